//! Sampling the directions in which a triangle is seen.
//!
//! Arvo 1995, "Stratified Sampling of Spherical Triangles"; the solid angle by Van Oosterom & Strackee 1983, "The
//! Solid Angle of a Plane Triangle", which keeps its digits for small ones. In double precision.

use glam::{DVec3, Vec2};

/// Solid angles below this (steradians) are sampled by area: there the two hardly differ.
const LEAST_SOLID_ANGLE: f64 = 1e-4;
/// Corners whose directions are nearer than this to each other, or to opposites, are sampled by area.
const LEAST_SINE: f64 = 1e-6;

/// A triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    corners: [DVec3; 3],
    /// Unit, by the winding.
    pub normal: DVec3,
    pub area: f64,
}

/// A point of a triangle, as seen from another point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TriangleSample {
    /// To the point, unit.
    pub wi: DVec3,
    pub distance: f64,
    pub pdf_solid_angle: f64,
}

/// A triangle as a point sees it.
struct Spherical {
    /// Unit, to the corners.
    directions: [DVec3; 3],
    /// Sine and cosine of the angle at the first corner.
    sin_alpha: f64,
    cos_alpha: f64,
    /// Cosine of the side from the first corner to the second.
    cos_side: f64,
    solid_angle: f64,
}

impl Triangle {
    /// `None` where it has no area.
    #[inline]
    pub fn new(corners: [DVec3; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let cross = (b - a).cross(c - a);
        let length = cross.length();
        let usable = length > 0.0 && length.is_finite();
        usable.then(|| Self { corners, normal: cross / length, area: 0.5 * length })
    }
    /// How far in front of its plane a point is, on the winding's side.
    #[inline]
    pub fn height(&self, p: DVec3) -> f64 {
        (p - self.corners[0]).dot(self.normal)
    }
    /// A point of it, uniform in solid angle, or by area where it is small or seen from its plane.
    #[inline]
    pub fn sample(&self, p: DVec3, u: Vec2) -> Option<TriangleSample> {
        let u = u.as_dvec2();
        if let Some(spherical) = self.spherical(p) {
            let wi = spherical.sample(u.x, u.y);
            let distance = -self.height(p) / wi.dot(self.normal);
            let usable = distance > 0.0 && distance.is_finite();
            let pdf_solid_angle = 1.0 / spherical.solid_angle;
            return usable.then_some(TriangleSample { wi, distance, pdf_solid_angle });
        }
        // Uniform by area: a square folded along its diagonal would tear neighbours apart.
        let root = u.x.sqrt();
        let [a, b, c] = self.corners;
        let to_light = a + (b - a) * (root * (1.0 - u.y)) + (c - a) * (root * u.y) - p;
        let distance = to_light.length();
        let wi = to_light / distance;
        let pdf_solid_angle = self.area_density(distance, wi);
        let usable = distance > 0.0 && pdf_solid_angle.is_finite();
        usable.then_some(TriangleSample { wi, distance, pdf_solid_angle })
    }
    /// Density with which [`Triangle::sample`] makes a direction, unit, that leads to the triangle.
    #[inline]
    pub fn pdf_solid_angle(&self, p: DVec3, wi: DVec3) -> f64 {
        let pdf = match self.spherical(p) {
            Some(spherical) => 1.0 / spherical.solid_angle,
            None => self.area_density(-self.height(p) / wi.dot(self.normal), wi),
        };
        if pdf.is_finite() { pdf } else { 0.0 }
    }
    /// Density by solid angle of a point that is uniform by area.
    #[inline]
    fn area_density(&self, distance: f64, wi: DVec3) -> f64 {
        distance * distance / (self.area * wi.dot(self.normal).abs())
    }
    /// `None` where it is to be sampled by area.
    #[inline]
    fn spherical(&self, p: DVec3) -> Option<Spherical> {
        let to = self.corners.map(|c| c - p);
        // Far away it is small: nothing else need be known.
        let nearest = to.map(|t| t.length_squared()).into_iter().fold(f64::INFINITY, f64::min);
        if self.area < 0.5 * LEAST_SOLID_ANGLE * nearest {
            return None;
        }
        let directions = to.map(DVec3::normalize_or_zero);
        let [a, b, c] = directions;
        let (ab, ca) = (a.cross(b), c.cross(a));
        let volume = ab.dot(c).abs();
        let solid_angle = 2.0 * volume.atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a));
        let (sin_ab, sin_ca) = (ab.length(), ca.length());
        let sin_bc = b.cross(c).length();
        if !(solid_angle >= LEAST_SOLID_ANGLE && sin_ab.min(sin_ca).min(sin_bc) >= LEAST_SINE) {
            return None;
        }
        let scale = 1.0 / (sin_ab * sin_ca);
        let (sin_alpha, cos_alpha) = (volume * scale, (-ab.dot(ca) * scale).clamp(-1.0, 1.0));
        Some(Spherical { directions, sin_alpha, cos_alpha, cos_side: a.dot(b), solid_angle })
    }
}

impl Spherical {
    /// A direction to the triangle, unit: a part of it is cut off along an arc through the second corner, which gives
    /// a point on the side opposite, and then a point on the arc is taken.
    #[inline]
    fn sample(&self, u: f64, v: f64) -> DVec3 {
        let [a, b, c] = self.directions;
        let alpha = self.sin_alpha.atan2(self.cos_alpha);
        let (s, t) = (u * self.solid_angle - alpha).sin_cos();
        let (p, q) = (t - self.cos_alpha, s + self.sin_alpha * self.cos_side);
        let cos_cut = ((q * t - p * s) * self.cos_alpha - q) / ((q * s + p * t) * self.sin_alpha);
        // Where next to nothing is cut off, both are rounding.
        let cos_cut = if cos_cut.is_nan() { 1.0 } else { cos_cut.clamp(a.dot(c), 1.0) };
        let cut = along(a, c, cos_cut);
        let cos_point = 1.0 - v * (1.0 - cut.dot(b));
        along(b, cut, cos_point)
    }
}

/// The direction at an angle, by its cosine, from one towards another; all unit.
#[inline]
fn along(from: DVec3, to: DVec3, cos: f64) -> DVec3 {
    let across = (to - from * to.dot(from)).normalize_or_zero();
    (from * cos + across * (1.0 - cos * cos).max(0.0).sqrt()).normalize_or_zero()
}
