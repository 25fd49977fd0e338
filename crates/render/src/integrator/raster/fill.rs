//! Which pixels' middles a triangle covers, and whether it is the nearest there.
//!
//! Edge functions are exact, in whole numbers (Pineda 1988, "A Parallel Algorithm for Polygon Rasterization"): nothing
//! gets through between triangles that share an edge. What lies on it belongs to both, and of what is as near the
//! one that rays meet first is seen. A fill rule such as "top left" would give it to one of them alone, by where that
//! lies on the film; that matters where colours are mixed, which they are not here.
//!
//! Several pixels of a row are tested at once, by plain loops over arrays that compilers make vector instructions of.

use std::ops::{Add, BitOr, Mul};

use super::project::{Grid, Vertex};
use super::square::{NOTHING, Pixels, Square};
use crate::clusters::LANES;

/// A projected triangle that may cover pixels' middles.
#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    /// Its corners, anticlockwise.
    corners: [Vertex; 3],
    /// Twice its area, square grid units.
    area: i64,
    is_clockwise: bool,
    number: u32,
}

/// What else decides about a triangle's pixels.
pub trait Rules {
    /// Whether a triangle goes before another that is as near; by their numbers.
    fn is_first(&self, number: u32, shown: u32) -> bool;
    /// Whether the triangle is there at a pixel of the film.
    #[inline(always)]
    fn is_there(&self, _pixel: [i32; 2]) -> bool {
        true
    }
}

impl Triangle {
    /// `None` where it has no area.
    #[inline(always)]
    pub fn new(corners: [Vertex; 3], number: u32) -> Option<Self> {
        let area = twice_area(&corners);
        let [a, b, c] = corners;
        let is_clockwise = area < 0;
        let corners = if is_clockwise { [a, c, b] } else { corners };
        (area != 0).then(|| Self { corners, area: area.abs(), is_clockwise, number })
    }
    /// How its corners went round on the film, where y is up.
    #[inline(always)]
    pub fn is_clockwise(&self) -> bool {
        self.is_clockwise
    }

    /// Draws it on a square, on which its box holds the middles of `pixels`: first and last column, first and last row
    /// of the film.
    #[inline(always)]
    pub fn fill(&self, grid: &Grid, square: &mut Square, pixels: [[i32; 2]; 2], rules: &impl Rules) {
        let [a, b, c] = self.corners;
        let first = [grid.center(pixels[0][0], grid.width), grid.center(pixels[1][0], grid.height)];
        let edges = [Edge::new(a, b, first), Edge::new(b, c, first), Edge::new(c, a, first)];
        let mut longest = 0;
        for edge in &edges {
            longest = longest.max(edge.across.abs()).max(edge.up.abs());
        }
        let cover = Cover { grid, triangle: self, edges, pixels, nearness: self.most_nearness() };
        if longest <= grid.short {
            cover.draw::<i32>(square, rules);
        } else {
            cover.draw::<i64>(square, rules);
        }
    }

    /// No less than its nearness anywhere, whatever the rounding.
    #[inline(always)]
    fn most_nearness(&self) -> f32 {
        let [a, b, c] = &self.corners;
        let most = if a.nearness > b.nearness { a.nearness } else { b.nearness };
        let most = if most > c.nearness { most } else { c.nearness };
        most + most.abs() * (8.0 * f32::EPSILON)
    }
}

/// Twice the area of a projected triangle, square grid units: negative where it winds clockwise.
#[inline(always)]
fn twice_area([a, b, c]: &[Vertex; 3]) -> i64 {
    // coordinates have 30 bits, their differences 31
    i64::from(b.x - a.x) * i64::from(c.y - a.y) - i64::from(b.y - a.y) * i64::from(c.x - a.x)
}

/// An edge function at pixel middles: not negative on the triangle's side and on the edge.
#[derive(Clone, Copy)]
struct Edge {
    /// At the first pixel, square grid units.
    value: i64,
    /// Change from pixel to pixel, pixels times grid units.
    across: i32,
    /// Change from row to row, upwards.
    up: i32,
}

impl Edge {
    #[inline(always)]
    fn new(a: Vertex, b: Vertex, first: [i32; 2]) -> Self {
        let (dx, dy, px, py) = (b.x - a.x, b.y - a.y, first[0] - a.x, first[1] - a.y);
        Self { value: i64::from(dx) * i64::from(py) - i64::from(dy) * i64::from(px), across: -dy, up: dx }
    }
}

/// A whole number in which edge functions are told pixel by pixel.
trait Whole: Copy + Add<Output = Self> + Mul<Output = Self> + BitOr<Output = Self> + From<i32> {
    /// Of a number that it has room for.
    fn of(value: i64) -> Self;
    /// All bits where it is negative, else none.
    fn sign(self) -> i32;
}

impl Whole for i32 {
    #[inline(always)]
    fn of(value: i64) -> Self {
        value as Self
    }
    #[inline(always)]
    fn sign(self) -> i32 {
        self >> 31
    }
}

impl Whole for i64 {
    #[inline(always)]
    fn of(value: i64) -> Self {
        value
    }
    #[inline(always)]
    fn sign(self) -> i32 {
        (self >> 63) as i32
    }
}

