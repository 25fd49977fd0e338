//! Shaping of lights by the formulas of UsdLux' ShapingAPI, and what it does to sampling and choosing.

use std::f32::consts::{PI, TAU};
use std::sync::Arc;

use glam::Vec2;
use umber_math::{DAffine3, DVec3, Point3, Ray, Rgb, Vector3};
use umber_sampling::Sampler;
use umber_sampling::chi2::{Chi2Options, test_sphere};
use umber_shading::{
    IesParams, IesProfile, Light, LightKind, LightParams, LightProblem, LightSampler, ShadowParams, ShapingParams,
};

const RECT: LightKind = LightKind::Rect { width: 0.5, height: 0.25 };
const BALL: LightKind = LightKind::Sphere { radius: 0.5, treat_as_point: false };
const POINT: LightKind = LightKind::Sphere { radius: 0.5, treat_as_point: true };

fn shaped(kind: LightKind, shaping: ShapingParams) -> LightParams {
    LightParams { shaping, ..LightParams::new(kind) }
}
fn cone(angle: f32, softness: f32) -> ShapingParams {
    ShapingParams { cone_angle_deg: angle, cone_softness: softness, ..ShapingParams::default() }
}
fn light(p: &LightParams) -> Light {
    let (light, problems) = Light::new(p).unwrap();
    assert_eq!(problems, []);
    light
}
fn ies(text: &str, angle_scale: f32, normalize: bool) -> ShapingParams {
    let profile = Arc::new(IesProfile::from_text(text).unwrap());
    ShapingParams { ies: Some(IesParams { profile, angle_scale, normalize }), ..ShapingParams::default() }
}
/// The direction in light space at an angle off the axis −Z and around it; 0 around is −X, 90° −Y.
fn emitted(off_axis_deg: f32, around_deg: f32) -> Vector3 {
    let (sin, cos) = off_axis_deg.to_radians().sin_cos();
    let (y, x) = around_deg.to_radians().sin_cos();
    Vector3::new(-sin * x, -sin * y, -cos)
}
/// What a point light's shaping multiplies its intensity by, by the angles of [`emitted`], degrees.
fn factors(shaping: &ShapingParams) -> impl Fn(f32, f32) -> Rgb + use<> {
    let (with, without) = (light(&shaped(POINT, shaping.clone())), light(&LightParams::new(POINT)));
    move |off_axis_deg, around_deg| {
        let at = Point3::ZERO + emitted(off_axis_deg, around_deg) * 7.0;
        let seen = |l: &Light| l.sample(at, Vec2::splat(0.5)).unwrap().radiance.0;
        Rgb(seen(&with) / seen(&without))
    }
}
fn factor(shaping: &ShapingParams, off_axis_deg: f32, around_deg: f32) -> Rgb {
    factors(shaping)(off_axis_deg, around_deg)
}
fn close(got: f32, want: f32, tolerance: f32) -> bool {
    (got - want).abs() <= tolerance
}

/// LM-63 text with this many vertical and horizontal angles, then the angles and the candela.
fn lm63(vertical: &[f32], horizontal: &[f32], candela: &[f32]) -> String {
    let list = |v: &[f32]| v.iter().map(f32::to_string).collect::<Vec<_>>().join(" ");
    let (v, h) = (vertical.len(), horizontal.len());
    let (vertical, horizontal, candela) = (list(vertical), list(horizontal), list(candela));
    format!(
        "IESNA:LM-63-2002\n[TEST] x\nTILT=NONE\n1 -1 1 {v} {h} 1 2 0 0 0\n1 1 9\n{vertical}\n{horizontal}\n{candela}\n"
    )
}

#[test]
fn cones_fade_as_the_schema_says() {
    for (softness, fade) in [(0.0, 40.0), (0.25, 30.0), (1.0, 0.0), (-3.0, 40.0), (7.0, 0.0)] {
        let factor = factors(&cone(40.0, softness));
        for tenths in (0..1800).step_by(7) {
            let angle = tenths as f32 * 0.1;
            let t = if fade < 40.0 { ((angle - fade) / (40.0 - fade)).clamp(0.0, 1.0) } else { 0.0 };
            let want = if angle > 40.0 { 0.0 } else { 1.0 - t * t * (3.0 - 2.0 * t) };
            let got = factor(angle, 77.0).0;
            assert!(close(got.x, want, 1e-5) && got.x == got.z, "softness {softness}, {angle}°: {got}, not {want}");
        }
    }
    // Also narrow ones, and those wider than a half space.
    for limit in [0.01, 1.0, 90.0, 135.0, 179.5] {
        assert_eq!(factor(&cone(limit, 0.0), limit * 0.999, 10.0), Rgb::WHITE);
        assert_eq!(factor(&cone(limit, 0.0), limit * 1.001, 10.0), Rgb::BLACK);
    }
}

