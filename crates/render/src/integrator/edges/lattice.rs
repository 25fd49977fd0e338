//! What is seen through the corners of pixels, finely where it is needed.

use std::collections::BTreeMap;

use rayon::prelude::*;
use umber_math::{Rgb, Vec2};
use umber_sampling::Sampler;

use crate::film::FilmDesc;
use crate::integrator::primary::Primary;
use crate::integrator::{Stop, path, tile};
use crate::scene::RenderScene;

/// Pixels across and down of a cell, whose corners are looked at first.
const CELL: usize = 2;
/// An edge runs through a cell where one of its corners shines so much brighter than another.
const CONTRAST: f32 = 2.0;
/// Distinguishes its random numbers from those of the picture.
const STREAM: u64 = 10 << 32;

/// Luminances that are seen through a point.
#[derive(Clone, Copy, Default)]
pub(super) struct Seen {
    /// Of what shines by itself; not a number where nobody looked.
    pub emitted: f32,
    /// With that which is reflected, as one path finds it.
    pub radiance: f32,
}

impl Seen {
    /// Where nobody looked.
    const NOTHING: Self = Self { emitted: f32::NAN, radiance: 0.0 };
}

/// What is seen through corners of pixels: of all that have to do with edges.
pub(super) struct Lattice {
    /// Pixels across and down.
    size: [usize; 2],
    /// Cells in which edges run, or beside such ones: row by row.
    cells: Vec<bool>,
    /// Corners of pixels, row by row; [`Seen::NOTHING`] where no such cell is.
    corners: Vec<Seen>,
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
        let size = [film.width, film.height];
        let count = size.map(|pixels| pixels.div_ceil(CELL));
        let coarse = rows(count.map(|cells| cells + 1), stop, rays, |x, y, rays| {
            let [x, y] = [(x, size[0]), (y, size[1])].map(|(cell, pixels)| (cell * CELL).min(pixels) as f32);
            let (primary, _) = primary(scene, Vec2::new(x, y), rays);
            Seen { emitted: luminance(scene, primary.emitted), radiance: 0.0 }
        });
        let mut cells = edges(&coarse, count);
        for pixel in lamps.keys() {
            cells[pixel / size[0] / CELL * count[0] + pixel % size[0] / CELL] = true;
        }
        let mut lattice = Self { size, cells: with_neighbours(&cells, count), corners: Vec::new() };
        if !lattice.cells.contains(&true) {
            return None;
        }
        lattice.corners = rows(size.map(|pixels| pixels + 1), stop, rays, |x, y, rays| {
            let around = |at: usize, pixels: usize| at.saturating_sub(1)..(at + 1).min(pixels);
            let is_wanted = around(y, size[1]).any(|y| around(x, size[0]).any(|x| lattice.is_fine(x, y)));
            if is_wanted { look(scene, Vec2::new(x as f32, y as f32), rays) } else { Seen::NOTHING }
        });
        (!stop.now()).then_some(lattice)
    }

    /// Whether edges run through a pixel's cell, or through one beside it.
    pub fn is_fine(&self, x: usize, y: usize) -> bool {
        self.cells[y / CELL * self.size[0].div_ceil(CELL) + x / CELL]
    }

    /// What is seen through one of the corners around a pixel: of columns and rows 0 to 3, 1 and 2 are its own. `None`
    /// outside of the film, and where nobody looked.
    pub fn seen(&self, [x, y]: [usize; 2], [column, row]: [usize; 2]) -> Option<Seen> {
        let [x, y] = [(x + column).checked_sub(1)?, (y + row).checked_sub(1)?];
        let is_inside = x <= self.size[0] && y <= self.size[1];
        is_inside.then(|| self.corners[y * (self.size[0] + 1) + x]).filter(|seen| !seen.emitted.is_nan())
    }
}

/// What is seen at each place of a grid of so many columns and rows, row by row. Counts rays.
fn rows(
    [columns, rows]: [usize; 2],
    stop: &Stop<'_>,
    rays: &mut u64,
    look: impl Fn(usize, usize, &mut u64) -> Seen + Sync,
) -> Vec<Seen> {
    let mut seen = vec![Seen::NOTHING; columns * rows];
    let of_row = |(y, row): (usize, &mut [Seen])| {
        let mut rays = 0;
        for (x, seen) in row.iter_mut().enumerate().take_while(|_| !stop.now()) {
            *seen = look(x, y, &mut rays);
        }
        rays
    };
    *rays += seen.par_chunks_mut(columns).enumerate().map(of_row).sum::<u64>();
    seen
}

