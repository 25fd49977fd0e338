//! Materials as rays meet them.

use umber_math::Rgb;
use umber_shading::Lobes;

/// A material with constant inputs, made once for all its points.
#[derive(Clone, Debug)]
pub struct RenderMaterial {
    /// Lobes; `None`: those of the mesh's displayColor.
    pub lobes: Option<Lobes>,
    /// Emitted radiance.
    pub emission: Rgb,
    /// Probability that a ray meets the surface instead of passing straight through.
    pub presence: f32,
}
