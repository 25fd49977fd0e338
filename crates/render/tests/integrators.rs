//! The integrators beside the path tracer: the rasteriser sees what rays meet, direct light ends after one scattering,
//! the mirror reflects.

mod common;

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use common::*;
use umber_math::{DAffine3, DVec2, DVec3, Rgb, Vec3};
use umber_render::{Aov, BufferFormat, FilmDesc, Session};
use umber_scene::{
    Camera, CameraId, CulledFaces, InstancerId, InstancerPatch, Interpolation, Light, LightId, LightKind, MeshPatch,
    Primvar, PrimvarValues, Projection, SceneEdit,
};
use umber_settings::Value;

const WIDTH: usize = 150;
const HEIGHT: usize = 90;
const IDS: [Aov; 3] = [Aov::PrimId, Aov::InstanceId, Aov::ElementId];

fn word(key: &str, value: &str) -> SceneEdit {
    SceneEdit::Setting(key.into(), Value::Text(value.into()))
}

fn camera(projection: Projection, z: f64) -> SceneEdit {
    let turned = DAffine3::from_rotation_y(0.3) * DAffine3::from_rotation_x(-0.25);
    let camera = Camera {
        projection,
        world_from_camera: turned * DAffine3::from_translation(DVec3::new(0.0, 0.0, z)),
        aperture: if projection == Projection::Perspective { DVec2::ONE } else { DVec2::splat(9.0) },
        focal_length: 1.0,
        clipping_range: [0.7, 40.0],
        ..Camera::default()
    };
    SceneEdit::Camera(CameraId::new("/camera"), camera)
}

/// Three cubes through one another, on a floor that reaches behind the camera.
fn scene(session: &Session) {
    let floor = MeshPatch {
        transform: Some(
            DAffine3::from_translation(DVec3::new(0.0, -61.0, 0.0)) * DAffine3::from_scale(DVec3::splat(60.0)),
        ),
        prim_id: Some(1),
        ..cube()
    };
    session.edit(mesh("/floor", floor)).unwrap();
    for i in 0..3 {
        let turned = DAffine3::from_rotation_z(0.4 + f64::from(i)) * DAffine3::from_rotation_x(f64::from(i));
        let place = DAffine3::from_translation(DVec3::new(f64::from(i) - 1.0, 0.2, -0.3 * f64::from(i)));
        let patch = MeshPatch { transform: Some(place * turned), prim_id: Some(10 + i), ..cube() };
        session.edit(mesh(&format!("/box{i}"), patch)).unwrap();
    }
}

struct Picture {
    ids: [Vec<i32>; 3],
    depth: Vec<f32>,
    camera_depth: Vec<f32>,
    normal: Vec<f32>,
    neye: Vec<f32>,
}

fn picture(integrator: &str, view: SceneEdit, make: &dyn Fn(&Session)) -> Picture {
    let session = session(1.0, 1, &[]);
    let aovs = [&IDS[..], &[Aov::Color, Aov::Depth, Aov::CameraDepth, Aov::Normal, Aov::Neye]].concat();
    session.set_film(FilmDesc {
        display_window: Some([0.0, 0.0, 200.0, 120.0]),
        data_window_min: [31, 17],
        ..FilmDesc::new(WIDTH, HEIGHT, &aovs)
    });
    session.edit(view).unwrap();
    session.edit(word("umber:integrator", integrator)).unwrap();
    make(&session);
    finish(&session);
    let floats = |aov: Aov, components: usize, format| {
        let mut out = vec![0u8; WIDTH * HEIGHT * 4 * components];
        assert!(session.resolve(aov, format, &mut out));
        bytemuck::cast_slice::<u8, f32>(&out).to_vec()
    };
    let ids = IDS.map(|aov| ids_of(&session, aov, WIDTH * HEIGHT));
    let (one, three) = (BufferFormat::Float32, BufferFormat::Float32Vec3);
    Picture {
        ids,
        depth: floats(Aov::Depth, 1, one),
        camera_depth: floats(Aov::CameraDepth, 1, one),
        normal: floats(Aov::Normal, 3, three),
        neye: floats(Aov::Neye, 3, three),
    }
}

/// Both integrators see the same through pixels' middles, but for `allowed` pixels next to edges.
fn assert_same_first_hits(view: &SceneEdit, allowed: usize, make: &dyn Fn(&Session)) {
    let [path, raster] = ["path", "raster"].map(|integrator| picture(integrator, view.clone(), make));
    let same = |i: usize| (0..3).all(|k| path.ids[k][i] == raster.ids[k][i]);
    let differing = (0..WIDTH * HEIGHT).filter(|i| !same(*i)).count();
    let seen = path.ids[0].iter().filter(|id| **id >= 0).count();
    assert!(seen > WIDTH * HEIGHT / 10, "only {seen} pixels show anything");
    assert!(differing <= allowed, "{differing} of {seen} pixels differ");
    for i in (0..WIDTH * HEIGHT).filter(|i| same(*i)) {
        let close = |a: f32, b: f32| (a - b).abs() <= 2e-4 * a.abs().max(1.0);
        assert!(close(path.depth[i], raster.depth[i]), "{i}: {} {}", path.depth[i], raster.depth[i]);
        assert!(close(path.camera_depth[i], raster.camera_depth[i]), "{i}");
        for k in 3 * i..3 * i + 3 {
            assert!(close(path.normal[k], raster.normal[k]) && close(path.neye[k], raster.neye[k]), "{i}");
        }
    }
}

