//! Triangles projected to the film, the nearest at each pixel's middle: no ray is traced, no light travels.
//!
//! A picture is one pass: points are projected, once an instance; triangles are sorted into squares of the film;
//! each square finds the nearest triangle at each pixel, and each pixel is then shaded once. Pieces of the scene and
//! squares of the film go to all threads; which thread took which changes nothing.

mod clip;
mod draw;
mod fill;
mod numbers;
mod placement;
mod project;
mod shade;
#[cfg(test)]
mod tests;
mod visibility;

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;
use umber_math::{Point3, Vec3};
use umber_settings::Settings;

use super::Stop;
use crate::film::{Film, TILE};
use crate::scene::RenderScene;
use draw::{Drawer, Piece};
use numbers::Batch;
use placement::Placement;
use project::{Grid, Vertex};
use shade::Shader;
use visibility::{Canvas, Square};

/// Groups of triangles that one thread draws at a time.
const PIECE: usize = 512;
/// Points that one thread projects at a time, at least.
const POINTS_A_PIECE: usize = 1 << 13;

/// The settings by which one sample a pixel is the finished picture.
pub fn settings(given: &Settings) -> Settings {
    Settings { converged_samples_per_pixel: 1, converged_variance: -1.0, ..given.clone() }
}

/// Gives every pixel of a film its sample; on the threads of the pool that it is called in. Ends early where stopped.
/// How many pixels were given one.
pub fn render(scene: &RenderScene, film: &Film, stop: &Stop<'_>) -> u64 {
    let grid = Grid::new(scene.camera.view(), film.desc().width, film.desc().height);
    let placements = placement::visible(scene, &grid, stop);
    let batches = Batch::all(scene, &placements);
    let (mut canvas, mut vertices) = (Canvas::new(grid), Vec::new());
    for (i, batch) in batches.iter().enumerate() {
        if stop.now() {
            return 0;
        }
        if i > 0 {
            canvas.squares().par_iter_mut().for_each(|square| own(square).end_batch(&batches[i - 1]));
        }
        vertices = project(scene, &grid, &placements[batch.placements.clone()], stop);
        draw(scene, &canvas, &placements, batch, &vertices, stop);
    }
    let Some(last) = batches.last().filter(|_| !stop.now()) else { return 0 };
    let shaded = canvas.squares().par_iter_mut().map(|square| {
        let mut shader = Shader::new(scene, &grid, &placements, last, &vertices);
        if stop.now() { 0 } else { shade(&mut shader, own(square), film) }
    });
    shaded.sum()
}

/// A square of a canvas on which nobody draws.
fn own(square: &mut Mutex<Square>) -> &mut Square {
    square.get_mut().unwrap_or_else(PoisonError::into_inner)
}

/// The points of each placement on the grid.
fn project(scene: &RenderScene, grid: &Grid, placements: &[Placement], stop: &Stop<'_>) -> Vec<Vec<Vertex>> {
    let projected = |placement: &Placement| -> Vec<Vertex> {
        let points = &placement.mesh(scene).shape.points;
        let place = |p: &Vec3| grid.place(placement.film_from_object.apply(Point3(*p)));
        if stop.now() {
            return Vec::new();
        }
        points.par_iter().with_min_len(POINTS_A_PIECE).map(place).collect()
    };
    // here, where all threads are at work
    placements.par_iter().filter(|_| !stop.now()).for_each(|placement| _ = placement.mesh(scene).shape.clusters());
    placements.par_iter().map(projected).collect()
}

/// Draws a batch's triangles. `vertices`: the points of its placements.
fn draw(
    scene: &RenderScene,
    canvas: &Canvas,
    placements: &[Placement],
    batch: &Batch,
    vertices: &[Vec<Vertex>],
    stop: &Stop<'_>,
) {
    if stop.now() {
        return;
    }
    // what is near first: it hides the rest
    let mut order: Vec<_> = batch.placements.clone().zip(vertices).collect();
    order.sort_by(|a, b| placements[a.0].distance.total_cmp(&placements[b.0].distance));
    let pieces = order.into_iter().flat_map(|(index, vertices)| {
        let (placement, first_number) = (&placements[index], batch.first_number(index));
        let count = placement.mesh(scene).shape.clusters().len();
        let ranges = (0..count).step_by(PIECE).map(move |start| start..(start + PIECE).min(count));
        ranges.map(move |clusters| Piece { placement, vertices, first_number, clusters })
    });
    let (jobs, next) = (jobs(pieces), AtomicUsize::new(0));
    rayon::broadcast(|_| {
        let mut drawer = Drawer::new(scene, canvas);
        while let Some(job) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
            job.iter().take_while(|_| !stop.now()).for_each(|piece| drawer.draw(piece));
        }
    });
}

/// Pieces in lists of about [`PIECE`] groups.
fn jobs<'a>(pieces: impl Iterator<Item = Piece<'a>>) -> Vec<Vec<Piece<'a>>> {
    let (mut jobs, mut job, mut size) = (Vec::new(), Vec::new(), 0);
    for piece in pieces {
        if size + piece.clusters.len() > PIECE && !job.is_empty() {
            jobs.push(std::mem::take(&mut job));
            size = 0;
        }
        size += piece.clusters.len();
        job.push(piece);
    }
    jobs.push(job);
    jobs
}

/// Shades a square's pixels into the film's tiles; those where nothing is seen stay without samples, which looks the
/// same. How many pixels were looked at.
fn shade(shader: &mut Shader<'_>, square: &Square, film: &Film) -> u64 {
    let [x, y, width, height] = [square.first[0], square.first[1], square.size[0], square.size[1]].map(|v| v as usize);
    let corners = (y..y + height).step_by(TILE).flat_map(|row| (x..x + width).step_by(TILE).map(move |x| (x, row)));
    for (x, y) in corners.filter(|_| !square.is_untouched()) {
        let index = film.tile_at(x, y);
        let rect = film.tile(index).rect;
        if !shader.look(square, rect) {
            continue;
        }
        // in the memory of an older picture, if there was one
        let mut samples = std::mem::take(&mut film.tile(index).halves[0]);
        samples.clear();
        shader.colors(rect, &mut samples.sums);
        film.tile(index).halves[0] = samples;
        if film.has_center_aovs() {
            film.set_centers(index, &shader.centers(rect));
        }
    }
    (width * height) as u64
}
