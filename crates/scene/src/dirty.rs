//! What changed since the scene was last compiled.

use std::collections::{BTreeMap, BTreeSet};

use crate::{LightId, MaterialId, MeshId};

/// What changed in one mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MeshDirty {
    /// Faces: everything derived from the mesh is stale.
    pub topology: bool,
    /// Points: the mesh's BVH is stale.
    pub points: bool,
    /// Normals or other primvars.
    pub attributes: bool,
    /// Transform, visibility, purpose, instancing: only the top level is stale.
    pub placement: bool,
    /// Material, sidedness, ids: no BVH is stale.
    pub binding: bool,
    /// Categories: which lights reach it, and are shadowed by it.
    pub links: bool,
}

impl MeshDirty {
    /// All of it.
    pub const ALL: Self =
        Self { topology: true, points: true, attributes: true, placement: true, binding: true, links: true };

    /// Whether anything changed.
    pub fn any(self) -> bool {
        self != Self::default()
    }

    /// Adds what another edit made dirty.
    pub fn merge(&mut self, o: Self) {
        self.topology |= o.topology;
        self.points |= o.points;
        self.attributes |= o.attributes;
        self.placement |= o.placement;
        self.binding |= o.binding;
        self.links |= o.links;
    }
}

/// What changed in the scene. Removed prims are listed as dirty too: they are then missing from the
/// store.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dirty {
    /// Meshes, and what of them.
    pub meshes: BTreeMap<MeshId, MeshDirty>,
    /// Any instancer.
    pub instancers: bool,
    /// Categories of any instancer's instances.
    pub instancer_links: bool,
    /// The camera in use, or which one it is.
    pub camera: bool,
    /// Lights.
    pub lights: BTreeSet<LightId>,
    /// Materials.
    pub materials: BTreeSet<MaterialId>,
    /// Purposes that are shown.
    pub purposes: bool,
    /// Settings.
    pub settings: bool,
}

impl Dirty {
    /// Whether anything changed.
    pub fn any(&self) -> bool {
        *self != Self::default()
    }
}
