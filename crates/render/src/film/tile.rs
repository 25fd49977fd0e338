//! A tile of the film: its samples, and what is seen through its pixels' middles.

use glam::Vec4;
use umber_math::Rgb;

use super::COARSE;
use super::pixel::{self, Samples, decode};
use crate::aov::Aov;
use crate::format::BufferFormat;
use crate::light_tracing::LightImage;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TileRect {
    pub x: usize,
    pub y: usize,
    pub width: usize,
    pub height: usize,
}

impl TileRect {
    /// Column and row of pixel `i`, counted row by row.
    #[inline]
    pub fn place(&self, i: usize) -> [usize; 2] {
        [self.x + i % self.width, self.y + i / self.width]
    }

    /// The number of the pixel at a column and a row.
    #[inline]
    pub fn index(&self, [x, y]: [usize; 2]) -> usize {
        (y - self.y) * self.width + (x - self.x)
    }
}

/// Pixels of one tile, row by row.
#[derive(Debug)]
pub(crate) struct Tile {
    /// First column and row, and how many of them.
    pub rect: TileRect,
    pub samples: Samples,
    /// Values of the AOVs seen through pixel middles, in the order of the film's description, as
    /// floats or bits of integers; empty until they are known.
    centers: Vec<Vec<[u32; 3]>>,
}

impl Tile {
    /// Without samples.
    pub fn new(rect: TileRect) -> Self {
        Self { rect, samples: Samples::default(), centers: Vec::new() }
    }
    /// Takes all samples away, and keeps their memory.
    pub fn clear(&mut self) {
        self.samples.clear();
        self.centers.clear();
    }
    /// Keeps what is seen through pixel middles.
    pub fn set_centers(&mut self, planes: Vec<Vec<[u32; 3]>>) {
        self.centers = planes;
    }
    /// Whether what is seen through pixel middles is known.
    pub fn has_centers(&self) -> bool {
        !self.centers.is_empty()
    }
    /// Colours of a row over `clear`. A pixel that has no sample shows the nearest one below and to
    /// the left that a coarser grid of first samples took.
    pub fn row_colors(&self, row: usize, clear: [f32; 4], out: &mut [[f32; 4]]) {
        let (start, clear) = (row * self.rect.width, Vec4::from(clear));
        let over_clear = |mean: Vec4| (mean + (1.0 - mean.w) * clear).to_array();
        let [first, second] = self.samples.halves.each_ref().map(|half| half.get(start..start + out.len()));
        // mostly there is one half, and it has samples
        let only = first.filter(|_| second.is_none()).filter(|sums| sums.iter().all(|sum| sum.samples > 0));
        if let Some(sums) = only {
            return out.iter_mut().zip(sums).for_each(|(out, sum)| *out = over_clear(sum.mean()));
        }
        for (column, out) in out.iter_mut().enumerate() {
            let mean = pixel::mean(self.samples.sums(start + column)).or_else(|| self.coarse(column, row));
            *out = mean.map_or(clear.to_array(), over_clear);
        }
    }
    #[cold]
    fn coarse(&self, x: usize, y: usize) -> Option<Vec4> {
        let at = |stride: usize| self.samples.sums(y / stride * stride * self.rect.width + x / stride * stride);
        COARSE.iter().rev().find_map(|stride| pixel::mean(at(*stride)))
    }

    /// What each of two images of light paths adds to pixel `i`, which is number `pixel` of the film.
    #[inline]
    pub fn light(&self, i: usize, light: &[LightImage; 2], pixel: usize) -> [Rgb; 2] {
        let samples = self.samples.count(i);
        light.each_ref().map(|image| image.radiance(pixel, samples))
    }

    /// Adds what light paths bring to a row of colours, whose first pixel is number `first` of the film.
    pub fn add_light(&self, row: usize, light: &[LightImage; 2], first: usize, out: &mut [[f32; 4]]) {
        // images with paths count the same, however many they have (see `adaptive`)
        let images = light.iter().filter(|image| !image.is_empty()).count();
        if images == 0 {
            return;
        }
        for (column, out) in out.iter_mut().enumerate() {
            let i = row * self.rect.width + column;
            let [a, b] = self.light(i, light, first + column);
            let sum = (a + b) * (1.0 / images as f32);
            for (channel, sum) in out.iter_mut().zip(sum.0.to_array()) {
                *channel += sum;
            }
        }
    }

    /// Writes a row of an AOV that is seen through pixel middles: the one of that number.
    pub fn write_centers(&self, row: usize, aov: Aov, plane: usize, format: BufferFormat, out: &mut [u8]) {
        let bits = self.centers.get(plane).map(|plane| &plane[row * self.rect.width..]);
        for (column, out) in out.chunks_exact_mut(format.bytes()).enumerate() {
            format.write(decode(aov, bits.map(|bits| bits[column])), out);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_without_samples_show_the_coarse_grid() {
        let mut tile = Tile::new(TileRect { x: 0, y: 0, width: 16, height: 16 });
        tile.samples.prepare(256, 1);
        for (x, y, v) in [(0, 0, 1.0), (8, 0, 2.0), (0, 8, 3.0), (8, 8, 4.0), (12, 8, 5.0)] {
            tile.samples.add(y * 16 + x, 0, Rgb::splat(v), 1.0);
        }
        let at = |x: usize, y: usize| {
            let mut row = [[0.0; 4]; 16];
            tile.row_colors(y, [0.0; 4], &mut row);
            row[x][0]
        };
        assert_eq!([at(7, 7), at(9, 3), at(2, 15), at(11, 9), at(15, 11)], [1.0, 2.0, 3.0, 4.0, 5.0]);
    }
}
