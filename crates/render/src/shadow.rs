//! Shadows that have a colour or do not reach far (`UsdLuxShadowAPI`).

use umber_math::{Ray, Rgb};
use umber_shading::ShadowShape;

use crate::linking::Links;
use crate::scene::RenderScene;

/// What is left of the light that comes along a shadow ray from light `target`, by the nearest occluder's
/// distance. The ray's direction is unit. Counts rays.
pub fn visibility(
    scene: &RenderScene,
    shape: &ShadowShape,
    mut ray: Ray,
    target: u32,
    links: Links,
    rays: &mut u64,
) -> Rgb {
    ray.t_max = ray.t_max.min(shape.distance);
    let other_light = scene.nearest_casting_shape(&ray, target, links);
    ray.t_max = other_light.unwrap_or(ray.t_max);
    // The chance that nothing met so far was there, and the shadow to expect.
    let (mut open, mut shadowed) = (1.0, 0.0);
    scene.occluders(ray, target, rays, |t, presence| {
        shadowed += open * presence * shape.strength(t);
        open *= 1.0 - presence;
        open > 0.0
    });
    if let Some(t) = other_light {
        shadowed += open * shape.strength(t);
    }
    shape.tint(shadowed)
}
