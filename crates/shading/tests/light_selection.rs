//! Choosing lights: probabilities are those of sampling, and no light that matters is left out.

use glam::Vec2;
use umber_math::{DAffine3, DVec3, Normal3, Point3};
use umber_sampling::Sampler;
use umber_shading::{Light, LightKind, LightParams, LightSampler, Receiver};

fn random(i: u32, salt: u64) -> [f64; 4] {
    let mut s = Sampler::new(salt, [i, 7], 0);
    let (a, b) = (s.next_2d(), s.next_2d());
    [a.x, a.y, b.x, b.y].map(f64::from)
}

/// Rectangles, spheres and points strewn over a box of 20 units.
fn lamps(n: u32) -> Vec<Light> {
    let lamp = |i| {
        let [x, y, z, w] = random(i, 1);
        let kind = match i % 4 {
            0 | 1 => LightKind::Rect { width: 0.5, height: 0.2 + w as f32 },
            2 => LightKind::Sphere { radius: 0.1 + w as f32, treat_as_point: false },
            _ => LightKind::Sphere { radius: 0.2, treat_as_point: true },
        };
        let turn = DAffine3::from_rotation_x(w * 6.0) * DAffine3::from_rotation_y(x * 6.0);
        let place = DAffine3::from_translation((DVec3::new(x, y, z) - 0.5) * 20.0);
        let intensity = if i == 2 { 0.0 } else { 1.0 + 10.0 * (y as f32) };
        let p = LightParams { render_from_light: place * turn, intensity, ..LightParams::new(kind) };
        Light::new(&p).unwrap().0
    };
    (0..n).map(lamp).collect()
}

fn sky() -> [Light; 2] {
    let light = |kind, intensity| Light::new(&LightParams { intensity, ..LightParams::new(kind) }).unwrap().0;
    [light(LightKind::Dome { texture: None }, 0.01), light(LightKind::Distant { angle_deg: 0.5 }, 3.0)]
}

fn points() -> impl Iterator<Item = Point3> {
    (0..24).map(|i| {
        let [x, y, z, w] = random(i, 2);
        Point3(((DVec3::new(x, y, z) - 0.5) * if w < 0.2 { 400.0 } else { 22.0 }).as_vec3())
    })
}

/// The points, each receiving from all around and on one side, whichever.
fn receivers() -> impl Iterator<Item = Receiver> {
    points().zip(0..).flat_map(|(point, i)| {
        let normal =
            Normal3::from(random(i, 3).map(|v| v as f32 - 0.5).first_chunk::<3>().copied().unwrap_or_default());
        [Receiver::all_around(point), Receiver { normal: normal.normalized(), ..Receiver::all_around(point) }]
    })
}

#[test]
fn probabilities_are_those_of_sampling() {
    for n in [0, 1, 2, 5, 16, 17, 256] {
        let mut lights = lamps(n);
        if n != 1 {
            lights.extend(sky());
        }
        let sampler = LightSampler::new(&lights, 12.0);
        for r in receivers() {
            let samples = 1 << 12;
            let mut counts = vec![0u32; lights.len()];
            for i in 0..samples {
                let Some((index, pmf)) = sampler.sample(&r, (i as f32 + 0.5) / samples as f32) else { continue };
                counts[index] += 1;
                let claimed = sampler.pmf(&r, index);
                assert!((pmf - claimed).abs() <= 1e-5 * pmf && pmf > 0.0, "{n} lights: {pmf} but {claimed}");
            }
            let total: f32 = (0..lights.len()).map(|i| sampler.pmf(&r, i)).sum();
            assert!(total <= 1.0 + 1e-4, "{total}");
            for (index, &count) in counts.iter().enumerate() {
                // One number a light and one rounding: at even spacing each light is met as often as its probability says.
                let (share, pmf) = (count as f32 / samples as f32, sampler.pmf(&r, index));
                assert!(
                    (share - pmf).abs() < 2.5 / samples as f32 + 1e-4,
                    "{n} lights, light {index}: {share} but {pmf}"
                );
            }
        }
    }
}

