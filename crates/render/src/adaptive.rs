//! Adaptive sampling: how many samples each pixel gets, so that a given mean error costs the least.
//!
//! A pixel has two halves, which share no sample. After a pilot of equal counts everywhere, one decision is
//! made: the counts of the *first* half follow from the pilot of all *second* halves, and the other way round.
//! The picture is the mean of both halves, each counting the same.
//!
//! So no bias: given the second halves, the counts of the first are constants, its samples are what they would
//! be without any decision, and the mean of a fixed number of them is unbiased; the same holds with the halves
//! exchanged, and the weights of the halves are constants. A rule that looked at the samples it keeps would end
//! where they happen to be dark (Kirk & Arvo 1991, "Unbiased sampling techniques for image synthesis").
//!
//! Of all allocations with the same mean relative variance, the one with counts proportional to the square root of a
//! pixel's relative variance, per sample, takes the fewest (Neyman 1934). Equal error everywhere would take as many
//! samples as equal counts: the n ∝ v rule has mean error t at mean count E[v] / t, as n = const has. That samples of
//! noisy pixels take more rays is left out: counts by variance over rays took 1.03 to 1.08 times as long to the same
//! error (metal, many rays where it is noisy; a Cornell box: no difference).
//!
//! The variance that counts is not that of single samples: points of a pixel are spread evenly, and where that serves,
//! at an edge or in light that comes straight, their mean is far better than as many independent samples would be.
//! So it is read off the means of two runs of samples.

use std::iter::Sum;
use std::ops::Div;

use glam::DVec3;
use rayon::prelude::*;

use crate::film::{self, Film};

/// Pixels to each side over which means are pooled; and, in several windows, relative variances, of which the geometric
/// mean counts: small windows keep edges, large ones learn of spikes that few pixels met where all could have.
///
/// Windows of 2 and 12 took 1.02 to 1.05 times as many rays to the same error on metal, and as many on chess; one of 1
/// beside these changes nothing, and would often meet no light at all where that is rare.
const MEAN_RADIUS: usize = 3;
const RADII: [usize; 4] = [2, 4, 8, 16];
/// Samples of the pilot, a pixel, in both halves together. 32 tell more, and took 1.03 (metal) to 1.1 times (chess) as
/// many rays: they are too many where little is to be seen.
const PILOT: u32 = 16;
/// Bins of the distribution of relative variances, an octave.
const BINS_PER_OCTAVE: f64 = 16.0;
/// Octaves of relative variance per sample that are told apart, from 2^-`OCTAVES` to 2^`OCTAVES`.
const OCTAVES: f64 = 32.0;

/// Samples a pixel in each half.
#[derive(Debug)]
pub(crate) struct Plan {
    width: usize,
    counts: [Vec<u32>; 2],
}

impl Plan {
    /// Samples of the pixel at column `x` and row `y`, in each half.
    pub fn counts(&self, x: usize, y: usize) -> [u32; 2] {
        self.counts.each_ref().map(|half| half[y * self.width + x])
    }
    /// Samples of all pixels.
    pub fn total(&self) -> u64 {
        self.counts.iter().flatten().map(|n| u64::from(*n)).sum()
    }
    /// Smallest and largest count of a pixel, both halves together.
    pub fn bounds(&self) -> [u32; 2] {
        let [a, b] = &self.counts;
        let both = || a.iter().zip(b).map(|(a, b)| a + b);
        [both().min().unwrap_or(0), both().max().unwrap_or(0)]
    }
}

/// Samples of a pilot where a pixel gets at most `most`.
pub(crate) fn pilot(most: u32) -> u32 {
    PILOT.min(most)
}

/// How many of `samples` samples of a pixel are in each half.
pub(crate) fn halves(samples: u32) -> [u32; 2] {
    [samples.div_ceil(2), samples / 2]
}

/// The plan by which the mean of the pixels' relative variances is `target`, as far as `most` samples a pixel
/// allow. `film` holds the pilot. `by_tile`: whether all pixels of a tile get the same counts.
pub(crate) fn plan(film: &Film, target: f32, most: u32, by_tile: bool) -> Plan {
    let least = halves(pilot(most));
    let most = halves(most);
    let variances = [0, 1].map(|half| {
        let variances = variances(film, half);
        if by_tile { means_of_tiles(film, &variances) } else { variances }
    });
    let counts = |half: usize| {
        let deciding = &variances[1 - half];
        let scale = scale(deciding, target.into(), [least[half], most[half]]);
        deciding.par_iter().map(|v| count(*v, scale, [least[half], most[half]])).collect()
    };
    Plan { width: film.desc().width, counts: [counts(0), counts(1)] }
}

/// Samples of a pixel: a power of two, or one and a half times that, as points of so many are spread more evenly than
/// of others.
fn count(variance: f64, scale: f64, [least, most]: [u32; 2]) -> u32 {
    let wanted = (scale * variance.sqrt()).max(1.0);
    let step = 0.5 * wanted.log2().floor().exp2();
    // the cast saturates
    (((wanted / step).round() * step) as u32).clamp(least, most)
}

