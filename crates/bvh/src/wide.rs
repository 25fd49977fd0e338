//! The wide hierarchy: eight children a node, laid out for vector units.

use umber_math::Bounds3;

use crate::binary::BinaryTree;

mod collapse;

/// Most children of a node, and most primitives of a leaf.
pub(crate) const WIDTH: usize = 8;

/// Entries of a traversal's stack. A tree that could need more is rebuilt balanced.
pub(crate) const STACK_SIZE: usize = 256;

/// Most primitives of one tree: what a child reference can tell.
pub(crate) const MAX_PRIMITIVES: usize = (1 << 28) - WIDTH;

/// A child: an inner node, or a leaf of up to [`WIDTH`] primitives that lie side by side in the tree's order.
///
/// Bit 31 tells a leaf, whose low three bits are the number of primitives less one and the others
/// the first of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub(crate) struct ChildRef(pub u32);

impl ChildRef {
    /// A child that is not there. No ray meets its box.
    pub const NONE: Self = Self(u32::MAX);

    pub fn node(index: usize) -> Self {
        Self(index as u32)
    }
    pub fn leaf(start: usize, count: usize) -> Self {
        Self(1 << 31 | (start as u32) << 3 | (count as u32 - 1))
    }
    #[inline(always)]
    pub fn is_leaf(self) -> bool {
        self.0 as i32 <= -1
    }
    /// First primitive and number of them.
    #[inline(always)]
    pub fn range(self) -> (usize, usize) {
        ((self.0 as usize & 0x7fff_ffff) >> 3, (self.0 as usize & 7) + 1)
    }
}

/// Eight boxes and what is in them: four cache lines.
#[derive(Clone)]
#[repr(C, align(64))]
pub(crate) struct WideNode {
    /// Smaller and larger plane of x, then y, then z: a row of eight each. Empty boxes have `∞` and `−∞`.
    pub planes: [[f32; WIDTH]; 6],
    pub children: [ChildRef; WIDTH],
}

impl WideNode {
    fn empty() -> Self {
        let (low, high) = ([f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]);
        Self { planes: [low, high, low, high, low, high], children: [ChildRef::NONE; WIDTH] }
    }
    fn set_bounds(&mut self, child: usize, b: Bounds3) {
        for axis in 0..3 {
            self.planes[2 * axis][child] = b.min[axis];
            self.planes[2 * axis + 1][child] = b.max[axis];
        }
    }
    fn bounds(&self) -> Bounds3 {
        let low = |axis: usize| self.planes[2 * axis].iter().copied().fold(f32::INFINITY, f32::min);
        let high = |axis: usize| self.planes[2 * axis + 1].iter().copied().fold(f32::NEG_INFINITY, f32::max);
        Bounds3 { min: [low(0), low(1), low(2)].into(), max: [high(0), high(1), high(2)].into() }
    }
}

/// A wide tree over primitives that the owner keeps in the tree's order.
#[derive(Clone)]
pub(crate) struct WideTree {
    /// Parents lie before their children.
    pub nodes: Vec<WideNode>,
    pub root: ChildRef,
    pub bounds: Bounds3,
}

impl WideTree {
    /// Builds over finite boxes, at most [`MAX_PRIMITIVES`]; `leaf_size` primitives a leaf, at most
    /// [`WIDTH`]. Also gives the primitives' order: where leaf ranges point, these primitives belong.
    pub fn build(boxes: &[Bounds3], leaf_size: usize) -> (Self, Vec<u32>) {
        let mut collapsed = collapse::collapse(&BinaryTree::build(boxes), leaf_size);
        if collapsed.stack_need > STACK_SIZE {
            collapsed = collapse::collapse(&BinaryTree::balanced(&collapsed.order, boxes), leaf_size);
        }
        let collapse::Collapsed { nodes, root, order, .. } = collapsed;
        let mut tree = Self { nodes, root, bounds: Bounds3::EMPTY };
        tree.fit(|start, count| {
            order[start..start + count].iter().fold(Bounds3::EMPTY, |b, &i| b.union(boxes[i as usize]))
        });
        (tree, order)
    }

    /// Sets every box from the leaves up. `leaf_bounds` gives the box of a range of primitives.
    pub fn fit(&mut self, leaf_bounds: impl Fn(usize, usize) -> Bounds3) {
        for index in (0..self.nodes.len()).rev() {
            for child in 0..WIDTH {
                let bounds = self.bounds_of(self.nodes[index].children[child], &leaf_bounds);
                self.nodes[index].set_bounds(child, bounds);
            }
        }
        self.bounds = self.bounds_of(self.root, &leaf_bounds);
    }

    fn bounds_of(&self, child: ChildRef, leaf_bounds: &impl Fn(usize, usize) -> Bounds3) -> Bounds3 {
        if child == ChildRef::NONE {
            Bounds3::EMPTY
        } else if child.is_leaf() {
            let (start, count) = child.range();
            leaf_bounds(start, count)
        } else {
            self.nodes[child.0 as usize].bounds()
        }
    }

    /// First primitive and number of primitives of each leaf.
    pub fn leaves(&self) -> impl Iterator<Item = (usize, usize)> {
        let root = self.nodes.is_empty().then_some(&self.root);
        let children = root.into_iter().chain(self.nodes.iter().flat_map(|n| &n.children));
        children.filter(|c| **c != ChildRef::NONE && c.is_leaf()).map(|c| c.range())
    }

    pub fn memory_bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<WideNode>()
    }
}
