//! Textures of rect lights.

use std::path::Path;

use glam::Vec2;
use umber_math::Rgb;
use umber_sampling::Distribution2D;

use crate::image_file::{ImageError, LinearImage};
use crate::texels::{Sides, Texels};

/// A picture on a rect light, sampled in proportion to its luminance. Bilinear, its edge pixels going on to the edge.
#[derive(Clone, Debug)]
pub struct LightTexture {
    texels: Texels,
    /// Over the pixels, by the luminance of the filtered image.
    distribution: Distribution2D,
    mean: Rgb,
}

impl LightTexture {
    /// Reads an image file; see [`LinearImage::load`].
    ///
    /// # Errors
    /// Where the file cannot be read or decoded.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, ImageError> {
        Self::named(LinearImage::load(path.as_ref())?, path.as_ref())
    }
    /// From pixels, row 0 at the top. Negative and NaN channels count as zero; infinite ones as 65504.
    ///
    /// # Errors
    /// Where the number of pixels is not width × height, or zero.
    pub fn from_pixels(width: usize, height: usize, pixels: Vec<[f32; 3]>) -> Result<Self, ImageError> {
        Self::named(LinearImage { width, height, pixels }, Path::new("(pixels)"))
    }
    fn named(image: LinearImage, path: &Path) -> Result<Self, ImageError> {
        let (width, height) = (image.width, image.height);
        let texels = Texels::new(image, path)?;
        let bad_size = || ImageError::Size { path: path.to_owned(), width, height };
        let distribution = Distribution2D::new(&texels.mean_luminance(Sides::Clamp), width).ok_or_else(bad_size)?;
        let mean = texels.weighted_mean(|_| 1.0);
        Ok(Self { texels, distribution, mean })
    }
    /// The picture at a place: u to the right, v down, both 0 … 1.
    #[inline]
    pub(crate) fn at(&self, uv: Vec2) -> Rgb {
        self.texels.at(uv * self.texels.size(), Sides::Clamp)
    }
    /// A place, and its density over the unit square.
    #[inline]
    pub(crate) fn sample(&self, u: Vec2) -> (Vec2, f32) {
        self.distribution.sample(u)
    }
    /// Density over the unit square with which [`LightTexture::sample`] makes a place.
    #[inline]
    pub(crate) fn pdf(&self, uv: Vec2) -> f32 {
        // The last row and column hold the edge itself.
        self.distribution.pdf(uv.clamp(Vec2::ZERO, Vec2::splat(1.0 - f32::EPSILON)))
    }
    /// Mean over the picture.
    pub(crate) fn mean(&self) -> Rgb {
        self.mean
    }
}
