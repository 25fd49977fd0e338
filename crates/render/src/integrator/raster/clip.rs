//! Triangles that reach beyond what has a place on the grid: cut off at the near plane and around the film.

use super::project::{Grid, Homogeneous, Vertex};

/// Corners of a triangle after five cuts, at most.
const MOST: usize = 8;

/// A convex polygon.
#[derive(Clone, Copy, Default)]
struct Polygon {
    corners: [Homogeneous; MOST],
    count: usize,
}

impl Polygon {
    fn push(&mut self, p: Homogeneous) {
        if let Some(slot) = self.corners.get_mut(self.count) {
            (*slot, self.count) = (p, self.count + 1);
        }
    }

    /// The part where `height` is not negative (Sutherland and Hodgman 1974). Where an edge is cut, the cut is
    /// reckoned from the end that stays: both triangles of an edge find the same point.
    fn cut(&self, height: impl Fn(&Homogeneous) -> f64) -> Self {
        let mut kept = Self::default();
        for i in 0..self.count {
            let (a, b) = (self.corners[i], self.corners[(i + 1) % self.count]);
            let (height_a, height_b) = (height(&a), height(&b));
            if height_a >= 0.0 {
                kept.push(a);
                if height_b < 0.0 {
                    kept.push(a.toward(b, height_a / (height_a - height_b)));
                }
            } else if height_b >= 0.0 {
                kept.push(b.toward(a, height_b / (height_b - height_a)));
            }
        }
        kept
    }
}

/// Calls `take` with the parts of a triangle that have a place on the grid, in the triangle's winding.
pub fn clip(grid: &Grid, triangle: [Homogeneous; 3], mut take: impl FnMut([Vertex; 3])) {
    let finite = |p: &Homogeneous| p.x.is_finite() && p.y.is_finite() && p.distance.is_finite();
    if !triangle.iter().all(finite) {
        return;
    }
    let mut polygon = Polygon::default();
    triangle.into_iter().for_each(|p| polygon.push(p));
    let g = grid.guard;
    let polygon = polygon
        .cut(|p| p.distance - grid.near)
        .cut(|p| grid.weight(p) * g - p.x)
        .cut(|p| grid.weight(p) * g + p.x)
        .cut(|p| grid.weight(p) * g - p.y)
        .cut(|p| grid.weight(p) * g + p.y);
    let placed = polygon.corners.map(|p| grid.place_clipped(p));
    for i in 2..polygon.count {
        take([placed[0], placed[i - 1], placed[i]]);
    }
}
