//! Meshes: what is said of one, and what it then is.

use std::collections::BTreeMap;
use std::sync::Arc;

use umber_geometry::{Primvar, Topology};
use umber_math::{DAffine3, Vec3};

use crate::dirty::MeshDirty;
use crate::{Category, InstancerId, MaterialId};

/// `UsdGeomImageable.purpose`, Hydra's render tag.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Purpose {
    /// Always shown.
    #[default]
    Default,
    /// Final quality.
    Render,
    /// Stand-in for interactive work.
    Proxy,
    /// Helpers.
    Guide,
}

/// Faces that the camera looks through, by Hydra's cull style and `doubleSided` together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CulledFaces {
    /// None: both sides are seen.
    #[default]
    None,
    /// Those turned away.
    Back,
    /// Those turned to the camera.
    Front,
}

/// Faces with a material of their own (UsdGeomSubset of family materialBind).
#[derive(Clone, Debug, PartialEq)]
pub struct GeomSubset {
    /// Material of these faces; `None` takes the mesh's.
    pub material: Option<MaterialId>,
    /// Face indices.
    pub faces: Arc<[i32]>,
}

/// A mesh as the host has described it so far.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// Faces.
    pub topology: Arc<Topology>,
    /// Points, object space.
    pub points: Arc<[Vec3]>,
    /// `normals` or `primvars:normals`, object space, with their interpolation.
    pub normals: Option<Primvar>,
    /// Other primvars by name (`displayColor`, `displayOpacity`, `st`).
    pub primvars: BTreeMap<Arc<str>, Primvar>,
    /// Subsets with a material of their own; a later one wins where they overlap.
    pub subsets: Arc<[GeomSubset]>,
    /// World from object; for an instanced mesh, instancer from object.
    pub transform: DAffine3,
    /// Whether it is shown at all.
    pub visible: bool,
    /// Purpose.
    pub purpose: Purpose,
    /// `UsdGeomGprim.doubleSided`.
    pub double_sided: bool,
    /// Faces that the camera looks through.
    pub culled_faces: CulledFaces,
    /// Bound material.
    pub material: Option<MaterialId>,
    /// Innermost instancer, where it is instanced.
    pub instancer: Option<InstancerId>,
    /// Which of that instancer's instances show this mesh; the position in this list is the
    /// instance's number within it.
    pub instance_indices: Arc<[i32]>,
    /// Value of the `primId` AOV.
    pub prim_id: i32,
    /// Categories that it belongs to; what an instancer shows has the instance's instead.
    pub categories: Arc<[Category]>,
}

impl Default for Mesh {
    fn default() -> Self {
        Self {
            topology: Arc::default(),
            points: Arc::default(),
            normals: None,
            primvars: BTreeMap::new(),
            subsets: Arc::default(),
            transform: DAffine3::IDENTITY,
            visible: true,
            purpose: Purpose::Default,
            double_sided: false,
            culled_faces: CulledFaces::None,
            material: None,
            instancer: None,
            instance_indices: Arc::default(),
            prim_id: -1,
            categories: Arc::default(),
        }
    }
}

/// What an edit says of a mesh: fields that are `None` stay as they are.
#[derive(Clone, Debug, Default)]
pub struct MeshPatch {
    /// See [`Mesh::topology`].
    pub topology: Option<Arc<Topology>>,
    /// See [`Mesh::points`].
    pub points: Option<Arc<[Vec3]>>,
    /// See [`Mesh::normals`]; `Some(None)` takes authored normals away.
    pub normals: Option<Option<Primvar>>,
    /// Primvars to set, or (`None`) to take away.
    pub primvars: BTreeMap<Arc<str>, Option<Primvar>>,
    /// See [`Mesh::subsets`].
    pub subsets: Option<Arc<[GeomSubset]>>,
    /// See [`Mesh::transform`].
    pub transform: Option<DAffine3>,
    /// See [`Mesh::visible`].
    pub visible: Option<bool>,
    /// See [`Mesh::purpose`].
    pub purpose: Option<Purpose>,
    /// See [`Mesh::double_sided`].
    pub double_sided: Option<bool>,
    /// See [`Mesh::culled_faces`].
    pub culled_faces: Option<CulledFaces>,
    /// See [`Mesh::material`].
    pub material: Option<Option<MaterialId>>,
    /// See [`Mesh::instancer`].
    pub instancer: Option<Option<InstancerId>>,
    /// See [`Mesh::instance_indices`].
    pub instance_indices: Option<Arc<[i32]>>,
    /// See [`Mesh::prim_id`].
    pub prim_id: Option<i32>,
    /// See [`Mesh::categories`].
    pub categories: Option<Arc<[Category]>>,
}

/// Assigns a value that was said; true where it is another one.
pub(crate) fn assign<T: PartialEq>(field: &mut T, said: Option<T>) -> bool {
    match said {
        Some(value) if *field != value => {
            *field = value;
            true
        }
        _ => false,
    }
}

impl Mesh {
    /// Takes over what the patch says and tells what that made dirty. A value equal to the old one
    /// makes nothing dirty.
    pub fn apply(&mut self, patch: MeshPatch) -> MeshDirty {
        let mut dirty = MeshDirty::default();
        dirty.topology |= assign(&mut self.topology, patch.topology);
        dirty.points |= assign(&mut self.points, patch.points);
        dirty.attributes |= assign(&mut self.normals, patch.normals);
        for (name, said) in patch.primvars {
            dirty.attributes |= match said {
                Some(primvar) if self.primvars.get(&name) != Some(&primvar) => {
                    self.primvars.insert(name, primvar);
                    true
                }
                Some(_) => false,
                None => self.primvars.remove(&name).is_some(),
            };
        }
        dirty.placement |= assign(&mut self.transform, patch.transform);
        dirty.placement |= assign(&mut self.visible, patch.visible);
        dirty.placement |= assign(&mut self.purpose, patch.purpose);
        dirty.placement |= assign(&mut self.instancer, patch.instancer);
        dirty.placement |= assign(&mut self.instance_indices, patch.instance_indices);
        dirty.binding |= assign(&mut self.subsets, patch.subsets);
        dirty.binding |= assign(&mut self.double_sided, patch.double_sided);
        dirty.binding |= assign(&mut self.culled_faces, patch.culled_faces);
        dirty.binding |= assign(&mut self.material, patch.material);
        dirty.binding |= assign(&mut self.prim_id, patch.prim_id);
        dirty.links |= assign(&mut self.categories, patch.categories);
        dirty
    }
}
