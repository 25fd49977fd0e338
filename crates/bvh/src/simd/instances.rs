//! Searches of a group's instances.

use std::marker::PhantomData;

use super::{
    Isa,
    walk::{Visitor, walk},
};
use crate::{
    instance::{Child, InstanceBvh},
    ray::TraversalRay,
    search::Search,
};

/// Closest hit among a group's instances.
struct GroupClosest<'a, S> {
    group: &'a InstanceBvh,
    ray: &'a TraversalRay,
    search: &'a mut Search,
    unit: PhantomData<S>,
}

impl<S: Isa> Visitor for GroupClosest<'_, S> {
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
struct GroupAny<'a, S> {
    group: &'a InstanceBvh,
    ray: &'a TraversalRay,
    limit: f32,
    found: bool,
    unit: PhantomData<S>,
}

impl<S: Isa> Visitor for GroupAny<'_, S> {
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

/// See [`Isa::group_closest`].
#[inline(always)]
pub(super) unsafe fn closest<S: Isa>(group: &InstanceBvh, ray: &TraversalRay, search: &mut Search) {
    let unit = PhantomData::<S>;
    let mut visitor = GroupClosest { group, ray, search, unit };
    // SAFETY: the caller vouches for the unit.
    unsafe { walk::<S, _, true>(group.tree(), ray, &mut visitor) }
}

/// See [`Isa::group_any`].
#[inline(always)]
pub(super) unsafe fn any<S: Isa>(group: &InstanceBvh, ray: &TraversalRay, limit: f32) -> bool {
    let unit = PhantomData::<S>;
    let mut visitor = GroupAny { group, ray, limit, found: false, unit };
    // SAFETY: the caller vouches for the unit.
    unsafe { walk::<S, _, false>(group.tree(), ray, &mut visitor) };
    visitor.found
}
