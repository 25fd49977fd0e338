//! Choosing one light of many for a point.

use std::f32::consts::PI;

use super::Light;
use super::cluster::{Cluster, Cone};
use super::receiver::{Receiver, View};
use super::shaping::Beam;
use super::tree::LightTree;

/// Up to this many finite lights are weighed one by one; more are kept in a tree.
const FEW: usize = 16;

/// Chooses lights by the irradiance they are expected to give a point.
///
/// Finite lights by power over squared distance and by the cosines at both ends, where the light is in front of the
/// receiver and the receiver in front of the light; distant and dome lights by their irradiance. Lights that emit
/// nothing are never chosen, nor are those that rays find as well ([`Light::is_left_to_rays`]).
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
    /// The tree, and the index of each of its lights.
    Many(LightTree, Vec<u32>),
}

/// A finite light as seen by the sampler.
#[derive(Clone, Debug)]
struct Emitter {
    /// Index among all lights.
    light: u32,
    /// Without its shaping but for the peak of that.
    cluster: Cluster,
    /// Where it shines, if it is shaped.
    beam: Option<Box<Beam>>,
}

impl Emitter {
    /// `weight`: the light's power over 4 π, relative to that of the other lights.
    fn new(index: u32, light: &Light, weight: f32) -> Self {
        let cone = light.cone();
        // A flat light sends its power into a cosine lobe, a fourth of the steradians of the sphere, or into two.
        let concentration = match (cone.cos > 0.5, cone.two_sided) {
            (true, false) => 4.0,
            (true, true) => 2.0,
            (false, _) => 1.0,
        };
        let shaping = light.emission().shaping.as_ref();
        let beam = shaping.map(|s| Box::new(s.beam()));
        // What a shaped light lacks in power it does not lack along its beam.
        let weight = match (shaping, &beam) {
            (Some(s), Some(beam)) => (weight / s.power_share() * beam.peak).min(1e30),
            _ => weight,
        };
        let cluster = Cluster::new(light.bounds().unwrap_or_default(), cone, concentration * weight);
        Self { light: index, cluster, beam }
    }
    /// Irradiance to expect at a receiver, relative; zero only where none of its light arrives.
    #[inline]
    fn importance(&self, view: &View) -> f32 {
        let plain = self.cluster.importance(view);
        let Some(beam) = &self.beam else { return plain };
        plain * beam.toward(view.point - self.cluster.center(), self.cluster.radius_squared())
    }
    /// What a tree is to know of it: its directions, narrowed to the beam.
    fn bounding(&self) -> Cluster {
        let Some(beam) = &self.beam else { return self.cluster };
        let cone = self.cluster.cone();
        let cos_edge = beam.end.cos();
        let narrowed = if cone.cos >= 1.0 {
            let along = cone.axis.dot(beam.axis) > 0.9999;
            Cone { cos_edge: if along { cos_edge.max(cone.cos_edge) } else { cone.cos_edge }, ..cone }
        } else if beam.end < 0.9 * PI {
            Cone { axis: beam.axis, cos: 1.0, two_sided: false, cos_edge }
        } else {
            Cone::ALL
        };
        self.cluster.facing(narrowed)
    }
}

