//! Numbers of what lies below a group of instances.

use std::sync::Arc;

use umber_bvh::InstancePath;

/// Numbers of all of some kind (what emits, say) below a group of instances, in their order.
#[derive(Debug, Default)]
pub struct Numbering {
    /// For each instance how many come before it.
    before: Vec<u32>,
    /// Of each instance that is a group itself; empty where none is.
    inner: Vec<Option<Arc<Numbering>>>,
}

impl Numbering {
    /// Adds an instance.
    pub fn push(&mut self, before: u32, inner: Option<Arc<Self>>) {
        if let Some(inner) = inner {
            self.inner.resize_with(self.before.len(), || None);
            self.inner.push(Some(inner));
        }
        self.before.push(before);
    }
    /// The number of what a path leads to; it must be there and of that kind.
    #[inline]
    pub fn number(&self, path: &InstancePath) -> u32 {
        let (mut number, mut group) = (0, self);
        for &index in path.as_slice() {
            number += group.before.get(index as usize).copied().unwrap_or(0);
            match group.inner.get(index as usize) {
                Some(Some(inner)) => group = inner,
                _ => break,
            }
        }
        number
    }
}
