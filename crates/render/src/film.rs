//! The film: what the samples add up to, tile by tile, readable while it is written.

use std::sync::{Mutex, MutexGuard};

use crate::aov::{Accumulation, Aov};
use crate::format::{BufferFormat, Pixel};

/// Edge of a tile, pixels.
pub const TILE: usize = 16;

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

/// What all samples of a pixel add up to.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PixelSum {
    /// Sum of radiance and coverage.
    pub color: [f32; 4],
    /// Sum of squared luminance.
    pub luminance_squared: f32,
    /// How many samples.
    pub samples: u32,
}

impl PixelSum {
    /// Adds a sample.
    pub fn add(&mut self, rgb: umber_math::Rgb, coverage: f32) {
        for (sum, v) in self.color.iter_mut().zip([rgb.0.x, rgb.0.y, rgb.0.z, coverage]) {
            *sum += v;
        }
        let y = rgb.luminance();
        self.luminance_squared += y * y;
        self.samples += 1;
    }

    fn mean(&self, clear: [f32; 4]) -> [f32; 4] {
        if self.samples == 0 {
            return clear;
        }
        let mean = self.color.map(|c| c / self.samples as f32);
        let behind = 1.0 - mean[3];
        std::array::from_fn(|i| mean[i] + behind * clear[i])
    }
}

/// What is seen through the middle of a pixel.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CenterHit {
    pub depth: f32,
    pub camera_depth: f32,
    pub normal: [f32; 3],
    pub neye: [f32; 3],
    pub prim_id: i32,
    pub instance_id: i32,
    pub element_id: i32,
    pub st: [f32; 2],
}

/// Pixels of one tile, row by row.
#[derive(Debug)]
pub(crate) struct Tile {
    /// First column and row, and how many of them.
    pub rect: TileRect,
    /// One sum a pixel.
    pub sums: Vec<PixelSum>,
    /// Values of the AOVs seen through pixel middles, in the order of the film's description, as
    /// floats or bits of integers; empty until they are known.
    centers: Vec<Vec<[u32; 3]>>,
}

