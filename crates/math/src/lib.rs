//! Points, vectors, normals, transforms, frames, bounds, rays, floating-point error; colour.
//!
//! Everything here is plain data. Spaces are named by the variables that hold the values
//! (`point_world`, `wi_local`); transforms are target-from-source (`render_from_object`).

pub mod blackbody;
mod bounds;
mod color;
pub mod float;
mod frame;
mod ray;
mod transform;
mod vectors;

pub use bounds::Bounds3;
pub use color::{Rgb, linear_from_srgb, srgb_from_linear};
pub use frame::Frame;
pub use glam::{DAffine3, DMat3, DMat4, DVec2, DVec3, Vec2, Vec3};
pub use ray::Ray;
pub use transform::{Transform, keeps_angles};
pub use vectors::{Normal3, Point3, Vector3};
