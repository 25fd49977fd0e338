//! Textures, BSDF lobes, materials and lights.
//!
//! A [`Material`] makes a [`Bsdf`] at a surface point; the integrator asks it for values, densities and
//! samples. A [`Light`] is sampled from a point, and met by rays; a [`LightSampler`] chooses among many.
//! Directions are unit, in render space, and point away from the surface: `wo` to the viewer, `wi` to the light.

mod bsdf;
mod environment;
mod image_file;
mod lights;
mod material;
mod preview_surface;

pub use bsdf::{Bsdf, BsdfEval, BsdfSample, DELTA_ALPHA, LobeKind, Lobes};
pub use environment::EnvironmentMap;
pub use image_file::{ImageError, LinearImage};
pub use lights::{
    DistantLight, DomeLight, EmitterMesh, EmitterTriangle, Light, LightHit, LightKind, LightParams, LightProblem,
    LightSample, LightSampler, MeshLight, Receiver, RectLight, SphereLight,
};
pub use material::Material;
pub use preview_surface::{OpacityMode, PreviewSurface};
