//! Radiometry, densities and edge cases of lights.

use std::f32::consts::PI;
use std::sync::Arc;

use glam::Vec2;
use umber_math::{DAffine3, DVec3, Normal3, Point3, Ray, Rgb};
use umber_sampling::Sampler;
use umber_sampling::chi2::{Chi2Options, test_sphere};
use umber_shading::{EnvironmentMap, Light, LightKind, LightParams, LightProblem};

fn params(kind: LightKind) -> LightParams {
    LightParams::new(kind)
}
fn rect(width: f32, height: f32) -> LightParams {
    params(LightKind::Rect { width, height })
}
fn sphere(radius: f32) -> LightParams {
    params(LightKind::Sphere { radius, treat_as_point: false })
}
fn distant(angle_deg: f32) -> LightParams {
    params(LightKind::Distant { angle_deg })
}
fn light(p: &LightParams) -> Light {
    let (light, problems) = Light::new(p).unwrap();
    assert_eq!(problems, []);
    light
}

/// Irradiance by light sampling, and by casting uniform rays: two independent estimates.
fn irradiance(l: &Light, p: Point3, n: Normal3, samples: u32) -> (f32, f32) {
    let (mut sampled, mut cast) = (0.0, 0.0);
    for i in 0..samples {
        let mut s = Sampler::new(3, [8, 1], i);
        if let Some(s) = l.sample(p, s.next_2d()) {
            sampled += f64::from(s.radiance.0.x * s.wi.dot_normal(n).max(0.0) / s.pdf_solid_angle);
        }
        let w = umber_sampling::warp::uniform_sphere(s.next_2d());
        let hit = l.intersect(&Ray::new(p, w)).map(|h| h.radiance).or(l.from_infinity(w).map(|f| f.radiance));
        cast += f64::from(hit.map_or(0.0, |r| r.0.x) * w.dot_normal(n).max(0.0) * 4.0 * PI);
    }
    ((sampled / f64::from(samples)) as f32, (cast / f64::from(samples)) as f32)
}

fn close(got: f32, want: f32, tolerance: f32) -> bool {
    (got - want).abs() <= tolerance * want.abs()
}

const DOWN: Normal3 = Normal3::new(0.0, 0.0, -1.0);
const UP: Normal3 = Normal3::new(0.0, 0.0, 1.0);

#[test]
fn irradiance_under_a_rectangle_is_the_analytic_one() {
    // A rectangle facing down, its corner over the point: configuration factor of Howell's catalogue, B-3, four times.
    for (w, h, height) in [(2.0f32, 1.0f32, 1.0f32), (0.02, 0.03, 1.0), (40.0, 60.0, 0.5), (1.0, 1.0, 30.0)] {
        let mut p = rect(w, h);
        p.render_from_light = DAffine3::from_translation(DVec3::Z * f64::from(height));
        let (a, b) = (0.5 * w / height, 0.5 * h / height);
        let quarter = |a: f32, b: f32| {
            let (ra, rb) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
            (a / ra * (b / ra).atan() + b / rb * (a / rb).atan()) * 0.5
        };
        let want = 4.0 * quarter(a, b);
        let (sampled, cast) = irradiance(&light(&p), Point3::ZERO, UP, 1 << 14);
        assert!(close(sampled, want, 2e-3), "{w} × {h} at {height}: {sampled}, not {want}");
        assert!(a.min(b) < 0.5 || close(cast, want, 2e-2), "{w} × {h} at {height}: {cast}, not {want}");
        // Nothing behind it.
        let behind = Point3::new(0.0, 0.0, 2.0 * height);
        assert!(light(&p).sample(behind, Vec2::splat(0.5)).is_none());
        assert_eq!(light(&p).pdf_solid_angle(behind, DOWN.as_vector()), 0.0);
    }
}

#[test]
fn irradiance_under_a_sphere_is_the_analytic_one() {
    for (radius, distance) in [(1.0f32, 3.0f32), (1.0, 1.001), (1e-3, 10.0), (1e-6, 100.0), (50.0, 51.0)] {
        let mut p = sphere(radius);
        p.render_from_light = DAffine3::from_translation(DVec3::Z * f64::from(distance));
        let want = PI * (radius / distance).powi(2);
        let (sampled, cast) = irradiance(&light(&p), Point3::ZERO, UP, 1 << 14);
        assert!(close(sampled, want, 2e-3), "radius {radius} at {distance}: {sampled}, not {want}");
        assert!(radius / distance < 0.3 || close(cast, want, 2e-2), "radius {radius} at {distance}: {cast}");
        for i in 0..100 {
            let s = light(&p).sample(Point3::ZERO, Sampler::new(0, [i, 0], 0).next_2d()).unwrap();
            assert!(s.distance >= 0.999 * (distance - radius) && s.distance <= 1.001 * distance, "{s:?}");
        }
    }
    assert!(light(&sphere(1.0)).sample(Point3::new(0.3, 0.0, 0.0), Vec2::splat(0.5)).is_none());
}

