//! Pictures with and without light samples towards what emits must agree.

mod apis;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use umber_math::{DAffine3, DVec3, Rgb, Vec2, Vec3};
use umber_sampling::Sampler;
use umber_scene::{
    Camera, CameraId, GeomSubset, InstancerId, InstancerPatch, Light, LightId, LightKind, Material, MaterialId,
    MaterialSync, MeshId, MeshPatch, PreviewSurface, SceneEdit, SceneStore, SubdivisionScheme, Topology,
};

use super::Compiler;
use crate::integrator::path;
use crate::integrator::primary::Primary;
use crate::integrator::splitting::Splitting;
use crate::light_set::LightSet;
use crate::scene::RenderScene;
use crate::{Aov, FilmDesc};

fn polygons(points: &[[f32; 3]], faces: &[&[i32]]) -> MeshPatch {
    let topology = Topology {
        scheme: SubdivisionScheme::None,
        face_vertex_counts: faces.iter().map(|f| f.len() as i32).collect(),
        face_vertex_indices: faces.iter().flat_map(|f| f.iter().copied()).collect(),
        ..Topology::default()
    };
    MeshPatch {
        topology: Some(Arc::new(topology)),
        points: Some(points.iter().map(|p| Vec3::from(*p)).collect()),
        visible: Some(true),
        ..MeshPatch::default()
    }
}

fn floor() -> MeshPatch {
    polygons(&[[-9.0, -9.0, 0.0], [9.0, -9.0, 0.0], [9.0, 9.0, 0.0], [-9.0, 9.0, 0.0]], &[&[0, 1, 2, 3]])
}

/// A tetrahedron, faces outwards.
fn tetrahedron() -> MeshPatch {
    let points = [[0.0, 0.0, 0.8], [0.7, 0.0, 0.0], [-0.4, 0.6, 0.0], [-0.4, -0.6, -0.2]];
    polygons(&points, &[&[0, 1, 2], &[0, 2, 3], &[0, 3, 1], &[1, 3, 2]])
}

fn surface(albedo: f32, glow: [f32; 3], opacity: f32) -> Material {
    Material::Preview(PreviewSurface {
        diffuse_color: Rgb::splat(albedo),
        emissive_color: Rgb::from(glow),
        use_specular_workflow: true,
        opacity,
        ..PreviewSurface::default()
    })
}

struct Stage(SceneStore);

impl Stage {
    fn new() -> Self {
        let camera = Camera {
            world_from_camera: DAffine3::from_translation(DVec3::new(0.0, 0.0, 6.0)),
            aperture: umber_math::DVec2::ONE,
            focal_length: 1.0,
            clipping_range: [0.01, 1e6],
            ..Camera::default()
        };
        let mut stage = Self(SceneStore::default());
        stage.edit(SceneEdit::Camera(CameraId::new("/c"), camera));
        stage.edit(SceneEdit::RenderCamera(CameraId::new("/c")));
        stage.material("/grey", surface(0.7, [0.0; 3], 1.0));
        stage.mesh("/floor", MeshPatch { material: bound("/grey"), ..floor() });
        stage
    }
    fn edit(&mut self, edit: SceneEdit) {
        self.0.apply(edit).unwrap();
    }
    fn material(&mut self, path: &str, material: Material) {
        self.edit(SceneEdit::Material(MaterialId::new(path), material));
    }
    fn mesh(&mut self, path: &str, patch: MeshPatch) {
        self.edit(SceneEdit::Mesh(MeshId::new(path), Box::new(patch)));
    }
    fn compile(&mut self) -> (RenderScene, Vec<String>) {
        let dirty = self.0.take_dirty();
        let mut said = Vec::new();
        let film = FilmDesc::new(SIZE, SIZE, &[Aov::Color]);
        let scene = Compiler::default()
            .compile(&self.0, dirty, &film, &AtomicBool::new(false), &mut |m| said.push(m.to_string()))
            .unwrap_or_else(|_| panic!("no scene"));
        (scene, said)
    }
}

fn bound(path: &str) -> Option<Option<MaterialId>> {
    Some(Some(MaterialId::new(path)))
}

fn at(x: f64, y: f64, z: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, y, z))
}

const SIZE: usize = 8;

