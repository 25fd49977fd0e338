//! Blue noise over pixels: values of which neighbours differ, so that the eye averages them.
//!
//! Georgiev & Fajardo 2016, "Blue-noise dithered sampling" (SIGGRAPH talks): each dimension takes a dither mask's value
//! at the pixel. The mask is one of void-and-cluster (`examples/void_and_cluster.rs`). All its threshold sets are
//! spread evenly, so that it stays blue noise where values are shifted modulo one.

use crate::hash::mix;

/// Pixels to each side of the mask, a power of two.
const SIDE: u32 = 64;
const PIXELS: usize = (SIDE * SIDE) as usize;
/// Pixels by rank, rows first: each of 0 … `PIXELS` − 1 once.
static RANKS: [u16; PIXELS] = ranks(include_bytes!("blue_noise_mask.bin"));

/// Little-endian numbers.
const fn ranks(bytes: &[u8; 2 * PIXELS]) -> [u16; PIXELS] {
    let mut ranks = [0; PIXELS];
    let mut i = 0;
    while i < PIXELS {
        ranks[i] = u16::from_le_bytes([bytes[2 * i], bytes[2 * i + 1]]);
        i += 1;
    }
    ranks
}

/// The mask's values at one pixel, a number for each dimension.
///
/// Over seeds, each is uniform. Dimensions see the mask from other places: those of the R2 sequence (Roberts 2018, "The
/// unreasonable effectiveness of quasirandom sequences") from a start by the seed. Of hashed places some would be the
/// same: in one of two pictures, two of the first seventy-five dimensions would then be one. Of R2's, any two of the
/// first two hundred are two and a half pixels apart or more.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PixelMask {
    seed: u32,
    /// Where dimension 0 sees the mask, as fractions of its sides: 2³² is the whole side.
    start: [u32; 2],
}

impl PixelMask {
    /// The mask at a pixel, as `seed` shifts it.
    #[inline]
    pub fn new(seed: u32, pixel: [u32; 2]) -> Self {
        let start = [mix(seed ^ START_X), mix(seed ^ START_Y)];
        let of_pixel = |i: usize| start[i].wrapping_add(pixel[i].wrapping_mul(1 << (32 - SIDE.ilog2())));
        Self { seed, start: [of_pixel(0), of_pixel(1)] }
    }

    /// The value for a dimension, in units of 2⁻³².
    #[inline]
    pub fn value(&self, dimension: u32) -> u32 {
        let [x, y] = [0, 1].map(|i| {
            let place = self.start[i].wrapping_add(dimension.wrapping_mul(R2[i]));
            (place >> (32 - SIDE.ilog2())) as usize
        });
        let rank = u32::from(RANKS[y * SIDE as usize + x]);
        (rank << (32 - PIXELS.ilog2())).wrapping_add(mix(self.seed ^ dimension.wrapping_mul(0x9e37_79b9)))
    }
}

const START_X: u32 = 0x1f12_3bb5;
const START_Y: u32 = 0x5a8c_09d7;
/// The first two negative powers of the plastic number, 1.3247…, in units of 2⁻³².
const R2: [u32; 2] = [0xc13f_a9a9, 0x91e1_0da5];
