//! From binary to wide: the cheapest way to cut the binary tree into nodes of eight children.
//!
//! Ylitie, Karras and Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed
//! Wide BVHs", section 3.1: dynamic programming over the cost of representing each subtree as a
//! forest of at most `i` trees.

use super::{ChildRef, WIDTH, WideNode};
use crate::binary::{BinaryNode, BinaryTree};

/// Cost of visiting a node.
const NODE_COST: f32 = 1.0;
/// Cost of visiting a leaf, whose triangles are all tested at once: the same for one and for eight.
/// Measured; anything from 0.7 to 1.2 traces about as fast.
const LEAF_COST: f32 = 0.8;

/// What the collapse gives.
pub(super) struct Collapsed {
    pub nodes: Vec<WideNode>,
    pub root: ChildRef,
    /// The primitives in the order of the leaves.
    pub order: Vec<u32>,
    /// Most stack entries that a traversal can need.
    pub stack_need: usize,
}

/// Costs of a subtree: entry `i − 1` as a forest of at most `i` trees.
type Costs = [f32; WIDTH - 1];

/// What is known of each binary node.
struct Plan<'a> {
    nodes: &'a [BinaryNode],
    costs: Vec<Costs>,
    /// Number of primitives below.
    counts: Vec<u32>,
    leaf_size: usize,
}

pub(super) fn collapse(tree: &BinaryTree, leaf_size: usize) -> Collapsed {
    let mut out = Collapsed { nodes: Vec::new(), root: ChildRef::NONE, order: Vec::new(), stack_need: 0 };
    if tree.nodes.is_empty() {
        return out;
    }
    let plan = Plan::new(&tree.nodes, leaf_size.clamp(1, WIDTH));
    out.order.reserve_exact(plan.counts[0] as usize);
    plan.emit(&mut out);
    out.nodes.shrink_to_fit();
    out.stack_need = stack_need(&out.nodes);
    out
}

impl<'a> Plan<'a> {
    fn new(nodes: &'a [BinaryNode], leaf_size: usize) -> Self {
        let costs = vec![[0.0; WIDTH - 1]; nodes.len()];
        let mut plan = Self { nodes, costs, counts: vec![1; nodes.len()], leaf_size };
        for &n in parents_first(nodes).iter().rev() {
            plan.weigh(n as usize);
        }
        plan
    }

    /// Works out the costs of a node whose children's are known.
    fn weigh(&mut self, n: usize) {
        let node = self.nodes[n];
        if node.is_leaf {
            self.costs[n] = [self.leaf_cost(n); WIDTH - 1];
            return;
        }
        let first = node.first as usize;
        self.counts[n] = self.counts[first].saturating_add(self.counts[first + 1]);
        let mut costs = [0.0; WIDTH - 1];
        costs[0] = self.leaf_cost(n).min(self.node_cost(n));
        for i in 2..WIDTH {
            costs[i - 1] = self.split_cost(first, i).0.min(costs[i - 2]);
        }
        self.costs[n] = costs;
    }

    /// Cost as one leaf; infinite where there are too many primitives.
    fn leaf_cost(&self, n: usize) -> f32 {
        let fits = self.counts[n] as usize <= self.leaf_size;
        if fits { self.nodes[n].half_area * LEAF_COST } else { f32::INFINITY }
    }

    /// Cost as one wide node.
    fn node_cost(&self, n: usize) -> f32 {
        self.nodes[n].half_area * NODE_COST + self.split_cost(self.nodes[n].first as usize, WIDTH).0
    }

    /// Least cost of a pair of siblings as `i` trees, and how many of these the first one gets.
    fn split_cost(&self, first: usize, i: usize) -> (f32, usize) {
        let (left, right) = (&self.costs[first], &self.costs[first + 1]);
        let mut best = (f32::INFINITY, 1);
        for k in 1..i {
            let cost = left[k - 1] + right[i - k - 1];
            if cost < best.0 {
                best = (cost, k);
            }
        }
        best
    }

    fn is_wide_leaf(&self, n: usize) -> bool {
        self.nodes[n].is_leaf || {
            let as_leaf = self.leaf_cost(n);
            as_leaf.is_finite() && as_leaf <= self.node_cost(n)
        }
    }

    /// Makes the wide nodes. Children of one node lie side by side.
    fn emit(&self, out: &mut Collapsed) {
        out.root = self.make_child(0, out);
        let mut work = if out.root.is_leaf() { Vec::new() } else { vec![(0usize, out.root)] };
        let mut parts = Vec::with_capacity(WIDTH);
        while let Some((n, at)) = work.pop() {
            parts.clear();
            let first = self.nodes[n].first as usize;
            let k = self.split_cost(first, WIDTH).1;
            self.forest(first, k, &mut parts);
            self.forest(first + 1, WIDTH - k, &mut parts);
            let pushed = work.len();
            for (slot, &part) in parts.iter().enumerate() {
                let child = self.make_child(part, out);
                out.nodes[at.0 as usize].children[slot] = child;
                if !child.is_leaf() {
                    work.push((part, child));
                }
            }
            work[pushed..].reverse();
        }
    }

    /// The roots of a subtree as a forest of at most `i` trees. At most `WIDTH` deep.
    fn forest(&self, n: usize, i: usize, parts: &mut Vec<usize>) {
        if i == 1 || self.nodes[n].is_leaf {
            parts.push(n);
        } else if self.costs[n][i - 1] == self.costs[n][i - 2] {
            self.forest(n, i - 1, parts);
        } else {
            let first = self.nodes[n].first as usize;
            let k = self.split_cost(first, i).1;
            self.forest(first, k, parts);
            self.forest(first + 1, i - k, parts);
        }
    }

    /// A new leaf with its primitives in order, or a new empty node.
    fn make_child(&self, n: usize, out: &mut Collapsed) -> ChildRef {
        if !self.is_wide_leaf(n) {
            out.nodes.push(WideNode::empty());
            return ChildRef::node(out.nodes.len() - 1);
        }
        let start = out.order.len();
        let mut below = vec![n];
        while let Some(n) = below.pop() {
            let node = self.nodes[n];
            if node.is_leaf {
                out.order.push(node.first);
            } else {
                below.extend([node.first as usize + 1, node.first as usize]);
            }
        }
        out.order[start..].sort_unstable();
        ChildRef::leaf(start, out.order.len() - start)
    }
}

/// The nodes, each before its children.
fn parents_first(nodes: &[BinaryNode]) -> Vec<u32> {
    let mut order = Vec::with_capacity(nodes.len());
    let mut work = vec![0u32];
    while let Some(n) = work.pop() {
        order.push(n);
        let node = nodes[n as usize];
        if !node.is_leaf {
            work.extend([node.first + 1, node.first]);
        }
    }
    order
}

/// Most stack entries that a traversal can need: all siblings but one along the worst path.
fn stack_need(nodes: &[WideNode]) -> usize {
    let mut need = vec![0usize; nodes.len()];
    for (i, node) in nodes.iter().enumerate().rev() {
        let there = node.children.iter().filter(|c| **c != ChildRef::NONE);
        let deepest = there.clone().filter(|c| !c.is_leaf()).map(|c| need[c.0 as usize]).max().unwrap_or(0);
        need[i] = there.count() + deepest;
    }
    need.first().copied().unwrap_or(0)
}