#[test]
fn every_light_that_reaches_a_point_can_be_chosen() {
    for n in [9, 100] {
        let lights = lamps(n);
        let sampler = LightSampler::new(&lights, 12.0);
        for r in receivers() {
            for (index, light) in lights.iter().enumerate() {
                let reaches = light.sample(r.point, Vec2::splat(0.5)).is_some_and(|s| {
                    let is_above = r.normal == Normal3::ZERO || s.wi.dot_normal(r.normal) > 0.0;
                    is_above && !s.radiance.is_black()
                });
                let pmf = sampler.pmf(&r, index);
                assert!(pmf > 0.0 || !reaches, "light {index} of {n} at {r:?}");
                assert!(pmf == 0.0 || !light.is_black());
            }
        }
    }
}

#[test]
fn near_and_bright_lights_are_preferred() {
    for n in [12, 200] {
        let lights = lamps(n);
        let sampler = LightSampler::new(&lights, 12.0);
        // The variance of one light's contribution over its probability, against choosing evenly.
        let (mut chosen, mut even) = (0.0, 0.0);
        for p in points() {
            let contribution = |l: &Light| {
                let s = l.sample(p, Vec2::splat(0.5))?;
                Some(f64::from(s.radiance.0.x / s.pdf_solid_angle))
            };
            let values: Vec<f64> = lights.iter().map(|l| contribution(l).unwrap_or(0.0)).collect();
            let mean: f64 = values.iter().sum();
            let second = |pmf: &dyn Fn(usize) -> f64| {
                let terms = values.iter().enumerate().filter(|(_, v)| **v > 0.0);
                terms.map(|(i, v)| v * v / pmf(i)).sum::<f64>() / (mean * mean) - 1.0
            };
            chosen += second(&|i| f64::from(sampler.pmf(&Receiver::all_around(p), i)));
            even += second(&|_| 1.0 / lights.len() as f64);
        }
        assert!(chosen < 0.25 * even, "{n} lights: {chosen}, evenly {even}");
    }
}

#[test]
fn odd_scenes_are_survived() {
    assert!(
        LightSampler::new(&[], 1.0).is_empty()
            && LightSampler::new(&[], 1.0).sample(&Receiver::all_around(Point3::ZERO), 0.5).is_none()
    );
    let dark = lamps(3).split_off(2);
    let sampler = LightSampler::new(&dark, 1.0);
    assert!(
        sampler.is_empty()
            && sampler.sample(&Receiver::all_around(Point3::ZERO), 0.5).is_none()
            && sampler.pmf(&Receiver::all_around(Point3::ZERO), 0) == 0.0
    );
    let one = LightSampler::new(&lamps(1), 1.0);
    assert_eq!(
        (
            one.sample(&Receiver::all_around(Point3::ZERO), 0.9),
            one.pmf(&Receiver::all_around(Point3::ZERO), 0),
            one.pmf(&Receiver::all_around(Point3::ZERO), 1)
        ),
        (Some((0, 1.0)), 1.0, 0.0)
    );
    // Many lights in one place, some far too bright, and points nowhere.
    let same =
        LightParams { exposure: 300.0, ..LightParams::new(LightKind::Sphere { radius: 1.0, treat_as_point: true }) };
    let mut lights: Vec<Light> = (0..100).map(|_| Light::new(&same).unwrap().0).collect();
    lights.extend(lamps(40));
    for radius in [0.0, 1.0, 1e30, f32::NAN] {
        let sampler = LightSampler::new(&lights, radius);
        for p in [
            Point3::ZERO,
            Point3::new(f32::NAN, 0.0, 0.0),
            Point3::new(1e30, 0.0, 0.0),
            Point3::new(f32::INFINITY, 0.0, 0.0),
        ] {
            for u in [0.0, 0.5, 0.999_999_94] {
                if let Some((index, pmf)) = sampler.sample(&Receiver::all_around(p), u) {
                    assert!(index < lights.len() && pmf > 0.0 && pmf <= 1.0, "{index} {pmf}");
                }
            }
        }
    }
}

