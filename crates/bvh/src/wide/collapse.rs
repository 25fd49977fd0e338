//! From binary to wide: the cheapest way to cut the binary tree into nodes of eight children.
//!
//! Ylitie, Karras and Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed
//! Wide BVHs", section 3.1: dynamic programming over the cost of representing each subtree as a
//! forest of at most `i` trees.

use std::mem;

use rayon::prelude::*;

use super::{ChildRef, WIDTH, WideNode};
use crate::build::{BinaryNode, BinaryTree};

/// Cost of visiting a node.
const NODE_COST: f32 = 1.0;
/// Cost of visiting a leaf, whose triangles are all tested at once: the same for one and for eight.
/// Measured; anything from 0.7 to 1.2 traces about as fast.
const LEAF_COST: f32 = 0.8;
/// Subtrees of at most as many primitives are one thread's work.
const TASK: usize = 16384;

/// What the collapse gives.
pub(super) struct Collapsed {
    /// Parents lie before their children.
    pub nodes: Vec<WideNode>,
    pub root: ChildRef,
    /// Most stack entries that a traversal can need.
    pub stack_need: usize,
}

/// Costs of a subtree: entry `i − 1` as a forest of at most `i` trees.
type Costs = [f32; WIDTH - 1];

/// Lays a tree out wide, with leaves of at most `leaf_size` primitives.
pub(super) fn collapse(tree: &BinaryTree, leaf_size: usize) -> Collapsed {
    let plan = Plan::new(tree, leaf_size.clamp(1, WIDTH));
    let mut top = Wide::default();
    let root = plan.child(0, &mut top.nodes);
    let mut jobs = Vec::new();
    if !root.is_leaf() {
        plan.lay_out(0, 0, &mut top, Some(&mut jobs));
    }
    let parts: Vec<Wide> = jobs
        .par_iter()
        .map(|job| {
            let mut part = Wide::default();
            part.nodes.push(WideNode::empty());
            plan.lay_out(job.subtree, job.stack_need, &mut part, None);
            part
        })
        .collect();
    let stack_need = parts.iter().fold(top.stack_need, |need, part| need.max(part.stack_need));
    Collapsed { nodes: join(top, &jobs, parts), root, stack_need }
}

/// Wide nodes, and the most stack entries on the way to any of them.
#[derive(Default)]
struct Wide {
    nodes: Vec<WideNode>,
    stack_need: usize,
}

/// A subtree that is laid out on its own.
struct Job {
    subtree: usize,
    /// The node and slot that refer to it.
    parent: (usize, usize),
    /// Stack entries on the way to it.
    stack_need: usize,
}

/// All nodes in one list.
fn join(top: Wide, jobs: &[Job], parts: Vec<Wide>) -> Vec<WideNode> {
    let mut nodes = top.nodes;
    if parts.is_empty() {
        nodes.shrink_to_fit();
        return nodes;
    }
    let mut next = nodes.len();
    let mut offsets = Vec::with_capacity(parts.len());
    for (job, part) in jobs.iter().zip(&parts) {
        nodes[job.parent.0].children[job.parent.1] = ChildRef::node(next);
        offsets.push(next);
        next += part.nodes.len();
    }
    let mut all = vec![WideNode::empty(); next];
    let (first, mut rest) = all.split_at_mut(nodes.len());
    first.clone_from_slice(&nodes);
    let mut moves = Vec::with_capacity(parts.len());
    for (part, offset) in parts.into_iter().zip(offsets) {
        let (to, after) = mem::take(&mut rest).split_at_mut(part.nodes.len());
        rest = after;
        moves.push((part.nodes, offset, to));
    }
    moves.into_par_iter().for_each(|(from, offset, to)| {
        for (to, mut node) in to.iter_mut().zip(from) {
            for child in node.children.iter_mut().filter(|c| !c.is_leaf()) {
                *child = ChildRef::node(child.0 as usize + offset);
            }
            *to = node;
        }
    });
    all
}

/// What is known of each binary node.
struct Plan<'a> {
    nodes: &'a [BinaryNode],
    costs: Vec<Costs>,
    leaf_size: usize,
}

