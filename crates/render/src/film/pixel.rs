//! What a pixel keeps: the sum of its samples, and what is seen through its middle.

use glam::{DVec3, Vec4};
use umber_math::Rgb;

use crate::aov::Aov;
use crate::format::Pixel;

/// Beyond what single precision can tell of squares.
const LARGEST_VARIANCE: f64 = 1e60;

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

/// What the samples of a pilot, or of one half of it, tell about how many more there should be.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PixelSpread {
    /// Sum of the radiance of the first run.
    first: [f32; 3],
}

impl PixelSpread {
    /// Takes in another sample. `sum`: with it.
    fn add(&mut self, sum: &PixelSum, run: u32) {
        if sum.samples == run {
            self.first = [sum.color[0], sum.color[1], sum.color[2]];
        }
    }
    /// Variance of radiance, channel by channel, as two runs of `run` samples show it: that of a run's mean, times its
    /// samples.
    fn variance(&self, sum: &PixelSum, run: u32) -> DVec3 {
        if run == 0 || sum.samples < 2 * run {
            return DVec3::ZERO;
        }
        let first = DVec3::from(self.first.map(f64::from)) / f64::from(run);
        // of two means: half of the square of their difference, which is twice that from the mean of both
        let off = 2.0 * (first - sum.radiance());
        // one sample that is beyond all measure must not make sums over pixels infinite
        (off * off * (0.5 * f64::from(run))).min(DVec3::splat(LARGEST_VARIANCE))
    }
}

/// The samples of a tile, or of one half of them: row by row, an entry a pixel; without entries where there are none.
#[derive(Clone, Debug, Default)]
pub(crate) struct Samples {
    pub sums: Vec<PixelSum>,
    /// Kept of a pilot.
    pub spreads: Vec<PixelSpread>,
    /// Samples of each of the two runs that spreads tell of.
    run: u32,
}

impl Samples {
    /// Makes room for so many pixels; for what two runs of `run` samples tell, where those are a pilot.
    pub fn prepare(&mut self, pixels: usize, run: Option<u32>) {
        self.sums.resize(pixels, PixelSum::default());
        self.spreads.resize(if run.is_some() { pixels } else { 0 }, PixelSpread::default());
        self.run = run.unwrap_or(0);
    }
    /// Takes all away, and keeps the memory.
    pub fn clear(&mut self) {
        self.sums.clear();
        self.spreads.clear();
    }
    /// Mean radiance of pixel `i`, and the variance that a pilot shows, times samples, channel by channel.
    pub fn spread(&self, i: usize) -> (DVec3, DVec3) {
        let sum = self.sums.get(i).copied().unwrap_or_default();
        let spread = self.spreads.get(i).copied().unwrap_or_default();
        (sum.radiance(), spread.variance(&sum, self.run))
    }
    /// Adds a sample of pixel `i`.
    pub fn add(&mut self, i: usize, rgb: Rgb, coverage: f32) {
        self.sums[i].add(rgb, coverage);
        if let Some(spread) = self.spreads.get_mut(i) {
            spread.add(&self.sums[i], self.run);
        }
    }
}

/// Mean radiance and coverage of a pixel from its halves: each half counts the same, however many samples it
/// has (see `adaptive`). `None` without samples.
pub(super) fn mean(halves: [PixelSum; 2]) -> Option<Vec4> {
    match halves.map(|half| half.samples > 0) {
        [true, true] => {
            let [a, b] = halves.map(|half| half.mean());
            Some(0.5 * (a + b))
        }
        [true, false] => Some(halves[0].mean()),
        [false, true] => Some(halves[1].mean()),
        [false, false] => None,
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
