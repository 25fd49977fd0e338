//! What sharing is worth in a picture: the error over the rays, of groups of several sizes.

use glam::DVec3;
use rayon::prelude::*;
use umber_math::{Rgb, Vec2};
use umber_sampling::Sampler;

use super::groups::RUN;
use super::{LARGEST_GROUP, Path, share, trace};
use crate::film::FilmDesc;
use crate::integrator::primary::Primary;
use crate::integrator::splitting::Splitting;
use crate::integrator::{Stop, tile, trial};
use crate::scene::RenderScene;

/// Sizes of groups that are tried: squares of pixels.
const SIZES: [usize; 3] = [1, 4, LARGEST_GROUP];
/// Edge of a block of pixels that tries them, in pixels.
const BLOCK: usize = 4;
/// Pixels of a block.
const PIXELS: usize = BLOCK * BLOCK;
/// Samples of a pixel of it: two independent runs. Their means are what has to differ little: that of edges and of light
/// that comes straight is as good in groups of any size, and by single samples its noise drowned the rest. (In a Cornell
/// box groups of 16 seemed to take .83 of the cost of 4 where they take .49, and for one seed in ten 4 were taken.)
const SAMPLES: u64 = 2 * RUN as u64;
/// Most blocks that try.
const MOST_BLOCKS: u64 = 256;
/// Less say nothing.
const LEAST_BLOCKS: u64 = 32;
/// A trial may take this part of the picture's paths.
const TRIAL: u64 = 128;
/// How much better it has to be to share: noise is less even then.
const CLEARLY: f64 = 0.9;
/// A block whose squared relative error is above this in groups of any size counts less: a few bright specks are not to
/// decide. (On rough metal, at 16 samples, groups of 4 were taken for one seed in three; they take 1.13 times as long to
/// a given error.)
const LARGEST_ERROR: f64 = 0.2;
/// What a ray that joins two vertices costs, over one of a path, each with all that is computed at its ends. Measured:
/// 0.6 in a Cornell box, 1.6 on rough metal over a floor.
const JOIN_COST: f64 = 0.75;
/// Distinguishes its random numbers from those of the picture.
const STREAM: u64 = 8 << 32;

/// What a block found of each size.
#[derive(Clone, Copy, Default)]
struct Trial {
    /// Mean radiance of all its samples.
    mean: DVec3,
    /// Variance of a pixel's mean over a run, the mean over its pixels.
    variances: [DVec3; SIZES.len()],
    /// Of the paths and of what joins them.
    rays: [u64; SIZES.len()],
}

/// Of groups of 1, 4 and [`LARGEST_GROUP`] pixels those that cost the fewest rays to a given error; for a picture of so
/// many samples a pixel to come. Small pictures are not worth a trial: 1. Counts rays.
pub(crate) fn best_group(scene: &RenderScene, film: &FilmDesc, samples: u32, stop: &Stop<'_>, rays: &mut u64) -> usize {
    let paths = (film.width * film.height) as u64 * u64::from(samples) / TRIAL;
    let blocks = (paths / (PIXELS as u64 * SAMPLES)).min(MOST_BLOCKS);
    if blocks < LEAST_BLOCKS || film.width < BLOCK || film.height < BLOCK {
        return 1;
    }
    let one = |block| if stop.now() { Trial::default() } else { Trial::new(scene, film, block) };
    let trials: Vec<Trial> = (0..blocks as u32).into_par_iter().map(one).collect();
    *rays += trials.iter().map(Trial::traced).sum::<u64>();
    SIZES[best(&trials)]
}

/// The number of the size with the least product of error and rays.
fn best(trials: &[Trial]) -> usize {
    let errors = trial::errors(trials.iter().map(|t| (t.mean, t.variances)), LARGEST_ERROR);
    let cost = |size: usize| {
        let rays = |size: usize| trials.iter().map(|trial| trial.rays[size]).sum::<u64>() as f64;
        errors[size] * (rays(0) + JOIN_COST * (rays(size) - rays(0)))
    };
    let shared = (1..SIZES.len()).min_by(|a, b| cost(*a).total_cmp(&cost(*b)));
    shared.filter(|size| cost(*size) < CLEARLY * cost(0)).unwrap_or(0)
}

impl Trial {
    fn new(scene: &RenderScene, film: &FilmDesc, number: u32) -> Self {
        let block = Block::new(scene, film, number);
        let [(a, rays_a), (b, rays_b)] = [0, 1].map(|picture| block.picture(picture));
        let pixels = PIXELS as f64;
        let squares = |size: usize| a[size].iter().zip(&b[size]).map(|(a, b)| (*a - *b) * (*a - *b)).sum::<DVec3>();
        let smoothest = SIZES.len() - 1;
        Self {
            mean: a[smoothest].iter().chain(&b[smoothest]).sum::<DVec3>() / (2.0 * pixels),
            variances: std::array::from_fn(|size| squares(size) / (2.0 * pixels)),
            rays: std::array::from_fn(|size| rays_a[size] + rays_b[size]),
        }
    }
    /// Rays of all sizes together: the paths are traced once, and joined for each.
    fn traced(&self) -> u64 {
        let alone = self.rays[0];
        alone + self.rays.iter().map(|rays| rays - alone).sum::<u64>()
    }
}

