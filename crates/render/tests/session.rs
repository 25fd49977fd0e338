//! The session as a host drives it.

mod common;

use std::time::{Duration, Instant};

use common::*;
use umber_math::{DAffine3, DVec3, Vec3};
use umber_render::{Aov, FilmDesc};
use umber_scene::{
    InstancerId, InstancerPatch, Interpolation, Light, LightId, LightKind, MeshId, MeshPatch, Primvar, PrimvarValues,
    SceneEdit,
};

fn dome() -> SceneEdit {
    SceneEdit::Light(LightId::new("/dome"), Light::new(LightKind::Dome { texture: None }))
}

#[test]
fn the_same_picture_whatever_the_threads_and_the_stops() {
    for interactive in [0, 1] {
        let render = |threads: i64, interrupt: bool, limit: i64| {
            let session = session(4.0, 32, &[Aov::Color, Aov::PrimId]);
            session.edit(setting("umber:threads", threads)).unwrap();
            session.edit(setting("enableInteractive", interactive)).unwrap();
            session.edit(setting("umber:timeLimit", limit)).unwrap();
            session.edit(mesh("/box", cube())).unwrap();
            session.edit(dome()).unwrap();
            while interrupt && !session.is_converged() {
                session.start();
                std::thread::sleep(Duration::from_micros(300));
                session.stop();
            }
            finish(&session);
            color(&session)
        };
        let one = render(1, false, 0);
        assert_eq!(one, render(2, false, 0));
        assert_eq!(one, render(8, false, 0));
        assert_eq!(one, render(2, true, 0));
        // small passes, whoever watches
        assert_eq!(one, render(2, true, 1000));
    }
}

#[test]
fn compile_reuses_what_did_not_change() {
    let session = session(4.0, 1, &[Aov::Color]);
    for i in 0..5 {
        session.edit(mesh(&format!("/box{i}"), cube())).unwrap();
    }
    bind(&session, "/box0", "/m", lambert(0.5, 0.0));
    let built = |edit: Option<SceneEdit>| {
        if let Some(edit) = edit {
            assert!(session.edit(edit).unwrap());
            assert!(!session.is_converged());
        }
        finish(&session);
        let stats = session.stats();
        (stats.built_meshes, stats.built_top_level)
    };
    assert_eq!(built(None), (5, true));
    assert_eq!(built(Some(camera_at(5.0))), (0, false));
    let moved = Some(DAffine3::from_translation(DVec3::X));
    assert_eq!(built(Some(mesh("/box1", MeshPatch { transform: moved, ..MeshPatch::default() }))), (0, true));
    let points = cube().points.unwrap().iter().map(|p| *p * 0.5).collect();
    assert_eq!(built(Some(mesh("/box2", MeshPatch { points: Some(points), ..MeshPatch::default() }))), (1, true));
    let m = umber_scene::MaterialId::new("/m");
    assert_eq!(built(Some(SceneEdit::Material(m, lambert(0.7, 0.0)))), (0, false));
    assert_eq!(built(Some(dome())), (0, false));
    assert_eq!(built(Some(SceneEdit::RemoveMesh(MeshId::new("/box3")))), (0, true));
    assert_eq!(built(Some(setting("umber:seed", 9))), (0, false));
}

/// Corners of faces are kept only where a primvar has values for them: one that comes later finds them too.
#[test]
fn a_primvar_by_corners_may_come_later() {
    // from corner to corner of each face
    let colors = (0..24).map(|i| (i % 4) as f32 / 3.0).map(|x| Vec3::new(x, 0.5, 1.0 - x)).collect();
    let primvar = Primvar { interpolation: Interpolation::FaceVarying, values: PrimvarValues::Float3(colors) };
    let primvars: std::collections::BTreeMap<_, _> = [("displayColor".into(), Some(primvar))].into();
    let picture = |at_once: bool| {
        let session = session(4.0, 4, &[Aov::Color]);
        session.edit(dome()).unwrap();
        if at_once {
            session.edit(mesh("/box", MeshPatch { primvars: primvars.clone(), ..cube() })).unwrap();
        } else {
            session.edit(mesh("/box", cube())).unwrap();
            finish(&session);
            let patch = MeshPatch { primvars: primvars.clone(), ..MeshPatch::default() };
            session.edit(mesh("/box", patch)).unwrap();
        }
        finish(&session);
        color(&session)
    };
    let at_once = picture(true);
    assert_eq!(at_once, picture(false));
    let reds: Vec<f32> = at_once.iter().map(|p| p[0]).collect();
    let (low, high) = reds.iter().fold((f32::MAX, 0.0f32), |(l, h), r| (l.min(*r), h.max(*r)));
    assert!(high > 1.5 * low, "the colours do not show: {low} … {high}");
}

