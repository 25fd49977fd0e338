//! Instancers: where the instances of their prototypes stand.

use std::sync::Arc;

use umber_math::DAffine3;

use crate::InstancerId;
use crate::mesh::assign;

/// An instancer as the host has described it so far.
///
/// A prototype's point goes by its own transform, then by one of [`transforms`](Self::transforms),
/// then by the parent's instances, if there is a parent. Only the outermost leads to world space.
#[derive(Clone, Debug, PartialEq)]
pub struct Instancer {
    /// The instancer that instances this one.
    pub parent: Option<InstancerId>,
    /// Which of the parent's instances show this instancer.
    pub parent_indices: Arc<[i32]>,
    /// One transform an instance: parent space (world where there is no parent) from prototype space.
    pub transforms: Arc<[DAffine3]>,
    /// Whether it is shown at all.
    pub visible: bool,
}

impl Default for Instancer {
    fn default() -> Self {
        Self { parent: None, parent_indices: Arc::default(), transforms: Arc::default(), visible: true }
    }
}

/// What an edit says of an instancer: fields that are `None` stay as they are.
#[derive(Clone, Debug, Default)]
pub struct InstancerPatch {
    /// See [`Instancer::parent`].
    pub parent: Option<Option<InstancerId>>,
    /// See [`Instancer::parent_indices`].
    pub parent_indices: Option<Arc<[i32]>>,
    /// See [`Instancer::transforms`].
    pub transforms: Option<Arc<[DAffine3]>>,
    /// See [`Instancer::visible`].
    pub visible: Option<bool>,
}

impl Instancer {
    /// Takes over what the patch says; true where anything changed.
    pub fn apply(&mut self, patch: InstancerPatch) -> bool {
        let mut changed = assign(&mut self.parent, patch.parent);
        changed |= assign(&mut self.parent_indices, patch.parent_indices);
        changed |= assign(&mut self.transforms, patch.transforms);
        changed |= assign(&mut self.visible, patch.visible);
        changed
    }
}
