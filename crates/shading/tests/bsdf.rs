//! Energy, reciprocity, densities and edge cases of surfaces.

use glam::{Vec2, Vec3};
use umber_math::{Frame, Normal3, Rgb, Vector3};
use umber_sampling::Sampler;
use umber_sampling::chi2::{Chi2Options, test_sphere};
use umber_shading::{Bsdf, LobeKind, Material, OpacityMode, PreviewSurface};

const UP: Normal3 = Normal3::new(0.0, 0.0, 1.0);

fn flat(p: &PreviewSurface) -> Bsdf {
    p.bsdf(Frame::from_normal(UP), UP)
}

fn at_cosine(cos: f32, phi: f32) -> Vector3 {
    let sin = (1.0 - cos * cos).sqrt();
    Vector3::new(sin * phi.cos(), sin * phi.sin(), cos)
}

fn metal(roughness: f32) -> PreviewSurface {
    PreviewSurface { diffuse_color: Rgb::WHITE, metallic: 1.0, roughness, ..Default::default() }
}

fn plastic(roughness: f32) -> PreviewSurface {
    PreviewSurface { diffuse_color: Rgb::WHITE, roughness, ..Default::default() }
}

fn specular(f0: f32, roughness: f32) -> PreviewSurface {
    let specular_color = Rgb::splat(f0);
    PreviewSurface { use_specular_workflow: true, specular_color, ..plastic(roughness) }
}

fn coated(base: PreviewSurface, clearcoat_roughness: f32) -> PreviewSurface {
    PreviewSurface { clearcoat: 1.0, clearcoat_roughness, ..base }
}

/// Reflectance towards `wo` in a white environment, by the surface's own sampling.
fn furnace(bsdf: &Bsdf, wo: Vector3, samples: u32) -> f32 {
    let weight = |i| {
        let mut s = Sampler::new(5, [1, 2], i);
        bsdf.sample(wo, s.next_1d(), s.next_2d()).map_or(0.0, |s| {
            assert!(s.f.is_finite() && s.pdf_solid_angle > 0.0 && s.cos_theta > 0.0 && s.wi.z() > 0.0, "{s:?}");
            (s.f * (s.cos_theta / s.pdf_solid_angle)).max_channel()
        })
    };
    (0..samples).map(|i| f64::from(weight(i))).sum::<f64>() as f32 / samples as f32
}

const ROUGHNESSES: [f32; 8] = [0.0, 0.02, 0.032, 0.05, 0.15, 0.3, 0.6, 1.0];
const COSINES: [f32; 7] = [1.0, 0.9, 0.6, 0.3, 0.1, 0.03, 0.004];

#[test]
fn no_surface_creates_energy() {
    for r in ROUGHNESSES {
        let surfaces = [
            metal(r),
            plastic(r),
            specular(0.5, r),
            specular(1.0, r),
            coated(plastic(0.4), r),
            coated(plastic(r), 0.01),
            coated(metal(r), 0.3),
            PreviewSurface { ior: 4.0, ..coated(specular(0.9, r), r) },
            PreviewSurface { metallic: 0.5, ..coated(plastic(r), 0.2) },
        ];
        for (i, surface) in surfaces.iter().enumerate() {
            for cos in COSINES {
                let e = furnace(&flat(surface), at_cosine(cos, 0.3), 1 << 13);
                assert!(e <= 1.004, "surface {i}, roughness {r}, cosine {cos}: {e}");
            }
        }
    }
}

#[test]
fn white_layers_lose_nothing_but_multiple_scattering() {
    for cos in COSINES {
        let lambert = Bsdf::lambert(Rgb::WHITE, Frame::from_normal(UP), UP);
        assert!((furnace(&lambert, at_cosine(cos, 0.0), 64) - 1.0).abs() < 1e-5);
        // A white mirror loses nothing; nor does a white base under a dielectric of any roughness.
        assert!((furnace(&flat(&metal(0.0)), at_cosine(cos, 0.0), 64) - 1.0).abs() < 1e-5);
        for r in ROUGHNESSES {
            let e = furnace(&flat(&plastic(r)), at_cosine(cos, 0.0), 4096);
            assert!((e - 1.0).abs() < 6e-3, "roughness {r}, cosine {cos}: {e}");
        }
    }
    // Single scattering at full roughness keeps more than three tenths at any angle.
    for cos in COSINES {
        assert!(furnace(&flat(&metal(1.0)), at_cosine(cos, 0.0), 4096) > 0.3);
    }
}

