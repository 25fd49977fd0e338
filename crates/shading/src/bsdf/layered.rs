//! A clear coat over a specular lobe over a Lambertian base.
//!
//! The layers share the light so that none is created and reciprocity holds: what lies under a lobe of
//! reflectance `E` is scaled by `(1 − E(wo)) (1 − E(wi))`; the Lambertian also by `1 / (1 − E mean)`, which gives
//! back what bounces between the two (Kelemen & Szirmay-Kalos 2001, "A Microfacet Based Coupled
//! Specular-Matte BRDF Model"). All vectors are local, and above the surface.

use glam::{Vec2, Vec3};
use umber_math::{Rgb, Vector3};
use umber_sampling::warp;

use super::ggx::Ggx;
use super::{BsdfEval, LobeKind};

/// The lobes of a surface: UsdPreviewSurface's, each optional.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layered {
    /// Albedo of the Lambertian base.
    pub diffuse: Rgb,
    pub specular: Option<Ggx>,
    pub coat: Option<Coat>,
    /// `1 / (1 − mean reflectance of the specular lobe)`.
    diffuse_scale: Rgb,
}

/// A clear coat: a lobe and how much of it there is, 0 … 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coat {
    pub lobe: Ggx,
    pub weight: f32,
}

/// A sampled direction of local space.
pub(crate) struct LocalSample {
    pub eval: BsdfEval,
    pub wi: Vector3,
    pub lobe: LobeKind,
}

/// Probabilities of choosing each lobe; they sum to one, or are all zero.
#[derive(Clone, Copy)]
struct Choice {
    diffuse: f32,
    specular: f32,
    coat: f32,
}

/// What one viewing direction decides.
struct View {
    choice: Choice,
    /// What of the light passes the coat towards the viewer.
    under_coat: Rgb,
    /// What of the light passes the specular lobe towards the viewer.
    under_specular: Rgb,
}

