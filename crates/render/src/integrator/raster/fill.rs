//! Which pixels' middles a triangle covers, and whether it is the nearest there.
//!
//! Edge functions are exact, in whole numbers (Pineda 1988, "A Parallel Algorithm for Polygon Rasterization"): nothing
//! gets through between triangles that share an edge. What lies on it belongs to both, and of what is as near the
//! one that rays meet first is seen. A fill rule such as "top left" would give it to one of them alone, by where that
//! lies on the film; that matters where colours are mixed, which they are not here.
//!
//! Several pixels of a row are tested at once.

use wide::f32x8;

use super::project::{Grid, Vertex};
use super::square::{LANES, NOTHING, Pixels, Square};

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
        Cover { grid, triangle: self, edges, pixels }.draw(square, rules);
    }

    /// Its nearness at most: what is reckoned at a pixel may be more, by rounding, where it has hardly any area.
    #[inline(always)]
    fn most_nearness(&self) -> f32 {
        let [a, b, c] = self.corners.map(|corner| corner.nearness);
        larger(larger(a, b), c)
    }
}

/// The larger of two numbers; the second where one is none.
#[inline(always)]
pub fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
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

/// The edge functions of a triangle at some pixels of a row.
struct Lanes {
    values: [i64; 3],
    across: [i64; 3],
    steps: [i64; 3],
}

impl Lanes {
    /// From column `x` of the first row on.
    #[inline(always)]
    fn new(cover: &Cover<'_>, x: i32) -> Self {
        let column = i64::from(x - cover.pixels[0][0]);
        Self {
            values: cover.edges.map(|edge| cover.whole(&edge) + i64::from(edge.across) * column),
            across: cover.edges.map(|edge| i64::from(edge.across)),
            steps: cover.edges.map(|edge| i64::from(edge.up)),
        }
    }
    /// A bit for each pixel that the triangle does not cover.
    #[inline(always)]
    fn outside(&self) -> u32 {
        let ([a, b, c], [a_step, b_step, c_step]) = (self.values, self.across);
        let mut bits = 0;
        for i in 0..LANES as i64 {
            let signs = (a + a_step * i) | (b + b_step * i) | (c + c_step * i);
            bits |= u32::from(signs < 0) << i;
        }
        bits
    }
    /// Goes to the next row.
    #[inline(always)]
    fn step(&mut self) {
        for (value, step) in self.values.iter_mut().zip(self.steps) {
            *value += step;
        }
    }
}

/// A triangle over a rectangle of a square's pixels.
struct Cover<'a> {
    grid: &'a Grid,
    triangle: &'a Triangle,
    edges: [Edge; 3],
    /// First and last column, first and last row of the film.
    pixels: [[i32; 2]; 2],
}

impl Cover<'_> {
    /// An edge function at the first pixel, in pixels times grid units: steps from pixel to pixel are whole, and what
    /// is less than one does not change the sign.
    #[inline(always)]
    fn whole(&self, edge: &Edge) -> i64 {
        edge.value >> self.grid.subpixel_bits
    }

    #[inline(always)]
    fn draw(&self, square: &mut Square, rules: &impl Rules) {
        let [[x0, x1], [y0, y1]] = self.pixels;
        let most = self.triangle.most_nearness();
        let mut plane = None;
        for x in (x0..x1 + 1).step_by(LANES) {
            let (mut lanes, column) = (Lanes::new(self, x), (x - square.first[0]) as usize);
            for y in y0..y1 + 1 {
                let Some(shown) = square.pixels([column, (y - square.first[1]) as usize]) else { return };
                let hidden = f32x8::new(*shown.nearness).simd_gt(f32x8::splat(most)).to_bitmask();
                let covered = !(lanes.outside() | hidden) & ((1 << LANES) - 1);
                if covered != 0 {
                    let plane: &Plane = plane.get_or_insert_with(|| Plane::new(self, most));
                    self.put(shown, covered, plane, [x, y], rules);
                }
                lanes.step();
            }
        }
    }

    /// Shows it at those of some pixels for which `covered` has a bit and where nothing is nearer. `pixel`: the first.
    #[inline(always)]
    fn put(&self, shown: Pixels<'_>, mut covered: u32, plane: &Plane, [x, y]: [i32; 2], rules: &impl Rules) {
        while covered != 0 {
            let i = covered.trailing_zeros() as usize % LANES;
            covered &= covered - 1;
            let x = x + i as i32;
            let nearness = plane.at(x - self.pixels[0][0], y - self.pixels[1][0]);
            let (old_nearness, old_number) = (&mut shown.nearness[i], &mut shown.numbers[i]);
            let is_seen = nearness > *old_nearness || nearness == *old_nearness && self.is_first(*old_number, rules);
            if is_seen && rules.is_there([x, y]) {
                (*old_nearness, *old_number) = (nearness, self.triangle.number);
            }
        }
    }

    /// Whether it goes before what is shown and as near.
    #[cold]
    #[inline(never)]
    fn is_first(&self, shown: u32, rules: &impl Rules) -> bool {
        shown != NOTHING && rules.is_first(self.triangle.number, shown)
    }
}

/// The nearness of a triangle: linear over the film.
struct Plane {
    /// At the first pixel.
    value: f64,
    across: f64,
    up: f64,
    /// What it does not exceed.
    most: f32,
}

impl Plane {
    #[inline(always)]
    fn new(cover: &Cover<'_>, most: f32) -> Self {
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
            most,
        }
    }
    /// At a pixel.
    #[inline(always)]
    fn at(&self, column: i32, row: i32) -> f32 {
        let nearness = (self.value + self.across * f64::from(column) + self.up * f64::from(row)) as f32;
        if nearness < self.most { nearness } else { self.most }
    }
}
