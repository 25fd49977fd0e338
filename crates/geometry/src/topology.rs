//! What UsdGeomMesh says of a mesh: faces, orientation, subdivision scheme, primvars.

use std::sync::Arc;

use glam::{Vec2, Vec3, Vec4};

/// Winding of the faces as seen from outside (`UsdGeomGprim.orientation`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Orientation {
    /// Counter-clockwise.
    #[default]
    RightHanded,
    /// Clockwise.
    LeftHanded,
}

/// `UsdGeomMesh.subdivisionScheme`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SubdivisionScheme {
    /// A polygonal mesh: normals as authored, else one a face.
    #[default]
    None,
    /// Catmull-Clark.
    CatmullClark,
    /// Loop.
    Loop,
    /// Bilinear: flat faces, refined.
    Bilinear,
}

/// Faces of a mesh. Nothing here is checked: triangulation reports what does not hold.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Topology {
    /// Subdivision scheme.
    pub scheme: SubdivisionScheme,
    /// Winding.
    pub orientation: Orientation,
    /// Number of corners of each face.
    pub face_vertex_counts: Arc<[i32]>,
    /// Point index of each corner, face after face.
    pub face_vertex_indices: Arc<[i32]>,
    /// Faces that are holes.
    pub hole_indices: Arc<[i32]>,
}

/// How primvar values spread over a mesh (UsdGeomPrimvar).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// One value for all.
    Constant,
    /// One value a face.
    Uniform,
    /// One value a point, linear in between.
    Varying,
    /// One value a point, by the subdivision basis in between (linear for polygons).
    Vertex,
    /// One value a corner.
    FaceVarying,
}

/// Values of a primvar, already expanded from their indices.
#[derive(Clone, Debug, PartialEq)]
pub enum PrimvarValues {
    /// Scalars.
    Float(Arc<[f32]>),
    /// Pairs (texture coordinates).
    Float2(Arc<[Vec2]>),
    /// Triples (colours, points, normals).
    Float3(Arc<[Vec3]>),
    /// Quadruples.
    Float4(Arc<[Vec4]>),
}

impl PrimvarValues {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::Float(v) => v.len(),
            Self::Float2(v) => v.len(),
            Self::Float3(v) => v.len(),
            Self::Float4(v) => v.len(),
        }
    }
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A primvar: values and how they spread.
#[derive(Clone, Debug, PartialEq)]
pub struct Primvar {
    /// How the values spread.
    pub interpolation: Interpolation,
    /// The values.
    pub values: PrimvarValues,
}
