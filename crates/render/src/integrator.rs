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
    /// To counts that are not known yet: all to so many so far.
    Pilot(u32),
    /// To the counts of a plan.
    Planned(&'a Plan),
}

impl Goal<'_> {
    /// Samples of the pixel at column `x` and row `y`.
    pub fn count(&self, x: usize, y: usize) -> u32 {
        match self.target {
            Target::Even | Target::Pilot(_) => self.samples,
            Target::Planned(plan) => plan.count(x, y).min(self.samples),
        }
    }
    /// Into how many parts, which know nothing of each other, the pixels are divided.
    fn parts(&self) -> usize {
        if matches!(self.target, Target::Even) { 1 } else { 2 }
    }
    /// The part of the pixel at a column and a row.
    fn part(&self, place: [usize; 2]) -> usize {
        if self.parts() > 1 { adaptive::color(place) } else { 0 }
    }
    /// Samples of all pixels of a film of so many across and down, in each part.
    pub fn totals(&self, [width, height]: [usize; 2]) -> [u64; 2] {
        if let Target::Planned(_) = self.target {
            return (0..width * height).map(|i| [i % width, i / width]).fold([0; 2], |mut totals, place| {
                totals[self.part(place)] += u64::from(self.count(place[0], place[1]));
                totals
            });
        }
        let pixels = (width * height) as u64;
        let second = if self.parts() > 1 { pixels / 2 } else { 0 };
        [pixels - second, second].map(|pixels| pixels * u64::from(self.samples))
    }
    /// Of which half of a pixel's samples one is, by its number.
    fn half(&self, number: u32) -> usize {
        match self.target {
            Target::Even => 0,
            Target::Pilot(samples) => adaptive::half(samples, number),
            Target::Planned(plan) => adaptive::half(plan.pilot(), number),
        }
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
