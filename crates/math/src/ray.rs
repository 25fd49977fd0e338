//! Rays.

use crate::{Point3, Vector3};

/// A ray segment: points `origin + t · direction` for `t_min < t < t_max`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where `t` is zero.
    pub origin: Point3,
    /// Direction; need not be of unit length (then `t` is in its units).
    pub direction: Vector3,
    /// Hits at or before this parameter do not count.
    pub t_min: f32,
    /// Hits at or beyond this parameter do not count.
    pub t_max: f32,
}

impl Ray {
    /// A ray without end.
    #[inline]
    pub fn new(origin: Point3, direction: Vector3) -> Self {
        Self { origin, direction, t_min: 0.0, t_max: f32::INFINITY }
    }
    /// The point at parameter `t`.
    #[inline]
    pub fn at(&self, t: f32) -> Point3 {
        self.origin + self.direction * t
    }
}
