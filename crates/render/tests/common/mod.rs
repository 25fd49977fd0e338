//! Small scenes for the tests of the session.
#![allow(dead_code)] // each test binary uses its own part

use std::sync::Arc;
use std::time::Duration;

use umber_math::{DAffine3, DVec3, Rgb, Vec3};
use umber_render::{Aov, BufferFormat, FilmDesc, Session};
use umber_scene::{
    Camera, CameraId, Light, LightId, LightKind, Material, MaterialId, MeshId, MeshPatch, PreviewSurface, SceneEdit,
    SubdivisionScheme, Topology,
};
use umber_settings::Value;

pub const SIZE: usize = 24;

/// A cube of half edge 1 around the origin.
pub fn cube() -> MeshPatch {
    let points: Vec<Vec3> =
        (0..8).map(|i| Vec3::new((i >> 2 & 1) as f32, (i >> 1 & 1) as f32, (i & 1) as f32) * 2.0 - Vec3::ONE).collect();
    let topology = Topology {
        scheme: SubdivisionScheme::None,
        face_vertex_counts: [4; 6].into(),
        face_vertex_indices: [0, 1, 3, 2, 4, 6, 7, 5, 0, 4, 5, 1, 2, 3, 7, 6, 0, 2, 6, 4, 1, 5, 7, 3].into(),
        ..Topology::default()
    };
    MeshPatch {
        topology: Some(Arc::new(topology)),
        points: Some(points.into()),
        transform: Some(DAffine3::IDENTITY),
        visible: Some(true),
        prim_id: Some(7),
        ..MeshPatch::default()
    }
}

pub fn mesh(path: &str, patch: MeshPatch) -> SceneEdit {
    SceneEdit::Mesh(MeshId::new(path), Box::new(patch))
}

pub fn setting(key: &str, value: i64) -> SceneEdit {
    SceneEdit::Setting(key.into(), Value::Int(value))
}

pub fn number(key: &str, value: f64) -> SceneEdit {
    SceneEdit::Setting(key.into(), Value::Float(value))
}

/// A camera at `z` that looks along -Z, 53 degrees wide.
pub fn camera_at(z: f64) -> SceneEdit {
    let camera = Camera {
        world_from_camera: DAffine3::from_translation(DVec3::new(0.0, 0.0, z)),
        aperture: umber_math::DVec2::ONE,
        focal_length: 1.0,
        clipping_range: [0.01, 1e6],
        ..Camera::default()
    };
    SceneEdit::Camera(CameraId::new("/camera"), camera)
}

/// A session that looks from `z` with `samples` a pixel.
pub fn session(z: f64, samples: i64, aovs: &[Aov]) -> Session {
    let session = Session::new();
    session.set_film(FilmDesc::new(SIZE, SIZE, aovs));
    for edit in [
        camera_at(z),
        SceneEdit::RenderCamera(CameraId::new("/camera")),
        setting("convergedSamplesPerPixel", samples),
        setting("umber:threads", 2),
    ] {
        session.edit(edit).unwrap();
    }
    session
}

pub fn lambert(albedo: f32, emission: f32) -> Material {
    Material::Preview(PreviewSurface {
        diffuse_color: Rgb::splat(albedo),
        emissive_color: Rgb::splat(emission),
        use_specular_workflow: true,
        specular_color: Rgb::BLACK,
        ..PreviewSurface::default()
    })
}

pub fn bind(session: &Session, mesh_path: &str, material_path: &str, material: Material) {
    let id = MaterialId::new(material_path);
    session.edit(SceneEdit::Material(id.clone(), material)).unwrap();
    session.edit(mesh(mesh_path, MeshPatch { material: Some(Some(id)), ..MeshPatch::default() })).unwrap();
}

/// A small bright lamp, a floor, and a metal box whose reflections of the lamp the floor meets by chance alone.
pub fn metal_and_lamp(samples: i64) -> Session {
    let session = session(6.0, samples, &[Aov::Color]);
    let at = |x: f64, y: f64, z: f64, size: DVec3| {
        Some(DAffine3::from_translation(DVec3::new(x, y, z)) * DAffine3::from_scale(size))
    };
    let floor = at(0.0, -2.0, 0.0, DVec3::new(8.0, 0.5, 8.0));
    session.edit(mesh("/floor", MeshPatch { transform: floor, ..cube() })).unwrap();
    session.edit(mesh("/box", MeshPatch { transform: at(0.9, -0.7, 0.0, DVec3::splat(0.8)), ..cube() })).unwrap();
    let metal = PreviewSurface { diffuse_color: Rgb::splat(0.9), metallic: 1.0, roughness: 0.15, ..Default::default() };
    bind(&session, "/box", "/metal", Material::Preview(metal));
    bind(&session, "/floor", "/matt", lambert(0.6, 0.0));
    let lamp = Light { intensity: 400.0, ..Light::new(LightKind::Sphere { radius: 0.15, treat_as_point: false }) };
    let lamp = Light { world_from_light: DAffine3::from_translation(DVec3::new(-2.0, 0.5, 0.5)), ..lamp };
    session.edit(SceneEdit::Light(LightId::new("/lamp"), lamp)).unwrap();
    session
}

