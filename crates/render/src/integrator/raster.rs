//! Triangles projected to the film, the nearest at each pixel's middle: no ray is traced, no light travels.
//!
//! A picture is one pass: points are projected, once an instance; triangles are sorted into squares of the film;
//! each square finds the nearest triangle at each pixel, and each pixel is then shaded once. Pieces of the scene and
//! squares of the film go to all threads; which thread took which changes nothing.

mod bins;
mod clip;
mod fill;
mod placement;
mod project;
mod shade;
#[cfg(test)]
mod tests;

use std::ops::Range;

use rayon::prelude::*;
use umber_geometry::TriangleMesh;
use umber_math::Point3;
use umber_settings::Settings;

use super::Stop;
use crate::film::{Film, PixelSum, TILE};
use crate::scene::RenderScene;
use bins::{BIN, Binned, Bins, Piece, Projected, Sorter};
use fill::Bin;
use placement::Placement;
use project::{Grid, Vertex};
use shade::Shader;

/// Triangles that one thread sorts at a time.
const PIECE: usize = 1 << 14;
/// Points that are projected at a time, at most, but for those of one mesh: what bounds the memory.
const BATCH: usize = 1 << 22;
/// Points that one thread projects at a time, at least.
const POINTS_A_PIECE: usize = 1 << 13;

const _: () = assert!(BIN.is_multiple_of(TILE));

/// The settings by which one sample a pixel is the finished picture.
pub fn settings(given: &Settings) -> Settings {
    Settings { converged_samples_per_pixel: 1, converged_variance: -1.0, ..given.clone() }
}

/// Gives every pixel of a film its sample; on the threads of the pool that it is called in. Ends early where stopped.
/// How many pixels were given one.
pub fn render(scene: &RenderScene, film: &Film, stop: &Stop<'_>) -> u64 {
    let (width, height) = (film.desc().width, film.desc().height);
    let grid = Grid::new(scene.camera.view(), width, height);
    let layout = Bins::new(width, height);
    let placements = placement::visible(scene, &grid);
    let mut bins: Vec<Bin> = (0..layout.count()).map(|i| Bin::new(&grid, i, layout.columns)).collect();
    for batch in batches(scene, &placements) {
        let binned = sort(scene, &grid, layout, &placements, batch, stop);
        let is_there = |t: &Projected, [x, y]: [i32; 2]| {
            let placement = &placements[t.placement() as usize];
            let corners = placement.mesh(scene).shape.triangle(t.triangle);
            let at = [(x, width), (y, height)].map(|(v, pixels)| f64::from(v) + 0.5 - 0.5 * pixels as f64);
            let barycentrics = shade::barycentrics(&shade::weights(&grid, placement, corners), at);
            bins::is_there(scene, placement, t.triangle, barycentrics)
        };
        bins.par_iter_mut().enumerate().for_each(|(index, bin)| {
            if !stop.now() {
                let triangles = binned.iter().flat_map(|piece| piece.of(index));
                triangles.for_each(|triangle| bin.fill(&grid, triangle, is_there));
            }
        });
    }
    if stop.now() {
        return 0;
    }
    let shaded = bins.par_iter().map(|bin| if stop.now() { 0 } else { shade(scene, &grid, &placements, bin, film) });
    shaded.sum()
}

/// Ranges of placements whose points are projected together.
fn batches(scene: &RenderScene, placements: &[Placement]) -> Vec<Range<usize>> {
    let (mut ranges, mut start, mut points) = (Vec::new(), 0, 0);
    for (i, placement) in placements.iter().enumerate() {
        let own = placement.mesh(scene).shape.points.len();
        if points + own > BATCH && i > start {
            ranges.push(start..i);
            (start, points) = (i, 0);
        }
        points += own;
    }
    if start < placements.len() {
        ranges.push(start..placements.len());
    }
    ranges
}

/// Projects a batch and sorts its triangles; in the order of the scene, whoever does it.
fn sort(
    scene: &RenderScene,
    grid: &Grid,
    layout: Bins,
    placements: &[Placement],
    batch: Range<usize>,
    stop: &Stop<'_>,
) -> Vec<Binned> {
    let projected = |placement: &Placement| -> Vec<Vertex> {
        let points = &placement.mesh(scene).shape.points;
        let place = |p: &umber_math::Vec3| grid.place(placement.film_from_object.apply(Point3(*p)));
        if stop.now() {
            return Vec::new();
        }
        points.par_iter().with_min_len(POINTS_A_PIECE).map(place).collect()
    };
    let vertices: Vec<Vec<Vertex>> = placements[batch.clone()].par_iter().map(projected).collect();
    let pieces = batch.zip(&vertices).flat_map(|(index, vertices)| {
        let placement = &placements[index];
        let ranges = ranges_of(&placement.mesh(scene).shape.mesh);
        ranges.map(move |triangles| Piece { index: index as u32, placement, vertices, triangles })
    });
    let jobs = jobs(pieces);
    let sort = |job: &Vec<Piece<'_>>| {
        if stop.now() {
            return Binned::default();
        }
        let mut sorter = Sorter::new(scene, grid, layout);
        job.iter().for_each(|piece| sorter.add(piece));
        sorter.sorted()
    };
    jobs.par_iter().map(sort).collect()
}

/// A mesh's triangles in pieces.
fn ranges_of(mesh: &TriangleMesh) -> impl Iterator<Item = Range<usize>> + use<> {
    let count = mesh.len();
    (0..count).step_by(PIECE).map(move |start| start..(start + PIECE).min(count))
}

/// Pieces in lists of about [`PIECE`] triangles.
fn jobs<'a>(pieces: impl Iterator<Item = Piece<'a>>) -> Vec<Vec<Piece<'a>>> {
    let (mut jobs, mut job, mut size) = (Vec::new(), Vec::new(), 0);
    for piece in pieces {
        if size + piece.triangles.len() > PIECE && !job.is_empty() {
            jobs.push(std::mem::take(&mut job));
            size = 0;
        }
        size += piece.triangles.len();
        job.push(piece);
    }
    jobs.push(job);
    jobs
}

/// Shades a bin's pixels into the film's tiles. How many.
fn shade(scene: &RenderScene, grid: &Grid, placements: &[Placement], bin: &Bin, film: &Film) -> u64 {
    let mut shader = Shader::new(scene, grid, placements);
    let [x, y, width, height] = [bin.first[0], bin.first[1], bin.size[0], bin.size[1]].map(|v| v as usize);
    for (row, column) in (y..y + height).step_by(TILE).flat_map(|r| (x..x + width).step_by(TILE).map(move |c| (r, c))) {
        let index = film.tile_at(column, row);
        let rect = film.tile(index).rect;
        let places = || (0..rect.width * rect.height).map(|i| [rect.x + i % rect.width, rect.y + i / rect.width]);
        let pixels = || places().map(|at| at.map(|v| v as i32)).map(|at| (bin.seen(at[0], at[1]), at));
        let sums = pixels().map(|(seen, at)| {
            let mut sum = PixelSum::default();
            match shader.color(seen, at) {
                Some(color) => sum.add(color, 1.0),
                None => sum.add(umber_math::Rgb::BLACK, 0.0),
            }
            sum
        });
        let sums = sums.collect();
        film.tile(index).halves = [sums, Vec::new()];
        if film.has_center_aovs() {
            let centers: Vec<_> = pixels().map(|(seen, at)| shader.center(seen, at)).collect();
            film.set_centers(index, &centers);
        }
    }
    (width * height) as u64
}
