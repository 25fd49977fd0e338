//! Lights in render space.

use std::collections::{BTreeMap, HashMap};
use std::path::PathBuf;
use std::sync::Arc;

use umber_math::{Bounds3, DAffine3};
use umber_scene::{Light, LightId, LightKind};
use umber_shading::{EnvironmentMap, LightParams};

use super::emitters::Emitters;
use crate::light_set::LightSet;

/// Keeps the pictures of dome lights.
#[derive(Debug, Default)]
pub struct LightCompiler {
    /// By file; `None` where it could not be read.
    textures: HashMap<PathBuf, Option<Arc<EnvironmentMap>>>,
}

impl LightCompiler {
    /// Makes all lights that shine.
    pub fn compile(
        &mut self,
        lights: &BTreeMap<LightId, Light>,
        render_from_world: DAffine3,
        scene_bounds: Bounds3,
        emitters: Emitters,
        warn: &mut dyn FnMut(&str, String),
    ) -> LightSet {
        let in_use = |file: &PathBuf| {
            let is_this = |l: &Light| matches!(&l.kind, LightKind::Dome { texture: Some(t) } if t.file == *file);
            lights.values().any(is_this)
        };
        self.textures.retain(|file, _| in_use(file));
        let mut made = Vec::new();
        for (id, light) in lights.iter().filter(|(_, light)| light.visible) {
            let Some(params) = self.params(id, light, render_from_world, warn) else { continue };
            match umber_shading::Light::new(&params) {
                Ok((light, problems)) => {
                    problems.iter().for_each(|problem| warn(id.path(), problem.to_string()));
                    made.push(light);
                }
                Err(problem) => warn(id.path(), problem.to_string()),
            }
        }
        LightSet::with_emitters(made, emitters, scene_bounds)
    }

    fn params(
        &mut self,
        id: &LightId,
        light: &Light,
        render_from_world: DAffine3,
        warn: &mut dyn FnMut(&str, String),
    ) -> Option<LightParams> {
        let kind = match &light.kind {
            LightKind::Distant { angle_deg } => umber_shading::LightKind::Distant { angle_deg: *angle_deg },
            LightKind::Rect { width, height } => umber_shading::LightKind::Rect { width: *width, height: *height },
            LightKind::Sphere { radius, treat_as_point } => {
                umber_shading::LightKind::Sphere { radius: *radius, treat_as_point: *treat_as_point }
            }
            LightKind::Dome { texture } => {
                let texture = texture.as_ref().and_then(|t| self.texture(id, &t.file, warn));
                umber_shading::LightKind::Dome { texture }
            }
            // made with the mesh's emitters
            LightKind::Mesh { .. } => return None,
        };
        Some(params(light, kind, render_from_world * light.world_from_light))
    }

    fn texture(
        &mut self,
        id: &LightId,
        file: &PathBuf,
        warn: &mut dyn FnMut(&str, String),
    ) -> Option<Arc<EnvironmentMap>> {
        if let Some(known) = self.textures.get(file) {
            return known.clone();
        }
        let loaded = match EnvironmentMap::load(file) {
            Ok(map) => Some(Arc::new(map)),
            Err(error) => {
                warn(id.path(), format!("its texture is left out: {error}"));
                None
            }
        };
        self.textures.insert(file.clone(), loaded.clone());
        loaded
    }
}

/// A light of the kind given, with what lights of all kinds have.
pub fn params(light: &Light, kind: umber_shading::LightKind, render_from_light: DAffine3) -> LightParams {
    LightParams {
        kind,
        render_from_light,
        color: light.color,
        intensity: light.intensity,
        exposure: light.exposure,
        normalize: light.normalize,
        color_temperature: light.color_temperature,
        diffuse: light.diffuse,
        specular: light.specular,
        shadow_enable: light.shadow_enable,
        camera_visible: light.camera_visible,
    }
}