/// Mean and its variance over the picture, each channel.
fn picture(scene: &RenderScene, samples: u32, seed: u64) -> [(f64, f64); 3] {
    let mut sums = [[0.0; 2]; 3];
    let pixels = (SIZE * SIZE) as f64;
    for pixel in 0..SIZE * SIZE {
        let (x, y) = (pixel % SIZE, pixel / SIZE);
        // Batches of their own seeds tell how far the mean is off: within one, samples are stratified.
        let batches = 8;
        let mut means = [[0.0; 2]; 3];
        for batch in 0..batches {
            let mut mean = [0.0; 3];
            for number in 0..samples {
                let mut sampler = Sampler::new(seed + (batch << 40), [x as u32, y as u32], number);
                sampler.start_dimension(crate::integrator::dimensions::FILM);
                let ray = scene.camera.ray(Vec2::new(x as f32, y as f32) + sampler.next_2d());
                let primary = Primary::new(scene, ray, &mut sampler, &mut 0);
                let radiance = path::radiance(&primary, &mut sampler, &mut 0).radiance;
                (0..3).for_each(|c| mean[c] += f64::from(radiance.0[c]) / f64::from(samples));
            }
            (0..3).for_each(|c| {
                means[c][0] += mean[c];
                means[c][1] += mean[c] * mean[c];
            });
        }
        for c in 0..3 {
            let n = batches as f64;
            let mean = means[c][0] / n;
            sums[c][0] += mean / pixels;
            sums[c][1] += (means[c][1] / n - mean * mean).max(0.0) / (n - 1.0) / (pixels * pixels);
        }
    }
    sums.map(|[mean, variance]| (mean, variance))
}

/// Renders with light samples and by chance alone; how much less variance light samples make.
fn compare(scene: RenderScene, name: &str) -> f64 {
    let sampled = picture(&scene, 32, 1);
    assert!(!scene.lights.lights().is_empty(), "{name}: nothing to sample");
    let by_chance = picture(&RenderScene { lights: Arc::new(LightSet::default()), ..scene }, 128, 2);
    for (s, c) in sampled.iter().zip(&by_chance) {
        let z = (s.0 - c.0) / (s.1 + c.1).sqrt().max(1e-12);
        assert!(z.abs() < 4.5 && s.0 > 1e-3, "{name}: {s:?} with light samples, {c:?} by chance: z = {z}");
    }
    4.0 * by_chance[1].1 / sampled[1].1
}

#[test]
fn emissive_materials() {
    let mut stage = Stage::new();
    stage.material("/glow", surface(0.3, [3.0, 2.0, 1.0], 1.0));
    stage.material("/blue", surface(0.0, [0.0, 0.0, 9.0], 1.0));
    let subset = GeomSubset { material: Some(MaterialId::new("/blue")), faces: [1].into() };
    let patch = MeshPatch {
        material: bound("/glow"),
        // beside the picture: all that is seen of it is what it lights
        transform: Some(at(4.5, 0.0, 1.5)),
        subsets: Some([subset].into()),
        ..tetrahedron()
    };
    stage.mesh("/tetrahedron", patch);
    let (scene, said) = stage.compile();
    assert_eq!(said, Vec::<String>::new());
    let gain = compare(scene, "emissive materials");
    assert!(gain > 5.0, "light samples make only {gain} times less variance");
}

#[test]
fn partly_present_emitters() {
    let mut stage = Stage::new();
    stage.material("/glow", surface(0.3, [3.0, 2.0, 1.0], 0.4));
    let patch = MeshPatch { material: bound("/glow"), transform: Some(at(0.0, 0.3, 1.0)), ..tetrahedron() };
    stage.mesh("/tetrahedron", patch);
    compare(stage.compile().0, "partly present");
}

