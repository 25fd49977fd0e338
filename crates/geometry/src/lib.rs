//! From USD topology to triangles: triangulation, normals, primvars; ray-triangle tests.

mod topology;

pub use topology::{Interpolation, Orientation, Primvar, PrimvarValues, SubdivisionScheme, Topology};
