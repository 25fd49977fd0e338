//! The tree from the top down, on all threads; the same tree whatever their number.

use std::mem;

use rayon::prelude::*;

use super::{
    BinaryNode, BinaryTree,
    bins::{Bins, Mapping, Split},
    primitive::{Box4, PrimitiveBox},
};

/// Sets of at most as many primitives are one thread's work.
const TASK: usize = 8192;
/// Larger ones are gone through in pieces of this size, on all threads.
const PIECE: usize = 16384;

/// What the tree should be like.
#[derive(Clone, Copy)]
pub(super) struct Shape {
    /// Most primitives of a leaf.
    pub leaf_size: usize,
    /// Primitives that cost as much as one: a power of two.
    pub block: usize,
    /// Levels after which sets are halved as they lie.
    pub most_levels: usize,
}

/// A subtree.
enum Subtree {
    /// One thread's work; children are counted from its own root, which is node 0.
    Whole(Vec<BinaryNode>),
    Fork(BinaryNode, Box<[Subtree; 2]>),
}

/// Builds the tree; there is at least one primitive.
pub(super) fn grow(mut primitives: Vec<PrimitiveBox>, shape: Shape) -> BinaryTree {
    let mut spare = if primitives.len() > TASK { primitives.clone() } else { Vec::new() };
    let mut order = vec![0; primitives.len()];
    let set = Set { primitives: &mut primitives, spare: &mut spare, order: &mut order, start: 0 };
    let tree = set.grow(shape, 0);
    drop((primitives, spare));
    let (nodes, parts) = join(tree);
    BinaryTree { nodes, order, parts }
}

/// Primitives that lie side by side in the order, and room for as many.
struct Set<'a> {
    primitives: &'a mut [PrimitiveBox],
    spare: &'a mut [PrimitiveBox],
    order: &'a mut [u32],
    start: usize,
}

impl Set<'_> {
    fn grow(mut self, shape: Shape, level: usize) -> Subtree {
        let count = self.primitives.len();
        if count <= TASK {
            let mut task = Task { nodes: Vec::with_capacity(count), spare: Vec::new(), bins: Bins::new(), shape };
            task.nodes.push(leaf(self.start, count));
            task.fill(0, self.primitives, self.start, level);
            self.order.iter_mut().zip(&*self.primitives).for_each(|(slot, p)| *slot = p.index());
            return Subtree::Whole(task.nodes);
        }
        let around = |mut a: (Box4, Box4), b: &PrimitiveBox| {
            a.0.add(b);
            a.1.add_point(b.center2());
            a
        };
        let empty = || (Box4::EMPTY, Box4::EMPTY);
        let (bounds, centers) = self
            .primitives
            .par_chunks(PIECE)
            .map(|piece| piece.iter().fold(empty(), around))
            .reduce(empty, |a, b| (a.0.union(b.0), a.1.union(b.1)));
        let mapping = Mapping::new(centers, count);
        let middle = (level < shape.most_levels).then(|| self.split(&mapping, shape.block)).flatten();
        // Split, the primitives are in what was spare.
        let (primitives, spare) =
            if middle.is_some() { (self.spare, self.primitives) } else { (self.primitives, self.spare) };
        let middle = middle.unwrap_or(count / 2);
        let (left, right) = primitives.split_at_mut(middle);
        let (left_spare, right_spare) = spare.split_at_mut(middle);
        let (left_order, right_order) = self.order.split_at_mut(middle);
        let left = Set { primitives: left, spare: left_spare, order: left_order, start: self.start };
        let right = Set { primitives: right, spare: right_spare, order: right_order, start: self.start + middle };
        let (left, right) = rayon::join(|| left.grow(shape, level + 1), || right.grow(shape, level + 1));
        let node = BinaryNode { bounds: bounds.bounds(), ..leaf(self.start, count) };
        Subtree::Fork(node, Box::new([left, right]))
    }

    /// Copies the primitives to the spare room, those left of the best plane first; gives the number of these. None,
    /// and nothing is done, where there is no plane.
    fn split(&mut self, mapping: &Mapping, block: usize) -> Option<usize> {
        let pieces: Vec<&[PrimitiveBox]> = self.primitives.chunks(PIECE).collect();
        let bins: Vec<Bins> = pieces
            .par_iter()
            .map(|piece| {
                let mut bins = Bins::new();
                bins.add_all(piece, mapping);
                bins
            })
            .collect();
        let mut all = Bins::new();
        bins.iter().for_each(|b| all.merge(b));
        let split = all.best_split(mapping, block)?;
        let lefts: Vec<usize> =
            bins.iter().map(|b| b.counts[split.axis][..split.bin].iter().sum::<u32>() as usize).collect();
        let middle = lefts.iter().sum();
        let (mut left, mut right) = self.spare.split_at_mut(middle);
        let mut moves = Vec::with_capacity(pieces.len());
        for (piece, &count) in pieces.into_iter().zip(&lefts) {
            let (to_left, left_rest) = mem::take(&mut left).split_at_mut(count);
            let (to_right, right_rest) = mem::take(&mut right).split_at_mut(piece.len() - count);
            (left, right) = (left_rest, right_rest);
            moves.push((piece, to_left, to_right));
        }
        moves.into_par_iter().for_each(|(piece, to_left, to_right)| {
            let (mut to_left, mut to_right) = (to_left.iter_mut(), to_right.iter_mut());
            for p in piece {
                let to = if split.is_right(mapping, p) { to_right.next() } else { to_left.next() };
                to.into_iter().for_each(|slot| *slot = *p);
            }
        });
        Some(middle)
    }
}

