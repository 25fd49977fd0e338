//! Owen-scrambled Sobol points by hashing.
//!
//! Burley 2020, "Practical Hash-based Owen Scrambling", JCGT 9(4): two-dimensional Sobol points, padded:
//! each set of dimensions shuffles the sample index and scrambles each dimension with its own seed, so that
//! sets are independent while each keeps the stratification of a (0, 2)-sequence. The mixing constants of
//! the Laine-Karras permutation are Vegdahl's 2021 improvement.
//!
//! Pixels are independent, or their error is blue noise: neighbours' samples then differ as far as they can.

use glam::Vec2;

use crate::blue_noise::PixelMask;
use crate::hash::mix;

/// Random access to the sample points of one pixel: a point is a function of seed, pixel, sample number and dimension.
///
/// Its only state is the number of the next dimension set. Any prefix of 2ᵏ samples is stratified.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    scramble_seed: u32,
    /// Bit-reversed sample number: what nested scrambling works on.
    reversed_index: u32,
    set: u32,
    /// Where the pixel's first sample is to be, if not anywhere.
    first: Option<PixelMask>,
}

impl Sampler {
    /// The points of sample number `sample` in a pixel (raster coordinates), starting at dimension set 0.
    ///
    /// Pixels are independent: the error over pixels is white noise.
    #[inline]
    pub fn new(seed: u64, pixel: [u32; 2], sample: u32) -> Self {
        Self::scrambled(seed_hash(seed), pixel, sample)
    }

    /// The same with blue noise over pixels: neighbours' samples differ, so that the eye averages the error of a picture
    /// of few samples. A pixel by itself has points as good as those of [`Sampler::new`], at more cost.
    ///
    /// Sample number 0 is where a blue-noise mask has it (Georgiev & Fajardo 2016, "Blue-noise dithered sampling"), the
    /// same in pixels 64 apart. All of the pixel's points move with it by a digital shift (exclusive or with a constant),
    /// which keeps every elementary interval; but for that move, pixels are independent. Over seeds, each point is uniform.
    /// Dimension sets are told apart up to 2³¹.
    #[inline(never)]
    pub fn blue_noise(seed: u64, pixel: [u32; 2], sample: u32) -> Self {
        let seed = seed_hash(seed);
        let first = Some(PixelMask::new(mix(seed ^ MASK), pixel));
        Self { first, ..Self::scrambled(seed, pixel, sample) }
    }

    #[inline]
    fn scrambled(seed: u32, place: [u32; 2], sample: u32) -> Self {
        let mut h = mix(seed ^ place[0]);
        h = mix(h.wrapping_mul(0x85eb_ca6b) ^ place[1]);
        Self { scramble_seed: h, reversed_index: sample.reverse_bits(), set: 0, first: None }
    }

    /// Goes to a dimension set; each `next_…` takes one set.
    ///
    /// A user that starts every bounce at a fixed set keeps the dimensions of one bounce from shifting those of another.
    #[inline]
    pub fn start_dimension(&mut self, set: u32) {
        self.set = set;
    }

    /// The next number in [0, 1). Takes one dimension set.
    #[inline(always)]
    pub fn next_1d(&mut self) -> f32 {
        let (set, seed) = self.next_set();
        match self.first {
            None => unit_float(point_1d(self.reversed_index, seed)),
            Some(first) => first.moved_1d(self.reversed_index, set, seed),
        }
    }

    /// The next point in [0, 1)². Takes one dimension set.
    #[inline(always)]
    pub fn next_2d(&mut self) -> Vec2 {
        let (set, seed) = self.next_set();
        match self.first {
            None => unit_point(point_2d(self.reversed_index, seed)),
            Some(first) => first.moved_2d(self.reversed_index, set, seed),
        }
    }

    /// The next set and its seed.
    #[inline]
    fn next_set(&mut self) -> (u32, u32) {
        let set = self.set;
        self.set = set.wrapping_add(1);
        (set, mix(self.scramble_seed ^ set.wrapping_mul(0x9e37_79b9)))
    }
}

impl PixelMask {
    // neither is to make the other way's code larger
    #[cold]
    #[inline(never)]
    fn moved_1d(self, reversed_index: u32, set: u32, seed: u32) -> f32 {
        let move_by = point_1d(0, seed) ^ self.value(set.wrapping_mul(2));
        unit_float(point_1d(reversed_index, seed) ^ move_by)
    }
    #[cold]
    #[inline(never)]
    fn moved_2d(self, reversed_index: u32, set: u32, seed: u32) -> Vec2 {
        let ([x, y], [first_x, first_y]) = (point_2d(reversed_index, seed), point_2d(0, seed));
        let dimension = set.wrapping_mul(2);
        unit_point([x ^ first_x ^ self.value(dimension), y ^ first_y ^ self.value(dimension + 1)])
    }
}

