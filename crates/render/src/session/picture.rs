//! A picture under way: pass by pass to its end.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use rayon::ThreadPool;
use umber_settings::Integrator;

use super::control::Shared;
use crate::adaptive::{self, Plan};
use crate::caustics::{self, CausticMap};
use crate::film::{COARSE, Film, FilmDesc};
use crate::integrator::edges::{self, EdgeMap};
use crate::integrator::splitting::{self, Splitting};
use crate::integrator::{Goal, Stop, Target, TileWork, raster, render_tile, reuse};
use crate::light_tracing::LightTracing;
use crate::scene::RenderScene;

/// Samples a pixel that one pass of a final frame adds.
const FINAL_PASS: u32 = 16;
/// The same where pixels get different counts, and few of them all.
const PLANNED_PASS: u32 = 64;

/// Samples a pixel, or of a whole small picture, that adaptive pictures are taken to need before anything is known of them:
/// mostly they may have far more than they get.
const TYPICAL: u32 = 64;
const TYPICAL_OF_ALL: usize = 1 << 20;

/// Where somebody watches, or the time is limited, so many samples a pixel are shown before searches and trials.
/// Of adaptive pictures they are the first half of the pilot.
const SAMPLES_BEFORE: u32 = 8;

/// What has samples, and how many.
pub(super) struct Picture {
    epoch: u64,
    scene: RenderScene,
    film: Arc<Film>,
    order: Vec<usize>,
    /// How many of the coarse grids are done.
    coarse: usize,
    /// Samples that every pixel has, or all that its plan gives it.
    done: u32,
    /// Samples of each pixel, once the pilot has decided about them.
    plan: Option<Plan>,
    /// Samples that every pixel had when it was decided how those to come are taken.
    prepared_at: Option<u32>,
    seconds: f64,
    rays: AtomicU64,
    samples: AtomicU64,
}

/// What a pass left to be done.
#[derive(PartialEq, Eq)]
enum Passed {
    Whole,
    Cancelled,
    TimeIsUp,
}

impl Picture {
    /// A picture without samples.
    pub fn new(epoch: u64, scene: RenderScene, film: Arc<Film>) -> Self {
        let order = film.tile_order();
        let (rays, samples) = (AtomicU64::new(0), AtomicU64::new(0));
        let prepared_at = None;
        Self { epoch, scene, film, order, coarse: 0, done: 0, plan: None, prepared_at, seconds: 0.0, rays, samples }
    }
    /// The restart that it belongs to.
    pub fn epoch(&self) -> u64 {
        self.epoch
    }

    /// Adds passes until the picture is finished (true) or the job is cancelled (false).
    pub fn render(&mut self, shared: &Shared, pool: &ThreadPool) -> bool {
        while self.film.tile_count() > 0 {
            let is_due = self.done >= self.samples_before() && self.done < self.most();
            if is_due && self.prepared_at.is_none() && !self.prepare(shared, pool) {
                if shared.cancelled().load(Ordering::Relaxed) {
                    return false;
                }
                break;
            }
            if self.is_adaptive() && self.plan.is_none() && is_due && self.done == self.pilot() {
                self.decide(pool);
            }
            let Some((samples, stride)) = self.next_pass() else { break };
            self.trace_light(shared, pool, samples);
            match self.pass(shared, pool, samples, stride) {
                Passed::Cancelled => return false,
                Passed::TimeIsUp => break,
                Passed::Whole if stride > 1 => self.coarse += 1,
                Passed::Whole => self.done = samples,
            }
        }
        let relative_variance = self.film.mean_relative_variance().unwrap_or(-1.0);
        shared.update_stats(|s| {
            s.percent_done = 100.0;
            s.relative_variance = relative_variance;
        });
        true
    }

