//! Triangles of a mesh, drawn at a place.

use std::ops::Range;

use umber_bvh::Hit;
use umber_math::Point3;

use super::clip::clip;
use super::fill::{Boxed, Triangle, draw_point};
use super::placement::Placement;
use super::project::{Grid, Reach, Vertex};
use super::shade;
use super::visibility::{Canvas, Pencil};
use crate::clusters::{CLUSTER, ClusterTriangle};
use crate::scene::RenderScene;
use crate::surface;

/// Surfaces that are more than this present are seen.
const SEEN_PRESENCE: f32 = 0.5;

/// Some groups of a placement's triangles, and where its points are on the grid.
#[derive(Clone, Debug)]
pub struct Piece<'a> {
    /// The placement.
    pub placement: &'a Placement,
    /// Its mesh's points, projected.
    pub vertices: &'a [Vertex],
    /// Number by which its first triangle is seen.
    pub first_number: u32,
    /// Groups of the mesh's triangles.
    pub clusters: Range<usize>,
}

/// Draws pieces.
pub struct Drawer<'a> {
    scene: &'a RenderScene,
    grid: &'a Grid,
    pencil: Pencil<'a>,
    /// Clusters of the piece under way, with what they reach.
    order: Vec<(Option<Reach>, usize)>,
}

impl<'a> Drawer<'a> {
    /// Draws on a canvas.
    pub fn new(scene: &'a RenderScene, canvas: &'a Canvas) -> Self {
        Self { scene, grid: canvas.grid(), pencil: canvas.pencil(), order: Vec::new() }
    }

    /// Draws a piece: its clusters from front to back, so that those behind are hidden when it is their turn.
    pub fn draw(&mut self, piece: &Piece<'_>) {
        let shape = &piece.placement.mesh(self.scene).shape;
        let film_from_object = &piece.placement.film_from_object;
        let clusters = shape.clusters();
        let mut order = std::mem::take(&mut self.order);
        let reach = |cluster: usize| self.grid.reach(film_from_object, clusters.bounds(cluster));
        order.extend(piece.clusters.clone().map(|cluster| (reach(cluster), cluster)));
        // what reaches behind the near plane comes first
        let nearness = |reach: &Option<Reach>| reach.map_or(f32::INFINITY, |reach| reach.nearness);
        order.sort_unstable_by(|a, b| nearness(&b.0).total_cmp(&nearness(&a.0)));
        for (reach, cluster) in order.drain(..) {
            if !reach.is_some_and(|reach| self.pencil.hides(&reach)) {
                self.draw_cluster(piece, clusters.triangles(cluster));
            }
        }
        self.order = order;
    }

    fn draw_cluster(&mut self, piece: &Piece<'_>, triangles: &[ClusterTriangle]) {
        // most of them cover nothing, and nobody can tell beforehand which: first they are boxed, without branches
        let (mut boxed, mut count) = ([Boxed::NOTHING; CLUSTER], 0);
        for triangle in triangles {
            let number = piece.first_number + triangle.index;
            let corners = triangle.points.map(|i| piece.vertices[i as usize]);
            // all three are looked at: one branch, not three
            if corners.iter().fold(false, |any, v| any | v.is_off_grid()) {
                self.draw_clipped(piece, number);
            } else {
                boxed[count] = Boxed::new(self.grid, corners, number);
                count += usize::from(!boxed[count].is_empty());
            }
        }
        boxed[..count].iter().for_each(|boxed| self.draw_boxed(piece, boxed));
    }

    #[cold]
    fn draw_clipped(&mut self, piece: &Piece<'_>, number: u32) {
        let corners = piece.placement.mesh(self.scene).shape.triangle(number - piece.first_number);
        let positions = corners.map(|p: Point3| piece.placement.film_from_object.apply(p));
        clip(self.grid, positions, |corners| {
            let boxed = Boxed::new(self.grid, corners, number);
            if !boxed.is_empty() {
                self.draw_boxed(piece, &boxed);
            }
        });
    }

    #[inline]
    fn draw_boxed(&mut self, piece: &Piece<'_>, boxed: &Boxed) {
        let placement = piece.placement;
        let [[x0, x1], [y0, y1]] = boxed.pixels;
        if x0 == x1 && y0 == y1 && !placement.may_be_absent {
            let square = self.pencil.square_at([x0, y0]);
            if draw_point(self.grid, boxed, placement.culled, square) {
                return;
            }
        }
        let Some(triangle) = Triangle::new(boxed) else { return };
        if placement.culled[usize::from(triangle.is_clockwise())] {
            return;
        }
        if placement.may_be_absent {
            self.draw_partly(placement, boxed.number - piece.first_number, &triangle);
        } else {
            self.pencil.draw(&triangle, None);
        }
    }

    /// Draws what is there of a triangle.
    #[cold]
    fn draw_partly(&mut self, placement: &Placement, index: u32, triangle: &Triangle) {
        match presence(self.scene, placement, index) {
            Presence::None => {}
            Presence::Whole => self.pencil.draw(triangle, None),
            Presence::Parts => {
                let corners = placement.mesh(self.scene).shape.triangle(index);
                let corners = corners.map(|p| placement.film_from_object.apply(p));
                self.pencil.draw(
                    triangle,
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
