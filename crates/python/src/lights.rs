//! Lights, cameras and materials, from the dataclasses of `umber.description`.

use pyo3::prelude::*;
use umber_math::{DVec2, Rgb};
use umber_scene::{
    Camera, CameraId, Category, ConformPolicy, DomeTexture, DomeTextureFormat, Light, LightId, LightKind, Material,
    MaterialId, MaterialSync, MeshId, OpacityMode, PreviewSurface, Projection, SceneEdit,
};

use crate::arrays::{Doubles, bad_value, transform};
use crate::light_apis::{PyShadow, PyShaping};

pub(crate) fn rgb([r, g, b]: [f32; 3]) -> Rgb {
    Rgb::new(r, g, b)
}

/// `umber.description.Light`.
#[derive(FromPyObject)]
pub struct PyLight<'py> {
    path: String,
    kind: String,
    angle_deg: f32,
    width: f32,
    height: f32,
    radius: f32,
    length: f32,
    treat_as_point: bool,
    treat_as_line: bool,
    texture_file: Option<String>,
    texture_format: String,
    mesh: Option<String>,
    material_sync_mode: String,
    transform: Doubles<'py>,
    color: [f32; 3],
    intensity: f32,
    exposure: f32,
    normalize: bool,
    color_temperature: Option<f32>,
    diffuse: f32,
    specular: f32,
    shadow_enable: bool,
    shaping: PyShaping,
    shadow: PyShadow,
    portals: Vec<String>,
    light_link: Option<String>,
    shadow_link: Option<String>,
}

impl PyLight<'_> {
    /// The edit that inserts or replaces the light.
    pub fn edit(&self) -> PyResult<SceneEdit> {
        let kind = match self.kind.as_str() {
            "distant" => LightKind::Distant { angle_deg: self.angle_deg },
            "dome" => {
                let format = DomeTextureFormat::from_token(&self.texture_format)
                    .ok_or_else(|| bad_value(format!("unknown texture format '{}'", self.texture_format)))?;
                let texture = |file: &String| DomeTexture { file: file.into(), format };
                LightKind::Dome { texture: self.texture_file.as_ref().map(texture) }
            }
            "rect" => LightKind::Rect { width: self.width, height: self.height },
            "sphere" => LightKind::Sphere { radius: self.radius, treat_as_point: self.treat_as_point },
            "disk" => LightKind::Disk { radius: self.radius },
            "cylinder" => {
                LightKind::Cylinder { length: self.length, radius: self.radius, treat_as_line: self.treat_as_line }
            }
            "portal" => LightKind::Portal { width: self.width, height: self.height },
            "mesh" => LightKind::Mesh {
                mesh: MeshId::new(self.mesh.as_deref().unwrap_or_default()),
                material_sync: self.material_sync()?,
            },
            other => return Err(bad_value(format!("unknown kind of light '{other}'"))),
        };
        let category = |name: &Option<String>| name.as_deref().map(Category::new);
        let light = Light {
            texture_file: self.texture_file.as_ref().filter(|_| self.kind == "rect").map(Into::into),
            world_from_light: transform(&self.transform, "transform")?,
            color: rgb(self.color),
            intensity: self.intensity,
            exposure: self.exposure,
            normalize: self.normalize,
            color_temperature: self.color_temperature,
            diffuse: self.diffuse,
            specular: self.specular,
            shadow_enable: self.shadow_enable,
            shaping: self.shaping.convert(),
            shadow: self.shadow.convert(),
            portals: self.portals.iter().map(|path| LightId::new(path)).collect(),
            light_link: category(&self.light_link),
            shadow_link: category(&self.shadow_link),
            ..Light::new(kind)
        };
        Ok(SceneEdit::Light(LightId::new(&self.path), light))
    }

    fn material_sync(&self) -> PyResult<MaterialSync> {
        match self.material_sync_mode.as_str() {
            "materialGlowTintsLight" => Ok(MaterialSync::GlowTintsLight),
            "independent" => Ok(MaterialSync::Independent),
            "noMaterialResponse" => Ok(MaterialSync::NoResponse),
            other => Err(bad_value(format!("unknown material sync mode '{other}'"))),
        }
    }
}

/// `umber.description.Camera`.
#[derive(FromPyObject)]
pub struct PyCamera<'py> {
    path: String,
    transform: Doubles<'py>,
    orthographic: bool,
    aperture: [f64; 2],
    aperture_offset: [f64; 2],
    focal_length: f64,
    clipping_range: [f32; 2],
    conform_policy: String,
}

impl PyCamera<'_> {
    /// The edits that insert or replace the camera and look through it.
    pub fn edits(&self) -> PyResult<[SceneEdit; 2]> {
        let conform_policy = match self.conform_policy.as_str() {
            "matchVertically" => ConformPolicy::MatchVertically,
            "matchHorizontally" => ConformPolicy::MatchHorizontally,
            "fit" => ConformPolicy::Fit,
            "crop" => ConformPolicy::Crop,
            "dontConform" => ConformPolicy::DontConform,
            other => return Err(bad_value(format!("unknown conform policy '{other}'"))),
        };
        let camera = Camera {
            world_from_camera: transform(&self.transform, "transform")?,
            projection: if self.orthographic { Projection::Orthographic } else { Projection::Perspective },
            aperture: DVec2::from_array(self.aperture),
            aperture_offset: DVec2::from_array(self.aperture_offset),
            focal_length: self.focal_length,
            clipping_range: self.clipping_range,
            conform_policy,
        };
        let id = CameraId::new(&self.path);
        Ok([SceneEdit::Camera(id.clone(), camera), SceneEdit::RenderCamera(id)])
    }
}

/// `umber.description.PreviewSurface`.
#[derive(FromPyObject)]
pub struct PyPreviewSurface {
    diffuse_color: [f32; 3],
    emissive_color: [f32; 3],
    use_specular_workflow: bool,
    specular_color: [f32; 3],
    metallic: f32,
    roughness: f32,
    clearcoat: f32,
    clearcoat_roughness: f32,
    opacity: f32,
    opacity_mode: String,
    opacity_threshold: f32,
    ior: f32,
}

/// `umber.description.Material`.
#[derive(FromPyObject)]
pub struct PyMaterial {
    path: String,
    surface: Option<PyPreviewSurface>,
}

impl PyPreviewSurface {
    fn convert(&self) -> PyResult<PreviewSurface> {
        let opacity_mode = match self.opacity_mode.as_str() {
            "transparent" => OpacityMode::Transparent,
            "presence" => OpacityMode::Presence,
            other => return Err(bad_value(format!("unknown opacity mode '{other}'"))),
        };
        Ok(PreviewSurface {
            diffuse_color: rgb(self.diffuse_color),
            emissive_color: rgb(self.emissive_color),
            use_specular_workflow: self.use_specular_workflow,
            specular_color: rgb(self.specular_color),
            metallic: self.metallic,
            roughness: self.roughness,
            clearcoat: self.clearcoat,
            clearcoat_roughness: self.clearcoat_roughness,
            opacity: self.opacity,
            opacity_mode,
            opacity_threshold: self.opacity_threshold,
            ior: self.ior,
        })
    }
}

impl PyMaterial {
    /// The edit that inserts or replaces the material.
    pub fn edit(&self) -> PyResult<SceneEdit> {
        let material = match &self.surface {
            Some(surface) => Material::Preview(surface.convert()?),
            None => Material::Unknown,
        };
        Ok(SceneEdit::Material(MaterialId::new(&self.path), material))
    }
}
