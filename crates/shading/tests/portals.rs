//! Portals guide the sampling of a dome: densities, means, bad input.

use std::f32::consts::PI;
use std::sync::Arc;

use glam::Vec2;
use umber_math::{DAffine3, DVec3, Point3, Vector3};
use umber_sampling::Sampler;
use umber_sampling::chi2::{Chi2Options, test_sphere};
use umber_shading::{EnvironmentMap, Light, LightKind, LightParams, LightProblem, Portal};

fn dome(texture: Option<Arc<EnvironmentMap>>) -> Light {
    let params = LightParams { shadow_enable: true, ..LightParams::new(LightKind::Dome { texture }) };
    Light::new(&params).unwrap().0
}

fn spotted_map() -> Arc<EnvironmentMap> {
    let mut pixels: Vec<[f32; 3]> = (0..32 * 16).map(|i| [0.1 + (i % 7) as f32 * 0.1, 0.2, 0.3]).collect();
    pixels[5 * 32 + 9] = [40.0, 30.0, 20.0];
    Arc::new(EnvironmentMap::from_pixels(32, 16, pixels).unwrap())
}

/// A portal at `at`, turned around Y so that light goes from it towards where `turn` says: 0 along −Z.
fn portal(at: [f64; 3], turn: f64, size: [f32; 2]) -> Portal {
    let place = DAffine3::from_translation(DVec3::from(at)) * DAffine3::from_rotation_y(turn);
    Portal::new(place, size[0], size[1]).unwrap()
}

/// One that is large, one that is small, two that overlap, one that the point is in front of.
fn cases() -> Vec<(&'static str, Light)> {
    let large = || portal([0.2, -0.1, 1.0], 0.0, [3.0, 2.0]);
    let small = || portal([1.0, 1.5, 2.0], 0.3, [0.6, 0.5]);
    let behind = || portal([0.0, 0.0, -1.0], 0.0, [1.0, 1.0]);
    let sheared = DAffine3::from_mat3(glam::DMat3::from_cols(DVec3::X, DVec3::new(0.8, 1.0, 0.3), DVec3::Z));
    let skew = Portal::new(DAffine3::from_translation(DVec3::Z * 1.5) * sheared, 2.0, 1.5).unwrap();
    vec![
        ("one", dome(None).with_portals(vec![large()])),
        (
            "several, overlapping",
            dome(None).with_portals(vec![large(), small(), portal([0.5, 0.2, 1.3], 0.2, [2.0, 2.0])]),
        ),
        ("with a picture", dome(Some(spotted_map())).with_portals(vec![large(), small()])),
        ("in front of one", dome(None).with_portals(vec![large(), behind()])),
        ("in front of all", dome(Some(spotted_map())).with_portals(vec![behind()])),
        ("skew", dome(None).with_portals(vec![skew])),
    ]
}

#[test]
fn mixtures_stand_the_chi_squared_test() {
    let o = Chi2Options { samples: 30_000, bins: [16, 32], min_depth: 3, ..Chi2Options::default() };
    let cases = cases();
    for (name, light) in &cases {
        let sample = |u| {
            let s = light.sample(Point3::ZERO, u)?;
            let pdf = light.pdf_solid_angle(Point3::ZERO, s.wi);
            assert!((s.wi.length() - 1.0).abs() < 1e-5 && s.distance == f32::INFINITY, "{name}: {s:?}");
            assert!((pdf / s.pdf_solid_angle - 1.0).abs() < 1e-3, "{name}: {pdf} {s:?}");
            Some(s.wi)
        };
        let outcome = test_sphere(o, sample, |w| light.pdf_solid_angle(Point3::ZERO, w));
        assert!(outcome.accepted(0.01, cases.len()) && (outcome.integral - 1.0).abs() < 3e-3, "{name}: {outcome:?}");
    }
}

/// The irradiance is that of the dome without portals, from wherever it is estimated.
#[test]
fn the_mean_is_that_without_portals() {
    let toward = Vector3::new(0.3, 0.2, 1.0).normalized();
    for (name, light) in cases() {
        let plain = dome(if name.contains("picture") || name.contains("all") { Some(spotted_map()) } else { None });
        let estimate = |light: &Light, seed: u32, n: u32| {
            let values = (0..n).map(|i| {
                let u = Sampler::new(seed.into(), [5, 1], i).next_2d();
                light
                    .sample(Point3::ZERO, u)
                    .map_or(0.0, |s| f64::from(s.radiance.0.x * s.wi.dot(toward).max(0.0) / s.pdf_solid_angle))
            });
            values.sum::<f64>() / f64::from(n)
        };
        let (got, want) = (estimate(&light, 1, 1 << 16), estimate(&plain, 2, 1 << 16));
        assert!((got / want - 1.0).abs() < 0.02, "{name}: {got}, not {want}");
        if !name.contains("all") && !name.contains("picture") {
            assert!((want / f64::from(PI) - 1.0).abs() < 5e-3, "{want}");
        }
    }
}

/// A light without shadows comes through no opening, and other lights know no portals.
#[test]
fn only_domes_with_shadows_have_portals() {
    let window = || vec![portal([0.0, 0.0, 1.0], 0.0, [1.0, 1.0])];
    let params = LightParams { shadow_enable: false, ..LightParams::new(LightKind::Dome { texture: None }) };
    let everywhere = 1.0 / (4.0 * PI);
    let through = Light::new(&params).unwrap().0.with_portals(window());
    assert_eq!(through.pdf_solid_angle(Point3::ZERO, Vector3::new(0.0, 0.0, 1.0)), everywhere);
    let guided = dome(None).with_portals(window());
    assert!(guided.pdf_solid_angle(Point3::ZERO, Vector3::new(0.0, 0.0, 1.0)) > 5.0 * everywhere);
    assert_eq!(
        dome(None).with_portals(Vec::new()).pdf_solid_angle(Point3::ZERO, Vector3::new(0.0, 0.0, 1.0)),
        everywhere
    );
}

#[test]
fn broken_portals_are_refused_and_odd_points_are_finite() {
    let error = |m, w, h| Portal::new(m, w, h).err();
    let id = DAffine3::IDENTITY;
    assert_eq!(error(id, 0.0, 1.0), Some(LightProblem::NoArea));
    assert_eq!(error(id, f32::NAN, 1.0), Some(LightProblem::NoArea));
    assert_eq!(error(DAffine3::from_translation(DVec3::NAN), 1.0, 1.0), Some(LightProblem::SingularTransform));
    assert_eq!(error(DAffine3::from_scale(DVec3::new(0.0, 1.0, 1.0)), 1.0, 1.0), Some(LightProblem::SingularTransform));
    let odd = [0.0, 1.0, -1.0, 1e-30, -1e-20, 1e7, -1e20, f32::NAN, f32::INFINITY];
    for (name, light) in cases() {
        for k in 0..odd.len().pow(3) {
            let p = Point3::from([k, k / odd.len(), k / odd.len().pow(2)].map(|k| odd[k % odd.len()]));
            for u in [Vec2::ZERO, Vec2::splat(0.5), Vec2::splat(0.999_999_94), Vec2::new(0.1, 0.3)] {
                let Some(s) = light.sample(p, u) else { continue };
                assert!(
                    s.wi.is_finite() && s.pdf_solid_angle > 0.0 && s.pdf_solid_angle.is_finite(),
                    "{name}: {p:?} {s:?}"
                );
                assert!(light.pdf_solid_angle(p, s.wi).is_finite(), "{name}: {p:?} {s:?}");
            }
        }
    }
}
