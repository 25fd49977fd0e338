//! What light paths add to a picture.

use umber_math::Rgb;

use super::light_path::Splat;

/// Sums of what light paths bring to each pixel.
#[derive(Debug, Default)]
pub(crate) struct LightImage {
    /// Row by row; empty where there are no paths.
    sums: Vec<Rgb>,
    paths: u32,
    /// First samples of each pixel that find by themselves all that light paths do.
    before: u32,
}

impl LightImage {
    /// Whether there are no light paths.
    pub fn is_empty(&self) -> bool {
        self.paths == 0
    }
    /// Light paths so far.
    pub fn paths(&self) -> u32 {
        self.paths
    }
    /// Adds what the paths up to number `until` bring to a film of so many pixels, of which so many samples each were taken
    /// before there were any.
    pub fn add(&mut self, until: u32, splats: &[Splat], pixels: usize, before: u32) {
        self.sums.resize(pixels, Rgb::BLACK);
        for splat in splats {
            self.sums[splat.pixel as usize] += splat.radiance;
        }
        (self.paths, self.before) = (until, before);
    }
    /// Radiance that is to be added to the mean of so many samples of a pixel.
    #[inline]
    pub fn radiance(&self, pixel: usize, samples: u32) -> Rgb {
        let of_samples = samples.saturating_sub(self.before) as f32 / samples.max(1) as f32;
        self.sums.get(pixel).map_or(Rgb::BLACK, |sum| *sum * (of_samples / self.paths.max(1) as f32))
    }
}
