//! Materials: what makes a BSDF at a surface point.

use umber_math::{Frame, Normal3, Rgb};

use crate::{Bsdf, Lobes, PreviewSurface};

/// A material.
#[derive(Clone, Debug)]
pub enum Material {
    /// UsdPreviewSurface.
    Preview(PreviewSurface),
    /// What shows where nothing is bound: a Lambertian of the displayColor, present by the displayOpacity.
    Display {
        /// Albedo, clamped to 0 … 1 in use.
        color: Rgb,
        /// Probability that a ray meets the surface, 0 … 1.
        opacity: f32,
    },
}

impl Default for Material {
    /// Grey of 18 %.
    fn default() -> Self {
        Self::Display { color: Rgb::splat(0.18), opacity: 1.0 }
    }
}

impl Material {
    /// The lobes alone: the same over the whole surface while inputs are constant, so made once for many points.
    pub fn lobes(&self) -> Lobes {
        match self {
            Self::Preview(p) => p.lobes(),
            Self::Display { color, .. } => Lobes::lambert(*color),
        }
    }
    /// The BSDF at a point; frame and geometric normal in render space, unit.
    pub fn bsdf(&self, frame: Frame, ng: Normal3) -> Bsdf {
        Bsdf::new(self.lobes(), frame, ng)
    }
    /// Emitted radiance, finite and not negative.
    pub fn emission(&self) -> Rgb {
        match self {
            Self::Preview(p) => p.emission(),
            Self::Display { .. } => Rgb::BLACK,
        }
    }
    /// Probability that a ray meets the surface instead of passing straight through, 0 … 1.
    pub fn presence(&self) -> f32 {
        match self {
            Self::Preview(p) => p.presence(),
            Self::Display { opacity, .. } => crate::bsdf::unit(*opacity),
        }
    }
}
