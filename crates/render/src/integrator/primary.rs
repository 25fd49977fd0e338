//! What a ray from the camera meets.

use umber_math::{Ray, Rgb, Vec2};
use umber_sampling::Sampler;

use super::found::Met;
use super::path::{Vertex, Walk};
use super::splitting::Splitting;
use super::{RadianceSample, dimensions, tile};
use crate::scene::RenderScene;

/// A ray from the camera, or several through a pixel, followed to where paths go on from.
pub(crate) struct Primary<'a> {
    /// Radiance against the ray of what shines by itself.
    pub emitted: Rgb,
    /// 1 where anything is seen, 0 where nothing is; the mean of several rays.
    pub coverage: f32,
    /// A path that has not gone on yet, and where it does, if anywhere.
    pub(super) first: Option<(Walk<'a>, Vertex<'a>)>,
    /// How much what it finds counts.
    share: f32,
}

impl<'a> Primary<'a> {
    /// Follows a ray.
    #[inline]
    pub fn new(scene: &'a RenderScene, ray: Ray, sampler: &mut Sampler, rays: &mut u64) -> Self {
        let walk = Walk::new(scene, ray);
        let met = walk.meet(sampler, rays);
        let (emitted, coverage) = walk.seen(&met);
        Self { emitted, coverage, first: walk.vertex(&met).map(|vertex| (walk, vertex)), share: 1.0 }
    }

    /// Follows what a pixel's samples begin with that share their rays, of which number `number` is one: one ray, or
    /// where edges run through the pixel, so many for each of them. `draw` gives the points of a sample or of a ray by
    /// number.
    pub fn of_samples(
        scene: &'a RenderScene,
        pixel: Vec2,
        number: u32,
        splitting: Splitting,
        draw: impl Fn(u32) -> Sampler,
        rays: &mut u64,
    ) -> Self {
        let begin = |number| {
            let mut sampler = draw(number);
            sampler.start_dimension(dimensions::FILM);
            (scene.camera.ray(pixel + sampler.next_2d()), sampler)
        };
        let (group, first) = (splitting.group(number), splitting.ray(number));
        let edge_rays = scene.edges.as_ref().map_or(0, |edges| edges.rays([pixel.x as usize, pixel.y as usize]));
        if edge_rays * group.len() as u32 <= 1 {
            let (ray, mut sampler) = begin(first);
            return Self::new(scene, ray, &mut sampler, rays);
        }
        let mut choice = draw(first);
        choice.start_dimension(dimensions::RAY_CHOICE);
        let numbers = group.start * edge_rays..group.end * edge_rays;
        Self::of_many(scene, numbers.map(begin), choice.next_1d(), rays)
    }

    /// The sample of a path that reflects a radiance where it goes on.
    #[inline]
    pub fn sample(&self, reflected: Rgb) -> RadianceSample {
        RadianceSample { radiance: self.emitted + reflected * self.share, coverage: self.coverage }
    }

    /// Follows several rays. What shines by itself is their mean; paths go on from a surface that one of them met, each
    /// with the same chance, and count by how many met one. `choice` is in [0, 1).
    fn of_many(
        scene: &'a RenderScene,
        begun: impl ExactSizeIterator<Item = (Ray, Sampler)>,
        choice: f32,
        rays: &mut u64,
    ) -> Self {
        let count = begun.len() as f32;
        let mut surfaces = Vec::with_capacity(begun.len());
        let (mut emitted, mut coverage) = (Rgb::BLACK, 0.0);
        for (ray, mut sampler) in begun {
            let walk = Walk::new(scene, ray);
            let met = walk.meet(&mut sampler, rays);
            let seen = walk.seen(&met);
            // one ray is not to spoil the others
            emitted += tile::kept(scene, seen.0);
            coverage += seen.1;
            if matches!(met, Met::Surface(..)) {
                surfaces.push((walk, met));
            }
        }
        let chosen = surfaces.get((choice * surfaces.len() as f32) as usize);
        let first = chosen.and_then(|(walk, met)| Some((*walk, walk.vertex(met)?)));
        let share = surfaces.len() as f32 / count;
        Self { emitted: emitted * (1.0 / count), coverage: coverage / count, first, share }
    }
}