    /// Decides how the samples to come are taken: where they take more rays from the camera, how they find caustics,
    /// how many pixels share their paths, and whether paths are split, each of the last two judged with caustics as
    /// they are found and without the other. False, and all left as it was, where it was stopped.
    fn prepare(&mut self, shared: &Shared, pool: &ThreadPool) -> bool {
        let started = Instant::now();
        let stop = self.stop(shared, started);
        let samples = self.most_likely().saturating_sub(self.done);
        let (scene, film) = (&mut self.scene, self.film.desc());
        let mut rays = 0;
        if edges::are_looked_for(&scene.settings) {
            scene.edges = pool.install(|| EdgeMap::find(scene, film, &stop, &mut rays));
        }
        pool.install(|| find_caustics(scene, film, samples, &stop, &mut rays));
        if reuse::is_possible(&scene.settings, &scene.lights) {
            scene.path_group = pool.install(|| reuse::best_group(scene, film, samples, &stop, &mut rays));
        }
        let splitting = Splitting::wanted(&scene.settings, scene.path_group);
        if pool.install(|| splitting::pays(scene, splitting, film, self.done + samples, &stop, &mut rays)) {
            scene.splitting = splitting;
        }
        if stop.now() {
            (scene.caustics, scene.light_tracing) = (None, None);
            (scene.path_group, scene.splitting, scene.edges) = (1, Splitting::NONE, None);
        } else {
            self.prepared_at = Some(self.done);
            *self.rays.get_mut() += rays;
            shared.update_stats(|s| {
                s.edge_pixels = scene.edges.as_ref().map_or(0, EdgeMap::pixels);
                s.path_group = scene.path_group as u32;
                s.samples_a_ray = scene.splitting.share(scene.settings.converged_samples_per_pixel);
            });
        }
        self.seconds += started.elapsed().as_secs_f64();
        self.prepared_at.is_some()
    }

    /// Decides how many samples pixels get, by their pilot.
    fn decide(&mut self, pool: &ThreadPool) {
        let started = Instant::now();
        let target = self.scene.settings.converged_variance;
        // pixels that share paths have their samples together
        let by_tile = self.scene.path_group > 1;
        self.plan = Some(pool.install(|| adaptive::plan(&self.film, target, self.most(), by_tile)));
        self.seconds += started.elapsed().as_secs_f64();
    }

    /// Adds the light paths that belong to so many samples a pixel.
    fn trace_light(&mut self, shared: &Shared, pool: &ThreadPool, samples: u32) {
        let (Some(tracing), Some(before)) = (&self.scene.light_tracing, self.prepared_at) else { return };
        let started = Instant::now();
        let (stop, film) = (self.stop(shared, started), self.film.desc());
        let size = [film.width, film.height];
        let [all, without] = [samples, before].map(|samples| self.goal(samples, 1));
        for (part, (all, without)) in all.totals(size).into_iter().zip(without.totals(size)).enumerate() {
            let until = tracing.paths(all.saturating_sub(without));
            loop {
                let first = self.film.light()[part].paths();
                let numbers = first..until.min(LightTracing::end_of_chunk(first));
                if numbers.is_empty() {
                    break;
                }
                let trace = || tracing.trace(&self.scene, film, numbers.clone(), part, &stop);
                let (splats, rays) = pool.install(trace);
                if stop.now() {
                    break;
                }
                self.film.light()[part].add(numbers.end, &splats, size[0] * size[1], before);
                self.rays.fetch_add(rays, Ordering::Relaxed);
                shared.update_stats(|s| s.light_paths += numbers.len() as u64);
            }
        }
        self.seconds += started.elapsed().as_secs_f64();
    }

    /// Samples a pixel that searches and trials are to pay for.
    fn most_likely(&self) -> u32 {
        let most = self.most();
        let pixels = self.film.desc().width * self.film.desc().height;
        let typical = TYPICAL.max((TYPICAL_OF_ALL / pixels.max(1)) as u32);
        if self.is_adaptive() { most.min(typical) } else { most }
    }

    /// Samples a pixel that are taken before it is decided how the others are.
    fn samples_before(&self) -> u32 {
        if self.may_end_early() { SAMPLES_BEFORE } else { 0 }
    }

    /// There may be an end at any time, or somebody who watches.
    fn may_end_early(&self) -> bool {
        self.scene.settings.enable_interactive || self.scene.settings.time_limit > 0.0
    }

