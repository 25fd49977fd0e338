//! Axis-aligned bounding boxes.

use glam::Vec3;

use crate::Point3;

/// An axis-aligned box; empty where `min > max` in any axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds3 {
    /// Smallest corner.
    pub min: Vec3,
    /// Largest corner.
    pub max: Vec3,
}

impl Default for Bounds3 {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Bounds3 {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest box around the points; points with a NaN are passed over.
    pub fn of_points(points: impl IntoIterator<Item = Point3>) -> Self {
        points.into_iter().filter(|p| !p.0.is_nan()).fold(Self::EMPTY, |b, p| b.with_point(p))
    }
    /// The smallest box that also holds `p`.
    #[inline]
    pub fn with_point(self, p: Point3) -> Self {
        Self { min: self.min.min(p.0), max: self.max.max(p.0) }
    }
    /// The smallest box around both.
    #[inline]
    pub fn union(self, o: Self) -> Self {
        Self { min: self.min.min(o.min), max: self.max.max(o.max) }
    }
    /// Whether it holds nothing.
    #[inline]
    pub fn is_empty(self) -> bool {
        !self.min.cmple(self.max).all()
    }
    /// Edge lengths; zero where empty.
    #[inline]
    pub fn size(self) -> Vec3 {
        if self.is_empty() { Vec3::ZERO } else { self.max - self.min }
    }
    /// The middle; the origin where empty.
    #[inline]
    pub fn center(self) -> Point3 {
        if self.is_empty() { Point3::ZERO } else { Point3(self.min * 0.5 + self.max * 0.5) }
    }
    /// The eight corners.
    pub fn corners(self) -> [Point3; 8] {
        std::array::from_fn(|i| {
            let pick = |bit: usize, axis: usize| if i >> bit & 1 == 0 { self.min[axis] } else { self.max[axis] };
            Point3::new(pick(0, 0), pick(1, 1), pick(2, 2))
        })
    }
}
