//! Pearson's chi-squared test of sampled densities.
//!
//! One adapter for every density, after Mitsuba's `chi2.py`: draw samples, count them in bins, integrate the
//! claimed density over each bin, compare. Samples that are refused (`None`) are a bin of their own, whose
//! expectation is what the density lacks to one.

use std::f64::consts::PI;

use glam::Vec2;
use statrs::distribution::{ChiSquared, ContinuousCDF};
use umber_math::Vector3;

/// What to draw and how to count it.
#[derive(Clone, Copy, Debug)]
pub struct Chi2Options {
    /// Number of samples.
    pub samples: usize,
    /// Bins along the first and second coordinate (cosine and azimuth for directions).
    pub bins: [usize; 2],
    /// How often a bin is halved along each side, at least. Where the density has edges, more: a sliver may hide
    /// between the sixteen points that are looked at.
    pub min_depth: u32,
    /// How often, at most, to integrate the density to a hundredth of a sample.
    pub max_depth: u32,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Default for Chi2Options {
    fn default() -> Self {
        Self { samples: 100_000, bins: [20, 40], min_depth: 1, max_depth: 7, seed: 1 }
    }
}

/// Outcome of a test.
#[derive(Clone, Copy, Debug)]
pub struct Chi2Outcome {
    /// Σ (count − expectation)² / expectation.
    pub statistic: f64,
    /// Bins that were compared, less one.
    pub degrees_of_freedom: usize,
    /// Probability of a statistic this large or larger if the density is right.
    pub p_value: f64,
    /// Integral of the density over the domain.
    pub integral: f64,
}

impl Chi2Outcome {
    /// Whether the density stands at the significance level, one of `tests` tests made at that level together
    /// (Šidák's correction), and integrates to no more than one (within the error of integration, 0.002).
    pub fn accepted(&self, significance: f64, tests: usize) -> bool {
        self.integral < 1.002 && self.p_value > 1.0 - (1.0 - significance).powf(1.0 / tests.max(1) as f64)
    }
}

/// Tests a density over the sphere by solid angle. Directions are unit; bins are equal in solid angle.
pub fn test_sphere(
    options: Chi2Options,
    mut sample: impl FnMut(Vec2) -> Option<Vector3>,
    pdf_solid_angle: impl Fn(Vector3) -> f32,
) -> Chi2Outcome {
    let to_square = |w: Vector3| {
        let phi = f64::from(w.y()).atan2(f64::from(w.x())) / (2.0 * PI);
        [(f64::from(w.z()) * 0.5 + 0.5).clamp(0.0, 1.0), phi - phi.floor()]
    };
    let direction = |p: [f64; 2]| {
        let (z, phi) = (p[0] * 2.0 - 1.0, p[1] * 2.0 * PI);
        let r = (1.0 - z * z).max(0.0).sqrt();
        Vector3::new((r * phi.cos()) as f32, (r * phi.sin()) as f32, z as f32)
    };
    let density = |p: [f64; 2]| 4.0 * PI * f64::from(pdf_solid_angle(direction(p)));
    test(options, |u| sample(u).map(to_square), density)
}

/// Tests a density over the unit square by area.
pub fn test_square(
    options: Chi2Options,
    mut sample: impl FnMut(Vec2) -> Option<Vec2>,
    pdf_area: impl Fn(Vec2) -> f32,
) -> Chi2Outcome {
    let density = |p: [f64; 2]| f64::from(pdf_area(Vec2::new(p[0] as f32, p[1] as f32)));
    test(options, |u| sample(u).map(|p| [f64::from(p.x), f64::from(p.y)]), density)
}

fn test(
    o: Chi2Options,
    mut sample: impl FnMut(Vec2) -> Option<[f64; 2]>,
    density: impl Fn([f64; 2]) -> f64,
) -> Chi2Outcome {
    let [nx, ny] = o.bins;
    let mut counts = vec![0.0; nx * ny + 1];
    let mut random = SplitMix(o.seed);
    for _ in 0..o.samples {
        let u = Vec2::new(random.next(), random.next());
        let bin = sample(u).map_or(nx * ny, |p| {
            let at = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
            at(p[0], nx) * ny + at(p[1], ny)
        });
        counts[bin] += 1.0;
    }
    let n = o.samples as f64;
    let tolerance = 0.01 / n;
    let cell = |i: usize| {
        let (x, y) = ((i / ny) as f64 / nx as f64, (i % ny) as f64 / ny as f64);
        integrate(&density, [x, y], [1.0 / nx as f64, 1.0 / ny as f64], tolerance, o)
    };
    let mut expected: Vec<f64> = (0..nx * ny).map(|i| cell(i) * n).collect();
    let integral = expected.iter().sum::<f64>() / n;
    expected.push((n - integral * n).max(0.0));
    let (statistic, degrees_of_freedom) = pearson(&counts, &expected);
    let p_value = ChiSquared::new(degrees_of_freedom.max(1) as f64).map_or(0.0, |d| d.sf(statistic));
    Chi2Outcome { statistic, degrees_of_freedom, p_value, integral }
}

/// The statistic and its degrees of freedom; bins with fewer than five expected samples are pooled.
fn pearson(counts: &[f64], expected: &[f64]) -> (f64, usize) {
    let term = |c: f64, e: f64| (c - e) * (c - e) / e;
    let (mut statistic, mut bins, mut pool) = (0.0, 0usize, (0.0, 0.0));
    for (&c, &e) in counts.iter().zip(expected) {
        if e >= 5.0 {
            statistic += term(c, e);
            bins += 1;
        } else {
            pool = (pool.0 + c, pool.1 + e);
        }
    }
    if pool.1 >= 5.0 {
        statistic += term(pool.0, pool.1);
        bins += 1;
    } else if pool.0 > 10.0 + 10.0 * pool.1 {
        // Samples where the density says there are none.
        statistic = f64::INFINITY;
    }
    (statistic, bins.saturating_sub(1))
}

/// Integral over a box: 4 × 4 Gauss points, refined where the four quarters disagree with the whole.
fn integrate(f: &impl Fn([f64; 2]) -> f64, at: [f64; 2], size: [f64; 2], tolerance: f64, o: Chi2Options) -> f64 {
    refine(f, [at, size], gauss(f, at, size), tolerance, [o.min_depth, o.max_depth])
}

/// `depth`: halvings that must and that may follow.
fn refine(f: &impl Fn([f64; 2]) -> f64, [at, size]: [[f64; 2]; 2], whole: f64, tolerance: f64, depth: [u32; 2]) -> f64 {
    let half = [size[0] * 0.5, size[1] * 0.5];
    let quarters = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|c| {
        let corner = [at[0] + c[0] * half[0], at[1] + c[1] * half[1]];
        (corner, gauss(f, corner, half))
    });
    let sum: f64 = quarters.iter().map(|q| q.1).sum();
    if depth[1] == 0 || (depth[0] == 0 && (sum - whole).abs() <= tolerance) {
        return sum;
    }
    let deeper = depth.map(|d| d.saturating_sub(1));
    quarters.iter().map(|&(corner, part)| refine(f, [corner, half], part, tolerance * 0.5, deeper)).sum()
}

