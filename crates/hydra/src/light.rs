//! Lights.

use std::sync::Arc;

use umber_math::Rgb;
use umber_render::Message;
use umber_scene::{DomeTexture, LightId, LightKind, MaterialSync, MeshId, SceneEdit};

use crate::bridge::ffi;
use crate::convert::affine;
use crate::delegate::Delegate;
use crate::guard::{Outcome, guard, guard_refusal};
use crate::host::Host;

/// Parameters that [`Light::set_numbers`] and [`Light::set_text`] know.
const PARAMETERS: [&str; 17] = [
    "color",
    "intensity",
    "exposure",
    "normalize",
    "enableColorTemperature",
    "colorTemperature",
    "diffuse",
    "specular",
    "shadow:enable",
    "angle",
    "width",
    "height",
    "radius",
    "treatAsPoint",
    "texture:file",
    "texture:format",
    "materialSyncMode",
];

/// UsdLux' fallback of `inputs:colorTemperature`.
const DAYLIGHT_KELVIN: f32 = 6500.0;

/// One `HdLight`.
pub struct Light {
    host: Arc<Host>,
    id: LightId,
    fallback: LightKind,
    light: umber_scene::Light,
    kelvin: f32,
    by_temperature: bool,
}

pub fn light_parameters() -> Outcome<Vec<String>> {
    guard(|| PARAMETERS.map(str::to_owned).to_vec())
}

/// The shape with UsdLux' fallbacks.
fn kind(light_type: ffi::LightType, path: &str) -> LightKind {
    match light_type {
        ffi::LightType::Distant => LightKind::Distant { angle_deg: 0.53 },
        ffi::LightType::Dome => LightKind::Dome { texture: None },
        ffi::LightType::Rect => LightKind::Rect { width: 1.0, height: 1.0 },
        ffi::LightType::Mesh => {
            LightKind::Mesh { mesh: MeshId::new(path), material_sync: MaterialSync::GlowTintsLight }
        }
        _ => LightKind::Sphere { radius: 0.5, treat_as_point: false },
    }
}

pub fn new_light(delegate: &Delegate, path: &str, light_type: ffi::LightType) -> Outcome<Box<Light>> {
    guard(|| {
        let fallback = kind(light_type, path);
        Box::new(Light {
            host: delegate.host(),
            id: LightId::new(path),
            light: umber_scene::Light::new(fallback.clone()),
            fallback,
            kelvin: DAYLIGHT_KELVIN,
            by_temperature: false,
        })
    })
}

impl Light {
    pub fn set_transform(&mut self, matrix: &[f64; 16]) -> Outcome {
        guard(|| self.light.world_from_light = affine(matrix))
    }

    pub fn set_visible(&mut self, visible: bool) -> Outcome {
        guard(|| self.light.visible = visible)
    }

    pub fn reset_parameters(&mut self) -> Outcome {
        guard(|| {
            let (world_from_light, visible) = (self.light.world_from_light, self.light.visible);
            let fresh = umber_scene::Light::new(self.fallback.clone());
            self.light = umber_scene::Light { world_from_light, visible, ..fresh };
            self.kelvin = DAYLIGHT_KELVIN;
            self.by_temperature = false;
        })
    }

    pub fn set_numbers(&mut self, parameter: &str, numbers: &[f32]) -> Outcome {
        guard(|| {
            let Some(&number) = numbers.first() else { return };
            let light = &mut self.light;
            match parameter {
                "color" => {
                    if let &[r, g, b] = numbers {
                        light.color = Rgb::new(r, g, b);
                    }
                }
                "intensity" => light.intensity = number,
                "exposure" => light.exposure = number,
                "normalize" => light.normalize = number != 0.0,
                "enableColorTemperature" => self.by_temperature = number != 0.0,
                "colorTemperature" => self.kelvin = number,
                "diffuse" => light.diffuse = number,
                "specular" => light.specular = number,
                "shadow:enable" => light.shadow_enable = number != 0.0,
                _ => shape(&mut light.kind, parameter, number),
            }
            light.color_temperature = self.by_temperature.then_some(self.kelvin);
        })
    }

