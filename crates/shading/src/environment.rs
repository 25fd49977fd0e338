//! Environment maps, sampled in proportion to their luminance.

use std::f32::consts::{PI, TAU};
use std::path::Path;

use glam::Vec2;
use umber_math::{Rgb, Vector3};
use umber_sampling::Distribution2D;
use wide::f32x4;

use crate::image_file::{ImageError, LinearImage};
use crate::texels::{Sides, Texels};

mod projection;

use projection::Projection;

/// How a dome light's image shows the directions (`inputs:texture:format`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum TextureFormat {
    /// Longitude to the right, latitude up.
    #[default]
    LatLong,
    /// An orthographic photo of a mirror ball that touches the image's edges.
    MirroredBall,
    /// A disk that touches the edges; the distance from its middle is in proportion to the angle.
    Angular,
    /// A cube unfolded to a cross, three faces wide and four high.
    CubeMapVerticalCross,
}

impl TextureFormat {
    /// What `automatic` means: a cross if the image is three by four (and of more than twelve pixels, so that faces
    /// have a size), else latitude-longitude. A square image could be a probe, a ball or a badly sized map: it is taken
    /// for the last, as other renderers do.
    pub fn guess(width: usize, height: usize) -> Self {
        let is_cross = width >= 3 && width.is_multiple_of(3) && width / 3 * 4 == height;
        if is_cross { Self::CubeMapVerticalCross } else { Self::LatLong }
    }
}

/// Where an [`EnvironmentMap`]'s image shows a direction: from 0 to 1 to the right and down.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ImagePlace(Vec2);

/// Radiance over all directions, from an image: bilinear between pixel centres.
///
/// In its space +Y is up and the middle of the image looks along +Z. Of a latitude-longitude map the top row is +Y;
/// column u (0 … 1 from left to right) looks along longitude π − 2 π u, counted from +Z towards +X, and the image is
/// wrapped around the horizon. Other formats keep their own image, and are sampled in it. See [`crate::DomeLight`].
#[derive(Clone, Debug)]
pub struct EnvironmentMap {
    texels: Texels,
    /// `None` for latitude-longitude.
    projection: Option<Projection>,
    /// Over the pixels, by the luminance of the filtered image times solid angle.
    distribution: Distribution2D,
    /// Cosine of the polar angle at the upper edge of each row, and below the last; of latitude-longitude maps.
    edge_cosines: Vec<f32>,
    mean: Rgb,
}