#[test]
fn the_albedo_estimate_agrees_with_sampling() {
    for r in [0.0, 0.1, 0.4, 0.8] {
        for surface in [metal(r), specular(0.3, r), coated(plastic(r), 0.3)] {
            for cos in [0.95, 0.5, 0.2] {
                let wo = at_cosine(cos, 1.0);
                let (estimate, e) = (flat(&surface).albedo(wo).max_channel(), furnace(&flat(&surface), wo, 4096));
                assert!((estimate - e).abs() < 0.03, "{surface:?} {cos}: {estimate} {e}");
            }
        }
    }
}

#[test]
fn values_are_reciprocal() {
    for surface in [plastic(0.3), metal(0.2), coated(specular(0.4, 0.5), 0.1), coated(plastic(0.8), 0.6)] {
        let bsdf = flat(&surface);
        for i in 0..64 {
            let mut s = Sampler::new(9, [0, 0], i);
            let (a, b) = (s.next_2d(), s.next_2d());
            let (wo, wi) = (
                at_cosine(0.02 + 0.97 * a.x, std::f32::consts::TAU * a.y),
                at_cosine(0.02 + 0.97 * b.x, std::f32::consts::TAU * b.y),
            );
            let (there, back) = (bsdf.eval(wo, wi), bsdf.eval(wi, wo));
            assert!((there.0 - back.0).abs().max_element() <= 1e-4 * there.max_channel(), "{there:?} {back:?}");
            assert!(there.0.min_element() > 0.0);
        }
    }
}

#[test]
fn sampled_densities_stand_the_chi_squared_test() {
    let surfaces = [
        plastic(0.2),
        plastic(1.0),
        metal(0.15),
        metal(0.4),
        metal(1.0),
        specular(0.6, 0.3),
        coated(plastic(0.5), 0.2),
        coated(metal(0.6), 0.3),
    ];
    let cosines = [0.999, 0.7, 0.2];
    let tests = surfaces.len() * cosines.len() + 1;
    let o = Chi2Options { samples: 40_000, bins: [24, 24], ..Chi2Options::default() };
    for surface in &surfaces {
        for cos in cosines {
            let wo = at_cosine(cos, 2.0);
            let mut lobe = 0u32;
            check(&flat(surface), wo, o, tests, &mut lobe, &format!("{surface:?} at {cos}"));
        }
    }
    // With a tilted frame whose shading normal is not the geometric one.
    let (n, ng) = (Normal3::new(0.3, -0.5, 0.7).normalized(), Normal3::new(0.1, -0.6, 0.7).normalized());
    let wo = Vector3::new(0.8, -0.1, 0.3).normalized();
    check(&plastic(0.4).bsdf(Frame::from_normal(n), ng), wo, o, tests, &mut 0, "tilted");
}

fn check(bsdf: &Bsdf, wo: Vector3, o: Chi2Options, tests: usize, lobe: &mut u32, name: &str) {
    let sample = |u| {
        *lobe += 1;
        let u_lobe = Sampler::new(77, [3, 4], *lobe).next_1d();
        let s = bsdf.sample(wo, u_lobe, u)?;
        let pdf = bsdf.pdf_solid_angle(wo, s.wi);
        assert!((pdf - s.pdf_solid_angle).abs() <= 2e-3 * pdf, "{name}: {pdf}, not {s:?}");
        let f = bsdf.eval(wo, s.wi);
        assert!((f.0 - s.f.0).abs().max_element() <= 2e-3 * f.max_channel(), "{name}: {f:?}, not {s:?}");
        Some(s.wi)
    };
    let outcome = test_sphere(o, sample, |wi| bsdf.pdf_solid_angle(wo, wi));
    assert!(outcome.accepted(0.01, tests), "{name}: {outcome:?}");
}

