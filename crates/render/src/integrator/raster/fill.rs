//! Which triangle is nearest at each pixel's middle.
//!
//! Edge functions are exact, in whole numbers, so that of two triangles that share an edge exactly one covers what
//! lies on it (Pineda 1988, "A Parallel Algorithm for Polygon Rasterization"; the rule is "top left").

use super::bins::{BIN, Projected, twice_area};
use super::project::{Grid, Vertex};

/// Triangles up to so many pixels across are tested pixel by pixel.
const NARROW: i32 = 8;

/// What is seen through a pixel's middle: a triangle of a placement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seen {
    /// Index of the placement.
    pub placement: u32,
    /// Triangle of its mesh.
    pub triangle: u32,
}

impl Seen {
    /// Nothing.
    pub const NOTHING: Self = Self { placement: u32::MAX, triangle: 0 };
}

/// A square of the film, and what is seen there.
#[derive(Debug)]
pub struct Bin {
    /// First column and row.
    pub first: [i32; 2],
    /// Columns and rows.
    pub size: [i32; 2],
    nearness: Vec<f32>,
    seen: Vec<Seen>,
}

impl Bin {
    /// Bin number `index` of a film, where nothing is seen; `columns`: bins across.
    pub fn new(grid: &Grid, index: usize, columns: usize) -> Self {
        let first = [index % columns * BIN, index / columns * BIN].map(|v| v as i32);
        let size = [grid.width - first[0], grid.height - first[1]].map(|left| left.min(BIN as i32));
        Self { first, size, nearness: Vec::new(), seen: Vec::new() }
    }

    /// What is seen at a column and a row of the film.
    pub fn seen(&self, x: i32, y: i32) -> Seen {
        let at = ((y - self.first[1]) as usize) * BIN + (x - self.first[0]) as usize;
        self.seen.get(at).copied().unwrap_or(Seen::NOTHING)
    }

    /// Takes a triangle. `is_there` says whether a masked one is at a pixel.
    pub fn fill(&mut self, grid: &Grid, projected: &Projected, is_there: impl Fn(&Projected, [i32; 2]) -> bool) {
        if self.seen.is_empty() {
            self.nearness = vec![grid.far_nearness; BIN * BIN];
            self.seen = vec![Seen::NOTHING; BIN * BIN];
        }
        let Some(cover) = Cover::new(grid, projected.corners, self) else { return };
        if projected.is_masked() {
            self.pixels(&cover, projected, |at| is_there(projected, at));
        } else if cover.columns <= NARROW {
            self.pixels(&cover, projected, |_| true);
        } else {
            self.spans(&cover, projected);
        }
    }

    /// Tests pixel by pixel.
    #[inline]
    fn pixels(&mut self, cover: &Cover, projected: &Projected, is_there: impl Fn([i32; 2]) -> bool) {
        let seen = Seen { placement: projected.placement(), triangle: projected.triangle };
        for j in 0..cover.rows {
            let [mut e0, mut e1, mut e2] = cover.row(j);
            let row = cover.at + j as usize * BIN;
            let mut nearness = cover.nearness + cover.up * f64::from(j);
            for i in 0..cover.columns {
                let at = row + i as usize;
                if e0 | e1 | e2 >= 0
                    && nearness as f32 > self.nearness[at]
                    && is_there([cover.first[0] + i, cover.first[1] + j])
                {
                    (self.nearness[at], self.seen[at]) = (nearness as f32, seen);
                }
                (e0, e1, e2) = (e0 + cover.edges[0].across, e1 + cover.edges[1].across, e2 + cover.edges[2].across);
                nearness += cover.across;
            }
        }
    }

    /// Works out where each row begins and ends.
    fn spans(&mut self, cover: &Cover, projected: &Projected) {
        let seen = Seen { placement: projected.placement(), triangle: projected.triangle };
        for j in 0..cover.rows {
            let Some((from, to)) = cover.span(j) else { continue };
            let start = (cover.nearness + cover.up * f64::from(j) + cover.across * from as f64) as f32;
            let across = cover.across as f32;
            let row = cover.at + j as usize * BIN;
            let range = row + from as usize..=row + to as usize;
            let old = self.nearness[range.clone()].iter_mut().zip(&mut self.seen[range]);
            for (i, (old_nearness, old_seen)) in (0u8..).zip(old) {
                let nearness = start + across * f32::from(i);
                let nearer = nearness > *old_nearness;
                *old_nearness = if nearer { nearness } else { *old_nearness };
                *old_seen = if nearer { seen } else { *old_seen };
            }
        }
    }
}

