//! Surfaces from mirror to matt: energy that is lost, and bright specks.

use std::{sync::Arc, time::Duration};

use umber_math::{DAffine3, DVec2, DVec3, Frame, Normal3, Rgb, Vec3, Vector3};
use umber_render::{Aov, BufferFormat, FilmDesc, Session};
use umber_sampling::Sampler;
use umber_scene::{
    Camera, CameraId, Light, LightId, LightKind, Material, MaterialId, MeshId, MeshPatch, PreviewSurface, SceneEdit,
    SubdivisionScheme, Topology,
};
use umber_settings::Value;
use umber_shading::{Bsdf, PreviewSurface as Surface};

use super::shapes::{Mesh, icosphere};

/// White surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum White {
    /// A metal.
    Metal,
    /// A dielectric of index 1.5 over a white Lambertian base.
    Plastic,
}

/// Cosines of the angles of view over which energy is averaged.
const COSINES: [f32; 5] = [1.0, 0.8, 0.6, 0.4, 0.2];

/// By how much a white surface in a white environment is darker or brighter than it, mean over angles of view. All of
/// it, were the surface to lose nothing, is zero.
pub fn energy_error(surface: White, roughness: f32, samples: u32) -> f64 {
    let metallic = if surface == White::Metal { 1.0 } else { 0.0 };
    let up = Normal3::new(0.0, 0.0, 1.0);
    let preview = Surface { diffuse_color: Rgb::WHITE, metallic, roughness, ..Surface::default() };
    let bsdf = preview.bsdf(Frame::from_normal(up), up);
    let errors = COSINES.map(|cos| (reflected(&bsdf, cos, samples) - 1.0).abs());
    errors.iter().sum::<f64>() / COSINES.len() as f64
}

/// What is reflected to a direction, by the surface's own sampling.
fn reflected(bsdf: &Bsdf, cos: f32, samples: u32) -> f64 {
    let wo = Vector3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
    let weight = |i| {
        let mut s = Sampler::new(11, [3, 4], i);
        let sampled = bsdf.sample(wo, s.next_1d(), s.next_2d());
        sampled.map_or(0.0, |s| f64::from((s.f * (s.cos_theta / s.pdf_solid_angle)).max_channel()))
    };
    (0..samples).map(weight).sum::<f64>() / f64::from(samples)
}

/// Samples of a picture of a caustic.
#[derive(Clone, Copy, Debug)]
pub struct Specks {
    /// Their mean, radiance.
    pub mean: f64,
    /// The largest, radiance.
    pub largest: f64,
}

/// Pixels along each side of the picture; each has one sample.
const SIZE: usize = 128;

/// A Lambertian floor beside a white metal sphere, under a lamp of a twentieth of its size: what the floor shows, one
/// sample a pixel, over pictures of `seeds` seeds. `clamp`: of `umber:fireflyClamp`, radiance; 0 for none.
pub fn caustic(roughness: f32, clamp: f32, seeds: u32) -> Specks {
    let session = scene(roughness, clamp);
    let (mut sum, mut largest) = (0.0, 0f64);
    for seed in 0..seeds {
        // one that cannot be set is of another type than the table has: a mistake here
        let _ = session.edit(SceneEdit::Setting("umber:seed".into(), Value::Int(i64::from(seed))));
        session.start();
        while !session.wait(Duration::from_secs(10)) {}
        let mut bytes = vec![0u8; SIZE * SIZE * 16];
        session.resolve(Aov::Color, BufferFormat::Float32Vec4, &mut bytes);
        let floats = bytes.chunks_exact(4).map(|b| f32::from_ne_bytes([b[0], b[1], b[2], b[3]]));
        for value in floats.step_by(4).map(f64::from) {
            sum += value;
            largest = largest.max(value);
        }
    }
    Specks { mean: sum / (SIZE * SIZE) as f64 / f64::from(seeds), largest }
}

fn scene(roughness: f32, clamp: f32) -> Session {
    let session = Session::new();
    session.set_film(FilmDesc::new(SIZE, SIZE, &[Aov::Color]));
    let camera = Camera {
        world_from_camera: DAffine3::from_translation(DVec3::new(2.5, 0.0, 8.0)),
        aperture: DVec2::splat(0.25),
        focal_length: 1.0,
        clipping_range: [0.01, 1e3],
        ..Camera::default()
    };
    let lamp = Light {
        world_from_light: DAffine3::from_translation(DVec3::new(3.5, 0.0, 3.0)),
        intensity: 7000.0,
        camera_visible: false,
        ..Light::new(LightKind::Sphere { radius: 0.05, treat_as_point: false })
    };
    let matt = PreviewSurface {
        diffuse_color: Rgb::splat(0.5),
        use_specular_workflow: true,
        specular_color: Rgb::BLACK,
        ..PreviewSurface::default()
    };
    let metal = PreviewSurface { diffuse_color: Rgb::WHITE, metallic: 1.0, roughness, ..PreviewSurface::default() };
    let floor = Mesh {
        points: [(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)]
            .map(|(x, y)| umber_math::Point3(Vec3::new(x, y, 0.0)))
            .into(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    };
    let ball = icosphere(4).map(|p| p + Vec3::new(0.0, 0.0, 1.1));
    let camera_id = CameraId::new("/camera");
    let edits = [
        SceneEdit::Camera(camera_id.clone(), camera),
        SceneEdit::RenderCamera(camera_id),
        SceneEdit::Light(LightId::new("/lamp"), lamp),
        SceneEdit::Material(MaterialId::new("/matt"), Material::Preview(matt)),
        SceneEdit::Material(MaterialId::new("/metal"), Material::Preview(metal)),
        SceneEdit::Mesh(MeshId::new("/floor"), Box::new(patch(&floor, "/matt", 0))),
        SceneEdit::Mesh(MeshId::new("/ball"), Box::new(patch(&ball, "/metal", 1))),
        SceneEdit::Setting("convergedSamplesPerPixel".into(), Value::Int(1)),
        SceneEdit::Setting("enableInteractive".into(), Value::Bool(false)),
        SceneEdit::Setting("umber:fireflyClamp".into(), Value::Float(clamp.into())),
    ];
    for edit in edits {
        let _ = session.edit(edit);
    }
    session
}

fn patch(mesh: &Mesh, material: &str, prim_id: i32) -> MeshPatch {
    let topology = Topology {
        scheme: SubdivisionScheme::None,
        face_vertex_counts: vec![3; mesh.triangles.len()].into(),
        face_vertex_indices: mesh.triangles.iter().flatten().map(|&i| i as i32).collect(),
        ..Topology::default()
    };
    MeshPatch {
        topology: Some(Arc::new(topology)),
        points: Some(mesh.points.iter().map(|p| p.0).collect()),
        transform: Some(DAffine3::IDENTITY),
        visible: Some(true),
        prim_id: Some(prim_id),
        material: Some(Some(MaterialId::new(material))),
        ..MeshPatch::default()
    }
}
