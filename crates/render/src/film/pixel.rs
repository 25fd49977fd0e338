//! What a pixel keeps: the sum of its samples, and what is seen through its middle.

use glam::{DVec3, Vec4};
use umber_math::Rgb;

use crate::aov::Aov;
use crate::format::Pixel;

/// Beyond what single precision can tell of squares.
const LARGEST_DEVIATION: f64 = 1e30;

/// What all samples of a pixel, or of one half of it, add up to.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PixelSum {
    /// Sum of radiance and coverage.
    pub color: [f32; 4],
    /// How many samples.
    pub samples: u32,
}

impl PixelSum {
    /// One sample.
    pub fn of(rgb: Rgb, coverage: f32) -> Self {
        Self { color: [rgb.0.x, rgb.0.y, rgb.0.z, coverage], samples: 1 }
    }
    /// Adds a sample.
    pub fn add(&mut self, rgb: Rgb, coverage: f32) {
        for (sum, v) in self.color.iter_mut().zip([rgb.0.x, rgb.0.y, rgb.0.z, coverage]) {
            *sum += v;
        }
        self.samples += 1;
    }
    /// Mean radiance, channel by channel; 0 without samples.
    pub fn radiance(&self) -> DVec3 {
        let [r, g, b, _] = self.color.map(f64::from);
        DVec3::new(r, g, b) / f64::from(self.samples.max(1))
    }
    /// Mean radiance and coverage; not a number without samples.
    #[inline]
    pub fn mean(&self) -> Vec4 {
        Vec4::from(self.color) / self.samples as f32
    }
}

/// The samples of a tile, row by row, an entry a pixel.
#[derive(Clone, Debug, Default)]
pub(crate) struct Samples {
    /// In two halves, of which no sample is in both; all are in the first one where nobody asks how much they differ, and
    /// the second has no entries.
    pub halves: [Vec<PixelSum>; 2],
    /// Rays that the samples took, a pixel; without entries where there is one half.
    rays: Vec<u32>,
}

impl Samples {
    /// Bytes of a pixel in so many halves.
    pub fn bytes(halves: usize) -> usize {
        halves * size_of::<PixelSum>() + (halves - 1) * size_of::<u32>()
    }
    /// Makes room for so many pixels in so many halves.
    pub fn prepare(&mut self, pixels: usize, halves: usize) {
        self.halves[..halves].iter_mut().for_each(|half| half.resize(pixels, PixelSum::default()));
        self.rays.resize(if halves > 1 { pixels } else { 0 }, 0);
    }
    /// Takes all away, and keeps the memory.
    pub fn clear(&mut self) {
        self.halves.iter_mut().for_each(Vec::clear);
        self.rays.clear();
    }
    /// Adds a sample of pixel `i` to a half.
    #[inline]
    pub fn add(&mut self, i: usize, half: usize, rgb: Rgb, coverage: f32) {
        self.halves[half][i].add(rgb, coverage);
    }
    /// Counts rays that samples of pixel `i` took.
    #[inline]
    pub fn add_rays(&mut self, i: usize, rays: u64) {
        if let Some(sum) = self.rays.get_mut(i) {
            *sum = sum.saturating_add(rays.min(u32::MAX.into()) as u32);
        }
    }
    /// Rays that the samples of pixel `i` took, where they are counted; else 0.
    pub fn rays(&self, i: usize) -> u32 {
        self.rays.get(i).copied().unwrap_or(0)
    }
    /// The sums of both halves of pixel `i`.
    #[inline]
    pub fn sums(&self, i: usize) -> [PixelSum; 2] {
        self.halves.each_ref().map(|half| half.get(i).copied().unwrap_or_default())
    }
    /// How many samples pixel `i` has.
    #[inline]
    pub fn count(&self, i: usize) -> u32 {
        let [a, b] = self.sums(i);
        a.samples + b.samples
    }
}

/// Mean radiance and coverage of a pixel from its halves, in which all samples count the same. `None` without samples.
pub(super) fn mean([a, b]: [PixelSum; 2]) -> Option<Vec4> {
    let samples = a.samples + b.samples;
    (samples > 0).then(|| (Vec4::from(a.color) + Vec4::from(b.color)) / samples as f32)
}

/// Mean radiance of a pixel, channel by channel; 0 without samples.
pub(crate) fn radiance(halves: [PixelSum; 2]) -> DVec3 {
    mean(halves).map_or(DVec3::ZERO, |mean| mean.truncate().as_dvec3())
}

/// By how much the mean of a pixel is off, channel by channel, as the difference of its halves tells, were they
/// independent; 0 where one has no samples.
pub(crate) fn deviation(halves: [PixelSum; 2]) -> DVec3 {
    let [a, b] = halves.map(|half| f64::from(half.samples));
    let difference = halves[0].radiance() - halves[1].radiance();
    // one sample that is beyond all measure must not make sums over pixels infinite
    (difference * ((a * b).sqrt() / (a + b).max(1.0)))
        .clamp(DVec3::splat(-LARGEST_DEVIATION), DVec3::splat(LARGEST_DEVIATION))
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

pub(super) fn encode(aov: Aov, hit: Option<&CenterHit>) -> [u32; 3] {
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

pub(super) fn decode(aov: Aov, bits: Option<[u32; 3]>) -> Pixel {
    let bits = bits.unwrap_or_else(|| encode(aov, None));
    let row = aov.row();
    if row.format.is_integer() {
        return Pixel::Int(bits[0] as i32);
    }
    let [a, b, c] = bits.map(f32::from_bits);
    Pixel::Float([a, b, c, 1.0], row.format.components())
}
