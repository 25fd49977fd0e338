//! Every lobe at every roughness and angle: samples follow the density, and their weights add up to the integral of
//! the values.

use std::f32::consts::PI;

use umber_math::{Frame, Normal3, Rgb, Vector3};
use umber_sampling::Sampler;
use umber_sampling::chi2::{Chi2Options, test_sphere};
use umber_shading::{Bsdf, PreviewSurface};

const UP: Normal3 = Normal3::new(0.0, 0.0, 1.0);
const ROUGHNESSES: [f32; 5] = [0.2, 0.35, 0.5, 0.75, 1.0];
const COSINES: [f32; 4] = [0.98, 0.6, 0.25, 0.06];
/// Of the direction to the viewer.
const AZIMUTH: f32 = 0.7;

/// A surface that is one lobe, or a layering of them, at a roughness.
type Make = fn(f32) -> PreviewSurface;

const LOBES: [(&str, Make); 6] = [
    ("diffuse", |_| PreviewSurface { specular_color: Rgb::BLACK, ..glossy(0.5, Rgb::WHITE) }),
    ("dielectric", |r| glossy(r, Rgb::BLACK)),
    ("metal", |r| PreviewSurface { diffuse_color: Rgb::WHITE, metallic: 1.0, roughness: r, ..Default::default() }),
    ("coat", |r| PreviewSurface { specular_color: Rgb::BLACK, ..coated(0.5, r, Rgb::BLACK) }),
    ("dielectric over diffuse", |r| glossy(r, Rgb::new(0.9, 0.5, 0.2))),
    ("coat over dielectric over diffuse", |r| coated(1.1 - r, r, Rgb::new(0.9, 0.5, 0.2))),
];

fn glossy(roughness: f32, diffuse_color: Rgb) -> PreviewSurface {
    let specular_color = Rgb::splat(0.3);
    PreviewSurface { use_specular_workflow: true, specular_color, diffuse_color, roughness, ..Default::default() }
}

fn coated(roughness: f32, clearcoat_roughness: f32, diffuse_color: Rgb) -> PreviewSurface {
    PreviewSurface { clearcoat: 1.0, clearcoat_roughness, ..glossy(roughness, diffuse_color) }
}

fn direction(cos: f32, phi: f32) -> Vector3 {
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    Vector3::new(sin * phi.cos(), sin * phi.sin(), cos)
}

fn for_all(mut test: impl FnMut(&str, &Bsdf, Vector3)) {
    for (name, make) in LOBES {
        for roughness in ROUGHNESSES {
            for cos in COSINES {
                let bsdf = make(roughness).bsdf(Frame::from_normal(UP), UP);
                test(&format!("{name}, roughness {roughness}, cosine {cos}"), &bsdf, direction(cos, AZIMUTH));
            }
        }
    }
}

#[test]
fn samples_follow_the_density() {
    let tests = LOBES.len() * ROUGHNESSES.len() * COSINES.len();
    let o = Chi2Options { samples: 20_000, bins: [16, 24], ..Chi2Options::default() };
    for_all(|name, bsdf, wo| {
        let mut lobe = 0;
        let sample = |u| {
            lobe += 1;
            bsdf.sample(wo, Sampler::new(31, [5, 6], lobe).next_1d(), u).map(|s| s.wi)
        };
        let outcome = test_sphere(o, sample, |wi| bsdf.pdf_solid_angle(wo, wi));
        assert!(outcome.accepted(0.01, tests), "{name}: {outcome:?}");
    });
}

/// Reflectance in a white furnace, two ways: by the surface's own sampling, and by midpoints over the half sphere.
#[test]
fn weights_add_up_to_the_integral_of_the_values() {
    const SAMPLES: u32 = 1 << 12;
    // cosines and azimuths
    const HEIGHTS: u32 = 384;
    const AZIMUTHS: u32 = 256;
    for_all(|name, bsdf, wo| {
        let weight = |i| {
            let mut s = Sampler::new(5, [1, 2], i);
            let sampled = bsdf.sample(wo, s.next_1d(), s.next_2d());
            sampled.map_or(0.0, |s| f64::from((s.f * (s.cos_theta / s.pdf_solid_angle)).max_channel()))
        };
        let sampled = (0..SAMPLES).map(weight).sum::<f64>() / f64::from(SAMPLES);
        let value = |cell: u32| {
            let cos = ((cell / AZIMUTHS) as f32 + 0.5) / HEIGHTS as f32;
            // azimuths crowd about the mirror direction, where lobes are narrow at grazing angles
            let s = 2.0 * ((cell % AZIMUTHS) as f32 + 0.5) / AZIMUTHS as f32 - 1.0;
            let wi = direction(cos, AZIMUTH + PI * (1.0 + s * s * s));
            f64::from(bsdf.eval(wo, wi).max_channel() * cos * 3.0 * PI * s * s)
        };
        let cells = HEIGHTS * AZIMUTHS;
        let integral = (0..cells).map(value).sum::<f64>() * 2.0 / f64::from(cells);
        assert!((sampled - integral).abs() < 0.01, "{name}: {sampled} by samples, {integral} by midpoints");
        assert!(integral <= 1.005, "{name}: {integral}");
    });
}
