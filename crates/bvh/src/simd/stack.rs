//! What a traversal comes back to.

use std::mem::MaybeUninit;

use crate::{
    ray::FAR_SLACK,
    wide::{ChildRef, STACK_SIZE},
};

/// Children to come back to: the entry parameter's bits above the reference. Both are compared at
/// once, since the parameter is never negative.
pub(super) struct Stack {
    entries: [MaybeUninit<u64>; STACK_SIZE],
    /// Number of entries.
    pub len: usize,
}

impl Stack {
    #[inline(always)]
    pub fn new() -> Self {
        Self { entries: [const { MaybeUninit::uninit() }; STACK_SIZE], len: 0 }
    }
    #[inline(always)]
    pub fn entry(near: f32, child: ChildRef) -> u64 {
        u64::from(near.to_bits()) << 32 | u64::from(child.0)
    }
    /// # Safety
    /// No more than [`STACK_SIZE`] entries: the tree was built so that none needs more.
    #[inline(always)]
    pub unsafe fn set(&mut self, at: usize, entry: u64) {
        debug_assert!(at < STACK_SIZE);
        // SAFETY: the caller's promise.
        unsafe { self.entries.get_unchecked_mut(at) }.write(entry);
    }
    /// # Safety
    /// Entry `at` was set.
    #[inline(always)]
    pub unsafe fn get(&self, at: usize) -> u64 {
        // SAFETY: the caller's promise.
        unsafe { self.entries.get_unchecked(at).assume_init() }
    }
    /// The next child that begins within the limit.
    #[inline(always)]
    pub fn pop(&mut self, limit: f32) -> Option<ChildRef> {
        let limit = u64::from((limit * FAR_SLACK).to_bits()) << 32 | 0xffff_ffff;
        while self.len > 0 {
            self.len -= 1;
            // SAFETY: all entries below the old length were set.
            let entry = unsafe { self.get(self.len) };
            if entry <= limit {
                return Some(ChildRef(entry as u32));
            }
        }
        None
    }
}
