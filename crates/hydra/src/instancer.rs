//! Instancers, kept nested.

use std::sync::Arc;

use umber_scene::{Category, InstancerId, InstancerPatch, SceneEdit};

use crate::convert::{affines, categories};
use crate::delegate::Delegate;
use crate::guard::{Outcome, guard, guard_refusal};
use crate::host::Host;

/// One `HdInstancer`, and what a sync has pulled for it so far.
pub struct Instancer {
    host: Arc<Host>,
    id: InstancerId,
    patch: InstancerPatch,
    /// Those of each instance, as far as they were said.
    categories: Vec<Arc<[Category]>>,
}

pub fn new_instancer(delegate: &Delegate, path: &str) -> Outcome<Box<Instancer>> {
    guard(|| {
        let patch = InstancerPatch::default();
        Box::new(Instancer { host: delegate.host(), id: InstancerId::new(path), patch, categories: Vec::new() })
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

    pub fn clear_categories(&mut self) -> Outcome {
        guard(|| {
            self.categories.clear();
            self.patch.categories = Some(Arc::default());
        })
    }

    pub fn add_categories(&mut self, names: &[&str]) -> Outcome {
        guard(|| {
            // equal neighbours share one list
            let same = self.categories.last().filter(|last| last.iter().map(Category::path).eq(names.iter().copied()));
            let next = same.cloned().unwrap_or_else(|| categories(names));
            self.categories.push(next);
        })
    }

    pub fn commit(&mut self) -> Outcome {
        let mut patch = std::mem::take(&mut self.patch);
        if patch.categories.is_some() && self.categories.iter().any(|categories| !categories.is_empty()) {
            patch.categories = Some(std::mem::take(&mut self.categories).into());
        }
        guard_refusal(|| self.host.edit(SceneEdit::Instancer(self.id.clone(), patch)))
    }

    pub fn remove(&mut self) -> Outcome {
        guard_refusal(|| self.host.edit(SceneEdit::RemoveInstancer(self.id.clone())))
    }
}
