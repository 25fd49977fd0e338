//! One mesh: built, traced, refitted, and traced again.

use std::sync::Arc;

use arbitrary::Arbitrary;
use umber_bvh::{Child, Instance, InstanceBvh, MeshBvh, SimdLevel};
use umber_math::{Bounds3, DAffine3, Ray, Vec3};

use super::{
    scene::{Mesh, MeshInput, RayInput, bits, check_hit},
    values::Triple,
};

/// Most rays that are traced.
const MAX_RAYS: usize = 16;

/// What is checked.
#[derive(Arbitrary, Debug)]
pub struct Input {
    mesh: MeshInput,
    /// Where points are moved to, from the first on.
    moved: Vec<Triple>,
    /// Number of points that are gone when it is refitted.
    gone: u8,
    rays: Vec<RayInput>,
}

/// Hits are those of the scalar test on every triangle, bit for bit, on every vector unit; also when refitted.
pub fn check(input: Input) {
    let mesh = input.mesh.mesh();
    let mut built = MeshBvh::build(&mesh.points, &mesh.triangles);
    let sound: Vec<usize> = (0..mesh.triangles.len()).filter(|&i| mesh.is_sound(i)).collect();
    assert_eq!((built.triangle_count(), built.skipped()), (sound.len(), mesh.triangles.len() - sound.len()));
    check_bounds(&built, &mesh, &sound);
    compare(&built, &mesh, &sound, &input.rays);

    let mut moved = mesh;
    moved.points.iter_mut().zip(&input.moved).for_each(|(p, to)| *p = to.point());
    if !input.moved.is_empty() {
        moved.points.truncate(moved.points.len().saturating_sub(usize::from(input.gone % 8)));
    }
    built.refit(&moved.points, &moved.triangles);
    compare(&built, &moved, &sound, &input.rays);
}

/// The box of a hierarchy holds its triangles, and not much more.
fn check_bounds(built: &MeshBvh, mesh: &Mesh, sound: &[usize]) {
    let points = sound.iter().filter_map(|&i| mesh.vertices(i)).flatten();
    let (got, want) = (built.bounds(), Bounds3::of_points(points));
    assert_eq!(got.union(want), got);
    assert!(want.is_empty() || got.min.is_finite() && got.max.is_finite());
    let reach = want.min.abs().max(want.max.abs()).max_element() * 1e-5 + f32::MIN_POSITIVE;
    let close = |a: Vec3, b: Vec3| (a - b).abs().max_element() <= reach;
    assert!(
        want.is_empty() && got.is_empty() || close(got.min, want.min) && close(got.max, want.max),
        "{got:?} {want:?}"
    );
}

fn compare(built: &MeshBvh, mesh: &Mesh, built_with: &[usize], rays: &[RayInput]) {
    let child = Child::Mesh { bvh: Arc::new(built.clone()), mesh: 7 };
    let scene = InstanceBvh::build(vec![Instance { child, parent_from_child: DAffine3::IDENTITY, tag: 0 }]);
    for ray in rays.iter().take(MAX_RAYS) {
        let ray = ray.ray(|on| mesh.point_on(on));
        let want = mesh.brute_force(built_with.iter().copied(), &ray);
        for &level in SimdLevel::available() {
            compare_ray(&scene, level, &ray, want.map(|(i, hit)| (i, bits(hit.t, hit.barycentrics))));
        }
    }
}

fn compare_ray(scene: &InstanceBvh, level: SimdLevel, ray: &Ray, want: Option<(u32, [u32; 4])>) {
    let got = scene.closest_hit_on(level, ray);
    assert_eq!(got.map(|h| (h.triangle, bits(h.t, h.barycentrics))), want, "{level:?} {got:?} {ray:?}");
    assert_eq!(scene.any_hit_on(level, ray), want.is_some(), "{level:?} {ray:?}");
    if let Some(hit) = got {
        check_hit(&hit, ray);
        assert_eq!((hit.mesh, hit.path.as_slice()), (7, &[0][..]));
    }
}
