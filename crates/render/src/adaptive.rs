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
//! of a pixel's relative variance per sample takes the fewest samples (Neyman 1934). Equal error everywhere
//! would take as many as equal counts: the n ∝ v rule has mean error t at mean count E[v] / t, as n = const has.

use rayon::prelude::*;

use crate::film::Film;

/// Pixels to each side over which variance is pooled: pixels that saw no spike yet learn from those that did.
const RADIUS: usize = 2;
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
        deciding.par_iter().map(|v| count(*v, scale, [least[half], most[half]])).collect()
    };
    Plan { width: film.desc().width, counts: [counts(0), counts(1)] }
}

fn count(variance: f64, scale: f64, [least, most]: [u32; 2]) -> u32 {
    // the cast saturates
    ((scale * variance.sqrt()).ceil() as u32).clamp(least, most)
}

/// The factor between counts and the square roots of variances by which the mean of variance / (2 · count), the
/// error of a mean of two such halves, is `target`: least such factor, over a finely binned distribution.
fn scale(variances: &[f64], target: f64, bounds: [u32; 2]) -> f64 {
    let bins = (2.0 * OCTAVES * BINS_PER_OCTAVE) as usize;
    let mut population = vec![0u64; bins];
    for v in variances.iter().filter(|v| **v > 0.0) {
        population[((v.log2() + OCTAVES) * BINS_PER_OCTAVE).clamp(0.0, bins as f64 - 1.0) as usize] += 1;
    }
    // the upper end of a bin stands for all of it
    let of_bin = |bin: usize| ((bin + 1) as f64 / BINS_PER_OCTAVE - OCTAVES).exp2();
    let error = |scale: f64| {
        let of = |(bin, n): (usize, &u64)| {
            let v = of_bin(bin);
            *n as f64 * v / (2.0 * f64::from(count(v, scale, bounds)))
        };
        population.iter().enumerate().filter(|(_, n)| **n > 0).map(of).sum::<f64>() / variances.len().max(1) as f64
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

/// Relative variance of one sample, pixel by pixel, as one half shows it: pooled over a window, once as the mean
/// of the pixels' relative variances, once as the mean variance over the squared mean, whichever is more. The
/// first sees across edges, the second where few pixels met what all of them could have met.
fn spread(film: &Film, half: usize) -> Vec<f64> {
    let (width, height) = (film.desc().width, film.desc().height);
    let (mut means, mut variances) = (vec![0.0; width * height], vec![0.0; width * height]);
    for index in 0..film.tile_count() {
        let tile = film.tile(index);
        for i in 0..tile.rect.width * tile.rect.height {
            let at = (tile.rect.y + i / tile.rect.width) * width + tile.rect.x + i % tile.rect.width;
            let sum = tile.sums(i)[half];
            (means[at], variances[at]) = (sum.luminance(), sum.luminance_variance());
        }
    }
    let mean = means.iter().sum::<f64>() / means.len().max(1) as f64;
    let floor = (0.01 * mean).powi(2).max(f64::MIN_POSITIVE);
    let relative: Vec<f64> = means.iter().zip(&variances).map(|(m, v)| v / (m * m + floor)).collect();
    let [means, variances, relative] = [means, variances, relative].map(|plane| pooled(&plane, width));
    let pixels = means.into_par_iter().zip(variances).zip(relative);
    pixels.map(|((m, v), r)| r.max(v / (m * m + floor))).collect()
}

/// Means over windows of 2 · `RADIUS` + 1 pixels square, cut at the borders.
fn pooled(plane: &[f64], width: usize) -> Vec<f64> {
    let height = plane.len() / width.max(1);
    let window = |at: usize, size: usize| at.saturating_sub(RADIUS)..(at + RADIUS + 1).min(size);
    let mean = |values: &mut dyn Iterator<Item = f64>, n: usize| values.sum::<f64>() / n as f64;
    let along: Vec<f64> = (0..plane.len())
        .into_par_iter()
        .map(|i| {
            let (row, columns) = (i / width * width, window(i % width, width));
            mean(&mut plane[row + columns.start..row + columns.end].iter().copied(), columns.len())
        })
        .collect();
    let across = |i: usize| {
        let rows = window(i / width, height);
        mean(&mut rows.clone().map(|y| along[y * width + i % width]), rows.len())
    };
    (0..plane.len()).into_par_iter().map(across).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{FilmDesc, PixelSum};
    use crate::{Aov, film};
    use umber_math::Rgb;

    /// A film whose left half is smooth and whose right half is noisy, by one half-buffer's pilot.
    fn pilot_film(noisy: [f32; 2]) -> Film {
        let film = Film::new(FilmDesc::new(64, 32, &[Aov::Color]));
        for index in 0..film.tile_count() {
            let mut tile = film.tile(index);
            let rect = tile.rect;
            for (half, noisy) in noisy.into_iter().enumerate() {
                let sums = (0..film::TILE * film::TILE).map(|i| {
                    let spread = if rect.x + i % rect.width < 32 { 0.1 } else { noisy };
                    let mut sum = PixelSum::default();
                    for k in 0..8 {
                        sum.add(Rgb::splat(if k % 2 == 0 { 1.0 + spread } else { 1.0 - spread }), 1.0);
                    }
                    sum
                });
                tile.halves[half] = sums.collect();
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
