//! Secondary rays: none meets the surface that it leaves, and none passes over one that is near.
//!
//! Rays leave as the renderer lets them: from [`hit_point`], moved by [`offset_ray_origin`].

use umber_bvh::{Hit, InstanceBvh};
use umber_geometry::{geometric_normal, watertight::hit_point};
use umber_math::{Point3, Ray, Vec3, Vector3, float::offset_ray_origin};

use crate::meshes::{Mesh, Random, cube, icosphere, ray_to};
use crate::rays;
use crate::textbook::{FIXED_OFFSET, moeller_trumbore};

/// A ray that leaves a hit to the side that `seen_from` is on, as the renderer spawns it.
fn spawn(mesh: &Mesh, hit: &Hit, direction: Vec3) -> Ray {
    let [a, b, c] = mesh.corners(hit.triangle as usize);
    let (point, error) = hit_point(a, b, c, hit.barycentrics);
    let direction = Vector3(direction);
    Ray::new(offset_ray_origin(point, error, geometric_normal(a, b, c), direction), direction)
}

/// The same with a fixed offset along the normal, as textbooks give it.
fn spawn_fixed(mesh: &Mesh, first: &Ray, t: f32, triangle: u32, direction: Vec3) -> Ray {
    let [a, b, c] = mesh.corners(triangle as usize);
    let n = geometric_normal(a, b, c).facing(Vector3(direction));
    Ray::new(Point3(first.at(t).0 + n.0 * FIXED_OFFSET), Vector3(direction))
}

/// A direction on the side of a triangle's plane that `toward` is on; one in four at a grazing angle.
fn leaving([a, b, c]: [Point3; 3], toward: Vec3, random: &mut Random) -> Vec3 {
    let n = geometric_normal(a, b, c).facing(Vector3(toward)).0;
    let grazing = if random.below(4) == 0 { 1e-3 } else { 1.0 };
    let d = random.direction();
    let (height, along) = (d.dot(n), d - n * d.dot(n));
    (along + n * height.abs().max(1e-2) * grazing).normalize()
}

/// Rays that leave a convex mesh outwards and meet it again: on the same triangle, and on any; of `count`.
fn again(mesh: &Mesh, center: Vec3, size: f32, count: usize) -> [usize; 3] {
    let scene = mesh.scene();
    let mut random = Random(0x0dd_ba11_5eed);
    let (mut own, mut any, mut fixed) = (0, 0, 0);
    for i in 0..count {
        let corners = mesh.corners(random.below(mesh.triangles.len()));
        let target = random.point_of(corners, i.is_multiple_of(3));
        let first = ray_to(center + random.direction() * size * 4.0, target);
        let Some(hit) = scene.closest_hit(&first) else { continue };
        let [a, b, c] = mesh.corners(hit.triangle as usize);
        // At a silhouette edge the triangle behind it may be met, from inside.
        let n = geometric_normal(a, b, c).0;
        if n.dot((a.0 + b.0 + c.0) / 3.0 - center) * n.dot(first.direction.0) >= 0.0 {
            continue;
        }
        let direction = leaving([a, b, c], -first.direction.0, &mut random);
        if let Some(second) = scene.closest_hit(&spawn(mesh, &hit, direction)) {
            any += 1;
            own += usize::from(second.triangle == hit.triangle);
        }
        let ray = spawn_fixed(mesh, &first, hit.t, hit.triangle, direction);
        fixed += usize::from(moeller_trumbore(mesh.corners(hit.triangle as usize), &ray).is_some());
    }
    [own, any, fixed]
}

#[test]
fn no_ray_meets_the_triangle_that_it_leaves() {
    let count = rays(10_000);
    let shapes =
        [("sphere", icosphere(3)), ("slivers", icosphere(3).map(|p| p * Vec3::new(30.0, 1.0, 1e-3))), ("cube", cube())];
    let mut fixed_failures = 0;
    for (name, shape) in &shapes {
        for scale in [1e-4f32, 1e-2, 1.0, 1e2, 1e5] {
            for distance in [0.0f32, 1e3, 1e5, 1e7] {
                if scale < distance * 1e-4 {
                    continue;
                }
                let center = Vec3::new(1.0, -0.7, 0.4) * distance;
                let mesh = shape.clone().map(|p| p * scale + center);
                let [own, any, fixed] = again(&mesh, center, scale, count);
                println!(
                    "{name}, scale {scale:e}, distance {distance:e}: {own} of {count} meet their own triangle, {any} any; fixed offset {fixed}"
                );
                assert_eq!(own, 0, "{name}, scale {scale:e}, distance {distance:e}");
                assert_eq!(any, 0, "{name}, scale {scale:e}, distance {distance:e}");
                fixed_failures += fixed;
            }
        }
    }
    assert!(fixed_failures > count, "the fixed offset failed only {fixed_failures} times");
}

