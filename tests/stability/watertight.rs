//! No ray passes through a closed mesh, and none meets a surface twice, however it is aimed.

use umber_bench::stability::{
    DISTANCES, SCALES,
    closed::{Counts, Inside, from_inside, from_outside, textbook_hit, textbook_walk, walk},
    offset,
    shapes::{Mesh, cube, icosphere, ray_to},
};
use umber_math::Vec3;

use crate::rays;

/// Rays from inside by closest and by any hit, and from outside.
fn counts(mesh: &Mesh, inside: Inside, count: usize) -> [Counts; 3] {
    let scene = mesh.scene();
    [
        from_inside(mesh, inside, count, |r| scene.closest_hit(r).is_some()),
        from_inside(mesh, inside, count / 4, |r| scene.any_hit(r)),
        from_outside(mesh, inside, count / 2, |r, crossings| walk(mesh, &scene, r, crossings)),
    ]
}

fn hold(name: &str, mesh: &Mesh, inside: Inside, count: usize, most_doubles: u64) {
    for (way, counts) in ["out, closest", "out, any", "in and out"].iter().zip(counts(mesh, inside, count)) {
        println!("{name}: {way}: {counts:?}");
        assert!(counts.leaks == 0 && counts.doubles <= most_doubles, "{name}: {way}: {counts:?}");
    }
}

#[test]
fn edges_and_corners_hold_at_every_scale_and_distance() {
    let (count, sphere) = (rays(60_000), icosphere(5));
    for scale in SCALES {
        // Where the mesh is no bigger than the spacing of the numbers, there is no inside.
        for distance in DISTANCES.into_iter().filter(|d| scale >= d * 1e-5) {
            let center = offset(distance);
            let mesh = sphere.clone().map(|p| p * scale + center);
            let inside = Inside { center, half: Vec3::splat(scale * 0.5) };
            hold(&format!("scale {scale:e}, distance {distance:e}"), &mesh, inside, count, 0);
        }
    }
}

#[test]
fn slivers_hold() {
    for stretch in [Vec3::new(1e3, 1.0, 1e-3), Vec3::new(1e5, 1e-4, 1.0), Vec3::new(1.0, 1e5, 1e5)] {
        let mesh = icosphere(4).map(|p| p * stretch);
        let inside = Inside { center: Vec3::ZERO, half: stretch * 0.3 };
        // Rounding folds what is thinner than the place of its edges is known: still closed, but crossed more often.
        let count = rays(100_000);
        hold(&format!("stretched by {stretch}"), &mesh, inside, count, count as u64 / 20);
    }
}

#[test]
fn edges_met_exactly_are_crossed_once() {
    // Between points of a lattice, where rays meet edges, diagonals and vertices without any rounding.
    let mesh = cube();
    let scene = mesh.scene();
    let lattice = || (0..9).map(|i| i as f32 * 0.25 - 1.0);
    for axis in 0..3 {
        for (u, v) in lattice().flat_map(|u| lattice().map(move |v| (u, v))).filter(|(u, v)| u.abs().max(v.abs()) < 1.0)
        {
            for slant in [0.0, 0.0625] {
                let place = |h: f32, s: f32| {
                    let mut p = Vec3::ZERO;
                    (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (h, u + s * slant, v - s * slant);
                    p
                };
                let ray = ray_to(place(-3.0, -2.0), place(-1.0, 0.0));
                let mut crossings = Vec::new();
                walk(&mesh, &scene, &ray, &mut crossings);
                assert_eq!(crossings, [true, false], "{ray:?}");
            }
        }
    }
}

#[test]
fn degenerate_and_duplicate_faces_neither_leak_nor_hide() {
    let mut mesh = icosphere(3);
    let sound = mesh.triangles.clone();
    mesh.triangles.extend(sound.iter().map(|&[a, b, _]| [a, b, b]));
    mesh.triangles.extend(sound.iter().map(|&[a, ..]| [a; 3]));
    mesh.triangles.extend(&sound);
    let (scene, plain) = (mesh.scene(), Mesh { triangles: sound, ..mesh.clone() }.scene());
    let inside = Inside { center: Vec3::ZERO, half: Vec3::splat(0.3) };
    let counts = from_inside(&mesh, inside, rays(50_000), |r| {
        let (with, without) = (scene.closest_hit(r), plain.closest_hit(r));
        assert_eq!(with.map(|h| (h.t, h.triangle)), without.map(|h| (h.t, h.triangle)), "{r:?}");
        with.is_some()
    });
    assert_eq!(counts.leaks, 0);
}

#[test]
fn moeller_trumbore_leaks() {
    let count = rays(4_000).min(20_000);
    for (scale, distance, at_least) in [(1.0f32, 0.0f32, 1e-4), (1e-3, 0.0, 0.9), (1.0, 1e4, 1e-3)] {
        let center = offset(distance);
        let mesh = icosphere(2).map(|p| p * scale + center);
        let inside = Inside { center, half: Vec3::splat(scale * 0.5) };
        let out = from_inside(&mesh, inside, count, |r| textbook_hit(&mesh, r));
        let through = from_outside(&mesh, inside, count, |r, crossings| textbook_walk(&mesh, r, crossings));
        println!("Möller-Trumbore, scale {scale:e}, distance {distance:e}: {out:?}, through: {through:?}");
        let escaped = out.leaks as f64 / count as f64;
        assert!(escaped >= at_least, "scale {scale:e}, distance {distance:e}: only {escaped} escape");
    }
}