impl EnvironmentMap {
    /// Reads an HDR, EXR, PNG, JPEG or TIFF file, its format guessed; see [`LinearImage::load`] and
    /// [`TextureFormat::guess`].
    ///
    /// # Errors
    /// Where the file cannot be read or decoded.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, ImageError> {
        Self::load_as(path, None)
    }
    /// Reads a file of a format; `None` guesses it.
    ///
    /// # Errors
    /// Where the file cannot be read or decoded.
    pub fn load_as(path: impl AsRef<Path>, format: Option<TextureFormat>) -> Result<Self, ImageError> {
        let image = LinearImage::load(path.as_ref())?;
        let format = format.unwrap_or_else(|| TextureFormat::guess(image.width, image.height));
        Self::named(image, format, path.as_ref())
    }
    /// A latitude-longitude map from pixels, row 0 at the top (+Y). Negative and NaN channels count as zero; infinite
    /// ones as 65504.
    ///
    /// # Errors
    /// Where the number of pixels is not width × height, or zero.
    pub fn from_pixels(width: usize, height: usize, pixels: Vec<[f32; 3]>) -> Result<Self, ImageError> {
        Self::from_pixels_as(TextureFormat::LatLong, width, height, pixels)
    }
    /// A map of any format from pixels, row 0 at the top.
    ///
    /// # Errors
    /// Where the number of pixels is not width × height, or zero.
    pub fn from_pixels_as(
        format: TextureFormat,
        width: usize,
        height: usize,
        pixels: Vec<[f32; 3]>,
    ) -> Result<Self, ImageError> {
        Self::named(LinearImage { width, height, pixels }, format, Path::new("(pixels)"))
    }
    fn named(image: LinearImage, format: TextureFormat, path: &Path) -> Result<Self, ImageError> {
        let (width, height) = (image.width, image.height);
        let mut texels = Texels::new(image, path)?;
        let projection = Projection::of(format);
        let edge = |row: usize| (f64::from(PI) * row as f64 / height as f64).cos() as f32;
        let edge_cosines: Vec<f32> = if projection.is_none() { (0..=height).map(edge).collect() } else { Vec::new() };
        if let Some(p) = projection {
            p.extend(&mut texels);
        }
        let solid_angle = |i: usize| match projection {
            None => edge_cosines[i / width] - edge_cosines[i / width + 1],
            Some(p) => p.pixel_solid_angle([i % width, i / width], Vec2::new(width as f32, height as f32)),
        };
        let solid_angles: Vec<f32> = (0..width * height).map(solid_angle).collect();
        let sides = if projection.is_none() { Sides::Wrap } else { Sides::Clamp };
        let mut weights = texels.mean_luminance(sides);
        weights.iter_mut().zip(&solid_angles).for_each(|(weight, solid_angle)| *weight *= solid_angle);
        let bad_size = || ImageError::Size { path: path.to_owned(), width, height };
        let distribution = Distribution2D::new(&weights, width).ok_or_else(bad_size)?;
        let mean = texels.weighted_mean(|i| f64::from(solid_angles[i]));
        Ok(Self { texels, projection, distribution, edge_cosines, mean })
    }
    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        [self.texels.width, self.texels.height]
    }
    /// Radiance from a direction, unit, in the map's space.
    #[inline]
    pub fn radiance(&self, w: Vector3) -> Rgb {
        self.radiance_at(self.place_of(w))
    }
    /// Where the image shows a direction, unit, in the map's space.
    #[inline]
    pub(crate) fn place_of(&self, w: Vector3) -> ImagePlace {
        ImagePlace(self.projection.map_or_else(|| uv_of(w), |p| p.uv(w)))
    }
    /// Radiance from the direction that is shown at a place.
    #[inline]
    pub(crate) fn radiance_at(&self, ImagePlace(uv): ImagePlace) -> Rgb {
        match self.projection {
            None => self.texels.at(uv * self.texels.size(), Sides::Wrap),
            Some(p) => self.texels.at(p.place(uv, self.texels.size()), Sides::Clamp),
        }
    }
    /// A direction, its radiance, and its density: constant by solid angle over each pixel of a latitude-longitude
    /// map, by area over those of others. Zero where the pixel shows no direction there.
    #[inline]
    pub fn sample(&self, u: Vec2) -> (Vector3, Rgb, f32) {
        let s = self.distribution.sample_cell(u);
        let [column, row] = s.cell;
        if let Some(p) = self.projection {
            let uv = (Vec2::new(column as f32, row as f32) + s.within) / self.texels.size();
            let Some((w, steradians)) = p.direction(uv) else { return (Vector3::new(0.0, 1.0, 0.0), Rgb::BLACK, 0.0) };
            return (w, self.radiance(w), self.density(s.pmf, steradians));
        }
        let (top, bottom) = (self.edge_cosines[row], self.edge_cosines[row + 1]);
        let y = top + (bottom - top) * s.within.y;
        let longitude = PI - TAU * (column as f32 + s.within.x) / self.texels.width as f32;
        let r = (1.0 - y * y).max(0.0).sqrt();
        let w = Vector3::new(r * longitude.sin(), y, r * longitude.cos());
        (w, self.radiance(w), s.pmf / self.pixel_solid_angle(row))
    }
    /// Density by solid angle with which [`EnvironmentMap::sample`] makes a direction, unit, in the map's space.
    #[inline]
    pub fn pdf_solid_angle(&self, w: Vector3) -> f32 {
        self.pdf_at(self.place_of(w))
    }
    /// The same for the direction that is shown at a place.
    #[inline]
    pub(crate) fn pdf_at(&self, ImagePlace(uv): ImagePlace) -> f32 {
        let column = ((uv.x * self.texels.width as f32) as usize).min(self.texels.width - 1);
        let row = ((uv.y * self.texels.height as f32) as usize).min(self.texels.height - 1);
        let pmf = self.distribution.pmf([column, row]);
        match self.projection {
            None => pmf / self.pixel_solid_angle(row),
            Some(p) => p.direction(uv).map_or(0.0, |(_, steradians)| self.density(pmf, steradians)),
        }
    }
    /// By solid angle, of a place that is uniform over a pixel; zero at the rim of a probe, where it grows over all
    /// bounds.
    #[inline]
    fn density(&self, pmf: f32, steradians: f32) -> f32 {
        let density = pmf * (self.texels.width * self.texels.height) as f32 / steradians;
        if steradians > 0.0 && density.is_finite() { density } else { 0.0 }
    }
    /// Mean over all directions.
    pub fn mean_radiance(&self) -> Rgb {
        self.mean
    }
    #[inline]
    fn pixel_solid_angle(&self, row: usize) -> f32 {
        (self.edge_cosines[row] - self.edge_cosines[row + 1]) * (TAU / self.texels.width as f32)
    }
}

/// Image coordinates of a direction in a latitude-longitude map, u to the right and v down, 0 … 1.
#[inline]
fn uv_of(w: Vector3) -> Vec2 {
    let horizontal = (w.x() * w.x() + w.z() * w.z()).sqrt();
    // The polar angle from the horizontal part too: the arc cosine alone is inexact near the poles.
    let (opposite, adjacent) = ([w.x(), horizontal, 0.0, 0.0], [w.z(), w.y(), 1.0, 1.0]);
    let [longitude, polar, ..] = f32x4::new(opposite).atan2(f32x4::new(adjacent)).to_array();
    Vec2::new((0.5 - longitude / TAU).clamp(0.0, 1.0), polar / PI)
}