impl Tile {
    /// Whether what is seen through pixel middles is known.
    pub fn has_centers(&self) -> bool {
        !self.centers.is_empty()
    }
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TileRect {
    pub x: usize,
    pub y: usize,
    pub width: usize,
    pub height: usize,
}

/// A film. Any thread may read while others render: a tile is locked only to copy it.
#[derive(Debug)]
pub struct Film {
    desc: FilmDesc,
    centers: Vec<Aov>,
    columns: usize,
    tiles: Vec<Mutex<Tile>>,
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
            let sums = vec![PixelSum::default(); rect.width * rect.height];
            Mutex::new(Tile { rect, sums, centers: Vec::new() })
        };
        let tiles = (0..columns * rows).map(tile).collect();
        Self { desc, centers, columns, tiles }
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
    pub(crate) fn tile(&self, index: usize) -> MutexGuard<'_, Tile> {
        // a panic elsewhere leaves at worst a tile that lacks samples
        self.tiles[index].lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }
    /// Keeps what is seen through pixel middles of a tile: `None` where nothing is.
    pub(crate) fn set_centers(&self, index: usize, hits: &[Option<CenterHit>]) {
        let planes = self.centers.iter().map(|aov| hits.iter().map(|hit| encode(*aov, hit.as_ref())).collect());
        self.tile(index).centers = planes.collect();
    }

    /// Bytes it takes.
    pub fn memory_bytes(&self) -> usize {
        let pixels = self.desc.width * self.desc.height;
        pixels * (size_of::<PixelSum>() + self.centers.len() * size_of::<[u32; 3]>())
    }

    /// Mean over the pixels of the variance of a pixel's mean luminance, relative to the squared
    /// luminance of the pixel or, where that is more, of 1 % of the picture's mean.
    pub fn mean_relative_variance(&self) -> f64 {
        let tiles = 0..self.tiles.len();
        let luminance = |s: &PixelSum| {
            let n = s.samples.max(1) as f32;
            f64::from(umber_math::Rgb::new(s.color[0], s.color[1], s.color[2]).luminance() / n)
        };
        let pixels = (self.desc.width * self.desc.height).max(1) as f64;
        let mean = tiles.clone().map(|t| self.tile(t).sums.iter().map(luminance).sum::<f64>()).sum::<f64>() / pixels;
        let floor = (0.01 * mean).powi(2).max(f64::MIN_POSITIVE);
        let variance = |s: &PixelSum| {
            let (y, n) = (luminance(s), f64::from(s.samples));
            let spread = (f64::from(s.luminance_squared) / n - y * y).max(0.0);
            spread / (n - 1.0).max(1.0) / (y * y).max(floor)
        };
        tiles.map(|t| self.tile(t).sums.iter().map(variance).sum::<f64>()).sum::<f64>() / pixels
    }

    /// Writes an AOV into `out`: row after row from the lowest, `width · height` pixels of `format`.
    /// False, and nothing written, where the film does not keep the AOV or `out` has another size.
    pub fn resolve(&self, aov: Aov, format: BufferFormat, out: &mut [u8]) -> bool {
        let bytes = format.bytes();
        if out.len() != self.desc.width * self.desc.height * bytes || !self.desc.aovs.contains(&aov) {
            return false;
        }
        let plane = self.centers.iter().position(|a| *a == aov);
        for index in 0..self.tiles.len() {
            let tile = self.tile(index);
            for i in 0..tile.sums.len() {
                let (x, y) = (tile.rect.x + i % tile.rect.width, tile.rect.y + i / tile.rect.width);
                let at = (y * self.desc.width + x) * bytes;
                let pixel = match plane {
                    Some(plane) => decode(aov, tile.centers.get(plane).map(|p| p[i])),
                    None => Pixel::Float(tile.sums[i].mean(self.desc.clear_color), 4),
                };
                format.write(pixel, &mut out[at..at + bytes]);
            }
        }
        true
    }

    /// Tile indices in the order in which they are rendered: from the middle outwards.
    pub(crate) fn tile_order(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.tiles.len()).collect();
        let rows = self.tiles.len() / self.columns.max(1);
        let distance = |i: &usize| {
            let (dx, dy) = ((2 * (i % self.columns)).abs_diff(self.columns), (2 * (i / self.columns)).abs_diff(rows));
            dx * dx + dy * dy
        };
        order.sort_by_key(distance);
        order
    }
}

fn encode(aov: Aov, hit: Option<&CenterHit>) -> [u32; 3] {
    let Some(hit) = hit else {
        let clear = aov.row().clear;
        return [if aov.row().format.is_integer() { (clear as i32) as u32 } else { clear.to_bits() }; 3];
    };
    match aov {
        Aov::Color | Aov::Depth => [hit.depth.to_bits(); 3],
        Aov::CameraDepth => [hit.camera_depth.to_bits(); 3],
        Aov::Normal => hit.normal.map(f32::to_bits),
        Aov::Neye => hit.neye.map(f32::to_bits),
        Aov::PrimId => [hit.prim_id as u32; 3],
        Aov::InstanceId => [hit.instance_id as u32; 3],
        Aov::ElementId => [hit.element_id as u32; 3],
        Aov::St => [hit.st[0].to_bits(), hit.st[1].to_bits(), 0],
    }
}

fn decode(aov: Aov, bits: Option<[u32; 3]>) -> Pixel {
    let bits = bits.unwrap_or_else(|| encode(aov, None));
    let row = aov.row();
    if row.format.is_integer() {
        return Pixel::Int(bits[0] as i32);
    }
    let [a, b, c] = bits.map(f32::from_bits);
    Pixel::Float([a, b, c, 1.0], row.format.components())
}

#[cfg(test)]
mod tests {
    use super::*;
    use umber_math::Rgb;

    #[test]
    fn mean_goes_over_the_clear_color() {
        let desc = FilmDesc { clear_color: [0.0, 0.0, 1.0, 0.0], ..FilmDesc::new(20, 3, &[Aov::Color, Aov::PrimId]) };
        let film = Film::new(desc);
        assert_eq!(film.tile_count(), 2);
        {
            let mut tile = film.tile(1);
            assert_eq!(tile.rect, TileRect { x: 16, y: 0, width: 4, height: 3 });
            tile.sums[4].add(Rgb::new(1.0, 0.0, 0.0), 1.0);
            tile.sums[4].add(Rgb::BLACK, 0.0);
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
}