/// Values times cosine and densities of Mitsuba 3.9.1's `principled`, metallic 1, base colour (0.95, 0.64, 0.37):
/// roughness; polar angles of both directions and the azimuth between them.
#[rustfmt::skip]
const PRINCIPLED: [(f32, [f32; 3], [f32; 3], f32); 25] = [
    (0.05, [0.1, 0.1, 3.13], [1.0940e4, 7.3704e3, 4.2610e3], 1.1516e4),
    (0.05, [0.5, 0.55, 3.09], [7.3896e-1, 4.9784e-1, 2.8783e-1], 7.7785e-1),
    (0.05, [0.8, 0.7, 2.9], [3.0745e-3, 2.0726e-3, 1.1999e-3], 3.2361e-3),
    (0.05, [0.3, 1.0, 1.0], [4.7594e-6, 3.2063e-6, 1.8537e-6], 5.0099e-6),
    (0.05, [1.2, 1.15, 3.2], [4.3553e-2, 3.0635e-2, 1.9385e-2], 4.5637e-2),
    (0.15, [0.1, 0.1, 3.13], [1.4988e2, 1.0097e2, 5.8374e1], 1.5777e2),
    (0.15, [0.5, 0.55, 3.09], [2.3816e1, 1.6045e1, 9.2762e0], 2.5070e1),
    (0.15, [0.8, 0.7, 2.9], [2.3325e-1, 1.5724e-1, 9.1036e-2], 2.4553e-1),
    (0.15, [0.3, 1.0, 1.0], [3.8458e-4, 2.5908e-4, 1.4978e-4], 4.0494e-4),
    (0.15, [1.2, 1.15, 3.2], [2.9613e0, 2.0830e0, 1.3180e0], 3.1049e0),
    (0.3, [0.1, 0.1, 3.13], [9.3789e0, 6.3184e0, 3.6528e0], 9.8727e0),
    (0.3, [0.5, 0.55, 3.09], [8.7176e0, 5.8731e0, 3.3955e0], 9.1834e0),
    (0.3, [0.8, 0.7, 2.9], [1.6810e0, 1.1332e0, 6.5608e-1], 1.7719e0),
    (0.3, [0.3, 1.0, 1.0], [5.9333e-3, 3.9972e-3, 2.3109e-3], 6.2762e-3),
    (0.3, [1.2, 1.15, 3.2], [9.0571e0, 6.3708e0, 4.0312e0], 9.5854e0),
    (0.6, [0.1, 0.1, 3.13], [5.8587e-1, 3.9469e-1, 2.2818e-1], 6.1690e-1),
    (0.6, [0.5, 0.55, 3.09], [6.4322e-1, 4.3333e-1, 2.5053e-1], 6.8522e-1),
    (0.6, [0.8, 0.7, 2.9], [6.5535e-1, 4.4179e-1, 2.5578e-1], 7.0530e-1),
    (0.6, [0.3, 1.0, 1.0], [5.6622e-2, 3.8145e-2, 2.2053e-2], 6.3966e-2),
    (0.6, [1.2, 1.15, 3.2], [1.1154e0, 7.8454e-1, 4.9642e-1], 1.3343e0),
    (1.0, [0.1, 0.1, 3.13], [7.5598e-2, 5.0929e-2, 2.9443e-2], 7.9777e-2),
    (1.0, [0.5, 0.55, 3.09], [7.4117e-2, 4.9933e-2, 2.8869e-2], 8.4766e-2),
    (1.0, [0.8, 0.7, 2.9], [7.7244e-2, 5.2072e-2, 3.0148e-2], 9.3802e-2),
    (1.0, [0.3, 1.0, 1.0], [5.4248e-2, 3.6546e-2, 2.1128e-2], 8.1395e-2),
    (1.0, [1.2, 1.15, 3.2], [6.4668e-2, 4.5488e-2, 2.8783e-2], 1.1682e-1),
];

