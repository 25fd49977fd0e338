//! Triangles with short edges, set up several at a time: most of what is drawn covers a pixel or none.
//!
//! They cover what [`Triangle`](super::fill::Triangle) says they do, and are as near: its whole numbers have few
//! enough bits here to be exact as floating-point ones, which vector units multiply.

use bytemuck::cast;
use wide::f32x8;

use super::fill::{Rules, larger};
use super::project::{Grid, ROUNDER, Vertex};
use super::square::{LANES, NOTHING, Pixels, Square};

/// Triangles that are set up together.
pub const BATCH: usize = 8;

/// A number of each of them.
type Each<T> = [T; BATCH];

/// Projected triangles, by corner and coordinate, each with the pixels whose middles its box holds.
#[derive(Clone, Copy, Debug, Default)]
pub struct Batch {
    x: [Each<i32>; 3],
    y: [Each<i32>; 3],
    nearness: [Each<f32>; 3],
    /// First column and row of the film.
    column: Each<i32>,
    row: Each<i32>,
    /// Whether the box holds the middles of other pixels too.
    has_more: Each<bool>,
}

impl Batch {
    /// Sets one. `pixels`: first and last column, first and last row.
    #[inline(always)]
    pub fn set(&mut self, i: usize, corners: [Vertex; 3], [[x0, x1], [y0, y1]]: [[i32; 2]; 2]) {
        for (corner, Vertex { x, y, nearness }) in corners.into_iter().enumerate() {
            (self.x[corner][i], self.y[corner][i], self.nearness[corner][i]) = (x, y, nearness);
        }
        (self.column[i], self.row[i], self.has_more[i]) = (x0, y0, (x0 != x1) | (y0 != y1));
    }
    /// Corners of one.
    pub fn corners(&self, i: usize) -> [Vertex; 3] {
        let corner = |k: usize| Vertex { x: self.x[k][i], y: self.y[k][i], nearness: self.nearness[k][i] };
        [corner(0), corner(1), corner(2)]
    }
}

/// Triangles of a batch, ready to be drawn; see [`Triangle`](super::fill::Triangle) for what the numbers are.
#[derive(Clone, Copy, Debug)]
pub struct Short {
    /// The longest side of an edge's box, grid units; more than [`Grid::short`] where a corner is off the grid.
    longest: Each<i32>,
    /// Twice the area, square grid units: negative where the corners go round clockwise.
    area: Each<f64>,
    /// Edge functions at the first pixel, pixels times grid units: not negative inside, whichever way corners go round.
    values: [Each<i32>; 3],
    /// Their change by one pixel across, and one up.
    across: [Each<i32>; 3],
    up: [Each<i32>; 3],
    /// Nearness at the first pixel, and its change by one across and one up.
    nearness: Each<f64>,
    nearness_across: Each<f64>,
    nearness_up: Each<f64>,
    /// What its nearness does not exceed.
    most_nearness: Each<f32>,
}