#[test]
fn instances_in_instances_stretched_and_mirrored() {
    let mut stage = Stage::new();
    stage.material("/glow", surface(0.0, [4.0, 5.0, 6.0], 1.0));
    let (inner, outer) = (InstancerId::new("/inner"), InstancerId::new("/outer"));
    let stretched = DAffine3::from_scale(DVec3::new(0.3, 1.2, -0.5)) * DAffine3::from_rotation_x(0.7);
    stage.edit(SceneEdit::Instancer(
        inner.clone(),
        InstancerPatch {
            parent: Some(Some(outer.clone())),
            parent_indices: Some([1, 0].into()),
            transforms: Some([at(1.0, 0.0, 0.4) * stretched, at(-1.0, 0.5, 0.0)].into()),
            visible: Some(true),
            ..InstancerPatch::default()
        },
    ));
    stage.edit(SceneEdit::Instancer(
        outer,
        InstancerPatch {
            transforms: Some([at(0.0, -1.5, 0.7), at(0.0, 1.5, 1.4) * DAffine3::from_rotation_z(1.0)].into()),
            visible: Some(true),
            ..InstancerPatch::default()
        },
    ));
    // A second mesh, dark, makes the instances groups.
    for (path, material) in [("/lamp", "/glow"), ("/a_post", "/grey")] {
        stage.mesh(
            path,
            MeshPatch {
                material: bound(material),
                instancer: Some(Some(inner.clone())),
                instance_indices: Some([0, 1].into()),
                transform: Some(if path == "/lamp" { at(0.0, 0.0, 0.0) } else { at(0.0, 0.9, -0.4) }),
                ..tetrahedron()
            },
        );
    }
    let (scene, said) = stage.compile();
    assert_eq!(said, Vec::<String>::new());
    assert_eq!(scene.lights.lights().len(), 4);
    compare(scene, "instances");
}

fn mesh_light(sync: MaterialSync, normalize: bool) -> SceneEdit {
    let kind = LightKind::Mesh { mesh: MeshId::new("/tetrahedron"), material_sync: sync };
    let light = Light { color: Rgb::new(2.0, 1.0, 0.5), intensity: 3.0, normalize, ..Light::new(kind) };
    SceneEdit::Light(LightId::new("/tetrahedron"), light)
}

/// A mesh light lights as an emissive material of its radiance does, by each rule of its material.
#[test]
fn mesh_lights_shine_by_usdlux() {
    let glow = [1.0, 4.0, 2.0];
    // Double the size of the tetrahedron: its area in the world.
    let placed = at(0.2, 0.1, 1.4) * DAffine3::from_scale(DVec3::splat(2.0));
    let area = {
        let m = tetrahedron();
        let (points, topology) = (m.points.unwrap(), m.topology.unwrap());
        let corner = |i: usize| points[topology.face_vertex_indices[i] as usize];
        let face = |f: usize| (corner(3 * f + 1) - corner(3 * f)).cross(corner(3 * f + 2) - corner(3 * f)).length();
        4.0 * 0.5 * (0..4).map(face).sum::<f32>()
    };
    let color = Rgb::new(6.0, 3.0, 1.5);
    let tinted = Rgb(color.0 * Vec3::from(glow));
    // Rule, material, normalised; the albedo and glow that light as much, and what the camera sees of it.
    let cases = [
        (MaterialSync::GlowTintsLight, true, false, 0.5, tinted, Rgb::from(glow)),
        (MaterialSync::GlowTintsLight, true, true, 0.5, tinted * (1.0 / area), Rgb::from(glow)),
        (MaterialSync::GlowTintsLight, false, false, 0.0, color, color),
        (MaterialSync::Independent, true, false, 0.5, color, Rgb::from(glow)),
        (MaterialSync::NoResponse, true, false, 0.0, color, color),
        (MaterialSync::NoResponse, true, true, 0.0, color * (1.0 / area), color * (1.0 / area)),
    ];
    for (sync, has_material, normalize, albedo, like, seen) in cases {
        let stage = |light: bool| {
            let mut stage = Stage::new();
            stage.material("/glow", surface(0.5, glow, 1.0));
            stage.material("/like", surface(albedo, like.0.to_array(), 1.0));
            let material = match (light, has_material) {
                (true, true) => bound("/glow"),
                (true, false) => None,
                (false, _) => bound("/like"),
            };
            stage.mesh("/tetrahedron", MeshPatch { material, transform: Some(placed), ..tetrahedron() });
            if light {
                stage.edit(mesh_light(sync, normalize));
            }
            let (scene, said) = stage.compile();
            assert_eq!(said, Vec::<String>::new());
            scene
        };
        let (lit, like_scene) = (stage(true), stage(false));
        let name = format!("{sync:?}, material {has_material}, normalize {normalize}");
        // The picture's middle is the light itself: what it emits is taken off, to compare what is lit.
        let emission =
            |scene: &RenderScene| picture(&RenderScene { settings: direct_only(scene), ..copy(scene) }, 8, 3);
        let (a, b) = (picture(&lit, 64, 1), picture(&like_scene, 64, 2));
        let (ea, eb) = (emission(&lit), emission(&like_scene));
        for c in 0..3 {
            let z = ((a[c].0 - ea[c].0) - (b[c].0 - eb[c].0)) / (a[c].1 + b[c].1 + ea[c].1 + eb[c].1).sqrt();
            assert!(z.abs() < 4.5 && a[c].0 - ea[c].0 > 1e-3, "{name}: {a:?} but {b:?}, z = {z}");
            let (got, want) = (ea[c].0 / eb[c].0, f64::from(seen.0[c] / like.0[c]));
            assert!((got / want - 1.0).abs() < 1e-4, "{name}: seen {got}, not {want}");
        }
    }
}

