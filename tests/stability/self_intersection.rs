//! Secondary rays: none meets the surface that it leaves, and none passes over one that is near.

use umber_bench::stability::{
    DISTANCES, SCALES, offset,
    placed::{Placed, Placement, placements},
    secondary::{Counts, has_inside, inwards, is_resolved, near_lid, outwards},
    shapes::{Mesh, cube, icosphere},
};
use umber_math::{DAffine3, Vec3};

use crate::rays;

const FLAT: Vec3 = Vec3::new(30.0, 1.0, 1e-3);

/// Closed convex meshes about the origin, with half-widths of their insides.
fn shapes() -> [(&'static str, Mesh, Vec3); 3] {
    let slivers = icosphere(3).map(|p| p * FLAT);
    [("sphere", icosphere(3), Vec3::ONE), ("slivers", slivers, FLAT), ("cube", cube(), Vec3::ONE)]
}

/// Distances of instances from the origin, and factors by which they are scaled.
const FAR: [f64; 4] = [0.0, 1e3, 1e5, 1e6];
const FACTORS: [f64; 4] = [1e-3, 1e-1, 10.0, 1e3];

fn everywhere(mut case: impl FnMut(&str, &Placement)) {
    for distance in FAR {
        for factor in FACTORS {
            for placement in placements(distance, factor) {
                case(&format!("{}, distance {distance:e}, scale {factor:e}", placement.name), &placement);
            }
        }
    }
}

fn none(name: &str, counts: Counts) {
    assert_eq!((counts.own, counts.wrong), (0, 0), "{name}: {counts:?}");
}

#[test]
fn no_ray_meets_the_triangle_that_it_leaves() {
    let count = rays(6_000);
    let mut textbook = 0;
    for (shape, mesh, _) in shapes() {
        for scale in SCALES {
            for distance in DISTANCES.into_iter().filter(|d| scale >= d * 1e-4) {
                let placed = Placed::new(mesh.clone().map(|p| p * scale + offset(distance)), &[DAffine3::IDENTITY]);
                let counts = outwards(&placed, count);
                println!("{shape}, scale {scale:e}, distance {distance:e}: {counts:?}");
                assert_eq!(counts.own, 0, "{shape}, scale {scale:e}, distance {distance:e}");
                // Rounded corners make what is thin no longer convex.
                assert!(counts.wrong == 0 || !has_inside(&placed), "{shape}, {scale:e}, {distance:e}: {counts:?}");
                textbook += counts.textbook;
            }
        }
    }
    assert!(textbook > count as u64, "the fixed offset failed only {textbook} times");
}

#[test]
fn no_ray_meets_the_instance_that_it_leaves() {
    let count = rays(2_000);
    let mut textbook = 0;
    for (shape, mesh, _) in shapes() {
        everywhere(|place, placement| {
            let placed = Placed::new(mesh.clone(), &placement.transforms);
            if is_resolved(&placed) {
                let counts = outwards(&placed, count);
                println!("{shape}, {place}: {counts:?}");
                none(&format!("{shape}, {place}"), counts);
                textbook += counts.textbook;
            }
        });
    }
    assert!(textbook > count as u64, "the fixed offset failed only {textbook} times");
}

#[test]
fn no_ray_slips_out_where_surfaces_meet() {
    let count = rays(4_000);
    for (shape, mesh, half) in shapes() {
        // At a rim of a hundredth of a right angle or less, the other side is nearer than a point's own rounding.
        let few = |allowed: bool| if allowed { count as u64 / 80 } else { 0 };
        for scale in SCALES {
            for distance in DISTANCES.into_iter().filter(|d| scale * half.min_element() >= d * 1e-4) {
                let placed = Placed::new(mesh.clone().map(|p| p * scale + offset(distance)), &[DAffine3::IDENTITY]);
                let counts = inwards(&placed, half * scale, count);
                println!("inside {shape}, scale {scale:e}, distance {distance:e}: {counts:?}");
                assert_eq!(counts.own, 0, "inside {shape}, scale {scale:e}, distance {distance:e}");
                assert!(counts.wrong <= few(shape == "slivers"), "{shape}, {scale:e}, {distance:e}: {counts:?}");
            }
        }
        everywhere(|place, placement| {
            let placed = Placed::new(mesh.clone(), &placement.transforms);
            if has_inside(&placed) {
                let counts = inwards(&placed, half, count / 4);
                println!("inside {shape}, {place}: {counts:?}");
                assert_eq!(counts.own, 0, "inside {shape}, {place}");
                let thin = shape == "slivers" || placement.name == "flattened";
                assert!(counts.wrong <= few(thin), "inside {shape}, {place}: {counts:?}");
            }
        });
    }
}

#[test]
fn no_ray_passes_over_a_near_surface() {
    let count = rays(1_000);
    let (mut places, mut textbook) = (0, 0);
    for center in [Vec3::ZERO, Vec3::new(0.3, 0.7, -0.4), Vec3::new(-900.0, 500.0, 70.0)] {
        everywhere(|place, placement| {
            if let Some(counts) = near_lid(&placement.transforms, center, count) {
                println!("center {center}, {place}: {counts:?}");
                none(&format!("center {center}, {place}"), counts);
                (places, textbook) = (places + 1, textbook + counts.textbook);
            }
        });
    }
    assert!(places > 100, "only {places} places");
    assert!(textbook > count as u64 * places / 10, "the fixed offset failed only {textbook} times");
}
