//! Reflection at a surface point.
//!
//! [`Bsdf`] goes from render to local space; the lobes in this folder see local vectors only.

mod energy;
mod ggx;
mod layered;

use std::f32::consts::FRAC_1_PI;

use glam::Vec2;
use umber_math::{Frame, Normal3, Rgb, Vector3};
use umber_sampling::warp;

pub use ggx::DELTA_ALPHA;
pub(crate) use ggx::Ggx;
use layered::LocalSample;
pub(crate) use layered::{Coat, Layered};

/// What kind of lobe a sampled direction comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LobeKind {
    /// Lambertian.
    Diffuse,
    /// A microfacet lobe of some width.
    Glossy,
    /// A perfect mirror: no other technique can find its direction.
    Delta,
}

/// Value and density of a BSDF for a pair of directions, without its delta lobes.
#[derive(Clone, Copy, Debug, Default)]
pub struct BsdfEval {
    /// Value of the diffuse lobe, without the cosine.
    pub diffuse: Rgb,
    /// Value of the glossy lobes, without the cosine.
    pub glossy: Rgb,
    /// Density with which [`Bsdf::sample`] makes the direction.
    pub pdf_solid_angle: f32,
}

impl BsdfEval {
    /// The value of all lobes together, without the cosine.
    #[inline]
    pub fn f(&self) -> Rgb {
        self.diffuse + self.glossy
    }
}

/// A sampled direction.
///
/// The path's throughput changes by `f · cos_theta / pdf_solid_angle`, for delta lobes too.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// Value without the cosine; for a delta lobe its reflectance over the cosine.
    pub f: Rgb,
    /// The part of `f` that is diffuse (what a light's diffuse multiplier scales).
    pub f_diffuse: Rgb,
    /// Direction, render space, unit.
    pub wi: Vector3,
    /// Cosine between `wi` and the shading normal, positive.
    pub cos_theta: f32,
    /// Density of the whole BSDF; for a delta lobe the probability of having chosen it.
    pub pdf_solid_angle: f32,
    /// The lobe that was sampled.
    pub lobe: LobeKind,
}

/// The lobes of a surface, without a place or an orientation.
#[derive(Clone, Copy, Debug)]
pub struct Lobes(Kind);

#[derive(Clone, Copy, Debug)]
enum Kind {
    Lambert(Rgb),
    Layered(Layered),
}

impl Lobes {
    /// A Lambertian of the albedo, each channel clamped to 0 … 1, NaN to 0.
    pub fn lambert(albedo: Rgb) -> Self {
        Self(Kind::Lambert(unit_rgb(albedo)))
    }
    /// Whether a lobe is narrow: what it reflects of a small light is a caustic.
    #[inline]
    pub fn focuses(&self) -> bool {
        match &self.0 {
            Kind::Lambert(_) => false,
            Kind::Layered(layers) => layers.widths().any(|alpha| alpha < NARROW_ALPHA),
        }
    }
    /// The least that holds the lobes given.
    pub(crate) fn layered(diffuse: Rgb, specular: Option<Ggx>, coat: Option<Coat>) -> Self {
        match (specular, coat) {
            (None, None) => Self(Kind::Lambert(diffuse)),
            _ => Self(Kind::Layered(Layered::new(diffuse, specular, coat))),
        }
    }
}

/// Clamps each channel to 0 … 1; NaN becomes 0.
pub(crate) fn unit_rgb(c: Rgb) -> Rgb {
    Rgb(glam::Vec3::from(c.0.to_array().map(unit)))
}

/// Clamps to 0 … 1; NaN becomes 0.
pub(crate) fn unit(v: f32) -> f32 {
    // `max` and `min` pass over NaN, `clamp` does not.
    #[allow(clippy::manual_clamp)]
    v.max(0.0).min(1.0)
}

/// Widths of microfacet lobes below this show lights as small bright spots (a roughness of 0.45).
const NARROW_ALPHA: f32 = 0.2;

/// The least cosine of `wo` to the shading normal: an interpolated normal that faces away is taken as grazing.
const LEAST_COS_O: f32 = 1e-3;

