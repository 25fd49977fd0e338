//! The tree from the top down, on all threads; the same tree whatever their number.

use std::mem;

use rayon::prelude::*;
use umber_math::Bounds3;

use super::{
    BinaryNode, BinaryTree,
    bins::{Bins, Mapping, Split},
    optimize,
    primitive::{Box4, PrimitiveBox},
};

/// About as many parts are built, each one thread's work.
const PARTS: usize = 2048;
/// Least and most primitives of a part.
const PART: std::ops::RangeInclusive<usize> = 32..=4096;
/// Larger sets are gone through in pieces of this size, on all threads.
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
    /// Whether the top is made better once it is there.
    pub optimize: bool,
}

/// A node above the parts.
#[derive(Clone, Copy)]
pub(super) struct TopNode {
    pub bounds: Bounds3,
    pub fork: Fork,
}

/// What is below a node of the top.
#[derive(Clone, Copy)]
pub(super) enum Fork {
    /// The first child; the second follows it.
    Children(usize),
    Part(usize),
}

/// Nodes whose children are counted from the part's own root, which is node 0; places in the order as when it was made.
type Part = Vec<BinaryNode>;

/// Builds the tree; there is at least one primitive.
pub(super) fn grow(mut primitives: Vec<PrimitiveBox>, shape: Shape) -> BinaryTree {
    let part_size = (primitives.len() / PARTS).clamp(*PART.start(), *PART.end());
    let mut spare = if primitives.len() > part_size { primitives.clone() } else { Vec::new() };
    let mut order = vec![0; primitives.len()];
    let set = Set { primitives: &mut primitives, spare: &mut spare, order: &mut order, start: 0 };
    let (top, parts) = flatten(set.grow(shape, part_size, 0));
    drop((primitives, spare));
    let top = if shape.optimize && top.len() > 3 { optimize::reinsert(&top) } else { top };
    join(&top, &parts, &order)
}

/// A subtree.
enum Subtree {
    Whole(Part),
    Fork(Bounds3, Box<[Subtree; 2]>),
}

/// The top, whose root is node 0, and the parts.
fn flatten(tree: Subtree) -> (Vec<TopNode>, Vec<Part>) {
    let empty = TopNode { bounds: Bounds3::EMPTY, fork: Fork::Part(0) };
    let (mut top, mut parts) = (vec![empty], Vec::new());
    let mut work = vec![(0, tree)];
    while let Some((at, tree)) = work.pop() {
        match tree {
            Subtree::Fork(bounds, children) => {
                let first = top.len();
                top[at] = TopNode { bounds, fork: Fork::Children(first) };
                top.extend([empty; 2]);
                let [left, right] = *children;
                work.extend([(first + 1, right), (first, left)]);
            }
            Subtree::Whole(part) => {
                top[at] = TopNode { bounds: part[0].bounds, fork: Fork::Part(parts.len()) };
                parts.push(part);
            }
        }
    }
    (top, parts)
}

/// A part on its way into the tree.
struct Move<'a> {
    part: &'a [BinaryNode],
    /// Where its nodes but the root go.
    nodes: &'a mut [BinaryNode],
    order: &'a mut [u32],
    /// Where these are, in the tree.
    at: usize,
    start: usize,
}

/// All nodes in one list, the parts in the order in which the top comes to them.
fn join(top: &[TopNode], parts: &[Part], order: &[u32]) -> BinaryTree {
    let mut nodes = vec![leaf(0, 0)];
    let mut roots = Vec::with_capacity(parts.len());
    let mut work = vec![(0, 0)];
    while let Some((at, from)) = work.pop() {
        match top[from].fork {
            Fork::Children(child) => {
                let first = nodes.len();
                nodes[at] = BinaryNode { bounds: top[from].bounds, first: first as u32, ..leaf(0, 0) };
                nodes.extend([leaf(0, 0); 2]);
                work.extend([(first + 1, child + 1), (first, child)]);
            }
            Fork::Part(part) => roots.push((at, part)),
        }
    }
    let above = nodes.len();
    nodes.resize(above + parts.iter().map(|p| p.len() - 1).sum::<usize>(), leaf(0, 0));
    let mut new_order = vec![0; order.len()];
    let (head, mut nodes_left) = nodes.split_at_mut(above);
    let (mut order_left, mut start, mut at) = (&mut new_order[..], 0, above);
    let (mut moves, mut starts) = (Vec::with_capacity(parts.len()), Vec::with_capacity(parts.len()));
    for &(root, part) in &roots {
        let part = &parts[part][..];
        let (to, rest) = mem::take(&mut nodes_left).split_at_mut(part.len() - 1);
        let (order, order_rest) = mem::take(&mut order_left).split_at_mut(part[0].count as usize);
        (nodes_left, order_left) = (rest, order_rest);
        let moved = Move { part, nodes: to, order, at, start };
        head[root] = moved.node(&part[0]);
        starts.push(at);
        at += part.len() - 1;
        start += part[0].count as usize;
        moves.push(moved);
    }
    moves.into_par_iter().with_min_len(16).for_each(|m| m.run(order));
    for i in (0..above).rev().filter(|&i| nodes[i].count == 0).collect::<Vec<_>>() {
        let [left, right] = [0, 1].map(|k| nodes[nodes[i].first as usize + k]);
        nodes[i] = BinaryNode { start: left.start, count: left.count + right.count, ..nodes[i] };
    }
    BinaryTree { nodes, order: new_order, parts: starts }
}

impl Move<'_> {
    /// A node of the part as it is in the tree.
    fn node(&self, n: &BinaryNode) -> BinaryNode {
        let first = if n.is_leaf() { 0 } else { n.first + self.at as u32 - 1 };
        BinaryNode { first, start: n.start - self.part[0].start + self.start as u32, ..*n }
    }

    fn run(mut self, order: &[u32]) {
        let nodes = mem::take(&mut self.nodes);
        nodes.iter_mut().zip(&self.part[1..]).for_each(|(to, from)| *to = self.node(from));
        let from = self.part[0].start as usize;
        self.order.copy_from_slice(&order[from..from + self.order.len()]);
    }
}

/// Primitives that lie side by side in the order, and room for as many.
struct Set<'a> {
    primitives: &'a mut [PrimitiveBox],
    spare: &'a mut [PrimitiveBox],
    order: &'a mut [u32],
    start: usize,
}

impl Set<'_> {
    fn grow(mut self, shape: Shape, part_size: usize, level: usize) -> Subtree {
        let count = self.primitives.len();
        if count <= part_size {
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
        let mapping = Mapping::new(bounds, centers, count);
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
        let (left, right) =
            rayon::join(|| left.grow(shape, part_size, level + 1), || right.grow(shape, part_size, level + 1));
        Subtree::Fork(bounds.bounds(), Box::new([left, right]))
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
            bins.iter().map(|b| b.counts[split.key][..split.bin].iter().sum::<u32>() as usize).collect();
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
        let middle = match self.best_split(primitives, bounds, centers, level) {
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
    BinaryNode { bounds: Bounds3::EMPTY, first: 0, start: start as u32, count: count as u32 }
}
