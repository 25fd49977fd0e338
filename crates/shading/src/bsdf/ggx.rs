//! GGX microfacets with separable Smith masking and shadowing and Schlick's Fresnel, isotropic, reflection only.
//!
//! Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces" (distribution, and masking times
//! shadowing: the form that other renderers of UsdPreviewSurface have, Mitsuba's `principled` among them); Dupuy & Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps".
//! All vectors are local: z is the shading normal. Single scattering: rough surfaces lose energy.

use std::f32::consts::PI;

use glam::Vec2;
use umber_math::{Rgb, Vector3};

use super::energy;

/// Widths below this reflect like a perfect mirror (a roughness of about 0.03).
///
/// A lobe that narrow is a third of a degree across: single precision no longer resolves its density well.
pub const DELTA_ALPHA: f32 = 1e-3;

/// A specular lobe: GGX of a width, Fresnel from `f0` at normal incidence to white at grazing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ggx {
    pub f0: Rgb,
    /// Zero for a perfect mirror, else at least [`DELTA_ALPHA`].
    pub alpha: f32,
    /// Where the width lies among the rows of the energy table.
    pub(super) energy_row: f32,
}

impl Ggx {
    /// `None` where `f0` is black: no specular reflection at all.
    pub fn new(f0: Rgb, roughness: f32) -> Option<Self> {
        let alpha = roughness * roughness;
        let alpha = if alpha < DELTA_ALPHA { 0.0 } else { alpha.min(1.0) };
        (!f0.is_black()).then(|| Self { f0, alpha, energy_row: energy::row_of(alpha) })
    }
    #[inline]
    pub fn is_delta(&self) -> bool {
        self.alpha == 0.0
    }
    /// Fresnel reflectance. Schlick 1994.
    #[inline]
    pub fn fresnel(&self, cos: f32) -> Rgb {
        let s = schlick_weight(cos);
        Rgb(self.f0.0 + (glam::Vec3::ONE - self.f0.0) * s)
    }
    /// Value and density by solid angle of a non-delta lobe. Both directions above the surface.
    #[inline]
    pub fn eval(&self, wo: Vector3, wi: Vector3) -> (Rgb, f32) {
        let h = (wo + wi).normalized();
        let d = distribution(h, self.alpha);
        let (lambda_o, lambda_i) = (lambda(wo, self.alpha), lambda(wi, self.alpha));
        let f = d / (4.0 * wo.z() * wi.z() * (1.0 + lambda_o) * (1.0 + lambda_i));
        let pdf = d / (4.0 * wo.z() * (1.0 + lambda_o));
        let value = self.fresnel(wi.dot(h)) * f;
        if pdf.is_finite() && value.is_finite() { (value, pdf) } else { (Rgb::BLACK, 0.0) }
    }
    /// A direction with the density that [`Ggx::eval`] gives; `None` where it falls below the surface.
    #[inline]
    pub fn sample(&self, wo: Vector3, u: Vec2) -> Option<Vector3> {
        let h = visible_normal(wo, self.alpha, u);
        let wi = h * (2.0 * wo.dot(h)) - wo;
        (wi.z() > 0.0).then(|| wi.normalized())
    }
}

/// `(1 − cos)⁵`.
#[inline]
pub(crate) fn schlick_weight(cos: f32) -> f32 {
    let m = (1.0 - cos).clamp(0.0, 1.0);
    let m2 = m * m;
    m2 * m2 * m
}

/// The distribution of normals, by solid angle, from the tangential part of `h`: exact for narrow lobes too.
#[inline]
pub(crate) fn distribution(h: Vector3, alpha: f32) -> f32 {
    let a2 = alpha * alpha;
    let t = h.x() * h.x() + h.y() * h.y() + h.z() * h.z() * a2;
    a2 / (PI * t * t)
}

/// Smith's Λ.
#[inline]
pub(crate) fn lambda(w: Vector3, alpha: f32) -> f32 {
    let tan2 = (w.x() * w.x() + w.y() * w.y()) / (w.z() * w.z());
    0.5 * ((1.0 + alpha * alpha * tan2).sqrt() - 1.0)
}

/// A normal with density proportional to what of it `wo` sees.
#[inline]
pub(crate) fn visible_normal(wo: Vector3, alpha: f32, u: Vec2) -> Vector3 {
    let stretched = Vector3::new(wo.x() * alpha, wo.y() * alpha, wo.z()).normalized();
    let (sin_phi, cos_phi) = (2.0 * PI * u.x).sin_cos();
    let z = (1.0 - u.y) * (1.0 + stretched.z()) - stretched.z();
    let r = (1.0 - z * z).max(0.0).sqrt();
    let h = Vector3::new(r * cos_phi, r * sin_phi, z) + stretched;
    Vector3::new(h.x() * alpha, h.y() * alpha, h.z().max(0.0)).normalized()
}
