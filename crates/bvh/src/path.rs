//! Which instances a hit came through.

/// Most levels of [`crate::InstanceBvh`] on a path. Deeper nesting is the caller's to flatten.
pub const MAX_DEPTH: usize = 8;

/// The instance index at each level, outermost first.
#[derive(Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct InstancePath {
    indices: [u32; MAX_DEPTH],
    len: u8,
}

impl InstancePath {
    /// The indices, outermost first.
    #[inline]
    pub fn as_slice(&self) -> &[u32] {
        &self.indices[..self.len as usize]
    }

    /// From indices, outermost first; `None` where there are more than [`MAX_DEPTH`].
    pub fn from_slice(indices: &[u32]) -> Option<Self> {
        let mut path = Self::default();
        path.indices.get_mut(..indices.len())?.copy_from_slice(indices);
        path.len = indices.len() as u8;
        Some(path)
    }

    /// Goes one level in. The caller sees to it that there are no more than [`MAX_DEPTH`].
    #[inline]
    pub(crate) fn push(&mut self, index: u32) {
        if let Some(slot) = self.indices.get_mut(self.len as usize) {
            *slot = index;
            self.len += 1;
        }
    }

    /// Goes one level out.
    #[inline]
    pub(crate) fn pop(&mut self) {
        self.len = self.len.saturating_sub(1);
    }
}

impl std::fmt::Debug for InstancePath {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.as_slice().fmt(f)
    }
}