#[test]
fn the_rasteriser_sees_what_rays_meet() {
    for projection in [Projection::Perspective, Projection::Orthographic] {
        // from outside, and from where the near plane cuts a cube open
        for z in [7.0, 2.2] {
            assert_same_first_hits(&camera(projection, z), 2, &scene);
        }
    }
}

#[test]
fn the_rasteriser_sees_nested_instances() {
    let shift = |x: f64, y: f64| DAffine3::from_translation(DVec3::new(x, y, 0.0));
    let mirror = DAffine3::from_scale(DVec3::new(-0.5, 0.8, 0.6));
    assert_same_first_hits(&camera(Projection::Perspective, 9.0), 2, &|session| {
        let outer = InstancerPatch {
            transforms: Some([shift(0.0, -2.0), shift(0.0, 0.0), shift(0.0, 2.0) * mirror].into()),
            ..InstancerPatch::default()
        };
        let inner = InstancerPatch {
            parent: Some(Some(InstancerId::new("/outer"))),
            parent_indices: Some([0, 2].into()),
            // one cannot be shown: it is flat
            transforms: Some(
                [shift(-2.0, 0.0), DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0)), shift(2.0, 0.0)].into(),
            ),
            ..InstancerPatch::default()
        };
        session.edit(SceneEdit::Instancer(InstancerId::new("/outer"), outer)).unwrap();
        session.edit(SceneEdit::Instancer(InstancerId::new("/inner"), inner)).unwrap();
        let turned = DAffine3::from_rotation_y(0.5) * DAffine3::from_rotation_x(0.3);
        let patch = MeshPatch {
            instancer: Some(Some(InstancerId::new("/inner"))),
            instance_indices: Some([0, 1, 2].into()),
            transform: Some(turned),
            culled_faces: Some(CulledFaces::Front),
            ..cube()
        };
        session.edit(mesh("/a", patch)).unwrap();
    });
}

#[test]
fn the_rasteriser_looks_through_what_rays_pass() {
    for culled in [CulledFaces::Back, CulledFaces::Front] {
        for z in [7.0, 2.2] {
            assert_same_first_hits(&camera(Projection::Perspective, z), 2, &|session| {
                scene(session);
                let patch = MeshPatch { culled_faces: Some(culled), ..MeshPatch::default() };
                session.edit(mesh("/box1", patch)).unwrap();
                // opacity that goes over faces from less to more than a half
                let values = (0..8).map(|i| 0.11 + 0.1 * (3 * i % 8) as f32).collect();
                let primvar = Primvar { interpolation: Interpolation::Vertex, values: PrimvarValues::Float(values) };
                let primvars: BTreeMap<_, _> = [("displayOpacity".into(), Some(primvar))].into();
                session.edit(mesh("/box2", MeshPatch { primvars, ..MeshPatch::default() })).unwrap();
            });
        }
    }
}

fn raster(threads: i64, shown: &str, stops: bool, [width, height]: [usize; 2]) -> Vec<[f32; 4]> {
    let session = session(4.0, 64, &[]);
    session.set_film(FilmDesc::new(width, height, &[Aov::Color, Aov::PrimId]));
    session.edit(setting("umber:threads", threads)).unwrap();
    session.edit(word("umber:integrator", "raster")).unwrap();
    session.edit(word("umber:rasterColor", shown)).unwrap();
    session.edit(SceneEdit::Setting("convergedVariance".into(), Value::Float(0.001))).unwrap();
    scene(&session);
    // coincident faces: which is seen must not depend on who draws first
    for i in 0..40 {
        session.edit(mesh(&format!("/again{i}"), MeshPatch { prim_id: Some(100 + i), ..cube() })).unwrap();
    }
    if stops {
        while !session.is_converged() {
            session.start();
            std::thread::sleep(Duration::from_micros(50));
            session.stop();
        }
    } else {
        finish(&session);
    }
    assert_eq!(session.stats().samples_per_pixel, 1);
    assert_eq!(session.stats().rays, 0);
    color_of(&session, width * height)
}

#[test]
fn raster_pictures_do_not_depend_on_threads_and_stops() {
    for shown in ["shaded", "random", "primId"] {
        // what one thread draws one after the other is drawn by several that share it
        let several = [WIDTH, HEIGHT];
        let one = raster(1, shown, false, several);
        assert!(one.iter().any(|c| c[3] == 1.0 && c[0] > 0.0));
        assert_eq!(one, raster(2, shown, false, several));
        assert_eq!(one, raster(8, shown, false, several));
        // few enough pixels to be done between two stops
        let small = [SIZE; 2];
        assert_eq!(raster(2, shown, false, small), raster(2, shown, true, small));
    }
}

