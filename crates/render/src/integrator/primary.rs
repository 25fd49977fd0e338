//! What a ray from the camera meets.

use umber_math::{Ray, Rgb};
use umber_sampling::Sampler;

use super::path::{Vertex, Walk};
use crate::scene::RenderScene;

/// A ray from the camera, followed to where paths go on from.
pub(crate) struct Primary<'a> {
    /// A path that has not gone on yet.
    pub(super) walk: Walk<'a>,
    /// Radiance against the ray of what shines by itself.
    pub emitted: Rgb,
    /// 1 where anything is seen, 0 where nothing is.
    pub coverage: f32,
    /// Where paths go on, if anywhere.
    pub first: Option<Vertex<'a>>,
}

impl<'a> Primary<'a> {
    /// Follows a ray.
    #[inline]
    pub fn new(scene: &'a RenderScene, ray: Ray, sampler: &mut Sampler, rays: &mut u64) -> Self {
        let walk = Walk::new(scene, ray);
        let met = walk.meet(sampler, rays);
        let (emitted, coverage) = walk.seen(&met);
        Self { walk, emitted, coverage, first: walk.vertex(&met) }
    }
}
