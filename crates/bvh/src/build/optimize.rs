//! A better tree from a good one: subtrees are moved to where they cost less, by obvhs.
//!
//! Meister and Bittner 2018, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization".

use obvhs::{
    aabb::Aabb,
    bvh2::{Bvh2, node::Bvh2Node, reinsertion::ReinsertionOptimizer},
};
use umber_math::Bounds3;

use super::{BinaryNode, BinaryTree};

/// Tries a part of the nodes, those with the largest boxes first.
pub(super) fn reinsert(tree: BinaryTree, part: f32) -> BinaryTree {
    let node = |n: &BinaryNode| {
        let bounds = Aabb::new(n.bounds.min.into(), n.bounds.max.into());
        if n.is_leaf() { Bvh2Node::new(bounds, n.count, n.start) } else { Bvh2Node::new(bounds, 0, n.first) }
    };
    let mut bvh = Bvh2 {
        nodes: tree.nodes.iter().map(node).collect(),
        primitive_indices: tree.order,
        children_are_ordered_after_parents: true,
        ..Bvh2::default()
    };
    ReinsertionOptimizer::default().run(&mut bvh, part, None);
    ordered(&bvh)
}

/// obvhs' tree as ours: children behind their parents, primitives in the order of the leaves.
fn ordered(bvh: &Bvh2) -> BinaryTree {
    let copied = |n: &Bvh2Node| BinaryNode {
        bounds: Bounds3 { min: n.aabb().min.into(), max: n.aabb().max.into() },
        first: 0,
        start: 0,
        count: 0,
    };
    let mut nodes = vec![copied(&bvh.nodes[0])];
    let mut order = Vec::with_capacity(bvh.primitive_indices.len());
    let mut work = vec![(0usize, 0usize)];
    while let Some((at, from)) = work.pop() {
        let node = &bvh.nodes[from];
        nodes[at].start = order.len() as u32;
        let first = node.first_index as usize;
        if node.is_leaf() {
            nodes[at].count = node.prim_count;
            order.extend_from_slice(&bvh.primitive_indices[first..first + node.prim_count as usize]);
        } else {
            nodes[at].first = nodes.len() as u32;
            work.extend([(nodes.len() + 1, first + 1), (nodes.len(), first)]);
            nodes.extend([copied(&bvh.nodes[first]), copied(&bvh.nodes[first + 1])]);
        }
    }
    for i in (0..nodes.len()).rev().filter(|&i| nodes[i].first != 0).collect::<Vec<_>>() {
        let first = nodes[i].first as usize;
        nodes[i].count = nodes[first].count + nodes[first + 1].count;
    }
    BinaryTree { nodes, order, parts: Vec::new() }
}
