//! A hierarchy over boxes alone, for primitives that are not triangles.

use umber_math::{Bounds3, Ray};

use crate::{
    ray::TraversalRay,
    simd::{self, SimdLevel},
    wide::{MAX_PRIMITIVES, WideTree},
};

/// Finds the boxes that a ray meets.
#[derive(Clone)]
pub struct BoundsBvh {
    tree: WideTree,
    /// The caller's index of each box, in the tree's order.
    order: Vec<u32>,
}

impl BoundsBvh {
    /// Builds the hierarchy. Boxes that are empty or not finite are never met.
    pub fn build(boxes: &[Bounds3]) -> Self {
        let usable = |b: &Bounds3| !b.is_empty() && b.min.is_finite() && b.max.is_finite();
        let bounds = |i: u32| Some(boxes[i as usize]).filter(usable);
        let (tree, order) = WideTree::build(boxes.len().min(MAX_PRIMITIVES), 1, bounds);
        Self { tree, order }
    }

    /// Calls `visit` for each box that the ray meets, roughly nearest first, with its index and the
    /// ray's end so far. A number that it gives becomes the new end, if it is smaller.
    ///
    /// Boxes are met conservatively: `visit` has the last word on its primitive.
    pub fn traverse(&self, ray: &Ray, mut visit: impl FnMut(u32, f32) -> Option<f32>) {
        if let Some(prepared) = TraversalRay::new(ray) {
            simd::visit_boxes(SimdLevel::best(), &self.tree, &prepared, ray.t_max, |slot, t_max| {
                visit(self.order[slot], t_max)
            });
        }
    }

    /// A box around all.
    pub fn bounds(&self) -> Bounds3 {
        self.tree.bounds
    }

    /// Memory held, in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Self>() + self.tree.memory_bytes() + self.order.capacity() * 4
    }
}
