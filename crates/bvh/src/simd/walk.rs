//! The traversal, for any vector unit.

use umber_geometry::watertight::TriangleHit;
use umber_math::Point3;

use super::{
    Isa, LaneHits, Lanes,
    portable::Portable,
    stack::{Stack, prefetch},
};
use crate::{
    instance::{Child, InstanceBvh},
    mesh::MeshBvh,
    ray::{FAR_SLACK, TraversalRay},
    search::Search,
    wide::{ChildRef, WideNode, WideTree},
};

/// What to do at a leaf.
trait Visitor {
    /// Boxes that the ray enters beyond this are passed over.
    fn limit(&self) -> f32;
    /// Visits a leaf. True ends the traversal.
    ///
    /// # Safety
    /// The range is a leaf of the visitor's tree, and the processor has the visitor's vector unit.
    unsafe fn visit(&mut self, start: usize, count: usize) -> bool;
    /// What a visit of a leaf will read first.
    fn first_read(&self, start: usize) -> *const u8;
}

/// Visits the leaves whose boxes the ray meets, nearest first if `ORDERED`.
///
/// # Safety
/// The processor has the unit `S`, and the visitor belongs to the tree.
#[inline(always)]
unsafe fn walk<S: Isa + ?Sized, V: Visitor, const ORDERED: bool>(tree: &WideTree, ray: &TraversalRay, visitor: &mut V) {
    if tree.root == ChildRef::NONE || visitor.limit() < ray.t_min {
        return;
    }
    let mut stack = Stack::new();
    let mut near = Lanes::default();
    let mut current = tree.root;
    loop {
        if current.is_leaf() {
            let (start, count) = current.range();
            // SAFETY: the reference is one of the tree's.
            if unsafe { visitor.visit(start, count) } {
                return;
            }
        } else {
            // SAFETY: inner references are indices of the tree's nodes.
            let node = unsafe { tree.nodes.get_unchecked(current.0 as usize) };
            // SAFETY: the caller vouches for the unit.
            let mask = unsafe { S::boxes(node, ray, visitor.limit() * FAR_SLACK, &mut near) };
            if mask != 0 {
                // SAFETY: the mask's bits are children of the node, and the stack holds what the tree needs.
                let before = stack.len;
                current = unsafe { descend::<ORDERED>(node, mask, &near, &mut stack) };
                // What is left for later comes from memory meanwhile.
                for at in before..stack.len {
                    // SAFETY: the entries were just set.
                    let child = ChildRef(unsafe { stack.get(at) } as u32);
                    let node = tree.nodes.as_ptr().wrapping_add(child.0 as usize).cast();
                    prefetch(if child.is_leaf() { visitor.first_read(child.range().0) } else { node });
                }
                continue;
            }
        }
        match stack.pop(visitor.limit()) {
            Some(child) => current = child,
            None => return,
        }
    }
}

/// Picks the child to go to and pushes the others.
///
/// # Safety
/// `mask` is not zero and has only the low eight bits; the stack has room for that many entries.
#[inline(always)]
unsafe fn descend<const ORDERED: bool>(node: &WideNode, mask: u32, near: &Lanes, stack: &mut Stack) -> ChildRef {
    // SAFETY: bits of the mask are below eight; entries are set in order from the old length on.
    unsafe {
        let child = |i: usize| *node.children.get_unchecked(i);
        if !ORDERED {
            let mut next = child(mask.trailing_zeros() as usize);
            let mut rest = mask & (mask - 1);
            while rest != 0 {
                stack.set(stack.len, Stack::entry(0.0, next));
                stack.len += 1;
                next = child(rest.trailing_zeros() as usize);
                rest &= rest - 1;
            }
            return next;
        }
        let entry = |i: usize| Stack::entry(*near.0.get_unchecked(i), child(i));
        let first = mask.trailing_zeros() as usize;
        let mut rest = mask & (mask - 1);
        if rest == 0 {
            return child(first);
        }
        let second = rest.trailing_zeros() as usize;
        rest &= rest - 1;
        let (a, b) = (entry(first), entry(second));
        if rest == 0 {
            stack.set(stack.len, a.max(b));
            stack.len += 1;
            return ChildRef(a.min(b) as u32);
        }
        let base = stack.len;
        stack.set(base, a.max(b));
        stack.set(base + 1, a.min(b));
        stack.len = base + 2;
        while rest != 0 {
            let c = entry(rest.trailing_zeros() as usize);
            rest &= rest - 1;
            let mut at = stack.len;
            while at > base && stack.get(at - 1) < c {
                stack.set(at, stack.get(at - 1));
                at -= 1;
            }
            stack.set(at, c);
            stack.len += 1;
        }
        stack.len -= 1;
        ChildRef(stack.get(stack.len) as u32)
    }
}

