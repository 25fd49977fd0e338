//! Lights in render space.

use std::collections::{BTreeMap, HashMap};
use std::path::PathBuf;
use std::sync::Arc;

use umber_math::{Bounds3, DAffine3};
use umber_scene::{DomeTexture, DomeTextureFormat, Light, LightId, LightKind};
use umber_shading::{EnvironmentMap, ImageError, LightParams, LightTexture, Portal, ShadowParams, TextureFormat};

use super::emitters::Emitters;
use super::profiles::Profiles;
use crate::light_set::LightSet;
use crate::linking::LightLinks;

/// Keeps the pictures of dome and rect lights, and IES profiles.
#[derive(Debug, Default)]
pub struct LightCompiler {
    domes: HashMap<(PathBuf, DomeTextureFormat), Read<EnvironmentMap>>,
    rects: HashMap<PathBuf, Read<LightTexture>>,
    profiles: Profiles,
}

/// What came of reading a picture.
type Read<T> = Result<Arc<T>, ImageError>;

impl LightCompiler {
    /// Makes all lights that shine, and their links.
    pub fn compile(
        &mut self,
        lights: &BTreeMap<LightId, Light>,
        render_from_world: DAffine3,
        scene_bounds: Bounds3,
        emitters: Emitters,
        warn: &mut dyn FnMut(&str, String),
    ) -> (LightSet, Vec<LightLinks>) {
        self.domes.retain(|(file, format), _| {
            let is_this = |t: &DomeTexture| t.file == *file && t.format == *format;
            lights.values().any(|l| matches!(&l.kind, LightKind::Dome { texture: Some(t) } if is_this(t)))
        });
        self.rects.retain(|file, _| lights.values().any(|l| rect_texture(l) == Some(file)));
        self.profiles.retain_used(lights.values());
        let (mut made, mut links) = (Vec::new(), Vec::new());
        let shines = |light: &Light| light.visible && !matches!(light.kind, LightKind::Portal { .. });
        for (id, light) in lights.iter().filter(|(_, light)| shines(light)) {
            let portals = portals(id, light, lights, render_from_world, warn);
            let Some(params) = self.params(id, light, render_from_world, warn) else { continue };
            match umber_shading::Light::new(&params) {
                Ok((shape, problems)) => {
                    problems.iter().for_each(|problem| warn(id.path(), problem.to_string()));
                    if !shape.is_black() {
                        made.push(shape.with_portals(portals));
                        links.push(self::links(light));
                    }
                }
                Err(problem) => warn(id.path(), problem.to_string()),
            }
        }
        links.extend(emitters.links.iter().cloned());
        let set = LightSet::with_emitters(made, emitters, scene_bounds);
        debug_assert_eq!(links.len(), set.lights().len());
        (set, links)
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
            LightKind::Disk { radius } => umber_shading::LightKind::Disk { radius: *radius },
            LightKind::Cylinder { length, radius, treat_as_line } => {
                umber_shading::LightKind::Cylinder { length: *length, radius: *radius, treat_as_line: *treat_as_line }
            }
            LightKind::Portal { width, height } => umber_shading::LightKind::Rect { width: *width, height: *height },
            LightKind::Dome { texture } => {
                let texture = texture.as_ref().and_then(|t| usable(self.dome(t), id, warn));
                umber_shading::LightKind::Dome { texture }
            }
            // made with the mesh's emitters
            LightKind::Mesh { .. } => return None,
        };
        Some(LightParams {
            texture: rect_texture(light).and_then(|file| usable(self.rect(file), id, warn)),
            shaping: self.profiles.shaping(id, &light.shaping, warn),
            ..params(light, kind, render_from_world * light.world_from_light)
        })
    }

    fn dome(&mut self, texture: &DomeTexture) -> &Read<EnvironmentMap> {
        let format = match texture.format {
            DomeTextureFormat::Automatic => None,
            DomeTextureFormat::LatLong => Some(TextureFormat::LatLong),
            DomeTextureFormat::MirroredBall => Some(TextureFormat::MirroredBall),
            DomeTextureFormat::Angular => Some(TextureFormat::Angular),
            DomeTextureFormat::CubeMapVerticalCross => Some(TextureFormat::CubeMapVerticalCross),
        };
        let read = || EnvironmentMap::load_as(&texture.file, format).map(Arc::new);
        self.domes.entry((texture.file.clone(), texture.format)).or_insert_with(read)
    }

    fn rect(&mut self, file: &PathBuf) -> &Read<LightTexture> {
        self.rects.entry(file.clone()).or_insert_with(|| LightTexture::load(file).map(Arc::new))
    }
}