impl Layered {
    pub fn new(diffuse: Rgb, specular: Option<Ggx>, coat: Option<Coat>) -> Self {
        let diffuse_scale = match specular {
            Some(lobe) if !diffuse.is_black() => {
                let left = Vec3::ONE - lobe.average_albedo().0;
                Rgb(Vec3::select(left.cmpgt(Vec3::splat(1e-4)), left.recip(), Vec3::ZERO))
            }
            _ => Rgb::WHITE,
        };
        Self { diffuse, specular, coat, diffuse_scale }
    }
    pub fn is_black(&self) -> bool {
        self.diffuse.is_black() && self.specular.is_none() && self.coat.is_none()
    }
    /// How many lobes there are.
    pub fn lobe_count(&self) -> usize {
        usize::from(!self.diffuse.is_black()) + usize::from(self.specular.is_some()) + usize::from(self.coat.is_some())
    }
    /// Of the microfacet lobes.
    pub fn widths(&self) -> impl Iterator<Item = f32> {
        self.specular.map(|s| s.alpha).into_iter().chain(self.coat.map(|c| c.lobe.alpha))
    }
    pub fn has_non_delta(&self) -> bool {
        !self.diffuse.is_black()
            || self.specular.is_some_and(|s| !s.is_delta())
            || self.coat.is_some_and(|c| !c.lobe.is_delta())
    }
    /// Fraction of a white environment reflected by all lobes, an estimate.
    pub fn albedo(&self, cos: f32) -> Rgb {
        let under_coat = self.under_coat(cos);
        let specular = self.specular.map_or(Rgb::BLACK, |s| s.albedo(cos));
        let coat = self.coat.map_or(Rgb::BLACK, |c| c.lobe.albedo(cos) * c.weight);
        // A specular lobe reflects light of about the viewer's angle, the base of any.
        let under_coat_mean = self.coat.map_or(Rgb::WHITE, |c| Rgb::WHITE - c.lobe.average_albedo() * c.weight);
        let base = specular * under_coat + self.diffuse * self.under_specular(cos) * under_coat_mean;
        coat + base * under_coat
    }
    /// What of the light passes the coat in a direction.
    #[inline]
    fn under_coat(&self, cos: f32) -> Rgb {
        self.coat.map_or(Rgb::WHITE, |c| Rgb::WHITE - c.lobe.albedo(cos) * c.weight)
    }
    /// What of the light passes the specular lobe in a direction.
    #[inline]
    fn under_specular(&self, cos: f32) -> Rgb {
        self.specular.map_or(Rgb::WHITE, |s| Rgb::WHITE - s.albedo(cos))
    }
    #[inline]
    fn view(&self, wo: Vector3) -> View {
        let alone = |diffuse, specular, coat| View {
            choice: Choice { diffuse, specular, coat },
            under_coat: Rgb::WHITE,
            under_specular: Rgb::WHITE,
        };
        match (self.diffuse.is_black(), self.specular, self.coat) {
            (true, Some(_), None) => return alone(0.0, 1.0, 0.0),
            (true, None, Some(_)) => return alone(0.0, 0.0, 1.0),
            (false, None, None) => return alone(1.0, 0.0, 0.0),
            _ => {}
        }
        let (under_coat, under_specular) = (self.under_coat(wo.z()), self.under_specular(wo.z()));
        let coat = (Rgb::WHITE - under_coat).max_channel();
        let specular = (Rgb::WHITE - under_specular).max_channel() * (1.0 - coat);
        let diffuse = if self.diffuse.is_black() {
            0.0
        } else {
            // Never zero: a lobe that is there must be reached.
            (self.diffuse * under_specular).max_channel().max(1e-3) * (1.0 - coat).max(1e-3)
        };
        let sum = diffuse + specular + coat;
        let scale = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        let choice = Choice { diffuse: diffuse * scale, specular: specular * scale, coat: coat * scale };
        View { choice, under_coat, under_specular }
    }
    /// Values and density of the lobes that are not delta.
    pub fn eval(&self, wo: Vector3, wi: Vector3) -> BsdfEval {
        self.eval_with(wo, wi, &self.view(wo))
    }
    fn eval_with(&self, wo: Vector3, wi: Vector3, view: &View) -> BsdfEval {
        let (mut out, choice) = (BsdfEval::default(), view.choice);
        let has_base = choice.diffuse + choice.specular > 0.0;
        let under_coat = if has_base { view.under_coat * self.under_coat(wi.z()) } else { Rgb::BLACK };
        if !self.diffuse.is_black() {
            let left = view.under_specular * self.under_specular(wi.z()) * self.diffuse_scale;
            out.diffuse = self.diffuse * left * under_coat * std::f32::consts::FRAC_1_PI;
            out.pdf_solid_angle += choice.diffuse * warp::cosine_hemisphere_pdf_solid_angle(wi.z());
        }
        if let Some(lobe) = self.specular.filter(|s| !s.is_delta()) {
            let (f, pdf) = lobe.eval(wo, wi);
            out.glossy += f * under_coat;
            out.pdf_solid_angle += choice.specular * pdf;
        }
        if let Some(coat) = self.coat.filter(|c| !c.lobe.is_delta()) {
            let (f, pdf) = coat.lobe.eval(wo, wi);
            out.glossy += f * coat.weight;
            out.pdf_solid_angle += choice.coat * pdf;
        }
        out
    }
    /// A direction of one of the lobes; for a delta lobe value over cosine, and its probability as density.
    pub fn sample(&self, wo: Vector3, u_lobe: f32, u: Vec2) -> Option<LocalSample> {
        let view = self.view(wo);
        let choice = view.choice;
        let (wi, lobe) = if u_lobe < choice.diffuse {
            (warp::cosine_hemisphere(u), LobeKind::Diffuse)
        } else {
            let coat = self.coat.filter(|_| u_lobe >= choice.diffuse + choice.specular && choice.coat > 0.0);
            let (lobe, weight, pmf) = match (coat, self.specular) {
                (Some(c), _) => (c.lobe, Rgb::splat(c.weight), choice.coat),
                (None, Some(s)) => (s, view.under_coat * view.under_coat, choice.specular),
                (None, None) => return None,
            };
            if lobe.is_delta() {
                let glossy = lobe.fresnel(wo.z()) * weight * (1.0 / wo.z());
                let eval = BsdfEval { diffuse: Rgb::BLACK, glossy, pdf_solid_angle: pmf };
                let wi = Vector3::new(-wo.x(), -wo.y(), wo.z());
                return (pmf > 0.0).then_some(LocalSample { eval, wi, lobe: LobeKind::Delta });
            }
            (lobe.sample(wo, u)?, LobeKind::Glossy)
        };
        let eval = self.eval_with(wo, wi, &view);
        (wi.z() > 0.0 && eval.pdf_solid_angle > 0.0).then_some(LocalSample { eval, wi, lobe })
    }
}
