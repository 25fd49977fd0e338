//! Adaptive sampling: how many samples each pixel gets, so that a given mean error costs the least.
//!
//! Pixels have two colours, as squares of a chessboard. After a pilot of equal counts everywhere, one decision is made:
//! the counts of the pixels of one colour follow from the pilot of those of the *other*, which lie all around them.
//!
//! So no bias: pixels of different colours share no sample, so that, given the other pixels, a pixel's count is a
//! constant, and the mean of a fixed number of its samples is unbiased. A rule that looked at the samples it keeps would
//! end where they happen to be dark (Kirk & Arvo 1991, "Unbiased sampling techniques for image synthesis"). Pixels that
//! share paths do so with those of their colour; light paths are two sets, of which each goes on by the counts of one
//! colour, and they count the same.
//!
//! A pixel's own samples could decide about each other only in halves that are independent, each spread over the pixel by
//! itself. That takes more of them than one sequence does, the more so the better such a sequence is.
//!
//! Of all allocations with the same mean relative variance, the one with counts proportional to the square root of a
//! pixel's relative variance, per sample, takes the fewest (Neyman 1934). Equal error everywhere would take as many
//! samples as equal counts: the n ∝ v rule has mean error t at mean count E[v] / t, as n = const has. Where samples
//! differ in cost, the square root is that of variance over cost, for which rays stand ([`weight`]).

mod estimate;

use umber_sampling::Sampler;

use crate::film::Film;
use estimate::{Estimate, estimates};

/// Samples of the pilot, a pixel. 32 tell more, and took 1.03 (metal) to 1.1 times (chess) as many rays, measured when
/// the halves of a pixel decided: they are too many where little is to be seen.
const PILOT: u32 = 16;
/// Bins of the distribution of weights, an octave.
const BINS_PER_OCTAVE: f64 = 16.0;
/// Octaves of weight that are told apart, from 2^-`OCTAVES` to 2^`OCTAVES`.
const OCTAVES: f64 = 32.0;

/// Samples of each pixel.
#[derive(Debug)]
pub(crate) struct Plan {
    width: usize,
    pilot: u32,
    counts: Vec<u32>,
}

impl Plan {
    /// Samples of the pilot.
    pub fn pilot(&self) -> u32 {
        self.pilot
    }
    /// After a whole pilot, as many samples as said of the pixels at columns and rows of a film of a size.
    #[cfg(test)]
    pub fn of([width, height]: [usize; 2], count: impl Fn([usize; 2]) -> u32) -> Self {
        let counts = (0..width * height).map(|i| count([i % width, i / width])).collect();
        Self { width, pilot: PILOT, counts }
    }
    /// Samples of the pixel at column `x` and row `y`.
    pub fn count(&self, x: usize, y: usize) -> u32 {
        self.counts[y * self.width + x]
    }
    /// Samples of all pixels.
    pub fn total(&self) -> u64 {
        self.counts.iter().map(|n| u64::from(*n)).sum()
    }
    /// Smallest and largest count of a pixel.
    pub fn bounds(&self) -> [u32; 2] {
        let counts = || self.counts.iter().copied();
        [counts().min().unwrap_or(0), counts().max().unwrap_or(0)]
    }
}

/// Samples of a pilot where a pixel gets at most `most`.
pub(crate) fn pilot(most: u32) -> u32 {
    PILOT.min(most)
}

/// In which half of a pixel's samples one is, by its number: halves are made of runs, the first two of a pilot of so many.
pub(crate) fn half(pilot: u32, number: u32) -> usize {
    (number / (pilot / 2).max(1) % 2) as usize
}

/// The colour, 0 or 1, of the pixel at a column and a row.
#[inline]
pub(crate) fn color([x, y]: [usize; 2]) -> usize {
    (x + y) % 2
}

/// The points of sample number `sample` of a pixel of the view, with blue noise over the pixels of each colour: these
/// make a lattice of their own, turned by an eighth, with a mask of its own.
pub(crate) fn blue_noise(seed: u64, pixel: [u32; 2], sample: u32) -> Sampler {
    let [x, y] = pixel.map(u32::cast_signed);
    let (sum, difference) = (x.wrapping_add(y), x.wrapping_sub(y));
    let color = u64::from(sum.cast_unsigned() % 2);
    Sampler::blue_noise((color + 1) << 32 | seed, [sum >> 1, difference >> 1].map(i32::cast_unsigned), sample)
}