fn direct_only(scene: &RenderScene) -> umber_settings::Settings {
    umber_settings::Settings { max_bounces: 0, ..scene.settings.clone() }
}

fn copy(scene: &RenderScene) -> RenderScene {
    RenderScene {
        camera: scene.camera.clone(),
        settings: scene.settings.clone(),
        top: Arc::clone(&scene.top),
        numbers: Arc::clone(&scene.numbers),
        instance_count: scene.instance_count,
        meshes: Arc::clone(&scene.meshes),
        materials: Arc::clone(&scene.materials),
        lights: Arc::clone(&scene.lights),
        linking: scene.linking.clone(),
        partly_present: scene.partly_present,
        caustics: None,
        light_tracing: None,
        path_group: 1,
        splitting: Splitting::NONE,
        edges: None,
    }
}

#[test]
fn what_cannot_shine_is_told() {
    let mut stage = Stage::new();
    stage.material("/dark", surface(0.5, [0.0; 3], 1.0));
    stage.material("/nan", surface(0.5, [f32::NAN, 1.0, 0.0], 1.0));
    stage.mesh("/tetrahedron", MeshPatch { material: bound("/dark"), ..tetrahedron() });
    stage.edit(mesh_light(MaterialSync::GlowTintsLight, false));
    let elsewhere = LightKind::Mesh { mesh: MeshId::new("/nowhere"), material_sync: MaterialSync::Independent };
    stage.edit(SceneEdit::Light(LightId::new("/lost"), Light::new(elsewhere)));
    let again = LightKind::Mesh { mesh: MeshId::new("/tetrahedron"), material_sync: MaterialSync::Independent };
    stage.edit(SceneEdit::Light(LightId::new("/z_second"), Light::new(again)));
    let (scene, said) = stage.compile();
    assert!(scene.lights.lights().is_empty());
    for (prim, text) in [
        ("/tetrahedron", "does not glow"),
        ("/lost", "no mesh </nowhere>"),
        ("/z_second", "</tetrahedron> shines from the same mesh"),
        ("/nan", "emissiveColor is not a number"),
    ] {
        assert!(said.iter().any(|s| s.contains(prim) && s.contains(text)), "{prim}: {said:?}");
    }
    assert_eq!(said.len(), 4, "{said:?}");
}

/// Triangles without area, and ones far from the origin, do no harm.
#[test]
fn broken_triangles_are_left_out() {
    let mut stage = Stage::new();
    stage.material("/glow", surface(0.0, [2.0, 2.0, 2.0], 1.0));
    let points = [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [1.0, 1.0, 1.0], [2.0, 2.0, 1.0], [f32::NAN; 3]];
    let patch = polygons(&points, &[&[0, 1, 2], &[2, 3, 4], &[0, 2, 4], &[0, 1, 5]]);
    stage.mesh("/shreds", MeshPatch { material: bound("/glow"), ..patch });
    let (scene, _) = stage.compile();
    assert_eq!(scene.lights.lights().len(), 1);
    assert!(picture(&scene, 4, 1).iter().all(|(mean, variance)| *mean > 0.0 && variance.is_finite()));
}
