//! From a described mesh to its shape and attributes.

use std::sync::{Arc, OnceLock};

use umber_bvh::MeshBvh;
use umber_geometry::{
    Attribute, AttributeValue, Interpolation, MeshProblem, Primvar, PrimvarValues, SubdivisionScheme, smooth_normals,
    triangulate,
};
use umber_math::{Point3, Vec2, Vec3};
use umber_scene::Mesh;

use crate::mesh::{MeshAttributes, MeshShape};

/// Primvars that attributes are made of: colour, opacity, texture coordinates.
const READ_PRIMVARS: [&str; 3] = ["displayColor", "displayOpacity", "st"];

/// Triangulates a mesh and builds its hierarchy; where its points alone moved from an older shape, that one's
/// hierarchy is fitted to them as long as it stays good enough. Says what had to be left out.
pub fn compile_shape(mesh: &Mesh, older: Option<&MeshShape>, say: &mut dyn FnMut(String)) -> MeshShape {
    let points: &[Point3] = bytemuck::cast_slice(&mesh.points);
    let (mut triangles, problems) = triangulate(&mesh.topology, points);
    if !needs_corners(mesh) {
        triangles.corners = Vec::new();
    }
    for problem in problems {
        say(problem.to_string());
    }
    let same_faces = |older: &&MeshShape| older.mesh.elements == triangles.elements;
    let fitted = older.filter(same_faces).and_then(|older| older.bvh.refitted(points, &triangles.triangles));
    let bvh = fitted.unwrap_or_else(|| MeshBvh::build(points, &triangles.triangles));
    MeshShape::new(Arc::clone(&mesh.points), triangles, Arc::new(bvh))
}

/// Whether a shape lacks what the mesh's attributes are read by.
pub fn lacks_corners(shape: &MeshShape, mesh: &Mesh) -> bool {
    shape.mesh.corners.len() < shape.mesh.len() && needs_corners(mesh)
}

/// Whether a primvar that is read has values of its own at each corner of a face.
fn needs_corners(mesh: &Mesh) -> bool {
    let named = READ_PRIMVARS.iter().filter_map(|name| mesh.primvars.get(*name));
    let normals = mesh.normals.iter().filter(|_| mesh.topology.scheme == SubdivisionScheme::None);
    named.chain(normals).any(|primvar| primvar.interpolation == Interpolation::FaceVarying)
}

/// Collects normals and primvars. Says which could not be used.
pub fn compile_attributes(mesh: &Mesh, shape: &MeshShape, say: &mut dyn FnMut(String)) -> MeshAttributes {
    let get = |name: &str| mesh.primvars.get(name).map(|primvar| (primvar, name.to_owned()));
    let [color, opacity, st] = READ_PRIMVARS.map(get);
    MeshAttributes {
        normals: normals(mesh, shape, say),
        display_color: color.and_then(|(p, name)| attribute(mesh, p, &name, to_vec3, say)),
        display_opacity: opacity.and_then(|(p, name)| attribute(mesh, p, &name, to_float, say)),
        st: st.and_then(|(p, name)| attribute(mesh, p, &name, to_vec2, say)),
        cluster_normals: OnceLock::new(),
    }
}

/// Authored normals of a polygonal mesh; smooth ones of a subdivision surface, which ignores what is
/// authored (UsdGeomMesh); else none, which is flat.
fn normals(mesh: &Mesh, shape: &MeshShape, say: &mut dyn FnMut(String)) -> Option<Attribute<Vec3>> {
    match mesh.topology.scheme {
        SubdivisionScheme::CatmullClark | SubdivisionScheme::Loop => {
            let normals = smooth_normals(&shape.mesh, bytemuck::cast_slice(&shape.points));
            let values: Vec<Vec3> = bytemuck::allocation::cast_vec(normals);
            let count = values.len();
            Attribute::new(values, Interpolation::Vertex, 0, count, 0).ok()
        }
        SubdivisionScheme::Bilinear => None,
        SubdivisionScheme::None => {
            let primvar = mesh.normals.as_ref()?;
            attribute(mesh, primvar, "normals", to_vec3, say)
        }
    }
}

fn attribute<T: AttributeValue>(
    mesh: &Mesh,
    primvar: &Primvar,
    name: &str,
    convert: fn(&PrimvarValues) -> Option<Arc<[T]>>,
    say: &mut dyn FnMut(String),
) -> Option<Attribute<T>> {
    let Some(values) = convert(&primvar.values) else {
        say(format!("primvar '{name}' ignored: its values have the wrong type"));
        return None;
    };
    if values.is_empty() {
        return None;
    }
    let topology = &mesh.topology;
    let faces = topology.face_vertex_counts.len();
    let corners = topology.face_vertex_indices.len();
    Attribute::new(values, primvar.interpolation, faces, mesh.points.len(), corners)
        .map_err(|problem: MeshProblem| say(format!("primvar '{name}' ignored: {problem}")))
        .ok()
}

fn to_vec3(values: &PrimvarValues) -> Option<Arc<[Vec3]>> {
    match values {
        PrimvarValues::Float3(v) => Some(Arc::clone(v)),
        PrimvarValues::Float4(v) => Some(v.iter().map(|v| v.truncate()).collect()),
        _ => None,
    }
}

fn to_vec2(values: &PrimvarValues) -> Option<Arc<[Vec2]>> {
    match values {
        PrimvarValues::Float2(v) => Some(Arc::clone(v)),
        PrimvarValues::Float3(v) => Some(v.iter().map(|v| v.truncate()).collect()),
        _ => None,
    }
}

fn to_float(values: &PrimvarValues) -> Option<Arc<[f32]>> {
    match values {
        PrimvarValues::Float(v) => Some(Arc::clone(v)),
        _ => None,
    }
}