/// What is seen through a point of the film. Counts rays.
pub(super) fn look(scene: &RenderScene, at: Vec2, rays: &mut u64) -> Seen {
    let (primary, mut sampler) = primary(scene, at, rays);
    let sample = path::radiance(&primary, &mut sampler, rays);
    Seen { emitted: luminance(scene, primary.emitted), radiance: luminance(scene, sample.radiance) }
}

/// Luminance of what a pixel keeps.
fn luminance(scene: &RenderScene, radiance: Rgb) -> f32 {
    tile::kept(scene, radiance).luminance()
}

/// What a ray through a point of the film meets.
fn primary<'a>(scene: &'a RenderScene, at: Vec2, rays: &mut u64) -> (Primary<'a>, Sampler) {
    let mut sampler = Sampler::new(STREAM | u64::from(scene.settings.seed), at.to_array().map(f32::to_bits), 0);
    (Primary::new(scene, scene.camera.ray(at), &mut sampler, rays), sampler)
}

/// Which of so many cells across and down edges run through.
fn edges(corners: &[Seen], [columns, rows]: [usize; 2]) -> Vec<bool> {
    let emitted = |x: usize, y: usize| corners[y * (columns + 1) + x].emitted;
    let runs_through = |i: usize| {
        let (x, y) = (i % columns, i / columns);
        let corners = [emitted(x, y), emitted(x + 1, y), emitted(x, y + 1), emitted(x + 1, y + 1)];
        let [low, high] = [corners.into_iter().fold(f32::INFINITY, f32::min), corners.into_iter().fold(0.0, f32::max)];
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_run_through_cells_whose_corners_shine_differently() {
        // three cells across and two down; one corner of the grid shines
        let count = [3, 2];
        let shining = |x: usize, y: usize, dark: f32| -> Vec<usize> {
            let mut corners = vec![Seen { emitted: dark, radiance: dark }; 12];
            corners[y * 4 + x].emitted = 1.0;
            edges(&corners, count).iter().enumerate().filter(|(_, edge)| **edge).map(|(cell, _)| cell).collect()
        };
        assert_eq!(shining(0, 0, 0.0), [0]);
        assert_eq!(shining(1, 1, 0.0), [0, 1, 3, 4]);
        assert_eq!(shining(3, 2, 0.0), [5]);
        assert_eq!(shining(1, 1, 0.4), [0, 1, 3, 4]);
        assert!(shining(1, 1, 0.6).is_empty());
    }

    #[test]
    fn cells_beside_edges_are_looked_at_as_well() {
        let cells = |edge: usize| {
            let mut cells = vec![false; 12];
            cells[edge] = true;
            let near = with_neighbours(&cells, [4, 3]);
            (0..12).filter(|cell| near[*cell]).collect::<Vec<_>>()
        };
        assert_eq!(cells(0), [0, 1, 4, 5]);
        assert_eq!(cells(6), [1, 2, 3, 5, 6, 7, 9, 10, 11]);
        assert_eq!(cells(11), [6, 7, 10, 11]);
        assert_eq!(with_neighbours(&[true], [1, 1]), [true]);
    }

    #[test]
    fn what_lies_outside_or_was_not_looked_at_is_not_seen() {
        // one pixel across and three down, whose second has a corner that nobody looked at
        let at = |y: usize| Seen { emitted: y as f32, radiance: 0.0 };
        let mut corners: Vec<Seen> = (0..8).map(|i| at(i / 2)).collect();
        corners[2] = Seen::NOTHING;
        let lattice = Lattice { size: [1, 3], cells: vec![true; 2], corners };
        let seen = |pixel: [usize; 2], corner| lattice.seen(pixel, corner).map(|seen| seen.emitted);
        assert_eq!(seen([0, 0], [1, 1]), Some(0.0));
        assert_eq!(seen([0, 0], [2, 2]), Some(1.0));
        assert_eq!(seen([0, 1], [1, 1]), None);
        assert_eq!(seen([0, 2], [2, 2]), Some(3.0));
        assert_eq!([[0, 1], [1, 0], [3, 1]].map(|corner| seen([0, 0], corner)), [None; 3]);
        assert_eq!(seen([0, 2], [1, 3]), None);
    }
}
