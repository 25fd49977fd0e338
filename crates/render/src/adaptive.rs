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
//! Of all allocations with the same mean relative variance, the one with counts proportional to the square root
//! of a pixel's relative variance over its cost, per sample, costs the least (Neyman 1934). Equal error everywhere
//! would take as many samples as equal counts: the n ∝ v rule has mean error t at mean count E[v] / t, as n = const
//! has. What a sample costs is told by its rays: they are the same each time, as seconds are not.

use std::iter::Sum;
use std::ops::Div;

use glam::DVec3;
use rayon::prelude::*;

use crate::film::{self, Film};

/// Pixels to each side over which means and, in two windows, relative variances are pooled.
///
/// Chosen by the variance that is left of that of equal counts, at as many samples, of four scenes (metal with caustics,
/// a Cornell box, many lights, chess; the variances themselves, pooled over 2, would divide it by 2.4, 1.6, 1.8, 3.5):
/// this divides it by 1.68, 1.50, 1.37, 2.53, a far window of 8 by 1.60, 1.51, 1.37, 2.55, of 16 by 1.72, 1.50, 1.35, 2.51.
/// Windows that end where prims or normals change (16, with the near one) by 1.72, 1.51, 1.37, 2.39.
const MEAN_RADIUS: usize = 3;
const NEAR_RADIUS: usize = 2;
const FAR_RADIUS: usize = 12;
/// Samples of the pilot, a pixel, in both halves together.
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
/// allow. `film` holds the pilot.
pub(crate) fn plan(film: &Film, target: f32, most: u32) -> Plan {
    let least = halves(pilot(most));
    let most = halves(most);
    let spreads = [0, 1].map(|half| spread(film, half));
    let counts = |half: usize| {
        let deciding = &spreads[1 - half];
        let scale = scale(deciding, target.into(), [least[half], most[half]]);
        deciding.par_iter().map(|s| count(s.worth(), scale, [least[half], most[half]])).collect()
    };
    Plan { width: film.desc().width, counts: [counts(0), counts(1)] }
}

/// What one more sample of a pixel is about.
#[derive(Clone, Copy)]
struct Spread {
    /// Relative variance of one sample.
    variance: f64,
    /// What one sample costs.
    cost: f64,
}

impl Spread {
    /// Counts go with its square root.
    fn worth(self) -> f64 {
        self.variance / self.cost
    }
}

fn count(worth: f64, scale: f64, [least, most]: [u32; 2]) -> u32 {
    // the cast saturates
    ((scale * worth.sqrt()).ceil() as u32).clamp(least, most)
}

