//! Searches of a mesh's triangles.

use std::marker::PhantomData;

use umber_geometry::watertight::TriangleHit;
use umber_math::Point3;

use super::{
    Isa, LaneHits, LaneMasks, kernel,
    walk::{Visitor, walk},
};
use crate::{mesh::MeshBvh, ray::TraversalRay, search::Search};

/// Closest hit among a mesh's triangles.
struct MeshClosest<'a, S> {
    mesh: &'a MeshBvh,
    id: u32,
    ray: &'a TraversalRay,
    search: &'a mut Search,
    hits: LaneHits,
    unit: PhantomData<S>,
}

impl<S: Isa> Visitor for MeshClosest<'_, S> {
    #[inline(always)]
    fn first_read(&self, start: usize) -> *const u8 {
        self.mesh.rows(start).cast()
    }
    #[inline(always)]
    fn limit(&self) -> f32 {
        self.search.limit
    }
    #[inline(always)]
    unsafe fn visit(&mut self, start: usize, count: usize) -> bool {
        let rows = self.mesh.rows(start);
        // SAFETY: the mesh keeps eight floats more than its triangles need; the caller vouches for the unit.
        let masks = unsafe { kernel::triangles::<S>(rows, count, self.ray, self.search.limit, &mut self.hits) };
        if masks.hit | masks.near | masks.again != 0 {
            self.take(start, count, masks);
        }
        false
    }
}

impl<S: Isa> MeshClosest<'_, S> {
    #[inline(always)]
    fn take(&mut self, start: usize, count: usize, masks: LaneMasks) {
        for lane in lanes(masks.hit) {
            self.offer(start, count, lane, self.hits.t.0[lane]);
        }
        for lane in lanes(masks.near) {
            if let Some(t) = near_parameter(self.mesh, start, count, lane, self.ray, self.search.limit) {
                self.offer(start, count, lane, t);
            }
        }
        for lane in lanes(masks.again) {
            if let Some(hit) = scalar_test(self.mesh, start, count, lane, self.ray, self.search.limit) {
                self.search.offer(hit.t, hit.barycentrics, self.id, self.mesh.triangle_at(start, count, lane));
            }
        }
    }

    /// A hit with the barycentrics that the vector unit found.
    #[inline(always)]
    fn offer(&mut self, start: usize, count: usize, lane: usize, t: f32) {
        let [u, v, w] = &self.hits.barycentrics;
        let barycentrics = [u.0[lane], v.0[lane], w.0[lane]];
        self.search.offer(t, barycentrics, self.id, self.mesh.triangle_at(start, count, lane));
    }
}

/// The lanes of a mask.
#[inline(always)]
fn lanes(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = mask.trailing_zeros() as usize & 7;
        (mask != 0).then(|| {
            mask &= mask - 1;
            lane
        })
    })
}

/// The parameter of a hit that may be on either side of the ray's origin, if it is up to and with `limit`.
#[inline(never)]
fn near_parameter(
    mesh: &MeshBvh,
    start: usize,
    count: usize,
    lane: usize,
    ray: &TraversalRay,
    limit: f32,
) -> Option<f32> {
    let t = ray.sheared.plane_parameter(mesh.leaf_vertices(start, count, lane).map(Point3));
    (t > ray.t_min && t <= limit).then_some(t)
}

/// The scalar test of one lane of a leaf, up to and with `limit`.
#[cold]
fn scalar_test(
    mesh: &MeshBvh,
    start: usize,
    count: usize,
    lane: usize,
    ray: &TraversalRay,
    limit: f32,
) -> Option<TriangleHit> {
    let [p0, p1, p2] = mesh.leaf_vertices(start, count, lane).map(Point3);
    ray.sheared.intersect(p0, p1, p2, ray.t_min, limit.next_up())
}

/// Any hit among a mesh's triangles.
struct MeshAny<'a, S> {
    mesh: &'a MeshBvh,
    ray: &'a TraversalRay,
    limit: f32,
    hits: LaneHits,
    found: bool,
    unit: PhantomData<S>,
}

impl<S: Isa> Visitor for MeshAny<'_, S> {
    #[inline(always)]
    fn first_read(&self, start: usize) -> *const u8 {
        self.mesh.rows(start).cast()
    }
    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }
    #[inline(always)]
    unsafe fn visit(&mut self, start: usize, count: usize) -> bool {
        // SAFETY: as for the closest hit.
        let masks =
            unsafe { kernel::triangles::<S>(self.mesh.rows(start), count, self.ray, self.limit, &mut self.hits) };
        if masks.hit | masks.near | masks.again == 0 {
            return false;
        }
        let (mesh, ray, limit) = (self.mesh, self.ray, self.limit);
        self.found = masks.hit != 0
            || lanes(masks.near).any(|lane| near_parameter(mesh, start, count, lane, ray, limit).is_some())
            || lanes(masks.again).any(|lane| scalar_test(mesh, start, count, lane, ray, limit).is_some());
        self.found
    }
}

/// See [`Isa::mesh_closest`].
#[inline(always)]
pub(super) unsafe fn closest<S: Isa>(mesh: &MeshBvh, id: u32, ray: &TraversalRay, search: &mut Search) {
    let unit = PhantomData::<S>;
    let mut visitor = MeshClosest { mesh, id, ray, search, hits: LaneHits::default(), unit };
    // SAFETY: the caller vouches for the unit.
    unsafe { walk::<S, _, true>(mesh.tree(), ray, &mut visitor) }
}

/// See [`Isa::mesh_any`].
#[inline(always)]
pub(super) unsafe fn any<S: Isa>(mesh: &MeshBvh, ray: &TraversalRay, limit: f32) -> bool {
    let unit = PhantomData::<S>;
    let mut visitor = MeshAny { mesh, ray, limit, hits: LaneHits::default(), found: false, unit };
    // SAFETY: the caller vouches for the unit.
    unsafe { walk::<S, _, false>(mesh.tree(), ray, &mut visitor) };
    visitor.found
}