#[test]
fn irradiance_of_distant_and_dome_lights_is_the_analytic_one() {
    for angle in [0.53f32, 20.0, 170.0] {
        let want = PI * (angle.to_radians() * 0.5).sin().powi(2);
        let l = light(&distant(angle));
        let (sampled, cast) = irradiance(&l, Point3::ZERO, UP, 1 << 14);
        assert!(close(sampled, want, 2e-3), "{angle}°: {sampled}, not {want}");
        assert!(angle < 5.0 || close(cast, want, 3e-2), "{angle}°: {cast}, not {want}");
        // Normalised, a surface that faces it receives the intensity: also without a size, and beyond a half sphere
        // the wrapped part is what the schema's factor adds.
        let mut p = distant(angle);
        (p.normalize, p.intensity) = (true, 3.0);
        assert!(close(irradiance(&light(&p), Point3::ZERO, UP, 1 << 14).0, 3.0, 2e-3));
    }
    for normalize in [false, true] {
        let p = LightParams { normalize, intensity: 3.0, ..distant(0.0) };
        let s = light(&p).sample(Point3::ZERO, Vec2::splat(0.1)).unwrap();
        assert!(s.is_delta && s.radiance == Rgb::splat(3.0) && s.pdf_solid_angle == 1.0 && s.distance == f32::INFINITY);
        assert!((s.wi - UP.as_vector()).length() < 1e-6);
        assert!(light(&p).from_infinity(s.wi).is_none());
    }
    let wide = LightParams { normalize: true, ..distant(300.0) };
    let size = (2.0 - 150f32.to_radians().sin().powi(2)) * PI;
    assert!(close(light(&wide).from_infinity(UP.as_vector()).unwrap().radiance.0.x, 1.0 / size, 1e-5));
    let (sampled, cast) = irradiance(&light(&params(LightKind::Dome { texture: None })), Point3::ZERO, UP, 1 << 14);
    assert!(close(sampled, PI, 2e-3) && close(cast, PI, 2e-3), "{sampled} {cast}");
}

#[test]
fn radiance_follows_usdlux() {
    let mut p = rect(2.0, 3.0);
    p.color = Rgb::new(1.0, 0.5, 0.25);
    (p.intensity, p.exposure) = (4.0, -1.0);
    let seen = |p: &LightParams| light(p).sample(Point3::new(0.0, 0.0, -1.0), Vec2::splat(0.5)).unwrap().radiance.0;
    assert!((seen(&p) - glam::Vec3::new(2.0, 1.0, 0.5)).length() < 1e-6);
    p.normalize = true;
    p.render_from_light = DAffine3::from_scale(DVec3::new(2.0, 5.0, 9.0));
    assert!((seen(&p) - glam::Vec3::new(2.0, 1.0, 0.5) / 60.0).length() < 1e-6);
    p.color_temperature = Some(6500.0);
    let warm = umber_math::blackbody::blackbody_rgb(6500.0);
    assert!((seen(&p) - glam::Vec3::new(2.0, 1.0, 0.5) / 60.0 * warm.0).length() < 1e-6);
    let mut p = sphere(0.5);
    p.normalize = true;
    p.render_from_light = DAffine3::from_scale(DVec3::splat(4.0));
    let s = light(&p).sample(Point3::new(0.0, 0.0, -5.0), Vec2::splat(0.5)).unwrap();
    assert!(close(s.radiance.0.x, 1.0 / (16.0 * PI), 1e-5) && close(s.distance, 3.0, 1e-4), "{s:?}");
}

#[test]
fn a_point_shines_like_its_sphere_from_afar() {
    for normalize in [false, true] {
        for radius in [0.5, 0.01] {
            let kind = LightKind::Sphere { radius, treat_as_point: true };
            let point = light(&LightParams { normalize, ..params(kind) });
            let ball = light(&LightParams { normalize, ..sphere(radius) });
            let p = Point3::new(3.0, 40.0, -5.0);
            let n = Normal3((Point3::ZERO - p).normalized().0);
            let s = point.sample(p, Vec2::splat(0.5)).unwrap();
            assert!(s.is_delta && point.is_delta() && point.intersect(&Ray::new(p, s.wi)).is_none());
            assert!(close(s.radiance.0.x, irradiance(&ball, p, n, 1024).0, 2e-3));
            assert!(point.sample(Point3::ZERO, Vec2::splat(0.5)).is_none());
        }
    }
}