/// A block of pixels somewhere on the film.
struct Block<'a> {
    scene: &'a RenderScene,
    seed: u64,
    number: u32,
    /// First column and row.
    corner: [usize; 2],
}

impl<'a> Block<'a> {
    fn new(scene: &'a RenderScene, film: &FilmDesc, number: u32) -> Self {
        let seed = STREAM | u64::from(scene.settings.seed);
        let place = Sampler::new(seed, [number, 0], 0).next_2d();
        let within = |u: f32, size: usize| (u * (size - BLOCK + 1) as f32) as usize;
        Self { scene, seed, number, corner: [within(place.x, film.width), within(place.y, film.height)] }
    }

    /// What a picture's sample begins with in each pixel, and paths from there; squares of four follow each other.
    fn paths(&self, picture: usize, sample: u32) -> (Vec<Primary<'a>>, Vec<Path<'a>>) {
        let path = |i: usize| {
            let offset = [0, 1].map(|axis| (i >> axis & 1) + (i >> (axis + 2) & 1) * 2);
            let draw = |sample| Sampler::new(self.seed, [self.number, (1 + picture * PIXELS + i) as u32], sample);
            let at = Vec2::new((self.corner[0] + offset[0]) as f32, (self.corner[1] + offset[1]) as f32);
            let mut rays = 0;
            let primary = Primary::of_samples(self.scene, at, sample, Splitting::NONE, draw, &mut rays);
            let path = trace(&primary, &mut draw(sample));
            // here each begins by itself
            let path = Path { rays: path.rays + rays, ..path };
            (primary, path)
        };
        (0..PIXELS).map(path).unzip()
    }

    /// Radiance of each pixel in groups of each size, the mean of a run, and rays taken.
    fn picture(&self, picture: usize) -> ([Vec<DVec3>; SIZES.len()], [u64; SIZES.len()]) {
        let mut means = SIZES.map(|_| vec![DVec3::ZERO; PIXELS]);
        let mut rays = [0; SIZES.len()];
        for sample in 0..RUN {
            let (primaries, mut paths) = self.paths(picture, sample);
            let own: Vec<(Rgb, u64)> = paths.iter().map(|path| (path.reflected, path.rays)).collect();
            for (size, means) in means.iter_mut().enumerate() {
                paths.iter_mut().zip(&own).for_each(|(path, own)| (path.reflected, path.rays) = *own);
                paths.chunks_mut(SIZES[size]).for_each(|group| share(self.scene, group));
                for ((path, primary), mean) in paths.iter().zip(&primaries).zip(means) {
                    let sample = primary.sample(path.reflected);
                    *mean += tile::kept(self.scene, sample.radiance).0.as_dvec3() / f64::from(RUN);
                    rays[size] += path.rays;
                }
            }
        }
        (means, rays)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trial(variances: [f64; 3], rays: [u64; 3]) -> Trial {
        Trial { mean: DVec3::ONE, variances: variances.map(DVec3::splat), rays }
    }

    #[test]
    fn the_size_of_least_error_over_rays_is_taken_where_it_is_clearly_better() {
        assert_eq!(best(&[trial([0.1, 0.03, 0.01], [10, 14, 30])]), 2);
        assert_eq!(best(&[trial([0.1, 0.05, 0.04], [10, 14, 30])]), 1);
        assert_eq!(best(&[trial([0.1, 0.09, 0.08], [10, 14, 30])]), 0);
        assert_eq!(best(&[trial([0.1, 0.075, 0.06], [10, 14, 20])]), 0);
        // errors are relative to a block's own brightness
        let bright = Trial { mean: DVec3::splat(100.0), ..trial([1.0, 100.0, 1000.0], [10, 14, 30]) };
        assert_eq!(best(&[bright, trial([0.1, 0.03, 0.01], [10, 14, 30])]), 1);
        // specks do not decide, but where all is noisy it is what counts
        let speck = trial([100.0, 1.0, 1.0], [10, 14, 30]);
        assert_eq!(best(&[&[speck][..], &[trial([0.1, 0.09, 0.08], [10, 14, 30]); 30]].concat()), 0);
        assert_eq!(best(&[trial([1.0, 0.3, 0.1], [10, 14, 30])]), 2);
    }
}
