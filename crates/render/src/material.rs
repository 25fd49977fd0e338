//! Materials as rays meet them.

use umber_math::Rgb;
use umber_shading::Lobes;

/// A material with constant inputs, made once for all its points.
#[derive(Clone, Debug)]
pub struct RenderMaterial {
    /// Lobes; `None`: those of the mesh's displayColor.
    pub lobes: Option<Lobes>,
    /// Colour by which a rasteriser shows it, each channel between 0 and 1; `None`: the mesh's displayColor.
    pub base_color: Option<Rgb>,
    /// Emitted radiance.
    pub emission: Rgb,
    /// Probability that a ray meets the surface instead of passing straight through.
    pub presence: f32,
}

/// A colour with each channel between 0 and 1; what is not a number becomes 0.
pub fn in_unit(color: Rgb) -> Rgb {
    // of a number and what is none, `max` gives the number, while `clamp` gives none
    #[allow(clippy::manual_clamp)]
    let unit = |v: f32| v.max(0.0).min(1.0);
    Rgb(color.0.to_array().map(unit).into())
}
