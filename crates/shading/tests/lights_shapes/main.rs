//! Disk and cylinder lights, textured rect lights: radiometry against closed forms and quadrature, densities, edge
//! cases.

use std::f64::consts::{PI, TAU};

use glam::Vec2;
use umber_math::{DAffine3, DVec3, Normal3, Point3, Ray, Rgb};
use umber_sampling::chi2::{Chi2Options, test_sphere};
use umber_shading::{Light, LightKind, LightParams, LightProblem};

use common::{UP, at, close, cylinder, disk, irradiance, light, line, picture, place, quadrature, skewed, textured};

mod common;
mod textures;

#[test]
fn irradiance_under_a_disk_is_the_analytic_one() {
    // Howell's catalogue, B-13: a plane element and a parallel disk, aside by a.
    for (radius, height, aside) in [
        (1.0f64, 1.0, 0.0),
        (1.0, 0.01, 0.0),
        (1.0, 0.01, 0.9),
        (1.0, 0.05, 1.2),
        (0.01, 1.0, 0.3),
        (2.0, 30.0, 4.0),
        (50.0, 0.5, 20.0),
        (1.0, 1.2, 1.4),
    ] {
        let (h, r) = (height / aside, radius / aside);
        let want = if aside == 0.0 {
            PI * radius * radius / (radius * radius + height * height)
        } else {
            let z = 1.0 + h * h + r * r;
            PI * 0.5 * (1.0 - (1.0 + h * h - r * r) / (z * z - 4.0 * r * r).sqrt())
        };
        let p = place(disk(radius as f32), at(aside, 0.0, height));
        let (sampled, cast) = irradiance(&light(&p), Point3::ZERO, UP, 1 << 14);
        assert!(close(sampled, want, 4e-3), "{radius} at {height}, {aside}: {sampled}, not {want}");
        assert!(want < 0.3 || close(cast, want, 2e-2), "{radius} at {height}, {aside}: {cast}, not {want}");
        let behind = Point3::new(0.0, 0.0, 2.0 * height as f32);
        assert!(light(&p).sample(behind, Vec2::splat(0.5)).is_none());
        assert_eq!(light(&p).pdf_solid_angle(behind, -UP.as_vector()), 0.0);
    }
}

#[test]
fn a_transformed_disk_is_an_ellipse() {
    let p = place(disk(0.8), at(0.3, -0.2, 2.0) * skewed());
    let on = |u: f64, v: f64| {
        let (sin, cos) = (TAU * v).sin_cos();
        DVec3::new(cos, sin, 0.0) * (u * 0.8)
    };
    let to = light(&p).bounds().unwrap().center();
    for from in [DVec3::ZERO, DVec3::new(3.0, 1.0, -2.0), DVec3::new(0.4, 0.1, 0.9)] {
        let n = (to.0.as_dvec3() - from).normalize();
        let want = quadrature(&p, on, |_, _| DVec3::NEG_Z, |_, _| 1.0, (from, n));
        let from = Point3(from.as_vec3());
        let (sampled, cast) = irradiance(&light(&p), from, Normal3(n.as_vec3()), 1 << 14);
        assert!(close(sampled, want, 4e-3), "{from:?}: {sampled}, not {want}");
        assert!(want < 0.1 || close(cast, want, 5e-2), "{from:?}: {cast}, not {want}");
    }
    // Its box is the tightest.
    let (bounds, m) = (light(&p).bounds().unwrap(), p.render_from_light);
    let rim = (0..720).map(|i| Point3(m.transform_point3(on(1.0, f64::from(i) / 720.0)).as_vec3()));
    let tight = umber_math::Bounds3::of_points(rim);
    assert!((bounds.min - tight.min).length() < 1e-4 && (bounds.max - tight.max).length() < 1e-4);
}

