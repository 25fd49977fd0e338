//! The watertight ray-triangle test: the one definition of a hit.
//!
//! Woop, Benthin and Wald 2013, "Watertight Ray/Triangle Intersection". Every vectorised test does
//! the same operations in the same order, without contraction, and so finds the same hits bit for bit.
//!
//! A hit that may lie on either side of the ray's origin, by the rounding of the test, is decided in
//! double precision from the triangle itself. So a ray that starts on the right side of a triangle's
//! plane, by however little, never meets it, and one that starts before it does: what leaves a surface
//! needs to clear the rounding of its own origin and nothing else.

use glam::{DVec3, Vec3};
use umber_math::{Point3, Ray, float::MACHINE_EPSILON};

/// Below and above these magnitudes of the determinant, single precision may have lost digits to
/// underflow or overflow: the test is done over in double precision.
pub const DETERMINANT_RANGE: std::ops::RangeInclusive<f32> = 1e-30..=1e30;

/// How far the parameter `t` of a hit may be off, in parts: of the triangle's depth, and of the spread of its
/// vertices' depths times `reach² / |det|`. 138 roundings, by a count of the operations, made 256.
///
/// The hit may be on either side of the ray's origin where
/// `|t| · |det| ≤ DEPTH_ERROR · (depth · |det| + spread · reach²)`, with the largest magnitude of the
/// vertices' depths, their largest difference, and the largest magnitude of all their coordinates in the
/// ray's space; depths as scaled to `t`.
pub const DEPTH_ERROR: f32 = 256.0 * MACHINE_EPSILON;

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
    /// Direction of the ray.
    pub direction: Vec3,
    /// Axes that become x, y and z; z is the one along which the direction is longest.
    pub axes: [usize; 3],
    /// The origin along these axes.
    pub start: Vec3,
    /// Shear in x and y, and scale in z.
    pub shear: Vec3,
}

/// The components of a vector along some axes, looked up: a branch would be mispredicted for every other ray.
#[inline(always)]
fn along(v: Vec3, axes: [usize; 3]) -> Vec3 {
    let v = v.to_array();
    Vec3::new(v[axes[0]], v[axes[1]], v[axes[2]])
}