/// A triangle over a rectangle of a square's pixels.
struct Cover<'a> {
    grid: &'a Grid,
    triangle: &'a Triangle,
    edges: [Edge; 3],
    /// First and last column, first and last row of the film.
    pixels: [[i32; 2]; 2],
    /// No less than the triangle's anywhere.
    nearness: f32,
}

impl Cover<'_> {
    #[inline(always)]
    fn draw<T: Whole>(&self, square: &mut Square, rules: &impl Rules) {
        let [[x0, x1], [y0, y1]] = self.pixels;
        let mut plane = None;
        let mut x = x0;
        while x <= x1 {
            let [mut a, mut b, mut c] = [self.lanes::<T>(0, x), self.lanes::<T>(1, x), self.lanes::<T>(2, x)];
            let column = (x - square.first[0]) as usize;
            for y in y0..y1 + 1 {
                let Some(pixels) = square.pixels([column, (y - square.first[1]) as usize]) else { return };
                let (mut mask, mut any) = ([0; LANES], 0);
                for i in 0..LANES {
                    let is_outside = (a[i] | b[i] | c[i]).sign();
                    mask[i] = !is_outside & -i32::from(pixels.nearness[i] <= self.nearness);
                    any |= mask[i];
                }
                if any != 0 {
                    if plane.is_none() {
                        plane = Some(Plane::new(self));
                    }
                    if let Some(plane) = &plane {
                        self.put(pixels, mask, &plane.at(x - x0, y - y0), [x, y], rules);
                    }
                }
                for i in 0..LANES {
                    a[i] = a[i] + T::from(self.edges[0].up);
                    b[i] = b[i] + T::from(self.edges[1].up);
                    c[i] = c[i] + T::from(self.edges[2].up);
                }
            }
            x += LANES as i32;
        }
    }

    /// An edge function at some pixels of the first row, from column `x` on; in pixels times grid units: steps from
    /// pixel to pixel are whole, and what is less than one does not change the sign.
    #[inline(always)]
    fn lanes<T: Whole>(&self, edge: usize, x: i32) -> [T; LANES] {
        let edge = &self.edges[edge];
        let (value, across) = (T::of(edge.value >> self.grid.subpixel_bits), T::from(edge.across));
        let mut lanes = [value; LANES];
        for i in 0..LANES {
            lanes[i] = lanes[i] + across * T::from(x - self.pixels[0][0] + i as i32);
        }
        lanes
    }

    /// Shows it at those of some pixels that `mask` names and where nothing is nearer. `pixel`: the first of them.
    #[inline(always)]
    fn put(
        &self,
        shown: Pixels<'_>,
        mask: [i32; LANES],
        nearness: &[f32; LANES],
        [x, y]: [i32; 2],
        rules: &impl Rules,
    ) {
        let (mut drawn, mut is_tie) = ([false; LANES], false);
        for i in 0..LANES {
            drawn[i] = mask[i] != 0 && rules.is_there([x + i as i32, y]);
            is_tie |= drawn[i] & (nearness[i] == shown.nearness[i]);
        }
        if is_tie {
            self.settle(shown.nearness, shown.numbers, &drawn, nearness, rules);
        }
        for i in 0..LANES {
            let is_nearer = drawn[i] & (nearness[i] > shown.nearness[i]);
            shown.nearness[i] = if is_nearer { nearness[i] } else { shown.nearness[i] };
            shown.numbers[i] = if is_nearer { self.triangle.number } else { shown.numbers[i] };
        }
    }

    /// Decides where it is as near as what is shown.
    #[cold]
    fn settle(
        &self,
        shown: &[f32; LANES],
        numbers: &mut [u32; LANES],
        drawn: &[bool; LANES],
        nearness: &[f32; LANES],
        rules: &impl Rules,
    ) {
        for i in 0..LANES {
            let is_tie = drawn[i] && nearness[i] == shown[i] && numbers[i] != NOTHING;
            if is_tie && rules.is_first(self.triangle.number, numbers[i]) {
                numbers[i] = self.triangle.number;
            }
        }
    }
}

/// The nearness of a triangle: linear over the film.
struct Plane {
    /// At the first pixel.
    value: f64,
    across: f64,
    up: f64,
}

impl Plane {
    #[inline(always)]
    fn new(cover: &Cover<'_>) -> Self {
        let [a, b, c] = &cover.triangle.corners;
        let (a, b, c) = (f64::from(a.nearness), f64::from(b.nearness), f64::from(c.nearness));
        let (b, c, per_area) = (b - a, c - a, 1.0 / cover.triangle.area as f64);
        // the weights of b and c are the functions of the edges opposite to them
        let [of_c, _, of_b] = &cover.edges;
        let unit = f64::from(1u32 << cover.grid.subpixel_bits);
        Self {
            value: a + (of_b.value as f64 * b + of_c.value as f64 * c) * per_area,
            across: (f64::from(of_b.across) * unit * b + f64::from(of_c.across) * unit * c) * per_area,
            up: (f64::from(of_b.up) * unit * b + f64::from(of_c.up) * unit * c) * per_area,
        }
    }
    /// At some pixels of a row.
    #[inline(always)]
    fn at(&self, column: i32, row: i32) -> [f32; LANES] {
        let up = self.up * f64::from(row);
        let mut nearness = [0.0; LANES];
        for i in 0..LANES {
            nearness[i] = (self.value + self.across * f64::from(column + i as i32) + up) as f32;
        }
        nearness
    }
}
