//! What sharing is worth in a picture: the error over the rays, of groups of several sizes.

use glam::DVec3;
use rayon::prelude::*;
use umber_math::Vec2;
use umber_sampling::Sampler;

use super::groups::RUN;
use super::{LARGEST_GROUP, Path, share, trace};
use crate::film::FilmDesc;
use crate::integrator::primary::Primary;
use crate::integrator::splitting::Splitting;
use crate::integrator::trial::{self, Comparison};
use crate::integrator::{RadianceSample, Stop, path, tile};
use crate::scene::RenderScene;

/// Pixels of a small group; as [`LARGEST_GROUP`], a square.
const FEW: usize = 4;
/// Most blocks that try.
const MOST_BLOCKS: u64 = 256;
/// Less say nothing.
const LEAST_BLOCKS: u64 = 32;
/// A trial of one size, of which there may be four, takes this part of the picture's paths.
const TRIAL: u64 = 128;
/// A block whose squared relative error is above this in groups of any size counts less: a few bright specks are not to
/// decide.
const LARGEST_ERROR: f64 = 0.1;
/// What paths that are shared cost over the same paths by themselves, without the rays that join them: they are kept
/// until all are there. Measured, 1.04 to 1.3.
const GROUP_COST: f64 = 1.1;
/// What a ray that joins two vertices costs, over one of a path, each with all that is computed at its ends. Measured:
/// 0.6 in a Cornell box, 1.6 on rough metal over a floor.
const JOIN_COST: f64 = 0.75;
/// Large groups are tried where small ones bring the error times the cost below this: where they brought it to .7 to .9 (a
/// chess set, a furnished room), large ones made it 1.1 to 1.4 times as much as that, and the trial takes most of its
/// rays for them.
const MUCH_BETTER: f64 = 0.7;
/// Distinguishes its random numbers from those of the picture.
const STREAM: u64 = 8 << 32;

/// How large a block of pixels is that tries, and for how long.
#[derive(Clone, Copy)]
struct BlockSize {
    /// In pixels.
    edge: usize,
    /// Samples of a pixel, in each of two independent runs. Their means are what has to differ little: that of edges and
    /// of light that comes straight is as good in groups of any size, and by single samples its noise drowned the rest.
    run: u32,
}

/// For small groups and none, by as many samples as short pictures have: means of few show too much of what both share,
/// edges and light that comes straight. (By runs of 4 samples, a furnished room's error in groups of 4 seemed to be .78 of
/// that without; it is .63.) That groups change within so many samples is left out; it costs less than a tenth.
const SMALL: BlockSize = BlockSize { edge: 2, run: 16 };
/// For groups of either size.
const LARGE: BlockSize = BlockSize { edge: 4, run: RUN };

impl BlockSize {
    const fn pixels(self) -> usize {
        self.edge * self.edge
    }
    /// Paths of a block.
    const fn paths(self) -> u64 {
        2 * (self.pixels() as u64) * self.run as u64
    }
}

/// What a block found with groups of one size.
#[derive(Clone, Copy, Default)]
struct Trial {
    /// Mean radiance of all its samples.
    mean: DVec3,
    /// Variance of a pixel's mean over a run, the mean over its pixels.
    variance: DVec3,
    /// Along paths.
    path_rays: u64,
    /// Between vertices of different paths.
    join_rays: u64,
}

