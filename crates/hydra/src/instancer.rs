//! Instancers, kept nested.

use std::sync::Arc;

use umber_scene::{InstancerId, InstancerPatch, SceneEdit};

use crate::convert::affines;
use crate::delegate::Delegate;
use crate::guard::{Outcome, guard, guard_refusal};
use crate::host::Host;

/// One `HdInstancer`, and what a sync has pulled for it so far.
pub struct Instancer {
    host: Arc<Host>,
    id: InstancerId,
    patch: InstancerPatch,
}

pub fn new_instancer(delegate: &Delegate, path: &str) -> Outcome<Box<Instancer>> {
    guard(|| {
        let patch = InstancerPatch::default();
        Box::new(Instancer { host: delegate.host(), id: InstancerId::new(path), patch })
    })
}

impl Instancer {
    pub fn set_parent(&mut self, path: &str, indices: &[i32]) -> Outcome {
        guard(|| {
            self.patch.parent = Some((!path.is_empty()).then(|| InstancerId::new(path)));
            self.patch.parent_indices = Some(indices.into());
        })
    }

    pub fn set_transforms(&mut self, matrices: &[f64]) -> Outcome {
        guard(|| self.patch.transforms = Some(affines(matrices)))
    }

    pub fn set_visible(&mut self, visible: bool) -> Outcome {
        guard(|| self.patch.visible = Some(visible))
    }

    pub fn commit(&mut self) -> Outcome {
        let patch = std::mem::take(&mut self.patch);
        guard_refusal(|| self.host.edit(SceneEdit::Instancer(self.id.clone(), patch)))
    }

    pub fn remove(&mut self) -> Outcome {
        guard_refusal(|| self.host.edit(SceneEdit::RemoveInstancer(self.id.clone())))
    }
}