/// A light of the kind given, with what lights of all kinds have; without picture and shaping.
pub fn params(light: &Light, kind: umber_shading::LightKind, render_from_light: DAffine3) -> LightParams {
    LightParams {
        render_from_light,
        color: light.color,
        intensity: light.intensity,
        exposure: light.exposure,
        normalize: light.normalize,
        color_temperature: light.color_temperature,
        diffuse: light.diffuse,
        specular: light.specular,
        shadow_enable: light.shadow_enable,
        shadow_linked: light.shadow_link.is_some(),
        camera_visible: light.camera_visible,
        shadow: shadow(&light.shadow),
        ..LightParams::new(kind)
    }
}

/// The links of a light.
pub fn links(light: &Light) -> LightLinks {
    LightLinks { light: light.light_link.clone(), shadow: light.shadow_link.clone() }
}

fn rect_texture(light: &Light) -> Option<&PathBuf> {
    light.texture_file.as_ref().filter(|_| matches!(light.kind, LightKind::Rect { .. }))
}

/// The picture; where there is none, the light that wants it is named.
fn usable<T>(read: &Read<T>, id: &LightId, warn: &mut dyn FnMut(&str, String)) -> Option<Arc<T>> {
    let failed = |error: &ImageError| warn(id.path(), format!("its texture is left out: {error}"));
    read.as_ref().map_err(failed).ok().cloned()
}

fn shadow(shadow: &umber_scene::Shadow) -> ShadowParams {
    let &umber_scene::Shadow { color, distance, falloff, falloff_gamma } = shadow;
    ShadowParams { color, distance, falloff, falloff_gamma }
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

#[cfg(test)]
mod tests {
    use super::*;

    fn compiled(lights: Vec<(&str, Light)>, compiler: &mut LightCompiler) -> (LightSet, Vec<(String, String)>) {
        let lights: BTreeMap<_, _> = lights.into_iter().map(|(path, light)| (LightId::new(path), light)).collect();
        let mut said = Vec::new();
        let mut warn = |path: &str, text: String| said.push((path.to_owned(), text));
        let (set, _) = compiler.compile(&lights, DAffine3::IDENTITY, Bounds3::EMPTY, Emitters::default(), &mut warn);
        (set, said)
    }

    #[test]
    fn every_light_whose_picture_is_missing_is_named_and_shines_without() {
        let file: PathBuf = "no/such/picture.exr".into();
        let rect =
            || Light { texture_file: Some(file.clone()), ..Light::new(LightKind::Rect { width: 1.0, height: 1.0 }) };
        let texture = DomeTexture { file: file.clone(), format: DomeTextureFormat::Angular };
        let dome = Light::new(LightKind::Dome { texture: Some(texture) });
        let mut compiler = LightCompiler::default();
        // Again, as after an edit: still named.
        for _ in 0..2 {
            let lights = vec![("/a", rect()), ("/b", rect()), ("/sky", dome.clone())];
            let (set, said) = compiled(lights, &mut compiler);
            assert_eq!(set.lights().len(), 3);
            let named: Vec<&str> = said.iter().map(|(path, _)| path.as_str()).collect();
            assert_eq!(named, ["/a", "/b", "/sky"]);
            assert!(said.iter().all(|(_, text)| text.contains("no/such/picture.exr")), "{said:?}");
        }
        // A shape that shows no picture does not ask for it.
        let disk = Light { texture_file: Some(file), ..Light::new(LightKind::Disk { radius: 1.0 }) };
        assert!(compiled(vec![("/disk", disk)], &mut compiler).1.is_empty());
        assert!(compiler.rects.is_empty() && compiler.domes.is_empty());
    }

    #[test]
    fn shapes_reach_the_renderer() {
        let cylinder = |treat_as_line| Light::new(LightKind::Cylinder { length: 4.0, radius: 0.5, treat_as_line });
        let disk = Light::new(LightKind::Disk { radius: 2.0 });
        let lights = vec![("/a", disk), ("/b", cylinder(false)), ("/c", cylinder(true))];
        let (set, said) = compiled(lights, &mut LightCompiler::default());
        assert!(said.is_empty());
        let sizes: Vec<[f32; 3]> = set.lights().iter().map(|l| l.bounds().unwrap().size().to_array()).collect();
        assert_eq!(sizes, [[4.0, 4.0, 0.0], [4.0, 1.0, 1.0], [4.0, 0.0, 0.0]]);
        assert_eq!(set.lights().iter().map(|l| l.is_delta()).collect::<Vec<_>>(), [false, false, true]);
    }
}