/// The factor between counts and the square roots of worths by which the mean of variance / (2 · count), the
/// error of a mean of two such halves, is `target`: least such factor, over a finely binned distribution.
fn scale(spreads: &[Spread], target: f64, bounds: [u32; 2]) -> f64 {
    let bins = (2.0 * OCTAVES * BINS_PER_OCTAVE) as usize;
    let mut variances = vec![0.0; bins];
    for s in spreads.iter().filter(|s| s.worth() > 0.0) {
        variances[((s.worth().log2() + OCTAVES) * BINS_PER_OCTAVE).clamp(0.0, bins as f64 - 1.0) as usize] +=
            s.variance;
    }
    // the lower end of a bin stands for all of it
    let of_bin = |bin: usize| (bin as f64 / BINS_PER_OCTAVE - OCTAVES).exp2();
    let error = |scale: f64| {
        let of = |(bin, v): (usize, &f64)| v / (2.0 * f64::from(count(of_bin(bin), scale, bounds)));
        variances.iter().enumerate().filter(|(_, v)| **v > 0.0).map(of).sum::<f64>() / spreads.len().max(1) as f64
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

/// Relative variance of one sample, the mean of its channels, and its cost, pixel by pixel, as one half shows them.
///
/// The variance is pooled over two windows, of which the geometric mean counts: the small one keeps edges, the large one learns of
/// spikes that few pixels met where all could have. Its mean is that of the small window, which is not biased.
fn spread(film: &Film, half: usize) -> Vec<Spread> {
    let (width, height) = (film.desc().width, film.desc().height);
    let (mut means, mut variances) = (vec![DVec3::ZERO; width * height], vec![DVec3::ZERO; width * height]);
    let mut costs = vec![1.0; width * height];
    for index in 0..film.tile_count() {
        let tile = film.tile(index);
        for i in 0..tile.rect.width * tile.rect.height {
            let at = (tile.rect.y + i / tile.rect.width) * width + tile.rect.x + i % tile.rect.width;
            let (sum, spread) = tile.halves[half].pixel(i);
            (means[at], variances[at], costs[at]) = (sum.radiance(), spread.variance(&sum), spread.cost(&sum));
        }
    }
    let mean = means.iter().sum::<DVec3>() / means.len().max(1) as f64;
    let floor = film::error_floor(film::luminance(mean));
    let smooth = pooled(&means, width, MEAN_RADIUS).into_par_iter().zip(variances);
    let relative: Vec<f64> = smooth.map(|(m, v)| (v / (m * m + floor)).dot(DVec3::splat(1.0 / 3.0))).collect();
    let [near, far] = [NEAR_RADIUS, FAR_RADIUS].map(|radius| pooled(&relative, width, radius));
    let both: Vec<f64> = near.par_iter().zip(far).map(|(a, b)| (a * b).sqrt()).collect();
    let (of_near, of_both) = (near.iter().sum::<f64>(), both.iter().sum::<f64>());
    let scale = if of_both > 0.0 { of_near / of_both } else { 1.0 };
    both.into_par_iter().zip(costs).map(|(v, cost)| Spread { variance: v * scale, cost }).collect()
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

    /// A film whose left half is smooth and whose right half is noisy, by one half-buffer's pilot.
    fn pilot_film(noisy: [f32; 2]) -> Film {
        let film = Film::new(FilmDesc::new(64, 32, &[Aov::Color]));
        for index in 0..film.tile_count() {
            let mut tile = film.tile(index);
            let rect = tile.rect;
            for (half, noisy) in noisy.into_iter().enumerate() {
                tile.halves[half].prepare(film::TILE * film::TILE, true);
                for i in 0..film::TILE * film::TILE {
                    let spread = if rect.x + i % rect.width < 32 { 0.1 } else { noisy };
                    for sign in [1.0, -1.0].repeat(4) {
                        tile.halves[half].add(i, Rgb::splat(1.0 + sign * spread), 1.0, 1);
                    }
                }
            }
        }
        film
    }

    #[test]
    fn counts_go_with_the_root_of_the_variance_and_meet_the_target() {
        let film = pilot_film([0.8, 0.8]);
        let plan = plan(&film, 0.002, 1 << 20);
        let (smooth, noisy) = (plan.counts(4, 4)[0], plan.counts(60, 4)[0]);
        let ratio = f64::from(noisy) / f64::from(smooth);
        assert!((ratio / 8.0 - 1.0).abs() < 0.15, "{smooth} and {noisy}");
        // variance of a sample: (8 / 7) · spread²
        let error = |spread: f64, n: u32| 8.0 / 7.0 * spread * spread / (2.0 * f64::from(n));
        let mean = 0.5 * (error(0.1, smooth) + error(0.8, noisy));
        assert!(mean <= 0.002 && mean > 0.0015, "{mean}");
    }

    #[test]
    fn a_sample_beyond_all_measure_gets_its_pixel_more() {
        let film = pilot_film([0.8, 0.8]);
        for half in 0..2 {
            film.tile(0).halves[half].add(0, Rgb::splat(1e25), 1.0, 1);
        }
        let plan = plan(&film, 0.002, 1000);
        assert_eq!(plan.counts(0, 0), [500, 500]);
    }

    #[test]
    fn each_half_is_decided_by_the_other() {
        let film = pilot_film([0.8, 0.2]);
        let plan = plan(&film, 0.001, 1 << 20);
        let other = super::plan(&pilot_film([0.1, 0.2]), 0.001, 1 << 20);
        for x in [0, 31, 40, 63] {
            assert_eq!(plan.counts(x, 9)[0], other.counts(x, 9)[0]);
        }
        assert!(plan.counts(60, 9)[1] > other.counts(60, 9)[1]);
    }

    #[test]
    fn counts_stay_within_bounds() {
        let film = pilot_film([0.5, 0.5]);
        assert_eq!(plan(&film, 0.0, 100).bounds(), [100, 100]);
        assert_eq!(plan(&film, 1.0, 100).bounds(), [16, 16]);
        assert_eq!(plan(&film, 0.0, 1).bounds(), [1, 1]);
        assert_eq!(plan(&film, 0.0, 100).total(), 100 * 64 * 32);
        assert_eq!((pilot(1), pilot(64), pilot(1 << 20)), (1, 16, 16));
    }
}
