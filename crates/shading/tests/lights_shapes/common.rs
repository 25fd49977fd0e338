//! What the tests of shapes share.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::DMat3;
use umber_math::{DAffine3, DVec3, Normal3, Point3, Ray};
use umber_sampling::Sampler;
use umber_shading::{Light, LightKind, LightParams, LightTexture};

pub fn disk(radius: f32) -> LightParams {
    LightParams::new(LightKind::Disk { radius })
}
pub fn cylinder(length: f32, radius: f32) -> LightParams {
    LightParams::new(LightKind::Cylinder { length, radius, treat_as_line: false })
}
pub fn line(length: f32, radius: f32) -> LightParams {
    LightParams::new(LightKind::Cylinder { length, radius, treat_as_line: true })
}
pub fn textured(width: f32, height: f32, texture: &Arc<LightTexture>) -> LightParams {
    LightParams { texture: Some(texture.clone()), ..LightParams::new(LightKind::Rect { width, height }) }
}
pub fn place(p: LightParams, render_from_light: DAffine3) -> LightParams {
    LightParams { render_from_light, ..p }
}
pub fn at(x: f64, y: f64, z: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, y, z))
}
pub fn skewed() -> DAffine3 {
    let turned = DAffine3::from_rotation_x(0.7) * DAffine3::from_rotation_z(1.1);
    let shear = DMat3::from_cols(DVec3::new(1.5, 0.2, 0.0), DVec3::new(0.6, 0.7, 0.1), DVec3::new(-0.2, 0.3, 1.2));
    turned * DAffine3::from_mat3(shear)
}
pub fn light(p: &LightParams) -> Light {
    let (light, problems) = Light::new(p).unwrap();
    assert_eq!(problems, []);
    light
}
pub fn close(got: f64, want: f64, tolerance: f64) -> bool {
    (got - want).abs() <= tolerance * want.abs()
}
pub fn picture() -> Arc<LightTexture> {
    let mut pixels: Vec<[f32; 3]> = (0..8 * 4).map(|i| [0.1 + (i % 5) as f32 * 0.1, 0.2, 0.3]).collect();
    pixels[8 + 2] = [30.0, 20.0, 10.0];
    pixels[31] = [0.0; 3];
    Arc::new(LightTexture::from_pixels(8, 4, pixels).unwrap())
}

/// Irradiance (red) by light sampling, and by casting uniform rays: two independent estimates.
pub fn irradiance(l: &Light, p: Point3, n: Normal3, samples: u32) -> (f64, f64) {
    let (mut sampled, mut cast) = (0.0, 0.0);
    for i in 0..samples {
        let mut s = Sampler::new(3, [8, 1], i);
        if let Some(s) = l.sample(p, s.next_2d()) {
            sampled += f64::from(s.radiance.0.x * s.wi.dot_normal(n).max(0.0) / s.pdf_solid_angle);
        }
        let w = umber_sampling::warp::uniform_sphere(s.next_2d());
        let hit = l.intersect(&Ray::new(p, w)).map_or(0.0, |hit| f64::from(hit.radiance.0.x));
        cast += hit * f64::from(w.dot_normal(n).max(0.0)) * 4.0 * PI;
    }
    (sampled / f64::from(samples), cast / f64::from(samples))
}

/// Irradiance by the midpoint rule over a convex surface (u, v in [0, 1)): `point` is in light space, `outward` tells
/// the side that emits, `radiance` what.
pub fn quadrature(
    p: &LightParams,
    point: impl Fn(f64, f64) -> DVec3,
    outward: impl Fn(f64, f64) -> DVec3,
    radiance: impl Fn(f64, f64) -> f64,
    seen_from: (DVec3, DVec3),
) -> f64 {
    const N: u32 = 400;
    let (step, m) = (1.0 / f64::from(N), p.render_from_light);
    let middle = |i: u32| (f64::from(i) + 0.5) * step;
    let mut sum = 0.0;
    for (u, v) in (0..N * N).map(|i| (middle(i % N), middle(i / N))) {
        let e = 0.5 * step;
        let at = |u, v| m.transform_point3(point(u, v));
        let area = (at(u + e, v) - at(u - e, v)).cross(at(u, v + e) - at(u, v - e));
        let out = m.transform_vector3(outward(u, v));
        let area = if area.dot(out) < 0.0 { -area } else { area };
        let to_light = at(u, v) - seen_from.0;
        let d2 = to_light.length_squared();
        let cosines = to_light.dot(seen_from.1).max(0.0) * (-to_light.dot(area)).max(0.0) / d2;
        sum += radiance(u, v) * cosines / d2;
    }
    sum
}

pub const UP: Normal3 = Normal3::new(0.0, 0.0, 1.0);