#[test]
fn unchanged_values_restart_nothing() {
    let session = session(4.0, 4, &[Aov::Color]);
    session.edit(mesh("/box", cube())).unwrap();
    finish(&session);
    let rays = session.stats().rays;
    assert!(!session.edit(mesh("/box", cube())).unwrap());
    assert!(!session.edit(camera_at(4.0)).unwrap());
    assert!(!session.edit(setting("domeLightCameraVisibility", 1)).unwrap());
    assert!(!session.set_film(FilmDesc::new(SIZE, SIZE, &[Aov::Color])));
    assert!(session.is_converged());
    session.start();
    assert!(session.is_converged() && session.stats().rays == rays);
}

#[test]
fn nothing_to_look_through_is_an_error_and_ends() {
    let session = umber_render::Session::new();
    session.set_film(FilmDesc::new(SIZE, SIZE, &[Aov::Color]));
    session.edit(mesh("/box", cube())).unwrap();
    finish(&session);
    assert_messages(&session, &["no camera"]);
    assert!(color(&session).iter().all(|p| *p == [0.0; 4]));
}

#[test]
fn bad_input_is_named_and_the_rest_is_rendered() {
    let session = session(4.0, 1, &[Aov::Color, Aov::PrimId]);
    session.edit(mesh("/good", cube())).unwrap();
    let mut points = cube().points.unwrap().to_vec();
    points[0].x = f32::NAN;
    session.edit(mesh("/nan", MeshPatch { points: Some(points.into()), ..cube() })).unwrap();
    let flat = Some(DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0)));
    session.edit(mesh("/flat", MeshPatch { transform: flat, ..cube() })).unwrap();
    let nowhere = Some(Some(InstancerId::new("/nowhere")));
    session.edit(mesh("/lost", MeshPatch { instancer: nowhere, ..cube() })).unwrap();
    let dark = Light { intensity: f32::NAN, ..Light::new(LightKind::Distant { angle_deg: 1.0 }) };
    session.edit(SceneEdit::Light(LightId::new("/dark"), dark)).unwrap();
    finish(&session);
    assert_messages(&session, &["</nan>", "</nowhere>", "singular", "</dark>"]);
    assert!(color(&session).iter().flatten().all(|v| v.is_finite()));
    assert!(ids(&session, Aov::PrimId).contains(&7));
    // the same again says nothing new
    session.edit(camera_at(4.5)).unwrap();
    finish(&session);
    assert_messages(&session, &[]);
}

#[test]
fn nested_instances_have_numbers_and_places() {
    let session = session(30.0, 1, &[Aov::InstanceId, Aov::Depth]);
    let shift = |x: f64, y: f64| DAffine3::from_translation(DVec3::new(x, y, 0.0));
    let outer = InstancerPatch {
        transforms: Some([shift(0.0, -6.0), shift(0.0, 0.0), shift(0.0, 6.0)].into()),
        ..InstancerPatch::default()
    };
    let inner = InstancerPatch {
        parent: Some(Some(InstancerId::new("/outer"))),
        parent_indices: Some([0, 2].into()),
        transforms: Some([shift(-6.0, 0.0), shift(6.0, 0.0)].into()),
        ..InstancerPatch::default()
    };
    session.edit(SceneEdit::Instancer(InstancerId::new("/outer"), outer)).unwrap();
    session.edit(SceneEdit::Instancer(InstancerId::new("/inner"), inner)).unwrap();
    for (path, x) in [("/a", 0.0), ("/b", 2.5)] {
        let patch = MeshPatch {
            instancer: Some(Some(InstancerId::new("/inner"))),
            instance_indices: Some([0, 1].into()),
            transform: Some(shift(x, 0.0) * DAffine3::from_scale(DVec3::splat(0.9))),
            ..cube()
        };
        session.edit(mesh(path, patch)).unwrap();
    }
    finish(&session);
    assert_messages(&session, &[]);
    assert_eq!(session.stats().instances, 8);
    let id = ids(&session, Aov::InstanceId);
    // 53 degrees at distance 30 show 30 units: 1.25 a pixel, row 0 the lowest
    let at = |x: f64, y: f64| id[((y + 15.0) / 1.25) as usize * SIZE + ((x + 15.0) / 1.25) as usize];
    assert_eq!([at(-6.0, -6.0), at(6.0, -6.0), at(-6.0, 6.0), at(6.0, 6.0)], [0, 1, 2, 3]);
    assert_eq!([at(-3.5, -6.0), at(8.5, 6.0)], [0, 3]);
    assert_eq!(at(0.0, 0.0), -1);
    let hidden = SceneEdit::Instancer(
        InstancerId::new("/outer"),
        InstancerPatch { visible: Some(false), ..InstancerPatch::default() },
    );
    session.edit(hidden).unwrap();
    finish(&session);
    assert!(ids(&session, Aov::InstanceId).iter().all(|id| *id == -1));
}

