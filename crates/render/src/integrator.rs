//! Integrators: they read a frozen scene and give samples.

mod center;
pub mod dimensions;
mod direct;
pub(crate) mod edges;
pub(crate) mod found;
mod mirror;
pub mod path;
pub(crate) mod primary;
pub mod raster;
pub(crate) mod reuse;
pub(crate) mod splitting;
pub(crate) mod tile;
mod trial;

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use umber_math::Rgb;
use umber_settings::{Integrator, Settings};

use crate::adaptive::{self, Plan};
use crate::scene::RenderScene;

pub use tile::render_tile;

/// The settings as the chosen integrator takes them.
pub fn settings(given: &Settings) -> Settings {
    match given.integrator {
        Integrator::Path | Integrator::Mirror => given.clone(),
        Integrator::Direct => direct::settings(given),
        Integrator::Raster => raster::settings(given),
    }
}

/// One sample of a pixel.
#[derive(Clone, Copy, Debug)]
pub struct RadianceSample {
    /// Radiance towards the camera.
    pub radiance: Rgb,
    /// How much of what its rays from the camera see is not the void: 1 or 0, or between where there are several.
    pub coverage: f32,
}

/// What rendering a tile took.
#[derive(Clone, Copy, Debug, Default)]
pub struct TileWork {
    /// Rays traced.
    pub rays: u64,
    /// Samples added.
    pub samples: u64,
}

/// How far a pass brings the pixels.
#[derive(Clone, Copy, Debug)]
pub struct Goal<'a> {
    /// Samples a pixel.
    pub samples: u32,
    /// Every how many pixels, across and down, one is sampled: more than 1 for a first coarse picture.
    pub stride: usize,
    /// Where the pixels are to get.
    pub target: Target<'a>,
}

/// Where the pixels are to get in the end.
#[derive(Clone, Copy, Debug)]
pub enum Target<'a> {
    /// All to the same count.
    Even,
    /// To counts that are not known yet: all to so many so far, in two halves.
    Pilot(u32),
    /// To the counts of a plan.
    Planned(&'a Plan),
}

impl Goal<'_> {
    /// Samples of the pixel at column `x` and row `y`, in each half.
    pub fn counts(&self, x: usize, y: usize) -> [u32; 2] {
        let halves = adaptive::halves(self.samples);
        match self.target {
            Target::Even => [self.samples, 0],
            Target::Pilot(_) => halves,
            Target::Planned(plan) => {
                let planned = plan.counts(x, y);
                std::array::from_fn(|half| planned[half].min(halves[half]))
            }
        }
    }
    /// Samples of all pixels of a film of so many across and down, in each half.
    pub fn totals(&self, [width, height]: [usize; 2]) -> [u64; 2] {
        match self.target {
            Target::Planned(_) => (0..width * height).fold([0; 2], |[a, b], i| {
                let [in_a, in_b] = self.counts(i % width, i / width).map(u64::from);
                [a + in_a, b + in_b]
            }),
            _ => self.counts(0, 0).map(|count| u64::from(count) * (width * height) as u64),
        }
    }
    /// Samples of each of the two runs of a half that are to tell how many more it needs; `None` where that is known.
    fn run(&self, half: u32) -> Option<u32> {
        match self.target {
            Target::Pilot(samples) => Some(adaptive::halves(samples)[half as usize] / 2),
            _ => None,
        }
    }
    /// Seed of the sequence of a half: halves share no sample, and are independent.
    fn seed(&self, scene: &RenderScene, half: u32) -> u64 {
        let stream = if matches!(self.target, Target::Even) { 0 } else { half + 1 };
        u64::from(stream) << 32 | u64::from(scene.settings.seed)
    }
}

/// When to end early.
#[derive(Clone, Copy, Debug)]
pub struct Stop<'a> {
    /// Read before each sample, or those of a group.
    pub cancel: &'a AtomicBool,
    /// Read before each pixel, or group.
    pub deadline: Option<Instant>,
}

impl Stop<'_> {
    fn cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }
    /// Whether the time is up.
    pub fn late(&self) -> bool {
        self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }
    /// Whether to begin nothing new.
    pub fn now(&self) -> bool {
        self.cancelled() || self.late()
    }
}
