//! The methods that fail, as textbooks give them.

use umber_math::{Bounds3, Normal3, Point3, Ray, Vec3, Vector3};

/// The fixed epsilon of textbooks.
pub const EPSILON: f32 = 1e-6;
/// The fixed distance by which textbooks move rays off surfaces, in units.
pub const FIXED_OFFSET: f32 = 1e-4;

/// Where a ray meets a triangle (Möller and Trumbore 1997, "Fast, Minimum Storage Ray/Triangle Intersection"), with
/// a fixed epsilon.
pub fn moeller_trumbore([a, b, c]: [Point3; 3], ray: &Ray) -> Option<f32> {
    let (e1, e2, d) = (b.0 - a.0, c.0 - a.0, ray.direction.0);
    let h = d.cross(e2);
    let det = e1.dot(h);
    if det.abs() < EPSILON {
        return None;
    }
    let s = ray.origin.0 - a.0;
    let u = s.dot(h) / det;
    let q = s.cross(e1);
    let v = d.dot(q) / det;
    let t = e2.dot(q) / det;
    let inside = (0.0..=1.0).contains(&u) && v >= 0.0 && u + v <= 1.0;
    (inside && t > EPSILON).then_some(t)
}

/// Whether a ray meets a box: slabs in single precision, without a margin for their own rounding (Kay and Kajiya
/// 1986, "Ray Tracing Complex Scenes").
pub fn slabs(b: &Bounds3, ray: &Ray) -> bool {
    let inverse: Vec3 = ray.direction.0.recip();
    let (t0, t1) = ((b.min - ray.origin.0) * inverse, (b.max - ray.origin.0) * inverse);
    let (near, far) = (t0.min(t1).max_element(), t0.max(t1).min_element());
    near.max(0.0) <= far
}

/// A ray that leaves the point at `t` on another, moved by [`FIXED_OFFSET`] along a unit normal.
pub fn spawn(first: &Ray, t: f32, n: Normal3, direction: Vector3) -> Ray {
    Ray::new(Point3(first.at(t).0 + n.facing(direction).0 * FIXED_OFFSET), direction)
}