impl Short {
    /// Sets up a batch.
    #[inline(always)]
    pub fn new(grid: &Grid, batch: &Batch) -> Self {
        let mut short = Self {
            longest: [0; BATCH],
            area: [0.0; BATCH],
            values: [[0; BATCH]; 3],
            across: [[0; BATCH]; 3],
            up: [[0; BATCH]; 3],
            nearness: [0.0; BATCH],
            nearness_across: [0.0; BATCH],
            nearness_up: [0.0; BATCH],
            most_nearness: [0.0; BATCH],
        };
        let unit = f64::from(1u32 << grid.subpixel_bits);
        let per_unit = 1.0 / unit;
        // values go in steps of one over the unit: the integer nearest to a value less a half, and half a step more, is its
        // floor, and none is as near
        let floor = 0.5 * per_unit - 0.5;
        let float = |v: i32| f64::from(v);
        for i in 0..BATCH {
            let [ax, bx, cx] = [batch.x[0][i], batch.x[1][i], batch.x[2][i]];
            let [ay, by, cy] = [batch.y[0][i], batch.y[1][i], batch.y[2][i]];
            let px = grid.center(batch.column[i], grid.width);
            let py = grid.center(batch.row[i], grid.height);
            let (dx, dy) = ([bx - ax, cx - bx, ax - cx], [by - ay, cy - by, ay - cy]);
            let to_pixel = [[px - ax, py - ay], [px - bx, py - by], [px - cx, py - cy]];
            let area = float(dx[2]) * float(dy[0]) - float(dy[2]) * float(dx[0]);
            let sign = if area < 0.0 { -1 } else { 1 };
            // where all corners are off the grid, edges would seem to have no length
            let mut longest = if ax == Vertex::OFF_GRID.x { i32::MAX } else { 0 };
            let mut values = [0.0; 3];
            for k in 0..3 {
                longest = longest.max(dx[k].abs()).max(dy[k].abs());
                values[k] = float(dx[k]) * float(to_pixel[k][1]) - float(dy[k]) * float(to_pixel[k][0]);
                short.values[k][i] = (values[k] * float(sign) * per_unit + floor + ROUNDER).to_bits() as i32;
                short.across[k][i] = -dy[k] * sign;
                short.up[k][i] = dx[k] * sign;
            }
            (short.longest[i], short.area[i]) = (longest, area);
            // the weights of b and c are the functions of the edges opposite to them, over the area
            let [a, b, c] = [0, 1, 2].map(|corner| batch.nearness[corner][i]);
            short.most_nearness[i] = larger(larger(a, b), c);
            let [a, b, c] = [a, b, c].map(f64::from);
            let (b, c) = (b - a, c - a);
            let per_area = 1.0 / area;
            short.nearness[i] = a + (values[2] * b + values[0] * c) * per_area;
            short.nearness_across[i] = (float(-dy[2]) * unit * b + float(-dy[0]) * unit * c) * per_area;
            short.nearness_up[i] = (float(dx[2]) * unit * b + float(dx[0]) * unit * c) * per_area;
        }
        short
    }

    /// Whether one has edges that are short enough for its numbers to be right; else it must be drawn by itself.
    #[inline(always)]
    pub fn is_short(&self, grid: &Grid, i: usize) -> bool {
        self.longest[i] <= grid.short
    }
    /// Those that may cover something or are not short, of the first `count`; how many they are.
    #[inline(always)]
    pub fn covering(&self, grid: &Grid, batch: &Batch, count: usize) -> ([usize; BATCH], usize) {
        let (mut covering, mut found) = ([0; BATCH], 0);
        let [a, b, c] = &self.values;
        // without branches: nobody can tell beforehand
        for i in 0..count.min(BATCH) {
            covering[found % BATCH] = i;
            found += usize::from(batch.has_more[i] | ((a[i] | b[i] | c[i]) >= 0) | !self.is_short(grid, i));
        }
        (covering, found)
    }
    /// Twice its area, square grid units: negative where its corners go round clockwise.
    #[inline(always)]
    pub fn area(&self, i: usize) -> f64 {
        self.area[i]
    }

    /// Draws one, which has an area, on a square; as [`Triangle::fill`](super::fill::Triangle::fill), but that it is
    /// there wherever it covers a pixel's middle.
    #[inline(always)]
    pub fn fill(&self, i: usize, square: &mut Square, pixels: [[i32; 2]; 2], number: u32, rules: &impl Rules) {
        let mut levels = [0; LANES];
        self.each_row(i, square, pixels, |row, shown| row.show(shown, number, &mut levels));
        if levels.into_iter().fold(0, |all, level| all | level) != 0 {
            self.settle(i, square, pixels, number, rules);
        }
    }

    /// Shows it where what is shown is as near, but comes after it.
    #[cold]
    fn settle(&self, i: usize, square: &mut Square, pixels: [[i32; 2]; 2], number: u32, rules: &impl Rules) {
        self.each_row(i, square, pixels, |row, shown| {
            let nearness = row.nearness();
            for (lane, old) in shown.numbers.iter_mut().enumerate() {
                let is_level = row.is_inside(lane) && nearness[lane] == shown.nearness[lane];
                if is_level && ![NOTHING, number].contains(old) && rules.is_first(number, *old) {
                    *old = number;
                }
            }
        });
    }

