//! Light tracing: caustics by paths that begin on smooth surfaces in the light, and are seen where they arrive.
//!
//! A path from the camera seldom finds the small bright reflection of a light in a smooth surface. From the other end it
//! is found easily: what a path from the smooth surface meets is joined to the camera by a ray (Dutré, Lafortune &
//! Willems 1993, "Monte Carlo light tracing with direct computation of pixel intensities"). It begins on the smooth
//! surface ([`casters`]) and not on a light: there lights are sampled as from any surface, so that all kinds of them
//! take part, and links hold. Both ends make the same paths, *what is seen, smooth surfaces, light*, and are weighed by
//! multiple importance sampling ([`chain`]; Veach 1997, chapter 9), so that neither has to be good everywhere.

mod casters;
pub(crate) mod chain;
mod image;
mod light_path;

use std::ops::Range;

use rayon::prelude::*;
use umber_math::Point3;
use umber_sampling::Sampler;
use umber_shading::Bsdf;

use crate::film::FilmDesc;
use crate::integrator::{Stop, reuse};
use crate::scene::RenderScene;

use casters::Casters;
pub(crate) use image::LightImage;
pub(crate) use light_path::Landing;
pub(crate) use light_path::Splat;
use light_path::{LightPath, Met};

/// Samples of the picture to one light path. On metal spheres over a floor 20 and 64 take 1.03 to 1.05 of the time to a
/// given error.
const SAMPLES_A_PATH: u64 = 32;
/// The same for the paths that first look for where to begin, by rounds. With half as many in the first the variance of
/// metal spheres over a floor is 1.06 times as much at 17 samples; more in either bring little.
const SAMPLES_A_SEARCH: [u64; 2] = [256, 128];
/// Pictures of fewer samples are not worth a search; more than so many paths find little more.
const FEWEST_SAMPLES: u64 = 1 << 19;
const MOST_SEARCH: [u64; 2] = [1 << 12, 1 << 14];
/// Smooth surfaces that a light path meets at most.
const REFLECTIONS: u32 = 4;
/// Light paths that one thread follows at a time, sorted by where they begin: what one brought into the caches serves
/// the next.
const BATCH: usize = 1024;
/// Light paths that are followed before what they bring is added to the picture.
const CHUNK: u32 = 1 << 20;
/// Distinguishes random numbers from those of the picture: of light paths for either part of it, and of searches.
const STREAMS: [u64; 2] = [3 << 32, 5 << 32];
const SEARCH_STREAMS: [u64; 2] = [12 << 32, 13 << 32];

/// How light is traced in a picture.
#[derive(Debug)]
pub(crate) struct LightTracing {
    casters: Casters,
    /// Light paths to one sample of every pixel.
    paths_a_sample: f32,
    /// Whether what wide lobes reflect is left to paths that pixels share.
    pub beside_shared_paths: bool,
}

/// What a path of a search found at a surface.
struct Found {
    landing: Option<Landing>,
    /// Luminance that it brings to the film, and the side of a block of casters where it begins.
    brought: Option<(usize, f32)>,
}

impl LightTracing {
    /// Looks for where light paths of a scene are best begun to be seen by a film, for a picture of so many samples a
    /// pixel to come; with where they landed. `matters`: whether some landings are worth going on. `None` where they
    /// are not, where the samples are too few to pay for it, or the camera squeezes. Counts rays. Of no use where
    /// stopped meanwhile.
    pub fn search(
        scene: &RenderScene,
        film: &FilmDesc,
        samples: u32,
        matters: impl Fn(&[Landing]) -> bool,
        stop: &Stop<'_>,
        rays: &mut u64,
    ) -> Option<(Self, Vec<Landing>)> {
        let pixels = (film.width * film.height) as u64;
        let samples = pixels * u64::from(samples);
        if samples < FEWEST_SAMPLES || !scene.camera.keeps_angles() {
            return None;
        }
        let paths_a_sample = pixels as f32 / SAMPLES_A_PATH as f32;
        let mut tracing = Self { casters: Casters::new(scene)?, paths_a_sample, beside_shared_paths: false };
        let mut landings = Vec::new();
        for round in 0..SAMPLES_A_SEARCH.len() {
            let paths = (samples / SAMPLES_A_SEARCH[round]).min(MOST_SEARCH[round]) as u32;
            let seed = SEARCH_STREAMS[round] | u64::from(scene.settings.seed);
            let found = tracing.follow(scene, seed, 0..paths, stop, rays, |path, met, sampler, rays| {
                let splat = path.splat(scene, film, met, sampler, rays);
                let brought = splat.map(|splat| (path.side, splat.radiance.luminance()));
                Some(Found { landing: path.landing(scene, met, sampler, rays), brought })
            });
            landings.extend(found.iter().filter_map(|found| found.landing));
            // few of them tell whether it is worth going on
            if stop.now() || round == 0 && !matters(&landings) {
                return None;
            }
            tracing.casters.learn(found.iter().filter_map(|found| found.brought));
        }
        Some((tracing, landings))
    }