/// Closest hit among a mesh's triangles.
struct MeshClosest<'a, S: ?Sized> {
    mesh: &'a MeshBvh,
    id: u32,
    ray: &'a TraversalRay,
    search: &'a mut Search,
    hits: LaneHits,
    unit: std::marker::PhantomData<S>,
}

impl<S: Isa + ?Sized> Visitor for MeshClosest<'_, S> {
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
        let masks = unsafe { S::triangles(rows, count, self.ray, self.search.limit, &mut self.hits) };
        if masks.hit | masks.again != 0 {
            self.take(start, count, masks.hit, masks.again);
        }
        false
    }
}

impl<S: Isa + ?Sized> MeshClosest<'_, S> {
    #[inline]
    fn take(&mut self, start: usize, count: usize, mut hit: u32, mut again: u32) {
        while hit != 0 {
            let lane = hit.trailing_zeros() as usize & 7;
            hit &= hit - 1;
            let barycentrics = self.hits.barycentrics.map(|b| b.0[lane]);
            self.search.offer(self.hits.t.0[lane], barycentrics, self.id, self.mesh.triangle_at(start, count, lane));
        }
        while again != 0 {
            let lane = again.trailing_zeros() as usize;
            again &= again - 1;
            if let Some(hit) = scalar_test(self.mesh, start, count, lane, self.ray, self.search.limit) {
                self.search.offer(hit.t, hit.barycentrics, self.id, self.mesh.triangle_at(start, count, lane));
            }
        }
    }
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
struct MeshAny<'a, S: ?Sized> {
    mesh: &'a MeshBvh,
    ray: &'a TraversalRay,
    limit: f32,
    hits: LaneHits,
    found: bool,
    unit: std::marker::PhantomData<S>,
}

impl<S: Isa + ?Sized> Visitor for MeshAny<'_, S> {
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
        let masks = unsafe { S::triangles(self.mesh.rows(start), count, self.ray, self.limit, &mut self.hits) };
        let again = |lane| scalar_test(self.mesh, start, count, lane, self.ray, self.limit).is_some();
        self.found = masks.hit != 0 || masks.again != 0 && (0..count).any(|l| masks.again >> l & 1 == 1 && again(l));
        self.found
    }
}

/// Closest hit among a group's instances.
struct GroupClosest<'a, S: ?Sized> {
    group: &'a InstanceBvh,
    ray: &'a TraversalRay,
    search: &'a mut Search,
    unit: std::marker::PhantomData<S>,
}

impl<S: Isa + ?Sized> Visitor for GroupClosest<'_, S> {
    #[inline(always)]
    fn first_read(&self, start: usize) -> *const u8 {
        std::ptr::from_ref(self.group.placed(start)).cast()
    }
    #[inline(always)]
    fn limit(&self) -> f32 {
        self.search.limit
    }
    #[inline(always)]
    unsafe fn visit(&mut self, start: usize, count: usize) -> bool {
        for slot in start..start + count {
            let placed = self.group.placed(slot);
            let inside;
            let ray = match placed.child_from_parent() {
                None => self.ray,
                Some(matrix) => match self.ray.transformed(matrix) {
                    None => continue,
                    Some(r) => {
                        inside = r;
                        &inside
                    }
                },
            };
            self.search.path.push(placed.index);
            // SAFETY: the caller vouches for the unit.
            unsafe {
                match &placed.child {
                    Child::Mesh { bvh, mesh } => S::mesh_closest(bvh, *mesh, ray, self.search),
                    Child::Group(group) => S::group_closest(group, ray, self.search),
                }
            }
            self.search.path.pop();
        }
        false
    }
}

/// Any hit among a group's instances.
struct GroupAny<'a, S: ?Sized> {
    group: &'a InstanceBvh,
    ray: &'a TraversalRay,
    limit: f32,
    found: bool,
    unit: std::marker::PhantomData<S>,
}

