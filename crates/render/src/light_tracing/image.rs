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
    /// Whether first samples of each pixel went without light paths, so that their weight goes by a pixel's count.
    pub fn begins_late(&self) -> bool {
        self.before > 0
    }
    /// Adds what the paths up to number `until` bring to a film of so many pixels, of which so many samples each were
    /// taken before there were any.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_that_go_without_light_paths_get_nothing_of_them() {
        let mut image = LightImage::default();
        assert_eq!(image.radiance(0, 9), Rgb::BLACK);
        image.add(4, &[Splat { pixel: 1, radiance: Rgb::splat(6.0) }], 2, 9);
        image.add(8, &[Splat { pixel: 1, radiance: Rgb::splat(2.0) }], 2, 9);
        assert_eq!([9, 18, 36].map(|samples| image.radiance(1, samples)), [0.0, 0.5, 0.75].map(Rgb::splat));
        assert_eq!([image.radiance(0, 36), image.radiance(1, 0), image.radiance(2, 36)], [Rgb::BLACK; 3]);
    }
}
