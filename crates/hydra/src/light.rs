//! Lights.

use std::sync::Arc;

use umber_math::{DAffine3, Rgb};
use umber_render::Message;
use umber_scene::{Category, DomeTexture, DomeTextureFormat, LightId, LightKind, MaterialSync, MeshId, SceneEdit};

use crate::bridge::ffi;
use crate::convert::affine;
use crate::delegate::Delegate;
use crate::guard::{Outcome, guard, guard_refusal};
use crate::host::Host;
use crate::light_apis;

/// Parameters that [`Light::set_numbers`] and [`Light::set_text`] know.
const PARAMETERS: [&str; 23] = [
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
    "length",
    "treatAsPoint",
    "treatAsLine",
    "texture:file",
    "texture:format",
    "lightLink",
    "shadowLink",
    "portals",
    "materialSyncMode",
    SHADER_ID,
];
const SHADER_ID: &str = "light:shaderId";

/// UsdLux' fallback of `inputs:colorTemperature`.
const DAYLIGHT_KELVIN: f32 = 6500.0;

/// One `HdLight`.
pub struct Light {
    host: Arc<Host>,
    id: LightId,
    fallback: LightKind,
    light: umber_scene::Light,
    world_from_prim: DAffine3,
    /// `domeOffset`, which stands a DomeLight_1 on its `poleAxis`.
    prim_from_dome: DAffine3,
    texture_file: String,
    texture_format: DomeTextureFormat,
    kelvin: f32,
    by_temperature: bool,
}

pub fn light_parameters() -> Outcome<Vec<String>> {
    guard(|| PARAMETERS.into_iter().chain(light_apis::PARAMETERS).map(str::to_owned).collect())
}

/// The shape with UsdLux' fallbacks.
fn kind(light_type: ffi::LightType, path: &str) -> LightKind {
    match light_type {
        ffi::LightType::Distant => LightKind::Distant { angle_deg: 0.53 },
        ffi::LightType::Dome => LightKind::Dome { texture: None },
        ffi::LightType::Rect => LightKind::Rect { width: 1.0, height: 1.0 },
        ffi::LightType::Disk => LightKind::Disk { radius: 0.5 },
        ffi::LightType::Cylinder => LightKind::Cylinder { length: 1.0, radius: 0.5, treat_as_line: false },
        ffi::LightType::Other => LightKind::Portal { width: 1.0, height: 1.0 },
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
            world_from_prim: DAffine3::IDENTITY,
            prim_from_dome: DAffine3::IDENTITY,
            texture_file: String::new(),
            texture_format: DomeTextureFormat::Automatic,
            kelvin: DAYLIGHT_KELVIN,
            by_temperature: false,
        })
    })
}

impl Light {
    pub fn set_transform(&mut self, matrix: &[f64; 16]) -> Outcome {
        guard(|| self.world_from_prim = affine(matrix))
    }

    pub fn set_dome_offset(&mut self, matrix: &[f64; 16]) -> Outcome {
        guard(|| self.prim_from_dome = affine(matrix))
    }

    pub fn set_visible(&mut self, visible: bool) -> Outcome {
        guard(|| self.light.visible = visible)
    }