#[test]
fn irradiance_beside_a_long_cylinder_is_the_analytic_one() {
    // A surface that faces an endless cylinder's axis: E = π L r / d.
    for (radius, distance) in [(0.5f64, 1.0f64), (0.5, 0.501), (1e-3, 1.0), (2.0, 9.0)] {
        let p = place(cylinder(2e4, radius as f32), at(0.0, 0.0, distance));
        let want = PI * radius / distance;
        let (sampled, cast) = irradiance(&light(&p), Point3::ZERO, UP, 1 << 14);
        assert!(close(sampled, want, 2e-3), "{radius} at {distance}: {sampled}, not {want}");
        assert!(want < 0.5 || close(cast, want, 2e-2), "{radius} at {distance}: {cast}, not {want}");
    }
}

#[test]
fn irradiance_of_any_cylinder_is_that_of_quadrature() {
    let (length, radius) = (1.6f64, 0.4f64);
    let on = |u: f64, v: f64| {
        let (sin, cos) = (TAU * v).sin_cos();
        DVec3::new((u - 0.5) * length, radius * cos, radius * sin)
    };
    let out = |_: f64, v: f64| DVec3::new(0.0, (TAU * v).cos(), (TAU * v).sin());
    let transforms = [
        DAffine3::from_rotation_y(0.4),
        DAffine3::from_scale(DVec3::splat(2.5)),
        DAffine3::from_scale(DVec3::new(1.0, 0.5, 3.0)),
        DAffine3::from_scale(DVec3::new(-2.0, 0.5, 1.0)),
        skewed(),
    ];
    for (i, transform) in transforms.iter().enumerate() {
        let p = place(cylinder(length as f32, radius as f32), at(0.5, 0.2, 3.5) * *transform);
        for from in [DVec3::ZERO, DVec3::new(4.0, 1.0, 3.0), DVec3::new(-3.0, 5.0, 8.0)] {
            let n = (DVec3::new(0.5, 0.2, 3.5) - from).normalize();
            let want = quadrature(&p, on, out, |_, _| 1.0, (from, n));
            let from = Point3(from.as_vec3());
            let (sampled, cast) = irradiance(&light(&p), from, Normal3(n.as_vec3()), 1 << 14);
            assert!(close(sampled, want, 4e-3), "{i} from {from:?}: {sampled}, not {want}");
            assert!(want < 0.1 || close(cast, want, 0.1), "{i} from {from:?}: {cast}, not {want}");
        }
        let (bounds, m) = (light(&p).bounds().unwrap(), p.render_from_light);
        let ends = (0..720).map(|i| on(f64::from(i % 2), f64::from(i / 2) / 360.0));
        let tight = umber_math::Bounds3::of_points(ends.map(|e| Point3(m.transform_point3(e).as_vec3())));
        assert!((bounds.min - tight.min).length() < 1e-3 && (bounds.max - tight.max).length() < 1e-3);
    }
}

#[test]
fn only_the_outside_of_a_cylinder_shines() {
    let l = light(&cylinder(2.0, 0.5));
    // Inside, and beyond its ends, whence only they are seen.
    for p in [[0.2, 0.1, -0.3], [3.0, 0.1, -0.3], [-1.5, 0.0, 0.0]] {
        assert!(l.sample(p.into(), Vec2::new(0.3, 0.6)).is_none(), "{p:?}");
    }
    let hit = |o: [f32; 3], d: [f32; 3]| l.intersect(&Ray::new(o.into(), d.into()));
    let side = hit([0.3, 2.0, 0.0], [0.0, -2.0, 0.0]).unwrap();
    assert_eq!((side.t, side.radiance, side.is_front), (0.75, Rgb::WHITE, true));
    let inside = hit([0.3, 0.0, 0.0], [0.0, 0.0, 1.0]).unwrap();
    assert_eq!((inside.t, inside.radiance, inside.is_front), (0.5, Rgb::BLACK, false));
    let end = hit([4.0, 0.2, 0.1], [-1.0, 0.0, 0.0]).unwrap();
    assert_eq!((end.t, end.radiance, end.is_front), (3.0, Rgb::BLACK, false));
    assert_eq!(hit([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]).unwrap().t, 1.0);
    for (o, d) in [
        ([4.0, 0.6, 0.0], [-1.0, 0.0, 0.0]),
        ([1.1, 2.0, 0.0], [0.0, -1.0, 0.0]),
        ([0.0, 2.0, 0.0], [0.0, 1.0, 0.0]),
        ([0.0, 2.0, 0.51], [0.0, -1.0, 0.0]),
    ] {
        assert!(hit(o, d).is_none(), "{o:?}");
    }
}