#[test]
fn metals_agree_with_another_renderer() {
    for (roughness, [to, ti, phi], want, want_pdf) in PRINCIPLED {
        let surface = PreviewSurface { diffuse_color: Rgb::new(0.95, 0.64, 0.37), ..metal(roughness) };
        let (wo, wi) = (at_cosine(to.cos(), 0.0), at_cosine(ti.cos(), phi));
        let got = flat(&surface).eval(wo, wi) * wi.z();
        let pdf = flat(&surface).pdf_solid_angle(wo, wi);
        let tolerance = 0.002;
        for (g, w) in got.0.to_array().into_iter().zip(want) {
            assert!((g / w - 1.0).abs() < tolerance, "{roughness} {to} {ti} {phi}: {got:?}, not {want:?}");
        }
        assert!((pdf / want_pdf - 1.0).abs() < 0.002, "{roughness} {to} {ti} {phi}: {pdf}, not {want_pdf}");
    }
}

#[test]
fn a_black_specular_color_leaves_a_pure_lambertian() {
    let albedo = Rgb::new(0.2, 0.5, 0.9);
    let surface = PreviewSurface { diffuse_color: albedo, ..specular(0.0, 0.3) };
    for cos in COSINES {
        let (wo, wi) = (at_cosine(cos, 0.0), at_cosine(0.3, 2.0));
        let f = flat(&surface).evaluate(wo, wi);
        assert_eq!((f.diffuse, f.glossy), (albedo * std::f32::consts::FRAC_1_PI, Rgb::BLACK));
    }
    // An ior of one reflects nothing either, the coat included.
    let none = PreviewSurface { ior: 1.0, clearcoat: 1.0, diffuse_color: Rgb::BLACK, ..Default::default() };
    assert!(flat(&none).is_black() && !flat(&none).has_non_delta());
    assert!(flat(&none).sample(at_cosine(0.5, 0.0), 0.5, Vec2::splat(0.5)).is_none());
}

#[test]
fn smooth_metals_are_mirrors() {
    for roughness in [0.0, 0.01, 0.03] {
        let surface = PreviewSurface { diffuse_color: Rgb::new(0.9, 0.5, 0.1), ..metal(roughness) };
        let bsdf = flat(&surface);
        let wo = at_cosine(0.4, 0.7);
        let s = bsdf.sample(wo, 0.3, Vec2::new(0.2, 0.9)).unwrap();
        assert!((s.wi.0 - Vec3::new(-wo.x(), -wo.y(), wo.z())).length() < 1e-6 && s.lobe == LobeKind::Delta);
        let throughput = s.f * (s.cos_theta / s.pdf_solid_angle);
        let schlick = 0.6f32.powi(5);
        let want = Vec3::new(0.9, 0.5, 0.1) * (1.0 - schlick) + schlick;
        assert!((throughput.0 - want).length() < 1e-5);
        assert!(!bsdf.has_non_delta() && !bsdf.is_black() && bsdf.eval(wo, s.wi).is_black());
        assert_eq!(bsdf.pdf_solid_angle(wo, s.wi), 0.0);
    }
    assert_eq!(flat(&metal(0.033)).sample(at_cosine(0.4, 0.7), 0.3, Vec2::splat(0.4)).unwrap().lobe, LobeKind::Glossy);
}

