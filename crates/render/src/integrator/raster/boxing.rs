//! Boxes around projected points, and the pixels whose middles lie in them.

use super::fill::larger;
use super::project::{Grid, Vertex, Vertices};
use super::square::Square;
use crate::clusters::LANES;

/// A place, and the place with both signs changed: of several the least of each is the box around them.
pub type Mirrored = [i32; 4];

/// Which pixels' middles of a square lie in a box.
pub struct Boxing {
    shift: [i32; 4],
    bits: u32,
    /// The square's first column and row, and its last ones, negative.
    square: [i32; 4],
}

/// The place of a vertex.
#[inline(always)]
pub fn mirrored(vertex: &Vertex) -> Mirrored {
    let Vertex { x, y, .. } = *vertex;
    // boxes around what has no place reach everywhere
    if vertex.is_off_grid() { [x, y, x, y] } else { [x, y, -x, -y] }
}

impl Boxing {
    /// On a square.
    #[inline(always)]
    pub fn new(grid: &Grid, square: &Square) -> Self {
        let bits = grid.subpixel_bits;
        let up = (1 << bits) - 1;
        let [x, y] = [grid.width, grid.height].map(|pixels| (pixels - 1) << (bits - 1));
        let ([x0, y0], [width, height]) = (square.first, square.size);
        Self { shift: [x + up, y + up, up - x, up - y], bits, square: [x0, y0, 1 - width - x0, 1 - height - y0] }
    }
    /// First column and row whose middles lie in the box, and the last ones, negative.
    #[inline(always)]
    pub fn pixels(&self, a: &Mirrored, b: &Mirrored, c: &Mirrored) -> [i32; 4] {
        let mut pixels = [0; 4];
        for i in 0..4 {
            let least = a[i].min(b[i]).min(c[i]);
            pixels[i] = ((least + self.shift[i]) >> self.bits).max(self.square[i]);
        }
        pixels
    }
    /// First and last column, first and last row whose middles lie in the box around a triangle; `None` without any.
    pub fn range(&self, corners: &[Vertex; 3]) -> Option<[[i32; 2]; 2]> {
        let [a, b, c] = corners.each_ref().map(mirrored);
        let pixels = self.pixels(&a, &b, &c);
        (!is_empty(pixels)).then(|| ranges(&pixels))
    }
}

/// First and last column, first and last row.
#[inline(always)]
pub fn ranges([x0, y0, x1, y1]: &[i32; 4]) -> [[i32; 2]; 2] {
    [[*x0, -x1], [*y0, -y1]]
}

/// Whether no pixel is among those.
#[inline(always)]
pub fn is_empty([x0, y0, x1, y1]: [i32; 4]) -> bool {
    // of two numbers either is more than zero, without a branch
    (x0 + x1).max(y0 + y1) > 0
}

/// What is around points: of those in the same lane of their blocks, the least and the largest.
pub struct Around {
    low: [[i32; LANES]; 2],
    high: [[i32; LANES]; 2],
    nearness: [f32; LANES],
}

impl Around {
    /// Around none.
    pub const NOTHING: Self =
        Self { low: [[i32::MAX; LANES]; 2], high: [[i32::MIN; LANES]; 2], nearness: [f32::NEG_INFINITY; LANES] };

    /// Goes around some more.
    #[inline(always)]
    pub fn add(&mut self, vertices: &Vertices) {
        for (axis, places) in [&vertices.x, &vertices.y].into_iter().enumerate() {
            for (i, place) in places.iter().enumerate() {
                self.low[axis][i] = self.low[axis][i].min(*place);
                self.high[axis][i] = self.high[axis][i].max(*place);
            }
        }
        for i in 0..LANES {
            self.nearness[i] = larger(vertices.nearness[i], self.nearness[i]);
        }
    }
    /// Whether a square shows nothing of triangles between them: nothing is drawn nearer than a triangle's corners. Never
    /// where one of them has no place, as what is clipped may be elsewhere.
    #[inline(always)]
    pub fn is_hidden(&self, boxing: &Boxing, square: &Square) -> bool {
        let [x0, y0] = self.low.map(|low| low.into_iter().fold(i32::MAX, i32::min));
        if x0 == Vertex::OFF_GRID.x {
            return false;
        }
        let [x1, y1] = self.high.map(|high| high.into_iter().fold(i32::MIN, i32::max));
        let place = [x0, y0, -x1, -y1];
        let pixels = boxing.pixels(&place, &place, &place);
        let [x, y] = square.first;
        is_empty(pixels) || {
            let [[x0, x1], [y0, y1]] = ranges(&pixels);
            let pixels = [[x0 - x, x1 - x], [y0 - y, y1 - y]].map(|range| range.map(|v| v as u8));
            square.hides(pixels, self.nearness.into_iter().fold(f32::NEG_INFINITY, larger))
        }
    }
}
