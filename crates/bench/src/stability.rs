//! Where ray tracing methods fail: cases, counted with Umber's method and with the textbook's.
//!
//! The tests of `tests/stability` assert on these counts; `bench stability` draws them.

use rayon::prelude::*;
use umber_math::Vec3;

use crate::random::Random;

pub mod boxes;
pub mod closed;
pub mod figures;
pub mod hits;
pub mod placed;
pub mod polygons;
pub mod roughness;
pub mod secondary;
pub mod shapes;
pub mod slivers;
pub mod textbook;

/// Sizes of what is met, in units.
pub const SCALES: [f32; 5] = [1e-4, 1e-2, 1.0, 1e2, 1e5];
/// Distances from the origin of what is met, in units.
pub const DISTANCES: [f32; 5] = [0.0, 1e3, 1e4, 1e5, 1e7];

/// Where what is at a distance from the origin is put: off the axes.
pub fn offset(distance: f32) -> Vec3 {
    Vec3::new(1.0, -0.7, 0.4) * distance
}

/// The sums over cases 0 to `count` of what `case` counts. On all threads, the same on any number of them.
pub fn tally<const N: usize>(
    count: usize,
    seed: u64,
    case: impl Fn(&mut Random, usize) -> [u64; N] + Sync,
) -> [u64; N] {
    const AT_ONCE: usize = 4096;
    let add = |a: [u64; N], b: [u64; N]| std::array::from_fn(|i| a[i] + b[i]);
    let part = |start: usize| {
        let mut random = Random::stream(seed, start as u64);
        (start..count.min(start + AT_ONCE)).map(|i| case(&mut random, i)).fold([0; N], add)
    };
    let starts = (0..count.div_ceil(AT_ONCE)).into_par_iter().map(|i| i * AT_ONCE);
    starts.map(part).reduce(|| [0; N], add)
}