/// Renders to the end.
pub fn finish(session: &Session) {
    session.start();
    assert!(session.wait(Duration::from_secs(120)), "not finished in time");
}

pub fn color(session: &Session) -> Vec<[f32; 4]> {
    color_of(session, SIZE * SIZE)
}

/// Of a film of so many pixels.
pub fn color_of(session: &Session, pixels: usize) -> Vec<[f32; 4]> {
    let mut out = vec![0u8; pixels * 16];
    assert!(session.resolve(Aov::Color, BufferFormat::Float32Vec4, &mut out));
    bytemuck::cast_slice(&out).to_vec()
}

pub fn ids(session: &Session, aov: Aov) -> Vec<i32> {
    ids_of(session, aov, SIZE * SIZE)
}

/// Of a film of so many pixels.
pub fn ids_of(session: &Session, aov: Aov, pixels: usize) -> Vec<i32> {
    let mut out = vec![0u8; pixels * 4];
    assert!(session.resolve(aov, BufferFormat::Int32, &mut out));
    bytemuck::cast_slice(&out).to_vec()
}

pub fn floats(session: &Session, aov: Aov) -> Vec<f32> {
    let mut out = vec![0u8; SIZE * SIZE * 4];
    assert!(session.resolve(aov, BufferFormat::Float32, &mut out));
    bytemuck::cast_slice(&out).to_vec()
}

/// No messages but these.
pub fn assert_messages(session: &Session, expected: &[&str]) {
    let said: Vec<String> = session.take_messages().iter().map(ToString::to_string).collect();
    assert_eq!(said.len(), expected.len(), "{said:?}");
    for (text, want) in said.iter().zip(expected) {
        assert!(text.contains(want), "{text:?} does not speak of {want:?}");
    }
}

/// Sums of red over the blocks of 8 × 8 pixels of a film of such an edge, and over all.
pub fn block_sums(color: &[[f32; 4]], edge: usize) -> Vec<f64> {
    const BLOCK: usize = 8;
    let across = edge / BLOCK;
    let mut sums = vec![0.0; across * across + 1];
    for (i, pixel) in color.iter().enumerate() {
        sums[i / edge / BLOCK * across + i % edge / BLOCK] += f64::from(pixel[0]);
        *sums.last_mut().unwrap() += f64::from(pixel[0]);
    }
    sums
}

/// Films of so many pixels are the same, whatever the number of threads and however often the session was stopped:
/// final ones, watched ones and adaptive ones. `finish_and_check` brings a session to its end.
pub fn assert_same_for_threads_and_stops(
    pixels: usize,
    scene: impl Fn() -> Session,
    finish_and_check: impl Fn(&Session),
) {
    for (interactive, target) in [(0, -1.0), (1, -1.0), (0, 1e-4), (1, 1e-4)] {
        let picture = |threads, stops: u32| {
            let session = scene();
            session.edit(setting("umber:threads", threads)).unwrap();
            session.edit(setting("enableInteractive", interactive)).unwrap();
            session.edit(number("convergedVariance", target)).unwrap();
            let mut halted = 0;
            for i in 0..stops {
                session.start();
                std::thread::sleep(Duration::from_micros(300 << i));
                session.stop();
                halted += u32::from(!session.is_converged());
            }
            assert!(stops == 0 || halted > 0, "no stop came in time");
            finish_and_check(&session);
            color_of(&session, pixels)
        };
        let whole = picture(1, 0);
        assert!(whole == picture(3, 0), "interactive {interactive}, target {target}: threads");
        assert!(whole == picture(2, 9), "interactive {interactive}, target {target}: stops");
    }
}

/// Pictures of two kinds, each by its [`block_sums`], have the same means. As many of either: of ten, Student's t of 18
/// degrees of freedom; one of 37 blocks is beyond 4.5 once in a hundred tests.
pub fn assert_same_means(what: &str, a: &[Vec<f64>], b: &[Vec<f64>]) {
    let moments = |pictures: &[Vec<f64>], block: usize| {
        let n = pictures.len() as f64;
        let mean = pictures.iter().map(|p| p[block]).sum::<f64>() / n;
        let squares = pictures.iter().map(|p| (p[block] - mean).powi(2)).sum::<f64>();
        (mean, squares / ((n - 1.0) * n))
    };
    let z = |block: usize| {
        let ((a, va), (b, vb)) = (moments(a, block), moments(b, block));
        if a == b { 0.0 } else { (a - b) / (va + vb).sqrt() }
    };
    let scores: Vec<f64> = (0..a[0].len()).map(z).collect();
    println!("{what}: {scores:.1?}");
    assert!(scores.iter().all(|z| z.abs() < 4.5), "{what}: {scores:?}");
    assert!(scores.last().unwrap().abs() < 3.0, "{what}: {scores:?}");
}