/// One thread's part of the work.
struct Task {
    nodes: Vec<BinaryNode>,
    /// Room for what goes to the right.
    spare: Vec<PrimitiveBox>,
    bins: Bins,
    shape: Shape,
}

impl Task {
    /// Makes the subtree of a node over primitives; at most [`Shape::most_levels`] deep, and as many as halving takes.
    fn fill(&mut self, node: usize, primitives: &mut [PrimitiveBox], start: usize, level: usize) {
        let (mut bounds, mut centers) = (Box4::EMPTY, Box4::EMPTY);
        for p in &*primitives {
            bounds.add(p);
            centers.add_point(p.center2());
        }
        let count = primitives.len();
        self.nodes[node] = BinaryNode { bounds: bounds.bounds(), ..leaf(start, count) };
        if count <= self.shape.leaf_size {
            return;
        }
        let middle = match self.best_split(primitives, centers, level) {
            Some((mapping, split)) => self.partition(primitives, &mapping, split),
            None => count / 2,
        };
        let first = self.nodes.len();
        self.nodes[node].first = first as u32;
        self.nodes.extend([leaf(start, middle), leaf(start + middle, count - middle)]);
        let (left, right) = primitives.split_at_mut(middle);
        self.fill(first, left, start, level + 1);
        self.fill(first + 1, right, start + middle, level + 1);
    }

    fn best_split(&mut self, primitives: &[PrimitiveBox], centers: Box4, level: usize) -> Option<(Mapping, Split)> {
        if level >= self.shape.most_levels || primitives.len() == 2 {
            return None;
        }
        let mapping = Mapping::new(centers, primitives.len());
        self.bins.clear(&mapping);
        self.bins.add_all(primitives, &mapping);
        self.bins.best_split(&mapping, self.shape.block).map(|split| (mapping, split))
    }

    /// Moves those on the left to the front, in their order; gives their number.
    fn partition(&mut self, primitives: &mut [PrimitiveBox], mapping: &Mapping, split: Split) -> usize {
        self.spare.clear();
        let mut left = 0;
        for i in 0..primitives.len() {
            let p = primitives[i];
            if split.is_right(mapping, &p) {
                self.spare.push(p);
            } else {
                primitives[left] = p;
                left += 1;
            }
        }
        primitives[left..].copy_from_slice(&self.spare);
        left
    }
}

fn leaf(start: usize, count: usize) -> BinaryNode {
    BinaryNode { bounds: umber_math::Bounds3::EMPTY, first: 0, start: start as u32, count: count as u32 }
}

/// All nodes in one list, and where the parts begin in it.
fn join(tree: Subtree) -> (Vec<BinaryNode>, Vec<usize>) {
    let mut nodes = vec![leaf(0, 0)];
    // The nodes of each part, without its root, and where its children are then.
    let mut parts: Vec<Vec<BinaryNode>> = Vec::new();
    let mut roots = Vec::new();
    let mut work = vec![(0, tree)];
    while let Some((at, tree)) = work.pop() {
        match tree {
            Subtree::Fork(node, children) => {
                let first = nodes.len();
                nodes[at] = BinaryNode { first: first as u32, ..node };
                nodes.extend([leaf(0, 0); 2]);
                let [left, right] = *children;
                work.extend([(first + 1, right), (first, left)]);
            }
            Subtree::Whole(part) => {
                roots.push(at);
                parts.push(part);
            }
        }
    }
    let mut offset = nodes.len();
    nodes.reserve_exact(parts.iter().map(|p| p.len() - 1).sum());
    let mut starts = Vec::with_capacity(parts.len());
    let moved =
        |n: &BinaryNode, by: usize| BinaryNode { first: if n.first == 0 { 0 } else { n.first + by as u32 }, ..*n };
    for (root, part) in roots.into_iter().zip(&parts) {
        starts.push(offset);
        nodes[root] = moved(&part[0], offset - 1);
        nodes.extend(part[1..].iter().map(|n| moved(n, offset - 1)));
        offset += part.len() - 1;
    }
    (nodes, starts)
}