#[test]
fn depths_and_normals() {
    let session = session(4.0, 1, &[Aov::Depth, Aov::CameraDepth, Aov::Normal, Aov::Neye, Aov::ElementId]);
    session.edit(mesh("/box", cube())).unwrap();
    finish(&session);
    let middle = SIZE / 2 * SIZE + SIZE / 2;
    let (near, far) = (0.01f32, 1e6f32);
    assert!((floats(&session, Aov::CameraDepth)[middle] - 3.0).abs() < 1e-5);
    let depth = floats(&session, Aov::Depth);
    assert!((depth[middle] - far / (far - near) * (1.0 - near / 3.0)).abs() < 1e-6);
    assert_eq!(depth[0], 1.0);
    assert_eq!(ids(&session, Aov::ElementId)[middle], 5);
}

#[test]
fn stop_answers_while_rendering() {
    let session = session(4.0, 1 << 20, &[Aov::Color]);
    session.set_film(FilmDesc::new(512, 512, &[Aov::Color]));
    session.edit(mesh("/box", cube())).unwrap();
    session.edit(dome()).unwrap();
    session.start();
    while session.stats().rays == 0 {
        std::thread::sleep(Duration::from_millis(1));
    }
    let started = Instant::now();
    session.stop();
    let rays = session.stats().rays;
    std::thread::sleep(Duration::from_millis(20));
    assert_eq!(session.stats().rays, rays, "rendering went on after stop");
    assert!(started.elapsed() < Duration::from_secs(5), "stop never answered");
    assert!(!session.is_converged());
    session.set_paused(true);
    session.start();
    std::thread::sleep(Duration::from_millis(20));
    assert_eq!(session.stats().rays, rays, "rendering went on while paused");
    session.set_paused(false);
    while session.stats().rays == rays {
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Render space moves with the camera; a camera that cannot be looked through in between loses nothing.
#[test]
fn a_camera_that_goes_far_by_a_broken_one() {
    let session = session(4.0, 1, &[Aov::PrimId]);
    let far = Some(DAffine3::from_translation(DVec3::new(0.0, 0.0, 20_000.0)));
    session.edit(mesh("/box", MeshPatch { transform: far, ..cube() })).unwrap();
    finish(&session);
    assert!(ids(&session, Aov::PrimId).iter().all(|id| *id == -1));
    let SceneEdit::Camera(id, good) = camera_at(20_004.0) else { unreachable!() };
    let broken = umber_scene::Camera { aperture: umber_math::DVec2::ZERO, ..good.clone() };
    session.edit(SceneEdit::Camera(id.clone(), broken)).unwrap();
    finish(&session);
    assert_messages(&session, &["aperture"]);
    session.edit(SceneEdit::Camera(id, good)).unwrap();
    finish(&session);
    assert!(ids(&session, Aov::PrimId).contains(&7));
}

#[test]
fn nothing_is_waited_for_that_nobody_renders() {
    let session = session(4.0, 1, &[Aov::Color]);
    finish(&session);
    session.edit(mesh("/box", cube())).unwrap();
    assert!(!session.wait(Duration::from_secs(60)) && !session.is_converged());
    session.set_film(FilmDesc::new(0, 0, &[Aov::Color]));
    finish(&session);
    assert_messages(&session, &[]);
}

#[test]
fn instancers_in_a_circle_are_named() {
    let session = session(4.0, 1, &[Aov::Color]);
    for (id, parent) in [("/a", "/b"), ("/b", "/a")] {
        let patch = InstancerPatch {
            parent: Some(Some(InstancerId::new(parent))),
            parent_indices: Some([0].into()),
            transforms: Some([DAffine3::IDENTITY].into()),
            ..InstancerPatch::default()
        };
        session.edit(SceneEdit::Instancer(InstancerId::new(id), patch)).unwrap();
    }
    let instanced = Some(Some(InstancerId::new("/a")));
    session.edit(mesh("/m", MeshPatch { instancer: instanced, instance_indices: Some([0].into()), ..cube() })).unwrap();
    finish(&session);
    assert_messages(&session, &["</a>: its parents lead back"]);
}