impl<'a> Plan<'a> {
    fn new(tree: &'a BinaryTree, leaf_size: usize) -> Self {
        let nodes = &tree.nodes[..];
        let mut costs = vec![[0.0; WIDTH - 1]; nodes.len()];
        let ends = tree.parts.iter().skip(1).copied().chain([nodes.len()]);
        let top = tree.parts.first().copied().unwrap_or(nodes.len());
        let mut rest = &mut costs[top..];
        let mut parts = Vec::with_capacity(tree.parts.len());
        for (&start, end) in tree.parts.iter().zip(ends) {
            let (part, after) = mem::take(&mut rest).split_at_mut(end - start);
            rest = after;
            parts.push((start, part));
        }
        parts.into_par_iter().for_each(|(start, part)| weigh_all(&nodes[start..], part, start, leaf_size));
        // What is above the parts has children anywhere.
        for n in (0..top).rev() {
            costs[n] = weigh(&nodes[n], |child| &costs[child], leaf_size);
        }
        Self { nodes, costs, leaf_size }
    }

    fn is_wide_leaf(&self, n: usize) -> bool {
        let node = &self.nodes[n];
        node.is_leaf() || {
            let as_leaf = leaf_cost(node, self.leaf_size);
            as_leaf.is_finite() && as_leaf <= node_cost(node, self.children(node))
        }
    }

    fn children(&self, node: &BinaryNode) -> [&Costs; 2] {
        let first = node.first as usize;
        [&self.costs[first], &self.costs[first + 1]]
    }

    /// A leaf, or a new empty node.
    fn child(&self, n: usize, nodes: &mut Vec<WideNode>) -> ChildRef {
        if self.is_wide_leaf(n) {
            ChildRef::leaf(self.nodes[n].start as usize, self.nodes[n].count as usize)
        } else {
            nodes.push(WideNode::empty());
            ChildRef::node(nodes.len() - 1)
        }
    }

    /// Fills in the last node, which is to be that of a subtree, and all below. Children of one node lie side by side.
    /// Where `later` is given, subtrees that are one thread's work are left to it.
    fn lay_out(&self, subtree: usize, stack_need: usize, wide: &mut Wide, mut later: Option<&mut Vec<Job>>) {
        let mut work = vec![(subtree, wide.nodes.len() - 1, stack_need)];
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
            wide.stack_need = wide.stack_need.max(need);
            let pushed = work.len();
            for (slot, &part) in parts.iter().enumerate() {
                wide.nodes[at].set_bounds(slot, self.nodes[part].bounds);
                if let Some(jobs) = &mut later
                    && self.nodes[part].count as usize <= TASK
                    && !self.is_wide_leaf(part)
                {
                    jobs.push(Job { subtree: part, parent: (at, slot), stack_need: need });
                    continue;
                }
                let child = self.child(part, &mut wide.nodes);
                wide.nodes[at].children[slot] = child;
                if !child.is_leaf() {
                    work.push((part, child.0 as usize, need));
                }
            }
            work[pushed..].reverse();
        }
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

/// Works out the costs of nodes, the first of which is node `start`; their children are among them.
fn weigh_all(nodes: &[BinaryNode], costs: &mut [Costs], start: usize, leaf_size: usize) {
    for i in (0..costs.len()).rev() {
        costs[i] = weigh(&nodes[i], |child| &costs[child - start], leaf_size);
    }
}

/// The costs of a node whose children's are known.
#[inline(always)]
fn weigh<'a>(node: &BinaryNode, of: impl Fn(usize) -> &'a Costs, leaf_size: usize) -> Costs {
    let as_leaf = leaf_cost(node, leaf_size);
    if node.is_leaf() {
        return [as_leaf; WIDTH - 1];
    }
    let first = node.first as usize;
    let children = [of(first), of(first + 1)];
    let mut costs = [0.0; WIDTH - 1];
    costs[0] = as_leaf.min(node_cost(node, children));
    for i in 2..WIDTH {
        costs[i - 1] = split_cost(children, i).0.min(costs[i - 2]);
    }
    costs
}

/// Cost as one leaf; infinite where there are too many primitives.
fn leaf_cost(node: &BinaryNode, leaf_size: usize) -> f32 {
    if node.count as usize <= leaf_size { node.half_area() * LEAF_COST } else { f32::INFINITY }
}

/// Cost as one wide node.
fn node_cost(node: &BinaryNode, children: [&Costs; 2]) -> f32 {
    node.half_area() * NODE_COST + split_cost(children, WIDTH).0
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
