//! Affine transforms with their inverse.

use glam::{Affine3A, DAffine3, DMat3, DVec3, Vec3, Vec3A};

use crate::{Bounds3, Normal3, Point3, Ray, Vector3};

/// A single-precision affine transform and its inverse, named target-from-source.
///
/// Both directions are rounded from one double-precision matrix: the inverse is not the inverse of
/// the rounded forward matrix.
#[derive(Clone, Copy, Debug)]
pub struct Transform {
    forward: Affine3A,
    inverse: Affine3A,
}

impl Default for Transform {
    fn default() -> Self {
        Self { forward: Affine3A::IDENTITY, inverse: Affine3A::IDENTITY }
    }
}

impl Transform {
    /// From a double-precision matrix. `None` where it is singular or not finite.
    pub fn from_affine(m: DAffine3) -> Option<Self> {
        let inverse = m.inverse();
        if !(m.is_finite() && inverse.is_finite()) || m.matrix3.determinant() == 0.0 {
            return None;
        }
        let t = Self { forward: m.as_affine3a(), inverse: inverse.as_affine3a() };
        (t.forward.is_finite() && t.inverse.is_finite()).then_some(t)
    }
    /// The matrix itself.
    #[inline]
    pub fn forward(&self) -> &Affine3A {
        &self.forward
    }
    /// Its inverse.
    #[inline]
    pub fn inverse(&self) -> &Affine3A {
        &self.inverse
    }
    /// Transforms a point.
    #[inline]
    pub fn point(&self, p: Point3) -> Point3 {
        Point3(self.forward.transform_point3(p.0))
    }
    /// Transforms a vector.
    #[inline]
    pub fn vector(&self, v: Vector3) -> Vector3 {
        Vector3(self.forward.transform_vector3(v.0))
    }
    /// Transforms a normal, by the inverse transpose. Not normalised.
    #[inline]
    pub fn normal(&self, n: Normal3) -> Normal3 {
        let m = &self.inverse.matrix3;
        let n = Vec3A::from(n.0);
        Normal3(Vec3::new(m.x_axis.dot(n), m.y_axis.dot(n), m.z_axis.dot(n)))
    }
    /// Transforms a point back.
    #[inline]
    pub fn inverse_point(&self, p: Point3) -> Point3 {
        Point3(self.inverse.transform_point3(p.0))
    }
    /// Transforms a vector back.
    #[inline]
    pub fn inverse_vector(&self, v: Vector3) -> Vector3 {
        Vector3(self.inverse.transform_vector3(v.0))
    }
    /// Transforms a ray back; parameters `t` keep their meaning since the direction is not normalised.
    #[inline]
    pub fn inverse_ray(&self, r: &Ray) -> Ray {
        Ray { origin: self.inverse_point(r.origin), direction: self.inverse_vector(r.direction), ..*r }
    }
    /// The box around the transformed box.
    pub fn bounds(&self, b: Bounds3) -> Bounds3 {
        if b.is_empty() {
            return b;
        }
        Bounds3::of_points(b.corners().map(|p| self.point(p)))
    }
    /// Whether it mirrors (its determinant is negative).
    #[inline]
    pub fn flips_handedness(&self) -> bool {
        self.forward.matrix3.determinant() < 0.0
    }
}

/// Whether a matrix turns, mirrors and scales, but neither squeezes nor shears.
pub fn keeps_angles(m: &DMat3) -> bool {
    let lengths = [m.x_axis, m.y_axis, m.z_axis].map(DVec3::length_squared);
    let [least, most] = [lengths.into_iter().fold(f64::INFINITY, f64::min), lengths.into_iter().fold(0.0, f64::max)];
    let skew = m.x_axis.dot(m.y_axis).abs().max(m.y_axis.dot(m.z_axis).abs()).max(m.z_axis.dot(m.x_axis).abs());
    most - least < 1e-4 * most && skew < 1e-4 * most
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn normal_stays_perpendicular_under_shear() {
        let m = DAffine3::from_scale(DVec3::new(1.0, 4.0, 0.5)) * DAffine3::from_rotation_x(0.7);
        let t = Transform::from_affine(m).unwrap();
        let (v, n) = (Vector3::new(0.0, 1.0, 0.0), Normal3::new(0.0, 0.0, 1.0));
        assert!(t.vector(v).dot_normal(t.normal(n)).abs() < 1e-6);
    }

    #[test]
    fn singular_and_nan_matrices_are_refused() {
        assert!(Transform::from_affine(DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0))).is_none());
        assert!(Transform::from_affine(DAffine3::from_translation(DVec3::NAN)).is_none());
    }

    #[test]
    fn what_squeezes_or_shears_changes_angles() {
        let turned =
            DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 2.0) / 3.0, 0.7) * DMat3::from_diagonal(DVec3::splat(3.0));
        let mirrored = turned * DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
        assert!(keeps_angles(&turned) && keeps_angles(&mirrored));
        assert!(!keeps_angles(&(turned * DMat3::from_diagonal(DVec3::new(1.0, 1.01, 1.0)))));
        let sheared = DMat3::from_cols(DVec3::X, DVec3::new(0.01, 1.0, 0.0).normalize(), DVec3::Z);
        assert!(!keeps_angles(&sheared) && !keeps_angles(&DMat3::ZERO));
    }
}
