//! Triangles, projected and sorted into squares of the film.

use std::ops::Range;

use umber_bvh::Hit;
use umber_math::Point3;

use super::clip::clip;
use super::placement::Placement;
use super::project::{Grid, Vertex};
use crate::scene::RenderScene;
use crate::surface;

/// Edge of a bin, pixels; a multiple of the film's tiles'.
pub const BIN: usize = 64;
/// Set in a triangle's placement where it must be asked at each pixel whether the surface is there.
const MASKED: u32 = 1 << 31;
/// Surfaces that are more than this present are seen.
const SEEN_PRESENCE: f32 = 0.5;

/// A triangle that may cover the middle of a pixel.
#[derive(Clone, Copy, Debug)]
pub struct Projected {
    /// Its corners.
    pub corners: [Vertex; 3],
    placement: u32,
    /// Which of the mesh's.
    pub triangle: u32,
}

impl Projected {
    /// Index of its placement.
    pub fn placement(&self) -> u32 {
        self.placement & !MASKED
    }
    /// Whether parts of it may be looked through.
    pub fn is_masked(&self) -> bool {
        self.placement & MASKED != 0
    }
}

/// How a film is divided.
#[derive(Clone, Copy, Debug)]
pub struct Bins {
    /// Bins across.
    pub columns: usize,
    /// Bins down.
    pub rows: usize,
}

impl Bins {
    /// The bins of a film of so many pixels.
    pub fn new(width: usize, height: usize) -> Self {
        Self { columns: width.div_ceil(BIN), rows: height.div_ceil(BIN) }
    }
    /// How many there are.
    pub fn count(&self) -> usize {
        self.columns * self.rows
    }
}

/// Triangles of one piece of the scene, by bins.
#[derive(Debug, Default)]
pub struct Binned {
    triangles: Vec<Projected>,
    /// Where each bin's part of `order` begins.
    starts: Vec<u32>,
    order: Vec<u32>,
}

impl Binned {
    /// The triangles that may reach into a bin, in the scene's order.
    pub fn of(&self, bin: usize) -> impl Iterator<Item = &Projected> {
        let range = match self.starts.get(bin..bin + 2) {
            Some(&[start, end]) => start as usize..end as usize,
            _ => 0..0,
        };
        self.order[range].iter().map(|i| &self.triangles[*i as usize])
    }
}

/// Some triangles of a placement, and where its points are on the grid.
#[derive(Clone, Debug)]
pub struct Piece<'a> {
    /// Index of the placement.
    pub index: u32,
    /// The placement.
    pub placement: &'a Placement,
    /// Its mesh's points, projected.
    pub vertices: &'a [Vertex],
    /// Triangles of the mesh.
    pub triangles: Range<usize>,
}

/// Sorts the triangles of some pieces.
pub struct Sorter<'a> {
    scene: &'a RenderScene,
    grid: &'a Grid,
    bins: Bins,
    triangles: Vec<Projected>,
    /// Bin and index of a triangle.
    entries: Vec<(u32, u32)>,
}

impl<'a> Sorter<'a> {
    /// Sorts into the bins of a film.
    pub fn new(scene: &'a RenderScene, grid: &'a Grid, bins: Bins) -> Self {
        Self { scene, grid, bins, triangles: Vec::new(), entries: Vec::new() }
    }

    /// Takes a piece's triangles.
    pub fn add(&mut self, piece: &Piece<'_>) {
        let shape = &piece.placement.mesh(self.scene).shape;
        for (triangle, indices) in (piece.triangles.start..).zip(&shape.mesh.triangles[piece.triangles.clone()]) {
            let corners = indices.map(|i| piece.vertices[i as usize]);
            if corners.contains(&Vertex::OFF_GRID) {
                self.add_clipped(piece, triangle as u32, *indices, &shape.points);
            } else {
                self.add_triangle(piece, triangle as u32, corners);
            }
        }
    }

    #[cold]
    fn add_clipped(&mut self, piece: &Piece<'_>, triangle: u32, indices: [u32; 3], points: &[umber_math::Vec3]) {
        let film_from_object = &piece.placement.film_from_object;
        let positions = indices.map(|i| film_from_object.apply(Point3(points[i as usize])));
        clip(self.grid, positions, |corners| self.add_triangle(piece, triangle, corners));
    }

    #[inline]
    fn add_triangle(&mut self, piece: &Piece<'_>, triangle: u32, corners: [Vertex; 3]) {
        let [a, b, c] = corners;
        let low = [a.x.min(b.x).min(c.x), a.y.min(b.y).min(c.y)];
        let high = [a.x.max(b.x).max(c.x), a.y.max(b.y).max(c.y)];
        let (x0, x1) = self.grid.pixels_between(low[0], high[0], self.grid.width);
        let (y0, y1) = self.grid.pixels_between(low[1], high[1], self.grid.height);
        if x0 > x1 || y0 > y1 {
            return;
        }
        let area = twice_area(&corners);
        if area == 0 || piece.placement.culled[usize::from(area < 0)] {
            return;
        }
        let mut placement = piece.index;
        if piece.placement.may_be_absent {
            match self.presence(piece, triangle) {
                Presence::None => return,
                Presence::Parts => placement |= MASKED,
                Presence::Whole => {}
            }
        }
        let index = self.triangles.len() as u32;
        self.triangles.push(Projected { corners, placement, triangle });
        let of = |pixel: i32| pixel as usize / BIN;
        for row in of(y0)..=of(y1) {
            for column in of(x0)..=of(x1) {
                self.entries.push(((row * self.bins.columns + column) as u32, index));
            }
        }
    }

    /// Whether a triangle is there: opacity is linear over it.
    #[cold]
    fn presence(&self, piece: &Piece<'_>, triangle: u32) -> Presence {
        let corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        match corners.map(|b| is_there(self.scene, piece.placement, triangle, b)) {
            [true, true, true] => Presence::Whole,
            [false, false, false] => Presence::None,
            _ => Presence::Parts,
        }
    }

    /// The triangles by bins.
    pub fn sorted(self) -> Binned {
        let mut starts = vec![0u32; self.bins.count() + 1];
        for (bin, _) in &self.entries {
            starts[*bin as usize + 1] += 1;
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut order = vec![0u32; self.entries.len()];
        for (bin, index) in self.entries {
            let slot = &mut next[bin as usize];
            order[*slot as usize] = index;
            *slot += 1;
        }
        Binned { triangles: self.triangles, starts, order }
    }
}

enum Presence {
    None,
    Parts,
    Whole,
}

/// Whether the surface at barycentric coordinates of a triangle is seen, rather than looked through.
pub fn is_there(scene: &RenderScene, placement: &Placement, triangle: u32, barycentrics: [f32; 3]) -> bool {
    let hit = Hit { t: 0.0, barycentrics, mesh: placement.mesh, triangle, path: placement.path };
    surface::presence(scene, &hit) > SEEN_PRESENCE
}

/// Twice the area of a projected triangle, square grid units: negative where it winds clockwise.
#[inline]
pub fn twice_area([a, b, c]: &[Vertex; 3]) -> i64 {
    let along = |from: i32, to: i32| i64::from(to) - i64::from(from);
    along(a.x, b.x) * along(a.y, c.y) - along(a.y, b.y) * along(a.x, c.x)
}
