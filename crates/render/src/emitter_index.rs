//! From a hit to the light that its triangle belongs to.

use umber_bvh::Hit;

use crate::numbering::Numbering;

/// Which light a hit belongs to.
#[derive(Debug, Default)]
pub struct EmitterIndex {
    numbering: Numbering,
    /// By mesh: `None` where it does not emit, else whether its glow is seen whatever its light shines.
    kinds: Vec<Option<bool>>,
    /// Light by number; [`NO_LIGHT`] where there is none to choose.
    lights: Vec<u32>,
}

/// No light.
const NO_LIGHT: u32 = u32::MAX;

/// What emits at a hit.
#[derive(Clone, Copy, Debug)]
pub struct FoundEmitter {
    /// Its light, unless that shines nothing.
    pub light: Option<u32>,
    /// Whether camera and mirrors see the material's glow, whatever the light shines.
    pub glows: bool,
}

impl EmitterIndex {
    /// Of meshes by their index.
    pub fn new(numbering: Numbering, kinds: Vec<Option<bool>>) -> Self {
        Self { numbering, kinds, lights: Vec::new() }
    }
    /// Says which light is the next number's.
    pub fn push_light(&mut self, light: Option<u32>) {
        self.lights.push(light.unwrap_or(NO_LIGHT));
    }
    /// What emits at a hit; `None` where nothing does.
    #[inline]
    pub fn find(&self, hit: &Hit) -> Option<FoundEmitter> {
        let glows = (*self.kinds.get(hit.mesh as usize)?)?;
        let light = *self.lights.get(self.numbering.number(&hit.path) as usize)?;
        Some(FoundEmitter { light: (light != NO_LIGHT).then_some(light), glows })
    }
}
