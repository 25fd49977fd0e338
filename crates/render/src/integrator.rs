//! Integrators: they read a frozen scene and give samples.

mod center;
pub mod dimensions;
mod direct;
mod mirror;
pub mod path;
pub mod raster;

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use umber_math::{Rgb, Vec2};
use umber_sampling::Sampler;
use umber_settings::{Integrator, Settings};

use crate::adaptive::{self, Plan};
use crate::film::Film;
use crate::scene::RenderScene;

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
    /// 1 where anything is seen, 0 where nothing is.
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
    /// To counts that are not known yet: all the same so far, in two halves.
    Pilot,
    /// To the counts of a plan.
    Planned(&'a Plan),
}

impl Goal<'_> {
    /// Samples of the pixel at column `x` and row `y`, in each half.
    fn counts(&self, x: usize, y: usize) -> [u32; 2] {
        let halves = adaptive::halves(self.samples);
        match self.target {
            Target::Even => [self.samples, 0],
            Target::Pilot => halves,
            Target::Planned(plan) => {
                let planned = plan.counts(x, y);
                std::array::from_fn(|half| planned[half].min(halves[half]))
            }
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
    /// Read before each sample.
    pub cancel: &'a AtomicBool,
    /// Read before each pixel.
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

/// Renders a tile until every pixel has got where `goal` says. Ends early where stopped, between samples.
///
/// Each pixel adds its samples in their own order: the sums do not depend on who renders, nor on how
/// often it was stopped.
pub fn render_tile(scene: &RenderScene, film: &Film, tile: usize, goal: &Goal<'_>, stop: &Stop<'_>) -> TileWork {
    let mut work = TileWork::default();
    let (rect, mut halves, known) = {
        let tile = film.tile(tile);
        (tile.rect, tile.halves.clone(), tile.has_centers())
    };
    let pixels = rect.width * rect.height;
    let place = |i: usize| [rect.x + i % rect.width, rect.y + i / rect.width];
    if film.has_center_aovs() && !known && goal.stride == 1 {
        let hits: Vec<_> = (0..pixels).map(|i| center::trace(scene, place(i), &mut work.rays)).collect();
        film.set_centers(tile, &hits);
    }
    'halves: for (half, samples) in (0..).zip(&mut halves) {
        if goal.counts(rect.x, rect.y)[half as usize] > 0 {
            samples.prepare(pixels, !matches!(goal.target, Target::Even));
        }
        let sequence = Sequence { seed: goal.seed(scene, half), half, is_blue: spreads_blue_noise(&scene.settings) };
        for i in 0..samples.sums.len() {
            let [x, y] = place(i);
            if goal.stride > 1 && (x % goal.stride != 0 || y % goal.stride != 0) {
                continue;
            }
            if stop.late() {
                break 'halves;
            }
            let count = goal.counts(x, y)[half as usize];
            while samples.sums[i].samples < count {
                if stop.cancelled() {
                    break 'halves;
                }
                let mut rays = 0;
                let sample = sample(scene, film, sequence, [x, y], samples.sums[i].samples, &mut rays);
                samples.add(i, sample.radiance, sample.coverage, rays as u32);
                work.rays += rays;
                work.samples += 1;
            }
        }
    }
    film.tile(tile).halves = halves;
    work
}

/// A final frame of at least so many samples a pixel takes every pixel's points by themselves.
const MANY_SAMPLES: u32 = 16;

/// Whether the error is to be blue noise over pixels: where pictures of few samples are seen.
///
/// Both halves of an adaptive picture are then made so, each by its own seed: they count the same, and a half whose
/// error is white noise would drown the other's. They stay independent, as their seeds are.
fn spreads_blue_noise(settings: &Settings) -> bool {
    settings.enable_interactive || settings.converged_samples_per_pixel < MANY_SAMPLES
}

/// Samples of one half of a pixel.
#[derive(Clone, Copy)]
struct Sequence {
    seed: u64,
    half: u32,
    is_blue: bool,
}

impl Sequence {
    #[inline]
    fn sampler(self, pixel: [u32; 2], number: u32) -> Sampler {
        if self.is_blue {
            Sampler::blue_noise(self.seed, pixel, number)
        } else {
            Sampler::new(self.seed, pixel, number)
        }
    }
}

/// Takes sample number `number` of the pixel at column `x` and row `y`.
fn sample(
    scene: &RenderScene,
    film: &Film,
    sequence: Sequence,
    [x, y]: [usize; 2],
    number: u32,
    rays: &mut u64,
) -> RadianceSample {
    let data_min = film.desc().data_window_min;
    // numbered within the whole view, so that a part of it shows the same noise
    let pixel = [(x as i32 + data_min[0]) as u32, (y as i32 + data_min[1]) as u32];
    let sampler = || sequence.sampler(pixel, number);
    let ray = |in_pixel: Vec2| scene.camera.ray(Vec2::new(x as f32, y as f32) + in_pixel);
    let jittered = |sampler: &mut Sampler| {
        sampler.start_dimension(dimensions::FILM);
        ray(sampler.next_2d())
    };
    let sample = match scene.settings.integrator {
        Integrator::Mirror if number == 0 && sequence.half == 0 => {
            mirror::radiance(scene, ray(Vec2::splat(0.5)), sampler, rays)
        }
        Integrator::Mirror => {
            let mut sampler = sampler();
            mirror::radiance(scene, jittered(&mut sampler), || sampler, rays)
        }
        _ => {
            let mut sampler = sampler();
            path::radiance(scene, jittered(&mut sampler), &mut sampler, rays)
        }
    };
    RadianceSample { radiance: kept(scene, sample.radiance), ..sample }
}

/// What a pixel keeps of a sample's radiance.
fn kept(scene: &RenderScene, radiance: Rgb) -> Rgb {
    clamped(finite(radiance), scene.settings.firefly_clamp)
}

/// The same hue, with no channel above `largest`; 0 is no bound.
fn clamped(radiance: Rgb, largest: f32) -> Rgb {
    let channel = radiance.max_channel();
    if largest > 0.0 && channel > largest { radiance * (largest / channel) } else { radiance }
}

/// Nothing may poison a pixel: what is not a number counts as black, what is too large is cut.
fn finite(radiance: Rgb) -> Rgb {
    const LARGEST: f32 = 1e30;
    if radiance.0.is_nan() { Rgb::BLACK } else { Rgb(radiance.0.clamp(glam::Vec3::ZERO, glam::Vec3::splat(LARGEST))) }
}