/// Where a light is kept.
#[derive(Clone, Copy, Debug)]
enum Slot {
    Dark,
    /// Index into `infinite`.
    Infinite(u32),
    /// Index into the few, or number in the tree.
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
        let chosen = lights.iter().filter(|l| !l.is_left_to_rays());
        let brightest = chosen.map(weight).filter(|w| w.is_finite()).fold(0f32, f32::max);
        let (mut infinite, mut emitters, mut slots) = (Vec::new(), Vec::new(), Vec::new());
        for (index, light) in lights.iter().enumerate() {
            let (index, w) = (index as u32, weight(light) / brightest);
            slots.push(if w == 0.0 || w.is_nan() || light.is_left_to_rays() {
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
        let clusters: Vec<Cluster> = emitters.iter().map(Emitter::bounding).collect();
        let finite = match LightTree::new(&clusters) {
            Some(tree) if emitters.len() > FEW => Finite::Many(tree, emitters.iter().map(|e| e.light).collect()),
            _ => Finite::Few(emitters),
        };
        Self { infinite, infinite_total, finite, slots, only }
    }
    /// Whether no light can be chosen.
    pub fn is_empty(&self) -> bool {
        self.slots.iter().all(|s| matches!(s, Slot::Dark))
    }
    /// A light's index and the probability of having chosen it; `None` where no light reaches the receiver. `u` in
    /// [0, 1).
    #[inline]
    pub fn sample(&self, receiver: &Receiver, u: f32) -> Option<(usize, f32)> {
        self.sample_with(receiver, || u)
    }
    /// As [`LightSampler::sample`], with a number that is asked for only where there is a choice.
    #[inline]
    pub fn sample_with(&self, receiver: &Receiver, u: impl FnOnce() -> f32) -> Option<(usize, f32)> {
        if let Some(only) = self.only {
            return Some((only as usize, 1.0));
        }
        let view = receiver.view();
        let mut weights = [0.0; FEW];
        let finite = self.weigh(&view, &mut weights);
        let total = finite + self.infinite_total;
        if total <= 0.0 {
            return None;
        }
        let x = u() * total;
        if x >= finite || finite == 0.0 {
            let (index, weight) = self.infinite[pick(&self.infinite, x - finite, |i| i.1)?];
            return Some((index as usize, weight / total));
        }
        match &self.finite {
            Finite::Few(emitters) => {
                let slot = pick(&weights[..emitters.len()], x, |w| *w)?;
                Some((emitters[slot].light as usize, weights[slot] / total))
            }
            Finite::Many(tree, lights) => {
                let leaf = tree.sample(&view, x / finite)?;
                Some((lights[leaf.index as usize] as usize, leaf.pmf * (finite / total)))
            }
        }
    }
    /// Probability with which [`LightSampler::sample`] chooses a light for a receiver.
    #[inline]
    pub fn pmf(&self, receiver: &Receiver, index: usize) -> f32 {
        if let Some(only) = self.only {
            return if only as usize == index { 1.0 } else { 0.0 };
        }
        let view = receiver.view();
        let mut weights = [0.0; FEW];
        let finite = self.weigh(&view, &mut weights);
        let total = finite + self.infinite_total;
        if total <= 0.0 {
            return 0.0;
        }
        match (self.slots.get(index), &self.finite) {
            (Some(&Slot::Infinite(i)), _) => self.infinite[i as usize].1 / total,
            (Some(&Slot::Finite(i)), Finite::Few(_)) => weights[i as usize] / total,
            (Some(&Slot::Finite(i)), Finite::Many(tree, _)) => tree.pmf(&view, i as usize) * (finite / total),
            (Some(Slot::Dark) | None, _) => 0.0,
        }
    }
    /// Weight of all finite lights; that of each where they are few.
    #[inline]
    fn weigh(&self, view: &View, weights: &mut [f32; FEW]) -> f32 {
        match &self.finite {
            Finite::Few(emitters) => {
                for (weight, emitter) in weights.iter_mut().zip(emitters) {
                    *weight = emitter.importance(view);
                }
                weights.iter().take(emitters.len()).sum()
            }
            Finite::Many(tree, _) => tree.importance(view),
        }
    }
}

/// The number of the item within whose weight `x` falls when the weights are laid end to end; the last of positive
/// weight if beyond.
#[inline]
fn pick<T>(items: &[T], mut x: f32, weight: impl Fn(&T) -> f32) -> Option<usize> {
    let mut last = None;
    for (index, item) in items.iter().enumerate() {
        let w = weight(item);
        if w > 0.0 {
            last = Some(index);
            if x < w {
                break;
            }
            x -= w;
        }
    }
    last
}