#[test]
fn a_line_shines_as_its_cylinder_does_from_afar() {
    for normalize in [false, true] {
        let thin = LightParams { normalize, ..place(cylinder(2.0, 1e-3), at(0.0, 0.0, 1.5)) };
        let as_line = LightParams { kind: line(2.0, 1e-3).kind, ..thin.clone() };
        // A surface that faces the axis from its middle: I' / d · (α + sin α cos α), and I' = 2 r L.
        let per_length = if normalize { 1.0 / (PI * 2.0) } else { 2e-3 };
        let alpha = (1.0f64 / 1.5).atan();
        let want = per_length / 1.5 * (alpha + alpha.sin() * alpha.cos());
        let l = light(&as_line);
        let sampled = irradiance(&l, Point3::ZERO, UP, 1 << 12).0;
        assert!(close(sampled, want, 1e-3), "{sampled}, not {want}");
        let aside = Point3::new(2.0, 0.3, -0.4);
        let of_thin = irradiance(&light(&thin), aside, UP, 1 << 12).0;
        assert!(close(irradiance(&l, aside, UP, 1 << 12).0, of_thin, 2e-3));
        assert!(close(f64::from(l.power_estimate(1.0)), f64::from(light(&thin).power_estimate(1.0)), 1e-4));
        let s = l.sample(aside, Vec2::splat(0.3)).unwrap();
        assert!(s.is_delta && l.is_delta() && s.pdf_solid_angle == 1.0 && l.pdf_solid_angle(aside, s.wi) == 0.0);
        assert!(l.intersect(&Ray::new(aside, s.wi)).is_none());
        assert!(l.sample(Point3::new(7.0, 0.0, 1.5), Vec2::splat(0.3)).is_none());
    }
    // Normalised, it needs no radius.
    let bare = LightParams { normalize: true, ..line(2.0, 0.0) };
    assert!(light(&bare).sample(Point3::new(0.0, 1.0, 0.0), Vec2::splat(0.3)).is_some());
    assert_eq!(Light::new(&line(2.0, 0.0)).err(), Some(LightProblem::NoArea));
}

#[test]
fn normalize_divides_by_the_area_in_the_world() {
    let ellipse = |a: f64, b: f64| {
        // Ramanujan's second approximation.
        let h = ((a - b) / (a + b)).powi(2);
        PI * (a + b) * (1.0 + 3.0 * h / (10.0 + (4.0 - 3.0 * h).sqrt()))
    };
    let scale = DVec3::new(2.0, 0.5, 3.0);
    for (p, area) in [
        (disk(0.5), PI * 1.0 * 0.25),
        (cylinder(1.5, 0.5), 3.0 * ellipse(0.25, 1.5)),
        (LightParams::new(LightKind::Rect { width: 1.0, height: 3.0 }), 3.0),
        (textured(1.0, 3.0, &picture()), 3.0),
    ] {
        let plain = place(p, DAffine3::from_scale(scale));
        let divided = LightParams { normalize: true, ..plain.clone() };
        let [whole, part] = [&plain, &divided].map(|p| f64::from(light(p).power_estimate(1.0)));
        assert!(close(whole / part, area, 1e-4), "{:?}: {} not {area}", plain.kind, whole / part);
        let is_textured = plain.texture.is_some();
        assert!(is_textured || close(whole, PI * area, 1e-4), "{:?}: {whole}", plain.kind);
    }
}

