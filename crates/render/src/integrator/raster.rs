//! Triangles projected to the film, the nearest at each pixel's middle: no ray is traced, no light travels.
//!
//! A picture is one pass: clusters of triangles are sorted into the squares of the film that they may be seen in; each
//! square draws its own from front to back, passes over those that are hidden by then, and shades each pixel once.
//! Pieces of the scene and squares of the film go to all threads; which thread took which changes nothing.

mod bins;
mod boxing;
mod centers;
mod clip;
mod draw;
mod fill;
mod pieces;
mod placement;
mod project;
mod reach;
mod shade;
mod short;
mod square;
mod surface;
#[cfg(test)]
mod tests;

use std::sync::atomic::{AtomicUsize, Ordering};

use umber_settings::Settings;

use super::Stop;
use crate::film::{Film, TILE};
use crate::scene::RenderScene;
use bins::{Bins, Entry};
use draw::Drawer;
use pieces::{MOST_ENTRIES, Piece};
use placement::Placement;
use project::Grid;
use shade::Shader;
use square::Square;

/// The settings by which one sample a pixel is the finished picture.
pub fn settings(given: &Settings) -> Settings {
    Settings { converged_samples_per_pixel: 1, converged_variance: -1.0, ..given.clone() }
}

/// Gives every pixel of a film its sample; on the threads of the pool that it is called in. Ends early where stopped.
/// How many pixels were given one.
pub fn render(scene: &RenderScene, film: &Film, stop: &Stop<'_>) -> u64 {
    let grid = Grid::new(scene.camera.view(), film.desc().width, film.desc().height);
    let placements = placement::visible(scene, &grid, stop);
    let bins = Bins::new(scene, &grid, &placements, stop);
    // each thread takes the next square: some are much more work than others
    let next = AtomicUsize::new(0);
    let shares = rayon::broadcast(|_| {
        let (mut worker, mut pixels) = (Worker::new(scene, &grid, &placements), 0);
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= bins.square_count() || stop.now() {
                return pixels;
            }
            pixels += worker.render(index, bins.square(index), film);
        }
    });
    shares.into_iter().sum()
}

/// What renders squares, one a thread.
struct Worker<'a> {
    grid: &'a Grid,
    square: Square,
    /// The square's, from front to back.
    entries: Vec<Entry>,
    /// What of them was drawn.
    pieces: Vec<Piece<'a>>,
    drawer: Drawer<'a>,
    shader: Shader<'a>,
}

impl<'a> Worker<'a> {
    fn new(scene: &'a RenderScene, grid: &'a Grid, placements: &'a [Placement]) -> Self {
        let (drawer, shader) = (Drawer::new(scene, grid, placements), Shader::new(scene, grid, placements));
        let (entries, pieces) = (Vec::new(), Vec::new());
        Self { grid, square: Square::new(), entries, pieces, drawer, shader }
    }

    /// Draws and shades a square. How many pixels it has.
    fn render(&mut self, index: usize, entries: &[Entry], film: &Film) -> u64 {
        self.square.start(self.grid, index);
        self.entries.clear();
        self.entries.extend(entries);
        if !entries.is_empty() {
            self.entries.sort_unstable_by(|a, b| b.nearness.total_cmp(&a.nearness));
            self.entries.truncate(MOST_ENTRIES);
            self.drawer.draw(&mut self.square, &self.entries, &mut self.pieces);
            self.shade(film);
        }
        self.square.size.into_iter().map(|pixels| pixels as u64).product()
    }

    /// Shades the square's pixels into the film's tiles; those where nothing is seen stay without samples, which looks
    /// the same.
    fn shade(&mut self, film: &Film) {
        let ([x, y], [width, height]) = (self.square.first.map(|v| v as usize), self.square.size.map(|v| v as usize));
        self.shader.start(&self.square, &self.pieces);
        let corners = (y..y + height).step_by(TILE).flat_map(|row| (x..x + width).step_by(TILE).map(move |x| (x, row)));
        for (x, y) in corners {
            let index = film.tile_at(x, y);
            let rect = film.tile(index).rect;
            if !self.shader.look(&self.square, &self.pieces, rect) {
                continue;
            }
            // in the memory of an older picture, if there was one
            let mut samples = std::mem::take(&mut film.tile(index).samples);
            samples.clear();
            self.shader.colors(&self.pieces, rect, &mut samples.halves[0]);
            film.tile(index).samples = samples;
            if film.has_center_aovs() {
                film.set_centers(index, &self.shader.centers(&self.pieces, rect));
            }
        }
    }
}
