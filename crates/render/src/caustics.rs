//! Caustics: where smooth surfaces throw light on rough ones, and how paths from the camera are led to find them.
//!
//! A path that leaves a rough surface in any direction seldom finds the small bright reflection of a light in a smooth
//! one, and counts much where it does: white dots that take long to average out. What the camera sees of caustics is
//! made from the other end ([`crate::light_tracing`]). What it sees of them in other surfaces is left to paths from the
//! camera: where the first light paths landed it is kept from where on the smooth surface they came ([`map`]), and a
//! path that leaves a rough surface there aims at such a place now and then ([`aim`]), by one-sample multiple
//! importance sampling (Veach & Guibas 1995, "Optimally Combining Sampling Techniques for Monte Carlo Rendering"): any
//! map gives the right mean, a good one gives it sooner. Jensen 1995, "Importance Driven Path Tracing using the Photon
//! Map", keeps directions; places hold beside the point where they were learnt, too.

mod aim;
mod map;

use umber_settings::{Integrator, Settings};

use crate::material::RenderMaterial;

pub(crate) use aim::Guided;
pub(crate) use map::CausticMap;

/// Whether there may be any.
pub(crate) fn are_possible(settings: &Settings, materials: &[RenderMaterial]) -> bool {
    settings.light_tracing
        && settings.integrator == Integrator::Path
        && settings.max_bounces >= 2
        && materials.iter().any(|material| material.lobes.is_some_and(|lobes| lobes.focuses()))
}