/// A square that faces the camera is its colour; one colour a prim, or a polygon.
#[test]
fn raster_colors() {
    // of one square, and of several
    for size in [SIZE, 150] {
        let rendered = |shown: &str| {
            let session = session(4.0, 1, &[]);
            session.set_film(FilmDesc::new(size, size, &[Aov::Color, Aov::ElementId, Aov::PrimId]));
            session.edit(word("umber:integrator", "raster")).unwrap();
            session.edit(word("umber:rasterColor", shown)).unwrap();
            let turned = Some(DAffine3::from_rotation_y(0.6) * DAffine3::from_rotation_x(0.5));
            session.edit(mesh("/box", MeshPatch { transform: turned, ..cube() })).unwrap();
            bind(&session, "/box", "/m", lambert(0.6, 0.0));
            finish(&session);
            let (colors, elements) = (color_of(&session, size * size), ids_of(&session, Aov::ElementId, size * size));
            let seen = colors.into_iter().zip(elements).filter(|(color, _)| color[3] > 0.0);
            seen.map(|(color, element)| (color.map(f32::to_bits), element)).collect::<BTreeSet<_>>()
        };
        let colors = |seen: &BTreeSet<([u32; 4], i32)>| seen.iter().map(|(color, _)| *color).collect::<BTreeSet<_>>();
        assert_eq!(colors(&rendered("primId")).len(), 1);
        let seen = rendered("random");
        assert_eq!(seen.len(), 3, "three sides of a cube are seen, each in one colour: {seen:?}");
        assert_eq!(colors(&seen).len(), 3);
    }
    // face on: its colour times the cosine of the angle of view, and what it emits
    let session = session(4.0, 1, &[Aov::Color]);
    session.edit(word("umber:integrator", "raster")).unwrap();
    session.edit(mesh("/box", cube())).unwrap();
    bind(&session, "/box", "/m", lambert(0.6, 0.25));
    finish(&session);
    let step = 1.0 / SIZE as f32;
    for (i, color) in color(&session).iter().enumerate().filter(|(_, c)| c[3] > 0.0) {
        let [x, y] = [i % SIZE, i / SIZE].map(|v| (v as f32 + 0.5) * step - 0.5);
        let cos = 1.0 / (1.0 + x * x + y * y).sqrt();
        assert!((color[0] - (0.6 * cos + 0.25)).abs() < 1e-5, "{i}: {color:?}");
    }
}

/// Direct light is a path's light with at most one scattering, sample by sample.
#[test]
fn direct_light_is_that_of_paths_of_one_bounce() {
    let light = |session: &Session| {
        scene(session);
        let dome = Light { color: Rgb::new(0.3, 0.6, 1.0), ..Light::new(LightKind::Dome { texture: None }) };
        session.edit(SceneEdit::Light(LightId::new("/dome"), dome)).unwrap();
    };
    let render = |integrator: &str, bounces: i64| {
        let session = session(6.0, 8, &[Aov::Color]);
        session.edit(word("umber:integrator", integrator)).unwrap();
        session.edit(setting("umber:maxBounces", bounces)).unwrap();
        light(&session);
        finish(&session);
        color(&session)
    };
    assert_eq!(render("direct", 8), render("path", 1));
    assert_eq!(render("direct", 0), render("path", 0));
    assert_ne!(render("direct", 8), render("path", 8));
}

/// A square seen face on reflects the view ray to the viewer: towards (1, 1, 1) by a known cosine.
#[test]
fn a_mirror_reflects_towards_the_light() {
    let session = session(4.0, 1, &[Aov::Color]);
    session.edit(word("umber:integrator", "mirror")).unwrap();
    session.edit(mesh("/box", cube())).unwrap();
    finish(&session);
    let step = 1.0 / SIZE as f32;
    let mut seen = 0;
    for (i, color) in color(&session).iter().enumerate() {
        let [x, y] = [i % SIZE, i / SIZE].map(|v| (v as f32 + 0.5) * step - 0.5);
        if x.abs().max(y.abs()) * 3.0 >= 1.0 {
            assert_eq!(*color, [0.0; 4]);
            continue;
        }
        let factor = Vec3::new(x, y, 1.0).normalize().dot(Vec3::ONE / 3f32.sqrt());
        let value = if factor > 0.0 { factor } else { 50.0 / 255.0 };
        assert!(color[3] == 1.0 && (0..3).all(|k| (color[k] - value).abs() < 1e-5), "{i}: {color:?}, not {value}");
        seen += 1;
    }
    assert_eq!(seen, (2 * SIZE / 3) * (2 * SIZE / 3));
}
