//! The traversal, for any vector unit.

use super::{Isa, Lanes, kernel, stack::Stack};
use crate::prefetch::prefetch_four_lines;
use crate::{
    ray::{FAR_SLACK, TraversalRay},
    wide::{ChildRef, WideNode, WideTree},
};

/// What to do at a leaf.
pub(super) trait Visitor {
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
pub(super) unsafe fn walk<S: Isa, V: Visitor, const ORDERED: bool>(
    tree: &WideTree,
    ray: &TraversalRay,
    visitor: &mut V,
) {
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
            let mask = unsafe { kernel::boxes::<S>(node, ray, visitor.limit() * FAR_SLACK, &mut near) };
            if mask != 0 {
                let before = stack.len;
                // SAFETY: the mask's bits are children of the node, and the stack holds what the tree needs.
                current = unsafe { descend::<ORDERED>(node, mask, &near, &mut stack) };
                // What is left for later comes from memory meanwhile.
                for at in before..stack.len {
                    // SAFETY: the entries were just set.
                    let child = ChildRef(unsafe { stack.get(at) } as u32);
                    let node = tree.nodes.as_ptr().wrapping_add(child.0 as usize).cast();
                    prefetch_four_lines(if child.is_leaf() { visitor.first_read(child.range().0) } else { node });
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

/// Calls a closure for each primitive; it gives a new limit or none.
struct Each<F> {
    visit: F,
    limit: f32,
}

impl<F: FnMut(usize, f32) -> Option<f32>> Visitor for Each<F> {
    #[inline(always)]
    fn first_read(&self, _: usize) -> *const u8 {
        std::ptr::null()
    }
    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }
    #[inline(always)]
    unsafe fn visit(&mut self, start: usize, count: usize) -> bool {
        for slot in start..start + count {
            if let Some(limit) = (self.visit)(slot, self.limit) {
                self.limit = self.limit.min(limit);
            }
        }
        false
    }
}

/// See [`visit_boxes`](super::visit_boxes).
///
/// # Safety
/// The processor has the unit `S`.
#[inline(always)]
pub(super) unsafe fn each<S: Isa, F: FnMut(usize, f32) -> Option<f32>>(
    tree: &WideTree,
    ray: &TraversalRay,
    limit: f32,
    visit: F,
) {
    // SAFETY: the caller vouches for the unit.
    unsafe { walk::<S, _, true>(tree, ray, &mut Each { visit, limit }) }
}
