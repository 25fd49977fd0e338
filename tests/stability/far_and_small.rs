//! Accuracy of hits far from the origin, and with tiny and huge triangles together.

use umber_geometry::watertight::ShearedRay;
use umber_math::{DVec3, Point3, Ray, Vec3};

use crate::meshes::{Random, ray_to};
use crate::rays;
use crate::textbook::moeller_trumbore;

/// The parameter where a ray meets a triangle's plane, in double precision.
fn exact([a, b, c]: [Point3; 3], ray: &Ray) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| p.0.as_dvec3());
    let (o, d): (DVec3, DVec3) = (ray.origin.0.as_dvec3(), ray.direction.0.as_dvec3());
    let n = (b - a).cross(c - a);
    n.dot(a - o) / n.dot(d)
}

/// What a test makes of rays aimed well inside of triangles.
#[derive(Debug, Default)]
struct Tally {
    missed: usize,
    /// Largest error of `t`, which is 1 at the triangle.
    worst: f64,
}

impl Tally {
    fn add(&mut self, found: Option<f32>, exact: f64) {
        match found {
            None => self.missed += 1,
            Some(t) => self.worst = self.worst.max((f64::from(t) - exact).abs()),
        }
    }
}

/// Triangles of a size at a distance, seen from ten times their size; ours and the textbook's tally.
fn tallies(size: f32, distance: f32, count: usize) -> [Tally; 2] {
    let mut random = Random(0x0ff5_e700_0f5e_7001);
    let mut tallies = [Tally::default(), Tally::default()];
    for _ in 0..count {
        let center = random.direction() * distance;
        let corners = [0; 3].map(|_| Point3(center + random.cube() * size));
        let [a, b, c] = corners;
        let normal = (b - a).0.cross((c - a).0);
        let target = Point3((a.0 + b.0 + c.0) / 3.0);
        // Shapes that collapsed to lines, and views along the plane, are other tests'.
        let view = random.direction() * size * 10.0;
        if normal.length() < 0.1 * size * size || normal.normalize().dot(view.normalize()).abs() < 0.2 {
            continue;
        }
        let ray = ray_to(target.0 + view, target.0);
        let ours = ShearedRay::new(&ray).and_then(|r| r.intersect(a, b, c, 0.0, f32::INFINITY));
        tallies[0].add(ours.map(|h| h.t), exact(corners, &ray));
        tallies[1].add(moeller_trumbore(corners, &ray), exact(corners, &ray));
    }
    tallies
}

#[test]
fn no_triangle_is_too_small_or_too_far() {
    let count = rays(20_000);
    let mut textbook_missed = 0;
    for size in [1e-4f32, 1e-2, 1.0, 1e2, 1e5] {
        for distance in [0.0f32, 1e3, 1e5, 1e7] {
            // Corners a thousand spacings apart at least.
            if size < distance * 1e-4 {
                continue;
            }
            let [ours, textbook] = tallies(size, distance, count);
            println!(
                "size {size:e}, distance {distance:e}: missed {}, off by {:.1e}; textbook {}, {:.1e}",
                ours.missed, ours.worst, textbook.missed, textbook.worst
            );
            assert_eq!(ours.missed, 0, "size {size:e}, distance {distance:e}");
            assert!(ours.worst < 1e-5, "size {size:e}, distance {distance:e}: {ours:?}");
            textbook_missed += textbook.missed;
        }
    }
    assert!(textbook_missed > count / 4, "the textbook's test missed only {textbook_missed}");
}

#[test]
fn tiny_and_huge_triangles_together() {
    // A tiny triangle 10⁻³ over a floor of 10⁵: it is what is seen from above.
    let mut random = Random(0x7175_7175_1234_4321);
    let (mut ours, mut textbook) = (0, 0);
    let count = rays(20_000);
    let floor = [Vec3::new(-1e5, 0.0, -1e5), Vec3::new(1e5, 0.0, -1e5), Vec3::new(0.0, 0.0, 1e5)].map(Point3);
    for _ in 0..count {
        let at = Vec3::new(random.cube().x, 0.0, random.cube().z) * 100.0 + Vec3::Y * 1e-3;
        let tiny = [Vec3::ZERO, Vec3::new(1e-4, 0.0, 0.0), Vec3::new(0.0, 0.0, 1e-4)].map(|p| Point3(at + p));
        let mesh = crate::meshes::Mesh {
            points: floor.into_iter().chain(tiny).collect(),
            triangles: vec![[0, 1, 2], [3, 4, 5]],
        };
        let inside = (tiny[0].0 + tiny[1].0 + tiny[2].0) / 3.0;
        let ray = ray_to(inside + Vec3::new(0.3, 1.0, 0.2), inside);
        ours += usize::from(mesh.scene().closest_hit(&ray).is_none_or(|h| h.triangle != 1));
        let nearest = |i: usize| moeller_trumbore(mesh.corners(i), &ray).unwrap_or(f32::INFINITY);
        textbook += usize::from(nearest(1) >= nearest(0));
    }
    println!("tiny over huge: {ours} of {count} wrong, textbook {textbook}");
    assert_eq!(ours, 0);
    assert!(textbook > count / 2, "the textbook's test was wrong only {textbook} times");
}
