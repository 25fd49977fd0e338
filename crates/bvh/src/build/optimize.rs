//! A better top of the tree: subtrees are moved to where they cost less, by obvhs.
//!
//! Meister and Bittner 2018, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization".

use obvhs::{
    aabb::Aabb,
    bvh2::{Bvh2, node::Bvh2Node, reinsertion::ReinsertionOptimizer},
};
use umber_math::Bounds3;

use super::grow::{Fork, TopNode};

/// How often each node is tried.
const ROUNDS: u32 = 4;

/// Moves nodes of the top of a tree, node 0 of which is the root.
pub(super) fn reinsert(top: &[TopNode]) -> Vec<TopNode> {
    let node = |n: &TopNode| {
        let bounds = Aabb::new(n.bounds.min.into(), n.bounds.max.into());
        match n.fork {
            Fork::Children(first) => Bvh2Node::new(bounds, 0, first as u32),
            Fork::Part(part) => Bvh2Node::new(bounds, 1, part as u32),
        }
    };
    let mut bvh = Bvh2 { nodes: top.iter().map(node).collect(), ..Bvh2::default() };
    let all: Vec<u32> = (1..top.len() as u32).collect();
    ReinsertionOptimizer::default().run_with_candidates(&mut bvh, &all, ROUNDS);
    bvh.nodes.iter().map(top_node).collect()
}

fn top_node(n: &Bvh2Node) -> TopNode {
    let at = n.first_index as usize;
    TopNode {
        bounds: Bounds3 { min: n.aabb().min.into(), max: n.aabb().max.into() },
        fork: if n.is_leaf() { Fork::Part(at) } else { Fork::Children(at) },
    }
}
