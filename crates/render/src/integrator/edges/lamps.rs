//! Lights that are seen so small that rays through the corners of pixels may miss them.

use std::collections::BTreeMap;

use rayon::prelude::*;
use umber_math::Vec2;
use umber_shading::Light;

use super::lattice::{self, Seen};
use crate::film::FilmDesc;
use crate::integrator::Stop;
use crate::scene::RenderScene;

/// Pixels across and down of the largest lights that are looked for one by one.
const LARGEST: f32 = 4.0;

/// What is seen of small lights, through the middles of their boxes, by the number of each pixel that one may reach
/// into: of the brightest there. Of some lights alone, where stopped. Counts rays.
pub(super) fn find(scene: &RenderScene, film: &FilmDesc, stop: &Stop<'_>, rays: &mut u64) -> BTreeMap<usize, Seen> {
    let look = |light: &Light| {
        let [low, high] = extent(scene, light)?;
        let size = Vec2::new(film.width as f32, film.height as f32);
        let is_small = (high - low).max_element() <= LARGEST;
        let is_inside = low.cmplt(size).all() && high.cmpge(Vec2::ZERO).all();
        if !is_small || !is_inside || stop.now() {
            return None;
        }
        let mut rays = 0;
        let seen = lattice::look(scene, 0.5 * (low + high), &mut rays);
        Some((low, high, seen, rays))
    };
    let found: Vec<_> = scene.lights.lights().par_iter().filter_map(look).collect();
    let mut pixels = BTreeMap::<usize, Seen>::new();
    for (low, high, seen, traced) in found {
        *rays += traced;
        if seen.emitted <= 0.0 {
            continue;
        }
        let span = |low: f32, high: f32, count: usize| low.max(0.0) as usize..(high as usize + 1).min(count);
        for y in span(low.y, high.y, film.height) {
            for x in span(low.x, high.x, film.width) {
                let known = pixels.entry(y * film.width + x).or_default();
                if seen.emitted > known.emitted {
                    *known = seen;
                }
            }
        }
    }
    pixels
}

/// The rectangle of the film in which a light is seen, if it lies before the camera and the camera sees it.
fn extent(scene: &RenderScene, light: &Light) -> Option<[Vec2; 2]> {
    let bounds = light.bounds().filter(|_| light.camera_visible() && !light.is_delta())?;
    let mut extent = [Vec2::INFINITY, Vec2::NEG_INFINITY];
    for corner in bounds.corners() {
        let (place, _) = scene.camera.seen(corner)?;
        extent = [extent[0].min(place), extent[1].max(place)];
    }
    Some(extent)
}
