//! The hierarchy of one mesh's triangles.

use glam::Vec3;
use rayon::prelude::*;
use umber_math::{Bounds3, Point3};

use crate::wide::{MAX_PRIMITIVES, WIDTH, WideTree};

/// Floats of a triangle: three vertices of three coordinates.
const FLOATS: usize = 9;

/// Triangles of one mesh, in the mesh's own (object) space.
///
/// Holds the vertices of each triangle, so that a test needs no look-up; the original triangle
/// indices are kept aside and read at hits only. About 50 bytes a triangle.
#[derive(Clone)]
pub struct MeshBvh {
    tree: WideTree,
    /// Leaf after leaf: the nine coordinate rows of its triangles, as long as the leaf has
    /// triangles. Eight zeros at the end let whole vectors be read.
    coordinates: Vec<f32>,
    /// The caller's index of each triangle, in the tree's order.
    triangles: Vec<u32>,
    skipped: usize,
}

impl MeshBvh {
    /// Builds the hierarchy. Triangles are triples of point indices.
    ///
    /// Triangles with an index out of range or a point that is not finite can't be hit; see
    /// [`MeshBvh::skipped`]. At most 2²⁸ − 8 triangles are taken.
    pub fn build(points: &[Point3], triangles: &[[u32; 3]]) -> Self {
        let mut valid: Vec<u32> =
            (0..triangles.len() as u32).filter(|&i| corners(points, triangles, i).is_some_and(finite)).collect();
        valid.truncate(MAX_PRIMITIVES);
        let bounds =
            |&i: &u32| corners(points, triangles, i).map_or(Bounds3::EMPTY, |p| Bounds3::of_points(p.map(Point3)));
        let boxes: Vec<Bounds3> = valid.par_iter().map(bounds).collect();
        let (tree, mut order) = WideTree::build(&boxes, WIDTH);
        for slot in &mut order {
            *slot = valid[*slot as usize];
        }
        let skipped = triangles.len() - order.len();
        let mut bvh = Self { tree, coordinates: Vec::new(), triangles: order, skipped };
        bvh.coordinates = vec![0.0; bvh.triangles.len() * FLOATS + WIDTH];
        bvh.store(points, triangles);
        bvh
    }

    /// Moves the triangles: same topology, new points. Quality falls as shapes change much.
    ///
    /// `triangles` are those that it was built with. A triangle that is not finite any more can't be hit.
    pub fn refit(&mut self, points: &[Point3], triangles: &[[u32; 3]]) {
        self.store(points, triangles);
        let coordinates = &self.coordinates;
        self.tree.fit(|start, count| leaf_bounds(&coordinates[start * FLOATS..(start + count) * FLOATS], count));
    }

    /// Fills in the coordinates, leaf by leaf.
    fn store(&mut self, points: &[Point3], triangles: &[[u32; 3]]) {
        let Self { tree, coordinates, triangles: order, .. } = self;
        let mut leaf = |start: usize, count: usize| {
            let rows = &mut coordinates[start * FLOATS..(start + count) * FLOATS];
            for lane in 0..count {
                let p = corners(points, triangles, order[start + lane]).unwrap_or([Vec3::NAN; 3]);
                for (row, value) in p.iter().flat_map(|v| v.to_array()).enumerate() {
                    rows[row * count + lane] = value;
                }
            }
        };
        tree.leaves().for_each(|(start, count)| leaf(start, count));
    }

    /// The box around all triangles that can be hit.
    pub fn bounds(&self) -> Bounds3 {
        self.tree.bounds
    }

    /// Number of triangles that can be hit.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Number of triangles left out when built: bad indices, or points not finite.
    pub fn skipped(&self) -> usize {
        self.skipped
    }

    /// Memory held, in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Self>() + self.tree.memory_bytes() + 4 * (self.coordinates.capacity() + self.triangles.capacity())
    }

    #[inline(always)]
    pub(crate) fn tree(&self) -> &WideTree {
        &self.tree
    }

    /// The coordinate rows of the leaf that begins at triangle `start`.
    #[inline(always)]
    pub(crate) fn rows(&self, start: usize) -> *const f32 {
        debug_assert!(start < self.triangles.len());
        self.coordinates.as_ptr().wrapping_add(start * FLOATS)
    }

    /// The caller's index of the triangle at a place in the tree's order.
    #[inline]
    pub(crate) fn triangle_at(&self, slot: usize) -> u32 {
        self.triangles[slot]
    }

    /// Vertices of one triangle of a leaf.
    pub(crate) fn leaf_vertices(&self, start: usize, count: usize, lane: usize) -> [Vec3; 3] {
        let at = |row: usize| self.coordinates[start * FLOATS + row * count + lane];
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

/// The box of a leaf, from its coordinate rows.
fn leaf_bounds(rows: &[f32], count: usize) -> Bounds3 {
    let at = |row: usize, lane: usize| rows[row * count + lane];
    let vertex = |lane: usize, v: usize| Point3::new(at(3 * v, lane), at(3 * v + 1, lane), at(3 * v + 2, lane));
    Bounds3::of_points((0..count).flat_map(|lane| [0, 1, 2].map(|v| vertex(lane, v))))
}
