//! What is seen at each pixel's middle, kept in squares of the film that threads draw on in turn.

use std::sync::{Mutex, MutexGuard, PoisonError};

use super::fill::Triangle;
use super::numbers::{Batch, Seen};
use super::project::{Grid, Reach};
use crate::film::TILE;

/// Edge of a square, pixels; a multiple of the film's tiles'.
pub const SQUARE: usize = 64;
/// Number of no triangle.
pub const NOTHING: u32 = 0;

const _: () = assert!(SQUARE.is_multiple_of(TILE));

/// What is seen at each pixel.
///
/// Triangles have numbers, from 1 on. What is nearest is seen; where several are as near, the one with the
/// smallest number: it does not matter who draws first.
#[derive(Debug)]
pub struct Canvas {
    grid: Grid,
    columns: usize,
    squares: Vec<Mutex<Square>>,
}

impl Canvas {
    /// A canvas where nothing is seen.
    pub fn new(grid: Grid) -> Self {
        let [columns, rows] = [grid.width, grid.height].map(|pixels| (pixels as usize).div_ceil(SQUARE));
        let square = |i: usize| {
            let first = [i % columns * SQUARE, i / columns * SQUARE].map(|v| v as i32);
            let size = [grid.width - first[0], grid.height - first[1]].map(|left| left.min(SQUARE as i32));
            let (nearness, numbers, earlier) = Default::default();
            Mutex::new(Square { first, size, nearness, numbers, earlier })
        };
        Self { grid, columns, squares: (0..columns * rows).map(square).collect() }
    }
    /// The grid of its film.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }
    /// The squares, for one who is alone.
    pub fn squares(&mut self) -> &mut [Mutex<Square>] {
        &mut self.squares
    }
    /// Something to draw with, one a thread.
    pub fn pencil(&self) -> Pencil<'_> {
        Pencil { canvas: self, at: None }
    }
}

/// A square of the film.
#[derive(Debug)]
pub struct Square {
    /// First column and row.
    pub first: [i32; 2],
    /// Columns and rows.
    pub size: [i32; 2],
    /// Nearness and number of what is seen, row by row of [`SQUARE`] pixels; empty before anything is.
    pub nearness: Vec<f32>,
    /// As `nearness`.
    pub numbers: Vec<u32>,
    /// What was seen before the batch whose numbers those are; empty if that is the first.
    earlier: Vec<Option<Seen>>,
}

impl Square {
    /// The part of it in a range of columns and rows: first and last column and row.
    #[inline]
    pub fn part_of(&self, pixels: [[i32; 2]; 2]) -> [[i32; 2]; 2] {
        let [[x0, x1], [y0, y1]] = pixels;
        let [first_x, first_y] = self.first;
        let last = [first_x + self.size[0] - 1, first_y + self.size[1] - 1];
        [[x0.max(first_x), y0.max(first_y)], [x1.min(last[0]), y1.min(last[1])]]
    }

    /// Whether all pixels from one column and row to another, of the film, show what is nearer than `nearness`.
    fn hides(&self, [first, last]: [[i32; 2]; 2], nearness: f32) -> bool {
        let at = (first[1] - self.first[1]) as usize * SQUARE + (first[0] - self.first[0]) as usize;
        let [columns, rows] = [0, 1].map(|axis| (last[axis] - first[axis] + 1) as usize);
        // a whole row at once: several pixels in one operation
        let row_hides = |row: &[f32]| row[..columns].iter().fold(true, |all, shown| all & (*shown > nearness));
        self.nearness[at..].chunks(SQUARE).take(rows).all(row_hides)
    }

    /// Nearness of what a pixel of the film shows.
    #[inline]
    pub fn nearness_at(&self, [x, y]: [i32; 2]) -> f32 {
        self.nearness[(y - self.first[1]) as usize * SQUARE + (x - self.first[0]) as usize]
    }