/// Of groups of 1, 4 and [`LARGEST_GROUP`] pixels those that cost the fewest rays to a given error; for a picture of so
/// many samples a pixel to come. Small pictures are not worth a trial: 1. Light is traced as beside such groups from then
/// on. Counts rays.
pub(crate) fn best_group(
    scene: &mut RenderScene,
    film: &FilmDesc,
    samples: u32,
    stop: &Stop<'_>,
    rays: &mut u64,
) -> usize {
    trace_light_beside(scene, 1);
    let paths = (film.width * film.height) as u64 * u64::from(samples) / TRIAL;
    let blocks = (paths / SMALL.paths()).min(MOST_BLOCKS);
    if blocks < LEAST_BLOCKS || film.width < LARGE.edge || film.height < LARGE.edge {
        return 1;
    }
    let mut tried = |size: usize, block: BlockSize| {
        trace_light_beside(scene, size);
        let scene = &*scene;
        let one =
            |number| if stop.now() { Trial::default() } else { Block::new(scene, film, block, number).trial(size) };
        let trials: Vec<Trial> = (0..blocks as u32).into_par_iter().map(one).collect();
        *rays += trials.iter().map(|trial| trial.path_rays + trial.join_rays).sum::<u64>();
        trials
    };
    let few = compare(&tried(1, SMALL), GROUP_COST, &tried(FEW, SMALL));
    let group = if !few.is_clearly_below(1.0) {
        1
    } else if !few.is_clearly_below(MUCH_BETTER) {
        FEW
    } else {
        let many = compare(&tried(FEW, LARGE), 1.0, &tried(LARGEST_GROUP, LARGE));
        if many.is_clearly_below(1.0) { LARGEST_GROUP } else { FEW }
    };
    trace_light_beside(scene, group);
    group
}

/// Has light traced as it is beside groups of so many pixels: to shared paths it leaves what wide lobes pass on.
fn trace_light_beside(scene: &mut RenderScene, size: usize) {
    if let Some(tracing) = &mut scene.light_tracing {
        tracing.beside_shared_paths = size > 1;
    }
}

/// The product of error and cost in trials by groups of a second size over that by groups of a first, in the same blocks.
/// `path_cost`: of a path of the second, over one of the first.
fn compare(first: &[Trial], path_cost: f64, second: &[Trial]) -> Comparison {
    let pairs = first.iter().zip(second);
    let found = |(a, b): (&Trial, &Trial)| (0.5 * (a.mean + b.mean), [a.variance, b.variance]);
    let cost = |trials: &[Trial], path_cost: f64| {
        let sum = |of: fn(&Trial) -> u64| trials.iter().map(of).sum::<u64>() as f64;
        path_cost * sum(|trial| trial.path_rays) + JOIN_COST * sum(|trial| trial.join_rays)
    };
    let cost = cost(second, path_cost) / cost(first, 1.0);
    trial::compare(pairs.map(found), LARGEST_ERROR).times(cost)
}

/// A block of pixels somewhere on the film.
struct Block<'a> {
    scene: &'a RenderScene,
    seed: u64,
    number: u32,
    size: BlockSize,
    /// First column and row.
    corner: [usize; 2],
}

impl<'a> Block<'a> {
    fn new(scene: &'a RenderScene, film: &FilmDesc, size: BlockSize, number: u32) -> Self {
        let seed = STREAM | u64::from(scene.settings.seed);
        // spread evenly over the film
        let place = Sampler::new(seed, [0, 0], number).next_2d();
        let within = |u: f32, extent: usize| (u * (extent - size.edge + 1) as f32) as usize;
        Self { scene, seed, number, size, corner: [within(place.x, film.width), within(place.y, film.height)] }
    }

    /// Two independent runs, in groups of a size.
    fn trial(&self, size: usize) -> Trial {
        let mut trial = Trial::default();
        let [a, b] = [0, 1].map(|picture| self.picture(picture, size, &mut trial));
        let pixels = self.size.pixels() as f64;
        let squares: DVec3 = a.iter().zip(&b).map(|(a, b)| (*a - *b) * (*a - *b)).sum();
        trial.variance = squares / (2.0 * pixels);
        trial.mean = a.iter().chain(&b).sum::<DVec3>() / (2.0 * pixels);
        trial
    }

    /// Radiance of each pixel, the mean of a run; squares of four follow each other. Counts rays.
    fn picture(&self, picture: usize, size: usize, counts: &mut Trial) -> Vec<DVec3> {
        let mut means = vec![DVec3::ZERO; self.size.pixels()];
        for sample in 0..self.size.run {
            let samples = match size {
                1 => self.alone(picture, sample, counts),
                _ => self.in_groups(picture, sample, size, counts),
            };
            for (sample, mean) in samples.iter().zip(&mut means) {
                *mean += tile::kept(self.scene, sample.radiance).0.as_dvec3() / f64::from(self.size.run);
            }
        }
        means
    }

