//! From binary to wide: the cheapest way to cut the binary tree into nodes of eight children.
//!
//! Ylitie, Karras and Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed
//! Wide BVHs", section 3.1: dynamic programming over the cost of representing each subtree as a
//! forest of at most `i` trees.

use super::{BinaryNode, Wide};
use crate::wide::{ChildRef, WIDTH, WideNode};

/// Cost of visiting a node.
const NODE_COST: f32 = 1.0;
/// Cost of visiting a leaf, whose triangles are all tested at once: the same for one and for eight.
/// Measured; anything from 0.7 to 1.2 traces about as fast.
const LEAF_COST: f32 = 0.8;

/// What the leaves of a binary tree are.
#[derive(Clone, Copy)]
pub(super) enum Leaves<'a> {
    /// Primitives, of which a wide leaf takes at most as many; the first is at `start` in the order.
    Primitives { most: usize, start: usize },
    /// Wide subtrees of these costs. A reference to one is a leaf with its number as start.
    Parts(&'a [f32]),
}

/// Costs of a subtree: entry `i − 1` as a forest of at most `i` trees.
type Costs = [f32; WIDTH - 1];

/// Lays a tree out wide; there is at least one node.
pub(super) fn collapse(nodes: &[BinaryNode], leaves: Leaves) -> Wide {
    let mut plan = Plan { nodes, leaves, costs: vec![[0.0; WIDTH - 1]; nodes.len()] };
    for n in (0..nodes.len()).rev() {
        plan.weigh(n);
    }
    plan.lay_out()
}

/// What is known of each binary node.
struct Plan<'a> {
    nodes: &'a [BinaryNode],
    leaves: Leaves<'a>,
    costs: Vec<Costs>,
}

impl Plan<'_> {
    /// Works out the costs of a node whose children's are known.
    fn weigh(&mut self, n: usize) {
        let node = &self.nodes[n];
        let as_leaf = self.leaf_cost(node);
        if node.is_leaf() {
            self.costs[n] = [as_leaf; WIDTH - 1];
            return;
        }
        let children = self.children(node);
        let mut costs = [0.0; WIDTH - 1];
        costs[0] = as_leaf.min(node.half_area() * NODE_COST + split_cost(children, WIDTH).0);
        for i in 2..WIDTH {
            costs[i - 1] = split_cost(children, i).0.min(costs[i - 2]);
        }
        self.costs[n] = costs;
    }

    /// Cost as one leaf; infinite where there is too much in it.
    fn leaf_cost(&self, node: &BinaryNode) -> f32 {
        match self.leaves {
            Leaves::Primitives { most, .. } if node.count as usize <= most => node.half_area() * LEAF_COST,
            Leaves::Parts(costs) if node.is_leaf() => costs[node.start as usize],
            _ => f32::INFINITY,
        }
    }

    fn children(&self, node: &BinaryNode) -> [&Costs; 2] {
        let first = node.first as usize;
        [&self.costs[first], &self.costs[first + 1]]
    }

    /// Whether a subtree is a leaf if it is one child.
    fn is_wide_leaf(&self, n: usize) -> bool {
        self.nodes[n].is_leaf() || {
            let as_leaf = self.leaf_cost(&self.nodes[n]);
            as_leaf.is_finite() && as_leaf <= self.costs[n][0]
        }
    }

    /// A leaf, or a new empty node.
    fn child(&self, n: usize, nodes: &mut Vec<WideNode>) -> ChildRef {
        if self.is_wide_leaf(n) {
            let start = if let Leaves::Primitives { start, .. } = self.leaves { start } else { 0 };
            ChildRef::leaf(start + self.nodes[n].start as usize, self.nodes[n].count as usize)
        } else {
            nodes.push(WideNode::empty());
            ChildRef::node(nodes.len() - 1)
        }
    }

    /// Makes the wide nodes. Children of one node lie side by side.
    fn lay_out(&self) -> Wide {
        let mut nodes = Vec::new();
        let root = self.child(0, &mut nodes);
        let mut most_need = 0;
        let mut work = if root.is_leaf() { Vec::new() } else { vec![(0, root, 0)] };
        let mut parts = Vec::with_capacity(WIDTH);
        while let Some((n, at, need)) = work.pop() {
            parts.clear();
            let node = &self.nodes[n];
            let k = split_cost(self.children(node), WIDTH).1;
            self.forest(node.first as usize, k, &mut parts);
            self.forest(node.first as usize + 1, WIDTH - k, &mut parts);
            // An any-hit search takes the last child first: leaves may end it.
            parts.sort_by_key(|&part| self.is_wide_leaf(part));
            let need = need + parts.len();
            most_need = most_need.max(need);
            let pushed = work.len();
            for (slot, &part) in parts.iter().enumerate() {
                let child = self.child(part, &mut nodes);
                let wide = &mut nodes[at.0 as usize];
                wide.set_bounds(slot, self.nodes[part].bounds);
                wide.children[slot] = child;
                if !child.is_leaf() {
                    work.push((part, child, need));
                }
            }
            work[pushed..].reverse();
        }
        Wide { nodes, root, stack_need: most_need, cost: self.costs[0][0] }
    }

    /// The roots of a subtree as a forest of at most `i` trees. At most `WIDTH` deep.
    fn forest(&self, n: usize, i: usize, parts: &mut Vec<usize>) {
        let node = &self.nodes[n];
        if i == 1 || node.is_leaf() {
            parts.push(n);
        } else if self.costs[n][i - 1] == self.costs[n][i - 2] {
            self.forest(n, i - 1, parts);
        } else {
            let k = split_cost(self.children(node), i).1;
            self.forest(node.first as usize, k, parts);
            self.forest(node.first as usize + 1, i - k, parts);
        }
    }
}

/// Least cost of a pair of siblings as `i` trees, and how many of these the first one gets.
#[inline(always)]
fn split_cost([left, right]: [&Costs; 2], i: usize) -> (f32, usize) {
    let mut best = (f32::INFINITY, 1);
    for k in 1..i {
        let cost = left[k - 1] + right[i - k - 1];
        if cost < best.0 {
            best = (cost, k);
        }
    }
    best
}
