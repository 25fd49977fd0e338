//! Integrators: they read a frozen scene and give samples.

mod center;
pub mod path;

use std::sync::atomic::{AtomicBool, Ordering};

use umber_math::{Rgb, Vec2};
use umber_sampling::Sampler;

use crate::film::Film;
use crate::scene::RenderScene;

/// Sample dimensions of the camera; those of the path's vertices follow.
const CAMERA_DIMENSIONS: u32 = 4;
/// Film position within the pixel.
const FILM_DIMENSION: u32 = 0;

/// One sample of a pixel.
#[derive(Clone, Copy, Debug)]
pub struct RadianceSample {
    /// Radiance towards the camera.
    pub radiance: Rgb,
    /// 1 where anything is seen, 0 where nothing is.
    pub coverage: f32,
}

/// What rendering a tile took.
#[derive(Clone, Copy, Debug, Default)]
pub struct TileWork {
    /// Rays traced.
    pub rays: u64,
    /// Samples added.
    pub samples: u64,
}

/// Renders a tile until every pixel has `target` samples. Ends early where cancelled, between samples.
///
/// Each pixel adds its samples in their own order: the sums do not depend on who renders, nor on how
/// often it was stopped.
pub fn render_tile(scene: &RenderScene, film: &Film, tile: usize, target: u32, cancel: &AtomicBool) -> TileWork {
    let mut work = TileWork::default();
    let (rect, mut sums, known) = {
        let tile = film.tile(tile);
        (tile.rect, tile.sums.clone(), tile.has_centers())
    };
    if film.has_center_aovs() && !known {
        let pixels = (0..sums.len()).map(|i| [rect.x + i % rect.width, rect.y + i / rect.width]);
        let hits: Vec<_> = pixels.map(|pixel| center::trace(scene, pixel, &mut work.rays)).collect();
        film.set_centers(tile, &hits);
    }
    let data_min = film.desc().data_window_min;
    'pixels: for (i, sum) in sums.iter_mut().enumerate() {
        let (x, y) = (rect.x + i % rect.width, rect.y + i / rect.width);
        // numbered within the whole view, so that a part of it shows the same noise
        let pixel = [(x as i32 + data_min[0]) as u32, (y as i32 + data_min[1]) as u32];
        while sum.samples < target {
            if cancel.load(Ordering::Relaxed) {
                break 'pixels;
            }
            let mut sampler = Sampler::new(scene.settings.seed.into(), pixel, sum.samples);
            sampler.start_dimension(FILM_DIMENSION);
            let ray = scene.camera.ray(Vec2::new(x as f32, y as f32) + sampler.next_2d());
            let sample = path::radiance(scene, ray, &mut sampler, &mut work.rays);
            sum.add(finite(sample.radiance), sample.coverage);
            work.samples += 1;
        }
    }
    film.tile(tile).sums = sums;
    work
}

/// Nothing may poison a pixel: what is not a number counts as black, what is too large is cut.
fn finite(radiance: Rgb) -> Rgb {
    const LARGEST: f32 = 1e30;
    if radiance.0.is_nan() { Rgb::BLACK } else { Rgb(radiance.0.clamp(glam::Vec3::ZERO, glam::Vec3::splat(LARGEST))) }
}
