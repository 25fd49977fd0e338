//! Bounding volume hierarchies: built by the surface area heuristic, made better by obvhs, laid out wide, traversed with
//! instances.
//!
//! A [`MeshBvh`] holds the triangles of one mesh, an [`InstanceBvh`] places meshes and other groups
//! by transforms, to [`MAX_DEPTH`] levels; a [`BoundsBvh`] finds other primitives by their boxes.
//!
//! Hits are those of [`umber_geometry::watertight`], bit for bit, whatever the processor: the
//! vectorised tests do the same operations in the same order. Among hits at the same `t` the one
//! with the smallest instance path, then triangle index, counts, so that the answer does not depend
//! on the order of traversal.

mod bounds_bvh;
mod build;
mod cover;
mod instance;
mod mesh;
mod path;
mod prefetch;
mod ray;
mod search;
mod simd;
mod wide;

pub use bounds_bvh::BoundsBvh;
pub use instance::{Child, Instance, InstanceBvh, Placement};
pub use mesh::MeshBvh;
pub use path::{InstancePath, MAX_DEPTH};
pub use prefetch::prefetch;
pub use search::Hit;
pub use simd::SimdLevel;