#[test]
fn focus_tints_by_the_cosine() {
    let tint = Rgb::new(0.0, 0.25, 1.0);
    let shaping = ShapingParams { focus: 3.0, focus_tint: tint, ..ShapingParams::default() };
    for angle in (0..=180).step_by(9) {
        let f = (angle as f32).to_radians().cos().abs().powi(3);
        let got = factor(&shaping, angle as f32, 200.0).0;
        let want = tint.lerp(Rgb::WHITE, f).0;
        assert!((got - want).length() < 1e-5, "{angle}°: {got}, not {want}");
    }
    let white = ShapingParams { focus: 3.0, focus_tint: Rgb::WHITE, ..ShapingParams::default() };
    assert_eq!(factor(&white, 80.0, 0.0), Rgb::WHITE);
}

#[test]
fn profiles_are_read_between_their_angles() {
    let all_around = lm63(
        &[0.0, 30.0, 90.0],
        &[0.0, 90.0, 180.0, 270.0, 360.0],
        &[8.0, 4.0, 2.0, 8.0, 6.0, 0.0, 8.0, 1.0, 1.0, 8.0, 3.0, 5.0, 8.0, 4.0, 2.0],
    );
    let read = factors(&ies(&all_around, 0.0, false));
    let at = |v: f32, h: f32| read(v, h).0.y;
    for (v, h, want) in [
        (0.0, 0.0, 8.0),
        (0.0, 123.0, 8.0),
        (30.0, 0.0, 4.0),
        (30.0, 90.0, 6.0),
        (30.0, 180.0, 1.0),
        (30.0, 270.0, 3.0),
        (30.0, 45.0, 5.0),
        (30.0, 315.0, 3.5),
        (15.0, 90.0, 7.0),
        (60.0, 270.0, 4.0),
        (60.0, 225.0, 2.5),
        (91.0, 0.0, 0.0),
        (180.0, 0.0, 0.0),
    ] {
        assert!(close(at(v, h), want, 1e-4 * want.max(0.01)), "{v}°, {h}°: {}, not {want}", at(v, h));
    }
}

#[test]
fn symmetric_profiles_are_unfolded() {
    let vertical = [0.0, 90.0, 180.0];
    let table = |horizontal: &[f32], at: &dyn Fn(f32) -> f32| {
        let candela: Vec<f32> = horizontal.iter().flat_map(|&h| [1.0, at(h), 1.0]).collect();
        factors(&ies(&lm63(&vertical, horizontal, &candela), 0.0, false))
    };
    let degrees = |from: usize, to: usize| (from..=to).step_by(30).map(|h| h as f32).collect::<Vec<_>>();
    let quarter = |h: f32| 2.0 + h / 90.0;
    let half = |h: f32| 2.0 + h / 180.0;
    let quadrants = table(&degrees(0, 90), &quarter);
    let about_zero = table(&degrees(0, 180), &half);
    let about_ninety = table(&degrees(90, 270), &|h| 2.0 + (h - 90.0) / 180.0);
    let axial = table(&[0.0], &|_| 3.0);
    // Without the last plane, which is the first.
    let open = table(&degrees(0, 330), &|h| if h <= 180.0 { half(h) } else { half(360.0 - h) });
    for h in (0..360).step_by(5).map(|h| h as f32) {
        let mirrored = h.min(360.0 - h);
        let same = |read: &dyn Fn(f32, f32) -> Rgb, want: f32, what: &str| {
            let got = read(90.0, h).0.x;
            assert!(close(got, want, 1e-3), "{what} at {h}°: {got}, not {want}");
        };
        same(&quadrants, quarter(mirrored.min(180.0 - mirrored)), "quadrants");
        same(&about_zero, half(mirrored), "about zero");
        let from_ninety = (h - 90.0).rem_euclid(360.0);
        same(&about_ninety, 2.0 + from_ninety.min(360.0 - from_ninety) / 180.0, "about ninety");
        same(&axial, 3.0, "axial");
        same(&open, half(mirrored), "open");
    }
}

