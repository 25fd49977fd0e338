//! A better tree from a good one: subtrees are moved to where they cost less, by obvhs.
//!
//! Meister and Bittner 2018, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization".

use obvhs::{
    aabb::Aabb,
    bvh2::{Bvh2, node::Bvh2Node, reinsertion::ReinsertionOptimizer},
};
use umber_math::Bounds3;

use super::BinaryNode;

/// How often nodes are tried.
const ROUNDS: u32 = 4;
/// Most nodes that are tried: those with the largest boxes.
const MOST: usize = 4096;

/// Moves nodes of a tree, each leaf of which has one thing. Gives the new tree, and the things' old places in the
/// order of its leaves.
pub(super) fn reinsert(nodes: &[BinaryNode]) -> (Vec<BinaryNode>, Vec<u32>) {
    let node = |n: &BinaryNode| {
        let bounds = Aabb::new(n.bounds.min.into(), n.bounds.max.into());
        if n.is_leaf() { Bvh2Node::new(bounds, 1, n.start) } else { Bvh2Node::new(bounds, 0, n.first) }
    };
    let mut bvh = Bvh2 { nodes: nodes.iter().map(node).collect(), ..Bvh2::default() };
    let mut largest: Vec<u32> = (1..nodes.len() as u32).collect();
    if largest.len() > MOST {
        let area = |&i: &u32| nodes[i as usize].half_area();
        largest.select_nth_unstable_by(MOST, |a, b| area(b).total_cmp(&area(a)).then(a.cmp(b)));
        largest.truncate(MOST);
    }
    ReinsertionOptimizer::default().run_with_candidates(&mut bvh, &largest, ROUNDS);
    ordered(&bvh.nodes)
}

/// obvhs' tree as ours: children behind their parents.
fn ordered(from: &[Bvh2Node]) -> (Vec<BinaryNode>, Vec<u32>) {
    let copied = |n: &Bvh2Node| {
        let bounds = Bounds3 { min: n.aabb().min.into(), max: n.aabb().max.into() };
        BinaryNode { bounds, ..BinaryNode::leaf(0, 1) }
    };
    let mut nodes = Vec::with_capacity(from.len());
    nodes.push(copied(&from[0]));
    let mut leaves = Vec::with_capacity(from.len() / 2 + 1);
    let mut work = vec![(0, 0)];
    while let Some((at, old)) = work.pop() {
        let first = from[old].first_index as usize;
        nodes[at].start = leaves.len() as u32;
        if from[old].is_leaf() {
            leaves.push(first as u32);
        } else {
            nodes[at].first = nodes.len() as u32;
            work.extend([(nodes.len() + 1, first + 1), (nodes.len(), first)]);
            nodes.extend([copied(&from[first]), copied(&from[first + 1])]);
        }
    }
    for i in (0..nodes.len()).rev() {
        if !nodes[i].is_leaf() {
            let first = nodes[i].first as usize;
            nodes[i].count = nodes[first].count + nodes[first + 1].count;
        }
    }
    (nodes, leaves)
}