/// Rays that leave the inside of a closed mesh, from near its edges, and escape; of `count`.
fn escapes(mesh: &Mesh, center: Vec3, size: Vec3, count: usize) -> usize {
    let scene = mesh.scene();
    let mut random = Random(0x00c0_ffee_5eed);
    let mut escaped = 0;
    for i in 0..count {
        let corners = mesh.corners(random.below(mesh.triangles.len()));
        let first = ray_to(center + random.cube() * size * 0.3, random.point_of(corners, i.is_multiple_of(2)));
        let Some(hit) = scene.closest_hit(&first) else { continue };
        let direction = leaving(mesh.corners(hit.triangle as usize), -first.direction.0, &mut random);
        escaped += usize::from(!scene.any_hit(&spawn(mesh, &hit, direction)));
    }
    escaped
}

#[test]
fn no_ray_slips_out_where_surfaces_meet() {
    let count = rays(20_000);
    let flat = Vec3::new(30.0, 1.0, 1e-3);
    for (name, shape, size) in [
        ("sphere", icosphere(3), Vec3::ONE),
        ("slivers", icosphere(3).map(|p| p * flat), flat),
        ("cube", cube(), Vec3::ONE),
    ] {
        for scale in [1e-4f32, 1.0, 1e5] {
            for distance in [0.0f32, 1e3, 1e7] {
                if scale * size.min_element() < distance * 1e-4 {
                    continue;
                }
                let center = Vec3::new(1.0, -0.7, 0.4) * distance;
                let mesh = shape.clone().map(|p| p * scale + center);
                let escaped = escapes(&mesh, center, size * scale, count);
                println!("inside {name}, scale {scale:e}, distance {distance:e}: {escaped} of {count} escape");
                // At the rim of what is thinner than the place of its edges is known, there is no inside.
                let most = if name == "slivers" { count / 100 } else { 0 };
                assert!(escaped <= most, "{name}, scale {scale:e}, distance {distance:e}: {escaped}");
            }
        }
    }
}

/// A floor of this half-width, tilted, with a lid over it, and the gap between them.
fn floor_and_lid(size: f32, tilt: f32, center: Vec3, gap: f32) -> (Mesh, Vec3) {
    let up = Vec3::new(tilt, 1.0, 0.3 * tilt).normalize();
    let (x, z) = (up.cross(Vec3::Z).normalize(), Vec3::X.cross(up).normalize());
    let square = |at: Vec3, s: f32| [at - x * s - z * s, at + x * s - z * s, at + x * s * 0.1 + z * s].map(Point3);
    let mesh = Mesh {
        points: square(center, size).into_iter().chain(square(center + up * gap, size * 2.0)).collect(),
        triangles: vec![[0, 1, 2], [3, 4, 5]],
    };
    (mesh, up)
}

/// Of `count` rays that leave a floor upwards, those that pass over a lid at this gap; by us, and with a
/// fixed offset.
fn skipped(size: f32, tilt: f32, center: Vec3, gap: f32, count: usize) -> [usize; 2] {
    let (mesh, up) = floor_and_lid(size, tilt, center, gap);
    let floor = Mesh { triangles: vec![[0, 1, 2]], ..mesh.clone() };
    let (scene, below): (InstanceBvh, InstanceBvh) = (mesh.scene(), floor.scene());
    let mut random = Random(0x5caf_f01d_0f11);
    let mut lost = [0; 2];
    for _ in 0..count {
        let target = center + (random.point_of(floor.corners(0), false) - center) * 0.01;
        let first = ray_to(target + up * size + random.cube() * size * 0.1, target);
        let Some(hit) = below.closest_hit(&first) else { continue };
        let direction = (up + random.direction() * 0.5).normalize();
        lost[0] += usize::from(!scene.any_hit(&spawn(&mesh, &hit, direction)));
        let fixed = spawn_fixed(&mesh, &first, hit.t, hit.triangle, direction);
        lost[1] += usize::from(moeller_trumbore(mesh.corners(1), &fixed).is_none());
    }
    lost
}

#[test]
fn no_ray_passes_over_a_near_surface() {
    let count = rays(2_000);
    let mut fixed_failures = 0;
    for size in [1e-4f32, 1.0, 1e2, 1e5] {
        for distance in [0.0f32, 1e3, 1e5, 1e7] {
            for tilt in [0.0, 0.3] {
                if size < distance * 1e-4 {
                    continue;
                }
                let center = Vec3::new(1.0, -0.7, 0.4) * distance;
                // Eight spacings of the numbers where the surfaces are: what their own corners are off by.
                let reach = if tilt == 0.0 { center.abs().max_element() } else { size.max(center.abs().max_element()) };
                let gap = (reach * f32::EPSILON * 8.0).max(size * 1e-7);
                let [lost, fixed] = skipped(size, tilt, center, gap, count);
                println!(
                    "size {size:e}, distance {distance:e}, tilt {tilt}, gap {gap:.1e}: {lost} of {count} pass over; fixed offset {fixed}"
                );
                assert_eq!(lost, 0, "size {size:e}, distance {distance:e}, tilt {tilt}, gap {gap:e}");
                fixed_failures += fixed;
            }
        }
    }
    assert!(fixed_failures > count, "the fixed offset failed only {fixed_failures} times");
}
