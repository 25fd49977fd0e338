//! The film: what the samples add up to, tile by tile, readable while it is written.

mod pixel;
mod tile;

use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::DVec3;
use umber_math::Rgb;

use crate::aov::{Accumulation, Aov};
use crate::format::BufferFormat;
use crate::light_tracing::LightImage;

use pixel::encode;
pub(crate) use pixel::{CenterHit, PixelSum, Samples, deviation, radiance};
pub(crate) use tile::{Tile, TileRect};

/// Edge of a tile, pixels.
pub const TILE: usize = 16;
/// Strides, pixels, of the coarse grids that are sampled before every pixel is; each divides the tile's edge.
pub(crate) const COARSE: [usize; 3] = [8, 4, 2];
/// Edge, in tiles, of the blocks that are rendered one after the other.
const BLOCK: usize = 4;

/// Size and content of the picture, and which part of the camera's view it shows.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmDesc {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Where the camera's view lies, in pixels of the film with y up: min x, min y, max x, max y.
    /// `None`: the whole film.
    pub display_window: Option<[f64; 4]>,
    /// Where the film lies among the display window's pixels, y up: min x, min y. Row 0 is the lowest.
    pub data_window_min: [i32; 2],
    /// Width over height of one pixel.
    pub pixel_aspect: f64,
    /// AOVs to keep, each once.
    pub aovs: Vec<Aov>,
    /// Colour and alpha behind everything.
    pub clear_color: [f32; 4],
}

impl FilmDesc {
    /// A film that shows the whole view.
    pub fn new(width: usize, height: usize, aovs: &[Aov]) -> Self {
        Self {
            width,
            height,
            display_window: None,
            data_window_min: [0, 0],
            pixel_aspect: 1.0,
            aovs: aovs.to_vec(),
            clear_color: [0.0; 4],
        }
    }
    /// The same with what is not a number, or no shape, replaced by what a host that says nothing gets.
    pub(crate) fn sanitized(self) -> Self {
        let finite = |v: f32| if v.is_finite() { v } else { 0.0 };
        let usable = |[x0, y0, x1, y1]: &[f64; 4]| [x0, y0, x1, y1].iter().all(|v| v.is_finite()) && x1 > x0 && y1 > y0;
        let aspect = self.pixel_aspect;
        Self {
            display_window: self.display_window.filter(usable),
            pixel_aspect: if aspect.is_finite() && aspect > 0.0 { aspect } else { 1.0 },
            clear_color: self.clear_color.map(finite),
            ..self
        }
    }
    /// The camera's view, in pixels.
    pub fn view(&self) -> [f64; 4] {
        self.display_window.unwrap_or([0.0, 0.0, self.width as f64, self.height as f64])
    }
}

/// A film. Any thread may read while others render: a tile is locked only to copy it.
#[derive(Debug)]
pub struct Film {
    desc: FilmDesc,
    centers: Vec<Aov>,
    columns: usize,
    tiles: Vec<Mutex<Tile>>,
    /// What light paths add, in two images.
    light: Mutex<[LightImage; 2]>,
}

