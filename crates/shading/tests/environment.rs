//! Environment maps: files, orientation, sampling.

use std::f32::consts::PI;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Vec2;
use umber_math::{DAffine3, DMat4, Point3, Rgb, Vector3};
use umber_sampling::Sampler;
use umber_shading::{EnvironmentMap, ImageError, Light, LightKind, LightParams, LinearImage};

/// Every pixel its own colour: red by column, green by row.
fn numbered(width: usize, height: usize) -> EnvironmentMap {
    let pixels = (0..width * height).map(|i| [(i % width) as f32, (i / width) as f32, 1.0]).collect();
    EnvironmentMap::from_pixels(width, height, pixels).unwrap()
}

fn dome(map: EnvironmentMap, render_from_light: DAffine3) -> Light {
    let kind = LightKind::Dome { texture: Some(Arc::new(map)) };
    Light::new(&LightParams { render_from_light, ..LightParams::new(kind) }).unwrap().0
}

fn towards(l: &Light, x: f32, y: f32, z: f32) -> Rgb {
    l.from_infinity(Vector3::new(x, y, z).normalized()).unwrap().radiance
}

#[test]
fn the_image_is_placed_as_openexr_says() {
    let l = dome(numbered(64, 32), DAffine3::IDENTITY);
    let column = |x, z| towards(&l, x, 0.0, z).0.x;
    // Longitude 0 is +Z, in the middle; +X has longitude π/2, a quarter from the left, where it is +π.
    assert!((column(0.0, 1.0) - 31.5).abs() < 0.01);
    assert!((column(1.0, 0.0) - 15.5).abs() < 0.01);
    assert!((column(-1.0, 0.0) - 47.5).abs() < 0.01);
    // The edges meet at −Z: half a pixel to either side lie the centres of the last and the first column.
    let (sin, cos) = (PI / 64.0).sin_cos();
    assert!((column(-sin, -cos) - 63.0).abs() < 0.01 && column(sin, -cos) < 0.01);
    assert!(towards(&l, 0.0, 1.0, 0.0).0.y < 0.01 && towards(&l, 0.0, -1.0, 0.0).0.y > 30.99);
    assert!((towards(&l, 0.0, 0.0, 1.0).0.y - 15.5).abs() < 0.01);
}

#[test]
fn the_transform_turns_the_image() {
    // A quarter turn about X puts the image's +Y pole on +Z; scale does not matter.
    let turn = DAffine3::from_mat4(DMat4::from_rotation_x(std::f64::consts::FRAC_PI_2))
        * DAffine3::from_scale(glam::DVec3::splat(7.0));
    let l = dome(numbered(64, 32), turn);
    assert!(towards(&l, 0.0, 0.0, 1.0).0.y < 0.01 && towards(&l, 0.0, 0.0, -1.0).0.y > 30.99);
    // +Z of the image went to −Y.
    assert!((towards(&l, 0.0, -1.0, 0.0).0.x - 31.5).abs() < 0.01);
    let mirrored = dome(numbered(64, 32), DAffine3::from_scale(glam::DVec3::new(-1.0, 1.0, 1.0)));
    assert!((towards(&mirrored, -1.0, 0.0, 0.0).0.x - 15.5).abs() < 0.01);
}

#[test]
fn sampling_finds_the_irradiance_of_a_small_sun() {
    // Black but for one pixel: its bilinear tent reaches into neighbours that are black.
    let (width, height) = (64, 32);
    let mut pixels = vec![[0.0; 3]; width * height];
    pixels[8 * width + 31] = [1000.0, 1000.0, 1000.0];
    let map = EnvironmentMap::from_pixels(width, height, pixels).unwrap();
    let l = dome(map.clone(), DAffine3::IDENTITY);
    let n = 1 << 14;
    let (mut sampled, mut mean, mut brightest) = (0.0, 0.0, 0f32);
    for i in 0..n {
        let mut s = Sampler::new(1, [0, 0], i);
        let u = s.next_2d();
        if let Some(s) = l.sample(Point3::ZERO, u) {
            assert!((s.pdf_solid_angle - l.pdf_solid_angle(Point3::ZERO, s.wi)).abs() <= 1e-3 * s.pdf_solid_angle);
            let f = s.radiance.0.x * s.wi.y().max(0.0);
            sampled += f / s.pdf_solid_angle;
            brightest = (f / s.pdf_solid_angle).max(brightest);
        }
        let w = umber_sampling::warp::uniform_sphere(u);
        mean += l.from_infinity(w).unwrap().radiance.0.x * w.y().max(0.0) * 4.0 * PI;
    }
    let (sampled, mean) = (sampled / n as f32, mean / n as f32);
    // At the outer corner of a diagonal neighbour the tent is a quarter, its mean over that pixel a 64th.
    assert!(brightest < 17.0 * sampled, "a firefly: {brightest}");
    // The reference by uniform directions is itself good to a few per cent.
    assert!((sampled / mean - 1.0).abs() < 0.06, "{sampled} {mean}");
}

