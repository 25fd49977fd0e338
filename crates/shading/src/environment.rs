//! Latitude-longitude environment maps, sampled in proportion to their luminance.

use std::f32::consts::{PI, TAU};
use std::path::Path;

use glam::{Vec2, Vec3};
use umber_math::{Rgb, Vector3};
use umber_sampling::Distribution2D;

use crate::image_file::{ImageError, LinearImage};

/// Radiance over all directions, from an image: bilinear between pixel centres, wrapped around the horizon.
///
/// In its space +Y is up and the image's top row; column u (0 … 1 from left to right) looks along longitude
/// π − 2 π u, counted from +Z towards +X. See [`crate::DomeLight`].
#[derive(Clone, Debug)]
pub struct EnvironmentMap {
    width: usize,
    height: usize,
    /// Finite and not negative.
    pixels: Vec<[f32; 3]>,
    /// Over the pixels, by the luminance of the filtered image times solid angle.
    distribution: Distribution2D,
    /// Cosine of the polar angle at the upper edge of each row, and below the last.
    edge_cosines: Vec<f32>,
    mean: Rgb,
}

impl EnvironmentMap {
    /// Reads an HDR, EXR, PNG, JPEG or TIFF file; see [`LinearImage::load`].
    ///
    /// # Errors
    /// Where the file cannot be read or decoded.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, ImageError> {
        Self::named(LinearImage::load(path.as_ref())?, path.as_ref())
    }
    /// From pixels, row 0 at the top (+Y). Negative and NaN channels count as zero; infinite ones as 65504.
    ///
    /// # Errors
    /// Where the number of pixels is not width × height, or zero.
    pub fn from_pixels(width: usize, height: usize, pixels: Vec<[f32; 3]>) -> Result<Self, ImageError> {
        Self::named(LinearImage { width, height, pixels }, Path::new("(pixels)"))
    }
    fn named(image: LinearImage, path: &Path) -> Result<Self, ImageError> {
        let LinearImage { width, height, mut pixels } = image;
        let bad_size = ImageError::Size { path: path.to_owned(), width, height };
        if width.checked_mul(height) != Some(pixels.len()) {
            return Err(bad_size);
        }
        pixels.iter_mut().flatten().for_each(|v| *v = sanitized(*v));
        let edge = |row: usize| (f64::from(std::f32::consts::PI) * row as f64 / height as f64).cos() as f32;
        let edge_cosines: Vec<f32> = (0..=height).map(edge).collect();
        let weights = filtered_luminance(width, height, &pixels, &edge_cosines);
        let Some(distribution) = Distribution2D::new(&weights, width) else { return Err(bad_size) };
        let mean = mean(width, &pixels, &edge_cosines);
        Ok(Self { width, height, pixels, distribution, edge_cosines, mean })
    }
    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }
    /// Radiance from a direction, unit, in the map's space.
    #[inline]
    pub fn radiance(&self, w: Vector3) -> Rgb {
        let uv = uv_of(w);
        let x = uv.x * self.width as f32 - 0.5;
        let y = (uv.y * self.height as f32 - 0.5).clamp(0.0, (self.height - 1) as f32);
        let (x0, y0) = (x.floor(), y.floor());
        let column = |x: f32| (x as isize).rem_euclid(self.width as isize) as usize;
        let (c0, c1) = (column(x0), column(x0 + 1.0));
        let (r0, r1) = (y0 as usize, (y0 as usize + 1).min(self.height - 1));
        let at = |c: usize, r: usize| Vec3::from(self.pixels[r * self.width + c]);
        let (fx, fy) = (x - x0, y - y0);
        Rgb(at(c0, r0).lerp(at(c1, r0), fx).lerp(at(c0, r1).lerp(at(c1, r1), fx), fy))
    }
    /// A direction, its radiance, and its density: constant by solid angle over each pixel.
    #[inline]
    pub fn sample(&self, u: Vec2) -> (Vector3, Rgb, f32) {
        let s = self.distribution.sample_cell(u);
        let [column, row] = s.cell;
        let (top, bottom) = (self.edge_cosines[row], self.edge_cosines[row + 1]);
        let y = top + (bottom - top) * s.within.y;
        let longitude = PI - TAU * (column as f32 + s.within.x) / self.width as f32;
        let r = (1.0 - y * y).max(0.0).sqrt();
        let w = Vector3::new(r * longitude.sin(), y, r * longitude.cos());
        (w, self.radiance(w), s.pmf / self.pixel_solid_angle(row))
    }
    /// Density by solid angle with which [`EnvironmentMap::sample`] makes a direction, unit, in the map's space.
    #[inline]
    pub fn pdf_solid_angle(&self, w: Vector3) -> f32 {
        let uv = uv_of(w);
        let column = ((uv.x * self.width as f32) as usize).min(self.width - 1);
        let row = ((uv.y * self.height as f32) as usize).min(self.height - 1);
        self.distribution.pmf([column, row]) / self.pixel_solid_angle(row)
    }
    /// Mean over all directions.
    pub fn mean_radiance(&self) -> Rgb {
        self.mean
    }
    #[inline]
    fn pixel_solid_angle(&self, row: usize) -> f32 {
        (self.edge_cosines[row] - self.edge_cosines[row + 1]) * (TAU / self.width as f32)
    }
}

/// Image coordinates of a direction, u to the right and v down, 0 … 1.
#[inline]
fn uv_of(w: Vector3) -> Vec2 {
    let longitude = w.x().atan2(w.z());
    // From the horizontal part too: the arc cosine alone is inexact near the poles.
    let polar = w.x().hypot(w.z()).atan2(w.y());
    Vec2::new((0.5 - longitude / TAU).clamp(0.0, 1.0), polar / PI)
}

fn sanitized(v: f32) -> f32 {
    if v > 0.0 { if v.is_finite() { v } else { 65504.0 } } else { 0.0 }
}

/// For each pixel the mean luminance of the bilinear image over it, times its solid angle.
///
/// The mean over a pixel weighs the pixel itself by 6/8 and its neighbours by 1/8, along each side: positive wherever
/// the interpolated image is.
fn filtered_luminance(width: usize, height: usize, pixels: &[[f32; 3]], edge_cosines: &[f32]) -> Vec<f32> {
    let luminance: Vec<f32> = pixels.iter().map(|&p| Rgb::from(p).luminance()).collect();
    let blur_row = |y: usize, x: usize| {
        let at = |x: usize| luminance[y * width + x];
        0.125 * (at((x + width - 1) % width) + at((x + 1) % width)) + 0.75 * at(x)
    };
    let mut weights = Vec::with_capacity(pixels.len());
    for y in 0..height {
        let (above, below) = (y.saturating_sub(1), (y + 1).min(height - 1));
        let solid_angle = edge_cosines[y] - edge_cosines[y + 1];
        for x in 0..width {
            let mean = 0.125 * (blur_row(above, x) + blur_row(below, x)) + 0.75 * blur_row(y, x);
            weights.push(mean * solid_angle);
        }
    }
    weights
}

fn mean(width: usize, pixels: &[[f32; 3]], edge_cosines: &[f32]) -> Rgb {
    let rows = pixels.chunks_exact(width).zip(edge_cosines.windows(2));
    let sum: glam::DVec3 = rows
        .map(|(row, edge)| {
            let sum: glam::DVec3 = row.iter().map(|&p| Vec3::from(p).as_dvec3()).sum();
            sum * f64::from(edge[0] - edge[1])
        })
        .sum();
    Rgb((sum / (2.0 * width as f64)).as_vec3())
}