    pub fn set_text(&mut self, parameter: &str, text: &str) -> Outcome {
        guard(|| match (parameter, &mut self.light.kind) {
            ("texture:file", LightKind::Dome { texture }) => {
                *texture = (!text.is_empty()).then(|| DomeTexture { file: text.into() });
            }
            ("texture:format", LightKind::Dome { .. }) if !matches!(text, "" | "automatic" | "latlong") => {
                let text = format!("texture format '{text}' is not supported: the texture is read as latlong");
                self.host.say(Message::warning(Some(self.id.path()), text));
            }
            ("materialSyncMode", LightKind::Mesh { material_sync, .. }) => match material_sync_of(text) {
                Some(mode) => *material_sync = mode,
                None => {
                    let text = format!("materialSyncMode '{text}' is not known: it is left out");
                    self.host.say(Message::warning(Some(self.id.path()), text));
                }
            },
            _ => {}
        })
    }

    pub fn commit(&self) -> Outcome {
        guard_refusal(|| self.host.edit(SceneEdit::Light(self.id.clone(), self.light.clone())))
    }

    pub fn remove(&self) -> Outcome {
        guard_refusal(|| self.host.edit(SceneEdit::RemoveLight(self.id.clone())))
    }
}

/// `light:materialSyncMode` by its token.
fn material_sync_of(text: &str) -> Option<MaterialSync> {
    match text {
        "materialGlowTintsLight" => Some(MaterialSync::GlowTintsLight),
        "independent" => Some(MaterialSync::Independent),
        "noMaterialResponse" => Some(MaterialSync::NoResponse),
        _ => None,
    }
}

fn shape(kind: &mut LightKind, parameter: &str, number: f32) {
    match (kind, parameter) {
        (LightKind::Distant { angle_deg }, "angle") => *angle_deg = number,
        (LightKind::Rect { width, .. }, "width") => *width = number,
        (LightKind::Rect { height, .. }, "height") => *height = number,
        (LightKind::Sphere { radius, .. }, "radius") => *radius = number,
        (LightKind::Sphere { treat_as_point, .. }, "treatAsPoint") => *treat_as_point = number != 0.0,
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delegate::new_delegate;

    #[test]
    fn a_mesh_light_shines_from_the_mesh_at_its_path() {
        let delegate = new_delegate().unwrap();
        let mut light = new_light(&delegate, "/m", ffi::LightType::Mesh).unwrap();
        light.set_text("materialSyncMode", "independent").unwrap();
        let of = |material_sync| LightKind::Mesh { mesh: MeshId::new("/m"), material_sync };
        assert_eq!(light.light.kind, of(MaterialSync::Independent));
        light.set_text("materialSyncMode", "sometimes").unwrap();
        assert_eq!(light.light.kind, of(MaterialSync::Independent));
        light.reset_parameters().unwrap();
        assert_eq!(light.light.kind, of(MaterialSync::GlowTintsLight));
    }

    #[test]
    fn parameters_reach_their_fields() {
        let delegate = new_delegate().unwrap();
        let mut light = new_light(&delegate, "/l", ffi::LightType::Rect).unwrap();
        light.set_numbers("width", &[3.0]).unwrap();
        light.set_numbers("radius", &[9.0]).unwrap();
        light.set_numbers("color", &[1.0, 0.5, 0.25]).unwrap();
        light.set_numbers("enableColorTemperature", &[1.0]).unwrap();
        assert_eq!(light.light.kind, LightKind::Rect { width: 3.0, height: 1.0 });
        assert_eq!(light.light.color_temperature, Some(DAYLIGHT_KELVIN));
        light.set_visible(false).unwrap();
        light.reset_parameters().unwrap();
        assert_eq!(light.light.kind, light.fallback);
        assert!(!light.light.visible && light.light.color_temperature.is_none());
    }
}