impl ShearedRay {
    /// From a ray. `None` where its origin or direction is not finite, or the direction is zero or so short
    /// that one over it overflows.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Option<Self> {
        let (o, d) = (ray.origin.0, ray.direction.0);
        if !o.is_finite() || !d.is_finite() {
            return None;
        }
        let a = d.abs();
        // Without branches: they would be mispredicted for every other ray.
        let y_over_x = usize::from(a.y > a.x);
        let axis = y_over_x + usize::from(a.z > a.x.max(a.y)) * (2 - y_over_x);
        let axes = [[1, 2, 0], [2, 0, 1], [0, 1, 2]][axis];
        let (start, d_axes) = (along(o, axes), along(d, axes));
        let shear = Vec3::new(d_axes.x / d_axes.z, d_axes.y / d_axes.z, 1.0 / d_axes.z);
        if !shear.z.is_finite() {
            return None;
        }
        Some(Self { origin: o, direction: d, axes, start, shear })
    }

    /// The same ray from another origin. `None` where that is not finite.
    #[inline(always)]
    pub fn moved(&self, origin: Vec3) -> Option<Self> {
        origin.is_finite().then(|| Self { origin, start: along(origin, self.axes), ..*self })
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
        let scale = self.shear.z;
        let (barycentrics, t) = if u == 0.0 || v == 0.0 || w == 0.0 || !DETERMINANT_RANGE.contains(&det.abs()) {
            in_double([(ax, ay, scale * az), (bx, by, scale * bz), (cx, cy, scale * cz)])?
        } else {
            let inverse = 1.0 / det;
            let [b0, b1, b2] = [u * inverse, v * inverse, w * inverse];
            ([b0, b1, b2], (b0 * (scale * az) + b1 * (scale * bz)) + b2 * (scale * cz))
        };
        let depth = az.abs().max(bz.abs()).max(cz.abs());
        let reach = [ax, ay, bx, by, cx, cy].into_iter().fold(depth, |m: f32, x| m.max(x.abs()));
        let spread = az.max(bz).max(cz) - az.min(bz).min(cz);
        let unsure = (DEPTH_ERROR * scale.abs()) * (depth * det.abs() + spread * (reach * reach));
        let t = if t.abs() * det.abs() <= unsure { self.plane_parameter([p0, p1, p2]) } else { t };
        // A vertex that is not finite makes `t` NaN: no hit.
        (t > t_min && t < t_max).then_some(TriangleHit { t, barycentrics })
    }

    /// A point in the ray's space, where the ray starts at zero and goes along z; z is not yet scaled to `t`.
    #[inline]
    fn sheared(&self, p: Point3) -> (f32, f32, f32) {
        let p = p.0.to_array();
        let [x, y, z] = self.axes;
        let q = Vec3::new(p[x], p[y], p[z]) - self.start;
        (q.x - self.shear.x * q.z, q.y - self.shear.y * q.z, q.z)
    }

    /// Where the ray meets a triangle's plane, in double precision from the vertices as they are; within the
    /// triangle's own depths, where it is seen edge-on and the plane is met somewhere else.
    #[inline]
    pub fn plane_parameter(&self, triangle: [Point3; 3]) -> f32 {
        let (origin, direction) = (self.origin.as_dvec3(), self.direction.as_dvec3());
        let [a, b, c] = triangle;
        let (a, b, c) = (a.0.as_dvec3() - origin, b.0.as_dvec3() - origin, c.0.as_dvec3() - origin);
        let n = (b - a).cross(c - a);
        let kz = self.axes[2];
        let depth = |p: DVec3| p.to_array()[kz];
        let per_depth = 1.0 / depth(direction);
        let depths = [depth(a) * per_depth, depth(b) * per_depth, depth(c) * per_depth];
        let low = depths[0].min(depths[1]).min(depths[2]);
        let high = depths[0].max(depths[1]).max(depths[2]);
        // What is not a number becomes the lower end.
        (n.dot(a) / n.dot(direction)).max(low).min(high) as f32
    }
}

/// Barycentrics and parameter in double precision, from the same sheared vertices; none where it is outside.
///
/// All triangles at an edge or vertex that the ray meets exactly have the same parameter, bit for bit: what goes on
/// behind it passes them all.
#[cold]
fn in_double(vertices: [(f32, f32, f32); 3]) -> Option<([f32; 3], f32)> {
    let [a, b, c] = vertices.map(|p| Vec3::from(p).as_dvec3());
    let u = c.x * b.y - c.y * b.x;
    let v = a.x * c.y - a.y * c.x;
    let w = b.x * a.y - b.y * a.x;
    if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
        return None;
    }
    let det = u + v + w;
    // A vertex that is not a number leaves the edge across from it as it is.
    if det == 0.0 || det.is_nan() {
        return None;
    }
    let (b0, b1, b2) = (u / det, v / det, w / det);
    let t = match (u == 0.0, v == 0.0, w == 0.0) {
        (true, ..) => on_edge(b, c),
        (_, true, _) => on_edge(c, a),
        (.., true) => on_edge(a, b),
        _ => b0 * a.z + b1 * b.z + b2 * c.z,
    };
    Some(([b0 as f32, b1 as f32, b2 as f32], t as f32))
}

/// Depth at which the ray meets an edge that it meets exactly; the same whichever end is named first.
fn on_edge(p: DVec3, q: DVec3) -> f64 {
    let along_x = (q.x - p.x).abs() >= (q.y - p.y).abs();
    let (from, to) = if along_x { (p.x, q.x) } else { (p.y, q.y) };
    // A vertex met exactly is at zero: products with it vanish, and its depth is what remains.
    if from == 0.0 {
        p.z
    } else if to == 0.0 {
        q.z
    } else {
        (p.z * to - q.z * from) / (to - from)
    }
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
