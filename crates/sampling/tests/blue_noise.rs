//! Blue noise over pixels: what first samples of neighbours have to do with each other.

use std::f64::consts::TAU;

use glam::Vec2;
use umber_sampling::Sampler;
use umber_sampling::chi2::{Chi2Options, test_square};

/// Pixels to each side of a block, the period of the mask.
const SIDE: u32 = 64;
/// Those of the film, and of early and late path vertices.
const SETS: [u32; 9] = [0, 4, 5, 6, 7, 12, 13, 60, 90];

fn sampler(seed: u64, [x, y]: [u32; 2], set: u32) -> Sampler {
    let mut sampler = Sampler::blue_noise(seed, [x, y], 0);
    sampler.start_dimension(set);
    sampler
}

/// A function of the first samples of a block of pixels anywhere.
fn block(of: impl Fn([u32; 2]) -> f32) -> Vec<f64> {
    (0..SIDE * SIDE).map(|i| f64::from(of([1000 + i % SIDE, 33 + i / SIDE]))).collect()
}

/// First samples of all sets: each of two dimensions, and of one.
fn blocks(seed: u64) -> Vec<(String, Vec<f64>)> {
    let of_set = |set: u32| {
        let flat = block(|pixel| sampler(seed, pixel, set).next_1d());
        let planar = [0, 1].map(|d| block(|pixel| sampler(seed, pixel, set).next_2d()[d]));
        let [x, y] = planar;
        [("of one", flat), ("0 of two", x), ("1 of two", y)].map(|(name, v)| (format!("set {set}, {name}"), v))
    };
    SETS.into_iter().flat_map(of_set).collect()
}

/// Mean power of a block of numbers at frequencies from `low` up to `high`, in cycles a block, as a multiple of that of
/// white noise that is uniform in [0, 1).
fn power(values: &[f64], low: f64, high: f64) -> f64 {
    let side = f64::from(SIDE);
    let power_at = |fx: f64, fy: f64| {
        let (mut re, mut im) = (0.0, 0.0);
        for (i, v) in values.iter().enumerate() {
            let (x, y) = ((i as u32 % SIDE) as f64, (i as u32 / SIDE) as f64);
            let (sin, cos) = (TAU * (fx * x + fy * y) / side).sin_cos();
            (re, im) = (re + (v - 0.5) * cos, im + (v - 0.5) * sin);
        }
        (re * re + im * im) * 12.0 / (side * side)
    };
    let reach = high.ceil() as i32;
    // half of the plane is all, as the other half is its mirror
    let plane = (0..=reach).flat_map(|fx| (-reach..=reach).map(move |fy| [f64::from(fx), f64::from(fy)]));
    let powers: Vec<f64> = plane
        .filter(|[fx, fy]| (low..high).contains(&fx.hypot(*fy)) && (*fx > 0.0 || *fy > 0.0))
        .map(|[fx, fy]| power_at(fx, fy))
        .collect();
    powers.iter().sum::<f64>() / powers.len() as f64
}

/// Below a quarter of the Nyquist frequency.
fn low_power(values: &[f64]) -> f64 {
    power(values, 1.0, f64::from(SIDE) / 8.0)
}

#[test]
fn every_stratum_has_its_share_of_the_pixels() {
    for (name, values) in blocks(1) {
        let mut counts = [0u32; 16];
        for v in values {
            counts[(v * 16.0) as usize] += 1;
        }
        assert!(counts.iter().all(|n| n.abs_diff(SIDE * SIDE / 16) <= 1), "{name}: {counts:?}");
    }
}

#[test]
fn first_samples_are_blue_noise() {
    for seed in [0, 1, 1 << 32] {
        for (name, values) in blocks(seed) {
            let low = low_power(&values);
            assert!(low < 0.1, "seed {seed}, {name}: {low}");
        }
    }
    let white = block(|pixel| Sampler::new(0, pixel, 0).next_1d());
    assert!((low_power(&white) - 1.0).abs() < 0.4, "{}", low_power(&white));
}