impl<S: Isa + ?Sized> Visitor for GroupAny<'_, S> {
    #[inline(always)]
    fn first_read(&self, start: usize) -> *const u8 {
        std::ptr::from_ref(self.group.placed(start)).cast()
    }
    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }
    #[inline(always)]
    unsafe fn visit(&mut self, start: usize, count: usize) -> bool {
        self.found = (start..start + count).any(|slot| {
            let placed = self.group.placed(slot);
            let inside = placed.child_from_parent().map(|m| self.ray.transformed(m));
            let ray = match &inside {
                None => self.ray,
                Some(None) => return false,
                Some(Some(r)) => r,
            };
            // SAFETY: the caller vouches for the unit.
            unsafe {
                match &placed.child {
                    Child::Mesh { bvh, .. } => S::mesh_any(bvh, ray, self.limit),
                    Child::Group(group) => S::group_any(group, ray, self.limit),
                }
            }
        });
        self.found
    }
}

/// See [`Isa::mesh_closest`].
#[inline(always)]
pub(super) unsafe fn mesh_closest<S: Isa + ?Sized>(mesh: &MeshBvh, id: u32, ray: &TraversalRay, search: &mut Search) {
    let unit = std::marker::PhantomData::<S>;
    let mut visitor = MeshClosest { mesh, id, ray, search, hits: LaneHits::default(), unit };
    // SAFETY: the caller vouches for the unit.
    unsafe { walk::<S, _, true>(mesh.tree(), ray, &mut visitor) }
}

/// See [`Isa::mesh_any`].
#[inline(always)]
pub(super) unsafe fn mesh_any<S: Isa + ?Sized>(mesh: &MeshBvh, ray: &TraversalRay, limit: f32) -> bool {
    let unit = std::marker::PhantomData::<S>;
    let mut visitor = MeshAny { mesh, ray, limit, hits: LaneHits::default(), found: false, unit };
    // SAFETY: the caller vouches for the unit.
    unsafe { walk::<S, _, false>(mesh.tree(), ray, &mut visitor) };
    visitor.found
}

/// See [`Isa::group_closest`].
#[inline(always)]
pub(super) unsafe fn group_closest<S: Isa + ?Sized>(group: &InstanceBvh, ray: &TraversalRay, search: &mut Search) {
    let unit = std::marker::PhantomData::<S>;
    let mut visitor = GroupClosest { group, ray, search, unit };
    // SAFETY: the caller vouches for the unit.
    unsafe { walk::<S, _, true>(group.tree(), ray, &mut visitor) }
}

/// See [`Isa::group_any`].
#[inline(always)]
pub(super) unsafe fn group_any<S: Isa + ?Sized>(group: &InstanceBvh, ray: &TraversalRay, limit: f32) -> bool {
    let unit = std::marker::PhantomData::<S>;
    let mut visitor = GroupAny { group, ray, limit, found: false, unit };
    // SAFETY: the caller vouches for the unit.
    unsafe { walk::<S, _, false>(group.tree(), ray, &mut visitor) };
    visitor.found
}

/// Calls a closure for each primitive; it gives a new limit or none.
struct Each<F> {
    visit: F,
    limit: f32,
}

impl<F: FnMut(usize, f32) -> Option<f32>> Visitor for Each<F> {
    fn first_read(&self, _: usize) -> *const u8 {
        std::ptr::null()
    }
    fn limit(&self) -> f32 {
        self.limit
    }
    unsafe fn visit(&mut self, start: usize, count: usize) -> bool {
        for slot in start..start + count {
            if let Some(limit) = (self.visit)(slot, self.limit) {
                self.limit = self.limit.min(limit);
            }
        }
        false
    }
}

/// Calls `visit` with each primitive, by its place in the tree's order, whose box the ray meets up
/// to the limit; nearer boxes first. What it gives becomes the limit, if smaller.
pub(crate) fn walk_portable(
    tree: &WideTree,
    ray: &TraversalRay,
    limit: f32,
    visit: impl FnMut(usize, f32) -> Option<f32>,
) {
    // SAFETY: every processor has the portable unit.
    unsafe { walk::<Portable, _, true>(tree, ray, &mut Each { visit, limit }) }
}
