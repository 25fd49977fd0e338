//! A ray made ready for traversal.

use glam::{DAffine3, DMat3, Vec3};
use umber_geometry::watertight::ShearedRay;
use umber_math::{Point3, Ray, Vector3, float::gamma};

/// Far ends of boxes are pushed out by this factor.
///
/// Ize 2013, "Robust BVH Ray Traversal", gives `1 + 2γ(3)` for the rounding of the box test alone.
/// Twice that also covers the rounding of the shear in the triangle test, so that a box is entered
/// whenever the triangle test would find a hit in it.
pub(crate) const FAR_SLACK: f32 = 1.0 + 4.0 * gamma(3);

/// What the box and triangle tests need, worked out once a ray and level.
#[derive(Clone, Copy)]
pub(crate) struct TraversalRay {
    pub sheared: ShearedRay,
    /// One over the direction; infinite where that is zero. NaN where the direction is so small that one over
    /// it overflows: box tests then pass over the axis. Never so in all three: boxes that are not there are not met.
    pub inverse: Vec3,
    /// The same with [`FAR_SLACK`], for the far ends of boxes.
    pub inverse_far: Vec3,
    /// Which plane of each axis the ray meets first: 0 the smaller, 1 the larger.
    pub near: [usize; 3],
    /// Hits at or before this do not count; never negative.
    pub t_min: f32,
}

impl TraversalRay {
    /// `None` where no hit is possible: see [`ShearedRay::new`].
    #[inline(always)]
    pub fn new(ray: &Ray) -> Option<Self> {
        let sheared = ShearedRay::new(ray)?;
        let direction = ray.direction.0;
        let mut inverse = direction.recip();
        if !inverse.is_finite() {
            inverse = Vec3::select(direction.cmpeq(Vec3::ZERO) | inverse.is_finite_mask(), inverse, Vec3::NAN);
        }
        let near_plane = |d: f32| usize::from(d.is_sign_negative());
        let near = [near_plane(direction.x), near_plane(direction.y), near_plane(direction.z)];
        let t_min = if ray.t_min > 0.0 { ray.t_min } else { 0.0 };
        Some(Self { sheared, inverse, inverse_far: inverse * FAR_SLACK, near, t_min })
    }

    /// A component of the origin.
    #[inline(always)]
    pub fn origin(&self, axis: usize) -> f32 {
        self.sheared.origin[axis]
    }

    /// The same ray in the space of a child; `t` keeps its meaning.
    #[inline(always)]
    pub fn transformed(&self, child_from_parent: &ChildFromParent) -> Option<Self> {
        let (origin, direction) = (Point3(self.sheared.origin), Vector3(self.sheared.direction));
        if child_from_parent.is_translation {
            // the direction and all that follows from it stay
            return Some(Self { sheared: self.sheared.moved(child_from_parent.translated(origin).0)?, ..*self });
        }
        Self::in_child(&Ray { origin, direction, t_min: self.t_min, t_max: f32::INFINITY }, child_from_parent)
    }

    /// A ray in the space of a child; `t` keeps its meaning. In double precision, so that children far from their
    /// parent's origin lose nothing.
    #[inline(always)]
    pub fn in_child(ray: &Ray, child_from_parent: &ChildFromParent) -> Option<Self> {
        if child_from_parent.is_translation {
            return Self::new(&Ray { origin: child_from_parent.translated(ray.origin), ..*ray });
        }
        let matrix = &child_from_parent.matrix;
        let origin = matrix.transform_point3(ray.origin.0.as_dvec3()).as_vec3();
        let direction = matrix.transform_vector3(ray.direction.0.as_dvec3()).as_vec3();
        Self::new(&Ray { origin: Point3(origin), direction: Vector3(direction), ..*ray })
    }
}

/// Leads from a group's space to that of what an instance shows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChildFromParent {
    matrix: DAffine3,
    /// Whether it turns and stretches nothing: most instances are only moved, as render space is world space moved.
    is_translation: bool,
}

impl ChildFromParent {
    /// From a matrix.
    pub fn new(matrix: DAffine3) -> Self {
        Self { matrix, is_translation: matrix.matrix3 == DMat3::IDENTITY }
    }
    #[inline(always)]
    fn translated(&self, origin: Point3) -> Point3 {
        Point3((origin.0.as_dvec3() + self.matrix.translation).as_vec3())
    }
}
