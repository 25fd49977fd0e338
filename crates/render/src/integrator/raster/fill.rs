//! Which pixels' middles a triangle covers, and whether it is the nearest there.
//!
//! Edge functions are exact, in whole numbers (Pineda 1988, "A Parallel Algorithm for Polygon Rasterization"): nothing
//! gets through between triangles that share an edge. What lies on it belongs to both, and of what is as near the
//! smaller number is seen, as where a ray hits both. A fill rule such as "top left" would give it to one of them
//! alone, by where that lies on the film; that matters where colours are mixed, which they are not here.

use super::project::{Grid, Vertex};
use super::visibility::{SQUARE, Square};

/// Triangles up to so many pixels across are tested pixel by pixel.
const NARROW: i32 = 8;

/// A projected triangle, and which pixels it may cover.
#[derive(Clone, Copy, Debug)]
pub struct Boxed {
    /// Its corners.
    pub corners: [Vertex; 3],
    /// What it is seen as.
    pub number: u32,
    /// First and last column, first and last row whose middles its box holds.
    pub pixels: [[i32; 2]; 2],
}

impl Boxed {
    /// One that covers nothing.
    pub const NOTHING: Self = Self { corners: [Vertex::OFF_GRID; 3], number: 0, pixels: [[0, -1]; 2] };

    /// Finds the pixels.
    #[inline]
    pub fn new(grid: &Grid, corners: [Vertex; 3], number: u32) -> Self {
        let [a, b, c] = corners;
        let columns = grid.pixels_between(a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x), grid.width);
        let rows = grid.pixels_between(a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y), grid.height);
        Self { corners, number, pixels: [columns, rows] }
    }
    /// Whether there are none.
    #[inline]
    pub fn is_empty(&self) -> bool {
        let [[x0, x1], [y0, y1]] = self.pixels;
        // of two numbers the sign bit of either, without a branch
        (x1 - x0) | (y1 - y0) < 0
    }
}

/// A projected triangle that may cover pixels' middles.
#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    /// Its corners, anticlockwise.
    corners: [Vertex; 3],
    /// Twice its area, square grid units.
    area: i64,
    is_clockwise: bool,
    number: u32,
    pixels: [[i32; 2]; 2],
}

impl Triangle {
    /// `None` where it has no area.
    #[inline]
    pub fn new(boxed: &Boxed) -> Option<Self> {
        let Boxed { corners, number, pixels } = *boxed;
        let area = twice_area(&corners);
        let [a, b, c] = corners;
        let is_clockwise = area < 0;
        let corners = if is_clockwise { [a, c, b] } else { corners };
        (area != 0).then(|| Self { corners, area: area.abs(), is_clockwise, number, pixels })
    }
    /// How its corners went round on the film, where y is up.
    pub fn is_clockwise(&self) -> bool {
        self.is_clockwise
    }
    /// First and last column, first and last row that it may cover.
    pub fn pixels(&self) -> [[i32; 2]; 2] {
        self.pixels
    }

    /// Draws it on one of the squares that it may reach.
    #[inline]
    pub fn fill(&self, grid: &Grid, square: &mut Square, is_there: Option<&dyn Fn([i32; 2]) -> bool>) {
        let range = square.part_of(self.pixels);
        let [first, last] = range;
        let cover = Cover::new(grid, self, first, [last[0] - first[0] + 1, last[1] - first[1] + 1]);
        match is_there {
            None if cover.size[0] <= NARROW => cover.draw_pixels(square, |_| true),
            None => cover.draw_spans(square),
            Some(is_there) => cover.draw_masked(square, is_there),
        }
    }
}

/// No less than a triangle's nearness anywhere, whatever the rounding.
#[inline]
fn most_nearness(corners: &[Vertex; 3]) -> f32 {
    let [a, b, c] = corners.map(|v| v.nearness);
    let most = if a > b { a } else { b };
    let most = if most > c { most } else { c };
    most + most.abs() * (8.0 * f32::EPSILON)
}

/// Twice the area of a projected triangle, square grid units: negative where it winds clockwise.
#[inline]
fn twice_area([a, b, c]: &[Vertex; 3]) -> i64 {
    let along = |from: i32, to: i32| i64::from(to) - i64::from(from);
    along(a.x, b.x) * along(a.y, c.y) - along(a.y, b.y) * along(a.x, c.x)
}

