//! What is seen through the corners of pixels, finely where it is needed.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;
use umber_math::Vec2;
use umber_sampling::Sampler;

use crate::film::{self, FilmDesc};
use crate::integrator::primary::Primary;
use crate::integrator::{Stop, path};
use crate::scene::RenderScene;

/// Pixels across and down of a cell, whose corners are looked at first.
const CELL: usize = 2;
/// An edge runs through a cell where one of its corners shines so much brighter than another.
const CONTRAST: f64 = 2.0;
/// Distinguishes its random numbers from those of the picture.
const STREAM: u64 = 10 << 32;

/// Luminances that are seen through a point.
#[derive(Clone, Copy, Default)]
pub(super) struct Seen {
    /// Of what shines by itself.
    pub emitted: f64,
    /// With that which is reflected, as one path finds it.
    pub radiance: f64,
}

/// What is seen through corners of pixels: of all that have to do with edges.
pub(super) struct Lattice {
    /// Pixels across and down.
    size: [usize; 2],
    /// Cells in which edges run, or beside such ones: row by row.
    cells: Vec<bool>,
    /// Corners of pixels, row by row; nothing where no such cell is.
    corners: Vec<Option<Seen>>,
}

impl Lattice {
    /// Looks through the corners of cells, and where edges run, through those of pixels; `None` where none do, or where
    /// it was stopped. Counts rays.
    pub fn trace(
        scene: &RenderScene,
        film: &FilmDesc,
        lamps: &BTreeMap<usize, Seen>,
        stop: &Stop<'_>,
        rays: &mut u64,
    ) -> Option<Self> {
        let traced = AtomicU64::new(0);
        let each = |[columns, rows]: [usize; 2], look: &(dyn Fn(usize, usize, &mut u64) -> Option<Seen> + Sync)| {
            let of_row = |y: usize| {
                let mut rays = 0;
                let row = (0..columns).map(|x| if stop.cancelled() { None } else { look(x, y, &mut rays) });
                let row: Vec<_> = row.collect();
                traced.fetch_add(rays, Ordering::Relaxed);
                row
            };
            (0..rows).into_par_iter().flat_map_iter(of_row).collect::<Vec<_>>()
        };
        let size = [film.width, film.height];
        let count = size.map(|pixels| pixels.div_ceil(CELL));
        let coarse = each(count.map(|cells| cells + 1), &|x, y, rays| {
            let [x, y] = [(x, size[0]), (y, size[1])].map(|(cell, pixels)| (cell * CELL).min(pixels) as f32);
            let (primary, _) = primary(scene, Vec2::new(x, y), rays);
            Some(Seen { emitted: film::luminance(primary.emitted.0.as_dvec3()), radiance: 0.0 })
        });
        let mut cells = edges(&coarse, count);
        for pixel in lamps.keys() {
            cells[pixel / size[0] / CELL * count[0] + pixel % size[0] / CELL] = true;
        }
        let cells = with_neighbours(&cells, count);
        let mut lattice = Self { size, cells, corners: Vec::new() };
        if !lattice.cells.contains(&true) {
            return None;
        }
        lattice.corners = each(size.map(|pixels| pixels + 1), &|x, y, rays| {
            let touches = |x: usize, y: usize| x < size[0] && y < size[1] && lattice.is_fine(x, y);
            let [before_x, before_y] = [x, y].map(|at| at.wrapping_sub(1));
            let is_wanted =
                touches(x, y) || touches(before_x, y) || touches(x, before_y) || touches(before_x, before_y);
            is_wanted.then(|| look(scene, Vec2::new(x as f32, y as f32), rays))
        });
        *rays += traced.into_inner();
        (!stop.now()).then_some(lattice)
    }

    /// Whether edges run through a pixel's cell, or through one beside it.
    pub fn is_fine(&self, x: usize, y: usize) -> bool {
        self.cells[y / CELL * self.size[0].div_ceil(CELL) + x / CELL]
    }

    /// What is seen through a point around a pixel, counted from one before its first corner.
    pub fn seen(&self, x: usize, y: usize) -> Option<Seen> {
        let [x, y] = [x.checked_sub(1)?, y.checked_sub(1)?];
        let is_inside = x <= self.size[0] && y <= self.size[1];
        is_inside.then(|| self.corners[y * (self.size[0] + 1) + x]).flatten()
    }
}

/// What is seen through a point of the film. Counts rays.
pub(super) fn look(scene: &RenderScene, at: Vec2, rays: &mut u64) -> Seen {
    let (primary, mut sampler) = primary(scene, at, rays);
    let sample = path::radiance(&primary, &mut sampler, rays);
    let [emitted, radiance] = [primary.emitted, sample.radiance].map(|l| film::luminance(l.0.as_dvec3()));
    Seen { emitted, radiance }
}

/// What a ray through a point of the film meets.
fn primary<'a>(scene: &'a RenderScene, at: Vec2, rays: &mut u64) -> (Primary<'a>, Sampler) {
    let mut sampler = Sampler::new(STREAM | u64::from(scene.settings.seed), at.to_array().map(f32::to_bits), 0);
    (Primary::new(scene, scene.camera.ray(at), &mut sampler, rays), sampler)
}

/// Which of so many cells across and down edges run through.
fn edges(corners: &[Option<Seen>], [columns, rows]: [usize; 2]) -> Vec<bool> {
    let emitted = |x: usize, y: usize| corners[y * (columns + 1) + x].map_or(0.0, |seen| seen.emitted);
    let runs_through = |i: usize| {
        let (x, y) = (i % columns, i / columns);
        let corners = [emitted(x, y), emitted(x + 1, y), emitted(x, y + 1), emitted(x + 1, y + 1)];
        let [low, high] = [corners.into_iter().fold(f64::INFINITY, f64::min), corners.into_iter().fold(0.0, f64::max)];
        high > CONTRAST * low
    };
    (0..columns * rows).map(runs_through).collect()
}

/// Those cells, and the ones beside them.
fn with_neighbours(cells: &[bool], [columns, rows]: [usize; 2]) -> Vec<bool> {
    let around = |at: usize, count: usize| at.saturating_sub(1)..(at + 2).min(count);
    let is_near = |i: usize| {
        let (x, y) = (i % columns, i / columns);
        around(y, rows).any(|y| around(x, columns).any(|x| cells[y * columns + x]))
    };
    (0..cells.len()).map(is_near).collect()
}
