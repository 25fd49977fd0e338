//! Building a wide tree.
//!
//! Sets are split from the top by the surface area heuristic ([`grow`]) until they are one thread's work; each such
//! part becomes a binary tree ([`part`]) and then a wide one ([`collapse`]). obvhs moves subtrees to where they cost
//! less ([`optimize`]): those of a small tree all, those of a large one down to the parts. Last, the parts are put
//! together ([`join`]). The tree is the same whatever the number of threads.

use umber_math::Bounds3;

use crate::wide::{ChildRef, WideNode};

mod bins;
mod collapse;
mod grow;
mod join;
mod optimize;
mod part;
mod primitive;

pub(crate) use primitive::PrimitiveBox;

/// What a tree should be like.
#[derive(Clone, Copy)]
pub(crate) struct Shape {
    /// Most primitives of a leaf.
    pub leaf_size: usize,
    /// Primitives that cost about as much as one: a power of two.
    pub block: usize,
    /// Levels after which sets are halved as they lie, so that no tree is much deeper.
    pub most_levels: usize,
    /// Trees of at most as many primitives are made by one thread, which then has time for all their nodes.
    pub small: usize,
}

impl Shape {
    /// For triangles, of which up to `leaf_size` are visited at once.
    pub fn of_triangles(leaf_size: usize) -> Self {
        Self { leaf_size, block: 4, most_levels: 56, small: 16_384 }
    }
    /// For primitives that are costly to visit, as instances are: each is a leaf of its own.
    pub fn of_costly() -> Self {
        Self { leaf_size: 1, block: 1, most_levels: 56, small: 1 << 17 }
    }
    /// For boxes that make other trees degenerate into chains.
    pub fn balanced(self) -> Self {
        Self { most_levels: 0, small: 0, ..self }
    }
}

/// A wide tree or a part of one.
pub(crate) struct Wide {
    /// Parents lie before their children.
    pub nodes: Vec<WideNode>,
    pub root: ChildRef,
    /// Most stack entries that a traversal can need.
    pub stack_need: usize,
    /// What a visit costs by the surface area heuristic, not yet divided by the area of the whole.
    pub cost: f32,
}

/// Builds over finite boxes, at least one of them, that are neither too large nor too small for their areas to be
/// floats. Also gives the caller's index of each primitive, in the tree's order.
pub(crate) fn build(boxes: Vec<PrimitiveBox>, shape: Shape) -> (Wide, Vec<u32>) {
    if boxes.len() <= shape.small { part::whole(boxes, shape) } else { join::join(&grow::grow(boxes, shape)) }
}

/// A node of a binary tree, over the leaves from `start` on; node 0 is the root, and children lie behind their
/// parents.
#[derive(Clone, Copy, Debug)]
struct BinaryNode {
    bounds: Bounds3,
    /// Its first child; the second follows it. Zero for a leaf.
    first: u32,
    start: u32,
    count: u32,
}

impl BinaryNode {
    fn leaf(start: usize, count: usize) -> Self {
        Self { bounds: Bounds3::EMPTY, first: 0, start: start as u32, count: count as u32 }
    }
    fn is_leaf(&self) -> bool {
        self.first == 0
    }
    fn half_area(&self) -> f32 {
        let s = self.bounds.max - self.bounds.min;
        s.x * s.y + s.y * s.z + s.z * s.x
    }
}
