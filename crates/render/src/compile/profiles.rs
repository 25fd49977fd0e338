//! IES profiles of lights, read once.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use umber_scene::{Light, LightId, Shaping};
use umber_shading::{IesParams, IesProfile, ShapingParams};

/// Keeps the profiles that lights use.
#[derive(Debug, Default)]
pub struct Profiles {
    /// By file; `None` where it could not be read.
    files: HashMap<PathBuf, Option<Arc<IesProfile>>>,
}

impl Profiles {
    /// Forgets the files that no light uses.
    pub fn retain_used<'l>(&mut self, lights: impl Iterator<Item = &'l Light> + Clone) {
        self.files.retain(|file, _| lights.clone().any(|l| l.shaping.ies_file.as_ref() == Some(file)));
    }

    /// A light's shaping, its profile read. Without one that can be used, the rest of it holds.
    pub fn shaping(&mut self, id: &LightId, shaping: &Shaping, warn: &mut dyn FnMut(&str, String)) -> ShapingParams {
        let profile = shaping.ies_file.as_ref().and_then(|file| self.profile(id, file, warn));
        ShapingParams {
            focus: shaping.focus,
            focus_tint: shaping.focus_tint,
            cone_angle_deg: shaping.cone_angle_deg,
            cone_softness: shaping.cone_softness,
            ies: profile.map(|profile| IesParams {
                profile,
                angle_scale: shaping.ies_angle_scale,
                normalize: shaping.ies_normalize,
            }),
        }
    }

    fn profile(&mut self, id: &LightId, file: &PathBuf, warn: &mut dyn FnMut(&str, String)) -> Option<Arc<IesProfile>> {
        if let Some(known) = self.files.get(file) {
            return known.clone();
        }
        let loaded = match IesProfile::load(file) {
            Ok(profile) => Some(Arc::new(profile)),
            Err(error) => {
                warn(id.path(), format!("its IES profile is left out: {error}"));
                None
            }
        };
        self.files.insert(file.clone(), loaded.clone());
        loaded
    }
}
