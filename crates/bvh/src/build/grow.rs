//! The top of a large tree, on all threads.

use std::mem;

use rayon::prelude::*;
use umber_math::Bounds3;

use super::{
    BinaryNode, Shape, Wide,
    bins::{Bins, Mapping},
    part::part,
    primitive::{Box4, PrimitiveBox},
};

/// About as many parts are built.
const PARTS: usize = 2048;
/// Least and most primitives of a part.
const PART: std::ops::RangeInclusive<usize> = 512..=4096;
/// Sets are gone through in pieces of this size.
const PIECE: usize = 16_384;

/// A tree whose parts lie apart.
pub(super) struct Forest {
    /// The binary tree above the parts, each of which is a leaf of it.
    pub top: Vec<BinaryNode>,
    pub parts: Vec<Part>,
    /// The primitives' order, part after part.
    pub order: Vec<u32>,
}

/// A wide subtree over primitives that lie side by side in the order.
pub(super) struct Part {
    pub tree: Wide,
    pub bounds: Bounds3,
    pub start: usize,
    pub count: usize,
}

/// Builds the tree; there is at least one primitive.
pub(super) fn grow(mut primitives: Vec<PrimitiveBox>, shape: Shape) -> Forest {
    let most = (primitives.len() / PARTS).clamp(*PART.start(), *PART.end());
    let mut spare = Vec::new();
    if primitives.len() > most {
        primitives.par_iter().copied().collect_into_vec(&mut spare);
    }
    let mut order = vec![0; primitives.len()];
    let set = Set { primitives: &mut primitives, spare: &mut spare, order: &mut order, start: 0 };
    let (top, parts) = flatten(set.grow(shape, most, 0));
    Forest { top, parts, order }
}

enum Subtree {
    Part(Part),
    Fork(Bounds3, Box<[Subtree; 2]>),
}

fn flatten(tree: Subtree) -> (Vec<BinaryNode>, Vec<Part>) {
    let (mut top, mut parts) = (vec![BinaryNode::leaf(0, 0)], Vec::new());
    let mut work = vec![(0, tree)];
    while let Some((at, tree)) = work.pop() {
        match tree {
            Subtree::Fork(bounds, children) => {
                let first = top.len();
                top[at] = BinaryNode { bounds, first: first as u32, ..BinaryNode::leaf(0, 0) };
                top.extend([BinaryNode::leaf(0, 0); 2]);
                let [left, right] = *children;
                work.extend([(first + 1, right), (first, left)]);
            }
            Subtree::Part(part) => {
                top[at] = BinaryNode { bounds: part.bounds, ..BinaryNode::leaf(parts.len(), 1) };
                parts.push(part);
            }
        }
    }
    (top, parts)
}

/// Primitives that lie side by side in the order, and room for as many.
struct Set<'a> {
    primitives: &'a mut [PrimitiveBox],
    spare: &'a mut [PrimitiveBox],
    order: &'a mut [u32],
    start: usize,
}

impl Set<'_> {
    /// Splits the set until each part has at most `most` primitives.
    fn grow(mut self, shape: Shape, most: usize, level: usize) -> Subtree {
        let count = self.primitives.len();
        let around = self.primitives.par_chunks(PIECE).map(Box4::around);
        let (bounds, centers) = around.reduce(|| (Box4::EMPTY, Box4::EMPTY), |a, b| (a.0.union(b.0), a.1.union(b.1)));
        if count <= most {
            let tree = part(self.primitives, self.start, shape, level);
            self.order.iter_mut().zip(&*self.primitives).for_each(|(slot, p)| *slot = p.index());
            return Subtree::Part(Part { tree, bounds: bounds.bounds(), start: self.start, count });
        }
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
        let (left, right) = rayon::join(|| left.grow(shape, most, level + 1), || right.grow(shape, most, level + 1));
        Subtree::Fork(bounds.bounds(), Box::new([left, right]))
    }

    /// Copies the primitives to the spare room, those left of the best limit first; gives the number of these. None,
    /// and nothing is done, where there is no limit.
    fn split(&mut self, mapping: &Mapping, block: usize) -> Option<usize> {
        let pieces: Vec<&[PrimitiveBox]> = self.primitives.chunks(PIECE).collect();
        let binned = |piece: &&[PrimitiveBox]| {
            let mut bins = Bins::new();
            bins.add_all(piece, mapping);
            bins
        };
        let bins: Vec<Bins> = pieces.par_iter().map(binned).collect();
        let mut all = Bins::new();
        bins.iter().for_each(|b| all.merge(b));
        let split = all.best_split(mapping, block)?;
        let lefts: Vec<usize> = bins.iter().map(|b| b.count_left(split)).collect();
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
