//! Edits: the only way to change anything.

use umber_settings::Value;

use crate::{
    Camera, CameraId, InstancerId, InstancerPatch, Light, LightId, Material, MaterialId, MeshId, MeshPatch, Purpose,
};

/// One change. Prims that do not exist yet are inserted with their fallbacks first.
#[derive(Clone, Debug)]
pub enum SceneEdit {
    /// Inserts or updates a mesh.
    Mesh(MeshId, Box<MeshPatch>),
    /// Removes a mesh.
    RemoveMesh(MeshId),
    /// Inserts or updates an instancer.
    Instancer(InstancerId, InstancerPatch),
    /// Removes an instancer.
    RemoveInstancer(InstancerId),
    /// Inserts or replaces a camera.
    Camera(CameraId, Camera),
    /// Removes a camera.
    RemoveCamera(CameraId),
    /// Inserts or replaces a light.
    Light(LightId, Light),
    /// Removes a light.
    RemoveLight(LightId),
    /// Inserts or replaces a material.
    Material(MaterialId, Material),
    /// Removes a material.
    RemoveMaterial(MaterialId),
    /// Names the camera to look through.
    RenderCamera(CameraId),
    /// Purposes that are shown, beside those of default purpose.
    Purposes(Vec<Purpose>),
    /// Sets a row of the settings table.
    Setting(String, Value),
}