const DIMENSION_0: u32 = 0x68bc_21eb;
const DIMENSION_1: u32 = 0x02e5_be93;
const MASK: u32 = 0x2545_f491;
#[inline]
fn seed_hash(seed: u64) -> u32 {
    mix(mix(seed as u32 ^ 0x9e37_79b9) ^ (seed >> 32) as u32)
}

/// The number of a bit-reversed sample number, in units of 2⁻³².
#[inline]
fn point_1d(reversed_index: u32, seed: u32) -> u32 {
    // Bit-reversed van der Corput points are the index itself.
    let reversed = owen_reversed(reversed_index, seed);
    owen_reversed(reversed.reverse_bits(), mix(seed ^ DIMENSION_0)).reverse_bits()
}

/// The point of a bit-reversed sample number, in units of 2⁻³².
#[inline]
fn point_2d(reversed_index: u32, seed: u32) -> [u32; 2] {
    let index = owen_reversed(reversed_index, seed).reverse_bits();
    let x = owen_reversed(index, mix(seed ^ DIMENSION_0)).reverse_bits();
    let y = owen_reversed(sobol_1_reversed(index), mix(seed ^ DIMENSION_1)).reverse_bits();
    [x, y]
}

/// Owen scrambling of a bit-reversed number; the result is bit-reversed as well.
///
/// Every bit is flipped by a hash of the bits below it (above it, once reversed).
#[inline]
fn owen_reversed(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// Second Sobol dimension, bit-reversed: the index times the Pascal matrix modulo two.
#[inline]
fn sobol_1_reversed(index: u32) -> u32 {
    let mut v = index;
    v ^= (v & 0xffff_0000) >> 16;
    v ^= (v & 0xff00_ff00) >> 8;
    v ^= (v & 0xf0f0_f0f0) >> 4;
    v ^= (v & 0xcccc_cccc) >> 2;
    v ^ (v & 0xaaaa_aaaa) >> 1
}

#[inline]
fn unit_point([x, y]: [u32; 2]) -> Vec2 {
    Vec2::new(unit_float(x), unit_float(y))
}

/// The upper 24 bits as a number in [0, 1).
#[inline]
fn unit_float(x: u32) -> f32 {
    (x >> 8) as f32 * (1.0 / (1 << 24) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    type New = fn(u64, [u32; 2], u32) -> Sampler;
    const WAYS: [New; 2] = [Sampler::new, Sampler::blue_noise];

    fn points_of(new: New, seed: u64, pixel: [u32; 2], set: u32, n: u32) -> Vec<Vec2> {
        let point = |i| {
            let mut s = new(seed, pixel, i);
            s.start_dimension(set);
            s.next_2d()
        };
        (0..n).map(point).collect()
    }

    fn points(seed: u64, pixel: [u32; 2], set: u32, n: u32) -> Vec<Vec2> {
        points_of(Sampler::new, seed, pixel, set, n)
    }

    /// Pictures that are kept as references depend on them.
    #[test]
    fn points_stay_what_they_are() {
        for ((seed, pixel, sample, set), want) in [
            ((0, [0, 0], 0, 0), [14196216, 11595373, 8097628]),
            ((7, [3, 900], 5, 1), [16341935, 7080402, 4437204]),
            ((u64::MAX, [1920, 1080], 100, 70_000), [12275355, 1483335, 1736289]),
        ] {
            let mut s = Sampler::new(seed, pixel, sample);
            s.start_dimension(set);
            let (x, p) = (s.next_1d(), s.next_2d());
            assert_eq!([x, p.x, p.y].map(|v| (v * (1 << 24) as f32) as u32), want);
        }
    }

    #[test]
    fn second_dimension_is_sobols() {
        for index in [0u32, 1, 2, 3, 12345, 0x8000_0001, u32::MAX] {
            let (mut want, mut direction, mut i) = (0u32, 1u32 << 31, index);
            while i != 0 {
                want ^= if i & 1 == 1 { direction } else { 0 };
                direction ^= direction >> 1;
                i >>= 1;
            }
            assert_eq!(sobol_1_reversed(index).reverse_bits(), want, "{index:#x}");
        }
    }

    #[test]
    fn powers_of_two_fill_every_elementary_interval_once() {
        let pixels = [(0, [0, 0], 0), (7, [3, 900], 5), (u64::MAX, [1920, 1080], 100)];
        for (new, (seed, pixel, set)) in WAYS.into_iter().flat_map(|new| pixels.map(|pixel| (new, pixel))) {
            for k in [1u32, 4, 8, 10] {
                let p = points_of(new, seed, pixel, set, 1 << k);
                for kx in 0..=k {
                    let (nx, ny) = (1usize << kx, 1usize << (k - kx));
                    let mut seen = vec![false; nx * ny];
                    for q in &p {
                        let cell = (q.y * ny as f32) as usize * nx + (q.x * nx as f32) as usize;
                        assert!(!std::mem::replace(&mut seen[cell], true), "{nx} × {ny}: cell {cell} twice");
                    }
                }
            }
        }
    }

    #[test]
    fn one_dimension_is_stratified() {
        for new in WAYS {
            let mut seen = [false; 256];
            for i in 0..256 {
                let mut s = new(3, [17, 4], i);
                s.start_dimension(9);
                seen[(s.next_1d() * 256.0) as usize] = true;
            }
            assert!(seen.iter().all(|&s| s));
        }
    }

    fn correlation(a: impl Iterator<Item = f32>, b: impl Iterator<Item = f32>) -> f64 {
        let pairs: Vec<(f64, f64)> = a.zip(b).map(|(a, b)| (f64::from(a) - 0.5, f64::from(b) - 0.5)).collect();
        pairs.iter().map(|(a, b)| a * b).sum::<f64>() / pairs.len() as f64 * 12.0
    }

    #[test]
    fn sets_and_pixels_are_decorrelated() {
        // For n independent pairs the correlation has standard deviation 1/√n; scrambled points can only do better.
        let n = 4096;
        let bound = 4.5 / f64::from(n).sqrt();
        let base = points(1, [5, 6], 0, n);
        let others = [
            points(1, [5, 6], 1, n),
            points(1, [6, 6], 0, n),
            points(1, [5, 7], 0, n),
            points(1, [6, 5], 0, n),
            points(2, [5, 6], 0, n),
        ];
        for other in others {
            for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let c = correlation(base.iter().map(|p| p[a]), other.iter().map(|p| p[b]));
                assert!(c.abs() < bound, "{c}");
            }
        }
        // First sample over a row of pixels: what an image shows at one sample a pixel.
        let row: Vec<f32> = (0..n + 1).map(|x| Sampler::new(1, [x, 3], 0).next_1d()).collect();
        assert!(correlation(row.iter().copied(), row[1..].iter().copied()).abs() < bound);
        let mean = row.iter().map(|&v| f64::from(v)).sum::<f64>() / row.len() as f64;
        assert!((mean - 0.5).abs() < bound * 0.3, "{mean}");
    }

    #[test]
    fn converges_faster_than_random() {
        // ∫ over the unit square of a smooth function; random sampling has RMS error σ/√n.
        let f = |p: Vec2| f64::from((p.x * 3.0).sin() * (p.y * p.y + 0.5));
        let exact = (1.0 - 3f64.cos()) / 3.0 * (1.0 / 3.0 + 0.5);
        for new in WAYS {
            let rms = |n: u32| {
                let pixels = 64;
                let squares = (0..pixels).map(|x| {
                    let mean = points_of(new, 11, [x, 0], 3, n).into_iter().map(f).sum::<f64>() / f64::from(n);
                    (mean - exact).powi(2)
                });
                (squares.sum::<f64>() / f64::from(pixels)).sqrt()
            };
            let (coarse, fine) = (rms(64), rms(1024));
            assert!(coarse < 0.3 / 64f64.sqrt() * 0.4, "{coarse}");
            // Random would gain a factor of 4; scrambled nets approach 64 for smooth functions.
            assert!(coarse / fine > 16.0, "{coarse} → {fine}");
        }
    }

    #[test]
    fn dimension_sets_do_not_depend_on_what_was_taken_before() {
        for new in WAYS {
            let mut a = new(4, [1, 2], 33);
            let mut b = a;
            a.next_1d();
            a.next_2d();
            a.start_dimension(20);
            b.start_dimension(20);
            assert_eq!(a.next_2d(), b.next_2d());
        }
    }
}
