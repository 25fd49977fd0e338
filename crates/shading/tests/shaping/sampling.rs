//! Shaped lights are sampled, met, weighed and chosen as they shine.

use std::f32::consts::PI;

use glam::Vec2;
use umber_math::{DAffine3, DVec3, Point3, Ray, Rgb, Vector3};
use umber_sampling::Sampler;
use umber_sampling::chi2::{Chi2Options, test_sphere};
use umber_shading::{Light, LightKind, LightParams, LightSampler, Receiver, ShapingParams};

use crate::{BALL, POINT, RECT, close, cone, factors, ies, light, lm63, shaped};

#[test]
fn both_ways_to_the_light_see_the_same() {
    let text = lm63(
        &[0.0, 30.0, 60.0, 180.0],
        &[0.0, 90.0, 180.0, 270.0],
        &[8.0, 4.0, 2.0, 0.5, 8.0, 6.0, 0.0, 0.5, 8.0, 1.0, 1.0, 0.5, 8.0, 3.0, 5.0, 0.5],
    );
    let profile = ies(&text, 0.7, false).ies;
    let tint = Rgb::new(0.1, 0.9, 0.4);
    let shaping = ShapingParams { focus: 2.0, focus_tint: tint, ies: profile, ..cone(70.0, 0.5) };
    let factor = factors(&shaping);
    // A scale and a mirror: the directions are those of the turned axes.
    let place = DAffine3::from_translation(DVec3::new(0.3, 0.2, 2.0))
        * DAffine3::from_rotation_y(0.4)
        * DAffine3::from_scale(DVec3::new(-2.0, 0.5, 3.0));
    for kind in [RECT, BALL] {
        let l = light(&LightParams { render_from_light: place, ..shaped(kind.clone(), shaping.clone()) });
        let (mut lit, mut dark) = (0, 0);
        for i in 0..400 {
            let mut s = Sampler::new(1, [i, 3], 0);
            let (a, b) = (s.next_2d(), s.next_2d());
            let p = Point3::new(a.x * 12.0 - 6.0, a.y * 12.0 - 6.0, b.x * 2.0 - 1.0);
            let Some(sample) = l.sample(p, s.next_2d()) else { continue };
            let Some(hit) = l.intersect(&Ray::new(p, sample.wi * 3.0)) else { continue };
            let difference = (hit.radiance - sample.radiance).0.abs().max_element();
            assert!(difference < 1e-3, "{kind:?} from {p:?}: {hit:?} {sample:?}");
            // The axes turn, but are not stretched; the mirror sets X the other way round.
            let e = DAffine3::from_rotation_y(-0.4).transform_vector3(-sample.wi.0.as_dvec3());
            let e = Vector3::new(-e.x as f32, e.y as f32, e.z as f32);
            let off_axis = (-e.z()).acos().to_degrees();
            let want = factor(off_axis, (-e.y()).atan2(-e.x()).to_degrees());
            assert!((want - sample.radiance).0.abs().max_element() < 1e-3, "{kind:?} from {p:?}: {sample:?}");
            if sample.radiance.is_black() { dark += 1 } else { lit += 1 }
        }
        assert!(lit > 30 && dark > 30, "{lit} {dark}");
    }
}

#[test]
fn densities_are_those_of_the_unshaped_light() {
    let o = Chi2Options { samples: 40_000, bins: [16, 32], min_depth: 3, ..Chi2Options::default() };
    for kind in [RECT, BALL] {
        let at = DAffine3::from_translation(DVec3::new(0.1, 0.2, 0.8));
        let l = light(&LightParams { render_from_light: at, ..shaped(kind, cone(25.0, 0.3)) });
        let outcome =
            test_sphere(o, |u| l.sample(Point3::ZERO, u).map(|s| s.wi), |w| l.pdf_solid_angle(Point3::ZERO, w));
        assert!(outcome.accepted(0.01, 2) && (outcome.integral - 1.0).abs() < 3e-3, "{outcome:?}");
    }
}

/// Flux by uniform directions of a small light's intensity, far away.
fn flux(p: &LightParams) -> f32 {
    let l = light(p);
    let n = 40_000;
    let sum: f64 = (0..n)
        .map(|i| {
            let mut s = Sampler::new(5, [1, 1], i);
            let p = Point3::ZERO + umber_sampling::warp::uniform_sphere(s.next_2d()) * 1e3;
            let sample = l.sample(p, Vec2::splat(0.5));
            sample.map_or(0.0, |s| f64::from(s.radiance.luminance() / s.pdf_solid_angle * 1e6))
        })
        .sum();
    (sum / f64::from(n)) as f32 * 4.0 * PI
}

