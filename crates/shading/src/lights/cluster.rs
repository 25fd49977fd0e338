//! Bounds of place, direction and power of one light or of many, and what a point may expect of them.

use std::f32::consts::PI;

use umber_math::{Bounds3, Vec3};

use super::receiver::View;

/// Directions within θ of an axis; θ = π for all.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cone {
    pub axis: Vec3,
    pub cos: f32,
    /// Whether the opposite directions belong to it as well.
    pub two_sided: bool,
    /// Of how far each light shines off the direction that it faces, at most; 0 for a right angle.
    pub cos_edge: f32,
}

impl Cone {
    pub const ALL: Self = Self { axis: Vec3::Z, cos: -1.0, two_sided: false, cos_edge: -1.0 };

    /// Of what is flat, and shines into a cosine lobe or two.
    pub fn flat(axis: Vec3, two_sided: bool) -> Self {
        Self { axis, cos: 1.0, two_sided, cos_edge: 0.0 }
    }
    pub fn union(self, o: Self) -> Self {
        let (a, b) = if self.cos <= o.cos { (self, o) } else { (o, self) };
        let (two_sided, cos_edge) = (a.two_sided || b.two_sided, a.cos_edge.min(b.cos_edge));
        if a.cos <= -1.0 {
            return a;
        }
        let dot = a.axis.dot(b.axis);
        let b_axis = if two_sided && dot < 0.0 { -b.axis } else { b.axis };
        let between = if two_sided { dot.abs() } else { dot };
        if between >= 1.0 - 1e-7 && a.cos <= b.cos {
            return Self { two_sided, cos_edge, ..a };
        }
        let angle = |cos: f32| cos.clamp(-1.0, 1.0).acos();
        let (theta_a, theta_b, between) = (angle(a.cos), angle(b.cos), angle(between));
        if (between + theta_b).min(PI) <= theta_a {
            return Self { two_sided, cos_edge, ..a };
        }
        let theta = (theta_a + between + theta_b) * 0.5;
        // A two-sided cone of a right angle holds all directions.
        if theta >= if two_sided { PI * 0.5 } else { PI } {
            return Self::ALL;
        }
        let across = b_axis - a.axis * a.axis.dot(b_axis);
        let Some(across) = across.try_normalize() else { return Self::ALL };
        let (sin, cos) = (theta - theta_a).sin_cos();
        Self { axis: (a.axis * cos + across * sin).normalize(), cos: theta.cos(), two_sided, cos_edge }
    }
    /// Solid angle that lights facing within the cone shine into, weighted by how much.
    fn measure(self) -> f32 {
        let theta = self.cos.clamp(-1.0, 1.0).acos();
        let edge = (theta + self.cos_edge.clamp(-1.0, 1.0).acos()).min(PI);
        let sin = theta.sin();
        2.0 * PI * (1.0 - self.cos)
            + PI * 0.5 * (2.0 * edge * sin - (theta - 2.0 * edge).cos() - 2.0 * theta * sin + self.cos)
    }
}

/// What is known of one light, or of all lights below a node.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cluster {
    center: Vec3,
    /// Half the size of the box around them.
    half: Vec3,
    axis: Vec3,
    /// Of the half angle of the cone around the axis that they face within; −1 for all directions.
    cos: f32,
    sin: f32,
    /// As [`Cone::cos_edge`].
    cos_edge: f32,
    /// Radiant intensity along the brightest direction, relative.
    intensity: f32,
    two_sided: bool,
}

/// Beyond the edge by this cosine a light still counts, and below the horizon: rounding must not hide one.
const SLACK: f32 = 1e-3;

/// Least squared distance to a box from within it, in squares of half its diagonal: what chooses best in trials (the
/// example `light_choice`).
const WITHIN: f32 = 0.12;

/// From here on, in squares of a distance, all is equally far: products of two stay finite.
const FAR: f32 = 1e18;

