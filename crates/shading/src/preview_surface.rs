//! UsdPreviewSurface, by the "UsdPreviewSurface Specification" version 2.5, with constant inputs.
//!
//! Where the specification leaves room, or we leave it:
//! - All specular lobes are GGX with `alpha = roughness²`, Schlick's Fresnel from F0 to white (F90).
//!   The specification's F90 of a metal is its albedo, which no metal shows: at grazing incidence they all turn
//!   white. The lobe here is what other path tracers call a metal of that base colour.
//! - Where F0 is black (specularColor 0 in the specular workflow, ior 1, a black metal) there is no specular lobe,
//!   rather than one that shows at grazing angles only. `specularColor` (0, 0, 0), the default, thus gives a Lambertian.
//! - The clear coat's F0 comes from `ior`, as in OpenUSD's GLSLFX implementation.
//! - Opacity is presence in both opacity modes: specular highlights of a transparent surface fade with it.

use umber_math::{Frame, Normal3, Rgb};

use crate::bsdf::{Coat, Ggx, unit, unit_rgb};
use crate::{Bsdf, Lobes};

/// How opacity acts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OpacityMode {
    /// Like glass: specular reflection stays. Rendered as [`OpacityMode::Presence`].
    #[default]
    Transparent,
    /// Like a cut-out.
    Presence,
}

/// Inputs of a UsdPreviewSurface; the default is the specification's.
///
/// Any value may be given: colours and weights are clamped to 0 … 1 in use, NaN counts as 0.
#[derive(Clone, Debug, PartialEq)]
pub struct PreviewSurface {
    /// Albedo; the reflectance at normal incidence of a metal.
    pub diffuse_color: Rgb,
    /// Emitted radiance.
    pub emissive_color: Rgb,
    /// Whether `specular_color` gives F0, instead of `metallic` and `ior`.
    pub use_specular_workflow: bool,
    /// F0 of the specular workflow.
    pub specular_color: Rgb,
    /// 0 for a dielectric, 1 for a metal.
    pub metallic: f32,
    /// Roughness of the specular lobe.
    pub roughness: f32,
    /// Weight of the clear coat.
    pub clearcoat: f32,
    /// Roughness of the clear coat.
    pub clearcoat_roughness: f32,
    /// 1 where there is a surface.
    pub opacity: f32,
    /// How opacity acts.
    pub opacity_mode: OpacityMode,
    /// Above zero, opacity is cut: nothing below the threshold, full from it on.
    pub opacity_threshold: f32,
    /// Index of refraction.
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

impl PreviewSurface {
    /// The BSDF at a point; frame and geometric normal in render space, unit.
    pub fn bsdf(&self, frame: Frame, ng: Normal3) -> Bsdf {
        Bsdf::new(self.lobes(), frame, ng)
    }
    /// The lobes alone, for use at many points.
    pub fn lobes(&self) -> Lobes {
        let albedo = unit_rgb(self.diffuse_color);
        let (f0, diffuse) = if self.use_specular_workflow {
            (unit_rgb(self.specular_color), albedo)
        } else {
            let metallic = unit(self.metallic);
            (Rgb::splat(self.dielectric_f0()).lerp(albedo, metallic), albedo * (1.0 - metallic))
        };
        let clearcoat = unit(self.clearcoat);
        let coat = Ggx::new(Rgb::splat(self.dielectric_f0()), unit(self.clearcoat_roughness))
            .filter(|_| clearcoat > 0.0)
            .map(|lobe| Coat { lobe, weight: clearcoat });
        Lobes::layered(diffuse, Ggx::new(f0, unit(self.roughness)), coat)
    }
    /// Emitted radiance, finite and not negative.
    pub fn emission(&self) -> Rgb {
        let channel = |v: f32| if v > 0.0 { v.min(1e30) } else { 0.0 };
        Rgb(glam::Vec3::from(self.emissive_color.0.to_array().map(channel)))
    }
    /// Probability that a ray meets the surface instead of passing straight through, 0 … 1.
    pub fn presence(&self) -> f32 {
        if self.opacity_threshold > 0.0 {
            return if self.opacity >= self.opacity_threshold { 1.0 } else { 0.0 };
        }
        unit(self.opacity)
    }
    /// Reflectance at normal incidence of an interface with air: `((1 − ior) / (1 + ior))²`.
    fn dielectric_f0(&self) -> f32 {
        let r = (1.0 - self.ior) / (1.0 + self.ior);
        unit(r * r)
    }
}