#[test]
fn degenerate_maps_work() {
    let one = EnvironmentMap::from_pixels(1, 1, vec![[2.0, 3.0, 4.0]]).unwrap();
    let (w, l, pdf) = one.sample(Vec2::new(0.3, 0.8));
    assert!((w.length() - 1.0).abs() < 1e-6 && l == Rgb::new(2.0, 3.0, 4.0) && (pdf * 4.0 * PI - 1.0).abs() < 1e-5);
    assert!((one.mean_radiance().0 - glam::Vec3::new(2.0, 3.0, 4.0)).length() < 1e-5);
    let black = EnvironmentMap::from_pixels(2, 2, vec![[0.0; 3]; 4]).unwrap();
    let (_, l, pdf) = black.sample(Vec2::splat(0.5));
    assert!(l.is_black() && pdf > 0.0);
    let odd = EnvironmentMap::from_pixels(2, 1, vec![[f32::NAN, -1.0, 5.0], [f32::INFINITY, 1.0, 1.0]]).unwrap();
    for i in 0..64 {
        let (w, l, pdf) = odd.sample(Sampler::new(0, [0, 0], i).next_2d());
        assert!(l.is_finite() && l.0.min_element() >= 0.0 && pdf.is_finite() && odd.pdf_solid_angle(w).is_finite());
    }
    for y in [1.0, -1.0] {
        assert!(
            odd.radiance(Vector3::new(0.0, y, 0.0)).is_finite() && odd.pdf_solid_angle(Vector3::new(0.0, y, 0.0)) > 0.0
        );
    }
    assert!(matches!(EnvironmentMap::from_pixels(2, 2, vec![[0.0; 3]; 3]), Err(ImageError::Size { width: 2, .. })));
    assert!(EnvironmentMap::from_pixels(0, 0, vec![]).is_err());
    assert!(EnvironmentMap::from_pixels(usize::MAX, 2, vec![]).is_err());
}

fn temporary(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

#[test]
fn files_are_read_to_linear_colour() {
    let png = temporary("grey.png");
    image::RgbImage::from_pixel(3, 2, image::Rgb([188, 0, 255])).save(&png).unwrap();
    let read = LinearImage::load(&png).unwrap();
    assert_eq!((read.width, read.height, read.pixels.len()), (3, 2, 6));
    assert!((read.pixels[5][0] - 0.5029).abs() < 1e-3 && read.pixels[5][1] == 0.0 && read.pixels[5][2] == 1.0);

    let wide = temporary("wide.png");
    image::ImageBuffer::from_pixel(1, 1, image::Rgb([32768u16, 0, 65535])).save(&wide).unwrap();
    assert!((LinearImage::load(&wide).unwrap().pixels[0][0] - 0.5).abs() < 1e-4);

    let hdr = temporary("sky.hdr");
    let pixels: Vec<image::Rgb<f32>> = (0..16 * 8).map(|i| image::Rgb([i as f32, 1000.0, 0.25])).collect();
    let file = std::fs::File::create(&hdr).unwrap();
    image::codecs::hdr::HdrEncoder::new(file).encode(&pixels, 16, 8).unwrap();
    let read = LinearImage::load(&hdr).unwrap();
    assert!((read.pixels[100][0] - 100.0).abs() < 4.0 && (read.pixels[100][1] - 1000.0).abs() < 8.0);

    let path = temporary("sky.exr");
    exr::prelude::write_rgb_file(&path, 4, 2, |x, y| (x as f32, y as f32, 7.5f32)).unwrap();
    let map = EnvironmentMap::load(&path).unwrap();
    assert_eq!(map.size(), [4, 2]);
    assert_eq!(LinearImage::load(&path).unwrap().pixels[6], [2.0, 1.0, 7.5]);
}

#[test]
fn errors_name_the_file() {
    let missing = EnvironmentMap::load("no/such/sky.hdr").unwrap_err();
    assert!(matches!(missing, ImageError::Io { .. }) && missing.to_string().contains("no/such/sky.hdr"));
    for (name, bytes) in
        [("text.png", &b"not an image"[..]), ("cut.exr", &[0x76, 0x2f, 0x31, 0x01, 2][..]), ("empty.jpg", &[])]
    {
        let path = temporary(name);
        std::fs::write(&path, bytes).unwrap();
        let error = LinearImage::load(&path).unwrap_err();
        assert!(matches!(error, ImageError::Decode { .. }) && error.to_string().contains(name), "{error}");
    }
}
