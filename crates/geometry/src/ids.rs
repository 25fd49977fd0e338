//! Indices into a mesh, as types that never interchange.

/// A face of the mesh as the host authored it: what Hydra calls an element.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ElementId(pub u32);

/// A triangle of the triangulated mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct TriangleIndex(pub u32);
