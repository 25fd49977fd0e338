//! Makes the blue-noise mask of `src/blue_noise_mask.bin`: ranks of 64 × 64 pixels, 16 bits each, little-endian, rows
//! first.
//!
//! ```sh
//! cargo run --release -p umber-sampling --example void_and_cluster crates/sampling/src/blue_noise_mask.bin
//! ```
//!
//! Ulichney 1993, "The void-and-cluster method for dither array generation", Proc. SPIE 1913: pixels are ranked so that
//! those of rank below any threshold are spread evenly over the torus. Every sum is an integer, so that the mask is the
//! same on every machine.

use std::error::Error;

/// Pixels to each side, a power of two.
const SIDE: usize = 64;
const PIXELS: usize = SIDE * SIDE;
/// Standard deviation of the Gaussian that measures how crowded a place is, in pixels.
///
/// Chosen by the power below a quarter of the Nyquist frequency, of values shifted modulo one, relative to white noise:
/// 1.5 gives 0.060, 1.9 gives 0.048, 2.4 gives 0.041 but more in the worst of a thousand cases (0.10, else 0.09).
const SIGMA: f64 = 1.9;
/// Pixels of the pattern to begin with: a tenth, as Ulichney has it.
const INITIAL: usize = PIXELS / 10;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("which file is to be written?")?;
    Ok(std::fs::write(path, bytes(&ranks()))?)
}

fn bytes(ranks: &[u16]) -> Vec<u8> {
    ranks.iter().flat_map(|rank| rank.to_le_bytes()).collect()
}

/// Some of the pixels, and how crowded every place is by them.
#[derive(Clone)]
struct Pattern {
    taken: Vec<bool>,
    crowding: Vec<u64>,
    /// What a pixel adds to the crowding at an offset.
    weights: Vec<u64>,
}

impl Pattern {
    fn empty() -> Self {
        let toroidal = |offset: usize| offset.min(SIDE - offset) as f64;
        let weight = |i: usize| {
            let squared = toroidal(i % SIDE).powi(2) + toroidal(i / SIDE).powi(2);
            ((-squared / (2.0 * SIGMA * SIGMA)).exp() * (1u64 << 40) as f64).round() as u64
        };
        Self { taken: vec![false; PIXELS], crowding: vec![0; PIXELS], weights: (0..PIXELS).map(weight).collect() }
    }

    /// Takes a pixel that was not taken, or gives one back that was.
    fn flip(&mut self, pixel: usize) {
        let taken = !self.taken[pixel];
        self.taken[pixel] = taken;
        for (i, crowding) in self.crowding.iter_mut().enumerate() {
            let x = (i % SIDE).wrapping_sub(pixel % SIDE) % SIDE;
            let y = (i / SIDE).wrapping_sub(pixel / SIDE) % SIDE;
            let weight = self.weights[y * SIDE + x];
            *crowding = if taken { *crowding + weight } else { *crowding - weight };
        }
    }

    fn pixels(&self, taken: bool) -> impl Iterator<Item = usize> {
        (0..PIXELS).filter(move |pixel| self.taken[*pixel] == taken)
    }

    /// The taken pixel where it is most crowded.
    fn tightest_cluster(&self) -> usize {
        self.pixels(true).max_by_key(|pixel| self.crowding[*pixel]).expect("some pixel is taken")
    }

    /// The pixel not taken where it is least crowded.
    ///
    /// Once more than half of the pixels are taken, Ulichney looks for the tightest cluster of those that are not. On
    /// the torus, that is the same place: both crowdings add up to the sum of all weights.
    fn largest_void(&self) -> usize {
        self.pixels(false).min_by_key(|pixel| self.crowding[*pixel]).expect("some pixel is not taken")
    }
}

/// Pixels at random, moved from clusters into voids until none is better off elsewhere.
fn initial() -> Pattern {
    let mut pattern = Pattern::empty();
    let mut state = 1u64;
    while pattern.pixels(true).count() < INITIAL {
        // Knuth's linear congruential generator; its upper bits are good
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let pixel = (state >> 40) as usize % PIXELS;
        if !pattern.taken[pixel] {
            pattern.flip(pixel);
        }
    }
    loop {
        let cluster = pattern.tightest_cluster();
        pattern.flip(cluster);
        let void = pattern.largest_void();
        pattern.flip(void);
        if void == cluster {
            return pattern;
        }
    }
}

/// Ranks from 0 to `PIXELS` − 1, each once.
fn ranks() -> Vec<u16> {
    let mut ranks = vec![0; PIXELS];
    let initial = initial();
    let mut pattern = initial.clone();
    for rank in (0..INITIAL).rev() {
        let pixel = pattern.tightest_cluster();
        pattern.flip(pixel);
        ranks[pixel] = rank as u16;
    }
    let mut pattern = initial;
    for rank in INITIAL..PIXELS {
        let pixel = pattern.largest_void();
        pattern.flip(pixel);
        ranks[pixel] = rank as u16;
    }
    ranks
}

#[test]
fn the_mask_in_use_is_the_one_made_here() {
    assert!(bytes(&ranks()) == include_bytes!("../src/blue_noise_mask.bin"));
}
