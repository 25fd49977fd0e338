//! Environment maps of every format: orientation, agreement with latitude-longitude, sampling.

use std::f32::consts::{FRAC_1_SQRT_2, PI};

use glam::{Vec2, Vec3};
use umber_math::{Rgb, Vector3};
use umber_sampling::Sampler;
use umber_sampling::chi2::{Chi2Options, test_sphere};
use umber_shading::{EnvironmentMap, TextureFormat};

const FORMATS: [TextureFormat; 4] =
    [TextureFormat::LatLong, TextureFormat::Angular, TextureFormat::MirroredBall, TextureFormat::CubeMapVerticalCross];

fn size(format: TextureFormat, scale: usize) -> [usize; 2] {
    match format {
        TextureFormat::LatLong => [4 * scale, 2 * scale],
        TextureFormat::Angular | TextureFormat::MirroredBall => [4 * scale, 4 * scale],
        TextureFormat::CubeMapVerticalCross => [3 * scale, 4 * scale],
    }
}

/// The direction that a place of an image shows, written down a second time.
fn shown(format: TextureFormat, u: f32, v: f32) -> Option<Vec3> {
    let p = Vec2::new(2.0 * u - 1.0, 1.0 - 2.0 * v);
    let r = p.length();
    match format {
        TextureFormat::LatLong => {
            let (longitude, latitude) = (PI - 2.0 * PI * u, PI * (0.5 - v));
            let (sin, cos) = longitude.sin_cos();
            Some(Vec3::new(sin * latitude.cos(), latitude.sin(), cos * latitude.cos()))
        }
        TextureFormat::Angular if r <= 1.0 => {
            // +Z, turned by π r about the axis in the image plane that is square to p.
            let axis = Vec3::new(-p.y, p.x, 0.0).normalize_or(Vec3::X);
            Some(glam::Quat::from_axis_angle(axis, PI * r) * Vec3::Z)
        }
        TextureFormat::MirroredBall if r <= 1.0 => {
            // A ray that flies along −Z, mirrored by the ball.
            let normal = Vec3::new(p.x, p.y, (1.0 - r * r).sqrt());
            Some(Vec3::NEG_Z - 2.0 * normal * normal.dot(Vec3::NEG_Z))
        }
        TextureFormat::CubeMapVerticalCross => {
            // Folded up: cells beside the front one turn by a quarter about the edge that they share with it.
            let (column, row) = ((3.0 * u) as i32, (4.0 * v) as i32);
            let on_front = Vec3::new(1.0 - 2.0 * (3.0 * u - column as f32), 1.0 - 2.0 * (4.0 * v - row as f32), 1.0);
            let quarter = PI * 0.5;
            let turn = match (column, row) {
                (1, 1) => glam::Quat::IDENTITY,
                (0, 1) => glam::Quat::from_rotation_y(quarter),
                (2, 1) => glam::Quat::from_rotation_y(-quarter),
                (1, 0) => glam::Quat::from_rotation_x(-quarter),
                (1, 2) => glam::Quat::from_rotation_x(quarter),
                (1, 3) => glam::Quat::from_rotation_x(2.0 * quarter),
                _ => return None,
            };
            Some((turn * on_front).normalize())
        }
        _ => None,
    }
}

