//! Close boxes around what is instanced.

use std::collections::HashMap;

use glam::{DAffine3, DVec3, Vec3};
use umber_math::Bounds3;

use crate::instance::Child;

/// Products with sides up to this do not overflow in single precision.
const LARGEST: f64 = f32::MAX as f64 / 8.0;

/// The boxes of what is below the root's children, in child space: turned, they hold the child more closely than its
/// one box would.
pub(crate) struct Cover {
    bounds: Bounds3,
    centers: [Vec<f32>; 3],
    halves: [Vec<f32>; 3],
}

impl Cover {
    fn new(bounds: Bounds3, boxes: &[Bounds3]) -> Self {
        let row = |value: &dyn Fn(&Bounds3) -> f32| boxes.iter().map(value).collect::<Vec<f32>>();
        Self {
            bounds,
            centers: [0, 1, 2].map(|axis| row(&|b| b.min[axis] * 0.5 + b.max[axis] * 0.5)),
            halves: [0, 1, 2].map(|axis| row(&|b| b.max[axis] * 0.5 - b.min[axis] * 0.5)),
        }
    }

    /// A box around the transformed boxes, with a margin for the rounding of the ray that is taken into
    /// the child's space, a few units in the last place of the coordinates met there, and for that of this.
    /// Infinite where it is too large for the products of its sides.
    pub fn placed(&self, parent_from_child: &DAffine3) -> Bounds3 {
        let rows = parent_from_child.matrix3.transpose();
        let reach = self.bounds.min.abs().max(self.bounds.max.abs()).as_dvec3();
        let (mut low, mut high) = (DVec3::ZERO, DVec3::ZERO);
        for (axis, row) in [rows.x_axis, rows.y_axis, rows.z_axis].into_iter().enumerate() {
            let spread = row.abs().dot(reach);
            if spread > LARGEST || spread.is_nan() {
                return Bounds3 { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY };
            }
            let (a, b) = self.along(row.as_vec3());
            let (a, b) = (
                f64::from(a) + parent_from_child.translation[axis],
                f64::from(b) + parent_from_child.translation[axis],
            );
            let margin = (2.0 * spread + a.abs().max(b.abs())) * 8.0 * f64::from(f32::EPSILON);
            (low[axis], high[axis]) = (a - margin, b + margin);
        }
        let (low, high) = (low.as_vec3().to_array(), high.as_vec3().to_array());
        Bounds3 { min: Vec3::from(low.map(f32::next_down)), max: Vec3::from(high.map(f32::next_up)) }
    }

    /// Smallest and largest product of a vector with the boxes' points.
    fn along(&self, v: Vec3) -> (f32, f32) {
        let ([cx, cy, cz], [hx, hy, hz]) = (&self.centers, &self.halves);
        let count = cx.len();
        let ([cy, cz], [hx, hy, hz]) = ([&cy[..count], &cz[..count]], [&hx[..count], &hy[..count], &hz[..count]]);
        let a = v.abs();
        let mut ends = (f32::INFINITY, f32::NEG_INFINITY);
        for i in 0..count {
            let center = v.x * cx[i] + v.y * cy[i] + v.z * cz[i];
            let half = a.x * hx[i] + a.y * hy[i] + a.z * hz[i];
            let (low, high) = (center - half, center + half);
            ends = (if low < ends.0 { low } else { ends.0 }, if high > ends.1 { high } else { ends.1 });
        }
        ends
    }
}

/// The covers of what a group's instances show, each worked out once.
#[derive(Default)]
pub(crate) struct Covers(HashMap<usize, Cover>);

impl Covers {
    pub fn of(&mut self, child: &Child) -> &Cover {
        self.0.entry(child.address()).or_insert_with(|| Cover::new(child.bounds(), &child.cover()))
    }
}
