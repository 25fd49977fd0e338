//! The editable scene.

use std::collections::{BTreeMap, BTreeSet};

use umber_settings::{SettingError, Settings};

use crate::dirty::{Dirty, MeshDirty};
use crate::{
    Camera, CameraId, Instancer, InstancerId, Light, LightId, Material, MaterialId, Mesh, MeshId, Purpose, SceneEdit,
};

/// What all edits so far add up to, and what of it changed since [`SceneStore::take_dirty`].
#[derive(Clone, Debug, Default)]
pub struct SceneStore {
    meshes: BTreeMap<MeshId, Mesh>,
    instancers: BTreeMap<InstancerId, Instancer>,
    cameras: BTreeMap<CameraId, Camera>,
    lights: BTreeMap<LightId, Light>,
    materials: BTreeMap<MaterialId, Material>,
    render_camera: Option<CameraId>,
    purposes: BTreeSet<Purpose>,
    settings: Settings,
    dirty: Dirty,
}

impl SceneStore {
    /// Carries out one edit. True where it changed anything.
    ///
    /// # Errors
    /// A setting that does not exist or cannot have that value; nothing changes then.
    pub fn apply(&mut self, edit: SceneEdit) -> Result<bool, SettingError> {
        Ok(match edit {
            SceneEdit::Mesh(id, patch) => {
                let inserted = !self.meshes.contains_key(&id);
                let mut dirty = self.meshes.entry(id.clone()).or_default().apply(*patch);
                if inserted {
                    dirty = MeshDirty::ALL;
                }
                if dirty.any() {
                    self.dirty.meshes.entry(id).or_default().merge(dirty);
                }
                dirty.any()
            }
            SceneEdit::RemoveMesh(id) => {
                let removed = self.meshes.remove(&id).is_some();
                if removed {
                    self.dirty.meshes.insert(id, MeshDirty::ALL);
                }
                removed
            }
            SceneEdit::Instancer(id, patch) => {
                let inserted = !self.instancers.contains_key(&id);
                let change = self.instancers.entry(id).or_default().apply(patch);
                self.dirty.instancers |= change.placement | inserted;
                self.dirty.instancer_links |= change.links;
                change.any() | inserted
            }
            SceneEdit::RemoveInstancer(id) => {
                let changed = self.instancers.remove(&id).is_some();
                self.dirty.instancers |= changed;
                changed
            }
            SceneEdit::Camera(id, camera) => {
                let changed = self.cameras.get(&id) != Some(&camera);
                let in_use = self.render_camera.as_ref() == Some(&id);
                self.cameras.insert(id, camera);
                self.dirty.camera |= changed && in_use;
                changed && in_use
            }
            SceneEdit::RemoveCamera(id) => {
                let in_use = self.render_camera.as_ref() == Some(&id);
                let changed = self.cameras.remove(&id).is_some() && in_use;
                self.dirty.camera |= changed;
                changed
            }
            SceneEdit::RenderCamera(id) => {
                let changed = self.render_camera.as_ref() != Some(&id);
                self.render_camera = Some(id);
                self.dirty.camera |= changed;
                changed
            }
            SceneEdit::Light(id, light) => replace(&mut self.lights, &mut self.dirty.lights, id, Some(light)),
            SceneEdit::RemoveLight(id) => replace(&mut self.lights, &mut self.dirty.lights, id, None),
            SceneEdit::Material(id, m) => replace(&mut self.materials, &mut self.dirty.materials, id, Some(m)),
            SceneEdit::RemoveMaterial(id) => replace(&mut self.materials, &mut self.dirty.materials, id, None),
            SceneEdit::Purposes(shown) => {
                let shown = shown.into_iter().collect();
                let changed = self.purposes != shown;
                self.purposes = shown;
                self.dirty.purposes |= changed;
                changed
            }
            SceneEdit::Setting(key, value) => {
                let changed = self.settings.set(&key, &value)?;
                self.dirty.settings |= changed;
                changed
            }
        })
    }

