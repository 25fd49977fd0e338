//! Where light is asked for.

use umber_math::{Normal3, Point3, Vec3};

/// A point that light is sampled for.
#[derive(Clone, Copy, Debug)]
pub struct Receiver {
    /// Render space.
    pub point: Point3,
    /// Unit, on the side that receives: light from below the plane that it stands on counts for nothing. Zero where
    /// light from all around counts.
    pub normal: Normal3,
    /// How far along the normal rays start from the point, render-space units.
    pub clearance: f32,
}

impl Receiver {
    /// A point that receives from all around.
    pub fn all_around(point: Point3) -> Self {
        Self { point, normal: Normal3::ZERO, clearance: 0.0 }
    }
    #[inline]
    pub(crate) fn view(&self) -> View {
        View { point: self.point.0, normal: self.normal.0 }
    }
}

/// A receiver as the choice among lights sees it, in the space of the lights.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View {
    pub point: Vec3,
    /// Unit, or zero.
    pub normal: Vec3,
}
