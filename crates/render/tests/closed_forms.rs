//! Scenes whose radiance is known.

mod common;

use common::*;
use umber_math::{DAffine3, DVec3, Rgb};
use umber_render::Aov;
use umber_scene::{Light, LightId, LightKind, MeshPatch, SceneEdit};

fn mean(pixels: &[[f32; 4]]) -> f32 {
    pixels.iter().map(|p| p[0]).sum::<f32>() / pixels.len() as f32
}

/// pbrt's closed form: inside a closed surface of albedo a that emits 1 - a, radiance is 1 everywhere.
#[test]
fn inside_an_emitting_box() {
    let session = session(0.0, 64, &[Aov::Color]);
    session.edit(mesh("/box", cube())).unwrap();
    bind(&session, "/box", "/m", lambert(0.5, 0.5));
    session.edit(setting("umber:maxBounces", 100)).unwrap();
    finish(&session);
    assert_messages(&session, &[]);
    let pixels = color(&session);
    assert!((mean(&pixels) - 1.0).abs() < 2e-3, "{}", mean(&pixels));
    assert!(pixels.iter().all(|p| p[3] == 1.0));
}

/// A Lambertian under a uniform dome of radiance 1 reflects its albedo (nothing else is near it):
/// also where the face goes through the origin, so that its points have no rounding error.
#[test]
fn a_face_under_a_dome() {
    for height in [1.0, 0.0, 100.0] {
        let session = session(0.9 + f64::from(height), 256, &[Aov::Color]);
        let points = cube().points.unwrap().iter().map(|p| *p + umber_math::Vec3::Z * (height - 1.0)).collect();
        session.edit(mesh("/box", MeshPatch { points: Some(points), ..cube() })).unwrap();
        bind(&session, "/box", "/m", lambert(0.6, 0.0));
        session.edit(SceneEdit::Light(LightId::new("/dome"), Light::new(LightKind::Dome { texture: None }))).unwrap();
        finish(&session);
        let pixels = color(&session);
        assert!((mean(&pixels) - 0.6).abs() < 2e-3, "{} at {height}", mean(&pixels));
    }
}

/// A distant light of 0.53 degrees and radiance 15000 straight on: E = L π sin²(angle / 2).
#[test]
fn a_face_under_the_sun() {
    for shadow_enable in [true, false] {
        let session = session(1.9, 64, &[Aov::Color]);
        session.edit(mesh("/box", cube())).unwrap();
        bind(&session, "/box", "/m", lambert(0.5, 0.0));
        let sun = Light { intensity: 15000.0, shadow_enable, ..Light::new(LightKind::Distant { angle_deg: 0.53 }) };
        session.edit(SceneEdit::Light(LightId::new("/sun"), sun)).unwrap();
        finish(&session);
        let irradiance = 15000.0 * std::f32::consts::PI * (0.265f32.to_radians()).sin().powi(2);
        let want = 0.5 * irradiance / std::f32::consts::PI;
        let got = mean(&color(&session));
        assert!((got / want - 1.0).abs() < 1e-3, "{got}, not {want}");
    }
}

/// A sphere light of radius r at distance d over a face: E = L π (r / d)² at the point below it.
#[test]
fn a_face_under_a_sphere_light() {
    let session = session(1.02, 1024, &[Aov::Color]);
    session.edit(mesh("/box", cube())).unwrap();
    bind(&session, "/box", "/m", lambert(0.5, 0.0));
    let light = Light {
        color: Rgb::new(2.0, 1.0, 1.0),
        world_from_light: DAffine3::from_translation(DVec3::new(0.0, 0.0, 5.0)),
        ..Light::new(LightKind::Sphere { radius: 1.0, treat_as_point: false })
    };
    session.edit(SceneEdit::Light(LightId::new("/l"), light)).unwrap();
    finish(&session);
    let want = 0.5 * 2.0 / 16.0;
    let got = mean(&color(&session));
    assert!((got / want - 1.0).abs() < 3e-3, "{got}, not {want}");
}

/// Half-present geometry before a white dome: coverage and colour are half each.
#[test]
fn opacity_is_presence() {
    let session = session(3.0, 256, &[Aov::Color]);
    let opacity = umber_scene::Primvar {
        interpolation: umber_scene::Interpolation::Constant,
        values: umber_scene::PrimvarValues::Float([0.25].into()),
    };
    let primvars = [("displayOpacity".into(), Some(opacity))].into();
    // a face of 2 x 2 fills the middle of the picture; the box's far side covers it a second time
    session.edit(mesh("/box", MeshPatch { primvars, ..cube() })).unwrap();
    finish(&session);
    let pixels = color(&session);
    let middle: Vec<f32> = (8..16).flat_map(|y| (8..16).map(move |x| y * SIZE + x)).map(|i| pixels[i][3]).collect();
    let coverage = middle.iter().sum::<f32>() / middle.len() as f32;
    let want = 1.0 - 0.75 * 0.75;
    assert!((coverage - want).abs() < 0.01, "{coverage}, not {want}");
}