#[test]
fn both_sides_reflect_and_light_does_not_leak() {
    let (wo, wi) = (at_cosine(0.6, 0.0), at_cosine(0.3, 2.0));
    for surface in [plastic(0.4), metal(0.3), specular(0.0, 0.5)] {
        let front = flat(&surface);
        let f = front.eval(wo, wi);
        // Seen from behind, or with any of the normals turned: the same.
        assert!((front.eval(-wo, -wi).0 - f.0).length() < 1e-5 * f.max_channel());
        for (n, ng) in [(UP, -UP), (-UP, UP), (-UP, -UP)] {
            assert!((surface.bsdf(Frame::from_normal(n), ng).eval(wo, wi).0 - f.0).length() < 1e-5 * f.max_channel());
        }
        assert!(front.eval(wo, -wi).is_black() && front.eval(-wo, wi).is_black());
        // Above the shading horizon but below the surface.
        let ng = Normal3::new(0.6, 0.0, 0.8);
        let leaning = surface.bsdf(Frame::from_normal(UP), ng);
        let below = Vector3::new(-0.9, 0.0, 0.1).normalized();
        assert!(leaning.eval(wo, below).is_black() && leaning.pdf_solid_angle(wo, below) == 0.0);
        for i in 0..256 {
            let mut s = Sampler::new(0, [0, 0], i);
            if let Some(s) = leaning.sample(wo, s.next_1d(), s.next_2d()) {
                assert!(s.wi.dot_normal(ng) > 0.0);
            }
        }
        // The viewer above the surface but below the shading horizon: not black.
        let rim = Vector3::new(0.99, 0.0, -0.1).normalized();
        assert!(leaning.eval(rim, Vector3::new(0.3, 0.0, 0.9).normalized()).max_channel() > 0.0);
    }
}

#[test]
fn presence_and_emission() {
    let opacity = |opacity, opacity_threshold| PreviewSurface { opacity, opacity_threshold, ..Default::default() };
    assert_eq!(opacity(0.3, 0.0).presence(), 0.3);
    assert_eq!((opacity(0.3, 0.5).presence(), opacity(0.5, 0.5).presence()), (0.0, 1.0));
    assert_eq!(
        (opacity(7.0, 0.0).presence(), opacity(-1.0, 0.0).presence(), opacity(f32::NAN, 0.1).presence()),
        (1.0, 0.0, 0.0)
    );
    assert_eq!(PreviewSurface { opacity_mode: OpacityMode::Presence, ..opacity(0.2, 0.0) }.presence(), 0.2);
    let emissive_color = Rgb::new(2.0, -1.0, f32::NAN);
    let glow = Material::Preview(PreviewSurface { emissive_color, ..Default::default() });
    assert_eq!(glow.emission(), Rgb::new(2.0, 0.0, 0.0));
    let bound = Material::default();
    assert_eq!((bound.presence(), bound.emission()), (1.0, Rgb::BLACK));
    let f = bound.bsdf(Frame::from_normal(UP), UP).eval(at_cosine(0.5, 0.0), at_cosine(0.5, 1.0));
    assert!((f.0.x - 0.18 / std::f32::consts::PI).abs() < 1e-6);
}

#[test]
fn any_input_gives_finite_values() {
    let odd = [0.0, 1.0, -1.0, 1e-20, 1e30, f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    let directions = [
        at_cosine(1.0, 0.0),
        at_cosine(1e-6, 0.0),
        at_cosine(0.5, 1.0),
        Vector3::new(f32::NAN, 0.0, 1.0),
        Vector3::ZERO,
    ];
    for a in odd {
        for b in odd {
            let surface = PreviewSurface {
                diffuse_color: Rgb::new(a, b, 0.5),
                specular_color: Rgb::splat(b),
                use_specular_workflow: a > 0.5,
                metallic: b,
                roughness: a,
                clearcoat: b,
                clearcoat_roughness: a,
                ior: b,
                ..Default::default()
            };
            for n in [UP, Normal3::ZERO, Normal3::new(f32::NAN, 0.0, 0.0)] {
                let bsdf = surface.bsdf(Frame::from_normal(UP), n);
                for wo in directions {
                    for wi in directions {
                        let e = bsdf.evaluate(wo, wi);
                        assert!(e.f().is_finite() && e.pdf_solid_angle.is_finite(), "{surface:?} {wo:?} {wi:?}: {e:?}");
                    }
                    for u in [0.0, 0.3, 0.999_999_94] {
                        if let Some(s) = bsdf.sample(wo, u, Vec2::new(u, 1.0 - u)) {
                            let throughput = s.f * (s.cos_theta / s.pdf_solid_angle);
                            assert!(throughput.is_finite() && s.wi.is_finite(), "{surface:?} {wo:?}: {s:?}");
                        }
                    }
                }
            }
        }
    }
}
