//! One thread's part of a tree.

use std::mem;

use super::{
    BinaryNode, Shape, Wide,
    bins::{Bins, Mapping, Split},
    collapse::{Leaves, collapse},
    optimize,
    primitive::{Box4, PrimitiveBox},
};

/// A whole small tree, and the primitives' order.
pub(super) fn whole(mut primitives: Vec<PrimitiveBox>, shape: Shape) -> (Wide, Vec<u32>) {
    let nodes = binary(&mut primitives, shape, 0);
    let (nodes, leaves) = optimize::reinsert(&nodes);
    let order = leaves.iter().map(|&slot| primitives[slot as usize].index()).collect();
    (collapse(&nodes, Leaves::Primitives { most: shape.leaf_size, start: 0 }), order)
}

/// A part over primitives, at least one, that begin at `start` in the order. They are put in order.
pub(super) fn part(primitives: &mut [PrimitiveBox], start: usize, shape: Shape, level: usize) -> Wide {
    let nodes = binary(primitives, shape, level);
    collapse(&nodes, Leaves::Primitives { most: shape.leaf_size, start })
}

/// A binary tree, one primitive a leaf.
fn binary(primitives: &mut [PrimitiveBox], shape: Shape, level: usize) -> Vec<BinaryNode> {
    let mut nodes = Vec::with_capacity(2 * primitives.len() - 1);
    nodes.push(BinaryNode::leaf(0, 0));
    let mut builder = Builder { nodes, spare: Vec::new(), bins: Bins::new(), shape };
    builder.fill(0, primitives, 0, level);
    builder.nodes
}

struct Builder {
    nodes: Vec<BinaryNode>,
    /// Room for what goes to the right.
    spare: Vec<PrimitiveBox>,
    bins: Bins,
    shape: Shape,
}

impl Builder {
    /// Makes the subtree of a node over primitives; [`Shape::most_levels`] deep at most, and what halving takes.
    fn fill(&mut self, node: usize, primitives: &mut [PrimitiveBox], start: usize, level: usize) {
        let (bounds, centers) = Box4::around(primitives);
        let count = primitives.len();
        self.nodes[node] = BinaryNode { bounds: bounds.bounds(), ..BinaryNode::leaf(start, count) };
        if count == 1 {
            return;
        }
        let middle = match self.best_split(primitives, bounds, centers, level) {
            Some((mapping, split)) => self.partition(primitives, &mapping, split),
            None => count / 2,
        };
        let first = self.nodes.len();
        self.nodes[node].first = first as u32;
        self.nodes.extend([BinaryNode::leaf(0, 0); 2]);
        let (left, right) = primitives.split_at_mut(middle);
        self.fill(first, left, start, level + 1);
        self.fill(first + 1, right, start + middle, level + 1);
    }

    fn best_split(
        &mut self,
        primitives: &[PrimitiveBox],
        bounds: Box4,
        centers: Box4,
        level: usize,
    ) -> Option<(Mapping, Split)> {
        if level >= self.shape.most_levels || primitives.len() == 2 {
            return None;
        }
        let mapping = Mapping::new(bounds, centers, primitives.len());
        self.bins.clear(&mapping);
        self.bins.add_all(primitives, &mapping);
        self.bins.best_split(&mapping, self.shape.block).map(|split| (mapping, split))
    }

    /// Moves those on the left to the front, in their order; gives their number.
    fn partition(&mut self, primitives: &mut [PrimitiveBox], mapping: &Mapping, split: Split) -> usize {
        let mut spare = mem::take(&mut self.spare);
        spare.clear();
        let mut left = 0;
        for i in 0..primitives.len() {
            let p = primitives[i];
            if split.is_right(mapping, &p) {
                spare.push(p);
            } else {
                primitives[left] = p;
                left += 1;
            }
        }
        primitives[left..].copy_from_slice(&spare);
        self.spare = spare;
        left
    }
}
