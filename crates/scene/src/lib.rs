//! What a host says: typed ids, descriptions, edits, and the store that knows what is dirty.
//!
//! Pure data, no rendering. A front end sends [`SceneEdit`]s; [`SceneStore`] keeps what they add up
//! to, and tells `render`'s compile step what changed since it last looked.

mod camera;
mod dirty;
mod edit;
mod ids;
mod instancer;
mod light;
mod material;
mod mesh;
mod shaping;
mod store;

pub use camera::{Camera, ConformPolicy, Projection, ScreenWindow};
pub use dirty::{Dirty, MeshDirty};
pub use edit::SceneEdit;
pub use ids::{CameraId, Category, InstancerId, LightId, MaterialId, MeshId};
pub use instancer::{Instancer, InstancerPatch};
pub use light::{DomeTexture, DomeTextureFormat, Light, LightKind, MaterialSync};
pub use material::{Material, OpacityMode, PreviewSurface};
pub use mesh::{CulledFaces, GeomSubset, Mesh, MeshPatch, Purpose};
pub use shaping::{Shadow, Shaping};
pub use store::SceneStore;
pub use umber_geometry::{Interpolation, Orientation, Primvar, PrimvarValues, SubdivisionScheme, Topology};
