//! Image files to linear colour.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use exr::prelude as exr;
use image::{DynamicImage, ImageReader};
use umber_math::linear_from_srgb;

/// Why an image could not be read. Each names the file.
#[derive(Clone, Debug, thiserror::Error)]
pub enum ImageError {
    /// The file is missing or cannot be read.
    #[error("{path}: cannot be read: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: Arc<std::io::Error>,
    },
    /// The file is no image of a known format, or a broken one.
    #[error("{path}: not a readable image (HDR, EXR, PNG, JPEG and TIFF are): {reason}")]
    Decode {
        /// The file.
        path: PathBuf,
        /// What the decoder says.
        reason: String,
    },
    /// There are no pixels, or not as many as width × height.
    #[error("{path}: {width} × {height} pixels do not make an image")]
    Size {
        /// The file.
        path: PathBuf,
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
}

/// Scene-linear colours, row 0 at the top.
#[derive(Clone, Debug)]
pub struct LinearImage {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `width · height` Rec.709 triples, row by row; alpha is left out.
    pub pixels: Vec<[f32; 3]>,
}

impl LinearImage {
    /// Reads a file, its format told from its content.
    ///
    /// Eight-bit images are sRGB and are decoded; those with more bits or floating point are linear, as
    /// UsdUVTexture's automatic colour space has it.
    ///
    /// # Errors
    /// Where the file cannot be read or decoded.
    pub fn load(path: &Path) -> Result<Self, ImageError> {
        let io = |e: std::io::Error| ImageError::Io { path: path.to_owned(), source: Arc::new(e) };
        let bytes = std::fs::read(path).map_err(io)?;
        let image = if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
            decode_exr(&bytes)
        } else {
            let reader = ImageReader::new(std::io::Cursor::new(&bytes)).with_guessed_format();
            reader.map_err(io)?.decode().map(linear).map_err(|e| e.to_string())
        };
        let image = image.map_err(|reason| ImageError::Decode { path: path.to_owned(), reason })?;
        let (width, height) = (image.width, image.height);
        if image.pixels.is_empty() || image.pixels.len() != width * height {
            return Err(ImageError::Size { path: path.to_owned(), width, height });
        }
        Ok(image)
    }
}

fn decode_exr(bytes: &[u8]) -> Result<LinearImage, String> {
    use self::exr::*;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| LinearImage { width: size.0, height: size.1, pixels: vec![[0.0; 3]; size.0 * size.1] },
            |image: &mut LinearImage, at, (r, g, b): (f32, f32, f32)| {
                image.pixels[at.1 * image.width + at.0] = [r, g, b];
            },
        )
        .first_valid_layer()
        .all_attributes()
        // it would start threads of its own, one for each core; unpacking is the lesser part of the work
        .non_parallel()
        .from_buffered(std::io::Cursor::new(bytes));
    image.map(|i| i.layer_data.channel_data.pixels).map_err(|e| e.to_string())
}

fn linear(image: DynamicImage) -> LinearImage {
    use DynamicImage::{ImageLuma8, ImageLumaA8, ImageRgb8, ImageRgba8};
    let (width, height) = (image.width() as usize, image.height() as usize);
    let is_eight_bit = matches!(image, ImageLuma8(_) | ImageLumaA8(_) | ImageRgb8(_) | ImageRgba8(_));
    let pixels =
        image.into_rgb32f().pixels().map(|p| if is_eight_bit { p.0.map(linear_from_srgb) } else { p.0 }).collect();
    LinearImage { width, height, pixels }
}