/// The plan by which the mean of the pixels' relative variances is `target`, as far as `most` samples a pixel
/// allow. `film` holds the pilot. `by_tile`: whether all pixels of a tile and a colour get the same counts.
pub(crate) fn plan(film: &Film, target: f32, most: u32, by_tile: bool) -> Plan {
    let (width, height) = (film.desc().width, film.desc().height);
    let pilot = pilot(most);
    // a single pixel has no other to learn from
    let mut counts = vec![most; width * height];
    for of in 0..2 {
        let is_of = |i: &usize| color([i % width, i / width]) == of;
        let estimates = estimates(film, of, by_tile);
        let theirs: Vec<Estimate> = (0..estimates.len()).filter(is_of).map(|i| estimates[i]).collect();
        let scale = scale(&theirs, target.into(), [pilot, most]);
        for i in (0..estimates.len()).filter(is_of) {
            counts[i] = count(weight(&estimates[i]), scale, [pilot, most]);
        }
    }
    Plan { width, pilot, counts }
}

/// What the square of a pixel's count is to be in proportion to: its variance over the root of its rays, as these are
/// part of the cost. Over the rays themselves it takes 1.03 times as long to the same error on the chess set and 1.01 on
/// metal; by variances alone, which rays have no part in either, 1.05 on both.
fn weight(pixel: &Estimate) -> f64 {
    pixel.variance / pixel.rays.sqrt()
}

/// Samples of a pixel: a power of two, or one and a half times that, as points of so many are spread more evenly than
/// of others.
fn count(weight: f64, scale: f64, [least, most]: [u32; 2]) -> u32 {
    let wanted = (scale * weight.sqrt()).max(1.0);
    let step = 0.5 * wanted.log2().floor().exp2();
    // the cast saturates
    (((wanted / step).round() * step) as u32).clamp(least, most)
}

