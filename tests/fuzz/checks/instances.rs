//! Groups of groups of meshes, placed by any transforms.

use std::sync::Arc;

use arbitrary::Arbitrary;
use umber_bvh::{Child, Hit, Instance, InstanceBvh, InstancePath, MAX_DEPTH, MeshBvh, SimdLevel};
use umber_geometry::watertight::ShearedRay;
use umber_math::{DAffine3, DVec3, Point3, Ray, Vec3, Vector3};

use super::{
    scene::{Mesh, MeshInput, On, RayInput, bits, check_hit},
    values::Double,
};

/// Most paths through a scene: what nests eight levels of a few instances each takes long to search.
const MAX_PATHS: usize = 512;
/// Most rays that are traced.
const MAX_RAYS: usize = 8;

/// What is checked.
#[derive(Arbitrary, Debug)]
pub struct Input {
    first: MeshInput,
    meshes: Vec<MeshInput>,
    groups: Vec<Vec<Placement>>,
    last: Vec<Placement>,
    rays: Vec<RayInput>,
}

#[derive(Arbitrary, Debug)]
struct Placement {
    /// Of the meshes and the groups before this one, counted from the last.
    child: u8,
    place: Matrix,
}

#[derive(Arbitrary, Debug)]
enum Matrix {
    Identity,
    Translation([Double; 3]),
    /// By degrees about an axis.
    Turn([Double; 3], [i8; 3]),
    Scale([Double; 3], [Double; 3]),
    Any([Double; 12]),
}

impl Matrix {
    fn get(&self) -> DAffine3 {
        let triple = |v: &[Double; 3]| DVec3::from(v.each_ref().map(|d| d.0));
        match self {
            Self::Identity => DAffine3::IDENTITY,
            Self::Translation(t) => DAffine3::from_translation(triple(t)),
            Self::Turn(t, turns) => {
                let [x, y, z] = turns.map(|a| (2.0 * f64::from(a)).to_radians());
                let turn = DAffine3::from_rotation_x(x) * DAffine3::from_rotation_y(y) * DAffine3::from_rotation_z(z);
                DAffine3::from_translation(triple(t)) * turn
            }
            Self::Scale(t, scale) => DAffine3::from_translation(triple(t)) * DAffine3::from_scale(triple(scale)),
            Self::Any(columns) => DAffine3::from_cols_array(&columns.each_ref().map(|d| d.0)),
        }
    }
}

/// A child and the number of paths through it.
type Counted = (Child, usize);

/// The scene, and the meshes by number.
fn build(input: &Input) -> (InstanceBvh, Vec<Mesh>) {
    let meshes: Vec<Mesh> = [&input.first].into_iter().chain(&input.meshes).map(|m| m.mesh()).collect();
    let mut children: Vec<Counted> = Vec::new();
    for (i, mesh) in meshes.iter().enumerate() {
        let bvh = Arc::new(MeshBvh::build(&mesh.points, &mesh.triangles));
        children.push((Child::Mesh { bvh, mesh: i as u32 }, 1));
    }
    for group in &input.groups {
        let (group, paths) = build_group(group, &children);
        children.push((Child::Group(Arc::new(group)), paths));
    }
    (build_group(&input.last, &children).0, meshes)
}

fn build_group(placements: &[Placement], children: &[Counted]) -> (InstanceBvh, usize) {
    let (mut instances, mut paths) = (Vec::new(), 0);
    for (i, placement) in placements.iter().enumerate() {
        let (child, below) = &children[children.len() - 1 - usize::from(placement.child) % children.len()];
        if paths + below <= MAX_PATHS {
            paths += below;
            instances.push(Instance { child: child.clone(), parent_from_child: placement.place.get(), tag: i as u32 });
        }
    }
    (InstanceBvh::build(instances), paths)
}

/// Hits are the same on every vector unit, and each is one of the scalar test on the ray taken along its path.
pub fn check(input: Input) {
    let (scene, meshes) = build(&input);
    assert!(scene.skipped().is_sorted());
    assert!(scene.bounds().is_empty() || scene.bounds().min.is_finite() && scene.bounds().max.is_finite());
    assert!(scene.memory_bytes() > 0);
    for ray in input.rays.iter().take(MAX_RAYS) {
        check_ray(&scene, &meshes, &ray.ray(|on| point_on(&scene, &meshes, on)));
    }
}

/// A point on a placed triangle. What picks the triangle also picks the path.
fn point_on(scene: &InstanceBvh, meshes: &[Mesh], on: On) -> Vec3 {
    let (mut group, mut to_render) = (scene, DAffine3::IDENTITY);
    for level in 0..MAX_DEPTH {
        let count = group.instances().len().max(1);
        let Some(instance) = group.instances().get((usize::from(on.triangle) >> (2 * level)) % count) else { break };
        to_render *= instance.parent_from_child;
        match &instance.child {
            Child::Group(inner) => group = inner,
            Child::Mesh { mesh, .. } => {
                let local = meshes[*mesh as usize].point_on(on);
                return to_render.transform_point3(local.as_dvec3()).as_vec3();
            }
        }
    }
    Vec3::ZERO
}

