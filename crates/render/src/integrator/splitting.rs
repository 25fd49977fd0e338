//! How many samples of a pixel begin with the same ray from the camera.
//!
//! Such a ray, and all that is worked out where it ends, is a good part of what a sample costs; and where in the pixel
//! it went matters little to most errors, which lie in what paths do afterwards. So paths are split where the camera's
//! ray ends (Arvo & Kirk 1990, "Particle transport and image synthesis"). Every sample still has the right mean, and
//! goes on by points of its own; the film's are fewer, from the same sequence.
//!
//! Where what is seen is finer than a pixel, or light comes from points alone, most of the error *is* in where a ray
//! goes: a trial tells, once a picture ([`gain`]).

mod gain;

use std::ops::Range;

use umber_settings::{Integrator, Settings};

use super::tile::MANY_SAMPLES;
use crate::adaptive;

pub(crate) use gain::pays;

/// How many samples of a pixel begin with each ray from the camera: of its first ones, and of all others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Splitting([u32; 2]);

/// A pixel's first samples, whose rays may be more than later ones'. Whole runs of all that share one.
const FIRST: u32 = 16;

impl Splitting {
    /// Every sample has a ray of its own.
    pub const NONE: Self = Self([1, 1]);

    /// What may pay, for pixels that share paths with so many others; [`Splitting::NONE`] where nothing may.
    ///
    /// Who watches is to see smooth edges as soon as may be, and pictures that may end at any time are to have them.
    /// Measured at 64 samples, the variance that is left is 0.96 to 1.03 of that without splitting (metal, chess), and
    /// 1.07 to 1.4 where eight share; shared paths, which come from fewer places then, lose 5 % where four do. With equal
    /// counts two share among the first (at 16 samples four leave 1.1 times the variance of many lights and of
    /// rooms), with adaptive ones four do: that takes .89 to .99 of the time to a given error, as edges get their due.
    pub fn wanted(settings: &Settings, path_group: usize) -> Self {
        let follows_paths = matches!(settings.integrator, Integrator::Path | Integrator::Direct);
        let may_end_early = settings.enable_interactive || settings.time_limit > 0.0;
        let samples = settings.converged_samples_per_pixel;
        let is_short = samples < MANY_SAMPLES || may_end_early && samples <= FIRST;
        // without a scattering all samples of a ray are the same
        if !settings.path_splitting || !follows_paths || is_short || settings.max_bounces < 1 {
            return Self::NONE;
        }
        let late = if path_group > 1 { 2 } else { 4 };
        let early = match () {
            () if may_end_early => 1,
            // the pilot decides about the samples to come, and is to be off by as much
            () if settings.converged_variance >= 0.0 && adaptive::pilot(samples) < samples / 2 => late,
            () => 2,
        };
        Self([early, late])
    }
    /// The number of the ray with which sample `number` begins.
    pub fn ray(self, number: u32) -> u32 {
        let Self([early, late]) = self;
        let first = number.min(FIRST);
        first / early + (number - first) / late
    }
    /// The samples that begin as sample `number` does.
    pub fn group(self, number: u32) -> Range<u32> {
        let Self([early, late]) = self;
        let (before, share) = if number < FIRST { (0, early) } else { (FIRST, late) };
        let start = before + (number - before) / share * share;
        start..start + share
    }
    /// As a trial takes it: from the first sample on.
    fn tried(self) -> Self {
        let Self([early, late]) = self;
        Self([early.max(2), late])
    }
    /// How many samples begin with each ray at the end of a picture of so many samples a pixel.
    pub fn share(self, samples: u32) -> u32 {
        self.0[usize::from(samples > FIRST)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_samples_share_rays_by_what_they_are_for() {
        let wanted = |changes: &[(&str, &str)]| {
            let mut settings = Settings::default();
            for (key, value) in [("convergedSamplesPerPixel", "64"), ("enableInteractive", "0")].iter().chain(changes) {
                settings.set_from_text(key, value).unwrap();
            }
            [1, 4].map(|group| Splitting::wanted(&settings, group).0)
        };
        assert_eq!(wanted(&[]), [[2, 4], [2, 2]]);
        assert_eq!(wanted(&[("convergedVariance", "0.01")]), [[4, 4], [2, 2]]);
        // hardly more than a pilot
        assert_eq!(wanted(&[("convergedVariance", "0.01"), ("convergedSamplesPerPixel", "32")])[0], [2, 4]);
        assert_eq!(wanted(&[("convergedVariance", "0.01"), ("enableInteractive", "1")]), [[1, 4], [1, 2]]);
        assert_eq!(wanted(&[("umber:pathSplitting", "0")]), [[1, 1]; 2]);
        assert_eq!(wanted(&[("convergedSamplesPerPixel", "15")]), [[1, 1]; 2]);
    }

    #[test]
    fn samples_with_the_same_ray_follow_each_other() {
        for splitting in [[1, 1], [1, 2], [1, 4], [2, 2], [2, 4], [4, 4]].map(Splitting) {
            assert_eq!(splitting.ray(0), 0);
            for number in 0..100 {
                let (ray, group) = (splitting.ray(number), splitting.group(number));
                assert!(
                    group.contains(&number) && group.clone().all(|n| splitting.ray(n) == ray),
                    "{splitting:?} {number}"
                );
                assert_eq!(splitting.ray(group.end), ray + 1, "{splitting:?} {number}");
            }
        }
        assert_eq!([1, 2, 15, 16, 19, 20].map(|n| Splitting([2, 4]).ray(n)), [0, 1, 7, 8, 8, 9]);
    }
}