/// An edge function at pixel middles: not negative on the triangle's side and on the edge.
#[derive(Clone, Copy)]
struct Edge {
    /// At the first pixel.
    value: i64,
    /// Change from pixel to pixel.
    across: i64,
    /// Change from row to row, upwards.
    up: i64,
}

impl Edge {
    #[inline]
    fn new(grid: &Grid, a: Vertex, b: Vertex, first: [i32; 2]) -> Self {
        let [dx, dy] = [i64::from(b.x) - i64::from(a.x), i64::from(b.y) - i64::from(a.y)];
        let [px, py] = [i64::from(first[0]) - i64::from(a.x), i64::from(first[1]) - i64::from(a.y)];
        Self { value: dx * py - dy * px, across: -dy << grid.subpixel_bits, up: dx << grid.subpixel_bits }
    }
}

/// A triangle over a rectangle of a square's pixels.
struct Cover<'a> {
    triangle: &'a Triangle,
    edges: [Edge; 3],
    /// The first pixel.
    first: [i32; 2],
    /// Columns and rows.
    size: [i32; 2],
}

/// Draws a triangle whose box holds the middle of one pixel, in few operations. False, and nothing drawn, where an edge
/// goes through the middle: that takes all the rules.
#[inline]
pub fn draw_point(grid: &Grid, boxed: &Boxed, culled: [bool; 2], square: &mut Square) -> bool {
    let [x, y] = [boxed.pixels[0][0], boxed.pixels[1][0]];
    if square.nearness_at([x, y]) > most_nearness(&boxed.corners) {
        return true;
    }
    let (middle_x, middle_y) = (grid.center(x, grid.width), grid.center(y, grid.height));
    let [a, b, c] = boxed.corners.map(|v| [i64::from(v.x - middle_x), i64::from(v.y - middle_y)]);
    let area = |p: [i64; 2], q: [i64; 2]| p[0] * q[1] - p[1] * q[0];
    let weights = [area(b, c), area(c, a), area(a, b)];
    if weights.contains(&0) {
        return false;
    }
    let is_inside = !(weights[0] ^ weights[1] | weights[0] ^ weights[2]) < 0;
    if is_inside && !culled[usize::from(weights[0] < 0)] {
        let [a, b, c] = boxed.corners.map(|v| f64::from(v.nearness));
        let [of_a, of_b, of_c] = weights.map(|w| w as f64);
        let nearness = ((of_a * a + of_b * b + of_c * c) / (of_a + of_b + of_c)) as f32;
        square.draw_pixel([x, y], nearness, boxed.number);
    }
    true
}

impl<'a> Cover<'a> {
    #[inline]
    fn new(grid: &Grid, triangle: &'a Triangle, first: [i32; 2], size: [i32; 2]) -> Self {
        let [a, b, c] = triangle.corners;
        let middle = [grid.center(first[0], grid.width), grid.center(first[1], grid.height)];
        let edges = [(a, b), (b, c), (c, a)].map(|(from, to)| Edge::new(grid, from, to, middle));
        Self { triangle, edges, first, size }
    }

    /// Tests pixel by pixel.
    #[inline]
    fn draw_pixels(&self, square: &mut Square, is_there: impl Fn([i32; 2]) -> bool) {
        let mut plane = None;
        let (start, width) = (self.start(square), self.size[0] as usize);
        let steps = self.edges.map(|e| e.across);
        for j in 0..self.size[1] {
            let mut values = self.row(j);
            let row = start + j as usize * SQUARE;
            let old = square.nearness[row..row + width].iter_mut().zip(&mut square.numbers[row..row + width]);
            for (i, (old_nearness, old_number)) in (0..).zip(old) {
                if values[0] | values[1] | values[2] >= 0 && is_there([self.first[0] + i, self.first[1] + j]) {
                    let plane: &Plane = plane.get_or_insert_with(|| Plane::new(self));
                    let (nearness, number) = (plane.at(i, j), self.triangle.number);
                    if nearness > *old_nearness || nearness == *old_nearness && number < *old_number {
                        (*old_nearness, *old_number) = (nearness, number);
                    }
                }
                values = std::array::from_fn(|k| values[k] + steps[k]);
            }
        }
    }

    /// Tests pixel by pixel, and asks.
    #[cold]
    fn draw_masked(&self, square: &mut Square, is_there: &dyn Fn([i32; 2]) -> bool) {
        self.draw_pixels(square, is_there);
    }