    /// Draws on a pixel of the film.
    #[inline]
    pub fn draw_pixel(&mut self, [x, y]: [i32; 2], nearness: f32, number: u32) {
        let at = (y - self.first[1]) as usize * SQUARE + (x - self.first[0]) as usize;
        let (old_nearness, old_number) = (&mut self.nearness[at], &mut self.numbers[at]);
        if nearness > *old_nearness || nearness == *old_nearness && number < *old_number {
            (*old_nearness, *old_number) = (nearness, number);
        }
    }

    /// The numbers of what is seen from a pixel of the film on, along a row; none where nothing was ever drawn.
    #[inline]
    pub fn row(&self, [x, y]: [i32; 2], length: usize) -> &[u32] {
        let at = (y - self.first[1]) as usize * SQUARE + (x - self.first[0]) as usize;
        self.numbers.get(at..at + length).unwrap_or(&[])
    }

    /// Whether nothing was ever drawn on it.
    pub fn is_untouched(&self) -> bool {
        self.numbers.is_empty()
    }

    /// What is seen at a pixel of the film; `batch`: of the numbers.
    #[inline]
    pub fn seen(&self, batch: &Batch, [x, y]: [i32; 2]) -> Option<Seen> {
        let at = (y - self.first[1]) as usize * SQUARE + (x - self.first[0]) as usize;
        match *self.numbers.get(at)? {
            NOTHING => self.earlier.get(at).copied().flatten(),
            number => batch.seen(number),
        }
    }

    /// Makes room for the numbers of another batch.
    pub fn end_batch(&mut self, batch: &Batch) {
        self.earlier.resize(self.numbers.len(), None);
        for (number, seen) in self.numbers.iter_mut().zip(&mut self.earlier) {
            if *number != NOTHING {
                *seen = batch.seen(*number);
                *number = NOTHING;
            }
        }
    }
}

/// Draws on a canvas, and holds the square that it last drew on until it goes to another: triangles that follow one
/// another mostly lie in the same.
pub struct Pencil<'a> {
    canvas: &'a Canvas,
    at: Option<(usize, MutexGuard<'a, Square>)>,
}

impl Pencil<'_> {
    /// Draws a triangle; where `is_there` is given, at the pixels alone for which it says so.
    #[inline]
    pub fn draw(&mut self, triangle: &Triangle, is_there: Option<&dyn Fn([i32; 2]) -> bool>) {
        let [[x0, x1], [y0, y1]] = triangle.pixels().map(|range| range.map(|pixel| pixel as usize / SQUARE));
        for row in y0..y1 + 1 {
            for column in x0..x1 + 1 {
                let index = row * self.canvas.columns + column;
                triangle.fill(&self.canvas.grid, self.square(index), is_there);
            }
        }
    }

    /// Whether nothing of what reaches so far can be seen.
    pub fn hides(&mut self, reach: &Reach) -> bool {
        let [[x0, x1], [y0, y1]] = reach.pixels;
        let of = |pixel: i32| pixel as usize / SQUARE;
        if x0 > x1 || y0 > y1 {
            return true;
        }
        for row in of(y0)..of(y1) + 1 {
            for column in of(x0)..of(x1) + 1 {
                let square = self.square(row * self.canvas.columns + column);
                let range = square.part_of(reach.pixels);
                if !square.hides(range, reach.nearness) {
                    return false;
                }
            }
        }
        true
    }

    /// The square that a pixel is in.
    #[inline]
    pub fn square_at(&mut self, [x, y]: [i32; 2]) -> &mut Square {
        self.square(y as usize / SQUARE * self.canvas.columns + x as usize / SQUARE)
    }

    #[inline]
    fn square(&mut self, index: usize) -> &mut Square {
        if self.at.as_ref().is_none_or(|(at, _)| *at != index) {
            // the old one is let go before another is waited for: nobody can wait in a circle
            self.at = None;
        }
        let (_, square) = self.at.get_or_insert_with(|| {
            let mut square = self.canvas.squares[index].lock().unwrap_or_else(PoisonError::into_inner);
            if square.numbers.is_empty() {
                square.nearness = vec![self.canvas.grid.far_nearness; SQUARE * SQUARE];
                square.numbers = vec![NOTHING; SQUARE * SQUARE];
            }
            (index, square)
        });
        square
    }
}