impl Film {
    /// A film without samples.
    pub fn new(desc: FilmDesc) -> Self {
        let centers: Vec<Aov> =
            desc.aovs.iter().copied().filter(|a| a.row().accumulation == Accumulation::Center).collect();
        let columns = desc.width.div_ceil(TILE);
        let rows = desc.height.div_ceil(TILE);
        let tile = |i: usize| {
            let (x, y) = (i % columns * TILE, i / columns * TILE);
            let rect = TileRect { x, y, width: TILE.min(desc.width - x), height: TILE.min(desc.height - y) };
            Mutex::new(Tile::new(rect))
        };
        let tiles = (0..columns * rows).map(tile).collect();
        Self { desc, centers, columns, tiles, light: Mutex::default() }
    }
    /// A film without samples, in the memory of one that is not needed any more, where they are of one kind.
    pub(crate) fn renewed(desc: FilmDesc, old: Option<Self>) -> Self {
        let Some(mut film) = old.filter(|old| old.desc == desc) else { return Self::new(desc) };
        for tile in &mut film.tiles {
            let tile = tile.get_mut().unwrap_or_else(PoisonError::into_inner);
            tile.clear();
        }
        film.light = Mutex::default();
        film
    }
    /// What it was made for.
    pub fn desc(&self) -> &FilmDesc {
        &self.desc
    }
    /// AOVs that want a ray through the middle of each pixel.
    pub(crate) fn has_center_aovs(&self) -> bool {
        !self.centers.is_empty()
    }
    pub(crate) fn tile_count(&self) -> usize {
        self.tiles.len()
    }
    /// Index of the tile that holds the pixel at column `x` and row `y`.
    pub(crate) fn tile_at(&self, x: usize, y: usize) -> usize {
        y / TILE * self.columns + x / TILE
    }
    pub(crate) fn tile(&self, index: usize) -> MutexGuard<'_, Tile> {
        // a panic elsewhere leaves at worst a tile that lacks samples
        self.tiles[index].lock().unwrap_or_else(PoisonError::into_inner)
    }
    /// Keeps what is seen through pixel middles of a tile: `None` where nothing is.
    pub(crate) fn set_centers(&self, index: usize, hits: &[Option<CenterHit>]) {
        let planes = self.centers.iter().map(|aov| hits.iter().map(|hit| encode(*aov, hit.as_ref())).collect());
        self.tile(index).set_centers(planes.collect());
    }

    /// What light paths add, in two images.
    pub(crate) fn light(&self) -> MutexGuard<'_, [LightImage; 2]> {
        self.light.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Bytes it takes once every pixel has samples, in `halves` halves.
    pub fn memory_bytes(&self, halves: usize) -> usize {
        let pixels = self.desc.width * self.desc.height;
        pixels * (Samples::bytes(halves) + self.centers.len() * size_of::<[u32; 3]>())
    }

    /// Mean over pixels and channels of the variance of a pixel, as the difference of its halves shows it,
    /// relative to its square and that of 1 % of the picture's mean luminance together. Of
    /// pixels that have two halves; `None` where none have.
    pub fn mean_relative_variance(&self) -> Option<f64> {
        let light = self.light();
        // mean over pixels with two halves of what their means, and by how much these are off, tell; not a number without
        let over = |value: &dyn Fn(DVec3, DVec3) -> f64| {
            let (mut sum, mut count) = (0.0, 0);
            for tile in (0..self.tiles.len()).map(|t| self.tile(t)) {
                for i in 0..tile.rect.width * tile.rect.height {
                    let sums = tile.samples.sums(i);
                    if sums.iter().any(|half| half.samples == 0) {
                        continue;
                    }
                    let [x, y] = tile.rect.place(i);
                    let [a, b] = tile.light(i, &light, y * self.desc.width + x).map(|light| 0.5 * light.0.as_dvec3());
                    sum += value(radiance(sums) + a + b, deviation(sums) + a - b);
                    count += 1;
                }
            }
            sum / f64::from(count)
        };
        let floor = error_floor(over(&|mean, _| luminance(mean)));
        let mean = over(&|mean, off| relative_variance(off, mean, floor));
        (!mean.is_nan()).then_some(mean)
    }

    /// Writes an AOV into `out`: row after row from the lowest, `width · height` pixels of `format`.
    /// False, and nothing written, where the film does not keep the AOV or `out` has another size.
    pub fn resolve(&self, aov: Aov, format: BufferFormat, out: &mut [u8]) -> bool {
        let bytes = format.bytes();
        if out.len() != self.desc.width * self.desc.height * bytes || !self.desc.aovs.contains(&aov) {
            return false;
        }
        let plane = self.centers.iter().position(|a| *a == aov);
        let mut colors = [[0.0; 4]; TILE];
        let light = self.light();
        for index in 0..self.tiles.len() {
            let tile = self.tile(index);
            let TileRect { x, y, width, height } = tile.rect;
            for row in 0..height {
                let at = ((y + row) * self.desc.width + x) * bytes;
                let out = &mut out[at..at + width * bytes];
                match plane {
                    Some(plane) => tile.write_centers(row, aov, plane, format, out),
                    None => {
                        tile.row_colors(row, self.desc.clear_color, &mut colors[..width]);
                        tile.add_light(row, &light, (y + row) * self.desc.width + x, &mut colors[..width]);
                        format.write_row(&colors[..width], out);
                    }
                }
            }
        }
        true
    }

    /// Tile indices in the order in which they are rendered: blocks of tiles from the middle outwards,
    /// within a block along a Morton curve, so that what one tile brought into the caches serves the next.
    pub(crate) fn tile_order(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.tiles.len()).collect();
        let rows = self.tiles.len() / self.columns.max(1);
        let key = |i: &usize| {
            let (x, y) = (i % self.columns, i / self.columns);
            let middle = |at: usize, count: usize| (2 * (at / BLOCK * BLOCK) + BLOCK).abs_diff(count);
            let (dx, dy) = (middle(x, self.columns), middle(y, rows));
            let morton = (x & 1) | (y & 1) << 1 | (x & 2) << 1 | (y & 2) << 2;
            (dx * dx + dy * dy, y / BLOCK, x / BLOCK, morton)
        };
        order.sort_by_key(key);
        order
    }
}

