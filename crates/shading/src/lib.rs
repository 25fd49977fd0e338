//! Textures, BSDF lobes, materials and lights.
//!
//! A [`Material`] makes a [`Bsdf`] at a surface point; the integrator asks it for values, densities and
//! samples. A [`Light`] is sampled from a point, and met by rays; a [`LightSampler`] chooses among many.
//! Directions are unit, in render space, and point away from the surface: `wo` to the viewer, `wi` to the light.

mod bsdf;
mod environment;
mod ies;
mod image_file;
mod lights;
mod material;
mod preview_surface;
mod texels;

pub use bsdf::{Bsdf, BsdfEval, BsdfSample, DELTA_ALPHA, LobeKind, Lobes};
pub use environment::{EnvironmentMap, TextureFormat};
pub use ies::{IesError, IesProfile};
pub use image_file::{ImageError, LinearImage};
pub use lights::{
    CylinderLight, DiskLight, DistantLight, DomeLight, EmitterMesh, EmitterTriangle, IesParams, Light, LightHit,
    LightKind, LightParams, LightProblem, LightSample, LightSampler, LightTexture, MeshLight, Portal, Receiver,
    RectLight, ShadowParams, ShadowShape, ShapingParams, SphereLight,
};
pub use material::Material;
pub use preview_surface::{OpacityMode, PreviewSurface};