    /// When to end early what began at `started`.
    fn stop<'a>(&self, shared: &'a Shared, started: Instant) -> Stop<'a> {
        let limit = f64::from(self.scene.settings.time_limit);
        let left = (limit > 0.0).then(|| Duration::from_secs_f64((limit - self.seconds).max(0.0)));
        Stop { cancel: shared.cancelled(), deadline: left.and_then(|left| started.checked_add(left)) }
    }

    fn is_adaptive(&self) -> bool {
        self.scene.settings.converged_variance >= 0.0
    }

    /// Whether it is made in one pass over the whole film.
    fn is_rasterised(&self) -> bool {
        self.scene.settings.integrator == Integrator::Raster
    }

    /// Most samples of a pixel.
    fn most(&self) -> u32 {
        self.scene.settings.converged_samples_per_pixel
    }

    fn pilot(&self) -> u32 {
        adaptive::pilot(self.most())
    }

    /// Samples a pixel and stride of the next pass; `None` where the picture is finished.
    fn next_pass(&self) -> Option<(u32, usize)> {
        let small_steps = !self.is_rasterised() && self.may_end_early();
        if small_steps && self.done == 0 && self.coarse < COARSE.len() {
            return Some((1, COARSE[self.coarse]));
        }
        let (largest, most) = match &self.plan {
            Some(plan) => (PLANNED_PASS, plan.bounds()[1]),
            None if self.is_adaptive() => (FINAL_PASS, self.pilot()),
            None => (FINAL_PASS, self.most()),
        };
        let step = if small_steps { (self.done / 2).clamp(1, largest) } else { largest };
        // whole rays
        (self.done < most).then(|| (self.scene.splitting.group(self.done + step - 1).end.min(most), 1))
    }

    /// Samples that all passes together take, as far as that is known.
    fn whole(&self) -> f64 {
        let pixels = (self.film.desc().width * self.film.desc().height) as f64;
        let most = pixels * f64::from(self.most());
        self.plan.as_ref().map_or(most, |plan| plan.total() as f64)
    }

    /// Where a pass brings the pixels.
    fn goal(&self, samples: u32, stride: usize) -> Goal<'_> {
        let target = match &self.plan {
            Some(plan) => Target::Planned(plan),
            None if self.is_adaptive() => Target::Pilot(self.pilot()),
            None => Target::Even,
        };
        Goal { samples, stride, target }
    }

    /// Brings every pixel where it is to be after `samples` samples.
    fn pass(&mut self, shared: &Shared, pool: &ThreadPool, samples: u32, stride: usize) -> Passed {
        let started = Instant::now();
        let limit = f64::from(self.scene.settings.time_limit);
        let stop = self.stop(shared, started);
        let goal = self.goal(samples, stride);
        let (whole, before) = (self.whole(), self.seconds);
        let worked = |work: TileWork| {
            let rays = self.rays.fetch_add(work.rays, Ordering::Relaxed) + work.rays;
            let samples = self.samples.fetch_add(work.samples, Ordering::Relaxed) + work.samples;
            let seconds = before + started.elapsed().as_secs_f64();
            let of_time = if limit > 0.0 { seconds / limit } else { 0.0 };
            shared.update_stats(|s| {
                s.rays = s.rays.max(rays);
                s.percent_done = s.percent_done.max(100.0 * (samples as f64 / whole).max(of_time).min(1.0));
                s.render_seconds = seconds;
            });
        };
        if self.is_rasterised() {
            // a part of it would be no picture: it is not ended for the time
            let stop = Stop { deadline: None, ..stop };
            let samples = pool.install(|| raster::render(&self.scene, &self.film, &stop));
            self.samples.store(0, Ordering::Relaxed);
            worked(TileWork { rays: 0, samples });
        } else {
            // each thread takes the next tile: all work side by side, and none waits longer than for one tile
            let next = AtomicUsize::new(0);
            pool.broadcast(|_| {
                while let Some(tile) = self.order.get(next.fetch_add(1, Ordering::Relaxed)) {
                    if stop.now() {
                        return;
                    }
                    worked(render_tile(&self.scene, &self.film, *tile, &goal, &stop));
                }
            });
        }
        self.seconds = before + started.elapsed().as_secs_f64();
        let taken = self.samples.load(Ordering::Relaxed) as f64;
        let pixels = (self.film.desc().width * self.film.desc().height) as f64;
        let passed = match () {
            () if stop.cancel.load(Ordering::Relaxed) => Passed::Cancelled,
            () if stop.late() => Passed::TimeIsUp,
            () => Passed::Whole,
        };
        let least = self.plan.as_ref().map_or(samples, |plan| plan.bounds()[0].min(samples));
        shared.update_stats(|s| {
            if passed == Passed::Whole && stride == 1 {
                s.samples_per_pixel = least;
            }
            s.mean_samples_per_pixel = taken / pixels;
            s.render_seconds = self.seconds;
        });
        passed
    }
}

/// Looks for caustics of a scene in a picture of so many samples a pixel to come, and for how to find them.
fn find_caustics(scene: &mut RenderScene, film: &FilmDesc, samples: u32, stop: &Stop<'_>, rays: &mut u64) {
    if !caustics::are_possible(&scene.settings, &scene.materials) {
        return;
    }
    let eye = scene.camera.position();
    let matters = |landings: &[_]| CausticMap::new(eye, landings).is_some();
    if let Some((tracing, landings)) = LightTracing::search(scene, film, samples, matters, stop, rays) {
        scene.caustics = CausticMap::new(eye, &landings);
        scene.light_tracing = Some(tracing);
    }
}