/// An opacity below zero, or none at all, is zero: the face under the box is as bright as without it.
#[test]
fn opacity_out_of_range_amplifies_nothing() {
    for value in [-3.0, f32::NAN] {
        let session = session(3.0, 64, &[Aov::Color]);
        let opacity = umber_scene::Primvar {
            interpolation: umber_scene::Interpolation::Constant,
            values: umber_scene::PrimvarValues::Float([value].into()),
        };
        let primvars = [("displayOpacity".into(), Some(opacity))].into();
        session.edit(mesh("/veil", MeshPatch { primvars, ..cube() })).unwrap();
        session.edit(SceneEdit::Light(LightId::new("/dome"), Light::new(LightKind::Dome { texture: None }))).unwrap();
        finish(&session);
        assert!(color(&session).iter().all(|p| *p == [1.0; 4]), "{value}: {:?}", color(&session)[300]);
    }
}

/// A rect light fills the picture: its front is seen with its radiance, its back not at all.
#[test]
fn a_rect_light_has_one_side() {
    for (turn, want) in [(0.0, [2.0, 2.0, 2.0, 1.0]), (std::f64::consts::PI, [0.0; 4])] {
        let session = session(-1.0, 4, &[Aov::Color]);
        // it shines along -Z, the camera looks along -Z: turned around it faces the camera
        let light = Light {
            intensity: 2.0,
            world_from_light: DAffine3::from_translation(DVec3::new(0.0, 0.0, -3.0))
                * DAffine3::from_rotation_y(std::f64::consts::PI - turn),
            ..Light::new(LightKind::Rect { width: 10.0, height: 10.0 })
        };
        session.edit(SceneEdit::Light(LightId::new("/l"), light)).unwrap();
        finish(&session);
        assert!(color(&session).iter().all(|p| *p == want), "{:?}", color(&session)[0]);
    }
}

/// A square of two units over a floor, as a rect light and as a mesh that emits: the same light falls on the floor,
/// near the square and below it.
#[test]
fn an_emitting_square_is_a_rect_light() {
    let square = |z: f32, cells: i32| {
        let points: Vec<umber_math::Vec3> = (0..=cells)
            .flat_map(|j| (0..=cells).map(move |i| (i, j)))
            .map(|(i, j)| umber_math::Vec3::new(i as f32, j as f32, 0.0) * (2.0 / cells as f32))
            .map(|p| p + umber_math::Vec3::new(-1.0, -1.0, z))
            .collect();
        let at = |i, j| j * (cells + 1) + i;
        let face = |i, j| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        let faces: Vec<i32> = (0..cells).flat_map(|j| (0..cells).flat_map(move |i| face(i, j))).collect();
        let topology = umber_scene::Topology {
            scheme: umber_scene::SubdivisionScheme::None,
            face_vertex_counts: vec![4; (cells * cells) as usize].into(),
            face_vertex_indices: faces.into(),
            ..umber_scene::Topology::default()
        };
        MeshPatch { topology: Some(topology.into()), points: Some(points.into()), ..cube() }
    };
    for (height, cells) in [(0.6f32, 1), (0.6, 6), (0.02, 2)] {
        let render = |as_mesh: bool| {
            // The camera looks at the floor from below the square.
            let session = session(f64::from(height) * 0.9, 256, &[Aov::Color]);
            session.edit(mesh("/floor", square(0.0, 1))).unwrap();
            bind(&session, "/floor", "/grey", lambert(0.5, 0.0));
            if as_mesh {
                session.edit(mesh("/square", square(height, cells))).unwrap();
                bind(&session, "/square", "/glow", lambert(0.0, 3.0));
            } else {
                let light = Light {
                    intensity: 3.0,
                    world_from_light: DAffine3::from_translation(DVec3::new(0.0, 0.0, f64::from(height))),
                    ..Light::new(LightKind::Rect { width: 2.0, height: 2.0 })
                };
                session.edit(SceneEdit::Light(LightId::new("/l"), light)).unwrap();
            }
            finish(&session);
            assert_messages(&session, &[]);
            mean(&color(&session))
        };
        let (got, want) = (render(true), render(false));
        assert!((got / want - 1.0).abs() < 3e-3, "{cells} cells at {height}: {got}, not {want}");
    }
}
