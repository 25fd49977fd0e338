//! Floating-point error: bounds after pbrt-v4 section 6.8.1 ("Floating-Point Arithmetic").

use crate::{Normal3, Point3, Vector3};

/// Half the distance between 1 and the next float: the largest relative error of one rounding.
pub const MACHINE_EPSILON: f32 = f32::EPSILON * 0.5;

/// Bound of the relative error after `n` roundings: `n ε / (1 − n ε)`.
#[inline]
pub const fn gamma(n: i32) -> f32 {
    let e = n as f32 * MACHINE_EPSILON;
    e / (1.0 - e)
}

/// The origin of a ray that leaves a surface point in direction `w`: at least `clearance` from it along the
/// geometric normal, whatever is rounded here. pbrt-v4 section 6.8.6.
#[inline]
pub fn offset_ray_origin(p: Point3, clearance: f32, n: Normal3, w: Vector3) -> Point3 {
    let offset = if w.dot_normal(n) < 0.0 { -clearance * n.0 } else { clearance * n.0 };
    let moved = p.0 + offset;
    // One float on. Selections alone: signs are as good as random, and branches on them would be mispredicted.
    let away = |v: f32, o: f32| {
        let step = if (o > 0.0) == (v > 0.0) { 1 } else { u32::MAX };
        let next = f32::from_bits(v.to_bits().wrapping_add(step));
        let next = if v == 0.0 { f32::from_bits(1).copysign(o) } else { next };
        if o == 0.0 || !v.is_finite() { v } else { next }
    };
    Point3::new(away(moved.x, offset.x), away(moved.y, offset.y), away(moved.z, offset.z))
}
