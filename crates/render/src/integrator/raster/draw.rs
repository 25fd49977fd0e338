//! Triangles of a mesh, drawn at a place.

use std::ops::Range;

use umber_bvh::Hit;
use umber_math::Point3;

use super::clip::clip;
use super::fill::{Boxed, Triangle, draw_point};
use super::placement::Placement;
use super::project::{Grid, Vertex};
use super::shade;
use super::visibility::{Canvas, Pencil};
use crate::scene::RenderScene;
use crate::surface;

/// Surfaces that are more than this present are seen.
const SEEN_PRESENCE: f32 = 0.5;

/// Triangles that are boxed at a time.
const BLOCK: usize = 64;

/// Some triangles of a placement, and where its points are on the grid.
#[derive(Clone, Debug)]
pub struct Piece<'a> {
    /// The placement.
    pub placement: &'a Placement,
    /// Its mesh's points, projected.
    pub vertices: &'a [Vertex],
    /// Number by which its first triangle is seen.
    pub first_number: u32,
    /// Triangles of the mesh.
    pub triangles: Range<usize>,
}

/// Draws pieces.
pub struct Drawer<'a> {
    scene: &'a RenderScene,
    grid: &'a Grid,
    pencil: Pencil<'a>,
    /// What is drawn when all else of a piece is.
    later: Vec<Boxed>,
}

impl<'a> Drawer<'a> {
    /// Draws on a canvas.
    pub fn new(scene: &'a RenderScene, canvas: &'a Canvas) -> Self {
        Self { scene, grid: canvas.grid(), pencil: canvas.pencil(), later: Vec::new() }
    }

    /// Draws a piece.
    pub fn draw(&mut self, piece: &Piece<'_>) {
        let shape = &piece.placement.mesh(self.scene).shape;
        let mut number = piece.first_number + piece.triangles.start as u32;
        for block in shape.mesh.triangles[piece.triangles.clone()].chunks(BLOCK) {
            // half of them cover nothing, and nobody can tell beforehand which: first they are boxed, without branches
            let (mut boxed, mut count) = ([Boxed::NOTHING; BLOCK], 0);
            for indices in block {
                let corners = indices.map(|i| piece.vertices[i as usize]);
                // all three are looked at: one branch, not three
                if corners.iter().fold(false, |any, v| any | v.is_off_grid()) {
                    self.draw_clipped(piece, number);
                } else {
                    boxed[count] = Boxed::new(self.grid, corners, number);
                    count += usize::from(!boxed[count].is_empty());
                }
                number += 1;
            }
            for boxed in &boxed[..count] {
                // the sides of closed objects that are turned away are mostly hidden, once the others are drawn
                if boxed.is_clockwise() { self.later.push(*boxed) } else { self.draw_boxed(piece, boxed, false) }
            }
        }
        let mut later = std::mem::take(&mut self.later);
        later.drain(..).for_each(|boxed| self.draw_boxed(piece, &boxed, true));
        self.later = later;
    }

    #[cold]
    fn draw_clipped(&mut self, piece: &Piece<'_>, number: u32) {
        let corners = piece.placement.mesh(self.scene).shape.triangle(number - piece.first_number);
        let positions = corners.map(|p: Point3| piece.placement.film_from_object.apply(p));
        clip(self.grid, positions, |corners| {
            let boxed = Boxed::new(self.grid, corners, number);
            if !boxed.is_empty() {
                self.draw_boxed(piece, &boxed, false);
            }
        });
    }

    /// `look`: after a look whether it is hidden.
    #[inline]
    fn draw_boxed(&mut self, piece: &Piece<'_>, boxed: &Boxed, look: bool) {
        let placement = piece.placement;
        let [[x0, x1], [y0, y1]] = boxed.pixels;
        if x0 == x1 && y0 == y1 && !placement.may_be_absent {
            let square = self.pencil.square_at([x0, y0]);
            if square.hides([[x0, y0]; 2], boxed.most_nearness(), look)
                || draw_point(self.grid, boxed, placement.culled, square)
            {
                return;
            }
        }
        let Some(triangle) = Triangle::new(boxed) else { return };
        if placement.culled[usize::from(triangle.is_clockwise())] {
            return;
        }
        if placement.may_be_absent {
            self.draw_partly(placement, boxed.number - piece.first_number, &triangle, look);
        } else {
            self.pencil.draw(&triangle, look, None);
        }
    }

    /// Draws what is there of a triangle.
    #[cold]
    fn draw_partly(&mut self, placement: &Placement, index: u32, triangle: &Triangle, look: bool) {
        match presence(self.scene, placement, index) {
            Presence::None => {}
            Presence::Whole => self.pencil.draw(triangle, look, None),
            Presence::Parts => {
                let corners = placement.mesh(self.scene).shape.triangle(index);
                let corners = corners.map(|p| placement.film_from_object.apply(p));
                self.pencil.draw(
                    triangle,
                    look,
                    Some(&|pixel| {
                        let barycentrics = shade::barycentrics(self.grid, &corners, self.grid.film_position(pixel));
                        is_there(self.scene, placement, index, barycentrics)
                    }),
                );
            }
        }
    }
}

enum Presence {
    None,
    Parts,
    Whole,
}

/// Whether a triangle is there: opacity is linear over it.
fn presence(scene: &RenderScene, placement: &Placement, triangle: u32) -> Presence {
    let corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    match corners.map(|b| is_there(scene, placement, triangle, b)) {
        [true, true, true] => Presence::Whole,
        [false, false, false] => Presence::None,
        _ => Presence::Parts,
    }
}

/// Whether the surface at barycentric coordinates of a triangle is seen, rather than looked through.
fn is_there(scene: &RenderScene, placement: &Placement, triangle: u32, barycentrics: [f32; 3]) -> bool {
    let hit = Hit { t: 0.0, barycentrics, mesh: placement.mesh, triangle, path: placement.path };
    surface::presence(scene, &hit) > SEEN_PRESENCE
}