    /// Whether a surface passes light on: between what the camera sees and the light there are such alone. Paths from
    /// the camera that are led to caustics ([`crate::caustics`]) go where light paths do not know of; so there it ends.
    #[inline]
    fn casts(&self, scene: &RenderScene, bsdf: &Bsdf, point: Point3) -> bool {
        let is_led = || bsdf.scatters() && scene.caustics.as_ref().is_some_and(|map| map.places(point).is_some());
        bsdf.focuses() && !(self.beside_shared_paths && reuse::is_shared(bsdf)) && !is_led()
    }

    /// Light paths to so many samples of a picture, over all pixels.
    pub fn paths(&self, samples: u64) -> u32 {
        (samples / SAMPLES_A_PATH).min(u64::from(u32::MAX)) as u32
    }

    /// The number up to which the paths from number `first` on are followed before what they bring is added: so much
    /// may be lost where it is stopped.
    pub fn end_of_chunk(first: u32) -> u32 {
        (first / CHUNK).saturating_add(1).saturating_mul(CHUNK)
    }

    /// What a film sees of light paths, by their numbers, for a part of its picture; and how many rays that took. Of
    /// some paths alone, where stopped.
    pub fn trace(
        &self,
        scene: &RenderScene,
        film: &FilmDesc,
        numbers: Range<u32>,
        part: usize,
        stop: &Stop<'_>,
    ) -> (Vec<Splat>, u64) {
        let (seed, mut rays) = (STREAMS[part] | u64::from(scene.settings.seed), 0);
        let see = |path: &mut LightPath, met: &Met, sampler: &mut Sampler, rays: &mut u64| {
            path.splat(scene, film, met, sampler, rays)
        };
        (self.follow(scene, seed, numbers, stop, &mut rays, see), rays)
    }

    /// What is made of the surfaces that light paths meet, in an order that only their numbers decide. Of some alone,
    /// where stopped.
    fn follow<T: Send>(
        &self,
        scene: &RenderScene,
        seed: u64,
        numbers: Range<u32>,
        stop: &Stop<'_>,
        rays: &mut u64,
        make: impl Fn(&mut LightPath, &Met, &mut Sampler, &mut u64) -> Option<T> + Sync,
    ) -> Vec<T> {
        let batch = |first: u32| {
            let (mut made, mut rays) = (Vec::new(), 0);
            let numbers = first..numbers.end.min(first.saturating_add(BATCH as u32));
            let begin = |number| {
                let mut sampler = Sampler::new(seed, [0, 0], number);
                (sampler.next_1d(), sampler)
            };
            let mut beginnings: Vec<(f32, Sampler)> = numbers.map(begin).collect();
            beginnings.sort_by(|a, b| a.0.total_cmp(&b.0));
            for (u, mut sampler) in beginnings {
                if stop.now() {
                    break;
                }
                let path = LightPath::begin(scene, self, u, &mut sampler);
                path.and_then(|mut path| {
                    for _ in 0..REFLECTIONS.min(scene.settings.max_bounces - 1) {
                        let met = path.meet(scene, &mut sampler, &mut rays)?;
                        made.extend(make(&mut path, &met, &mut sampler, &mut rays));
                        if !self.casts(scene, &met.bsdf, met.point()) {
                            break;
                        }
                        path.reflect(&met, &mut sampler)?;
                    }
                    Some(())
                });
            }
            (made, rays)
        };
        let batches: Vec<(Vec<T>, u64)> = numbers.clone().into_par_iter().step_by(BATCH).map(batch).collect();
        *rays += batches.iter().map(|(_, rays)| rays).sum::<u64>();
        batches.into_iter().flat_map(|(made, _)| made).collect()
    }
}
