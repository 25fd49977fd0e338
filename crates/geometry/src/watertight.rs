//! The watertight ray-triangle test: the one definition of a hit.
//!
//! Woop, Benthin and Wald 2013, "Watertight Ray/Triangle Intersection". Every vectorised test does
//! the same operations in the same order, without contraction, and so finds the same hits bit for bit.

use glam::{DVec3, Vec3};
use umber_math::{Point3, Ray, float::gamma};

/// Below and above these magnitudes of the determinant, single precision may have lost digits to
/// underflow or overflow: the test is done over in double precision.
pub const DETERMINANT_RANGE: std::ops::RangeInclusive<f32> = 1e-30..=1e30;

/// A hit of a ray with a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleHit {
    /// Parameter along the ray.
    pub t: f32,
    /// Weights of the triangle's vertices; their sum is one but for rounding.
    pub barycentrics: [f32; 3],
}

/// A ray made ready for the test: translated to its origin, sheared so that its direction is the z axis.
#[derive(Clone, Copy, Debug)]
pub struct ShearedRay {
    /// Origin of the ray.
    pub origin: Vec3,
    /// Axes that become x, y and z; z is the one along which the direction is longest.
    pub axes: [usize; 3],
    /// Shear in x and y, and scale in z.
    pub shear: Vec3,
}

impl ShearedRay {
    /// From a ray. `None` where its origin or direction is not finite, or the direction zero.
    #[inline]
    pub fn new(ray: &Ray) -> Option<Self> {
        let (o, d) = (ray.origin.0, ray.direction.0);
        if !o.is_finite() || !d.is_finite() || d == Vec3::ZERO {
            return None;
        }
        let a = d.abs();
        let axes = if a.x >= a.y && a.x >= a.z {
            [1, 2, 0]
        } else if a.y >= a.z {
            [2, 0, 1]
        } else {
            [0, 1, 2]
        };
        let z = d[axes[2]];
        Some(Self { origin: o, axes, shear: Vec3::new(d[axes[0]] / z, d[axes[1]] / z, 1.0 / z) })
    }

    /// The hit with a triangle, seen from either side, for which `t_min < t < t_max`.
    ///
    /// A ray through a shared edge or vertex hits at least one of the triangles around it: the
    /// signs of the edge functions are exact, since rounding the products keeps their order, and a
    /// tie is decided in double precision, where products of floats are exact.
    #[inline]
    pub fn intersect(&self, p0: Point3, p1: Point3, p2: Point3, t_min: f32, t_max: f32) -> Option<TriangleHit> {
        let [(ax, ay, az), (bx, by, bz), (cx, cy, cz)] = [p0, p1, p2].map(|p| self.sheared(p));
        let u = cx * by - cy * bx;
        let v = ax * cy - ay * cx;
        let w = bx * ay - by * ax;
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let det = (u + v) + w;
        if u == 0.0 || v == 0.0 || w == 0.0 || !DETERMINANT_RANGE.contains(&det.abs()) {
            let [a, b, c] = [[ax, ay, az], [bx, by, bz], [cx, cy, cz]].map(|p| Vec3::from(p).as_dvec3());
            return intersect_double(a, b, c, t_min, t_max);
        }
        let inverse = 1.0 / det;
        let (b0, b1, b2) = (u * inverse, v * inverse, w * inverse);
        let t = (b0 * az + b1 * bz) + b2 * cz;
        (t > t_min && t < t_max).then_some(TriangleHit { t, barycentrics: [b0, b1, b2] })
    }

    /// A point in the ray's space: the ray starts at zero and goes along z, which is `t`.
    #[inline]
    fn sheared(&self, p: Point3) -> (f32, f32, f32) {
        let q = p.0 - self.origin;
        let [kx, ky, kz] = self.axes;
        (q[kx] - self.shear.x * q[kz], q[ky] - self.shear.y * q[kz], self.shear.z * q[kz])
    }
}

/// The rest of the test in double precision, from the same sheared vertices.
#[cold]
fn intersect_double(a: DVec3, b: DVec3, c: DVec3, t_min: f32, t_max: f32) -> Option<TriangleHit> {
    let u = c.x * b.y - c.y * b.x;
    let v = a.x * c.y - a.y * c.x;
    let w = b.x * a.y - b.y * a.x;
    if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
        return None;
    }
    let det = u + v + w;
    let (b0, b1, b2) = (u / det, v / det, w / det);
    let t = (b0 * a.z + b1 * b.z + b2 * c.z) as f32;
    // A determinant of zero, or a vertex that is not finite, makes `t` NaN: no hit.
    (t > t_min && t < t_max).then_some(TriangleHit { t, barycentrics: [b0 as f32, b1 as f32, b2 as f32] })
}