#[test]
fn profiles_scale_about_either_pole() {
    // Brightness tells the vertical angle: 1 + degrees.
    let ramp = lm63(&[0.0, 180.0], &[0.0], &[1.0, 181.0]);
    for (scale, angle, want) in [
        (0.0, 50.0, 51.0),
        (1.0, 50.0, 51.0),
        (-1.0, 50.0, 51.0),
        (0.5, 50.0, 101.0),
        (0.5, 91.0, 0.0),
        (2.0, 50.0, 26.0),
        (-0.5, 150.0, 121.0),
        (-0.5, 89.0, 0.0),
        (-2.0, 90.0, 136.0),
        (1e-30, 1.0, 0.0),
        (-1e-30, 1.0, 0.0),
        (1e30, 120.0, 1.0),
        (-1e30, 120.0, 181.0),
    ] {
        let got = factor(&ies(&ramp, scale, false), angle, 0.0).0.x;
        assert!(close(got, want, 1e-3 * want), "scale {scale}, {angle}°: {got}, not {want}");
    }
}

#[test]
fn normalized_profiles_keep_the_power() {
    // Bilinear in angle, far from what midpoints would give.
    let sphere = lm63(&[0.0, 60.0, 180.0], &[0.0, 180.0], &[9.0, 1.0, 5.0, 9.0, 70.0, 5.0]);
    let hemisphere = lm63(&[0.0, 20.0, 90.0], &[0.0], &[100.0, 30.0, 0.0]);
    for (text, solid_angle) in [(&sphere, 4.0 * PI), (&hemisphere, 2.0 * PI)] {
        let factor = factors(&ies(text, 0.0, true));
        let (steps, mut sum) = (400, 0.0f64);
        for i in 0..steps {
            let v = (i as f32 + 0.5) / steps as f32 * PI;
            let around = (0..60).map(|k| f64::from(factor(v.to_degrees(), k as f32 * 6.0 + 3.0).0.x));
            sum += around.sum::<f64>() / 60.0 * f64::from(v.sin() * PI / steps as f32 * TAU);
        }
        assert!(close(sum as f32 / solid_angle, 1.0, 2e-3), "{sum}");
    }
}

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
    for (count, goals) in [(16, [0.01, 0.1, 0.05]), (100, [0.7, 0.9, 0.9])] {
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
                    lit.map(|(i, v)| v * v / f64::from(sampler.pmf(p, i))).sum::<f64>() - mean * mean
                };
                assert!(variance(&sampler).is_finite(), "{name}: a light that reaches {p:?} is never chosen");
                with += variance(&sampler);
                without += variance(&blind);
            }
            assert!(with < goal * without, "{count} {name}: variance {with}, blind {without}");
        }
    }
}

#[test]
fn lights_that_emit_nothing_are_black() {
    let black = lm63(&[0.0, 90.0], &[0.0], &[0.0, 0.0]);
    for shaping in [cone(0.0, 0.0), cone(0.0, 1.0), ies(&black, 0.0, true)] {
        for kind in [RECT, BALL, POINT] {
            assert!(light(&shaped(kind, shaping.clone())).is_black());
        }
    }
    assert!(!light(&shaped(RECT, cone(1e-3, 1.0))).is_black());
}

