//! Instancers: where the instances of their prototypes stand.

use std::sync::Arc;

use umber_math::DAffine3;

use crate::mesh::assign;
use crate::{Category, InstancerId};

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
    /// Categories of each instance; a list of one counts for all instances, an empty one says none. Those of the
    /// outermost instancer count, whatever it instances.
    pub categories: Arc<[Arc<[Category]>]>,
}

impl Default for Instancer {
    fn default() -> Self {
        Self {
            parent: None,
            parent_indices: Arc::default(),
            transforms: Arc::default(),
            visible: true,
            categories: Arc::default(),
        }
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
    /// See [`Instancer::categories`].
    pub categories: Option<Arc<[Arc<[Category]>]>>,
}

/// What changed in an instancer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InstancerChange {
    /// Where its instances stand, or whether they are shown.
    pub placement: bool,
    /// Their categories.
    pub links: bool,
}

impl InstancerChange {
    /// Whether anything changed.
    pub fn any(self) -> bool {
        self.placement || self.links
    }
}

impl Instancer {
    /// Takes over what the patch says and tells what that changed.
    pub fn apply(&mut self, patch: InstancerPatch) -> InstancerChange {
        let mut placement = assign(&mut self.parent, patch.parent);
        placement |= assign(&mut self.parent_indices, patch.parent_indices);
        placement |= assign(&mut self.transforms, patch.transforms);
        placement |= assign(&mut self.visible, patch.visible);
        InstancerChange { placement, links: assign(&mut self.categories, patch.categories) }
    }
}