/// A hit of the slow search: parameter, path, triangle.
type Found = (f32, Vec<u32>, u32);

/// The closest hit by the scalar test on every triangle along every path.
fn brute_force(group: &InstanceBvh, meshes: &[Mesh], ray: &Ray, path: &mut Vec<u32>, best: &mut Option<Found>) {
    for (i, instance) in group.instances().iter().enumerate().filter(|(i, _)| !group.skipped().contains(&(*i as u32))) {
        path.push(i as u32);
        let inside = taken_into(ray, &instance.parent_from_child);
        match &instance.child {
            Child::Group(inner) => brute_force(inner, meshes, &inside, path, best),
            Child::Mesh { mesh, .. } => {
                let mesh = &meshes[*mesh as usize];
                let sound = (0..mesh.triangles.len()).filter(|&t| mesh.is_sound(t));
                if let Some((triangle, hit)) = mesh.brute_force(sound, &inside)
                    && best.as_ref().is_none_or(|b| (hit.t, &*path, triangle) < (b.0, &b.1, b.2))
                {
                    *best = Some((hit.t, path.clone(), triangle));
                }
            }
        }
        path.pop();
    }
}

fn check_ray(scene: &InstanceBvh, meshes: &[Mesh], ray: &Ray) {
    let first = scene.closest_hit_on(SimdLevel::Portable, ray);
    for &level in SimdLevel::available() {
        let got = scene.closest_hit_on(level, ray);
        assert_eq!(got, first, "{level:?} {ray:?}");
        assert_eq!(scene.any_hit_on(level, ray), first.is_some(), "{level:?} {ray:?} {first:?}");
    }
    let mut found = None;
    brute_force(scene, meshes, ray, &mut Vec::new(), &mut found);
    let got = first.map(|h| (h.t, h.path.as_slice().to_vec(), h.triangle));
    assert_eq!(got, found, "{ray:?}");
    let Some(hit) = first else { return };
    check_hit(&hit, ray);
    let inside = along(scene, &hit.path, ray);
    let [a, b, c] = meshes[hit.mesh as usize].vertices(hit.triangle as usize).expect("a triangle that is there");
    let again = ShearedRay::new(&inside).and_then(|r| r.intersect(a, b, c, ray.t_min.max(0.0), ray.t_max));
    let found = again.map(|h| bits(h.t, h.barycentrics));
    assert_eq!(found, Some(bits(hit.t, hit.barycentrics)), "{hit:?} {ray:?}");
    check_path(scene, &hit);
}

/// The ray in the space of what a path ends at, rounded at every level.
fn along(scene: &InstanceBvh, path: &InstancePath, ray: &Ray) -> Ray {
    let mut inside = *ray;
    for level in 0..path.as_slice().len() {
        let instance = scene.instance_at(path, level).expect("a path of the scene");
        inside = taken_into(&inside, &instance.parent_from_child);
    }
    inside
}

fn taken_into(ray: &Ray, parent_from_child: &DAffine3) -> Ray {
    if *parent_from_child == DAffine3::IDENTITY {
        return *ray;
    }
    let inverse = parent_from_child.inverse();
    let origin = inverse.transform_point3(ray.origin.0.as_dvec3()).as_vec3();
    let direction = inverse.transform_vector3(ray.direction.0.as_dvec3()).as_vec3();
    Ray { origin: Point3(origin), direction: Vector3(direction), ..*ray }
}

/// A hit's path leads to its mesh, through instances that were not skipped.
fn check_path(scene: &InstanceBvh, hit: &Hit) {
    let path = hit.path.as_slice();
    assert!((1..=MAX_DEPTH).contains(&path.len()) && !scene.skipped().contains(&path[0]), "{hit:?}");
    let last = scene.instance_at(&hit.path, path.len() - 1).map(|i| &i.child);
    assert!(matches!(last, Some(Child::Mesh { mesh, .. }) if *mesh == hit.mesh), "{hit:?}");
    assert!(scene.instance_at(&hit.path, path.len()).is_none());
    let levels = (0..path.len()).filter_map(|level| scene.instance_at(&hit.path, level));
    let composed = levels.fold(DAffine3::IDENTITY, |m, i| m * i.parent_from_child);
    let given = scene.render_from_object_double(&hit.path);
    let same = |(a, b): (f64, f64)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan();
    assert!(given.to_cols_array().into_iter().zip(composed.to_cols_array()).all(same), "{hit:?}");
    assert!(scene.render_from_object(&hit.path).forward().is_finite(), "{hit:?}");
}