    /// Calls `act` with all that its box holds, a few pixels of a row at a time, and with what they show.
    #[inline(always)]
    fn each_row(
        &self,
        i: usize,
        square: &mut Square,
        [[x0, x1], [y0, y1]]: [[i32; 2]; 2],
        mut act: impl FnMut(&Row, Pixels<'_>),
    ) {
        for x in (x0..x1 + 1).step_by(LANES) {
            let mut row = Row::new(self, i, x - x0);
            for y in y0..y1 + 1 {
                let place = [(x - square.first[0]) as usize, (y - square.first[1]) as usize];
                let Some(shown) = square.pixels(place) else { return };
                act(&row, shown);
                row.step();
            }
        }
    }
}

/// A triangle at some pixels of a row.
struct Row {
    /// Edge functions.
    values: [[i32; LANES]; 3],
    /// Their change from row to row.
    up: [i32; 3],
    /// Nearness in the first row, and its change from row to row.
    nearness: [f64; LANES],
    nearness_up: f64,
    most_nearness: f32,
    /// How many rows there were before.
    rows: i32,
}

impl Row {
    /// The first row. `column`: of the first pixel, from the first column.
    #[inline(always)]
    fn new(short: &Short, i: usize, column: i32) -> Self {
        let (mut values, mut nearness) = ([[0; LANES]; 3], [0.0; LANES]);
        for (k, values) in values.iter_mut().enumerate() {
            for (lane, value) in (0..).zip(values) {
                *value = short.values[k][i] + short.across[k][i] * (column + lane);
            }
        }
        for (lane, nearness) in (0..).zip(&mut nearness) {
            *nearness = short.nearness[i] + short.nearness_across[i] * f64::from(column + lane);
        }
        let (nearness_up, most_nearness) = (short.nearness_up[i], short.most_nearness[i]);
        let up = [short.up[0][i], short.up[1][i], short.up[2][i]];
        Self { values, up, nearness, nearness_up, most_nearness, rows: 0 }
    }
    /// Goes to the next row.
    #[inline(always)]
    fn step(&mut self) {
        for (values, up) in self.values.iter_mut().zip(self.up) {
            for value in values {
                *value += up;
            }
        }
        self.rows += 1;
    }
    #[inline(always)]
    fn is_inside(&self, lane: usize) -> bool {
        let [a, b, c] = &self.values;
        (a[lane] | b[lane] | c[lane]) >= 0
    }
    #[inline(always)]
    fn nearness(&self) -> [f32; LANES] {
        let up = self.nearness_up * f64::from(self.rows);
        let mut nearness = [0.0; LANES];
        for (nearness, first) in nearness.iter_mut().zip(&self.nearness) {
            let at = (first + up) as f32;
            *nearness = if at < self.most_nearness { at } else { self.most_nearness };
        }
        nearness
    }
    /// Shows it where nothing is as near. `levels` gets bits where it is as near as what is shown.
    #[inline(always)]
    fn show(&self, shown: Pixels<'_>, number: u32, levels: &mut [u32; LANES]) {
        let nearness = self.nearness();
        let (new, old) = (f32x8::new(nearness), f32x8::new(*shown.nearness));
        // numbers whose bits are all alike: of choices compilers make masked stores, which take some processors long
        let [nearer, level]: [[u32; LANES]; 2] = [cast(new.simd_gt(old)), cast(new.simd_eq(old))];
        let choose = |all: u32, new: u32, old: u32| new & all | old & !all;
        for i in 0..LANES {
            let inside = if self.is_inside(i) { u32::MAX } else { 0 };
            let seen = inside & nearer[i];
            levels[i] |= inside & level[i];
            shown.nearness[i] = f32::from_bits(choose(seen, nearness[i].to_bits(), shown.nearness[i].to_bits()));
            shown.numbers[i] = choose(seen, number, shown.numbers[i]);
        }
    }
}
