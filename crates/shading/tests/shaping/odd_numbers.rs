//! What a host may say and no light can do; and ShadowAPI's numbers.

use umber_math::{Point3, Ray, Rgb};
use umber_sampling::Sampler;
use umber_shading::{Light, LightKind, LightParams, LightProblem, ShadowParams, ShapingParams};

use crate::{BALL, POINT, RECT, close, cone, ies, light, lm63, shaped};

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