fn gauss(f: &impl Fn([f64; 2]) -> f64, at: [f64; 2], size: [f64; 2]) -> f64 {
    const NODES: [(f64, f64); 4] = [
        (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
        (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
        (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
        (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
    ];
    let mut sum = 0.0;
    for (x, wx) in NODES {
        for (y, wy) in NODES {
            sum += wx * wy * f([at[0] + x * size[0], at[1] + y * size[1]]);
        }
    }
    sum * size[0] * size[1]
}

/// Steele et al. 2014: independent of the samplers under test.
struct SplitMix(u64);

impl SplitMix {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 40) as f32 / (1 << 24) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp;

    #[test]
    fn a_right_density_is_accepted_and_wrong_ones_are_refused() {
        let o = Chi2Options::default();
        let sample = |u| Some(warp::cosine_hemisphere(u));
        let right = test_sphere(o, sample, |w| warp::cosine_hemisphere_pdf_solid_angle(w.z()));
        assert!(right.accepted(0.01, 1) && (right.integral - 1.0).abs() < 1e-4, "{right:?}");
        let wrong = test_sphere(o, sample, |w| if w.z() > 0.0 { 0.5 / PI as f32 } else { 0.0 });
        assert!(!wrong.accepted(0.01, 1), "{wrong:?}");
        let scaled = test_sphere(o, sample, |w| 1.02 * warp::cosine_hemisphere_pdf_solid_angle(w.z()));
        assert!(!scaled.accepted(0.01, 1), "{scaled:?}");
        let elsewhere = test_sphere(o, sample, |w| warp::cosine_hemisphere_pdf_solid_angle(-w.z()));
        assert!(!elsewhere.accepted(0.01, 1), "{elsewhere:?}");
    }

    #[test]
    fn refused_samples_are_counted() {
        let o = Chi2Options::default();
        let sample = |u: Vec2| (u.x < 0.5).then_some(u);
        assert!(test_square(o, sample, |p| if p.x < 0.5 { 1.0 } else { 0.0 }).accepted(0.01, 1));
        assert!(!test_square(o, sample, |p| if p.x < 0.5 { 2.0 } else { 0.0 }).accepted(0.01, 1));
    }
}