fn map(format: TextureFormat, scale: usize, radiance: impl Fn(Vec3) -> [f32; 3]) -> EnvironmentMap {
    let [width, height] = size(format, scale);
    let pixel = |i: usize| {
        let (u, v) = ((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
        shown(format, u / width as f32, v / height as f32).map_or([0.0; 3], &radiance)
    };
    EnvironmentMap::from_pixels_as(format, width, height, (0..width * height).map(pixel).collect()).unwrap()
}

fn smooth(w: Vec3) -> [f32; 3] {
    [1.0 + w.x * 0.5 + 0.3 * w.y * w.z, 1.0 + 0.8 * w.y, 1.5 - w.z + 0.2 * w.x * w.y]
}

fn directions(n: u32) -> impl Iterator<Item = Vector3> {
    (0..n).map(|i| umber_sampling::warp::uniform_sphere(Sampler::new(9, [0, 0], i).next_2d()))
}

#[test]
fn every_format_shows_the_axes_where_it_should() {
    let colors = |w: Vec3| {
        let m = w.abs();
        match () {
            () if m.z > m.x && m.z > m.y => [1.0, if w.z > 0.0 { 1.0 } else { 0.0 }, 0.0],
            () if m.x > m.y => [0.0, 1.0, if w.x > 0.0 { 1.0 } else { 0.0 }],
            () => [if w.y > 0.0 { 1.0 } else { 0.0 }, 0.0, 1.0],
        }
    };
    for format in FORMATS {
        let m = map(format, 32, colors);
        for axis in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z] {
            assert_eq!(m.radiance(Vector3(axis)), Rgb::from(colors(axis)), "{format:?} {axis}");
        }
    }
    // Known places: halfway to the rim of a probe, and at the sine of 45° of a ball, lies the horizon; +X to the right.
    let r = 0.5 * FRAC_1_SQRT_2;
    for (format, u, v, w) in [
        (TextureFormat::Angular, 0.5, 0.5, Vec3::Z),
        (TextureFormat::Angular, 0.75, 0.5, Vec3::X),
        (TextureFormat::Angular, 0.5, 0.25, Vec3::Y),
        (TextureFormat::MirroredBall, 0.5, 0.5, Vec3::Z),
        (TextureFormat::MirroredBall, 0.5 + r, 0.5, Vec3::X),
        (TextureFormat::MirroredBall, 0.5, 0.5 + r, Vec3::NEG_Y),
        (TextureFormat::CubeMapVerticalCross, 1.0 / 6.0, 3.0 / 8.0, Vec3::X),
        (TextureFormat::CubeMapVerticalCross, 0.5, 3.0 / 8.0, Vec3::Z),
        (TextureFormat::CubeMapVerticalCross, 5.0 / 6.0, 3.0 / 8.0, Vec3::NEG_X),
        (TextureFormat::CubeMapVerticalCross, 0.5, 1.0 / 8.0, Vec3::Y),
        (TextureFormat::CubeMapVerticalCross, 0.5, 5.0 / 8.0, Vec3::NEG_Y),
        (TextureFormat::CubeMapVerticalCross, 0.5, 7.0 / 8.0, Vec3::NEG_Z),
        (TextureFormat::LatLong, 0.25, 0.5, Vec3::X),
    ] {
        assert!((shown(format, u, v).unwrap() - w).length() < 1e-5, "{format:?} {u} {v}");
        // One bright pixel there: it is seen along the axis.
        let [width, height] = size(format, 33);
        let mut pixels = vec![[0.0; 3]; width * height];
        pixels[(v * height as f32) as usize * width + (u * width as f32) as usize] = [1.0; 3];
        let m = EnvironmentMap::from_pixels_as(format, width, height, pixels).unwrap();
        assert!(m.radiance(Vector3(w)).0.x > 0.2, "{format:?} {u} {v} {w}");
    }
}

#[test]
fn formats_agree_with_the_function_that_they_show() {
    for format in FORMATS {
        let m = map(format, 64, smooth);
        let worst = directions(4000)
            .map(|w| (w, (m.radiance(w).0 - Vec3::from(smooth(w.0))).abs().max_element()))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap();
        // The rim of a ball is the point behind it, where a pixel spans many degrees.
        let tolerance = if format == TextureFormat::MirroredBall { 0.2 } else { 0.03 };
        assert!(worst.1 < tolerance, "{format:?}: {worst:?}");
        assert!((m.mean_radiance().0 - Vec3::new(1.0, 1.0, 1.5)).length() < 0.01, "{format:?} {}", m.mean_radiance().0);
    }
}

#[test]
fn sampling_finds_the_irradiance() {
    // ∫ (1 + 0.8 y) max(y, 0) dω = π + 0.8 · 2π/3, green.
    let want = PI + 0.8 * 2.0 * PI / 3.0;
    for format in FORMATS {
        let m = map(format, 48, smooth);
        let n = 1 << 14;
        let sum: f32 = (0..n)
            .map(|i| {
                let (w, radiance, pdf) = m.sample(Sampler::new(2, [0, 0], i).next_2d());
                if pdf > 0.0 { radiance.0.y * w.y().max(0.0) / pdf } else { 0.0 }
            })
            .sum();
        let got = sum / n as f32;
        assert!((got / want - 1.0).abs() < 6e-3, "{format:?}: {got}, not {want}");
    }
}

#[test]
fn densities_stand_the_chi_squared_test() {
    let spotted = |w: Vec3| if w.dot(Vec3::new(0.6, 0.64, 0.48)) > 0.95 { [20.0, 10.0, 5.0] } else { smooth(w) };
    for format in FORMATS {
        let m = map(format, 8, spotted);
        let o = Chi2Options { samples: 40_000, bins: [16, 32], min_depth: 3, ..Chi2Options::default() };
        let sample = |u| {
            let (w, radiance, pdf) = m.sample(u);
            assert!(radiance.is_finite() && (w.length() - 1.0).abs() < 1e-5 && pdf.is_finite());
            (pdf > 0.0).then_some(w)
        };
        let outcome = test_sphere(o, sample, |w| m.pdf_solid_angle(w));
        assert!(outcome.accepted(0.01, FORMATS.len()) && outcome.integral > 0.9, "{format:?}: {outcome:?}");
    }
}

#[test]
fn a_sun_anywhere_is_found() {
    // No direction that shines may be out of the sampler's reach.
    for format in FORMATS {
        for (i, sun) in directions(24).enumerate() {
            let m = map(format, 16, |w| if w.dot(sun.0) > 0.97 { [100.0; 3] } else { [0.0; 3] });
            for w in directions(2000).filter(|w| m.radiance(*w).0.x > 1e-3) {
                assert!(m.pdf_solid_angle(w) > 0.0, "{format:?} {i}: {w:?}");
            }
        }
    }
}

#[test]
fn automatic_is_told_by_the_shape_of_the_image() {
    assert_eq!(TextureFormat::guess(3 * 64, 4 * 64), TextureFormat::CubeMapVerticalCross);
    for (width, height) in [(1, 1), (512, 256), (256, 256), (4, 3), (1024, 512), (100, 77), (0, 0)] {
        assert_eq!(TextureFormat::guess(width, height), TextureFormat::LatLong, "{width} × {height}");
    }
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("cross.exr");
    exr::prelude::write_rgb_file(&path, 30, 40, |x, y| (x as f32, y as f32, 1.0f32)).unwrap();
    // The middle of the front face, of 10 × 10 pixels: between those at (14, 14) and (15, 15).
    let middle = |format| EnvironmentMap::load_as(&path, format).unwrap().radiance(Vector3::new(0.0, 0.0, 1.0)).0;
    assert!((middle(None) - Vec3::new(14.5, 14.5, 1.0)).length() < 1e-3, "{}", middle(None));
    assert!((middle(Some(TextureFormat::LatLong)) - Vec3::new(14.5, 19.5, 1.0)).length() < 1e-3);
}

#[test]
fn tiny_images_work() {
    for format in FORMATS {
        for (width, height) in [(1, 1), (2, 1), (1, 3), (3, 4), (2, 2)] {
            let m =
                EnvironmentMap::from_pixels_as(format, width, height, vec![[2.0, 3.0, 4.0]; width * height]).unwrap();
            let (n, mut sum) = (4096, 0.0);
            for i in 0..n {
                let (w, radiance, pdf) = m.sample(Sampler::new(4, [0, 0], i).next_2d());
                assert!(w.is_finite() && radiance.is_finite() && pdf.is_finite() && pdf >= 0.0);
                sum += if pdf > 0.0 { radiance.0.x / pdf } else { 0.0 };
            }
            let mean = sum / n as f32 / (4.0 * PI);
            assert!((mean - 2.0).abs() < 0.05, "{format:?} {width} × {height}: {mean}");
            assert!((m.mean_radiance().0 - Vec3::new(2.0, 3.0, 4.0)).length() < 1e-4);
            for w in directions(200).chain([Vector3::new(0.0, 0.0, -1.0), Vector3::new(0.0, 0.0, 1.0)]) {
                assert!(
                    (m.radiance(w).0 - Vec3::new(2.0, 3.0, 4.0)).length() < 1e-4 && m.pdf_solid_angle(w).is_finite()
                );
            }
        }
        let black = EnvironmentMap::from_pixels_as(format, 6, 8, vec![[0.0; 3]; 48]).unwrap();
        assert!(black.radiance(Vector3::new(0.0, 1.0, 0.0)).is_black());
    }
}
