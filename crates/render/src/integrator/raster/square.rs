//! What is seen at each pixel's middle of a square of the film.

use super::project::Grid;
use crate::film::TILE;

/// Edge of a square, pixels; a multiple of the film's tiles'.
pub const SQUARE: usize = 64;
/// Pixels that are tested at once.
pub const LANES: usize = 8;
/// Pixels of a row with those after its end: what covers its last ones may be drawn beyond them, unseen.
const STRIDE: usize = SQUARE + LANES;
/// Number of no triangle.
pub const NOTHING: u32 = u32::MAX;

const _: () = assert!(SQUARE.is_multiple_of(TILE));

/// A square of the film: the nearness and the number of what is seen at each pixel.
#[derive(Debug)]
pub struct Square {
    /// First column and row.
    pub first: [i32; 2],
    /// Columns and rows.
    pub size: [i32; 2],
    /// Row by row of [`STRIDE`] pixels.
    nearness: Vec<f32>,
    numbers: Vec<u32>,
}

/// Some neighbouring pixels of a row.
pub struct Pixels<'a> {
    /// Nearness of what is seen.
    pub nearness: &'a mut [f32; LANES],
    /// Its number.
    pub numbers: &'a mut [u32; LANES],
}

impl Square {
    /// One that shows nothing, before its first place is known.
    pub fn new() -> Self {
        let pixels = STRIDE * SQUARE;
        Self { first: [0; 2], size: [0; 2], nearness: vec![0.0; pixels], numbers: vec![NOTHING; pixels] }
    }

    /// How many a film has, across and down.
    pub fn counts(grid: &Grid) -> [usize; 2] {
        [grid.width, grid.height].map(|pixels| (pixels as usize).div_ceil(SQUARE))
    }

    /// Becomes square `index` of a film, where nothing is seen yet.
    pub fn start(&mut self, grid: &Grid, index: usize) {
        let [columns, _] = Self::counts(grid);
        self.first = [index % columns * SQUARE, index / columns * SQUARE].map(|v| v as i32);
        self.size = [grid.width - self.first[0], grid.height - self.first[1]].map(|left| left.min(SQUARE as i32));
        self.nearness.fill(grid.far_nearness);
        self.numbers.fill(NOTHING);
    }

    /// Pixels from one of the square on.
    #[inline(always)]
    pub fn pixels(&mut self, [x, y]: [usize; 2]) -> Option<Pixels<'_>> {
        let at = y * STRIDE + x;
        let (nearness, _) = self.nearness.get_mut(at..)?.split_first_chunk_mut()?;
        let (numbers, _) = self.numbers.get_mut(at..)?.split_first_chunk_mut()?;
        Some(Pixels { nearness, numbers })
    }

    /// Whether all pixels from one column and row of the square to another show what is nearer than `nearness`.
    #[inline(always)]
    pub fn hides(&self, [[x0, x1], [y0, y1]]: [[u8; 2]; 2], nearness: f32) -> bool {
        let (first, end) = (usize::from(x0), usize::from(x1) + 1);
        for y in usize::from(y0)..usize::from(y1) + 1 {
            // a whole row at once: several pixels in one operation
            let mut is_hidden = true;
            for shown in &self.nearness[y * STRIDE + first..y * STRIDE + end] {
                is_hidden &= *shown > nearness;
            }
            if !is_hidden {
                return false;
            }
        }
        true
    }

    /// Number and nearness of what each pixel shows, row by row.
    #[cfg(test)]
    pub fn shown(&self) -> Vec<(u32, f32)> {
        let [width, height] = self.size.map(|v| v as usize);
        let row = |y: usize| y * STRIDE..y * STRIDE + width;
        (0..height).flat_map(row).map(|at| (self.numbers[at], self.nearness[at])).collect()
    }

    /// The numbers of what is seen from a pixel of the film on, along a row.
    #[inline]
    pub fn row(&self, [x, y]: [i32; 2], length: usize) -> &[u32] {
        let at = (y - self.first[1]) as usize * STRIDE + (x - self.first[0]) as usize;
        &self.numbers[at..at + length]
    }
}
