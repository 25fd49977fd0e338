//! What the rasteriser shades by: normals and colours, however a mesh holds them.

mod common;

use std::sync::Arc;

use common::*;
use umber_math::{DAffine3, DVec3, Vec3};
use umber_render::{Aov, BufferFormat, FilmDesc, Session};
use umber_scene::{Interpolation, MeshPatch, Primvar, PrimvarValues, SceneEdit, SubdivisionScheme, Topology};
use umber_settings::Value;

/// Quads of a wave, each way.
const QUADS: usize = 9;

type Color = [f32; 4];

/// A point of the wave at which lines meet.
fn point(x: usize, y: usize) -> Vec3 {
    let [x, y] = [x, y].map(|v| 3.0 * v as f32 / QUADS as f32 - 1.5);
    Vec3::new(x, y, 0.3 * (2.0 * x).sin() * (1.5 * y).cos())
}

/// A normal that is nobody else's, towards +Z.
fn normal(index: usize) -> Vec3 {
    let angle = index as f32;
    Vec3::new(0.4 * angle.sin(), 0.4 * (1.7 * angle).cos(), 1.0)
}

fn points() -> Vec<Vec3> {
    (0..=QUADS).flat_map(|y| (0..=QUADS).map(move |x| point(x, y))).collect()
}

/// Corners of its quads, one after the other.
fn corners() -> Vec<usize> {
    let quad = |x: usize, y: usize| [[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]].map(|[x, y]| y * (QUADS + 1) + x);
    (0..QUADS).flat_map(|y| (0..QUADS).flat_map(move |x| quad(x, y))).collect()
}

fn wave() -> MeshPatch {
    let topology = Topology {
        scheme: SubdivisionScheme::None,
        face_vertex_counts: vec![4; QUADS * QUADS].into(),
        face_vertex_indices: corners().into_iter().map(|i| i as i32).collect(),
        ..Topology::default()
    };
    MeshPatch {
        topology: Some(Arc::new(topology)),
        points: Some(points().into()),
        transform: Some(DAffine3::IDENTITY),
        visible: Some(true),
        ..MeshPatch::default()
    }
}

fn primvar(interpolation: Interpolation, values: Vec<Vec3>) -> Primvar {
    Primvar { interpolation, values: PrimvarValues::Float3(values.into()) }
}

/// Values for a wave, of what gives one for each number.
fn values(interpolation: Interpolation, value: &dyn Fn(usize) -> Vec3) -> Primvar {
    let values = match interpolation {
        Interpolation::Constant => vec![value(0)],
        Interpolation::Uniform => (0..QUADS * QUADS).map(value).collect(),
        Interpolation::Varying | Interpolation::Vertex => (0..points().len()).map(value).collect(),
        Interpolation::FaceVarying => corners().into_iter().map(value).collect(),
    };
    primvar(interpolation, values)
}

/// Colours of two waves with the same change, through one another.
fn rendered(change: &dyn Fn(MeshPatch) -> MeshPatch) -> Vec<Color> {
    let session = waves(change);
    finish(&session);
    color(&session)
}

fn waves(change: &dyn Fn(MeshPatch) -> MeshPatch) -> Session {
    let session = session(3.0, 1, &[Aov::Color, Aov::Normal, Aov::PrimId]);
    session.edit(SceneEdit::Setting("umber:integrator".into(), Value::Text("raster".into()))).unwrap();
    for (i, x) in [-0.7, 0.8].into_iter().enumerate() {
        let place = DAffine3::from_translation(DVec3::new(x, 0.1 * x, -0.3 * x)) * DAffine3::from_rotation_y(0.5 * x);
        let patch = MeshPatch { transform: Some(place), prim_id: Some(i as i32), ..change(wave()) };
        session.edit(mesh(&format!("/wave{i}"), patch)).unwrap();
    }
    session
}

fn with_normals(normals: Primvar) -> Vec<Color> {
    rendered(&|wave| MeshPatch { normals: Some(Some(normals.clone())), ..wave })
}

fn with_colors(colors: Primvar) -> Vec<Color> {
    rendered(&|wave| MeshPatch { primvars: [("displayColor".into(), Some(colors.clone()))].into(), ..wave })
}

fn assert_close(a: &[Color], b: &[Color], allowed: f32) {
    for (i, (a, b)) in a.iter().zip(b).enumerate() {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() <= allowed), "{i}: {a:?} {b:?}");
    }
}

/// Those of points are read from another place than those of corners, and give the very same picture.
#[test]
fn normals_of_points_and_corners_give_one_picture() {
    let vertex = with_normals(values(Interpolation::Vertex, &normal));
    assert_eq!(vertex, with_normals(values(Interpolation::Varying, &normal)));
    assert_eq!(vertex, with_normals(values(Interpolation::FaceVarying, &normal)));
    let constant = with_normals(values(Interpolation::Constant, &normal));
    assert_close(&constant, &with_normals(values(Interpolation::Vertex, &|_| normal(0))), 2e-6);
    let uniform = with_normals(values(Interpolation::Uniform, &normal));
    let of_faces = (0..QUADS * QUADS).flat_map(|face| [normal(face); 4]).collect();
    assert_close(&uniform, &with_normals(primvar(Interpolation::FaceVarying, of_faces)), 2e-6);
    assert_ne!(vertex, constant);
    assert_ne!(constant, uniform);
}

