//! From USD topology to triangles: triangulation, normals, primvars; ray-triangle tests; rays that leave triangles.

mod attribute;
mod ear_clipping;
mod ids;
mod normals;
mod problem;
mod surface_point;
mod topology;
mod triangulate;
pub mod watertight;

pub use attribute::{Attribute, AttributeValue};
pub use ids::{ElementId, TriangleIndex};
pub use normals::{geometric_normal, smooth_normals};
pub use problem::MeshProblem;
pub use surface_point::{SurfacePoint, surface_point};
pub use topology::{Interpolation, Orientation, Primvar, PrimvarValues, SubdivisionScheme, Topology};
pub use triangulate::{TriangleMesh, triangulate};
