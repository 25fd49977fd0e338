//! One tree from its parts.

use std::mem;

use rayon::prelude::*;

use super::{
    Wide,
    collapse::{Leaves, collapse},
    grow::{Forest, Part},
    optimize,
};
use crate::wide::{ChildRef, WideNode};

/// A part on its way into the tree.
struct Move<'a> {
    part: &'a Part,
    nodes: &'a mut [WideNode],
    order: &'a mut [u32],
    place: Place,
}

/// Where a part begins in the tree's nodes and in its order.
#[derive(Clone, Copy, Default)]
struct Place {
    node: usize,
    start: usize,
}

/// The tree, the parts in the order in which its top comes to them, and the primitives' order.
pub(super) fn join(forest: &Forest) -> (Wide, Vec<u32>) {
    let Forest { top, parts, order } = forest;
    let (top, leaves) = optimize::reinsert(top);
    let parts: Vec<&Part> = leaves.iter().map(|&part| &parts[part as usize]).collect();
    let costs: Vec<f32> = parts.iter().map(|p| p.tree.cost).collect();
    let mut wide = collapse(&top, Leaves::Parts(&costs));
    let mut place = Place { node: wide.nodes.len(), start: 0 };
    let mut roots = Vec::with_capacity(parts.len());
    for part in &parts {
        roots.push(moved(part, part.tree.root, place));
        place = Place { node: place.node + part.tree.nodes.len(), start: place.start + part.count };
    }
    // The top's leaves are parts.
    for child in wide.nodes.iter_mut().flat_map(|n| &mut n.children).chain([&mut wide.root]) {
        if *child != ChildRef::NONE && child.is_leaf() {
            *child = roots[child.range().0];
        }
    }
    let above = wide.nodes.len();
    wide.nodes.resize(place.node, WideNode::empty());
    let mut new_order = vec![0; order.len()];
    let (mut nodes, mut slots, mut place) =
        (&mut wide.nodes[above..], &mut new_order[..], Place { node: above, start: 0 });
    let mut moves = Vec::with_capacity(parts.len());
    for part in &parts {
        let (to, nodes_after) = mem::take(&mut nodes).split_at_mut(part.tree.nodes.len());
        let (slots_to, slots_after) = mem::take(&mut slots).split_at_mut(part.count);
        (nodes, slots) = (nodes_after, slots_after);
        moves.push(Move { part, nodes: to, order: slots_to, place });
        place = Place { node: place.node + part.tree.nodes.len(), start: place.start + part.count };
    }
    moves.into_par_iter().with_min_len(16).for_each(|m| m.run(order));
    wide.stack_need += parts.iter().map(|p| p.tree.stack_need).max().unwrap_or(0);
    (wide, new_order)
}

impl Move<'_> {
    fn run(self, order: &[u32]) {
        for (to, from) in self.nodes.iter_mut().zip(&self.part.tree.nodes) {
            *to = from.clone();
            to.children = from.children.map(|child| moved(self.part, child, self.place));
        }
        self.order.copy_from_slice(&order[self.part.start..][..self.part.count]);
    }
}

/// A reference of a part as it is in the tree.
fn moved(part: &Part, child: ChildRef, to: Place) -> ChildRef {
    if child == ChildRef::NONE {
        child
    } else if child.is_leaf() {
        let (start, count) = child.range();
        ChildRef::leaf(start - part.start + to.start, count)
    } else {
        ChildRef::node(child.0 as usize + to.node)
    }
}
