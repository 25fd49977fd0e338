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
        let mut collapsed = collapse::collapse(&BinaryTree::build(boxes, leaf_size == 1), leaf_size);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::binary::BinaryNode;
    use umber_math::Point3;

    /// A binary tree in which each node has one leaf and all the rest.
    fn chain(count: u32) -> BinaryTree {
        let area = |left: u32| left as f32 * left as f32;
        let mut nodes = vec![BinaryNode { half_area: area(count), first: 1, is_leaf: false }];
        for i in 0..count - 1 {
            let last = i == count - 2;
            let rest = if last { count - 1 } else { 2 * i + 3 };
            nodes.push(BinaryNode { half_area: 1.0, first: i, is_leaf: true });
            nodes.push(BinaryNode { half_area: area(count - 1 - i), first: rest, is_leaf: last });
        }
        BinaryTree { nodes }
    }

    #[test]
    fn chains_are_found_too_deep_and_balanced_trees_are_not() {
        let count = 5000;
        let boxes: Vec<Bounds3> = (0..count).map(|i| Bounds3::of_points([Point3::new(i as f32, 0.0, 0.0)])).collect();
        let deep = collapse::collapse(&chain(count), 1);
        assert!(deep.stack_need > STACK_SIZE, "{}", deep.stack_need);
        let mut order = deep.order.clone();
        order.sort_unstable();
        assert!(order.iter().copied().eq(0..count), "a primitive is lost");
        let shallow = collapse::collapse(&BinaryTree::balanced(&deep.order, &boxes), 1);
        assert!(shallow.stack_need <= STACK_SIZE, "{}", shallow.stack_need);
        assert_eq!(shallow.order.len(), count as usize);
    }

    #[test]
    fn parents_hold_their_children_and_every_primitive_is_in_one_leaf() {
        let boxes: Vec<Bounds3> = (0..3000u32)
            .map(|i| Point3::new((i * 7919 % 101) as f32, (i * 104_729 % 97) as f32, (i * 31 % 89) as f32))
            .map(|p| Bounds3::of_points([p, Point3(p.0 + 1.5)]))
            .collect();
        for leaf_size in [1, 3, 8] {
            let (tree, order) = WideTree::build(&boxes, leaf_size);
            let mut slots = vec![0; boxes.len()];
            for (start, count) in tree.leaves() {
                assert!(count <= leaf_size);
                order[start..start + count].iter().for_each(|&i| slots[i as usize] += 1);
            }
            assert!(slots.iter().all(|&n| n == 1));
            for (i, node) in tree.nodes.iter().enumerate() {
                for child in node.children.iter().filter(|c| **c != ChildRef::NONE && !c.is_leaf()) {
                    assert!(child.0 as usize > i, "a child lies before its parent");
                    assert_eq!(node.bounds().union(tree.nodes[child.0 as usize].bounds()), node.bounds());
                }
            }
        }
    }
}
