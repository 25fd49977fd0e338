//! What splitting is worth in a picture: the error over the rays, with it and without.

use glam::DVec3;
use rayon::prelude::*;
use umber_math::Vec2;
use umber_sampling::Sampler;

use super::Splitting;
use crate::film::FilmDesc;
use crate::integrator::primary::Primary;
use crate::integrator::{Stop, path, tile, trial};
use crate::scene::RenderScene;

/// Samples of a run, at most. Fewer make edges look as if they suffered more than they do.
const RUN: u32 = 32;
/// Most pixels that try.
const MOST_PIXELS: u64 = 512;
/// Less say nothing.
const LEAST_PIXELS: u64 = 48;
/// A trial may take this part of the picture's samples.
const TRIAL: u64 = 64;
/// It has to be this much worse to be left: what few pixels show is uncertain, and where splitting does harm it is by
/// far (small things seen from afar: 1.3 times the product at 16 samples, twice at 64).
const CLEARLY: f64 = 1.1;
/// What a ray from the camera costs over one of a path, each with all that is computed where it ends: measured, 0.7 on
/// metal and on the chess set.
const CAMERA_COST: f64 = 0.7;
/// A pixel whose run has a squared relative error above this, with splitting or without, counts less: a few bright specks
/// are not to decide. (With 0.05, splitting was left for one seed in eight on metal at 16 samples, where it takes .88 of
/// the cost; with 0.005 it is taken more often where small things are seen from afar, and does harm.)
const LARGEST_ERROR: f64 = 0.01;
/// Distinguishes its random numbers from those of the picture.
const STREAM: u64 = 9 << 32;

/// What a pixel found without splitting and with it.
#[derive(Clone, Copy, Default)]
struct Trial {
    /// Mean radiance of all its samples.
    mean: DVec3,
    /// Variance of the mean of a run.
    variances: [DVec3; 2],
    /// Rays taken.
    rays: [u64; 2],
}

/// Whether splitting costs no more rays to a given error, of paths that are not shared; for a picture of so many samples a
/// pixel. Small pictures are not worth a trial: false. Counts rays.
pub(crate) fn pays(
    scene: &RenderScene,
    splitting: Splitting,
    film: &FilmDesc,
    samples: u32,
    stop: &Stop<'_>,
    rays: &mut u64,
) -> bool {
    if splitting == Splitting::NONE {
        return false;
    }
    let run = samples.min(RUN);
    // two runs of each
    let pixels = (film.width * film.height) as u64 * u64::from(samples) / (TRIAL * 4 * u64::from(run.max(1)));
    if pixels < LEAST_PIXELS {
        return false;
    }
    let tried = splitting.tried();
    let one = |number| {
        if stop.now() { Trial::default() } else { Pixel::new(scene, film, number).trial(tried, run) }
    };
    let trials: Vec<Trial> = (0..pixels.min(MOST_PIXELS) as u32).into_par_iter().map(one).collect();
    *rays += trials.iter().map(|trial| trial.rays.iter().sum::<u64>()).sum::<u64>();
    is_better(&trials)
}

/// Whether the product of error and rays is not clearly more with splitting.
fn is_better(trials: &[Trial]) -> bool {
    let errors = trial::compare(trials.iter().map(|t| (t.mean, t.variances)), LARGEST_ERROR);
    let [alone, split] = [0, 1].map(|i| trials.iter().map(|trial| trial.rays[i]).sum::<u64>() as f64);
    errors.times((alone - CAMERA_COST * (alone - split)) / alone).ratio < CLEARLY
}

/// A pixel somewhere on the film.
struct Pixel<'a> {
    scene: &'a RenderScene,
    number: u32,
    corner: Vec2,
}

fn seed(scene: &RenderScene) -> u64 {
    STREAM | u64::from(scene.settings.seed)
}

impl<'a> Pixel<'a> {
    fn new(scene: &'a RenderScene, film: &FilmDesc, number: u32) -> Self {
        let size = Vec2::new(film.width as f32, film.height as f32);
        // spread evenly over the film
        let place = Sampler::new(seed(scene), [0, 0], number).next_2d();
        Self { scene, number, corner: (place * size).floor().min(size - 1.0) }
    }
    fn sampler(&self, run: u32, sample: u32) -> Sampler {
        Sampler::new(seed(self.scene), [self.number, run], sample)
    }

    fn trial(&self, splitting: Splitting, samples: u32) -> Trial {
        let mut trial = Trial::default();
        for (i, splitting) in [Splitting::NONE, splitting].into_iter().enumerate() {
            // both have the same points, so far as they can
            let [a, b] = [1, 2].map(|run| self.mean(splitting, run, samples, &mut trial.rays[i]));
            trial.mean += 0.25 * (a + b);
            trial.variances[i] = 0.5 * (a - b) * (a - b);
        }
        trial
    }

    /// Mean radiance of a run of samples.
    fn mean(&self, splitting: Splitting, run: u32, samples: u32, rays: &mut u64) -> DVec3 {
        let (mut sum, mut number) = (DVec3::ZERO, 0);
        while number < samples {
            let draw = |number| self.sampler(run, number);
            let primary = Primary::of_samples(self.scene, self.corner, number, splitting, draw, rays);
            let end = splitting.group(number).end.min(samples);
            for number in number..end {
                let sample = path::radiance(&primary, &mut self.sampler(run, number), rays);
                sum += tile::kept(self.scene, sample.radiance).0.as_dvec3();
            }
            number = end;
        }
        sum / f64::from(samples)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trial(variances: [f64; 2], rays: [u64; 2]) -> Trial {
        Trial { mean: DVec3::ONE, variances: variances.map(DVec3::splat), rays }
    }

    #[test]
    fn what_takes_clearly_more_error_times_rays_is_worse() {
        assert!(is_better(&[trial([0.01, 0.01], [100, 60])]));
        // what costs 72 is to make an error of less than 1.53 times as much
        assert!(is_better(&[trial([0.01, 0.015], [100, 60])]));
        assert!(!is_better(&[trial([0.01, 0.016], [100, 60])]));
        // where nothing is off there is nothing to gain
        assert!(!is_better(&[trial([0.0, 0.0], [100, 60])]));
        // a speck does not decide, but where all is noisy it is what counts
        let speck = trial([100.0, 2.0], [100, 60]);
        assert!(!is_better(&[&[speck][..], &[trial([0.01, 0.03], [100, 60]); 9]].concat()));
        assert!(!is_better(&[trial([0.1, 0.3], [100, 60])]));
    }
}
