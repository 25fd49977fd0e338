//! Factors by direction.

use std::f32::consts::{PI, TAU};

use umber_math::Rgb;
use umber_shading::ShapingParams;

use crate::{close, cone, factor, factors, ies, lm63};

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
