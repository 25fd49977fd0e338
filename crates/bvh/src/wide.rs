//! The wide hierarchy: eight children a node, laid out for vector units.

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use umber_math::Bounds3;

use crate::build::{self, PrimitiveBox, Shape, Wide};

/// Most children of a node, and most primitives of a leaf.
pub(crate) const WIDTH: usize = 8;

/// Entries of a traversal's stack. A tree that could need more is rebuilt balanced.
pub(crate) const STACK_SIZE: usize = 256;

/// A tree is fitted to moved primitives until it costs so many times what it did when built.
pub(crate) const MOST_GROWTH: f64 = 1.5;

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
    pub fn empty() -> Self {
        let (low, high) = ([f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]);
        Self { planes: [low, high, low, high, low, high], children: [ChildRef::NONE; WIDTH] }
    }
    pub fn set_bounds(&mut self, child: usize, b: Bounds3) {
        for axis in 0..3 {
            self.planes[2 * axis][child] = b.min[axis];
            self.planes[2 * axis + 1][child] = b.max[axis];
        }
    }
    fn child_bounds(&self, child: usize) -> Bounds3 {
        let corner = |k: usize| Vec3::from([0, 1, 2].map(|axis| self.planes[2 * axis + k][child]));
        Bounds3 { min: corner(0), max: corner(1) }
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
    /// Builds over the boxes of `count` primitives, at most [`MAX_PRIMITIVES`]; those without a box, which else must be
    /// finite, are left out. `leaf_size` primitives a leaf, at most [`WIDTH`]; one where they are costly to visit.
    /// Also gives the primitives' order: where leaf ranges point, these primitives belong.
    pub fn build(count: usize, leaf_size: usize, bounds: impl Fn(u32) -> Option<Bounds3> + Sync) -> (Self, Vec<u32>) {
        let primitive = |i: u32| bounds(i).map(|b| PrimitiveBox::new(b, i));
        let mut boxes: Vec<PrimitiveBox> = Vec::with_capacity(count);
        (0..count as u32)
            .into_par_iter()
            .map(|i| primitive(i).unwrap_or(PrimitiveBox::NONE))
            .collect_into_vec(&mut boxes);
        let around = |(all, some): (Bounds3, usize), b: &PrimitiveBox| {
            if b.is_none() { (all, some) } else { (all.union(b.bounds()), some + 1) }
        };
        let pieces = boxes.par_chunks(1 << 14).map(|c| c.iter().fold((Bounds3::EMPTY, 0), around));
        let (all, some) = pieces.reduce(|| (Bounds3::EMPTY, 0), |a, b| (a.0.union(b.0), a.1 + b.1));
        if some < boxes.len() {
            boxes.retain(|b| !b.is_none());
        }
        if boxes.is_empty() {
            return (Self { nodes: Vec::new(), root: ChildRef::NONE, bounds: Bounds3::EMPTY }, Vec::new());
        }
        let scale = Scale::for_bounds(all);
        if let Some(scale) = &scale {
            boxes.iter_mut().for_each(|b| *b = PrimitiveBox::new(scale.apply(b.bounds()), b.index()));
        }
        let shape = if leaf_size == 1 { Shape::of_costly() } else { Shape::of_triangles(leaf_size) };
        let (mut wide, mut order) = build::build(boxes, shape);
        if wide.stack_need > STACK_SIZE {
            (wide, order) = build::build(order.iter().filter_map(|&i| primitive(i)).collect(), shape.balanced());
        }
        let Wide { nodes, root, .. } = wide;
        let mut tree = Self { nodes, root, bounds: all };
        if scale.is_some() {
            let bounds = |i: &u32| bounds(*i).unwrap_or(Bounds3::EMPTY);
            tree.fit(|start, count| order[start..start + count].iter().fold(Bounds3::EMPTY, |b, i| b.union(bounds(i))));
        }
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

    /// What a ray through the tree's box is expected to visit, by the surface area heuristic: nodes and leaves alike.
    pub fn cost(&self) -> f64 {
        let area = |b: Bounds3| {
            let s = b.size().as_dvec3();
            s.x * s.y + s.y * s.z + s.z * s.x
        };
        let of_node = |n: &WideNode| (0..WIDTH).map(|slot| area(n.child_bounds(slot))).sum::<f64>();
        let all: f64 = self.nodes.par_iter().with_min_len(1024).map(of_node).sum();
        1.0 + all / area(self.bounds).max(f64::MIN_POSITIVE)
    }

    /// The box of each primitive of a tree with one a leaf, in the tree's order.
    pub fn leaf_boxes(&self, count: usize) -> Vec<Bounds3> {
        let mut boxes = vec![self.bounds; count];
        for node in &self.nodes {
            for (slot, child) in node.children.iter().enumerate() {
                if *child != ChildRef::NONE && child.is_leaf() {
                    boxes[child.range().0] = node.child_bounds(slot);
                }
            }
        }
        boxes
    }

    /// Boxes that hold all primitives: those two levels down, at most [`WIDTH`]².
    pub fn cover(&self) -> Vec<Bounds3> {
        let children = |child: ChildRef| {
            let node = (!child.is_leaf()).then(|| &self.nodes[child.0 as usize]);
            node.into_iter().flat_map(|n| (0..WIDTH).map(move |slot| (n.children[slot], n.child_bounds(slot))))
        };
        let mut boxes = Vec::new();
        for (child, bounds) in children(self.root).filter(|(c, _)| *c != ChildRef::NONE) {
            let before = boxes.len();
            boxes.extend(children(child).filter(|(c, _)| *c != ChildRef::NONE).map(|(_, bounds)| bounds));
            if boxes.len() == before {
                boxes.push(bounds);
            }
        }
        if boxes.is_empty() { vec![self.bounds] } else { boxes }
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

/// Brings boxes to about unit size.
struct Scale {
    low: DVec3,
    factor: f64,
}

impl Scale {
    /// Where areas would over- or underflow.
    fn for_bounds(all: Bounds3) -> Option<Self> {
        let (low, high) = (all.min.as_dvec3(), all.max.as_dvec3());
        let extent = (high - low).max_element();
        (extent > 0.0 && !(1e-12..1e12).contains(&extent)).then(|| Self { low, factor: extent.recip() })
    }
    fn apply(&self, b: Bounds3) -> Bounds3 {
        let scaled = |v: Vec3| ((v.as_dvec3() - self.low) * self.factor).as_vec3();
        Bounds3 { min: scaled(b.min), max: scaled(b.max) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use umber_math::Point3;

    #[test]
    fn parents_hold_their_children_and_every_primitive_is_in_one_leaf() {
        for (primitives, leaf_size) in [(3000, 1), (3000, 3), (3000, 8), (70_000, 8), (1, 8), (8, 8), (9, 8)] {
            let corner = |i: u32| Point3::new((i * 7919 % 101) as f32, (i * 4729 % 97) as f32, (i * 31 % 89) as f32);
            let bounds = |i: u32| Some(Bounds3::of_points([corner(i), Point3(corner(i).0 + 1.5)]));
            let (tree, order) = WideTree::build(primitives, leaf_size, |i| bounds(i).filter(|_| i % 100 != 99));
            let mut slots = vec![0; primitives];
            for (start, count) in tree.leaves() {
                assert!(count <= leaf_size);
                order[start..start + count].iter().for_each(|&i| slots[i as usize] += 1);
            }
            assert!(slots.iter().enumerate().all(|(i, &n)| n == usize::from(i % 100 != 99)));
            for (i, node) in tree.nodes.iter().enumerate() {
                for (slot, child) in node.children.iter().enumerate().filter(|(_, c)| **c != ChildRef::NONE) {
                    let within = if child.is_leaf() {
                        let (start, count) = child.range();
                        order[start..start + count]
                            .iter()
                            .filter_map(|&i| bounds(i))
                            .fold(Bounds3::EMPTY, Bounds3::union)
                    } else {
                        assert!(child.0 as usize > i, "a child lies before its parent");
                        tree.nodes[child.0 as usize].bounds()
                    };
                    assert_eq!(node.child_bounds(slot), within);
                }
            }
        }
    }
}