/// The factor between counts and the square roots of relative variances by which the mean of variance / (2 · count),
/// the error of a mean of two such halves, is `target`: least such factor, over a finely binned distribution.
fn scale(variances: &[f64], target: f64, bounds: [u32; 2]) -> f64 {
    let bins = (2.0 * OCTAVES * BINS_PER_OCTAVE) as usize;
    let mut sums = vec![0.0; bins];
    for v in variances.iter().filter(|v| **v > 0.0) {
        sums[((v.log2() + OCTAVES) * BINS_PER_OCTAVE).clamp(0.0, bins as f64 - 1.0) as usize] += v;
    }
    // the lower end of a bin stands for all of it
    let of_bin = |bin: usize| (bin as f64 / BINS_PER_OCTAVE - OCTAVES).exp2();
    let error = |scale: f64| {
        let of = |(bin, v): (usize, &f64)| v / (2.0 * f64::from(count(of_bin(bin), scale, bounds)));
        sums.iter().enumerate().filter(|(_, v)| **v > 0.0).map(of).sum::<f64>() / variances.len().max(1) as f64
    };
    let (mut low, mut high) = (-60.0f64, 60.0f64);
    if error(high.exp2()) > target {
        return high.exp2();
    }
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if error(middle.exp2()) > target { low = middle } else { high = middle }
    }
    high.exp2()
}

/// Relative variance times samples, the mean of the channels', pixel by pixel, as one half shows it.
fn variances(film: &Film, half: usize) -> Vec<f64> {
    let (width, height) = (film.desc().width, film.desc().height);
    let (mut means, mut variances) = (vec![DVec3::ZERO; width * height], vec![DVec3::ZERO; width * height]);
    let light = film.light();
    for index in 0..film.tile_count() {
        let tile = film.tile(index);
        for i in 0..tile.rect.width * tile.rect.height {
            let [x, y] = tile.rect.place(i);
            let at = y * width + x;
            (means[at], variances[at]) = tile.halves[half].mean_and_variance(i);
            means[at] += tile.light(i, &light, at)[half].0.as_dvec3();
        }
    }
    let mean = means.iter().sum::<DVec3>() / means.len().max(1) as f64;
    let floor = film::error_floor(film::luminance(mean));
    let smooth = pooled(&means, width, MEAN_RADIUS).into_par_iter().zip(variances);
    let relative: Vec<f64> = smooth.map(|(m, v)| (v / (m * m + floor)).dot(DVec3::splat(1.0 / 3.0))).collect();
    let windows = RADII.map(|radius| pooled(&relative, width, radius));
    let root = 1.0 / RADII.len() as f64;
    // roots first: products could leave what numbers can hold
    let geometric_mean = |i: usize| windows.iter().map(|window| window[i].powf(root)).product::<f64>();
    let all: Vec<f64> = (0..relative.len()).into_par_iter().map(geometric_mean).collect();
    // the mean of the smallest windows is not biased
    let (of_smallest, of_all) = (windows[0].iter().sum::<f64>(), all.iter().sum::<f64>());
    let scale = if of_all > 0.0 { of_smallest / of_all } else { 1.0 };
    all.into_par_iter().map(|v| v * scale).collect()
}

/// In place of each pixel's value the mean of its tile's.
fn means_of_tiles(film: &Film, values: &[f64]) -> Vec<f64> {
    let mut means = vec![0.0; values.len()];
    for index in 0..film.tile_count() {
        let rect = film.tile(index).rect;
        let count = rect.width * rect.height;
        let places = || (0..count).map(|i| rect.place(i)).map(|[x, y]| y * film.desc().width + x);
        let mean = places().map(|at| values[at]).sum::<f64>() / count as f64;
        places().for_each(|at| means[at] = mean);
    }
    means
}

