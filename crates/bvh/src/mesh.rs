//! The hierarchy of one mesh's triangles.

use std::mem;

use glam::Vec3;
use rayon::prelude::*;
use umber_math::{Bounds3, Point3, float::MACHINE_EPSILON};

use crate::wide::{MAX_PRIMITIVES, MOST_GROWTH, WIDTH, WideTree};

/// Words of a triangle: three vertices of three coordinates, and the caller's index.
const WORDS: usize = 10;
/// The row of the caller's indices.
const INDEX_ROW: usize = 9;
/// Leaves that one thread fills at a time.
const LEAVES_A_PIECE: usize = 2048;

/// Triangles of one mesh, in the mesh's own (object) space.
///
/// Holds the vertices and the index of each triangle where its leaf is, so that a test needs no look-up. About 50
/// bytes a triangle.
#[derive(Clone)]
pub struct MeshBvh {
    tree: WideTree,
    /// Leaf after leaf: the nine coordinate rows of its triangles, as bits, and that of their indices; each as long
    /// as the leaf has triangles. Eight zeros at the end let whole vectors be read.
    leaves: Vec<u32>,
    /// Number of triangles.
    count: usize,
    skipped: usize,
    /// What the tree cost when it was built, if it was fitted since.
    built_cost: Option<f64>,
}

impl MeshBvh {
    /// Builds the hierarchy. Triangles are triples of point indices.
    ///
    /// Triangles with an index out of range or a point that is not finite can't be hit; see
    /// [`MeshBvh::skipped`]. At most 2²⁸ − 8 triangles are taken.
    pub fn build(points: &[Point3], triangles: &[[u32; 3]]) -> Self {
        let bounds = |i: u32| corners(points, triangles, i).filter(|p| finite(*p)).map(triangle_bounds);
        let (tree, order) = WideTree::build(triangles.len().min(MAX_PRIMITIVES), WIDTH, bounds);
        let skipped = triangles.len() - order.len();
        let mut bvh =
            Self { leaves: vec![0; order.len() * WORDS + WIDTH], count: order.len(), tree, skipped, built_cost: None };
        bvh.store(points, triangles, Some(&order));
        bvh
    }

    /// The hierarchy of the triangles after they moved, in a fraction of the time that building takes. None where
    /// building would pay: where it would cost rays more than one and a half times what it did when built, where
    /// there are other triangles, or some were left out.
    pub fn refitted(&self, points: &[Point3], triangles: &[[u32; 3]]) -> Option<Self> {
        if self.skipped > 0 || triangles.len() != self.count {
            return None;
        }
        let mut moved = self.clone();
        moved.refit(points, triangles);
        let built = self.built_cost.unwrap_or_else(|| self.tree.cost());
        moved.built_cost = Some(built);
        // Written so that a cost that is no number is too much.
        (moved.tree.cost() <= MOST_GROWTH * built).then_some(moved)
    }

    /// Moves the triangles: as many of them, each where it was in the list. Quality falls as shapes change much. A
    /// triangle that is not finite any more can't be hit.
    pub fn refit(&mut self, points: &[Point3], triangles: &[[u32; 3]]) {
        self.store(points, triangles, None);
        let leaves = &self.leaves;
        self.tree.fit(|start, count| leaf_bounds(&leaves[start * WORDS..(start + count) * WORDS], count));
    }

    /// Fills in the coordinates, leaf by leaf, and the indices where the `order` of the triangles is given.
    fn store(&mut self, points: &[Point3], triangles: &[[u32; 3]], order: Option<&[u32]>) {
        let mut ranges: Vec<(usize, usize)> = self.tree.leaves().collect();
        ranges.par_sort_unstable();
        let mut rest = &mut self.leaves[..];
        let mut pieces = Vec::new();
        for ranges in ranges.chunks(LEAVES_A_PIECE) {
            let words = ranges.iter().map(|(_, count)| count * WORDS).sum();
            let (piece, after) = mem::take(&mut rest).split_at_mut(words);
            rest = after;
            pieces.push((ranges, piece));
        }
        pieces.into_par_iter().for_each(|(ranges, mut rest)| {
            for &(start, count) in ranges {
                let (rows, after) = mem::take(&mut rest).split_at_mut(count * WORDS);
                rest = after;
                let (rows, indices) = rows.split_at_mut(INDEX_ROW * count);
                if let Some(order) = order {
                    indices.copy_from_slice(&order[start..start + count]);
                }
                for (lane, &index) in indices.iter().enumerate() {
                    // All of it is NaN where any of it is not finite: one infinite point must not make boxes infinite.
                    let p = corners(points, triangles, index).filter(|p| finite(*p)).unwrap_or([Vec3::NAN; 3]);
                    for (row, value) in p.iter().flat_map(|v| v.to_array()).enumerate() {
                        rows[row * count + lane] = value.to_bits();
                    }
                }
            }
        });
    }

