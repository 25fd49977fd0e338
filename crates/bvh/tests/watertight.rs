//! No ray from inside a closed mesh escapes, however it is aimed.

mod common;

use common::{Mesh, Random, icosphere, ray_to};
use umber_bvh::SimdLevel;
use umber_math::{Ray, Vec3};

/// Number of rays that escape; each is aimed at a vertex or an edge.
fn leaks(
    mesh: &Mesh,
    inside: Vec3,
    spread: f32,
    count: usize,
    random: &mut Random,
    hit: impl Fn(&Ray) -> bool,
) -> usize {
    let escaped = |i: usize, random: &mut Random| {
        let [a, b, _] = mesh.vertices(random.below(mesh.triangles.len())).map(|p| p.0);
        let target = if i.is_multiple_of(4) { a } else { a + (b - a) * random.float() };
        !hit(&ray_to(inside + random.cube() * spread, target))
    };
    (0..count).filter(|&i| escaped(i, random)).count()
}

#[test]
fn a_million_rays_at_edges_and_vertices_stay_inside() {
    let mut random = Random(11);
    let sphere = icosphere(5);
    let cases = [
        ("unit", 1.0, Vec3::ZERO),
        ("small", 1e-4, Vec3::ZERO),
        ("large", 1e5, Vec3::ZERO),
        ("far", 1.0, Vec3::new(1e3, -2e3, 5e2)),
        ("farther", 1e3, Vec3::new(1e6, 1e6, -3e6)),
        ("farthest", 1e4, Vec3::splat(1e7)),
    ];
    for (name, scale, offset) in cases {
        let mesh = sphere.clone().map(|p| p * scale + offset);
        let scene = mesh.scene();
        let closest = leaks(&mesh, offset, scale * 0.5, 200_000, &mut random, |r| scene.closest_hit(r).is_some());
        let any = leaks(&mesh, offset, scale * 0.5, 50_000, &mut random, |r| scene.any_hit(r));
        assert_eq!((closest, any), (0, 0), "{name}");
    }
}

#[test]
fn stretched_spheres_of_slivers_stay_closed_on_every_unit() {
    let mut random = Random(12);
    let mesh = icosphere(4).map(|p| p * Vec3::new(1e3, 1.0, 1e-3));
    let scene = mesh.scene();
    for &level in SimdLevel::available() {
        let found = leaks(&mesh, Vec3::ZERO, 0.0, 100_000, &mut random, |r| scene.closest_hit_on(level, r).is_some());
        assert_eq!(found, 0, "{level:?}");
    }
}

/// Möller and Trumbore 1997 with the fixed epsilon that textbooks give it.
fn moeller_trumbore(mesh: &Mesh, ray: &Ray) -> bool {
    const EPSILON: f32 = 1e-6;
    (0..mesh.triangles.len()).any(|i| {
        let [a, b, c] = mesh.vertices(i).map(|p| p.0);
        let (e1, e2, d) = (b - a, c - a, ray.direction.0);
        let h = d.cross(e2);
        let det = e1.dot(h);
        if det.abs() < EPSILON {
            return false;
        }
        let s = ray.origin.0 - a;
        let u = s.dot(h) / det;
        let q = s.cross(e1);
        let v = d.dot(q) / det;
        (0.0..=1.0).contains(&u) && v >= 0.0 && u + v <= 1.0 && e2.dot(q) / det > EPSILON
    })
}

#[test]
fn the_textbook_test_leaks_where_this_one_does_not() {
    let mut random = Random(13);
    // At a size of 10⁻³ its epsilon passes for an area, and nothing is hit at all.
    for (scale, at_least) in [(1.0, 1), (1e-3, 1900)] {
        let mesh = icosphere(2).map(|p| p * scale);
        let scene = mesh.scene();
        let textbook = leaks(&mesh, Vec3::ZERO, scale * 0.5, 2000, &mut random, |r| moeller_trumbore(&mesh, r));
        let ours = leaks(&mesh, Vec3::ZERO, scale * 0.5, 2000, &mut random, |r| scene.any_hit(r));
        assert_eq!(ours, 0, "scale {scale}");
        assert!(textbook >= at_least, "scale {scale}: the textbook's test lost only {textbook} of 2000");
    }
}