impl Cluster {
    /// `intensity`: along the brightest direction, relative to that of the other lights, positive.
    pub fn new(bounds: Bounds3, cone: Cone, intensity: f32) -> Self {
        let sin = (1.0 - cone.cos * cone.cos).max(0.0).sqrt();
        let (center, half) = (bounds.center().0, bounds.size() * 0.5);
        let Cone { axis, cos, two_sided, cos_edge } = cone;
        Self { center, half, axis, cos, sin, cos_edge, intensity, two_sided }
    }
    pub fn center(&self) -> Vec3 {
        self.center
    }
    /// Square of half the diagonal of the bounds.
    #[inline]
    pub fn radius_squared(&self) -> f32 {
        self.half.length_squared()
    }
    pub fn bounds(&self) -> Bounds3 {
        Bounds3 { min: self.center - self.half, max: self.center + self.half }
    }
    pub fn cone(&self) -> Cone {
        Cone { axis: self.axis, cos: self.cos, two_sided: self.two_sided, cos_edge: self.cos_edge }
    }
    /// The same within other directions.
    pub fn facing(&self, cone: Cone) -> Self {
        Self::new(self.bounds(), cone, self.intensity)
    }
    pub fn union(self, o: Self) -> Self {
        let bounds = self.bounds().union(o.bounds());
        Self::new(bounds, self.cone().union(o.cone()), self.intensity + o.intensity)
    }
    /// The surface-area orientation heuristic's cost of a node.
    pub fn cost(&self) -> f32 {
        let s = self.half;
        // A little thickness: lights in a line or at a point are not free.
        let area = s.x * s.y + s.y * s.z + s.z * s.x + 1e-3 * s.length_squared();
        self.intensity * self.cone().measure() * area
    }
    /// Irradiance to expect at a receiver, relative; zero only where none of the light arrives.
    #[inline(always)] // two are weighed at a time: each waits for its own square roots
    pub fn importance(&self, view: &View) -> f32 {
        let to_point = view.point - self.center;
        let radius_squared = self.radius_squared();
        // Lights spread between the nearest and the farthest point of the box have this mean of 1 / d².
        let near = (to_point.abs() - self.half).max(Vec3::ZERO).length_squared();
        let far = (to_point.abs() + self.half).length_squared();
        let softened = (near.min(FAR) * far.min(FAR)).sqrt().max(WITHIN * radius_squared);
        let distance = softened.sqrt();
        let mut expected = self.intensity / softened;
        if view.normal != Vec3::ZERO {
            expected *= above(-to_point.dot(view.normal), self.half.dot(view.normal.abs()), distance);
        }
        if self.cos > -1.0 {
            expected *= self.emission_cosine(to_point, radius_squared, distance);
        }
        if expected.is_nan() { 0.0 } else { expected.min(1e30) }
    }
    /// The cosine at the lights that a point may expect.
    #[inline]
    fn emission_cosine(&self, to_point: Vec3, radius_squared: f32, distance: f32) -> f32 {
        let distance_squared = to_point.length_squared();
        let height = to_point.dot(self.axis);
        let height = if self.two_sided { height.abs() } else { height };
        // All face the same way, and none shines farther than flat things do.
        let is_flat = self.cos >= 1.0 && self.cos_edge >= 0.0;
        let flat = || above(height, self.half.dot(self.axis.abs()), distance);
        if is_flat && self.cos_edge == 0.0 {
            return flat();
        }
        if distance_squared <= radius_squared {
            return 1.0;
        }
        // The least angle between a light's facing and a direction from it to the point: bounds of both taken off.
        let cos = (height / distance_squared.sqrt()).clamp(-1.0, 1.0);
        let (sin, cos) = less((1.0 - cos * cos).max(0.0).sqrt(), cos, self.sin, self.cos);
        let sin_within = (radius_squared / distance_squared).sqrt();
        let (_, cos) = less(sin, cos, sin_within, (1.0 - sin_within * sin_within).max(0.0).sqrt());
        if cos < self.cos_edge - SLACK {
            return 0.0;
        }
        if is_flat { flat() } else { cos.max(SLACK) }
    }
}

/// Cosine to a horizon that what lies within `spread` above and below a height may have; zero only below the horizon.
#[inline]
fn above(height: f32, spread: f32, distance: f32) -> f32 {
    let top = height + spread;
    if top < -SLACK * SLACK * distance { 0.0 } else { (top / distance).clamp(SLACK * SLACK, 1.0) }
}

/// Sine and cosine of the difference of two angles within 0 … π, of 0 where it is negative.
#[inline]
fn less(sin_a: f32, cos_a: f32, sin_b: f32, cos_b: f32) -> (f32, f32) {
    if cos_a >= cos_b { (0.0, 1.0) } else { (sin_a * cos_b - cos_a * sin_b, cos_a * cos_b + sin_a * sin_b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_union_of_cones_holds_both() {
        let mut random = 1u32;
        let mut next = || {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (random >> 8) as f32 / (1 << 24) as f32
        };
        for _ in 0..2000 {
            let mut axis = || (Vec3::new(next(), next(), next()) - 0.5).normalize();
            let axes = [axis(), axis(), axis()];
            let two_sided = next() < 0.5;
            let union = axes.map(|axis| Cone::flat(axis, two_sided)).into_iter().reduce(Cone::union).unwrap();
            for axis in axes {
                let dot = union.axis.dot(axis);
                let dot = if union.two_sided { dot.abs() } else { dot };
                assert!(dot >= union.cos - 1e-5, "{axis} is outside of {union:?}");
            }
        }
    }
}