#[test]
fn odd_numbers_are_mended_and_reported() {
    let problems = |kind: LightKind, shaping: ShapingParams, shadow: ShadowParams| {
        let (l, problems) = Light::new(&LightParams { shadow, ..shaped(kind, shaping) }).unwrap();
        for k in 0..100 {
            let mut s = Sampler::new(2, [k, 0], 0);
            let p = Point3::ZERO + umber_sampling::warp::uniform_sphere(s.next_2d()) * 2.0;
            if let Some(s) = l.sample(p, s.next_2d()) {
                assert!(s.radiance.is_finite(), "{shaping:?} {s:?}", shaping = l);
                assert!(l.intersect(&Ray::new(p, s.wi)).is_none_or(|h| h.radiance.is_finite()));
            }
        }
        assert!(l.power_estimate(1.0).is_finite() || l.power_estimate(1.0) > 0.0);
        for t in [0.0, 1.0, 1e30] {
            assert!(l.shadow_shape().is_none_or(|s| (0.0..=1.0).contains(&s.strength(t)) && s.tint(0.5).is_finite()));
        }
        problems
    };
    let plain = ShapingParams::default;
    let ramp = lm63(&[0.0, 180.0], &[0.0], &[1.0, 1e38]);
    let none = ShadowParams::default;
    for kind in [RECT, BALL, POINT] {
        let shaping = |s: ShapingParams| problems(kind.clone(), s, none());
        let shadow = |s: ShadowParams| problems(kind.clone(), plain(), s);
        for odd in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert_eq!(shaping(cone(odd, 0.0)), [LightProblem::Ignored("shaping:cone:angle")]);
            assert_eq!(shaping(cone(30.0, odd)), [LightProblem::Ignored("shaping:cone:softness")]);
            assert_eq!(shaping(ShapingParams { focus: odd, ..plain() }), [LightProblem::Ignored("shaping:focus")]);
            let tint = ShapingParams { focus: 2.0, focus_tint: Rgb::splat(odd), ..plain() };
            assert_eq!(shaping(tint), [LightProblem::Ignored("shaping:focusTint")]);
            assert_eq!(shaping(ies(&ramp, odd, false)), [LightProblem::Ignored("shaping:ies:angleScale")]);
            let color = ShadowParams { color: Rgb::splat(odd), ..none() };
            assert_eq!(shadow(color), [LightProblem::Ignored("shadow:color")]);
            let gamma = ShadowParams { falloff_gamma: odd, distance: 3.0, falloff: 1.0, ..none() };
            assert_eq!(shadow(gamma), [LightProblem::Ignored("shadow:falloffGamma")]);
        }
        assert_eq!(shaping(cone(-5.0, 0.0)), [LightProblem::Negative("shaping:cone:angle")]);
        assert_eq!(shaping(ShapingParams { focus: -2.0, ..plain() }), [LightProblem::Negative("shaping:focus")]);
        for angle in [0.0, 180.0, 181.0, 1e30] {
            assert_eq!(shaping(cone(angle, 0.5)), []);
        }
        for focus in [1e-30, 1e30, f32::MAX] {
            assert_eq!(shaping(ShapingParams { focus, focus_tint: Rgb::splat(f32::MAX), ..plain() }), []);
        }
        for scale in [1e-38, -1e-38, 1e38, -1e38] {
            assert_eq!(shaping(ies(&ramp, scale, false)), []);
            assert_eq!(shaping(ies(&ramp, scale, true)), []);
        }
        assert_eq!(shadow(ShadowParams { distance: 0.0, falloff: f32::MAX, ..none() }), []);
    }
    for kind in [LightKind::Distant { angle_deg: 1.0 }, LightKind::Dome { texture: None }] {
        assert_eq!(problems(kind.clone(), cone(10.0, 0.0), none()), [LightProblem::NotShaped]);
        assert_eq!(problems(kind, cone(180.0, 1.0), none()), []);
    }
}

#[test]
fn shadows_fade_as_the_schema_says() {
    let strength = |distance, falloff, falloff_gamma, t| {
        let shadow = ShadowParams { distance, falloff, falloff_gamma, ..ShadowParams::default() };
        light(&LightParams { shadow, ..LightParams::new(POINT) }).shadow_shape().map(|s| s.strength(t))
    };
    for (distance, falloff, gamma, t, want) in [
        (4.0, -1.0, 1.0, 3.99, 1.0),
        (4.0, -1.0, 1.0, 4.01, 0.0),
        (4.0, 1.0, 1.0, 2.9, 1.0),
        (4.0, 1.0, 1.0, 3.25, 0.75),
        (4.0, 1.0, 2.0, 3.5, 0.25),
        (4.0, 9.0, 1.0, 1.0, 0.75),
        (0.0, 1.0, 1.0, 0.5, 0.0),
    ] {
        let got = strength(distance, falloff, gamma, t).unwrap();
        assert!(close(got, want, 1e-6), "{distance} {falloff} {gamma} at {t}: {got}, not {want}");
    }
    // Without a distance there is nothing to fall off to.
    assert_eq!(strength(-1.0, 2.0, 3.0, 1.0), None);
    let blue = ShadowParams { color: Rgb::new(0.0, 0.0, 1.0), ..ShadowParams::default() };
    let l = light(&LightParams { shadow: blue, ..LightParams::new(POINT) });
    assert_eq!(l.shadow_shape().unwrap().tint(1.0), Rgb::new(0.0, 0.0, 1.0));
    assert!(l.found_by_samples_alone() && l.shadow_shape().unwrap().strength(1e30) == 1.0);
    let off = LightParams { shadow: blue, shadow_enable: false, ..LightParams::new(POINT) };
    assert!(light(&off).shadow_shape().is_none());
    assert!(!light(&LightParams::new(POINT)).found_by_samples_alone());
}