#[test]
fn normals_without_direction_are_those_of_triangles() {
    let flat = rendered(&|wave| wave);
    assert!(flat.iter().filter(|c| c[0] > 0.05).count() > 200);
    for odd in [Vec3::ZERO, Vec3::NAN] {
        for interpolation in [Interpolation::Constant, Interpolation::Vertex, Interpolation::FaceVarying] {
            assert_close(&flat, &with_normals(values(interpolation, &|_| odd)), 1e-6);
        }
        let some = with_normals(values(Interpolation::Vertex, &|i| if i % 3 == 0 { odd } else { normal(i) }));
        assert!(some.iter().zip(&flat).all(|(a, b)| a[3] == b[3] && (a[3] == 0.0 || a[0] > 0.0)));
    }
}

/// Colour is base times the cosine between view ray and the normal that the AOV shows.
#[test]
fn normals_are_those_of_the_aov() {
    let session = waves(&|wave| MeshPatch {
        normals: Some(Some(values(Interpolation::Vertex, &normal))),
        primvars: [("displayColor".into(), Some(primvar(Interpolation::Constant, vec![Vec3::splat(0.5)])))].into(),
        ..wave
    });
    finish(&session);
    let mut normals = vec![0u8; SIZE * SIZE * 12];
    assert!(session.resolve(Aov::Normal, BufferFormat::Float32Vec3, &mut normals));
    let normals = bytemuck::cast_slice::<u8, f32>(&normals);
    let (colors, prims) = (color(&session), ids(&session, Aov::PrimId));
    let mut seen = [0; 2];
    for (i, color) in colors.iter().enumerate().filter(|(_, c)| c[3] > 0.0) {
        let [x, y] = [i % SIZE, i / SIZE].map(|v| (v as f32 + 0.5) / SIZE as f32 - 0.5);
        let cos = Vec3::from_slice(&normals[3 * i..]).dot(Vec3::new(x, y, -1.0).normalize()).abs();
        assert!((color[0] - 0.5 * cos).abs() < 1e-5, "{i}: {color:?} {cos}");
        seen[prims[i] as usize] += 1;
    }
    assert!(seen.iter().all(|count| *count > 50), "{seen:?}");
}

/// A colour that is linear over the surface is so in perspective, too.
#[test]
fn colors_vary_in_perspective() {
    let of_place = |p: Vec3| Vec3::new(0.3 + 0.1 * p.x, 0.5 + 0.2 * p.y, 0.4 + 0.1 * p.z);
    let of_point = |i: usize| of_place(points()[i]);
    let vertex = with_colors(values(Interpolation::Vertex, &of_point));
    assert_eq!(vertex, with_colors(values(Interpolation::Varying, &of_point)));
    assert_eq!(vertex, with_colors(values(Interpolation::FaceVarying, &of_point)));
    // of one square, and of several
    for size in [SIZE, 150] {
        slanted_plane_has(size, &of_place);
    }
}

/// A slanted plane behind small things, on a film of `size` pixels each way: its points are known from the view rays.
fn slanted_plane_has(size: usize, of_place: &dyn Fn(Vec3) -> Vec3) {
    let slant = DAffine3::from_rotation_y(1.0);
    let session = session(3.0, 1, &[]);
    session.set_film(FilmDesc::new(size, size, &[Aov::Color, Aov::PrimId]));
    session.edit(SceneEdit::Setting("umber:integrator".into(), Value::Text("raster".into()))).unwrap();
    let level: Vec<Vec3> = points().into_iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
    let colors = values(Interpolation::Vertex, &|i| of_place(level[i]));
    let patch = MeshPatch {
        points: Some(level.clone().into()),
        primvars: [("displayColor".into(), Some(colors))].into(),
        transform: Some(slant),
        prim_id: Some(3),
        ..wave()
    };
    session.edit(mesh("/plane", patch)).unwrap();
    for i in 0..9 {
        let at = DVec3::new(f64::from(i % 3) - 1.0, f64::from(i / 3) - 1.0, 1.0) * 0.4;
        let transform = DAffine3::from_translation(at) * DAffine3::from_scale(DVec3::splat(0.05));
        session.edit(mesh(&format!("/small{i}"), MeshPatch { transform: Some(transform), ..wave() })).unwrap();
    }
    finish(&session);
    let normal = slant.transform_vector3(DVec3::Z);
    let (colors, prims) = (color_of(&session, size * size), ids_of(&session, Aov::PrimId, size * size));
    let mut seen = 0;
    for (i, color) in colors.iter().enumerate().filter(|(i, _)| prims[*i] == 3) {
        let [x, y] = [i % size, i / size].map(|v| (v as f64 + 0.5) / size as f64 - 0.5);
        let (eye, ray) = (DVec3::new(0.0, 0.0, 3.0), DVec3::new(x, y, -1.0));
        let met = eye - ray * (eye.dot(normal) / ray.dot(normal));
        let expected =
            of_place(slant.inverse().transform_point3(met).as_vec3()) * (ray.normalize().dot(normal).abs()) as f32;
        assert!((Vec3::from_slice(&color[..3]) - expected).abs().max_element() < 1e-5, "{i}: {color:?} {expected}");
        seen += 1;
    }
    assert!(seen > size * size / 6, "{seen}");
    assert!(colors.iter().zip(&prims).any(|(color, prim)| color[3] > 0.0 && *prim != 3), "small things in front");
}