/// The factor between counts and the square roots of weights by which the mean of variance / count is `target`: least
/// such factor, over a finely binned distribution of weights.
fn scale(pixels: &[Estimate], target: f64, bounds: [u32; 2]) -> f64 {
    let bins = (2.0 * OCTAVES * BINS_PER_OCTAVE) as usize;
    let mut sums = vec![0.0; bins];
    for pixel in pixels.iter().filter(|pixel| pixel.variance > 0.0) {
        let bin = (weight(pixel).log2() + OCTAVES) * BINS_PER_OCTAVE;
        sums[bin.clamp(0.0, bins as f64 - 1.0) as usize] += pixel.variance;
    }
    // the lower end of a bin stands for all of it
    let of_bin = |bin: usize| (bin as f64 / BINS_PER_OCTAVE - OCTAVES).exp2();
    let error = |scale: f64| {
        let of = |(bin, v): (usize, &f64)| v / f64::from(count(of_bin(bin), scale, bounds));
        sums.iter().enumerate().filter(|(_, v)| **v > 0.0).map(of).sum::<f64>() / pixels.len().max(1) as f64
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::FilmDesc;
    use crate::light_tracing::Splat;
    use crate::{Aov, film};
    use std::collections::HashSet;
    use std::ops::Range;
    use umber_math::Rgb;

    /// A film by what the halves of a pixel are off to either side, by its place, and the rays that it took.
    fn pilot_film(spread: impl Fn([usize; 2]) -> f32, rays: impl Fn([usize; 2]) -> u64) -> Film {
        let film = Film::new(FilmDesc::new(64, 32, &[Aov::Color]));
        for index in 0..film.tile_count() {
            let mut tile = film.tile(index);
            let rect = tile.rect;
            tile.samples.prepare(film::TILE * film::TILE, 2);
            for i in 0..film::TILE * film::TILE {
                for number in 0..PILOT {
                    let half = half(PILOT, number);
                    let off = [1.0, -1.0][half] * spread(rect.place(i));
                    tile.samples.add(i, half, Rgb::splat(1.0 + off), 1.0);
                }
                tile.samples.add_rays(i, rays(rect.place(i)));
            }
        }
        film
    }

    /// Noisy by so much on the right, and smooth on the left.
    fn noisy_right(noisy: f32) -> Film {
        pilot_film(|[x, _]| if x < 32 { 0.05 } else { noisy }, |_| 40)
    }

    #[test]
    fn counts_go_with_the_root_of_the_variance_and_meet_the_target() {
        let plan = plan(&noisy_right(0.4), 0.002, 1 << 20, false);
        let (smooth, noisy) = (plan.count(4, 4), plan.count(60, 4));
        // eight is a power of two: both counts lie at the same place in their octaves
        assert_eq!(noisy, 8 * smooth);
        for n in [smooth, noisy] {
            assert!(n.is_power_of_two() || n % 3 == 0 && (n / 3).is_power_of_two(), "{n}");
        }
        // the mean of 16 is off by what it is off to either side
        let error = |spread: f64, n: u32| 16.0 * spread * spread / f64::from(n);
        let mean = 0.5 * (error(0.05, smooth) + error(0.4, noisy));
        // the next smaller counts, two thirds or three quarters of these, would not do
        assert!(mean <= 0.002 && mean * 4.0 / 3.0 > 0.002, "{mean}");
    }

    #[test]
    fn what_differs_within_a_half_alone_is_no_variance() {
        let film = Film::new(FilmDesc::new(4, 4, &[Aov::Color]));
        {
            let mut tile = film.tile(0);
            tile.samples.prepare(16, 2);
            for number in 0..16 {
                let sign = [1.0, -1.0][number as usize % 2];
                (0..16).for_each(|i| tile.samples.add(i, half(16, number), Rgb::splat(1.0 + 0.5 * sign), 1.0));
            }
        }
        assert_eq!(plan(&film, 1e-6, 100, false).bounds(), [16, 16]);
    }

    #[test]
    fn all_pixels_of_a_tile_and_a_color_get_the_same_counts_where_they_are_to() {
        let film = noisy_right(0.4);
        let counts = |by_tile: bool, y: usize| {
            let plan = plan(&film, 0.002, 1 << 20, by_tile);
            [16, 30, 32, 46, 48].map(|x| plan.count(x, y))
        };
        for y in [20, 21] {
            let [a, b, c, d, e] = counts(true, y);
            assert!(a == b && c == d && b < c && c <= e, "{:?}", counts(true, y));
            let [a, b, ..] = counts(false, y);
            assert!(a < b, "{a} and {b}");
        }
    }

    #[test]
    fn a_sample_beyond_all_measure_gets_the_pixels_around_more() {
        let film = noisy_right(0.4);
        film.tile(0).samples.add(0, 0, Rgb::splat(1e25), 1.0);
        // of a mean that is as large nothing else has an error
        let plan = plan(&film, 0.0002, 1000, false);
        assert_eq!([plan.count(1, 0), plan.count(0, 1)], [1000, 1000]);
        assert_eq!([plan.count(60, 31), plan.count(31, 2)], [16, 16]);
        // nor does the pixel decide about itself
        assert!(plan.count(0, 0) > 16);
    }

    /// Whatever its own samples are, and those of all others of its colour.
    #[test]
    fn each_color_is_decided_by_the_other() {
        let right = |[x, _]: [usize; 2], noisy: f32| if x < 32 { 0.05 } else { noisy };
        let first = pilot_film(|p| right(p, if color(p) == 0 { 0.4 } else { 0.1 }), |p| 40 + 9 * color(p) as u64);
        let other = pilot_film(|p| if color(p) == 0 { 0.2 } else { right(p, 0.1) }, |p| 40 + 9 * color(p) as u64);
        let more_rays = pilot_film(|p| right(p, 0.1), |p| if color(p) == 0 { (p[0] * p[1]) as u64 } else { 49 });
        for by_tile in [false, true] {
            let [plan, other, more_rays] = [&first, &other, &more_rays].map(|film| plan(film, 0.001, 1 << 20, by_tile));
            for (x, y) in [(0, 0), (31, 9), (40, 10), (63, 31)] {
                assert_eq!(color([x, y]), 0);
                assert_eq!([plan.count(x, y), plan.count(x, y)], [other.count(x, y), more_rays.count(x, y)]);
            }
            assert!(plan.count(50, 9) > plan.count(50, 10));
        }
    }

    #[test]
    fn each_color_is_decided_with_the_light_paths_of_the_other() {
        let counts = |image: Option<usize>| {
            let film = noisy_right(0.4);
            if let Some(image) = image {
                // some pixels of either colour
                let splat = |i: u32| Splat { pixel: 64 * (i / 4) + 40 + i % 4, radiance: Rgb::splat(9.0) };
                film.light()[image].add(1, &(0..16).map(splat).collect::<Vec<_>>(), 64 * 32, 0);
            }
            let plan = plan(&film, 0.002, 1 << 20, false);
            [0, 1].map(|of| {
                let places = (0..64 * 32).map(|i| [i % 64, i / 64]).filter(|place| color(*place) == of);
                places.map(|[x, y]| plan.count(x, y)).collect::<Vec<_>>()
            })
        };
        let [dark, first, second] = [None, Some(0), Some(1)].map(counts);
        assert!(first[0] == dark[0] && first[1] != dark[1]);
        assert!(second[1] == dark[1] && second[0] != dark[0]);
    }

    #[test]
    fn dear_pixels_get_fewer_samples_than_others_of_their_variance() {
        // far from the border windows see one side alone
        let film = pilot_film(|_| 0.2, |[x, _]| if x < 32 { 30 } else { 30 * 256 });
        let plan = plan(&film, 0.0005, 1 << 20, false);
        assert_eq!(plan.count(4, 9), 4 * plan.count(60, 9));
    }

    #[test]
    fn beside_a_noisy_thing_what_takes_few_rays_is_not_taken_to_be_noisy() {
        let noisy = |[x, _]: [usize; 2]| if x < 32 { 0.0 } else { 0.4 };
        let [alike, told_apart] = [40, 10].map(|rays| {
            let film = pilot_film(noisy, |[x, _]| if x < 32 { rays } else { 40 });
            plan(&film, 0.0001, 1 << 20, false).count(30, 9)
        });
        assert!(alike > told_apart, "{alike} and {told_apart}");
    }

    #[test]
    fn counts_stay_within_bounds() {
        let film = noisy_right(0.25);
        assert_eq!(plan(&film, 0.0, 100, false).bounds(), [100, 100]);
        assert_eq!(plan(&film, 1.0, 100, false).bounds(), [16, 16]);
        assert_eq!(plan(&film, 0.0, 1, false).bounds(), [1, 1]);
        assert_eq!(plan(&film, 0.0, 100, false).total(), 100 * 64 * 32);
        assert_eq!((pilot(1), pilot(64), pilot(1 << 20)), (1, 16, 16));
        // of a single pixel nothing tells
        let single = Film::new(FilmDesc::new(1, 1, &[Aov::Color]));
        single.tile(0).samples.prepare(1, 2);
        assert_eq!(plan(&single, 0.1, 100, true).bounds(), [100, 100]);
    }

    #[test]
    fn halves_are_runs_of_half_a_pilot() {
        let halves = |pilot, numbers: Range<u32>| numbers.map(|n| half(pilot, n)).collect::<Vec<_>>();
        assert_eq!(halves(16, 6..18), [0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0]);
        assert_eq!(halves(3, 0..4), [0, 1, 0, 1]);
        assert_eq!(halves(1, 0..2), [0, 1]);
    }

    /// No two pixels have the same points, left and below of the view's corner either.
    #[test]
    fn each_pixel_has_blue_noise_of_its_own() {
        let pixels = (0..40 * 40).map(|i: i32| [(i % 40 - 20).cast_unsigned(), (i / 40 - 20).cast_unsigned()]);
        let points = pixels.map(|pixel| {
            let mut sampler = blue_noise(7, pixel, 3);
            [0; 4].map(|_: i32| sampler.next_1d().to_bits())
        });
        assert_eq!(points.collect::<HashSet<_>>().len(), 40 * 40);
    }
}
