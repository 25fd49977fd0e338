//! Lights, by UsdLux.

use std::path::PathBuf;
use std::sync::Arc;

use umber_math::{DAffine3, Rgb};

use crate::{Category, LightId};

/// A dome light's picture, latitude-longitude (`inputs:texture:file`).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DomeTexture {
    /// The file, as the asset resolver found it.
    pub file: PathBuf,
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
    /// An opening on the XY plane around the origin, through which a dome shines along -Z. It does not shine itself:
    /// domes that name it in [`Light::portals`] are sampled through it.
    Portal {
        /// Extent along X, light-space units.
        width: f32,
        /// Extent along Y, light-space units.
        height: f32,
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
    /// Openings through which most of a dome's light comes in. They guide sampling, and change no picture.
    pub portals: Arc<[LightId]>,
    /// Category of what it illuminates; all where there is none.
    pub light_link: Option<Category>,
    /// Category of what casts shadows in its light; all where there is none.
    pub shadow_link: Option<Category>,
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
            portals: Arc::default(),
            light_link: None,
            shadow_link: None,
        }
    }
}