    /// Works out where each row begins and ends.
    #[inline(never)]
    fn draw_spans(&self, square: &mut Square) {
        // the largest value of an edge function in a rectangle is at one of its corners
        let most = |e: &Edge| {
            e.value + e.across.max(0) * i64::from(self.size[0] - 1) + e.up.max(0) * i64::from(self.size[1] - 1)
        };
        if self.edges.iter().any(|e| most(e) < 0) {
            return;
        }
        let plane = Plane::new(self);
        let per_step = self.edges.map(|e| 1.0 / e.across.abs() as f64);
        for j in 0..self.size[1] {
            let Some([from, to]) = self.span(j, per_step) else { continue };
            let row = self.start(square) + j as usize * SQUARE;
            let range = row + from as usize..=row + to as usize;
            let (nearness, numbers) = (&mut square.nearness[range.clone()], &mut square.numbers[range]);
            draw_span(nearness, numbers, self.triangle.number, |i| plane.at(from + i, j));
        }
    }

    /// Index of the first pixel in the square.
    fn start(&self, square: &Square) -> usize {
        (self.first[1] - square.first[1]) as usize * SQUARE + (self.first[0] - square.first[0]) as usize
    }

    /// The edge functions at the first pixel of a row.
    #[inline]
    fn row(&self, j: i32) -> [i64; 3] {
        self.edges.map(|e| e.value + e.up * i64::from(j))
    }

    /// First and last covered column of a row, from the rectangle's first one. `per_step`: one over the size of each
    /// edge's step.
    #[inline]
    fn span(&self, j: i32, per_step: [f64; 3]) -> Option<[i32; 2]> {
        let (mut from, mut to) = (0, i64::from(self.size[0]) - 1);
        for ((edge, value), per_step) in self.edges.iter().zip(self.row(j)).zip(per_step) {
            let (step, size) = (edge.across, i64::from(self.size[0]));
            // what is found in floating point is at most one off: the exact values beside it decide
            let near = ((value.abs() as f64 * per_step) as i64).min(size);
            let is_outside = |column: i64| i64::from(value + step * column < 0);
            let beside = [near - 1, near, near + 1].map(is_outside);
            let outside = beside[0] + beside[1] + beside[2];
            if step > 0 {
                from = from.max(if value < 0 { near - 1 + outside } else { 0 });
            } else if value < 0 {
                return None;
            } else if step < 0 {
                to = to.min(near + 1 - outside);
            }
        }
        (from <= to).then_some([from as i32, to as i32])
    }
}

/// Draws neighbouring pixels, of a nearness that depends on how many of them are before.
#[inline]
fn draw_span(nearness: &mut [f32], numbers: &mut [u32], number: u32, nearness_at: impl Fn(i32) -> f32) {
    let mut is_tie = false;
    for (i, (old_nearness, old_number)) in (0..).zip(nearness.iter_mut().zip(numbers.iter_mut())) {
        let nearness = nearness_at(i);
        let is_nearer = nearness > *old_nearness;
        is_tie |= nearness == *old_nearness;
        *old_number = if is_nearer { number } else { *old_number };
        *old_nearness = if is_nearer { nearness } else { *old_nearness };
    }
    if is_tie {
        for (i, (old_nearness, old_number)) in (0..).zip(nearness.iter().zip(numbers)) {
            if nearness_at(i) == *old_nearness {
                *old_number = number.min(*old_number);
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
    #[inline]
    fn new(cover: &Cover<'_>) -> Self {
        let [a, b, c] = cover.triangle.corners.map(|v| f64::from(v.nearness));
        let per_area = 1.0 / cover.triangle.area as f64;
        // the weights of b and c are the functions of the edges opposite to them
        let weighed = |of_b: i64, of_c: i64| (of_b as f64 * (b - a) + of_c as f64 * (c - a)) * per_area;
        let [opposite_c, _, opposite_b] = &cover.edges;
        Self {
            value: a + weighed(opposite_b.value, opposite_c.value),
            across: weighed(opposite_b.across, opposite_c.across),
            up: weighed(opposite_b.up, opposite_c.up),
        }
    }
    #[inline]
    fn at(&self, i: i32, j: i32) -> f32 {
        (self.value + self.across * f64::from(i) + self.up * f64::from(j)) as f32
    }
}