/// An edge function at pixel middles: not negative on the triangle's side, and where the edge itself counts.
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
        // anticlockwise with y up, the left edges go down and the top ones to the left
        let is_top_left = dy < 0 || dy == 0 && dx < 0;
        Self {
            value: dx * py - dy * px - i64::from(!is_top_left),
            across: -dy << grid.subpixel_bits,
            up: dx << grid.subpixel_bits,
        }
    }
}

/// A triangle as the pixels of a bin see it.
struct Cover {
    edges: [Edge; 3],
    /// Pixels that its box holds: the first one, and how many.
    first: [i32; 2],
    columns: i32,
    rows: i32,
    /// Index of the first pixel in the bin.
    at: usize,
    /// Nearness at the first pixel, and its change along a row and from row to row.
    nearness: f64,
    across: f64,
    up: f64,
}

impl Cover {
    /// `None` where it covers no pixel's middle there.
    #[inline]
    fn new(grid: &Grid, corners: [Vertex; 3], bin: &Bin) -> Option<Self> {
        let area = twice_area(&corners);
        let [a, b, c] = if area < 0 { [corners[0], corners[2], corners[1]] } else { corners };
        let (x0, x1) = grid.pixels_between(a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x), grid.width);
        let (y0, y1) = grid.pixels_between(a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y), grid.height);
        let first = [x0.max(bin.first[0]), y0.max(bin.first[1])];
        let columns = (x1 + 1).min(bin.first[0] + bin.size[0]) - first[0];
        let rows = (y1 + 1).min(bin.first[1] + bin.size[1]) - first[1];
        if columns <= 0 || rows <= 0 {
            return None;
        }
        let middle = [grid.center(first[0], grid.width), grid.center(first[1], grid.height)];
        let edges = [(a, b), (b, c), (c, a)].map(|(from, to)| Edge::new(grid, from, to, middle));
        // the largest value of an edge function in the box is at one of its corners
        let most = |e: &Edge| e.value + e.across.max(0) * i64::from(columns - 1) + e.up.max(0) * i64::from(rows - 1);
        if edges.iter().any(|e| most(e) < 0) {
            return None;
        }
        // the weights of b and c are the functions of the edges opposite to them
        let per_area = 1.0 / area.abs() as f64;
        let (to_b, to_c) =
            (f64::from(b.nearness) - f64::from(a.nearness), f64::from(c.nearness) - f64::from(a.nearness));
        let weighed = |of_b: i64, of_c: i64| (of_b as f64 * to_b + of_c as f64 * to_c) * per_area;
        Some(Self {
            edges,
            first,
            columns,
            rows,
            at: (first[1] - bin.first[1]) as usize * BIN + (first[0] - bin.first[0]) as usize,
            nearness: f64::from(a.nearness) + weighed(edges[2].value, edges[0].value),
            across: weighed(edges[2].across, edges[0].across),
            up: weighed(edges[2].up, edges[0].up),
        })
    }

    /// The edge functions at the first pixel of a row.
    #[inline]
    fn row(&self, j: i32) -> [i64; 3] {
        self.edges.map(|e| e.value + e.up * i64::from(j))
    }

    /// First and last covered column of a row, from the box's first one.
    #[inline]
    fn span(&self, j: i32) -> Option<(i64, i64)> {
        let (mut from, mut to) = (0, i64::from(self.columns) - 1);
        for (edge, value) in self.edges.iter().zip(self.row(j)) {
            let step = edge.across;
            if step > 0 {
                if value < 0 {
                    from = from.max((step - 1 - value) / step);
                }
            } else if value < 0 {
                return None;
            } else if step < 0 {
                to = to.min(value / -step);
            }
        }
        (from <= to).then_some((from, to))
    }
}
