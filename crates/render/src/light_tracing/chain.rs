//! How densely light paths are made, beside those from the camera: what multiple importance sampling needs.
//!
//! A path *x₁* (seen by the camera, not in a mirror there), *x₂ … xₖ* (smooth), *y* (on a light) is made in three ways:
//! from the camera with *y* by a light sample at *xₖ*, or by a ray of its BSDF; and from *xₖ* on, with *y* by a light
//! sample. In area measure, the last way's density over the first one's, samples counted, is
//!
//! ```text
//! R = ρ p(xₖ) / q(x₁) · Π p(xⱼ → xⱼ₋₁) / Π p(xⱼ → xⱼ₊₁) · Π cos(xⱼ → xⱼ₊₁) / Π cos(xⱼ → xⱼ₋₁)
//!                     j = 2 … k          j = 1 … k − 1     j = 1 … k − 1      j = 2 … k
//! ```
//!
//! with *ρ* light paths to each sample of a pixel, *p(xₖ)* the density by area with which light paths begin, *q(x₁)*
//! the pixels to a unit of area, and the BSDFs' densities by solid angle; distances cancel. Cosines are those to the
//! geometric normals. A mirror's densities are the chances of choosing it, the same both ways.

use umber_bvh::Hit;
use umber_math::Vector3;
use umber_shading::{Bsdf, BsdfSample, LobeKind};

use super::REFLECTIONS;
use crate::integrator::path::Vertex;
use crate::scene::RenderScene;
use crate::surface::SurfaceInteraction;

/// *R* of a path from the camera, without what belongs to its next vertex; 0 where no light path makes it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Chain(f32);

/// The same at a vertex, without the density with which light goes back along the path from there, as that depends on
/// where it comes from.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Link {
    /// 0 where no light path makes the path.
    so_far: f32,
    /// Density by area with which light paths begin there.
    pdf_area: f32,
}

/// *R* of a path.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Ratio(pub f32);

impl Ratio {
    /// By how much a light sample's density counts more, for both ways that sample lights together.
    #[inline]
    pub fn of_both(self) -> f32 {
        (1.0 + self.0 * self.0).sqrt()
    }
    /// The part of both that a path from the camera has.
    #[inline]
    pub fn share_of_path(self) -> f32 {
        1.0 / (1.0 + self.0 * self.0)
    }
}

impl Chain {
    /// At the vertex that it leads to, which is number `bounce`, counted from 0.
    #[inline(always)]
    pub fn link(
        self,
        scene: &RenderScene,
        hit: &Hit,
        surface: &SurfaceInteraction,
        bsdf: &Bsdf,
        wo: Vector3,
        bounce: u32,
    ) -> Link {
        let Some(tracing) = &scene.light_tracing else { return Link::default() };
        let cosine = wo.dot_normal(surface.at.normal);
        let (so_far, pdf_area) = if bounce == 0 {
            let density = scene.camera.pixels_over_area(-wo, hit.t) * cosine.abs();
            (tracing.paths_a_sample / density, 0.0)
        } else if self.0 > 0.0 && bounce <= REFLECTIONS && tracing.casts(scene, bsdf, surface.at.point) {
            (self.0 / cosine.abs(), tracing.casters.pdf_area(scene, hit, cosine > 0.0))
        } else {
            return Link::default();
        };
        if so_far.is_finite() && pdf_area.is_finite() { Link { so_far, pdf_area } } else { Link::default() }
    }
}

impl Link {
    /// At a vertex, for light from a direction that is no mirrored one.
    #[inline]
    pub fn ratio(&self, vertex: &Vertex<'_>, wi: Vector3) -> Ratio {
        if self.pdf_area == 0.0 {
            return Ratio(0.0);
        }
        self.with(vertex.guided.bsdf.pdf_solid_angle(wi, vertex.wo))
    }
    fn with(&self, pdf_back: f32) -> Ratio {
        let ratio = self.so_far * self.pdf_area * pdf_back;
        Ratio(if ratio.is_finite() { ratio } else { 0.0 })
    }
    /// Where a path goes on from a vertex by a sample of the BSDF: of what light comes straight from there, and of the
    /// rest.
    #[inline(always)]
    pub fn onwards(&self, vertex: &Vertex<'_>, sample: &BsdfSample) -> (Ratio, Chain) {
        if self.so_far == 0.0 { (Ratio(0.0), Chain(0.0)) } else { self.continued(vertex, sample) }
    }
    #[inline(never)]
    fn continued(
        &self,
        Vertex { surface, guided, wo, bounce, .. }: &Vertex<'_>,
        sample: &BsdfSample,
    ) -> (Ratio, Chain) {
        let pdf_back = match sample.lobe {
            // the camera is not joined to a mirror, and what is lifted comes back another way
            LobeKind::Delta if *bounce == 0 || guided.bsdf.lifts(*wo) => 0.0,
            _ if *bounce == 0 => 1.0,
            LobeKind::Delta => sample.pdf_solid_angle,
            LobeKind::Diffuse | LobeKind::Glossy => guided.bsdf.pdf_solid_angle(sample.wi, *wo),
        };
        let chain = self.so_far * sample.wi.dot_normal(surface.at.normal).abs() * pdf_back / sample.pdf_solid_angle;
        (self.with(pdf_back), Chain(if chain.is_finite() { chain } else { 0.0 }))
    }
}
