//! UsdLux's applied schemas for a light's emission by direction (ShapingAPI) and its shadows (ShadowAPI).

use std::path::PathBuf;

use umber_math::Rgb;

/// What a light's emission is multiplied by, by direction. The default is a light without the schema.
#[derive(Clone, Debug, PartialEq)]
pub struct Shaping {
    /// `inputs:shaping:focus`.
    pub focus: f32,
    /// `inputs:shaping:focusTint`, scene-linear.
    pub focus_tint: Rgb,
    /// `inputs:shaping:cone:angle`, degrees off the axis. The schema's own fallback is 90.
    pub cone_angle_deg: f32,
    /// `inputs:shaping:cone:softness`.
    pub cone_softness: f32,
    /// `inputs:shaping:ies:file`, as the asset resolver found it.
    pub ies_file: Option<PathBuf>,
    /// `inputs:shaping:ies:angleScale`.
    pub ies_angle_scale: f32,
    /// `inputs:shaping:ies:normalize`.
    pub ies_normalize: bool,
}

impl Default for Shaping {
    fn default() -> Self {
        Self {
            focus: 0.0,
            focus_tint: Rgb::BLACK,
            cone_angle_deg: 180.0,
            cone_softness: 0.0,
            ies_file: None,
            ies_angle_scale: 0.0,
            ies_normalize: false,
        }
    }
}

/// What a light's shadows are like, where it casts any. The default is the schema's.
#[derive(Clone, Debug, PartialEq)]
pub struct Shadow {
    /// `inputs:shadow:color`, scene-linear.
    pub color: Rgb,
    /// `inputs:shadow:distance`, world units; negative for no limit.
    pub distance: f32,
    /// `inputs:shadow:falloff`, world units.
    pub falloff: f32,
    /// `inputs:shadow:falloffGamma`.
    pub falloff_gamma: f32,
}

impl Default for Shadow {
    fn default() -> Self {
        Self { color: Rgb::BLACK, distance: -1.0, falloff: -1.0, falloff_gamma: 1.0 }
    }
}
