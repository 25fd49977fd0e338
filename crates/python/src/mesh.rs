//! Meshes and instancers, from the dataclasses of `umber.description`.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use glam::{Vec2, Vec3, Vec4};
use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;
use umber_scene::{
    Category, GeomSubset, InstancerId, InstancerPatch, Interpolation, MaterialId, MeshId, MeshPatch, Orientation,
    Primvar, PrimvarValues, Purpose, SceneEdit, SubdivisionScheme, Topology,
};

use crate::arrays::{Doubles, Floats, Ints, bad_value, ints, scalars, transform, transforms, vectors};

/// `umber.description.Primvar`.
#[derive(FromPyObject)]
pub struct PyPrimvar<'py> {
    values: Floats<'py>,
    interpolation: String,
}

/// `umber.description.Subset`.
#[derive(FromPyObject)]
pub struct PySubset<'py> {
    material: Option<String>,
    faces: Ints<'py>,
}

/// `umber.description.Mesh`.
#[derive(FromPyObject)]
pub struct PyMesh<'py> {
    path: String,
    points: Floats<'py>,
    face_vertex_counts: Ints<'py>,
    face_vertex_indices: Ints<'py>,
    hole_indices: Ints<'py>,
    subdivision_scheme: String,
    orientation: String,
    normals: Option<PyPrimvar<'py>>,
    primvars: HashMap<String, PyPrimvar<'py>>,
    subsets: Vec<PySubset<'py>>,
    transform: Doubles<'py>,
    purpose: String,
    double_sided: bool,
    material: Option<String>,
    instancer: Option<String>,
    instance_indices: Ints<'py>,
    prim_id: i32,
    categories: Vec<String>,
}

/// `umber.description.Instancer`.
#[derive(FromPyObject)]
pub struct PyInstancer<'py> {
    path: String,
    parent: Option<String>,
    parent_indices: Ints<'py>,
    transforms: Doubles<'py>,
    categories: Vec<Vec<String>>,
}

fn categories(names: &[String]) -> Arc<[Category]> {
    names.iter().map(|name| Category::new(name)).collect()
}

impl PyPrimvar<'_> {
    fn convert(&self, what: &str) -> PyResult<Primvar> {
        let interpolation = match self.interpolation.as_str() {
            "constant" => Interpolation::Constant,
            "uniform" => Interpolation::Uniform,
            "varying" => Interpolation::Varying,
            "vertex" => Interpolation::Vertex,
            "faceVarying" => Interpolation::FaceVarying,
            other => return Err(bad_value(format!("{what}: unknown interpolation '{other}'"))),
        };
        let values = match self.values.shape() {
            [_] => PrimvarValues::Float(scalars(&self.values, what)?),
            [_, 2] => PrimvarValues::Float2(vectors::<Vec2>(&self.values, what)?),
            [_, 3] => PrimvarValues::Float3(vectors::<Vec3>(&self.values, what)?),
            [_, 4] => PrimvarValues::Float4(vectors::<Vec4>(&self.values, what)?),
            shape => return Err(bad_value(format!("{what} must have shape (n,) or (n, 2 to 4), not {shape:?}"))),
        };
        Ok(Primvar { interpolation, values })
    }
}

impl PySubset<'_> {
    fn convert(&self) -> PyResult<GeomSubset> {
        let material = self.material.as_deref().map(MaterialId::new);
        Ok(GeomSubset { material, faces: ints(&self.faces, "faces of a subset")? })
    }
}

/// A purpose by its token.
pub fn purpose(name: &str) -> PyResult<Purpose> {
    match name {
        "default" => Ok(Purpose::Default),
        "render" => Ok(Purpose::Render),
        "proxy" => Ok(Purpose::Proxy),
        "guide" => Ok(Purpose::Guide),
        other => Err(bad_value(format!("unknown purpose '{other}'"))),
    }
}

impl PyMesh<'_> {
    fn topology(&self) -> PyResult<Topology> {
        let scheme = match self.subdivision_scheme.as_str() {
            "none" => SubdivisionScheme::None,
            "catmullClark" => SubdivisionScheme::CatmullClark,
            "loop" => SubdivisionScheme::Loop,
            "bilinear" => SubdivisionScheme::Bilinear,
            other => return Err(bad_value(format!("unknown subdivision scheme '{other}'"))),
        };
        let orientation = match self.orientation.as_str() {
            "rightHanded" => Orientation::RightHanded,
            "leftHanded" => Orientation::LeftHanded,
            other => return Err(bad_value(format!("unknown orientation '{other}'"))),
        };
        Ok(Topology {
            scheme,
            orientation,
            face_vertex_counts: ints(&self.face_vertex_counts, "face_vertex_counts")?,
            face_vertex_indices: ints(&self.face_vertex_indices, "face_vertex_indices")?,
            hole_indices: ints(&self.hole_indices, "hole_indices")?,
        })
    }

    /// The edit that inserts or replaces the mesh.
    pub fn edit(&self) -> PyResult<SceneEdit> {
        let primvars: BTreeMap<Arc<str>, Option<Primvar>> = self
            .primvars
            .iter()
            .map(|(name, primvar)| Ok((name.as_str().into(), Some(primvar.convert(name)?))))
            .collect::<PyResult<_>>()?;
        let patch = MeshPatch {
            topology: Some(Arc::new(self.topology()?)),
            points: Some(vectors(&self.points, "points")?),
            normals: Some(self.normals.as_ref().map(|n| n.convert("normals")).transpose()?),
            primvars,
            subsets: Some(self.subsets.iter().map(PySubset::convert).collect::<PyResult<_>>()?),
            transform: Some(transform(&self.transform, "transform")?),
            visible: Some(true),
            purpose: Some(purpose(&self.purpose)?),
            double_sided: Some(self.double_sided),
            culled_faces: None,
            material: Some(self.material.as_deref().map(MaterialId::new)),
            instancer: Some(self.instancer.as_deref().map(InstancerId::new)),
            instance_indices: Some(ints(&self.instance_indices, "instance_indices")?),
            prim_id: Some(self.prim_id),
            categories: Some(categories(&self.categories)),
        };
        Ok(SceneEdit::Mesh(MeshId::new(&self.path), Box::new(patch)))
    }
}

impl PyInstancer<'_> {
    /// The edit that inserts or replaces the instancer.
    pub fn edit(&self) -> PyResult<SceneEdit> {
        let patch = InstancerPatch {
            parent: Some(self.parent.as_deref().map(InstancerId::new)),
            parent_indices: Some(ints(&self.parent_indices, "parent_indices")?),
            transforms: Some(transforms(&self.transforms, "transforms")?),
            visible: Some(true),
            categories: Some(self.categories.iter().map(|names| categories(names)).collect()),
        };
        Ok(SceneEdit::Instancer(InstancerId::new(&self.path), patch))
    }
}
