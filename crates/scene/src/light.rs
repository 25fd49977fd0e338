//! Lights, by UsdLux.

use std::path::PathBuf;

use umber_math::{DAffine3, Rgb};

use crate::MeshId;

/// A dome light's picture, latitude-longitude (`inputs:texture:file`).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DomeTexture {
    /// The file, as the asset resolver found it.
    pub file: PathBuf,
}

/// `light:materialSyncMode`: how the material of a mesh and the light that shines from it go together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MaterialSync {
    /// The material's glow is seen; it lights things multiplied by the light's colour and brightness.
    #[default]
    GlowTintsLight,
    /// The material's glow is seen; what lights things is the light's alone.
    Independent,
    /// As if there were no material: a black surface that shines.
    NoResponse,
}

/// The shape of a light, in light space: it shines along -Z where it has a direction.
#[derive(Clone, Debug, PartialEq)]
pub enum LightKind {
    /// A far disk.
    Distant {
        /// Full angle of the disk, degrees.
        angle_deg: f32,
    },
    /// Everything around.
    Dome {
        /// Picture, multiplied with the light's colour.
        texture: Option<DomeTexture>,
    },
    /// A rectangle around the origin, on the XY plane.
    Rect {
        /// Extent along X, light-space units.
        width: f32,
        /// Extent along Y, light-space units.
        height: f32,
    },
    /// A sphere around the origin.
    Sphere {
        /// Radius, light-space units.
        radius: f32,
        /// Shine as a point of the same power, without shape.
        treat_as_point: bool,
    },
    /// A mesh, wherever it is shown; the light's own transform is of no account.
    Mesh {
        /// Which.
        mesh: MeshId,
        /// What its material has to do with it.
        material_sync: MaterialSync,
    },
}

/// A light. Radiance is `color · intensity · 2^exposure`, over the area where `normalize` is set.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Shape.
    pub kind: LightKind,
    /// World from light.
    pub world_from_light: DAffine3,
    /// `inputs:color`, scene-linear.
    pub color: Rgb,
    /// `inputs:intensity`.
    pub intensity: f32,
    /// `inputs:exposure`, stops.
    pub exposure: f32,
    /// `inputs:normalize`.
    pub normalize: bool,
    /// `inputs:colorTemperature` in kelvin, where `inputs:enableColorTemperature` is set.
    pub color_temperature: Option<f32>,
    /// `inputs:diffuse`: multiplies what diffuse lobes receive.
    pub diffuse: f32,
    /// `inputs:specular`: multiplies what specular lobes receive.
    pub specular: f32,
    /// `inputs:shadow:enable`.
    pub shadow_enable: bool,
    /// Whether the camera sees the shape itself.
    pub camera_visible: bool,
    /// Whether it shines at all.
    pub visible: bool,
}

impl Light {
    /// A light of this shape with UsdLux's fallbacks.
    pub fn new(kind: LightKind) -> Self {
        Self {
            kind,
            world_from_light: DAffine3::IDENTITY,
            color: Rgb::WHITE,
            intensity: 1.0,
            exposure: 0.0,
            normalize: false,
            color_temperature: None,
            diffuse: 1.0,
            specular: 1.0,
            shadow_enable: true,
            camera_visible: true,
            visible: true,
        }
    }
}