#[test]
fn powers_are_the_integrals_of_their_light() {
    let text = lm63(&[0.0, 30.0, 60.0, 180.0], &[0.0, 180.0], &[8.0, 4.0, 2.0, 0.5, 8.0, 1.0, 1.0, 0.5]);
    let up = lm63(&[90.0, 170.0, 180.0], &[0.0], &[0.0, 1.0, 50.0]);
    let focus = |focus| ShapingParams { focus, ..ShapingParams::default() };
    for (name, shaping) in [
        ("cone", cone(30.0, 0.0)),
        ("wide cone", cone(140.0, 0.0)),
        ("soft cone", cone(50.0, 0.8)),
        ("focus", focus(8.0)),
        ("tint", ShapingParams { focus_tint: Rgb::new(0.5, 0.0, 1.0), ..focus(4.0) }),
        ("profile", ies(&text, 0.0, false)),
        ("profile in a cone", ShapingParams { ies: ies(&text, 1.5, true).ies, ..cone(60.0, 0.2) }),
        ("profile upwards", ies(&up, 0.0, false)),
        ("scaled profile upwards", ies(&up, -0.5, false)),
    ] {
        for kind in [RECT, BALL, POINT] {
            let is_rect = matches!(kind, LightKind::Rect { .. });
            if is_rect && name.ends_with("upwards") {
                assert!(light(&shaped(kind, shaping.clone())).power_estimate(1.0) < 1e-5);
                continue;
            }
            let p = shaped(kind, shaping.clone());
            let (got, want) = (light(&p).power_estimate(1.0), flux(&p));
            assert!(close(got, want, 0.04 * want), "{name} {:?}: {got}, not {want}", p.kind);
        }
    }
    // Beams far narrower than the steps of any sum over all directions.
    let narrow = |s: ShapingParams| light(&shaped(POINT, s)).power_estimate(1.0);
    let whole = narrow(ShapingParams::default());
    assert!(close(narrow(cone(0.1, 0.0)) / whole, (0.5 * 0.1f32.to_radians()).powi(2), 1e-8));
    assert!(close(narrow(focus(1e4)) / whole, 1e-4, 1e-5), "{}", narrow(focus(1e4)) / whole);
}

/// Spots, one on 25 square units, that look down on a floor, at different places and a little askew.
fn spots(count: u32, shaping: &ShapingParams) -> Vec<Light> {
    let side = 5.0 * f64::from(count).sqrt();
    let spot = |i: u32| {
        let mut s = Sampler::new(9, [i, 2], 0);
        let (a, b) = (s.next_2d(), s.next_2d());
        let turn = DAffine3::from_rotation_x(f64::from(b.x) - 0.5) * DAffine3::from_rotation_y(f64::from(b.y) - 0.5);
        let place = DAffine3::from_translation(DVec3::new(f64::from(a.x) * side, f64::from(a.y) * side, 3.0));
        let kind = match i % 3 {
            0 => RECT,
            1 => BALL,
            _ => POINT,
        };
        light(&LightParams { render_from_light: place * turn, intensity: 1.0 + b.x, ..shaped(kind, shaping.clone()) })
    };
    (0..count).map(spot).collect()
}

/// What of a light arrives at a point, about.
fn arriving(l: &Light, p: Point3, seed: u32) -> f64 {
    let one = |k| {
        let u = Sampler::new(4, [seed, 2], k).next_2d();
        l.sample(p, u).map_or(0.0, |s| f64::from(s.radiance.luminance() / s.pdf_solid_angle))
    };
    (0..16).map(one).sum::<f64>() / 16.0
}

#[test]
fn spots_are_chosen_where_they_shine() {
    let beam = lm63(
        &[0.0, 5.0, 20.0, 40.0],
        &[0.0, 90.0, 180.0, 270.0],
        &[9.0, 9.0, 2.0, 0.0, 9.0, 5.0, 1.0, 0.0, 9.0, 3.0, 0.0, 0.0, 9.0, 8.0, 4.0, 0.0],
    );
    let focused = ShapingParams { focus: 40.0, ..cone(60.0, 0.0) };
    // One by one, and in a tree.
    for (count, goals) in [(16, [0.01, 0.1, 0.05]), (100, [0.7, 0.95, 0.9])] {
        let kinds = [("cones", cone(20.0, 0.3)), ("focus", focused.clone()), ("profiles", ies(&beam, 0.0, false))];
        for ((name, shaping), goal) in kinds.into_iter().zip(goals) {
            let lights = spots(count, &shaping);
            let sampler = LightSampler::new(&lights, 15.0);
            let blind = LightSampler::new(&spots(count, &ShapingParams::default()), 15.0);
            let (mut with, mut without) = (0.0, 0.0);
            for i in 0..300 {
                let a = Sampler::new(4, [i, 1], 0).next_2d();
                let side = 5.0 * (count as f32).sqrt();
                let p = Point3::new(a.x * side, a.y * side, 0.0);
                let values: Vec<f64> = lights.iter().map(|l| arriving(l, p, i)).collect();
                let mean: f64 = values.iter().sum();
                let variance = |sampler: &LightSampler| {
                    let lit = values.iter().enumerate().filter(|(_, v)| **v > 0.0);
                    lit.map(|(i, v)| v * v / f64::from(sampler.pmf(&Receiver::all_around(p), i))).sum::<f64>()
                        - mean * mean
                };
                assert!(variance(&sampler).is_finite(), "{name}: a light that reaches {p:?} is never chosen");
                with += variance(&sampler);
                without += variance(&blind);
            }
            assert!(with < goal * without, "{count} {name}: variance {with}, blind {without}");
        }
    }
}
