//! Choosing one light of many for a point.

use std::f32::consts::PI;

use umber_math::{Point3, Vec3};

use super::Light;
use super::tree::{Emitter, LightTree};

/// Up to this many finite lights are weighed one by one; more are kept in a tree.
const FEW: usize = 16;

/// Chooses lights by the irradiance they are expected to give a point.
///
/// Finite lights by power over squared distance, and by whether the point is on their lit side; distant and dome
/// lights by their irradiance. Lights that emit nothing are never chosen.
#[derive(Clone, Debug)]
pub struct LightSampler {
    /// Light index and weight.
    infinite: Vec<(u32, f32)>,
    infinite_total: f32,
    finite: Finite,
    /// By light index.
    slots: Vec<Slot>,
    /// The light, where there is just one that can be chosen.
    only: Option<u32>,
}

#[derive(Clone, Debug)]
enum Finite {
    Few(Vec<Emitter>),
    Many(LightTree),
}

/// Where a light is kept.
#[derive(Clone, Copy, Debug)]
enum Slot {
    Dark,
    /// Index into `infinite`.
    Infinite(u32),
    /// Index into the few, or leaf number of the tree.
    Finite(u32),
}

impl LightSampler {
    /// For the lights of a scene whose bounding sphere has the radius given.
    pub fn new(lights: &[Light], scene_radius: f32) -> Self {
        let power = |l: &Light| {
            let w = l.power_estimate(scene_radius) * l.diffuse().max(l.specular()).min(1e6);
            if w.is_finite() { w } else { 1e38 }
        };
        // Relative to the brightest, so that sums stay finite.
        let irradiance_scale = 1.0 / (PI * (scene_radius * scene_radius).max(f32::MIN_POSITIVE));
        let weight = |l: &Light| if l.is_infinite() { power(l) * irradiance_scale } else { power(l) / (4.0 * PI) };
        let brightest = lights.iter().map(weight).filter(|w| w.is_finite()).fold(0f32, f32::max);
        let (mut infinite, mut emitters, mut slots) = (Vec::new(), Vec::new(), Vec::new());
        for (index, light) in lights.iter().enumerate() {
            let (index, w) = (index as u32, weight(light) / brightest);
            slots.push(if w == 0.0 || w.is_nan() {
                Slot::Dark
            } else if light.is_infinite() {
                infinite.push((index, w.max(1e-30)));
                Slot::Infinite(infinite.len() as u32 - 1)
            } else {
                emitters.push(Emitter::new(index, light, w.max(1e-30)));
                Slot::Finite(emitters.len() as u32 - 1)
            });
        }
        let only = match (&infinite[..], &emitters[..]) {
            ([(index, _)], []) => Some(*index),
            ([], [emitter]) => Some(emitter.light),
            _ => None,
        };
        let infinite_total = infinite.iter().map(|i| i.1).sum();
        let finite = if emitters.len() <= FEW { Finite::Few(emitters) } else { Finite::Many(LightTree::new(emitters)) };
        Self { infinite, infinite_total, finite, slots, only }
    }
    /// Whether no light can be chosen.
    pub fn is_empty(&self) -> bool {
        self.slots.iter().all(|s| matches!(s, Slot::Dark))
    }
    /// A light's index and the probability of having chosen it; `None` where no light reaches the point.
    #[inline]
    pub fn sample(&self, p: Point3, u: f32) -> Option<(usize, f32)> {
        if let Some(only) = self.only {
            return Some((only as usize, 1.0));
        }
        let (finite, total) = self.totals(p.0)?;
        let x = u * total;
        if x >= finite || finite == 0.0 {
            let (index, weight) = pick(&self.infinite, x - finite, |i| i.1).copied()?;
            return Some((index as usize, weight / total));
        }
        match &self.finite {
            Finite::Few(emitters) => {
                let emitter = pick(emitters, x, |e| e.importance(p.0))?;
                Some((emitter.light as usize, emitter.importance(p.0) / total))
            }
            Finite::Many(tree) => {
                let (light, pmf) = tree.sample(p.0, x / finite)?;
                Some((light as usize, pmf * (finite / total)))
            }
        }
    }
    /// Probability with which [`LightSampler::sample`] chooses a light at `p`.
    #[inline]
    pub fn pmf(&self, p: Point3, index: usize) -> f32 {
        if let Some(only) = self.only {
            return if only as usize == index { 1.0 } else { 0.0 };
        }
        let Some((finite, total)) = self.totals(p.0) else { return 0.0 };
        match (self.slots.get(index), &self.finite) {
            (Some(&Slot::Infinite(i)), _) => self.infinite[i as usize].1 / total,
            (Some(&Slot::Finite(i)), Finite::Few(emitters)) => emitters[i as usize].importance(p.0) / total,
            (Some(&Slot::Finite(i)), Finite::Many(tree)) => tree.pmf(p.0, i as usize) * (finite / total),
            (Some(Slot::Dark) | None, _) => 0.0,
        }
    }
    /// Weight of all finite lights, and of all.
    #[inline]
    fn totals(&self, p: Vec3) -> Option<(f32, f32)> {
        let finite = match &self.finite {
            Finite::Few(emitters) => emitters.iter().map(|e| e.importance(p)).sum(),
            Finite::Many(tree) => tree.importance(p),
        };
        let total = finite + self.infinite_total;
        (total > 0.0).then_some((finite, total))
    }
}

/// The item within whose weight `x` falls when the weights are laid end to end; the last of positive weight if beyond.
#[inline]
fn pick<T>(items: &[T], mut x: f32, weight: impl Fn(&T) -> f32) -> Option<&T> {
    let mut last = None;
    for item in items {
        let w = weight(item);
        if w > 0.0 {
            last = Some(item);
            if x < w {
                break;
            }
            x -= w;
        }
    }
    last
}