    pub fn reset_parameters(&mut self) -> Outcome {
        guard(|| {
            let visible = self.light.visible;
            let fresh = umber_scene::Light::new(self.fallback.clone());
            self.light = umber_scene::Light { visible, ..fresh };
            self.prim_from_dome = DAffine3::IDENTITY;
            self.texture_file.clear();
            self.texture_format = DomeTextureFormat::Automatic;
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
                _ if light_apis::set_numbers(light, parameter, numbers) => {}
                _ => shape(&mut light.kind, parameter, number),
            }
            light.color_temperature = self.by_temperature.then_some(self.kelvin);
        })
    }

    pub fn set_text(&mut self, parameter: &str, text: &str) -> Outcome {
        guard(|| match parameter {
            "texture:file" => text.clone_into(&mut self.texture_file),
            "texture:format" if !text.is_empty() => {
                self.texture_format = DomeTextureFormat::from_token(text).unwrap_or_else(|| {
                    let text = format!("there is no texture format '{text}'; it is taken as automatic");
                    self.host.say(Message::warning(Some(self.id.path()), text));
                    DomeTextureFormat::Automatic
                });
            }
            "lightLink" => self.light.light_link = (!text.is_empty()).then(|| Category::new(text)),
            "shadowLink" => self.light.shadow_link = (!text.is_empty()).then(|| Category::new(text)),
            "materialSyncMode" => {
                let LightKind::Mesh { material_sync, .. } = &mut self.light.kind else { return };
                match material_sync_of(text) {
                    Some(mode) => *material_sync = mode,
                    None => {
                        let text = format!("materialSyncMode '{text}' is not known: it is left out");
                        self.host.say(Message::warning(Some(self.id.path()), text));
                    }
                }
            }
            SHADER_ID => {
                if matches!(self.light.kind, LightKind::Portal { .. }) && text != "PortalLight" {
                    let text = format!("lights of this type are not supported; left out ({text})");
                    self.host.say(Message::warning(Some(self.id.path()), text));
                    self.light.visible = false;
                }
            }
            _ => {
                light_apis::set_text(&mut self.light, parameter, text);
            }
        })
    }

    pub fn set_paths(&mut self, parameter: &str, paths: &[&str]) -> Outcome {
        guard(|| {
            if parameter == "portals" {
                self.light.portals = paths.iter().map(|path| LightId::new(path)).collect();
            }
        })
    }

    pub fn commit(&self) -> Outcome {
        guard_refusal(|| self.host.edit(SceneEdit::Light(self.id.clone(), self.described())))
    }

    /// The light, its transform and texture put together.
    fn described(&self) -> umber_scene::Light {
        let mut light = self.light.clone();
        let file = (!self.texture_file.is_empty()).then(|| self.texture_file.clone().into());
        light.world_from_light = self.world_from_prim;
        match &mut light.kind {
            LightKind::Dome { texture } => {
                light.world_from_light = self.world_from_prim * self.prim_from_dome;
                *texture = file.map(|file| DomeTexture { file, format: self.texture_format });
            }
            LightKind::Rect { .. } => light.texture_file = file,
            _ => {}
        }
        light
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
        (LightKind::Rect { width, .. } | LightKind::Portal { width, .. }, "width") => *width = number,
        (LightKind::Rect { height, .. } | LightKind::Portal { height, .. }, "height") => *height = number,
        (LightKind::Sphere { radius, .. }, "radius") => *radius = number,
        (LightKind::Sphere { treat_as_point, .. }, "treatAsPoint") => *treat_as_point = number != 0.0,
        (LightKind::Disk { radius } | LightKind::Cylinder { radius, .. }, "radius") => *radius = number,
        (LightKind::Cylinder { length, .. }, "length") => *length = number,
        (LightKind::Cylinder { treat_as_line, .. }, "treatAsLine") => *treat_as_line = number != 0.0,
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
        light.set_numbers("shaping:focusTint", &[0.5, 0.25, 0.0]).unwrap();
        light.set_numbers("shaping:cone:angle", &[30.0]).unwrap();
        light.set_text("shaping:ies:file", "lamp.ies").unwrap();
        light.set_numbers("shaping:ies:normalize", &[1.0]).unwrap();
        light.set_numbers("shadow:falloff", &[2.0]).unwrap();
        let shaping = &light.light.shaping;
        assert_eq!((shaping.cone_angle_deg, shaping.focus_tint), (30.0, Rgb::new(0.5, 0.25, 0.0)));
        assert!(shaping.ies_file.as_deref() == Some("lamp.ies".as_ref()) && shaping.ies_normalize);
        assert_eq!(light.light.shadow.falloff, 2.0);
        light.set_text("lightLink", "/l.collection:lightLink").unwrap();
        light.set_text("shadowLink", "").unwrap();
        assert_eq!(light.light.light_link, Some(Category::new("/l.collection:lightLink")));
        assert_eq!(light.light.shadow_link, None);
        light.set_visible(false).unwrap();
        light.reset_parameters().unwrap();
        assert_eq!(light.light.kind, light.fallback);
        assert!(!light.light.visible && light.light.color_temperature.is_none());
        assert_eq!(light.light.shaping, umber_scene::Shaping::default());
        assert_eq!(light.light.shadow, umber_scene::Shadow::default());
    }

    #[test]
    fn every_parameter_changes_something() {
        let delegate = new_delegate().unwrap();
        for parameter in light_apis::PARAMETERS {
            let mut light = new_light(&delegate, "/l", ffi::LightType::Sphere).unwrap();
            light.set_numbers(parameter, &[0.25, 0.5, 0.75]).unwrap();
            light.set_text(parameter, "text").unwrap();
            assert_ne!(light.light, umber_scene::Light::new(light.fallback.clone()), "{parameter}");
        }
    }

    #[test]
    fn shapes_have_their_sizes() {
        let delegate = new_delegate().unwrap();
        let mut disk = new_light(&delegate, "/disk", ffi::LightType::Disk).unwrap();
        assert_eq!(disk.light.kind, LightKind::Disk { radius: 0.5 });
        disk.set_numbers("radius", &[2.0]).unwrap();
        disk.set_numbers("length", &[9.0]).unwrap();
        assert_eq!(disk.light.kind, LightKind::Disk { radius: 2.0 });
        let mut tube = new_light(&delegate, "/tube", ffi::LightType::Cylinder).unwrap();
        assert_eq!(tube.light.kind, LightKind::Cylinder { length: 1.0, radius: 0.5, treat_as_line: false });
        for (name, value) in [("radius", 0.25), ("length", 3.0), ("treatAsLine", 1.0)] {
            assert!(PARAMETERS.contains(&name));
            tube.set_numbers(name, &[value]).unwrap();
        }
        assert_eq!(tube.light.kind, LightKind::Cylinder { length: 3.0, radius: 0.25, treat_as_line: true });
    }

    #[test]
    fn textures_and_their_format_reach_the_light_in_any_order() {
        let delegate = new_delegate().unwrap();
        let mut dome = new_light(&delegate, "/sky", ffi::LightType::Dome).unwrap();
        dome.set_text("texture:format", "mirroredBall").unwrap();
        assert_eq!(dome.described().kind, LightKind::Dome { texture: None });
        dome.set_text("texture:file", "sky.exr").unwrap();
        let texture = DomeTexture { file: "sky.exr".into(), format: DomeTextureFormat::MirroredBall };
        assert_eq!(dome.described().kind, LightKind::Dome { texture: Some(texture.clone()) });
        dome.set_text("texture:format", "cubist").unwrap();
        let automatic = DomeTexture { format: DomeTextureFormat::Automatic, ..texture };
        assert_eq!(dome.described().kind, LightKind::Dome { texture: Some(automatic) });
        dome.reset_parameters().unwrap();
        assert_eq!(dome.described().kind, LightKind::Dome { texture: None });
        let mut rect = new_light(&delegate, "/rect", ffi::LightType::Rect).unwrap();
        rect.set_text("texture:file", "card.png").unwrap();
        assert_eq!(rect.described().texture_file, Some("card.png".into()));
    }

    #[test]
    fn the_pole_axis_turns_the_dome_before_its_transform() {
        let delegate = new_delegate().unwrap();
        let mut dome = new_light(&delegate, "/sky", ffi::LightType::Dome).unwrap();
        // Row vectors: +Y goes to +Z.
        let z_up = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        // +X goes to +Y.
        let turn = [0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        dome.set_dome_offset(&z_up).unwrap();
        dome.set_transform(&turn).unwrap();
        let image = |v| dome.described().world_from_light.transform_vector3(v);
        use umber_math::DVec3;
        assert_eq!((image(DVec3::Y), image(DVec3::Z), image(DVec3::X)), (DVec3::Z, DVec3::X, DVec3::Y));
        dome.reset_parameters().unwrap();
        assert_eq!(dome.described().world_from_light.transform_vector3(DVec3::Y), DVec3::NEG_X);
    }

    #[test]
    fn portals_and_domes_that_name_them() {
        let delegate = new_delegate().unwrap();
        let mut dome = new_light(&delegate, "/d", ffi::LightType::Dome).unwrap();
        dome.set_paths("portals", &["/p", "/q"]).unwrap();
        assert_eq!(*dome.light.portals, [LightId::new("/p"), LightId::new("/q")]);
        dome.reset_parameters().unwrap();
        assert!(dome.light.portals.is_empty());
        let mut portal = new_light(&delegate, "/p", ffi::LightType::Other).unwrap();
        portal.set_numbers("height", &[3.0]).unwrap();
        portal.set_text(SHADER_ID, "PortalLight").unwrap();
        assert_eq!((&portal.light.kind, portal.light.visible), (&LightKind::Portal { width: 1.0, height: 3.0 }, true));
        portal.set_text(SHADER_ID, "SomebodysLight").unwrap();
        assert!(!portal.light.visible && delegate.host().take_messages().len() == 1);
    }
}
