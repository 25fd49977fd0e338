//! Direct light: the path integrator, ended after one scattering.
//!
//! What a surface emits is seen, and light that reaches it straight from a light, by light samples and by samples of
//! the BSDF, weighted against each other. No loop of its own: at one bounce, that is what a path is.

use umber_settings::Settings;

/// The settings by which the path integrator gives direct light alone.
pub fn settings(given: &Settings) -> Settings {
    Settings { max_bounces: given.max_bounces.min(1), ..given.clone() }
}