    /// The box around all triangles that can be hit.
    pub fn bounds(&self) -> Bounds3 {
        self.tree.bounds
    }

    /// Number of triangles that can be hit.
    pub fn triangle_count(&self) -> usize {
        self.count
    }

    /// Number of triangles left out when built: bad indices, or points not finite.
    pub fn skipped(&self) -> usize {
        self.skipped
    }

    /// Memory held, in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Self>() + self.tree.memory_bytes() + 4 * self.leaves.capacity()
    }

    #[inline(always)]
    pub(crate) fn tree(&self) -> &WideTree {
        &self.tree
    }

    /// The coordinate rows of the leaf that begins at triangle `start`.
    #[inline(always)]
    pub(crate) fn rows(&self, start: usize) -> *const f32 {
        debug_assert!(start < self.count);
        self.leaves.as_ptr().wrapping_add(start * WORDS).cast()
    }

    /// The caller's index of one triangle of a leaf.
    #[inline]
    pub(crate) fn triangle_at(&self, start: usize, count: usize, lane: usize) -> u32 {
        self.leaves[start * WORDS + INDEX_ROW * count + lane]
    }

    /// Vertices of one triangle of a leaf.
    pub(crate) fn leaf_vertices(&self, start: usize, count: usize, lane: usize) -> [Vec3; 3] {
        let at = |row: usize| f32::from_bits(self.leaves[start * WORDS + row * count + lane]);
        [0, 3, 6].map(|v| Vec3::new(at(v), at(v + 1), at(v + 2)))
    }
}

fn corners(points: &[Point3], triangles: &[[u32; 3]], index: u32) -> Option<[Vec3; 3]> {
    let [a, b, c] = triangles.get(index as usize)?.map(|i| points.get(i as usize).map(|p| p.0));
    Some([a?, b?, c?])
}

fn finite(p: [Vec3; 3]) -> bool {
    p.iter().all(|v| v.is_finite())
}

/// The box of a leaf, from its rows.
fn leaf_bounds(rows: &[u32], count: usize) -> Bounds3 {
    let at = |row: usize, lane: usize| f32::from_bits(rows[row * count + lane]);
    let vertex = |lane: usize, v: usize| Vec3::new(at(3 * v, lane), at(3 * v + 1, lane), at(3 * v + 2, lane));
    let triangle = |lane: usize| triangle_bounds([0, 1, 2].map(|v| vertex(lane, v)));
    (0..count).map(triangle).fold(Bounds3::EMPTY, Bounds3::union)
}

/// How far the box of a triangle is grown, as a part of its size: the triangle test moves vertices by about six
/// roundings of their distance. What that comes to at the hit, the box test's slack holds; the rest, where vertices
/// lie far behind or ahead of the hit, is held by this, else the one neighbour at an edge that is hit could be missed.
const MARGIN: f32 = 16.0 * MACHINE_EPSILON;

/// The box of a triangle, with its margin; empty where it is not finite.
///
/// A vertex's rounded coordinates are those of a vertex moved, along the ray's main axis, by as much as one of the
/// two sheared coordinates is off; what the other is off by then moves it along that one's axis. So a side without
/// width can go without: floors stay flat, and rays that leave them do not meet them.
fn triangle_bounds(vertices: [Vec3; 3]) -> Bounds3 {
    if !finite(vertices) {
        return Bounds3::EMPTY;
    }
    let [a, b, c] = vertices;
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    // What has two corners in one place can't be hit.
    let part = if a == b || b == c || c == a { 0.0 } else { MARGIN };
    let own = high * part - low * part;
    let mut margin = Vec3::splat(own.max_element());
    if let Some(flat) = own.to_array().iter().position(|width| *width == 0.0) {
        margin[flat] = 0.0;
    }
    // One step more, since rounding may have taken the margin away; but never to infinity.
    let (low, high) = ((low - margin).to_array(), (high + margin).to_array());
    Bounds3 {
        min: Vec3::from(low.map(|x| x.next_down().max(f32::MIN))),
        max: Vec3::from(high.map(|x| x.next_up().min(f32::MAX))),
    }
}
