//! Hits against the scalar test over all triangles, bit for bit, on every vector unit.

mod common;

use common::{Mesh, Random, answer, icosphere, ray_to, soup};
use umber_bvh::SimdLevel;
use umber_math::{Point3, Ray, Vec3, Vector3};

/// Traces rays of all sorts through a mesh of about unit size, scaled and moved.
fn compare(name: &str, mesh: &Mesh, scale: f32, offset: Vec3, count: usize, random: &mut Random) {
    let mesh = mesh.clone().map(|p| p * scale + offset);
    let scene = mesh.scene();
    let mut hits = 0;
    for i in 0..count {
        let ray = some_ray(i, &mesh, scale, offset, random);
        let want = mesh.brute_force(&ray);
        hits += usize::from(want.is_some());
        for &level in SimdLevel::available() {
            let got = scene.closest_hit_on(level, &ray);
            assert_eq!(answer(got), want, "{name}, {level:?}, ray {i}: {ray:?}");
            assert_eq!(scene.any_hit_on(level, &ray), want.is_some(), "{name}, any, {level:?}, ray {i}: {ray:?}");
            if let (Some(got), Some(first)) = (got, scene.closest_hit_on(SimdLevel::Portable, &ray)) {
                assert_eq!(got.barycentrics, first.barycentrics, "{name}, {level:?}, ray {i}");
            }
        }
    }
    assert!(hits * 20 > count, "{name}: only {hits} of {count} rays hit anything");
}

fn some_ray(i: usize, mesh: &Mesh, scale: f32, offset: Vec3, random: &mut Random) -> Ray {
    let from = random.cube() * 1.5 * scale + offset;
    let vertex = mesh.points[random.below(mesh.points.len())].0;
    let mut ray = match i % 5 {
        0 => ray_to(from, random.cube() * scale + offset),
        // Through a vertex, so that several triangles tie.
        1 => ray_to(from, vertex),
        // Along an axis, in the plane of a vertex: zero direction components, and boxes met edge on.
        2 => {
            let axis = Vec3::AXES[random.below(3)] * if random.float() < 0.5 { 1.0 } else { -1.0 };
            Ray::new(Point3(vertex - axis * 3.0 * scale), Vector3(axis))
        }
        // Along an edge of a triangle, seen from outside.
        3 => {
            let [a, b, _] = mesh.vertices(random.below(mesh.triangles.len()));
            Ray::new(Point3(from), Vector3((a.0 + b.0) * 0.5 - from))
        }
        _ => Ray::new(Point3(from), Vector3(random.direction())),
    };
    if i.is_multiple_of(7) {
        ray.t_min = random.float();
        ray.t_max = ray.t_min + random.float();
    }
    ray
}

#[test]
fn soups_from_one_triangle_to_thousands() {
    let mut random = Random(1);
    for count in [1, 2, 7, 8, 9, 33, 100, 1000, 5000] {
        let size = if count < 10 { 1.0 } else { 0.2 };
        compare(&format!("soup of {count}"), &soup(count, size, &mut random), 1.0, Vec3::ZERO, 2000, &mut random);
    }
}

#[test]
fn spheres_of_every_size_and_far_from_the_origin() {
    let (mesh, mut random) = (icosphere(3), Random(2));
    for scale in [1e-12, 1e-4, 1.0, 1e5, 1e12] {
        compare(&format!("sphere of {scale}"), &mesh, scale, Vec3::ZERO, 1000, &mut random);
    }
    for distance in [1e3, 1e5, 1e7] {
        let offset = Vec3::new(distance, -0.7 * distance, 0.3 * distance);
        compare(&format!("sphere at {distance}"), &mesh, 1.0 + distance * 1e-5, offset, 1000, &mut random);
    }
}

#[test]
fn degenerate_duplicate_and_sliver_triangles() {
    let mut random = Random(3);
    let mut mesh = soup(200, 0.3, &mut random);
    // Each again, so that every hit is a tie, and again shifted in order of corners.
    mesh.triangles.extend(mesh.triangles.clone());
    let turned: Vec<_> = mesh.triangles[..200].iter().map(|&[a, b, c]| [b, c, a]).collect();
    mesh.triangles.extend(turned);
    // Points and lines as triangles, and needles.
    mesh.triangles.extend((0..200).map(|i| [3 * i, 3 * i, 3 * i]));
    mesh.triangles.extend((0..200).map(|i| [3 * i, 3 * i + 1, 3 * i]));
    for i in 0..200 {
        let p = mesh.points[3 * i].0;
        mesh.points.push(Point3(p + Vec3::new(1e-6, 2e-6, -1e-6)));
        mesh.triangles.push([3 * i as u32, 3 * i as u32 + 1, mesh.points.len() as u32 - 1]);
    }
    compare("degenerate", &mesh, 1.0, Vec3::ZERO, 5000, &mut random);
}

#[test]
fn tiny_and_huge_triangles_together() {
    let mut random = Random(4);
    let mesh = icosphere(2).map(|p| p * 1e-4).with(&icosphere(1)).with(&soup(50, 1.0, &mut random).map(|p| p * 1e4));
    compare("sizes", &mesh, 1.0, Vec3::ZERO, 3000, &mut random);
}

#[test]
fn coplanar_grid_met_edge_on_and_flat() {
    let mut mesh = Mesh::default();
    for i in 0..20u32 {
        for j in 0..20u32 {
            mesh.points.push(Point3::new(i as f32 / 10.0 - 1.0, j as f32 / 10.0 - 1.0, 0.25));
            if i < 19 && j < 19 {
                let k = i * 20 + j;
                mesh.triangles.extend([[k, k + 20, k + 1], [k + 1, k + 20, k + 21]]);
            }
        }
    }
    compare("grid", &mesh, 1.0, Vec3::ZERO, 5000, &mut Random(5));
}

#[test]
fn thousands_of_copies_of_one_triangle() {
    let triangle = soup(1, 1.0, &mut Random(6));
    let mesh = Mesh { triangles: vec![triangle.triangles[0]; 20_000], ..triangle };
    let scene = mesh.scene();
    let [a, b, c] = mesh.vertices(0);
    let ray = ray_to(Vec3::splat(5.0), (a.0 + b.0 + c.0) / 3.0);
    assert_eq!(scene.closest_hit(&ray).map(|h| h.triangle), Some(0));
}
