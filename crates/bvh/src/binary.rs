//! The binary hierarchy that obvhs builds, before it is laid out wide.

use glam::DVec3;
use obvhs::{
    aabb::Aabb,
    bvh2::reinsertion::ReinsertionOptimizer,
    ploc::{PlocBuilder, PlocSearchDistance, SortPrecision},
};
use umber_math::Bounds3;

/// A node: its half area, and its first child (the second follows it) or its primitive.
#[derive(Clone, Copy)]
pub(crate) struct BinaryNode {
    pub half_area: f32,
    pub first: u32,
    pub is_leaf: bool,
}

/// A binary tree; node 0 is the root. Empty where there are no primitives.
pub(crate) struct BinaryTree {
    pub nodes: Vec<BinaryNode>,
}

impl BinaryTree {
    /// By locally ordered clustering (Meister and Bittner 2018) and reinsertion (the same, 2018).
    ///
    /// The boxes must be finite; one primitive a leaf. Where primitives are `costly` to visit, as instances
    /// are, more time goes into the tree.
    pub fn build(boxes: &[Bounds3], costly: bool) -> Self {
        if boxes.is_empty() {
            return Self { nodes: Vec::new() };
        }
        let boxes = scaled_boxes(boxes);
        let indices = (0..boxes.len() as u32).collect();
        let effort = Effort::for_count(boxes.len(), costly);
        let mut bvh = PlocBuilder::with_capacity(boxes.len()).build(
            effort.search,
            &boxes,
            indices,
            SortPrecision::U64,
            effort.shallow,
        );
        ReinsertionOptimizer::default().run(&mut bvh, effort.reinsertion, None);
        let node = |n: &obvhs::bvh2::node::Bvh2Node| BinaryNode {
            half_area: n.aabb().half_area(),
            first: n.first_index,
            is_leaf: n.is_leaf(),
        };
        Self { nodes: bvh.nodes.iter().map(node).collect() }
    }

    /// A balanced tree over primitives in the order given, for input that makes the built tree
    /// degenerate into a chain.
    pub fn balanced(order: &[u32], boxes: &[Bounds3]) -> Self {
        let mut nodes = vec![BinaryNode { half_area: 0.0, first: 0, is_leaf: true }];
        let mut work = vec![(0usize, 0..order.len())];
        while let Some((node, range)) = work.pop() {
            let bounds = order[range.clone()].iter().fold(Bounds3::EMPTY, |b, &i| b.union(boxes[i as usize]));
            let size = bounds.size();
            nodes[node].half_area = size.x * size.y + size.y * size.z + size.z * size.x;
            if range.len() == 1 {
                nodes[node].first = order[range.start];
                continue;
            }
            let (middle, first) = (range.start + range.len() / 2, nodes.len());
            nodes[node] = BinaryNode { first: first as u32, is_leaf: false, ..nodes[node] };
            nodes.extend([BinaryNode { half_area: 0.0, first: 0, is_leaf: true }; 2]);
            work.push((first, range.start..middle));
            work.push((first + 1, middle..range.end));
        }
        Self { nodes }
    }
}

/// How much time building may take, by the number of primitives.
struct Effort {
    search: PlocSearchDistance,
    /// Rounds of clustering that look at direct neighbours only.
    shallow: usize,
    /// Part of the nodes tried for reinsertion.
    reinsertion: f32,
}

impl Effort {
    fn for_count(count: usize, costly: bool) -> Self {
        if count < if costly { 200_000 } else { 20_000 } {
            Self { search: PlocSearchDistance::High, shallow: 1, reinsertion: 0.3 }
        } else {
            Self { search: PlocSearchDistance::Medium, shallow: 3, reinsertion: 0.05 }
        }
    }
}

/// The boxes as obvhs takes them, brought to about unit size where areas would over- or underflow.
fn scaled_boxes(boxes: &[Bounds3]) -> Vec<Aabb> {
    let total = boxes.iter().fold(Bounds3::EMPTY, |a, b| a.union(*b));
    let (low, high) = (total.min.as_dvec3(), total.max.as_dvec3());
    let extent = (high - low).max_element();
    if (1e-12..1e12).contains(&extent) || extent == 0.0 {
        return boxes.iter().map(|b| Aabb::new(b.min.into(), b.max.into())).collect();
    }
    let scaled = |v: glam::Vec3| ((v.as_dvec3() - low) * DVec3::splat(1.0 / extent)).as_vec3a();
    boxes.iter().map(|b| Aabb::new(scaled(b.min), scaled(b.max))).collect()
}