#[test]
fn powers_are_the_integrals_of_their_light() {
    let (r, s) = (light(&rect(2.0, 3.0)), light(&sphere(0.5)));
    assert!(close(r.power_estimate(10.0), 6.0 * PI, 1e-5) && close(s.power_estimate(10.0), PI * PI, 1e-5));
    assert!(close(light(&distant(0.0)).power_estimate(10.0), 100.0 * PI, 1e-5));
    let dome = light(&params(LightKind::Dome { texture: None }));
    assert!(close(dome.power_estimate(1.0), 4.0 * PI * PI, 1e-5));
    assert_eq!((r.bounds().unwrap().max.y, s.bounds().unwrap().min.z, dome.bounds()), (1.5, -0.5, None));
}

fn spotted_map() -> Arc<EnvironmentMap> {
    let mut pixels: Vec<[f32; 3]> = (0..32 * 16).map(|i| [0.1 + (i % 7) as f32 * 0.1, 0.2, 0.3]).collect();
    pixels[5 * 32 + 9] = [40.0, 30.0, 20.0];
    pixels[32 + 20] = [9.0, 9.0, 9.0];
    Arc::new(EnvironmentMap::from_pixels(32, 16, pixels).unwrap())
}

#[test]
fn sampled_densities_stand_the_chi_squared_test() {
    let turned = DAffine3::from_rotation_x(0.7) * DAffine3::from_rotation_z(1.1);
    let at = |x, y, z| DAffine3::from_translation(DVec3::new(x, y, z));
    let shear = DAffine3::from_mat3(glam::DMat3::from_cols(DVec3::X, DVec3::new(0.8, 1.0, 0.3), DVec3::Z));
    let place = |p: LightParams, m| LightParams { render_from_light: m, ..p };
    let lights = [
        ("near rectangle", place(rect(2.0, 1.0), at(0.3, 0.2, 0.4))),
        ("turned rectangle", place(rect(3.0, 2.0), at(0.5, -0.8, 1.5) * turned)),
        (
            "mirrored rectangle",
            place(rect(3.0, 2.0), at(0.5, -0.8, 1.5) * DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0))),
        ),
        ("parallelogram", place(rect(2.0, 2.0), at(0.2, 0.1, 1.2) * shear)),
        ("sphere", place(sphere(1.0), at(1.0, 1.0, 0.5))),
        ("close sphere", place(sphere(1.0), at(0.0, 1.01, 0.0))),
        ("sun", place(distant(40.0), turned)),
        ("half sky", place(distant(200.0), turned)),
        ("dome", place(params(LightKind::Dome { texture: Some(spotted_map()) }), turned)),
        (
            "mirrored dome",
            place(
                params(LightKind::Dome { texture: Some(spotted_map()) }),
                DAffine3::from_scale(DVec3::new(3.0, 3.0, -3.0)),
            ),
        ),
    ];
    let o = Chi2Options { samples: 40_000, bins: [16, 32], min_depth: 3, ..Chi2Options::default() };
    for (name, p) in &lights {
        let l = light(p);
        let sample = |u| {
            let s = l.sample(Point3::ZERO, u)?;
            assert!((s.wi.length() - 1.0).abs() < 1e-5 && s.pdf_solid_angle > 0.0, "{name}: {s:?}");
            if s.distance.is_finite() {
                // Shrunk towards the light a little, the direction must meet it where the sample says.
                let hit = l.intersect(&Ray::new(Point3::ZERO, s.wi));
                assert!(hit.is_none_or(|h| (h.t - s.distance).abs() < 0.03 * s.distance), "{name}: {hit:?} {s:?}");
            }
            Some(s.wi)
        };
        let outcome = test_sphere(o, sample, |w| l.pdf_solid_angle(Point3::ZERO, w));
        assert!(outcome.accepted(0.01, lights.len()) && (outcome.integral - 1.0).abs() < 3e-3, "{name}: {outcome:?}");
    }
}

