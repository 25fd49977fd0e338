//! Textures of rect lights.

use std::sync::Arc;

use glam::Vec2;
use umber_math::{DVec3, Point3, Ray, Rgb};
use umber_sampling::Sampler;
use umber_shading::{LightKind, LightParams, LightTexture};

use crate::common::{UP, at, close, irradiance, light, picture, place, quadrature, skewed, textured};

#[test]
fn a_texture_stands_upright_from_the_front() {
    let [red, green, blue, white] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0; 3]];
    let texture = Arc::new(LightTexture::from_pixels(2, 2, vec![red, green, blue, white]).unwrap());
    let l = light(&textured(2.0, 4.0, &texture));
    let seen = |x: f32, y: f32| l.intersect(&Ray::new([x, y, -3.0].into(), [0.0, 0.0, 1.0].into())).unwrap();
    // The first pixel at +X +Y, the last at −X −Y; half a pixel around their corners the colour is theirs alone.
    for (x, y, color) in [(0.9, 1.9, red), (-0.9, 1.9, green), (0.9, -1.9, blue), (-0.9, -1.9, white)] {
        assert_eq!(seen(x, y).radiance, Rgb::from(color));
    }
    let middle = seen(0.0, 0.0).radiance.0;
    assert!((middle - glam::Vec3::new(0.5, 0.5, 0.5)).length() < 1e-6);
    let behind = l.intersect(&Ray::new([0.9, 1.9, 3.0].into(), [0.0, 0.0, -1.0].into())).unwrap();
    assert!(behind.radiance.is_black() && !behind.is_front);
    for i in 0..256 {
        let p = Point3::new(0.4, -0.3, -1.0);
        let s = l.sample(p, Sampler::new(5, [1, 1], i).next_2d()).unwrap();
        let hit = l.intersect(&Ray::new(p, s.wi)).unwrap();
        assert!((hit.radiance.0 - s.radiance.0).length() < 1e-3 && hit.is_front);
    }
}

#[test]
fn irradiance_of_a_textured_rectangle_is_that_of_quadrature() {
    let texture = picture();
    let on = |u: f64, v: f64| DVec3::new(1.0 - 2.0 * u, 0.75 - 1.5 * v, 0.0);
    // Bilinear between pixel centres, by hand.
    let pixel = |c: i32, r: i32| match (c.clamp(0, 7), r.clamp(0, 3)) {
        (2, 1) => 30.0,
        (7, 3) => 0.0,
        (c, r) => 0.1 + f64::from((r * 8 + c) % 5) * 0.1,
    };
    let red = |u: f64, v: f64| {
        let (x, y) = (u * 8.0 - 0.5, v * 4.0 - 0.5);
        let (c, r) = (x.floor() as i32, y.floor() as i32);
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let row = |r| pixel(c, r) * (1.0 - fx) + pixel(c + 1, r) * fx;
        row(r) * (1.0 - fy) + row(r + 1) * fy
    };
    for (transform, samples) in [(at(0.2, 0.1, 0.5), 1 << 14), (at(3.0, 1.0, 40.0) * skewed(), 1 << 12)] {
        let p = place(textured(2.0, 1.5, &texture), transform);
        let want = quadrature(&p, on, |_, _| DVec3::NEG_Z, red, (DVec3::ZERO, DVec3::Z));
        let (sampled, cast) = irradiance(&light(&p), Point3::ZERO, UP, samples);
        assert!(close(sampled, want, 5e-3), "{sampled}, not {want}");
        assert!(want < 0.1 || close(cast, want, 5e-2), "{cast}, not {want}");
    }
}

#[test]
fn degenerate_textures_work() {
    let p = Point3::new(0.1, 0.2, -1.0);
    let plain = light(&LightParams::new(LightKind::Rect { width: 2.0, height: 1.0 }));
    let of = |pixels: Vec<[f32; 3]>| Arc::new(LightTexture::from_pixels(1, 1, pixels).unwrap());
    let one = light(&textured(2.0, 1.0, &of(vec![[0.5; 3]])));
    let [want, got] = [&plain, &one].map(|l| irradiance(l, p, UP, 1 << 13).0);
    assert!(close(got, 0.5 * want, 2e-3), "{got} {want}");
    assert!(close(f64::from(one.power_estimate(1.0)), 0.5 * f64::from(plain.power_estimate(1.0)), 1e-6));
    for odd in [[0.0; 3], [f32::NAN, -1.0, f32::INFINITY]] {
        let l = light(&textured(2.0, 1.0, &of(vec![odd])));
        let s = l.sample(p, Vec2::new(0.2, 0.7)).unwrap();
        assert!(s.radiance.is_finite() && s.radiance.0.min_element() >= 0.0 && s.pdf_solid_angle > 0.0);
        let hit = l.intersect(&Ray::new(p, s.wi)).unwrap();
        assert!(hit.is_front && hit.radiance.is_finite());
    }
    assert!(LightTexture::from_pixels(2, 2, vec![[0.0; 3]; 3]).is_err());
    assert!(LightTexture::load("no/such/picture.png").unwrap_err().to_string().contains("no/such/picture.png"));
}
