//! Triangles of any size at any distance from the origin.

use umber_geometry::watertight::ShearedRay;
use umber_math::{DVec3, Point3, Ray, Vec3};

use super::{
    shapes::{Mesh, ray_to},
    tally,
    textbook::moeller_trumbore,
};

/// Rays aimed well inside of triangles.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    /// Rays.
    pub rays: u64,
    /// Rays that missed, by Umber's test.
    pub missed: u64,
    /// Hits of Umber's test whose parameter is off by more than [`WORST`]; the triangle is at 1.
    pub off: u64,
    /// Rays that missed, by the textbook's test.
    pub textbook_missed: u64,
}

/// Largest error of the parameter of a hit, in parts.
pub const WORST: f64 = 1e-5;

/// The parameter where a ray meets a triangle's plane, in double precision.
fn exact([a, b, c]: [Point3; 3], ray: &Ray) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| p.0.as_dvec3());
    let (o, d): (DVec3, DVec3) = (ray.origin.0.as_dvec3(), ray.direction.0.as_dvec3());
    let n = (b - a).cross(c - a);
    n.dot(a - o) / n.dot(d)
}

/// Triangles of a size at a distance from the origin, both in units, seen from ten times their size.
pub fn at(size: f32, distance: f32, count: usize) -> Counts {
    let [rays, missed, off, textbook_missed] = tally(count, 0x0ff5_e700, |random, _| {
        let center = random.direction() * distance;
        let corners = [0; 3].map(|_| Point3(center + random.cube() * size));
        let [a, b, c] = corners;
        let normal = (b - a).0.cross((c - a).0);
        let target = (a.0 + b.0 + c.0) / 3.0;
        // Shapes that collapsed to lines, and views along the plane, are other cases.
        let view = random.direction() * size * 10.0;
        if normal.length() < 0.1 * size * size || normal.normalize().dot(view.normalize()).abs() < 0.2 {
            return [0; 4];
        }
        let ray = ray_to(target + view, target);
        let ours = ShearedRay::new(&ray).and_then(|r| r.intersect(a, b, c, 0.0, f32::INFINITY));
        let off = ours.is_some_and(|h| (f64::from(h.t) - exact(corners, &ray)).abs() > WORST);
        let textbook = moeller_trumbore(corners, &ray);
        [1, u64::from(ours.is_none()), u64::from(off), u64::from(textbook.is_none())]
    });
    Counts { rays, missed, off, textbook_missed }
}

/// A triangle of 10⁻⁴ units, 10⁻³ over a floor of 10⁵, seen from above: how often it is not what is seen. By Umber's
/// method and by the textbook's.
pub fn tiny_over_huge(count: usize) -> [u64; 2] {
    let floor = [Vec3::new(-1e5, 0.0, -1e5), Vec3::new(1e5, 0.0, -1e5), Vec3::new(0.0, 0.0, 1e5)].map(Point3);
    tally(count, 0x7175_7175, |random, _| {
        let at = Vec3::new(random.cube().x, 0.0, random.cube().z) * 100.0 + Vec3::Y * 1e-3;
        let tiny = [Vec3::ZERO, Vec3::new(1e-4, 0.0, 0.0), Vec3::new(0.0, 0.0, 1e-4)].map(|p| Point3(at + p));
        let points = floor.into_iter().chain(tiny).collect();
        let mesh = Mesh { points, triangles: vec![[0, 1, 2], [3, 4, 5]] };
        let inside = (tiny[0].0 + tiny[1].0 + tiny[2].0) / 3.0;
        let ray = ray_to(inside + Vec3::new(0.3, 1.0, 0.2), inside);
        let ours = mesh.scene().closest_hit(&ray).is_none_or(|h| h.triangle != 1);
        let nearest = |i: usize| moeller_trumbore(mesh.corners(i), &ray).unwrap_or(f32::INFINITY);
        [u64::from(ours), u64::from(nearest(1) >= nearest(0))]
    })
}