#[test]
fn sampled_densities_stand_the_chi_squared_test() {
    let turned = DAffine3::from_rotation_x(0.7) * DAffine3::from_rotation_z(1.1);
    let stretched = DAffine3::from_scale(DVec3::new(1.0, 0.4, 2.0));
    let lights = [
        ("near disk", place(disk(1.0), at(0.3, 0.2, 0.4))),
        ("very near disk", place(disk(1.0), at(0.3, 0.2, 0.01))),
        ("disk from aside", place(disk(1.0), at(1.2, 0.9, 0.2))),
        ("far disk", place(disk(1.0), at(1.0, -1.0, 2.5) * DAffine3::from_rotation_x(0.5))),
        ("ellipse", place(disk(1.2), at(0.4, 0.1, 1.5) * skewed())),
        ("long ellipse", place(disk(1.0), at(0.7, 0.4, 0.5) * DAffine3::from_scale(DVec3::new(3.0, 0.5, 1.0)))),
        ("far ellipse", place(disk(1.0), at(0.4, 1.1, 3.0) * skewed())),
        ("cylinder", place(cylinder(2.0, 0.5), at(0.2, 0.1, 1.5) * turned)),
        ("near cylinder", place(cylinder(4.0, 1.0), at(1.0, 0.0, 1.02))),
        ("long cylinder", place(cylinder(200.0, 0.3), at(10.0, 0.3, 0.8))),
        ("cylinder from its end", place(cylinder(3.0, 0.8), at(2.5, 0.9, 0.1))),
        ("elliptic cylinder", place(cylinder(2.0, 0.5), at(0.1, 0.3, 1.6) * stretched)),
        ("oblique cylinder", place(cylinder(1.5, 0.6), at(0.5, 0.4, 1.8) * skewed())),
        ("near picture", place(textured(2.0, 1.0, &picture()), at(0.3, 0.2, 0.4))),
        ("picture", place(textured(3.0, 2.0, &picture()), at(0.5, -0.8, 1.5) * turned)),
        ("skew picture", place(textured(2.0, 2.0, &picture()), at(0.2, 0.1, 1.6) * skewed())),
    ];
    let o = Chi2Options { samples: 40_000, bins: [16, 32], min_depth: 3, ..Chi2Options::default() };
    for (name, p) in &lights {
        let l = light(p);
        let sample = |u| {
            let s = l.sample(Point3::ZERO, u)?;
            assert!((s.wi.length() - 1.0).abs() < 1e-5 && s.pdf_solid_angle > 0.0, "{name}: {s:?}");
            let pdf = l.pdf_solid_angle(Point3::ZERO, s.wi);
            assert!(pdf == 0.0 || (pdf - s.pdf_solid_angle).abs() < 0.02 * pdf, "{name}: {pdf} {s:?}");
            let hit = l.intersect(&Ray::new(Point3::ZERO, s.wi));
            assert!(hit.is_none_or(|h| (h.t - s.distance).abs() < 0.03 * s.distance), "{name}: {hit:?} {s:?}");
            Some(s.wi)
        };
        // Its oblique ends cut slivers out of the bins.
        let o = if *name == "oblique cylinder" { Chi2Options { min_depth: 5, max_depth: 9, ..o } } else { o };
        let outcome = test_sphere(o, sample, |w| l.pdf_solid_angle(Point3::ZERO, w));
        // What falls beside the disk is refused.
        let least = if matches!(p.kind, LightKind::Disk { .. }) { 0.6 } else { 0.997 };
        let is_whole = outcome.integral > least;
        assert!(outcome.accepted(0.01, lights.len()) && is_whole, "{name}: {outcome:?}");
    }
}