/// Means over windows of 2 · `radius` + 1 pixels square, cut at the borders.
fn pooled<T>(plane: &[T], width: usize, radius: usize) -> Vec<T>
where
    T: Copy + Send + Sync + Sum + Div<f64, Output = T>,
{
    let height = plane.len() / width.max(1);
    let window = |at: usize, size: usize| at.saturating_sub(radius)..(at + radius + 1).min(size);
    let along: Vec<T> = (0..plane.len())
        .into_par_iter()
        .map(|i| {
            let (row, columns) = (i / width * width, window(i % width, width));
            let count = columns.len() as f64;
            plane[row + columns.start..row + columns.end].iter().copied().sum::<T>() / count
        })
        .collect();
    let across = |i: usize| {
        let rows = window(i / width, height);
        let count = rows.len() as f64;
        rows.map(|y| along[y * width + i % width]).sum::<T>() / count
    };
    (0..plane.len()).into_par_iter().map(across).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::FilmDesc;
    use crate::{Aov, film};
    use umber_math::Rgb;

    /// A film whose left half is smooth and whose right half is noisy, by one half-buffer's pilot: what its two runs
    /// are off to either side.
    fn pilot_film(noisy: [f32; 2]) -> Film {
        let film = Film::new(FilmDesc::new(64, 32, &[Aov::Color]));
        for index in 0..film.tile_count() {
            let mut tile = film.tile(index);
            let rect = tile.rect;
            for (half, noisy) in noisy.into_iter().enumerate() {
                tile.halves[half].prepare(film::TILE * film::TILE, Some(4));
                for i in 0..film::TILE * film::TILE {
                    let spread = if rect.x + i % rect.width < 32 { 0.1 } else { noisy };
                    for sign in [1.0, 1.0, 1.0, 1.0, -1.0, -1.0, -1.0, -1.0] {
                        tile.halves[half].add(i, Rgb::splat(1.0 + sign * spread), 1.0);
                    }
                }
            }
        }
        film
    }

    #[test]
    fn counts_go_with_the_root_of_the_variance_and_meet_the_target() {
        let film = pilot_film([0.8, 0.8]);
        let plan = plan(&film, 0.002, 1 << 20, false);
        let (smooth, noisy) = (plan.counts(4, 4)[0], plan.counts(60, 4)[0]);
        // eight is a power of two: both counts lie at the same place in their octaves
        assert_eq!(noisy, 8 * smooth);
        for n in [smooth, noisy] {
            assert!(n.is_power_of_two() || n % 3 == 0 && (n / 3).is_power_of_two(), "{n}");
        }
        // means of runs of four are off by the spread: half of a squared difference of twice as much, times four
        let error = |spread: f64, n: u32| 8.0 * spread * spread / (2.0 * f64::from(n));
        let mean = 0.5 * (error(0.1, smooth) + error(0.8, noisy));
        // the next smaller counts, two thirds or three quarters of these, would not do
        assert!(mean <= 0.002 && mean * 4.0 / 3.0 > 0.002, "{mean}");
    }

    #[test]
    fn what_differs_within_a_run_alone_is_no_variance() {
        let film = Film::new(FilmDesc::new(4, 4, &[Aov::Color]));
        for half in &mut film.tile(0).halves {
            half.prepare(16, Some(4));
            for sign in [1.0, -1.0].repeat(4) {
                (0..16).for_each(|i| half.add(i, Rgb::splat(1.0 + 0.5 * sign), 1.0));
            }
        }
        assert_eq!(plan(&film, 1e-6, 100, false).bounds(), [16, 16]);
    }

    #[test]
    fn all_pixels_of_a_tile_get_the_same_counts_where_they_are_to() {
        let film = pilot_film([0.8, 0.8]);
        let counts = |by_tile: bool| {
            let plan = plan(&film, 0.002, 1 << 20, by_tile);
            [16, 31, 32, 47, 48].map(|x| plan.counts(x, 20)[0])
        };
        let [a, b, c, d, e] = counts(true);
        assert!(a == b && c == d && b < c && c <= e, "{:?}", counts(true));
        let [a, b, ..] = counts(false);
        assert!(a < b, "{a} and {b}");
    }

    #[test]
    fn a_sample_beyond_all_measure_gets_its_pixel_more() {
        let film = pilot_film([0.8, 0.8]);
        for half in 0..2 {
            film.tile(0).halves[half].add(0, Rgb::splat(1e25), 1.0);
        }
        // of a mean that is as large nothing else has an error
        let plan = plan(&film, 0.0002, 1000, false);
        assert_eq!(plan.counts(0, 0), [500, 500]);
        assert_eq!(plan.counts(60, 30), [8, 8]);
    }

    #[test]
    fn each_half_is_decided_by_the_other() {
        let film = pilot_film([0.8, 0.2]);
        let plan = plan(&film, 0.001, 1 << 20, false);
        let other = super::plan(&pilot_film([0.1, 0.2]), 0.001, 1 << 20, false);
        for x in [0, 31, 40, 63] {
            assert_eq!(plan.counts(x, 9)[0], other.counts(x, 9)[0]);
        }
        assert!(plan.counts(60, 9)[1] > other.counts(60, 9)[1]);
    }

    #[test]
    fn counts_stay_within_bounds() {
        let film = pilot_film([0.5, 0.5]);
        assert_eq!(plan(&film, 0.0, 100, false).bounds(), [100, 100]);
        assert_eq!(plan(&film, 1.0, 100, false).bounds(), [16, 16]);
        assert_eq!(plan(&film, 0.0, 1, false).bounds(), [1, 1]);
        assert_eq!(plan(&film, 0.0, 100, false).total(), 100 * 64 * 32);
        assert_eq!((pilot(1), pilot(64), pilot(1 << 20)), (1, 16, 16));
    }
}