/// Low-frequency power of the mean of a pixel's first samples, relative to that of pixels by themselves.
fn relative_low_power(samples: u32, of: impl Fn(Vec2) -> f32) -> f64 {
    let [blue, white] = [Sampler::blue_noise, Sampler::new].map(|new| {
        let of_seed = |seed| {
            let mean = |pixel| (0..samples).map(|i| of(new(seed, pixel, i).next_2d())).sum::<f32>() / samples as f32;
            low_power(&block(mean))
        };
        (0..8).map(of_seed).sum::<f64>()
    });
    blue / white
}

#[test]
fn means_of_few_samples_are_bluish() {
    for (samples, most) in [(1, 0.1), (2, 0.85), (16, 1.2)] {
        let of_number = relative_low_power(samples, |p| p.x);
        let of_step = relative_low_power(samples, |p| f32::from(p.y < 0.37));
        println!("{samples} samples: {of_number} of a number, {of_step} of a step");
        assert!(of_number < most && of_step < most, "{samples} samples: {of_number}, {of_step}");
    }
    let of_disk = relative_low_power(1, |p| f32::from(p.length() < 0.8));
    assert!(of_disk < 0.7, "{of_disk}");
}

/// Pixels a period apart share their first sample, and no other.
#[test]
fn later_samples_do_not_repeat() {
    let points = |pixel| [0, 1, 2].map(|sample| Sampler::blue_noise(3, pixel, sample).next_2d());
    for (x, y) in (0..SIDE).map(|i| (i, i * 7 % SIDE)) {
        let [a, b, c] = [[x, y], [x + SIDE, y], [x, y + SIDE]].map(points);
        assert!(a[0] == b[0] && a[0] == c[0]);
        assert!([1, 2].iter().all(|i| a[*i] != b[*i] && a[*i] != c[*i]));
    }
}

/// Over pixels, any two numbers together fill the square as if they were independent.
#[test]
fn dimensions_are_decorrelated() {
    const CELLS: usize = 8;
    let values: Vec<_> = SETS
        .into_iter()
        .flat_map(|set| {
            [0, 1].map(|d| (format!("dimension {d} of set {set}"), block(|pixel| sampler(5, pixel, set).next_2d()[d])))
        })
        .collect();
    let expected = f64::from(SIDE * SIDE) / (CELLS * CELLS) as f64;
    for (i, (name, a)) in values.iter().enumerate() {
        for (other, b) in &values[..i] {
            let mut counts = [0.0; CELLS * CELLS];
            for (a, b) in a.iter().zip(b) {
                counts[(a * CELLS as f64) as usize * CELLS + (b * CELLS as f64) as usize] += 1.0;
            }
            let statistic = counts.iter().map(|n| (n - expected) * (n - expected) / expected).sum::<f64>();
            // 49 ± 10 where they are independent, 28672 where they are the same
            assert!(statistic < 130.0, "{name} and {other}: {statistic}");
        }
    }
}

/// At a pixel, over seeds: every sample is uniform, and so is the pair of two sets.
#[test]
fn uniform_over_seeds() {
    for (pixel, set, sample) in [([0, 0], 0, 0), ([17, 40], 7, 0), ([1919, 5], 4, 0), ([3, 2], 5, 1), ([9, 9], 12, 6)] {
        let point = |seed| {
            let mut sampler = Sampler::blue_noise(seed, pixel, sample);
            sampler.start_dimension(set);
            sampler
        };
        for two_sets in [false, true] {
            let mut seed = 0;
            let draw = |_| {
                seed += 1;
                let mut s = point(seed);
                Some(if two_sets { Vec2::new(s.next_1d(), s.next_1d()) } else { s.next_2d() })
            };
            let outcome = test_square(Chi2Options { bins: [16, 16], ..Chi2Options::default() }, draw, |_| 1.0);
            assert!(outcome.accepted(0.01, 10), "{pixel:?}, set {set}, sample {sample}: {outcome:?}");
        }
    }
}

/// Over seeds, the streams of a seed are independent, as the colours of an adaptive picture have to be.
#[test]
fn streams_are_independent() {
    let mut seed = 0;
    let draw = |_| {
        seed += 1;
        let [a, b] = [1, 2].map(|stream: u64| sampler(stream << 32 | seed, [11, 13], 6).next_1d());
        Some(Vec2::new(a, b))
    };
    let outcome = test_square(Chi2Options { bins: [16, 16], ..Chi2Options::default() }, draw, |_| 1.0);
    assert!(outcome.accepted(0.01, 1), "{outcome:?}");
}