#[test]
fn shapes_are_met_by_rays() {
    let r = light(&rect(2.0, 1.0));
    let ray = |o: [f32; 3], d: [f32; 3]| Ray::new(o.into(), d.into());
    let front = r.intersect(&ray([0.9, 0.4, -2.0], [0.0, 0.0, 2.0])).unwrap();
    assert_eq!((front.t, front.radiance), (1.0, Rgb::WHITE));
    let back = r.intersect(&ray([0.9, 0.4, 2.0], [0.0, 0.0, -1.0])).unwrap();
    assert_eq!((back.t, back.radiance), (2.0, Rgb::BLACK));
    assert!(r.intersect(&ray([1.1, 0.4, -2.0], [0.0, 0.0, 1.0])).is_none());
    assert!(r.intersect(&ray([0.0, 0.0, -2.0], [0.0, 0.0, -1.0])).is_none());
    assert!(r.intersect(&ray([0.0, 0.0, 0.0], [1.0, 0.0, 0.0])).is_none());
    let s = light(&sphere(0.5));
    let outside = s.intersect(&ray([0.0, 0.0, -2.0], [0.0, 0.0, 3.0])).unwrap();
    assert!(close(outside.t, 0.5, 1e-6) && outside.radiance == Rgb::WHITE);
    let inside = s.intersect(&ray([0.0, 0.0, 0.25], [0.0, 0.0, -1.0])).unwrap();
    assert!(close(inside.t, 0.75, 1e-6) && inside.radiance == Rgb::BLACK);
    assert!(s.intersect(&ray([0.0, 0.51, -2.0], [0.0, 0.0, 1.0])).is_none());
    let limited = Ray { t_max: 1.0, ..ray([0.0, 0.0, -2.0], [0.0, 0.0, 1.0]) };
    assert!(s.intersect(&limited).is_none() && r.intersect(&limited).is_none());
    // A small sphere far away is not blurred by rounding.
    let far = LightParams { render_from_light: DAffine3::from_translation(DVec3::Z * 1e4), ..sphere(0.1) };
    assert!(light(&far).intersect(&ray([0.09, 0.0, 0.0], [0.0, 0.0, 1.0])).is_some());
    assert!(light(&far).intersect(&ray([0.11, 0.0, 0.0], [0.0, 0.0, 1.0])).is_none());
}

#[test]
fn broken_lights_are_reported() {
    let error = |p: &LightParams| Light::new(p).err();
    let squashed = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0));
    let nan = DAffine3::from_translation(DVec3::NAN);
    assert_eq!(error(&rect(0.0, 1.0)), Some(LightProblem::NoArea));
    assert_eq!(error(&rect(f32::NAN, 1.0)), Some(LightProblem::NoArea));
    assert_eq!(error(&sphere(0.0)), Some(LightProblem::NoArea));
    assert_eq!(error(&sphere(-1.0)), Some(LightProblem::NoArea));
    assert_eq!(error(&sphere(1e-30)), Some(LightProblem::NoArea));
    for p in [rect(1.0, 1.0), sphere(1.0), distant(1.0), params(LightKind::Dome { texture: None })] {
        assert_eq!(error(&LightParams { render_from_light: nan, ..p.clone() }), Some(LightProblem::SingularTransform));
        let flat = Light::new(&LightParams { render_from_light: squashed, ..p.clone() });
        assert!(matches!(p.kind, LightKind::Distant { .. }) || flat.err() == Some(LightProblem::SingularTransform));
        for (intensity, color, problem) in [
            (-1.0, Rgb::WHITE, LightProblem::Negative("intensity")),
            (f32::NAN, Rgb::WHITE, LightProblem::NotFinite("intensity")),
            (1.0, Rgb::new(-1.0, -1.0, -0.5), LightProblem::Negative("color")),
        ] {
            let (l, problems) = Light::new(&LightParams { intensity, color, ..p.clone() }).unwrap();
            assert!(l.is_black() && problems == [problem], "{problems:?}");
        }
        let (l, problems) = Light::new(&LightParams { exposure: 500.0, normalize: true, ..p.clone() }).unwrap();
        assert_eq!(problems, [LightProblem::TooBright]);
        let s = l.sample(Point3::new(0.0, 0.0, -3.0), Vec2::splat(0.4)).unwrap();
        assert!(s.radiance.is_finite() && l.power_estimate(1.0).is_finite());
    }
}

#[test]
fn samples_are_finite_from_anywhere() {
    let lights = [
        light(&rect(2.0, 1.0)),
        light(&rect(1e-6, 1e6)),
        light(&sphere(1.0)),
        light(&sphere(1e-9)),
        light(&params(LightKind::Sphere { radius: 1.0, treat_as_point: true })),
        light(&distant(0.5)),
        light(&params(LightKind::Dome { texture: Some(spotted_map()) })),
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
