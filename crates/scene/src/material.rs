//! Materials.

use umber_math::Rgb;

/// `opacityMode` of UsdPreviewSurface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OpacityMode {
    /// Clear but reflecting, as glass.
    #[default]
    Transparent,
    /// Not there.
    Presence,
}

/// UsdPreviewSurface with constant inputs; names and fallbacks as in its specification.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct PreviewSurface {
    pub diffuse_color: Rgb,
    pub emissive_color: Rgb,
    pub use_specular_workflow: bool,
    pub specular_color: Rgb,
    pub metallic: f32,
    pub roughness: f32,
    pub clearcoat: f32,
    pub clearcoat_roughness: f32,
    pub opacity: f32,
    pub opacity_mode: OpacityMode,
    pub opacity_threshold: f32,
    pub ior: f32,
}

impl Default for PreviewSurface {
    fn default() -> Self {
        Self {
            diffuse_color: Rgb::splat(0.18),
            emissive_color: Rgb::BLACK,
            use_specular_workflow: false,
            specular_color: Rgb::BLACK,
            metallic: 0.0,
            roughness: 0.5,
            clearcoat: 0.0,
            clearcoat_roughness: 0.01,
            opacity: 1.0,
            opacity_mode: OpacityMode::Transparent,
            opacity_threshold: 0.0,
            ior: 1.5,
        }
    }
}

/// A material.
#[derive(Clone, Debug, PartialEq)]
pub enum Material {
    /// UsdPreviewSurface.
    Preview(PreviewSurface),
    /// Nothing that Umber understands: meshes show their displayColor.
    Unknown,
}
