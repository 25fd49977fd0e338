//! Lights, by UsdLux.

use std::path::PathBuf;
use std::sync::Arc;

use umber_math::{DAffine3, Rgb};

use crate::{Category, LightId, MeshId, Shadow, Shaping};

/// A dome light's picture (`inputs:texture:file`).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DomeTexture {
    /// The file, as the asset resolver found it.
    pub file: PathBuf,
    /// How it shows the directions.
    pub format: DomeTextureFormat,
}

/// How a dome light's picture shows the directions (`inputs:texture:format`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum DomeTextureFormat {
    /// As the file itself tells.
    #[default]
    Automatic,
    /// Longitude to the right, latitude up.
    LatLong,
    /// A photo of a mirror ball.
    MirroredBall,
    /// As a mirror ball, but the distance from the middle is in proportion to the angle.
    Angular,
    /// A cube unfolded to an upright cross.
    CubeMapVerticalCross,
}

impl DomeTextureFormat {
    /// UsdLux's token; `None` for another word.
    pub fn from_token(token: &str) -> Option<Self> {
        Some(match token {
            "automatic" => Self::Automatic,
            "latlong" => Self::LatLong,
            "mirroredBall" => Self::MirroredBall,
            "angular" => Self::Angular,
            "cubeMapVerticalCross" => Self::CubeMapVerticalCross,
            _ => return None,
        })
    }
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
    /// A disk around the origin, on the XY plane.
    Disk {
        /// Radius, light-space units.
        radius: f32,
    },
    /// A cylinder around the origin, along X; its ends are dark.
    Cylinder {
        /// Extent along X, light-space units.
        length: f32,
        /// Radius, light-space units.
        radius: f32,
        /// Shine as a line of the same power, without shape.
        treat_as_line: bool,
    },
    /// An opening on the XY plane around the origin, through which a dome shines along -Z. It does not shine itself:
    /// domes that name it in [`Light::portals`] are sampled through it.
    Portal {
        /// Extent along X, light-space units.
        width: f32,
        /// Extent along Y, light-space units.
        height: f32,
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
    /// `inputs:texture:file` of a rect light, as the asset resolver found it. A dome light has its own in its shape.
    pub texture_file: Option<PathBuf>,
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
    /// ShapingAPI: what the emission is multiplied by, by direction.
    pub shaping: Shaping,
    /// ShadowAPI, but for `inputs:shadow:enable`.
    pub shadow: Shadow,
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
            texture_file: None,
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
            shaping: Shaping::default(),
            shadow: Shadow::default(),
            portals: Arc::default(),
            light_link: None,
            shadow_link: None,
        }
    }
}
