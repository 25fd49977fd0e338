//! Light that a ray meets: what its radiance counts beside the light samples that could have found it.

use umber_bvh::Hit;
use umber_math::{Rgb, Vector3};
use umber_sampling::power_heuristic;
use umber_shading::Receiver;

use crate::light_set::ShapeHit;
use crate::linking::Links;
use crate::scene::RenderScene;
use crate::surface::SurfaceInteraction;

/// How a ray's direction was found.
#[derive(Clone, Copy)]
pub(super) enum Origin {
    Camera,
    /// No light sample could have found it.
    Delta {
        diffuse_share: Rgb,
        links: Links,
    },
    /// By a mirror, where light paths find the light, too.
    Traced {
        receiver: Receiver,
        /// Density of light paths over that of light samples, where rays have 1.
        ratio: f32,
        diffuse_share: Rgb,
        links: Links,
    },
    /// By the BSDF at a point, with this density.
    Bsdf {
        receiver: Receiver,
        pdf_solid_angle: f32,
        diffuse_share: Rgb,
        links: Links,
    },
}

impl Origin {
    /// The same, with another density.
    pub fn with_pdf(self, pdf: f32) -> Self {
        match self {
            Self::Bsdf { receiver, diffuse_share, links, .. } => {
                Self::Bsdf { receiver, pdf_solid_angle: pdf, diffuse_share, links }
            }
            _ => self,
        }
    }
    /// Of the surface that the ray left; `None`: it left the camera.
    pub fn links(&self) -> Option<Links> {
        match self {
            Self::Camera => None,
            Self::Delta { links, .. } | Self::Traced { links, .. } | Self::Bsdf { links, .. } => Some(*links),
        }
    }
}

/// How a light's `diffuse` and `specular` multipliers scale what arrives through a sampled lobe.
fn multiplier(scene: &RenderScene, light: u32, diffuse_share: Rgb) -> Rgb {
    let light = &scene.lights.lights()[light as usize];
    Rgb::splat(light.specular()) + diffuse_share * (light.diffuse() - light.specular())
}

/// Weight of a light's radiance that was found by following a ray. `density`: with which the light, once chosen,
/// makes the ray's direction.
fn weight_of_found(scene: &RenderScene, light: u32, origin: Origin, density: impl Fn(&Receiver) -> f32) -> Rgb {
    if origin.links().is_some_and(|links| !scene.is_lit(links, light)) {
        return Rgb::BLACK;
    }
    match origin {
        Origin::Camera => Rgb::WHITE,
        Origin::Delta { diffuse_share, .. } => multiplier(scene, light, diffuse_share),
        Origin::Traced { diffuse_share, .. } if !is_found_in_mirrors(scene, light) => {
            multiplier(scene, light, diffuse_share)
        }
        Origin::Traced { receiver, ratio, diffuse_share, links } => {
            let pdf_traced = ratio * scene.light_pmf(links, &receiver, light) * density(&receiver);
            multiplier(scene, light, diffuse_share) * power_heuristic(1.0, pdf_traced)
        }
        Origin::Bsdf { receiver, pdf_solid_angle, diffuse_share, links } => {
            if !scene.is_found_by_rays(light) {
                // its shadows are not those that rays meet
                return Rgb::BLACK;
            }
            let pdf_light = scene.light_pmf(links, &receiver, light) * density(&receiver);
            let mis_weight_bsdf = power_heuristic(pdf_solid_angle, pdf_light);
            multiplier(scene, light, diffuse_share) * mis_weight_bsdf
        }
    }
}

/// Whether a light shows in mirrors as its samples see it: not where its shadows are others, nor where a material's own
/// glow shows in its place.
#[inline]
pub(crate) fn is_found_in_mirrors(scene: &RenderScene, light: u32) -> bool {
    scene.is_found_by_rays(light) && scene.lights.lights()[light as usize].as_mesh().is_none()
}

/// What a ray meets.
pub(super) enum Met {
    /// The shape of a light.
    Light(ShapeHit),
    Surface(Hit, SurfaceInteraction),
    Nothing,
}

impl Met {
    /// Radiance of what shines by itself, against a ray of this direction.
    #[inline(always)]
    pub fn radiance(&self, scene: &RenderScene, direction: Vector3, origin: Origin) -> Rgb {
        match self {
            Self::Light(hit) => from_shape(scene, hit, direction, origin),
            Self::Surface(hit, surface) => from_surface(scene, hit, surface, direction, origin),
            Self::Nothing => from_infinity(scene, direction, origin).0,
        }
    }
    /// The same against a ray from the camera, and whether that sees anything.
    #[inline]
    pub fn seen(&self, scene: &RenderScene, direction: Vector3) -> (Rgb, bool) {
        match self {
            Self::Nothing => from_infinity(scene, direction, Origin::Camera),
            _ => (self.radiance(scene, direction, Origin::Camera), true),
        }
    }
}

#[inline]
fn from_shape(scene: &RenderScene, hit: &ShapeHit, wi: Vector3, origin: Origin) -> Rgb {
    let light = &scene.lights.lights()[hit.light as usize];
    let density = |r: &Receiver| light.pdf_solid_angle(r.point, wi);
    hit.radiance * weight_of_found(scene, hit.light, origin, density)
}

/// Radiance that geometry emits against a ray.
#[inline]
fn from_surface(scene: &RenderScene, hit: &Hit, surface: &SurfaceInteraction, wi: Vector3, origin: Origin) -> Rgb {
    let Some(emitter) = scene.lights.emitter_at(hit) else { return surface.emission };
    let as_light = matches!(origin, Origin::Bsdf { .. });
    if emitter.glows && !as_light {
        return surface.emission;
    }
    let Some(index) = emitter.light else { return Rgb::BLACK };
    let Some(light) = scene.lights.lights()[index as usize].as_mesh() else { return Rgb::BLACK };
    let radiance = light.radiance(hit.triangle, wi, surface.at.normal);
    if radiance.is_black() {
        return Rgb::BLACK;
    }
    radiance * weight_of_found(scene, index, origin, |r| light.pdf_solid_angle(r, hit.triangle, wi))
}

/// Radiance of the lights around the scene, and whether there is any.
#[inline]
fn from_infinity(scene: &RenderScene, wi: Vector3, origin: Origin) -> (Rgb, bool) {
    let mut sum = Rgb::BLACK;
    let mut seen = false;
    for &light in scene.lights.infinite() {
        let of_light = &scene.lights.lights()[light as usize];
        if matches!(origin, Origin::Camera)
            && !(of_light.camera_visible() && scene.settings.dome_light_camera_visibility)
        {
            continue;
        }
        if let Some(found) = of_light.from_infinity(wi) {
            let density = |r: &Receiver| of_light.pdf_from_infinity(r.point, &found);
            sum += found.radiance * weight_of_found(scene, light, origin, density);
            seen = true;
        }
    }
    (sum, seen)
}
