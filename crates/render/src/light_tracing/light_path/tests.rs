//! Both ends of a path know the same of it.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use umber_math::{DAffine3, DVec3, Vec3};
use umber_scene::{
    Camera, CameraId, Interpolation, Light, LightId, LightKind, Material, MaterialId, MeshId, MeshPatch,
    PreviewSurface, Primvar, PrimvarValues, SceneEdit, SceneStore, SubdivisionScheme, Topology,
};

use super::*;
use crate::Aov;
use crate::compile::Compiler;
use crate::integrator::Stop;
use crate::light_tracing::chain::Chain;

const SIZE: usize = 16;

fn square(store: &mut SceneStore, path: &str, roughness: f32, transform: DAffine3) {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let topology = Topology {
        scheme: SubdivisionScheme::None,
        face_vertex_counts: [4].into(),
        face_vertex_indices: [0, 1, 2, 3].into(),
        ..Topology::default()
    };
    // shading normals that are not those of the triangles
    let normal = |(x, y): (f32, f32)| Vec3::new(0.2 * x, 0.2 * y, 1.0).normalize();
    let normals =
        Primvar { interpolation: Interpolation::Vertex, values: PrimvarValues::Float3(corners.map(normal).into()) };
    let material = MaterialId::new(&format!("{path}_material"));
    let patch = MeshPatch {
        topology: Some(Arc::new(topology)),
        points: Some(corners.map(|(x, y)| Vec3::new(x, y, 0.0)).into()),
        normals: Some(Some(normals)),
        transform: Some(transform),
        visible: Some(true),
        material: Some(Some(material.clone())),
        ..MeshPatch::default()
    };
    let surface = PreviewSurface { metallic: 1.0, roughness, ..PreviewSurface::default() };
    store.apply(SceneEdit::Material(material, Material::Preview(surface))).unwrap();
    store.apply(SceneEdit::Mesh(MeshId::new(path), Box::new(patch))).unwrap();
}

/// Two smooth squares that face each other, one of them squeezed, over a rough one.
fn scene() -> RenderScene {
    let at = |x: f64, y: f64, z: f64| DAffine3::from_translation(DVec3::new(x, y, z));
    let mut store = SceneStore::default();
    square(&mut store, "/floor", 0.9, at(0.0, 0.0, -1.0) * DAffine3::from_scale(DVec3::splat(3.0)));
    square(&mut store, "/left", 0.3, at(-1.0, 0.0, 0.0) * DAffine3::from_rotation_y(1.2));
    let squeezed = DAffine3::from_scale(DVec3::new(0.7, 1.3, 1.0));
    square(&mut store, "/right", 0.15, at(1.0, 0.2, 0.0) * DAffine3::from_rotation_y(-1.3) * squeezed);
    let lamp = Light::new(LightKind::Sphere { radius: 0.2, treat_as_point: false });
    let lamp = Light { intensity: 10.0, world_from_light: at(0.0, 0.0, 1.0), ..lamp };
    let camera = Camera {
        world_from_camera: at(0.3, -0.2, 6.0) * DAffine3::from_scale(DVec3::splat(2.0)),
        aperture: umber_math::DVec2::new(1.0, 1.2),
        focal_length: 1.0,
        clipping_range: [0.01, 1e6],
        ..Camera::default()
    };
    for edit in [
        SceneEdit::Light(LightId::new("/lamp"), lamp),
        SceneEdit::Camera(CameraId::new("/c"), camera),
        SceneEdit::RenderCamera(CameraId::new("/c")),
    ] {
        store.apply(edit).unwrap();
    }
    let dirty = store.take_dirty();
    Compiler::default()
        .compile(&store, dirty, &film(), &AtomicBool::new(false), &mut |m| panic!("{m}"))
        .unwrap_or_else(|_| panic!("no scene"))
}

fn film() -> FilmDesc {
    FilmDesc::new(SIZE, SIZE, &[Aov::Color])
}

/// *R* as a path from the camera knows it: `surfaces` from the camera on, and the direction to the light from the last.
fn from_camera(scene: &RenderScene, ray: Ray, surfaces: &[(Hit, SurfaceInteraction)], wi: Vector3) -> f32 {
    let (mut chain, mut wo) = (Chain::default(), -ray.direction);
    for (bounce, (hit, surface)) in (0..).zip(surfaces) {
        let bsdf = surface.bsdf(wo);
        let hit = Hit { t: ray.t_max, ..*hit };
        let link = chain.link(scene, &hit, surface, &bsdf, wo, bounce);
        let guided = Guided::new(bsdf, surface.at.point, None);
        let vertex = Vertex { surface: *surface, guided, wo, bounce, link };
        let Some((_, next)) = surfaces.get(bounce as usize + 1) else {
            return link.ratio(&vertex, wi).0;
        };
        let onwards = (next.at.point - surface.at.point).normalized();
        let value = bsdf.evaluate(wo, onwards);
        let sample = BsdfSample {
            f: value.f(),
            f_diffuse: value.diffuse,
            wi: onwards,
            cos_theta: bsdf.cos_theta(onwards),
            pdf_solid_angle: value.pdf_solid_angle,
            lobe: LobeKind::Glossy,
        };
        (_, chain) = link.onwards(&vertex, &sample);
        wo = -onwards;
    }
    0.0
}

#[test]
fn both_ends_know_the_same_ratio_of_densities() {
    let mut scene = scene();
    let stop = AtomicBool::new(false);
    let stop = Stop { cancel: &stop, deadline: None };
    let (tracing, _) = LightTracing::search(&scene, &film(), 1 << 16, |_| true, &stop, &mut 0).unwrap();
    scene.light_tracing = Some(tracing);
    let tracing = scene.light_tracing.as_ref().unwrap();
    let mut compared = [0; 3];
    for number in 0..40_000 {
        let mut sampler = Sampler::new(0, [0, 0], number);
        let u = sampler.next_1d();
        let Some(mut path) = LightPath::begin(&scene, tracing, u, &mut sampler) else { continue };
        let (first, to_light) = (path.first, path.lit.sample.wi);
        let mut again = Sampler::new(0, [0, 0], number);
        let start = tracing.casters.sample(again.next_1d(), again.next_1d(), again.next_2d()).unwrap();
        let mut surfaces = vec![(start.hit, first)];
        for _ in 0..3 {
            let Some(met) = path.meet(&scene, &mut sampler, &mut 0) else { break };
            surfaces.insert(0, (met.hit, met.surface));
            if let Some(seen) = path.seen(&scene, &film(), &met).filter(|seen| !seen.radiance.is_black()) {
                let ratio = from_camera(&scene, seen.ray, &surfaces, to_light);
                assert!(
                    (ratio / seen.ratio - 1.0).abs() < 1e-3,
                    "{} surfaces: {ratio}, {}",
                    surfaces.len(),
                    seen.ratio
                );
                compared[surfaces.len() - 2] += 1;
            }
            if !tracing.casts(&scene, &met.bsdf, met.point()) || path.reflect(&met, &mut sampler).is_none() {
                break;
            }
        }
    }
    assert!(compared.iter().all(|count| *count > 50), "{compared:?}");
}
