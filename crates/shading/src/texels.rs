//! Images as functions of a place: bilinear between pixel centres. What all textures of lights share.

use std::path::Path;

use glam::{DVec3, Vec2, Vec3};
use umber_math::Rgb;

use crate::image_file::{ImageError, LinearImage};

/// Pixels without bad numbers, row 0 at the top.
#[derive(Clone, Debug)]
pub(crate) struct Texels {
    pub width: usize,
    pub height: usize,
    /// Finite and not negative.
    pub pixels: Vec<[f32; 3]>,
}

/// What lies beyond the left and right edges; beyond the upper and lower ones the edge pixels go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sides {
    /// The edge pixels go on.
    Clamp,
    /// The other side follows.
    Wrap,
}

impl Sides {
    /// The column that stands for one of the image or next to it.
    #[inline]
    fn column(self, x: isize, width: usize) -> usize {
        let width = width as isize;
        let x = match self {
            Self::Wrap if x < 0 => x + width,
            Self::Wrap if x >= width => x - width,
            Self::Wrap | Self::Clamp => x,
        };
        x.clamp(0, width - 1) as usize
    }
}

impl Texels {
    /// Negative and NaN channels count as zero; infinite ones as 65504.
    pub fn new(image: LinearImage, path: &Path) -> Result<Self, ImageError> {
        let LinearImage { width, height, mut pixels } = image;
        if pixels.is_empty() || width.checked_mul(height) != Some(pixels.len()) {
            return Err(ImageError::Size { path: path.to_owned(), width, height });
        }
        pixels.iter_mut().flatten().for_each(|v| *v = sanitized(*v));
        Ok(Self { width, height, pixels })
    }
    /// The image at a place in pixels from the upper left corner; pixel centres lie at halves.
    #[inline]
    pub fn at(&self, place: Vec2, sides: Sides) -> Rgb {
        let x = place.x - 0.5;
        let y = (place.y - 0.5).clamp(0.0, (self.height - 1) as f32);
        let (x0, y0) = (x.floor(), y.floor());
        let (c0, c1) = (sides.column(x0 as isize, self.width), sides.column(x0 as isize + 1, self.width));
        let (r0, r1) = (y0 as usize, (y0 as usize + 1).min(self.height - 1));
        let at = |c: usize, r: usize| Vec3::from(self.pixels[r * self.width + c]);
        let (fx, fy) = (x - x0, y - y0);
        Rgb(at(c0, r0).lerp(at(c1, r0), fx).lerp(at(c0, r1).lerp(at(c1, r1), fx), fy))
    }
    /// Size in pixels.
    #[inline]
    pub fn size(&self) -> Vec2 {
        Vec2::new(self.width as f32, self.height as f32)
    }
    /// For each pixel the mean luminance of the bilinear image over it: positive wherever the image is.
    ///
    /// The mean over a pixel weighs the pixel itself by 6/8 and its neighbours by 1/8, along each side.
    pub fn mean_luminance(&self, sides: Sides) -> Vec<f32> {
        let luminance: Vec<f32> = self.pixels.iter().map(|&p| Rgb::from(p).luminance()).collect();
        let blur_row = |y: usize, x: usize| {
            let at = |x: isize| luminance[y * self.width + sides.column(x, self.width)];
            let x = x as isize;
            0.125 * (at(x - 1) + at(x + 1)) + 0.75 * at(x)
        };
        let blur = |y: usize, x: usize| {
            let (above, below) = (y.saturating_sub(1), (y + 1).min(self.height - 1));
            0.125 * (blur_row(above, x) + blur_row(below, x)) + 0.75 * blur_row(y, x)
        };
        (0..self.pixels.len()).map(|i| blur(i / self.width, i % self.width)).collect()
    }
    /// Mean of the pixels, each with a weight of its own; black where there is no weight.
    pub fn weighted_mean(&self, weight: impl Fn(usize) -> f64) -> Rgb {
        let (mut sum, mut total) = (DVec3::ZERO, 0.0);
        for (i, &pixel) in self.pixels.iter().enumerate() {
            sum += Vec3::from(pixel).as_dvec3() * weight(i);
            total += weight(i);
        }
        if total > 0.0 { Rgb((sum / total).as_vec3()) } else { Rgb::BLACK }
    }
}

fn sanitized(v: f32) -> f32 {
    if v > 0.0 { if v.is_finite() { v } else { 65504.0 } } else { 0.0 }
}
