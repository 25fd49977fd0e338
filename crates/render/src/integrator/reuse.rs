//! Paths that neighbouring pixels share: each pixel takes the light that all of a group found.
//!
//! Of two paths that leave neighbouring points of a surface, each could have met what the other met second, and most
//! of a path's cost lies behind that. So the pixels of a group each trace one path, and the first surface point of
//! each is joined to the second ones of all others that it sees (Bekaert, Sbert & Halton 2002, "Accelerating Path
//! Tracing by Re-Using Paths"): for the rays of one path more, a pixel has light from as many directions as the group
//! has pixels.
//!
//! All members are techniques that could have made the same second point; each counts by its density over the sum of
//! all (Veach's balance heuristic), of which those that do not see the point are no part. So there is no bias, and
//! where neighbours have little in common, at an edge or a narrow reflection, a pixel's own path counts nearly alone.
//! The directions from the second point on are weighed likewise, and so are light samples there against the rays that
//! find the same light, which keeps narrow lobes there from making bright specks. What the first point gets straight
//! from lights, what shines by itself at the second, and what leaves either by a perfect mirror stays the pixel's own.
//!
//! A tile's pixels make other groups every few samples ([`groups`]), so that no pattern of them shows. How large they
//! are is decided once a picture by what paths of its own show ([`gain`]): in light that comes straight there is
//! nothing to share.

mod gain;
mod groups;
mod share;
#[cfg(test)]
mod tests;
mod trace;

use umber_settings::{Integrator, Settings};

use super::tile;
use crate::light_set::LightSet;

pub(crate) use gain::best_group;
pub(super) use groups::{Groups, runs};
pub(super) use share::share;
pub(crate) use trace::is_shared;
pub(super) use trace::{Path, trace};

/// Most pixels of a group.
pub(super) const LARGEST_GROUP: usize = 16;
/// Whether paths may be shared.
pub(crate) fn is_possible(settings: &Settings, lights: &LightSet) -> bool {
    // what a lobe gets of such a light is not what another one gets: it cannot be handed on
    let tells_lobes_apart = |light: &umber_shading::Light| light.diffuse() != light.specular();
    settings.path_reuse
        && settings.integrator == Integrator::Path
        && settings.max_bounces >= 2
        && settings.converged_samples_per_pixel >= tile::MANY_SAMPLES
        && !lights.lights().iter().any(tells_lobes_apart)
}