/// What is added to a squared mean before a variance is taken relative to it, where the picture's mean luminance is
/// `mean`: dark pixels need not be as exact as their own darkness.
pub(crate) fn error_floor(mean: f64) -> f64 {
    (0.01 * mean).powi(2).max(f64::MIN_POSITIVE)
}

/// Mean over the channels of a squared error relative to the square of a mean, and to [`error_floor`].
pub(crate) fn relative_variance(off: DVec3, mean: DVec3, floor: f64) -> f64 {
    (off * off / (mean * mean + floor)).dot(DVec3::splat(1.0 / 3.0))
}

/// Luminance of linear Rec.709.
pub(crate) fn luminance(radiance: DVec3) -> f64 {
    f64::from(Rgb(radiance.as_vec3()).luminance())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec4;

    #[test]
    fn mean_goes_over_the_clear_color() {
        let desc = FilmDesc { clear_color: [0.0, 0.0, 1.0, 0.0], ..FilmDesc::new(20, 3, &[Aov::Color, Aov::PrimId]) };
        let film = Film::new(desc);
        assert_eq!(film.tile_count(), 2);
        {
            let mut tile = film.tile(1);
            assert_eq!(tile.rect, TileRect { x: 16, y: 0, width: 4, height: 3 });
            tile.samples.prepare(12, 1);
            tile.samples.add(4, 0, Rgb::new(1.0, 0.0, 0.0), 1.0);
            tile.samples.add(4, 0, Rgb::BLACK, 0.0);
        }
        let mut out = vec![0u8; 20 * 3 * 16];
        assert!(film.resolve(Aov::Color, BufferFormat::Float32Vec4, &mut out));
        let pixel: &[f32] = bytemuck::cast_slice(&out[(20 + 16) * 16..(20 + 17) * 16]);
        assert_eq!(pixel, [0.5, 0.0, 0.5, 0.5]);
        let mut ids = vec![0u8; 20 * 3 * 4];
        assert!(film.resolve(Aov::PrimId, BufferFormat::Int32, &mut ids));
        assert!(bytemuck::cast_slice::<u8, i32>(&ids).iter().all(|id| *id == -1));
        assert!(!film.resolve(Aov::Depth, BufferFormat::Float32, &mut ids));
    }
    #[test]
    fn samples_count_the_same_in_both_halves() {
        let mut halves = [PixelSum::default(); 2];
        assert_eq!(pixel::mean(halves), None);
        halves[0].add(Rgb::splat(1.0), 1.0);
        assert_eq!(pixel::mean(halves), Some(Vec4::ONE));
        assert_eq!(deviation(halves), DVec3::ZERO);
        for _ in 0..3 {
            halves[1].add(Rgb::splat(2.0), 1.0);
        }
        assert_eq!(pixel::mean(halves), Some(Vec4::new(1.75, 1.75, 1.75, 1.0)));
        // of a variance of 1 a sample, the difference's is 1 + 1/3, and the mean's 1/4
        let off = deviation(halves);
        assert!((off * off - 0.25 / (4.0 / 3.0)).abs().max_element() < 1e-12, "{off}");
    }

    #[test]
    fn every_tile_is_rendered_once() {
        let film = Film::new(FilmDesc::new(333, 130, &[Aov::Color]));
        let mut order = film.tile_order();
        order.sort_unstable();
        assert!(order.into_iter().eq(0..film.tile_count()));
    }
}