    /// What changed since the last call, which forgets it.
    pub fn take_dirty(&mut self) -> Dirty {
        std::mem::take(&mut self.dirty)
    }
    /// What changed since [`SceneStore::take_dirty`] was last called.
    pub fn dirty(&self) -> &Dirty {
        &self.dirty
    }
    /// All meshes, by path.
    pub fn meshes(&self) -> &BTreeMap<MeshId, Mesh> {
        &self.meshes
    }
    /// All instancers, by path.
    pub fn instancers(&self) -> &BTreeMap<InstancerId, Instancer> {
        &self.instancers
    }
    /// All lights, by path.
    pub fn lights(&self) -> &BTreeMap<LightId, Light> {
        &self.lights
    }
    /// All materials, by path.
    pub fn materials(&self) -> &BTreeMap<MaterialId, Material> {
        &self.materials
    }
    /// The camera to look through, where it is named and exists.
    pub fn camera(&self) -> Option<&Camera> {
        self.cameras.get(self.render_camera.as_ref()?)
    }
    /// Whether prims of this purpose are shown.
    pub fn shows(&self, purpose: Purpose) -> bool {
        purpose == Purpose::Default || self.purposes.contains(&purpose)
    }
    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }
}

fn replace<K: Ord + Clone, V: PartialEq>(
    prims: &mut BTreeMap<K, V>,
    dirty: &mut BTreeSet<K>,
    id: K,
    value: Option<V>,
) -> bool {
    let changed = prims.get(&id) != value.as_ref();
    if changed {
        dirty.insert(id.clone());
    }
    match value {
        Some(value) => prims.insert(id, value),
        None => prims.remove(&id),
    };
    changed
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LightKind, MeshPatch};
    use umber_math::{DAffine3, DVec3};
    use umber_settings::Value;

    fn mesh(patch: MeshPatch) -> SceneEdit {
        SceneEdit::Mesh(MeshId::new("/m"), Box::new(patch))
    }

    #[test]
    fn equal_values_make_nothing_dirty() {
        let mut store = SceneStore::default();
        let edits = || {
            [
                mesh(MeshPatch { visible: Some(true), ..MeshPatch::default() }),
                SceneEdit::Light(LightId::new("/l"), Light::new(LightKind::Distant { angle_deg: 0.5 })),
                SceneEdit::Material(MaterialId::new("/k"), Material::Unknown),
                SceneEdit::RenderCamera(CameraId::new("/c")),
                SceneEdit::Camera(CameraId::new("/c"), Camera::default()),
                SceneEdit::Setting("umber:seed".into(), Value::Int(3)),
                SceneEdit::Purposes(vec![Purpose::Proxy]),
            ]
        };
        for edit in edits() {
            assert_eq!(store.apply(edit), Ok(true));
        }
        assert!(store.take_dirty().any());
        for edit in edits() {
            assert_eq!(store.apply(edit), Ok(false));
        }
        assert!(!store.take_dirty().any());
    }

    #[test]
    fn a_transform_edit_leaves_geometry_clean() {
        let mut store = SceneStore::default();
        store.apply(mesh(MeshPatch::default())).unwrap();
        assert_eq!(store.take_dirty().meshes[&MeshId::new("/m")], MeshDirty::ALL);
        let moved = DAffine3::from_translation(DVec3::X);
        store.apply(mesh(MeshPatch { transform: Some(moved), ..MeshPatch::default() })).unwrap();
        let dirty = store.take_dirty();
        let want = MeshDirty { placement: true, ..MeshDirty::default() };
        assert_eq!(dirty.meshes[&MeshId::new("/m")], want);
        store.apply(SceneEdit::RemoveMesh(MeshId::new("/m"))).unwrap();
        assert!(store.meshes().is_empty() && store.take_dirty().any());
    }

    #[test]
    fn an_idle_camera_makes_nothing_dirty() {
        let mut store = SceneStore::default();
        assert_eq!(store.apply(SceneEdit::Camera(CameraId::new("/a"), Camera::default())), Ok(false));
        assert!(store.camera().is_none() && !store.take_dirty().any());
        assert_eq!(store.apply(SceneEdit::RenderCamera(CameraId::new("/a"))), Ok(true));
        assert!(store.camera().is_some());
    }
}
