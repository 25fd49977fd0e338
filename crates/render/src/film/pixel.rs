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

/// The samples of a tile, or of one half of them: row by row, an entry a pixel; without entries where there are none.
#[derive(Clone, Debug, Default)]
pub(crate) struct Samples {
    pub sums: Vec<PixelSum>,
    /// Of a pilot, which is two runs of samples: the sum of radiance of the first.
    first_runs: Vec<[f32; 3]>,
    /// Samples of a run.
    run: u32,
}

impl Samples {
    /// Bytes of a pixel in one of two halves, with a pilot.
    pub const PILOT_BYTES: usize = size_of::<PixelSum>() + size_of::<[f32; 3]>();

    /// Makes room for so many pixels. `run`: how many samples each of the two runs of a pilot has; `None` where it is none.
    pub fn prepare(&mut self, pixels: usize, run: Option<u32>) {
        self.sums.resize(pixels, PixelSum::default());
        self.first_runs.resize(if run.is_some() { pixels } else { 0 }, [0.0; 3]);
        self.run = run.unwrap_or(0);
    }
    /// Takes all away, and keeps the memory.
    pub fn clear(&mut self) {
        self.sums.clear();
        self.first_runs.clear();
    }
    /// Adds a sample of pixel `i`.
    pub fn add(&mut self, i: usize, rgb: Rgb, coverage: f32) {
        let sum = &mut self.sums[i];
        sum.add(rgb, coverage);
        if sum.samples == self.run
            && let Some(first_run) = self.first_runs.get_mut(i)
        {
            *first_run = [sum.color[0], sum.color[1], sum.color[2]];
        }
    }
    /// What the pilot of pixel `i` shows, channel by channel: mean radiance, and the variance of a run's mean times its
    /// samples.
    pub fn mean_and_variance(&self, i: usize) -> (DVec3, DVec3) {
        let sum = self.sums.get(i).copied().unwrap_or_default();
        let (mean, run) = (sum.radiance(), f64::from(self.run));
        let Some(first_run) = self.first_runs.get(i).filter(|_| self.run > 0 && sum.samples >= 2 * self.run) else {
            return (mean, DVec3::ZERO);
        };
        // of two means: half of the square of their difference, which is twice that from the mean of both
        let difference = 2.0 * (DVec3::from(first_run.map(f64::from)) / run - mean);
        // one sample that is beyond all measure must not make sums over pixels infinite
        (mean, (difference * difference * (0.5 * run)).min(DVec3::splat(LARGEST_VARIANCE)))
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
