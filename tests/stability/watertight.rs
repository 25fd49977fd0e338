//! No ray from inside a closed mesh escapes, however it is aimed.

use umber_math::{Ray, Vec3};

use crate::meshes::{Mesh, Random, icosphere, ray_to};
use crate::rays;
use crate::textbook::moeller_trumbore;

/// Of `count` rays from inside, aimed at edges and corners, those that escape.
fn leaks(mesh: &Mesh, inside: Vec3, spread: Vec3, count: usize, hit: impl Fn(&Ray) -> bool) -> usize {
    let mut random = Random(0x1dea_5eed_0bad_cafe);
    let mut escapes = |i: usize| {
        let corners = mesh.corners(random.below(mesh.triangles.len()));
        let target = if i.is_multiple_of(4) { corners[0].0 } else { random.point_of(corners, true) };
        !hit(&ray_to(inside + random.cube() * spread, target))
    };
    (0..count).filter(|&i| escapes(i)).count()
}

#[test]
fn edges_and_corners_hold_at_every_scale_and_distance() {
    let count = rays(100_000);
    let sphere = icosphere(5);
    for scale in [1e-4f32, 1e-2, 1.0, 1e2, 1e5] {
        for distance in [0.0f32, 1e3, 1e5, 1e7] {
            let offset = Vec3::new(1.0, -0.7, 0.4) * distance;
            // Where the mesh is no bigger than the spacing of the numbers, there is no inside.
            if scale < distance * 1e-5 {
                continue;
            }
            let mesh = sphere.clone().map(|p| p * scale + offset);
            let scene = mesh.scene();
            let spread = Vec3::splat(scale * 0.5);
            let closest = leaks(&mesh, offset, spread, count, |r| scene.closest_hit(r).is_some());
            let any = leaks(&mesh, offset, spread, count / 4, |r| scene.any_hit(r));
            println!("scale {scale:e}, distance {distance:e}: {closest} of {count} escape, any hit {any}");
            assert_eq!((closest, any), (0, 0), "scale {scale:e}, distance {distance:e}");
        }
    }
}

#[test]
fn slivers_hold() {
    let count = rays(100_000);
    for stretch in [Vec3::new(1e3, 1.0, 1e-3), Vec3::new(1e5, 1e-4, 1.0), Vec3::new(1.0, 1e5, 1e5)] {
        let mesh = icosphere(4).map(|p| p * stretch);
        let scene = mesh.scene();
        let escaped = leaks(&mesh, Vec3::ZERO, stretch * 0.3, count, |r| scene.closest_hit(r).is_some());
        println!("stretched by {stretch}: {escaped} of {count} escape");
        assert_eq!(escaped, 0, "{stretch}");
    }
}

#[test]
fn degenerate_and_duplicate_faces_neither_leak_nor_hide() {
    let count = rays(50_000);
    let mut mesh = icosphere(3);
    let sound = mesh.triangles.clone();
    mesh.triangles.extend(sound.iter().map(|&[a, b, _]| [a, b, b]));
    mesh.triangles.extend(sound.iter().map(|&[a, ..]| [a; 3]));
    mesh.triangles.extend(&sound);
    let (scene, plain) = (mesh.scene(), Mesh { triangles: sound, ..mesh.clone() }.scene());
    let escaped = leaks(&mesh, Vec3::ZERO, Vec3::splat(0.3), count, |r| {
        let (with, without) = (scene.closest_hit(r), plain.closest_hit(r));
        assert_eq!(with.map(|h| (h.t, h.triangle)), without.map(|h| (h.t, h.triangle)), "{r:?}");
        with.is_some()
    });
    assert_eq!(escaped, 0);
}

#[test]
fn moeller_trumbore_leaks() {
    let count = rays(4_000).min(20_000);
    for (scale, distance, at_least) in [(1.0f32, 0.0f32, 1e-4), (1e-3, 0.0, 0.9), (1.0, 1e4, 1e-3)] {
        let offset = Vec3::new(1.0, -0.7, 0.4) * distance;
        let mesh = icosphere(2).map(|p| p * scale + offset);
        let textbook = |r: &Ray| (0..mesh.triangles.len()).any(|i| moeller_trumbore(mesh.corners(i), r).is_some());
        let escaped = leaks(&mesh, offset, Vec3::splat(scale * 0.5), count, textbook) as f64 / count as f64;
        println!("Möller-Trumbore, scale {scale:e}, distance {distance:e}: {:.3} % escape", 100.0 * escaped);
        assert!(escaped >= at_least, "scale {scale:e}, distance {distance:e}: only {escaped} escape");
    }
}
