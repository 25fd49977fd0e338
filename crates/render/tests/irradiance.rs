//! A white face under lights whose irradiance is known, through the whole renderer.

mod common;

use std::f64::consts::PI;

use common::*;
use glam::{DMat3, EulerRot};
use umber_math::{DAffine3, DVec3};
use umber_render::Aov;
use umber_scene::{Light, LightId, LightKind, SceneEdit};

const ALBEDO: f32 = 0.8;
/// Where the camera looks: the middle of the cube's upper face.
const POINT: DVec3 = DVec3::new(0.0, 0.0, 1.0);
const UP: DVec3 = DVec3::Z;

/// Irradiance of the face under lights, as the picture says.
fn irradiance(lights: &[Light], samples: i64) -> f64 {
    // so close that the picture shows a hundredth of a unit
    let session = session(1.01, samples, &[Aov::Color]);
    session.edit(mesh("/box", cube())).unwrap();
    bind(&session, "/box", "/m", lambert(ALBEDO, 0.0));
    for (i, light) in lights.iter().enumerate() {
        session.edit(SceneEdit::Light(LightId::new(&format!("/light{i}")), light.clone())).unwrap();
    }
    finish(&session);
    assert_messages(&session, &[]);
    let pixels = color(&session);
    let mean = pixels.iter().map(|p| f64::from(p[0])).sum::<f64>() / pixels.len() as f64;
    mean * PI / f64::from(ALBEDO)
}

fn check(lights: &[Light], want: f64, what: &str) {
    let got = irradiance(lights, 512);
    assert!((got / want - 1.0).abs() < 3e-3, "{what}: {got}, not {want}");
}

fn rect(width: f32, height: f32, world_from_light: DAffine3) -> Light {
    Light { world_from_light, ..Light::new(LightKind::Rect { width, height }) }
}

fn sphere(radius: f32, at: DVec3) -> Light {
    let kind = LightKind::Sphere { radius, treat_as_point: false };
    Light { world_from_light: DAffine3::from_translation(at), ..Light::new(kind) }
}

/// Lambert's formula: a polygon of radiance 1 above the horizon gives half the sum, over its edges, of the angle that
/// an edge is seen under times the cosine of the normal of the plane through edge and point.
fn of_polygon(corners: &[DVec3]) -> f64 {
    let to = |i: usize| (corners[i % corners.len()] - POINT).normalize();
    let edges = (0..corners.len()).map(|i| {
        let (a, b) = (to(i), to(i + 1));
        a.dot(b).clamp(-1.0, 1.0).acos() * a.cross(b).normalize().dot(UP)
    });
    (0.5 * edges.sum::<f64>()).abs()
}

fn of_rect(width: f64, height: f64, world_from_light: DAffine3) -> f64 {
    let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
    of_polygon(&corners.map(|(x, y)| world_from_light.transform_point3(DVec3::new(x * width, y * height, 0.0))))
}

fn of_sphere(radius: f64, at: DVec3) -> f64 {
    let to = at - POINT;
    PI * radius * radius / to.length_squared() * to.normalize().dot(UP)
}

/// Overhead; turned and to the side; mirrored; a parallelogram.
#[test]
fn rect_lights() {
    let at = |x, y, z| DAffine3::from_translation(DVec3::new(x, y, z));
    let turn = |x, y, z| DAffine3::from_mat3(DMat3::from_euler(EulerRot::XYZ, x, y, z));
    let shear = DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::new(0.7, 0.9, 0.2), DVec3::Z));
    for (what, placed) in [
        ("overhead", at(0.0, 0.0, 2.5)),
        ("turned", at(1.5, -0.7, 2.4) * turn(-0.4, 0.6, 0.9)),
        ("mirrored", at(-1.0, 1.2, 2.2) * turn(0.5, -0.3, 0.0) * DAffine3::from_scale(DVec3::new(-1.5, 0.6, 1.0))),
        ("parallelogram", at(0.4, 0.3, 2.0) * shear),
        ("close", at(0.3, 0.2, 1.2)),
    ] {
        check(&[rect(1.2, 0.8, placed)], of_rect(f64::from(1.2f32), f64::from(0.8f32), placed), what);
    }
}

/// To the side, near, and as a point that stands for the same power.
#[test]
fn sphere_lights() {
    for (radius, at) in [(0.5, DVec3::new(2.0, 0.5, 2.5)), (1.0, DVec3::new(0.0, 1.0, 2.6)), (0.02, DVec3::Z * 4.0)] {
        check(&[sphere(radius as f32, at)], of_sphere(f64::from(radius as f32), at), "sphere");
        let kind = LightKind::Sphere { radius: radius as f32, treat_as_point: true };
        check(&[Light { kind, ..sphere(1.0, at) }], of_sphere(f64::from(radius as f32), at), "point");
    }
}

/// Slanting light of any width, as long as all of it is above the horizon.
#[test]
fn distant_lights() {
    for angle_deg in [0.53f32, 5.0, 60.0] {
        let slant = 0.9f64;
        let world_from_light = DAffine3::from_rotation_y(slant);
        let of_disk = PI * (f64::from(angle_deg) * PI / 360.0).sin().powi(2);
        let kind = LightKind::Distant { angle_deg };
        let light = Light { world_from_light, ..Light::new(kind) };
        check(std::slice::from_ref(&light), of_disk * slant.cos(), "distant");
        let normalized = Light { normalize: true, intensity: 3.0, ..light };
        check(&[normalized], 3.0 * slant.cos(), "normalized distant");
    }
}

/// Light adds up, however different the lights are.
#[test]
fn many_lights() {
    let overhead = DAffine3::from_translation(DVec3::new(1.0, 0.0, 3.0));
    let (ball, small) = (DVec3::new(2.0, 0.5, 2.5), DVec3::new(-0.4, 0.3, 1.5));
    let lights = [
        rect(1.2, 0.8, overhead),
        sphere(0.5, ball),
        Light { intensity: 30.0, ..sphere(0.01, small) },
        Light { intensity: 0.1, normalize: true, ..Light::new(LightKind::Distant { angle_deg: 0.53 }) },
        Light { intensity: 0.05, ..Light::new(LightKind::Dome { texture: None }) },
    ];
    let rect = of_rect(f64::from(1.2f32), f64::from(0.8f32), overhead);
    let spheres = of_sphere(0.5, ball) + 30.0 * of_sphere(f64::from(0.01f32), small);
    // the large shapes hide their part of the dome, and none hides the sun
    let dome = 0.05 * (PI - rect - of_sphere(0.5, ball));
    check(&lights, rect + spheres + 0.1 + dome, "all together");
}

/// A convex body of albedo a that emits 1 - a, under a sky of radiance 1: 1 everywhere.
#[test]
fn outside_an_emitting_body() {
    let session = session(4.0, 256, &[Aov::Color]);
    session.edit(mesh("/box", cube())).unwrap();
    bind(&session, "/box", "/m", lambert(0.7, 0.3));
    session.edit(SceneEdit::Light(LightId::new("/dome"), Light::new(LightKind::Dome { texture: None }))).unwrap();
    finish(&session);
    for p in color(&session) {
        assert!((p[0] - 1.0).abs() < 0.02, "{p:?}");
    }
    let pixels = color(&session);
    let mean = pixels.iter().map(|p| f64::from(p[0])).sum::<f64>() / pixels.len() as f64;
    assert!((mean - 1.0).abs() < 1e-3, "{mean}");
}
