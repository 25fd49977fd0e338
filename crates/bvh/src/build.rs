//! Building: a binary tree by the surface area heuristic, which is then laid out wide.
//!
//! Trees are split from the top by binned costs ([`grow`]); obvhs then moves subtrees of the top to where they
//! cost less (`optimize`).

#[cfg(test)]
use glam::Vec3;
use umber_math::Bounds3;

mod bins;
mod grow;
mod optimize;
mod primitive;

pub(crate) use primitive::PrimitiveBox;

/// A node over the primitives from `start` on, in the tree's order.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BinaryNode {
    pub bounds: Bounds3,
    /// Its first child; the second follows it. Zero for a leaf.
    pub first: u32,
    pub start: u32,
    pub count: u32,
}

impl BinaryNode {
    pub fn is_leaf(&self) -> bool {
        self.first == 0
    }
    pub fn half_area(&self) -> f32 {
        let s = self.bounds.max - self.bounds.min;
        s.x * s.y + s.y * s.z + s.z * s.x
    }
}

/// A binary tree; node 0 is the root, and children lie behind their parents.
pub(crate) struct BinaryTree {
    pub nodes: Vec<BinaryNode>,
    /// The caller's index of each primitive, in the tree's order.
    pub order: Vec<u32>,
    /// Where the parts begin that have children in themselves alone, for work on several threads. What is
    /// before the first one has children anywhere.
    pub parts: Vec<usize>,
}

impl BinaryTree {
    /// Builds over finite boxes, at least one of them, that are neither too large nor too small for their
    /// areas to be floats.
    ///
    /// Each primitive is a leaf of its own. Where they are not `costly` to visit, as instances are, several are
    /// taken to cost as much as one.
    pub fn build(boxes: Vec<PrimitiveBox>, costly: bool) -> Self {
        let block = if costly { 1 } else { BLOCK };
        grow::grow(boxes, grow::Shape { leaf_size: 1, block, most_levels: MOST_LEVELS, optimize: true })
    }

    /// A balanced tree, for boxes that make the other one degenerate into a chain.
    pub fn balanced(boxes: Vec<PrimitiveBox>, leaf_size: usize) -> Self {
        grow::grow(boxes, grow::Shape { leaf_size, block: 1, most_levels: 0, optimize: false })
    }
}

#[cfg(test)]
impl BinaryTree {
    /// A tree in which each node has one leaf and all the rest.
    pub fn chain(count: u32) -> Self {
        let bounds = |start: u32| Bounds3 { min: Vec3::splat(start as f32), max: Vec3::splat(count as f32) };
        let leaf = |i: u32| BinaryNode {
            bounds: Bounds3 { max: Vec3::splat(1.0 + i as f32), ..bounds(i) },
            first: 0,
            start: i,
            count: 1,
        };
        let rest = |i: u32| match i == count - 1 {
            true => leaf(i),
            false => BinaryNode { bounds: bounds(i), first: 2 * i + 1, start: i, count: count - i },
        };
        let nodes = std::iter::once(rest(0)).chain((0..count - 1).flat_map(|i| [leaf(i), rest(i + 1)])).collect();
        Self { nodes, order: (0..count).collect(), parts: Vec::new() }
    }
}

/// Triangles that are about as costly to visit together as one.
const BLOCK: usize = 4;
/// Levels after which sets are halved, so that no tree is much deeper.
const MOST_LEVELS: usize = 56;
