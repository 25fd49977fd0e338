//! Lights in render space.

use std::collections::{BTreeMap, HashMap};
use std::path::PathBuf;
use std::sync::Arc;

use umber_math::{Bounds3, DAffine3};
use umber_scene::{Light, LightId, LightKind};
use umber_shading::{EnvironmentMap, LightParams, Portal};

use crate::light_set::LightSet;
use crate::linking::LightLinks;

/// Keeps the pictures of dome lights.
#[derive(Debug, Default)]
pub struct LightCompiler {
    /// By file; `None` where it could not be read.
    textures: HashMap<PathBuf, Option<Arc<EnvironmentMap>>>,
}

impl LightCompiler {
    /// Makes all lights that shine, and their links.
    pub fn compile(
        &mut self,
        lights: &BTreeMap<LightId, Light>,
        render_from_world: DAffine3,
        scene_bounds: Bounds3,
        warn: &mut dyn FnMut(&str, String),
    ) -> (LightSet, Vec<LightLinks>) {
        let in_use = |file: &PathBuf| {
            let is_this = |l: &Light| matches!(&l.kind, LightKind::Dome { texture: Some(t) } if t.file == *file);
            lights.values().any(is_this)
        };
        self.textures.retain(|file, _| in_use(file));
        let (mut made, mut links) = (Vec::new(), Vec::new());
        let shines = |light: &Light| light.visible && !matches!(light.kind, LightKind::Portal { .. });
        for (id, light) in lights.iter().filter(|(_, light)| shines(light)) {
            let portals = portals(id, light, lights, render_from_world, warn);
            let params = self.params(id, light, render_from_world, warn);
            match umber_shading::Light::new(&params) {
                Ok((shape, problems)) => {
                    problems.iter().for_each(|problem| warn(id.path(), problem.to_string()));
                    if !shape.is_black() {
                        made.push(shape.with_portals(portals));
                        links.push(LightLinks { light: light.light_link.clone(), shadow: light.shadow_link.clone() });
                    }
                }
                Err(problem) => warn(id.path(), problem.to_string()),
            }
        }
        (LightSet::new(made, scene_bounds), links)
    }

    fn params(
        &mut self,
        id: &LightId,
        light: &Light,
        render_from_world: DAffine3,
        warn: &mut dyn FnMut(&str, String),
    ) -> LightParams {
        let kind = match &light.kind {
            LightKind::Distant { angle_deg } => umber_shading::LightKind::Distant { angle_deg: *angle_deg },
            LightKind::Rect { width, height } => umber_shading::LightKind::Rect { width: *width, height: *height },
            LightKind::Sphere { radius, treat_as_point } => {
                umber_shading::LightKind::Sphere { radius: *radius, treat_as_point: *treat_as_point }
            }
            LightKind::Portal { width, height } => umber_shading::LightKind::Rect { width: *width, height: *height },
            LightKind::Dome { texture } => {
                let texture = texture.as_ref().and_then(|t| self.texture(id, &t.file, warn));
                umber_shading::LightKind::Dome { texture }
            }
        };
        LightParams {
            kind,
            render_from_light: render_from_world * light.world_from_light,
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

/// The portals of a light that are shown.
fn portals(
    id: &LightId,
    light: &Light,
    lights: &BTreeMap<LightId, Light>,
    render_from_world: DAffine3,
    warn: &mut dyn FnMut(&str, String),
) -> Vec<Portal> {
    let mut usable = Vec::new();
    for portal_id in light.portals.iter() {
        let Some(portal) = lights.get(portal_id) else {
            warn(id.path(), format!("no such portal: {portal_id}"));
            continue;
        };
        let LightKind::Portal { width, height } = portal.kind else {
            warn(id.path(), format!("{portal_id} is not a portal light; it guides nothing"));
            continue;
        };
        match Portal::new(render_from_world * portal.world_from_light, width, height) {
            Ok(made) if portal.visible => usable.push(made),
            Ok(_) => {}
            Err(problem) => warn(portal_id.path(), problem.to_string()),
        }
    }
    usable
}