#[test]
fn broken_shapes_are_reported() {
    let error = |p: &LightParams| Light::new(p).err();
    assert_eq!(error(&disk(1e-30)), Some(LightProblem::NoArea));
    assert_eq!(error(&cylinder(1.0, 1e-30)), Some(LightProblem::NoArea));
    for radius in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        for p in [disk(radius), cylinder(1.0, radius), line(1.0, radius)] {
            assert_eq!(error(&p), Some(LightProblem::NoArea), "{:?}", p.kind);
        }
    }
    for length in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        for p in [cylinder(length, 1.0), line(length, 1.0)] {
            assert_eq!(error(&p), Some(LightProblem::NoArea), "{:?}", p.kind);
        }
    }
    for scale in [DVec3::new(0.0, 1.0, 1.0), DVec3::new(1.0, 0.0, 1.0)] {
        for p in [disk(1.0), cylinder(1.0, 1.0)] {
            let p = place(p, DAffine3::from_scale(scale));
            assert_eq!(error(&p), Some(LightProblem::SingularTransform), "{:?}", p.kind);
        }
    }
    // A disk has no depth to lose.
    assert!(Light::new(&place(disk(1.0), DAffine3::from_scale(DVec3::new(1.0, 1.0, 0.0)))).is_ok());
    for p in [disk(1.0), cylinder(1.0, 1.0), line(1.0, 1.0), textured(1.0, 1.0, &picture())] {
        let nan = place(p.clone(), DAffine3::from_translation(DVec3::NAN));
        assert_eq!(error(&nan), Some(LightProblem::SingularTransform));
        let (l, problems) = Light::new(&LightParams { intensity: f32::NAN, ..p.clone() }).unwrap();
        assert!(l.is_black() && problems == [LightProblem::NotFinite("intensity")]);
        let (l, problems) = Light::new(&LightParams { exposure: 500.0, ..p.clone() }).unwrap();
        assert_eq!(problems, [LightProblem::TooBright]);
        let s = l.sample(Point3::new(0.1, 0.2, -3.0), Vec2::splat(0.4)).unwrap();
        assert!(s.radiance.is_finite());
    }
}

#[test]
fn samples_are_finite_from_anywhere() {
    let lights = [
        light(&disk(1.0)),
        light(&disk(1e-9)),
        light(&place(disk(1.0), DAffine3::from_scale(DVec3::new(1e4, 1e-4, 1.0)))),
        light(&cylinder(2.0, 1.0)),
        light(&cylinder(1e6, 1e-6)),
        light(&place(cylinder(1.0, 1.0), DAffine3::from_scale(DVec3::new(1.0, 1e-4, 1e3)))),
        light(&line(2.0, 1.0)),
        light(&textured(2.0, 1.0, &picture())),
    ];
    let odd = [0.0, -0.0, 1.0, -1.0, 0.5, -1e-7, 1e-30, -1e-20, 1e7, -1e20, 1e38, f32::NAN, f32::INFINITY];
    for (i, l) in lights.iter().enumerate() {
        for k in 0..odd.len().pow(3) {
            let p = Point3::from([k, k / odd.len(), k / odd.len().pow(2)].map(|k| odd[k % odd.len()]));
            for u in [Vec2::ZERO, Vec2::splat(0.5), Vec2::new(0.999_999_94, 0.999_999_94), Vec2::new(0.3, 0.0)] {
                let Some(s) = l.sample(p, u) else { continue };
                let weight = s.radiance / s.pdf_solid_angle;
                assert!(s.wi.is_finite() && (s.wi.length() - 1.0).abs() < 1e-4, "light {i} from {p:?}: {s:?}");
                assert!(
                    weight.is_finite() && s.pdf_solid_angle > 0.0 && !s.distance.is_nan(),
                    "light {i} from {p:?}: {s:?}"
                );
                assert!(l.pdf_solid_angle(p, s.wi).is_finite(), "light {i} from {p:?}: {s:?}");
                assert!(l.intersect(&Ray::new(p, s.wi)).is_none_or(|h| h.t.is_finite() && h.t >= 0.0));
            }
        }
    }
}