/// Lights below the horizon of a receiver are not chosen, those right on it are.
#[test]
fn the_horizon_divides_lights() {
    let lamp = |height: f64| {
        let render_from_light = DAffine3::from_translation(DVec3::new(3.0, 0.0, height));
        let kind = LightKind::Sphere { radius: 0.5, treat_as_point: false };
        Light::new(&LightParams { render_from_light, ..LightParams::new(kind) }).unwrap().0
    };
    let up = Receiver { normal: Normal3::new(0.0, 0.0, 1.0), ..Receiver::all_around(Point3::ZERO) };
    for extra in [0, 40] {
        let mut lights = vec![lamp(2.0), lamp(-0.45), lamp(-0.55), lamp(-9.0)];
        lights.extend((0..extra).map(|i| lamp(-20.0 - f64::from(i))));
        let sampler = LightSampler::new(&lights, 50.0);
        let pmf = |i| sampler.pmf(&up, i);
        assert!(pmf(0) > pmf(1) && pmf(1) > 0.0, "{} {}", pmf(0), pmf(1));
        assert!((2..lights.len()).all(|i| pmf(i) == 0.0));
    }
}

/// Lamps of a ceiling over a floor: ten thousand are chosen among nearly as well as few, and with next to none of the
/// noise that choosing evenly leaves.
#[test]
fn ten_thousand_lights() {
    let lamp = |i: u32| {
        let [x, y, _, w] = random(i, 9);
        let place = DVec3::new(x * 100.0 - 50.0, y * 100.0 - 50.0, 3.0);
        let render_from_light = DAffine3::from_translation(place);
        let kind = LightKind::Rect { width: 0.2, height: 0.2 };
        let intensity = 10f32.powf(2.0 * w as f32);
        Light::new(&LightParams { render_from_light, intensity, ..LightParams::new(kind) }).unwrap().0
    };
    let lights: Vec<Light> = (0..10_000).map(lamp).collect();
    let sampler = LightSampler::new(&lights, 70.0);
    let (mut worst, mut chosen, mut even) = (0f64, 0.0, 0.0);
    for i in 0..24 {
        let [x, y, ..] = random(i, 10);
        let point = Point3::new(x as f32 * 80.0 - 40.0, y as f32 * 80.0 - 40.0, 0.0);
        let r = Receiver { normal: Normal3::new(0.0, 0.0, 1.0), ..Receiver::all_around(point) };
        let value = |l: &Light| {
            let s = l.sample(point, Vec2::splat(0.5)).unwrap();
            f64::from(s.radiance.0.x * s.wi.z() / s.pdf_solid_angle)
        };
        let values: Vec<f64> = lights.iter().map(value).collect();
        let exact: f64 = values.iter().sum();
        let pmfs: Vec<f64> = (0..lights.len()).map(|i| f64::from(sampler.pmf(&r, i))).collect();
        assert!((pmfs.iter().sum::<f64>() - 1.0).abs() < 1e-3);
        let variance = |pmf: &dyn Fn(usize) -> f64| {
            values.iter().enumerate().map(|(i, v)| v * v / pmf(i)).sum::<f64>() / (exact * exact) - 1.0
        };
        chosen += variance(&|i| pmfs[i]);
        even += variance(&|_| 1e-4);
        // What sampling gives has that mean and that variance.
        let (mut sum, samples) = (0.0, 4096);
        for k in 0..samples {
            let (index, pmf) = sampler.sample(&r, (k as f32 + 0.5) / samples as f32).unwrap();
            assert!((f64::from(pmf) - pmfs[index]).abs() <= 1e-4 * pmfs[index]);
            sum += values[index] / f64::from(pmf) / f64::from(samples);
        }
        let off = (sum / exact - 1.0).abs() / (variance(&|i| pmfs[i]) / f64::from(samples)).sqrt();
        worst = worst.max(off);
    }
    assert!(worst < 4.5, "{worst} standard deviations off");
    assert!(chosen < even / 100.0, "relative variance {chosen}, evenly {even}");
}