/// Reflection at a surface point; two-sided and opaque.
///
/// `wo`'s side of the geometric normal is the outside: both normals are turned there. Light from the other side
/// contributes nothing, nor does light below the shading normal's horizon. Where `wo` itself lies below that
/// horizon (interpolated normals at a silhouette) it is lifted just above it, so that no black rim shows.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf {
    lobes: Lobes,
    frame: Frame,
    ng: Normal3,
}

impl Bsdf {
    /// From lobes, the shading frame and the geometric normal, in render space, unit; the normals may face either way.
    #[inline]
    pub fn new(lobes: Lobes, frame: Frame, ng: Normal3) -> Self {
        // The frame's normal decides nothing about sides; it follows the geometric one.
        let ng = if frame.normal.dot(ng) < 0.0 { -ng } else { ng };
        Self { lobes, frame, ng }
    }
    /// A Lambertian surface; the albedo is clamped to 0 … 1.
    #[inline]
    pub fn lambert(albedo: Rgb, frame: Frame, ng: Normal3) -> Self {
        Self::new(Lobes::lambert(albedo), frame, ng)
    }
    /// The value for a pair of directions, without the cosine and without delta lobes.
    #[inline]
    pub fn eval(&self, wo: Vector3, wi: Vector3) -> Rgb {
        self.evaluate(wo, wi).f()
    }
    /// Density with which [`Bsdf::sample`] makes `wi`, delta lobes left out.
    #[inline]
    pub fn pdf_solid_angle(&self, wo: Vector3, wi: Vector3) -> f32 {
        self.evaluate(wo, wi).pdf_solid_angle
    }
    /// Value and density together: costs half of asking for one after the other.
    #[inline]
    pub fn evaluate(&self, wo: Vector3, wi: Vector3) -> BsdfEval {
        match &self.lobes.0 {
            Kind::Lambert(albedo) => self.evaluate_lambert(*albedo, wo, wi),
            Kind::Layered(layers) => self.evaluate_layered(layers, wo, wi),
        }
    }
    #[inline]
    fn evaluate_lambert(&self, albedo: Rgb, wo: Vector3, wi: Vector3) -> BsdfEval {
        let Some(side) = self.side(wo) else { return BsdfEval::default() };
        let cos_theta = wi.dot_normal(self.frame.normal) * side;
        if !(wi.dot_normal(self.ng) * side > 0.0 && cos_theta > 0.0) || albedo.is_black() {
            return BsdfEval::default();
        }
        let pdf_solid_angle = warp::cosine_hemisphere_pdf_solid_angle(cos_theta);
        BsdfEval { diffuse: albedo * FRAC_1_PI, glossy: Rgb::BLACK, pdf_solid_angle }
    }
    fn evaluate_layered(&self, layers: &Layered, wo: Vector3, wi: Vector3) -> BsdfEval {
        let Some((side, wo_local)) = self.local_viewer(wo) else { return BsdfEval::default() };
        let wi_local = self.frame.to_local(wi) * side;
        if !(wi.dot_normal(self.ng) * side > 0.0 && wi_local.z() > 0.0) {
            return BsdfEval::default();
        }
        layers.eval(wo_local, wi_local)
    }
    /// Whether there are lobes to choose among: else [`Bsdf::sample`] does not use its `u_lobe`.
    #[inline]
    pub fn chooses_lobe(&self) -> bool {
        match &self.lobes.0 {
            Kind::Lambert(_) => false,
            Kind::Layered(layers) => layers.lobe_count() > 1,
        }
    }
    /// Chooses a lobe by `u_lobe` and a direction by `u`; `None` where the path ends (the direction falls below the
    /// surface).
    #[inline]
    pub fn sample(&self, wo: Vector3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        let (side, local) = match &self.lobes.0 {
            Kind::Lambert(albedo) => (self.side(wo)?, sample_lambert(*albedo, u)?),
            Kind::Layered(layers) => {
                let (side, wo_local) = self.local_viewer(wo)?;
                (side, layers.sample(wo_local, u_lobe, u)?)
            }
        };
        // unit but for rounding, as both are that it is made of
        let wi = self.frame.from_local(local.wi * side);
        (wi.dot_normal(self.ng) * side > 0.0).then_some(BsdfSample {
            f: local.eval.f(),
            f_diffuse: local.eval.diffuse,
            wi,
            cos_theta: local.wi.z(),
            pdf_solid_angle: local.eval.pdf_solid_angle,
            lobe: local.lobe,
        })
    }
    /// Cosine between a direction and the shading normal, without its sign.
    #[inline]
    pub fn cos_theta(&self, wi: Vector3) -> f32 {
        wi.dot_normal(self.frame.normal).abs()
    }
    /// Whether light sampling can find anything: some lobe is not a delta.
    #[inline]
    pub fn has_non_delta(&self) -> bool {
        match &self.lobes.0 {
            Kind::Lambert(albedo) => !albedo.is_black(),
            Kind::Layered(layers) => layers.has_non_delta(),
        }
    }
    /// Whether a lobe is narrow: what it reflects of a small light is a caustic.
    #[inline]
    pub fn focuses(&self) -> bool {
        self.lobes.focuses()
    }
    /// Whether a lobe is wide: caustics show on it.
    #[inline]
    pub fn scatters(&self) -> bool {
        self.is_wider_than(NARROW_ALPHA)
    }
    /// Whether a lobe is as wide as `alpha`; the diffuse one is as wide as any.
    #[inline]
    pub fn is_wider_than(&self, alpha: f32) -> bool {
        match &self.lobes.0 {
            Kind::Lambert(albedo) => !albedo.is_black(),
            Kind::Layered(layers) => !layers.diffuse.is_black() || layers.widths().any(|width| width >= alpha),
        }
    }
    /// Whether it reflects nothing at all.
    #[inline]
    pub fn is_black(&self) -> bool {
        match &self.lobes.0 {
            Kind::Lambert(albedo) => albedo.is_black(),
            Kind::Layered(layers) => layers.is_black(),
        }
    }
    /// Fraction of a white environment reflected towards `wo`: exact for a Lambertian, else to about a percent.
    pub fn albedo(&self, wo: Vector3) -> Rgb {
        match &self.lobes.0 {
            Kind::Lambert(albedo) => *albedo,
            Kind::Layered(layers) => self.local_viewer(wo).map_or(Rgb::BLACK, |(_, wo)| layers.albedo(wo.z())),
        }
    }
    /// On which side of the surface the viewer is, ±1. `None` for a viewer in the surface's plane, or NaN.
    #[inline]
    fn side(&self, wo: Vector3) -> Option<f32> {
        let cos_g = wo.dot_normal(self.ng);
        (cos_g.abs() > 0.0).then_some(1f32.copysign(cos_g))
    }
    /// Whether a direction lies below the shading normal's horizon, on its side of the surface, and is lifted as a
    /// viewer's.
    #[inline]
    pub fn lifts(&self, wo: Vector3) -> bool {
        self.side(wo).is_none_or(|side| wo.dot_normal(self.frame.normal) * side < LEAST_COS_O)
    }
    /// On which side of the surface the viewer is (±1; local vectors are mirrored through the origin for the back),
    /// and its local direction. `None` for a viewer in the surface's plane, or NaN.
    #[inline]
    fn local_viewer(&self, wo: Vector3) -> Option<(f32, Vector3)> {
        let side = self.side(wo)?;
        let local = self.frame.to_local(wo) * side;
        if local.z() >= LEAST_COS_O {
            return Some((side, local));
        }
        let lifted = Vector3::new(local.x(), local.y(), LEAST_COS_O).normalized();
        (lifted.z() > 0.0).then_some((side, lifted))
    }
}

#[inline]
fn sample_lambert(albedo: Rgb, u: Vec2) -> Option<LocalSample> {
    let wi = warp::cosine_hemisphere(u);
    let pdf_solid_angle = warp::cosine_hemisphere_pdf_solid_angle(wi.z());
    let eval = BsdfEval { diffuse: albedo * FRAC_1_PI, glossy: Rgb::BLACK, pdf_solid_angle };
    (pdf_solid_angle > 0.0 && !albedo.is_black()).then_some(LocalSample { eval, wi, lobe: LobeKind::Diffuse })
}
