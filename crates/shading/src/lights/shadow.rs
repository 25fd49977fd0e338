//! Shadows that are not black, or do not reach far (`UsdLuxShadowAPI`, OpenUSD 25.08).

use umber_math::Rgb;

use super::params::LightProblem;

/// What a host says of a light's shadows; the default is black ones without end.
#[derive(Clone, Copy, Debug)]
pub struct ShadowParams {
    /// `inputs:shadow:color`, scene-linear.
    pub color: Rgb,
    /// `inputs:shadow:distance`, world units; negative for no limit.
    pub distance: f32,
    /// `inputs:shadow:falloff`, world units.
    pub falloff: f32,
    /// `inputs:shadow:falloffGamma`.
    pub falloff_gamma: f32,
}

impl Default for ShadowParams {
    fn default() -> Self {
        Self { color: Rgb::BLACK, distance: -1.0, falloff: -1.0, falloff_gamma: 1.0 }
    }
}

/// Shadows unlike those of nature. What light samples say of them, no ray that meets the light could.
#[derive(Clone, Copy, Debug)]
pub struct ShadowShape {
    color: Rgb,
    /// From a surface to what shadows it: up to here fully, …
    full: f32,
    /// … and beyond this not at all. World units, maybe infinite.
    pub distance: f32,
    gamma: f32,
}

impl ShadowShape {
    /// `None` for shadows as they are in nature.
    pub(crate) fn new(p: &ShadowParams, problems: &mut Vec<LightProblem>) -> Option<Self> {
        let default = ShadowParams::default();
        let mut usable = |v: f32, name: &'static str, otherwise: f32| {
            if v.is_finite() {
                return v;
            }
            problems.push(LightProblem::Ignored(name));
            otherwise
        };
        // A reach that is infinite says what it means.
        let distance =
            if p.distance == f32::INFINITY { -1.0 } else { usable(p.distance, "shadow:distance", default.distance) };
        let falloff = usable(p.falloff, "shadow:falloff", default.falloff);
        let mut gamma = usable(p.falloff_gamma, "shadow:falloffGamma", default.falloff_gamma);
        let mut color = p.color.0.to_array().map(|c| usable(c, "shadow:color", 0.0));
        let mut positive = |v: &mut f32, name: &'static str| {
            if *v < 0.0 {
                *v = 0.0;
                problems.push(LightProblem::Negative(name));
            }
        };
        positive(&mut gamma, "shadow:falloffGamma");
        color.iter_mut().for_each(|c| positive(c, "shadow:color"));
        problems.dedup();
        let distance = if distance < 0.0 { f32::INFINITY } else { distance };
        let full = if falloff > 0.0 && distance.is_finite() { (distance - falloff).max(0.0) } else { distance };
        let color = Rgb::from(color);
        let is_natural = color.is_black() && distance == f32::INFINITY;
        (!is_natural).then_some(Self { color, full, distance, gamma })
    }
    /// How much an occluder shadows a surface at this distance from it, 0 to 1.
    #[inline]
    pub fn strength(&self, distance: f32) -> f32 {
        if distance <= self.full && distance < self.distance {
            1.0
        } else if distance < self.distance {
            ((self.distance - distance) / (self.distance - self.full)).powf(self.gamma)
        } else {
            0.0
        }
    }
    /// The factor on the light where it is shadowed by so much.
    #[inline]
    pub fn tint(&self, shadowed: f32) -> Rgb {
        Rgb::WHITE.lerp(self.color, shadowed)
    }
}
