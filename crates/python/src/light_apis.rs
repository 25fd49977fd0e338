//! ShapingAPI and ShadowAPI of lights, from the dataclasses of `umber.description`.

use pyo3::prelude::*;
use umber_scene::{Shadow, Shaping};

use crate::lights::rgb;

/// `umber.description.Shaping`.
#[derive(FromPyObject)]
pub struct PyShaping {
    focus: f32,
    focus_tint: [f32; 3],
    cone_angle_deg: f32,
    cone_softness: f32,
    ies_file: Option<String>,
    ies_angle_scale: f32,
    ies_normalize: bool,
}

impl PyShaping {
    pub fn convert(&self) -> Shaping {
        Shaping {
            focus: self.focus,
            focus_tint: rgb(self.focus_tint),
            cone_angle_deg: self.cone_angle_deg,
            cone_softness: self.cone_softness,
            ies_file: self.ies_file.as_ref().map(Into::into),
            ies_angle_scale: self.ies_angle_scale,
            ies_normalize: self.ies_normalize,
        }
    }
}

/// `umber.description.Shadow`.
#[derive(FromPyObject)]
pub struct PyShadow {
    color: [f32; 3],
    distance: f32,
    falloff: f32,
    falloff_gamma: f32,
}

impl PyShadow {
    pub fn convert(&self) -> Shadow {
        Shadow {
            color: rgb(self.color),
            distance: self.distance,
            falloff: self.falloff,
            falloff_gamma: self.falloff_gamma,
        }
    }
}