/// The point at barycentric coordinates, and a bound of its absolute error in each axis.
///
/// pbrt-v4 section 6.8.5: `γ(7)` times the sum of the terms' magnitudes.
#[inline]
pub fn hit_point(p0: Point3, p1: Point3, p2: Point3, barycentrics: [f32; 3]) -> (Point3, Vec3) {
    let [b0, b1, b2] = barycentrics;
    let (x, y, z) = (p0.0 * b0, p1.0 * b1, p2.0 * b2);
    (Point3(x + y + z), (x.abs() + y.abs() + z.abs()) * gamma(7))
}

#[cfg(test)]
mod tests {
    use super::*;
    use umber_math::Vector3;

    fn ray(o: [f32; 3], d: [f32; 3]) -> Ray {
        Ray::new(o.into(), Vector3::from(d))
    }

    #[test]
    fn hits_from_both_sides_with_the_right_weights() {
        let (p0, p1, p2) = (Point3::new(0., 0., 5.), Point3::new(4., 0., 5.), Point3::new(0., 4., 5.));
        for (o, d) in [([1., 2., 0.], [0., 0., 1.]), ([1., 2., 10.], [0., 0., -1.])] {
            let r = ray(o, d);
            let hit = ShearedRay::new(&r).unwrap().intersect(p0, p1, p2, 0.0, f32::INFINITY).unwrap();
            assert_eq!(hit, TriangleHit { t: 5.0, barycentrics: [0.25, 0.25, 0.5] });
            let (p, error) = hit_point(p0, p1, p2, hit.barycentrics);
            assert!((p.0 - r.at(hit.t).0).abs().cmple(error).all());
        }
    }

    #[test]
    fn ends_of_the_segment_do_not_count() {
        let (p0, p1, p2) = (Point3::new(0., 0., 5.), Point3::new(4., 0., 5.), Point3::new(0., 4., 5.));
        let r = ShearedRay::new(&ray([1., 1., 0.], [0., 0., 1.])).unwrap();
        assert!(r.intersect(p0, p1, p2, 5.0, 6.0).is_none());
        assert!(r.intersect(p0, p1, p2, 0.0, 5.0).is_none());
        assert!(r.intersect(p0, p1, p2, 0.0, 5f32.next_up()).is_some());
        assert!(r.intersect(p0, p1, p2, 5f32.next_down(), 6.0).is_some());
    }

    #[test]
    fn shared_edge_belongs_to_a_neighbour_at_every_scale() {
        // Four triangles around a vertex; rays aimed at it and at the edges, at scales where single
        // precision products underflow or overflow.
        for scale in [1e-22f32, 1e-18, 1e-9, 1e-3, 1.0, 1e4, 1e9, 1e17] {
            let at = |x: f32, y: f32| Point3::new(x * scale, y * scale, scale);
            let ring = [at(1.0, 0.1), at(0.1, 1.0), at(-1.0, 0.3), at(0.2, -1.0)];
            let center = at(0.013, 0.027);
            for i in 0..1000 {
                let s = i as f32 / 1000.0 * 0.9;
                let edge = ring[i % 4];
                let target = Point3(center.0 + (edge.0 - center.0) * s);
                let r = Ray::new(Point3::ZERO, target - Point3::ZERO);
                let sheared = ShearedRay::new(&r).unwrap();
                let hits = (0..4)
                    .filter(|&k| sheared.intersect(center, ring[k], ring[(k + 1) % 4], 0.0, f32::INFINITY).is_some())
                    .count();
                assert!(hits >= 1, "leak at scale {scale}, ray {i}");
            }
        }
    }

    #[test]
    fn bad_rays_and_triangles_are_no_hits() {
        assert!(ShearedRay::new(&ray([f32::NAN, 0., 0.], [0., 0., 1.])).is_none());
        assert!(ShearedRay::new(&ray([0.; 3], [0.; 3])).is_none());
        assert!(ShearedRay::new(&ray([0.; 3], [f32::INFINITY, 0., 1.])).is_none());
        let r = ShearedRay::new(&ray([0.; 3], [0., 0., 1.])).unwrap();
        let bad = [f32::NAN, f32::INFINITY, f32::MAX, 0.0];
        for x in bad {
            let p = Point3::new(x, x, 1.0);
            assert!(r.intersect(p, p, p, 0.0, f32::INFINITY).is_none(), "{x}");
        }
    }
}