    /// A sample of each pixel, by a path of its own.
    fn alone(&self, picture: usize, sample: u32, counts: &mut Trial) -> Vec<RadianceSample> {
        let rays = &mut counts.path_rays;
        let one =
            |i| path::radiance(&self.primary(picture, i, sample, rays), &mut self.sampler(picture, i, sample), rays);
        (0..self.size.pixels()).map(one).collect()
    }

    /// A sample of each pixel, by paths that groups of a size share.
    fn in_groups(&self, picture: usize, sample: u32, size: usize, counts: &mut Trial) -> Vec<RadianceSample> {
        let pixels = 0..self.size.pixels();
        let primaries: Vec<_> = pixels.map(|i| self.primary(picture, i, sample, &mut counts.path_rays)).collect();
        let one = |(i, primary)| trace(primary, &mut self.sampler(picture, i, sample));
        let mut paths: Vec<_> = primaries.iter().enumerate().map(one).collect();
        let rays = |paths: &[Path<'_>]| paths.iter().map(|path| path.rays).sum::<u64>();
        let path_rays = rays(&paths);
        paths.chunks_mut(size).for_each(|group| share(self.scene, group));
        counts.path_rays += path_rays;
        counts.join_rays += rays(&paths) - path_rays;
        paths.iter().zip(&primaries).map(|(path, primary)| primary.sample(path.reflected)).collect()
    }

    /// What a pixel's sample begins with. Counts rays.
    fn primary(&self, picture: usize, i: usize, sample: u32, rays: &mut u64) -> Primary<'a> {
        let offset = [0, 1].map(|axis| (i >> axis & 1) + (i >> (axis + 2) & 1) * 2);
        let corner = Vec2::new((self.corner[0] + offset[0]) as f32, (self.corner[1] + offset[1]) as f32);
        Primary::of_samples(
            self.scene,
            corner,
            sample,
            Splitting::NONE,
            |sample| self.sampler(picture, i, sample),
            rays,
        )
    }
    fn sampler(&self, picture: usize, i: usize, sample: u32) -> Sampler {
        Sampler::new(self.seed, [self.number, (1 + picture * self.size.pixels() + i) as u32], sample)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trials(variances: &[f64], path_rays: u64, join_rays: u64) -> Vec<Trial> {
        let trial = |v: &f64| Trial { mean: DVec3::ONE, variance: DVec3::splat(*v), path_rays, join_rays };
        variances.iter().map(trial).collect()
    }

    #[test]
    fn errors_count_with_what_they_cost() {
        let alone = trials(&[0.1; 40], 10, 0);
        // paths cost 11, and what joins them 3
        let few = trials(&[0.07; 40], 10, 4);
        assert!((compare(&alone, 1.1, &few).ratio - 0.7 * 1.4).abs() < 1e-3);
        // 13 over 25
        let many = trials(&[0.035; 40], 10, 20);
        assert!((compare(&few, 1.0, &many).ratio - 0.5 * 25.0 / 13.0).abs() < 1e-3);
    }

    #[test]
    fn what_may_be_chance_is_not_better() {
        let alone = trials(&[0.01; 40], 10, 0);
        let better = |variances: &[f64]| compare(&alone, 1.1, &trials(variances, 10, 4)).is_clearly_below(1.0);
        assert!(better(&[0.005; 40]) && !better(&[0.01; 40]));
        assert!(!better(&[vec![0.0; 38], vec![0.1; 2]].concat()));
        // where nothing is off there is nothing to gain
        assert!(!compare(&trials(&[0.0; 40], 10, 0), 1.1, &trials(&[0.0; 40], 10, 4)).is_clearly_below(1.0));
    }
}
