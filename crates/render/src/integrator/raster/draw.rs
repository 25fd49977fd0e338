//! Triangles of clusters, drawn on a square.

use pulp::{Arch, Simd, WithSimd};
use umber_bvh::Hit;
use umber_math::Point3;

use super::bins::Entry;
use super::boxing::{Around, Boxing, Mirrored, is_empty, mirrored, ranges};
use super::centers::barycentrics;
use super::clip::clip;
use super::fill::{Rules, Triangle};
use super::pieces::{Piece, Seen, number};
use super::placement::Placement;
use super::project::{Grid, Vertex, Vertices};
use super::short::{BATCH, Batch, Short};
use super::square::Square;
use crate::clusters::{CLUSTER, Cluster, LANES};
use crate::scene::RenderScene;
use crate::surface;

/// Surfaces that are more than this present are seen.
const SEEN_PRESENCE: f32 = 0.5;
/// What a byte can number: as many points a cluster has at most, and more.
const POINTS: usize = 256;

/// Draws clusters.
pub struct Drawer<'a> {
    scene: &'a RenderScene,
    grid: &'a Grid,
    placements: &'a [Placement],
    arch: Arch,
    points: Points,
    /// Triangles of the cluster under way that may cover something, and what their boxes hold.
    boxed: [Boxed; CLUSTER],
    batch: Batch,
}

/// Which triangle of a cluster, and first column and row whose middles its box holds, and the last ones, negative.
type Boxed = (u32, [i32; 4]);

/// Points of the cluster under way, on the grid.
struct Points {
    places: [Mirrored; POINTS],
    nearness: [f32; POINTS],
}

impl<'a> Drawer<'a> {
    /// Draws placements.
    pub fn new(scene: &'a RenderScene, grid: &'a Grid, placements: &'a [Placement]) -> Self {
        let points = Points { places: [[0; 4]; POINTS], nearness: [0.0; POINTS] };
        Self {
            scene,
            grid,
            placements,
            arch: Arch::new(),
            points,
            boxed: [(0, [0; 4]); CLUSTER],
            batch: Batch::default(),
        }
    }

    /// Draws a square's entries, which come from front to back: those behind are mostly hidden when it is their turn.
    /// `pieces` become those that are not.
    pub fn draw(&mut self, square: &mut Square, entries: &[Entry], pieces: &mut Vec<Piece<'a>>) {
        pieces.clear();
        self.arch.dispatch(DrawSquare { drawer: self, square, entries, pieces });
    }

    /// The next of them that is not hidden, asked for from memory.
    #[inline(always)]
    fn next(&self, square: &Square, entries: &mut std::slice::Iter<'_, Entry>) -> Option<Piece<'a>> {
        for entry in entries {
            if !square.hides(entry.pixels, entry.nearness) {
                let piece = Piece::new(self.scene, self.placements, *entry);
                piece.cluster.prefetch();
                return Some(piece);
            }
        }
        None
    }

    /// Draws a piece, and adds it to those of the square unless it is hidden.
    #[inline(always)]
    fn draw_piece(&mut self, square: &mut Square, piece: Piece<'a>, pieces: &mut Vec<Piece<'a>>) {
        let Piece { entry, cluster, .. } = piece;
        let placement = &self.placements[entry.placement as usize];
        let boxing = Boxing::new(self.grid, square);
        let mut around = Around::NOTHING;
        for (i, block) in cluster.points.iter().enumerate() {
            let vertices = self.grid.place_block(&placement.film_from_object, block);
            around.add(&vertices);
            self.points.set(i * LANES, &vertices);
        }
        if around.is_hidden(&boxing, square) {
            return;
        }
        piece.prefetch_normals();
        let first = number(pieces.len(), 0);
        pieces.push(piece);
        // most triangles cover nothing, and nobody can tell beforehand which: first they are boxed, without branches
        let mut count = 0;
        for (i, [a, b, c]) in cluster.corners.iter().enumerate() {
            let pixels = boxing.pixels(self.points.place(*a), self.points.place(*b), self.points.place(*c));
            self.boxed[count % CLUSTER] = (i as u32, pixels);
            count += usize::from(!is_empty(pixels));
        }
        let draw = Draw { scene: self.scene, grid: self.grid, placement, pieces, cluster };
        for boxed in self.boxed[..count].chunks(BATCH) {
            self.points.gather(&cluster, boxed, &mut self.batch);
            draw.draw_batch(square, &self.batch, boxed, first);
        }
    }
}

/// [`Drawer::draw`], compiled for the processor's vector unit with all that is inlined in it.
struct DrawSquare<'d, 'a> {
    drawer: &'d mut Drawer<'a>,
    square: &'d mut Square,
    entries: &'d [Entry],
    pieces: &'d mut Vec<Piece<'a>>,
}

impl WithSimd for DrawSquare<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { drawer, square, entries, pieces } = self;
        let mut entries = entries.iter();
        let mut next = drawer.next(square, &mut entries);
        while let Some(piece) = next {
            // comes from memory while the one before is drawn
            next = drawer.next(square, &mut entries);
            drawer.draw_piece(square, piece, pieces);
        }
    }
}

impl Points {
    /// Sets some, from `first` on.
    #[inline(always)]
    fn set(&mut self, first: usize, vertices: &Vertices) {
        for i in 0..LANES {
            let vertex = vertices.get(i);
            (self.places[first + i], self.nearness[first + i]) = (mirrored(&vertex), vertex.nearness);
        }
    }
    #[inline(always)]
    fn place(&self, number: u8) -> &Mirrored {
        &self.places[usize::from(number)]
    }
    #[inline(always)]
    fn vertex(&self, number: u8) -> Vertex {
        let [x, y, ..] = *self.place(number);
        Vertex { x, y, nearness: self.nearness[usize::from(number)] }
    }
    /// Puts triangles into a batch.
    #[inline(always)]
    fn gather(&self, cluster: &Cluster<'_>, boxed: &[Boxed], batch: &mut Batch) {
        for (at, (i, pixels)) in boxed.iter().enumerate() {
            let corners = cluster.corners[*i as usize].map(|point| self.vertex(point));
            batch.set(at % BATCH, corners, ranges(pixels));
        }
    }
}

/// Draws triangles of a cluster.
struct Draw<'a> {
    scene: &'a RenderScene,
    grid: &'a Grid,
    placement: &'a Placement,
    pieces: &'a [Piece<'a>],
    cluster: Cluster<'a>,
}

impl Draw<'_> {
    /// Draws some together. `first`: number of the cluster's first triangle.
    #[inline(always)]
    fn draw_batch(&self, square: &mut Square, batch: &Batch, boxed: &[Boxed], first: u32) {
        let short = Short::new(self.grid, batch);
        let [anticlockwise, clockwise] = self.placement.culled;
        let (covering, count) = short.covering(self.grid, batch, boxed.len());
        for &at in &covering[..count] {
            let (i, pixels) = &boxed[at];
            let (pixels, number) = (ranges(pixels), first + i);
            if self.placement.may_be_absent || !short.is_short(self.grid, at) {
                self.draw(square, batch.corners(at), number, pixels);
                continue;
            }
            let area = short.area(at);
            let is_seen = (area > 0.0) & !anticlockwise | (area < 0.0) & !clockwise;
            if is_seen {
                short.fill(at, square, pixels, number, self);
            }
        }
    }

    /// Draws one by itself.
    #[inline(never)]
    fn draw(&self, square: &mut Square, corners: [Vertex; 3], number: u32, pixels: [[i32; 2]; 2]) {
        let [a, b, c] = &corners;
        if a.is_off_grid() | b.is_off_grid() | c.is_off_grid() {
            return self.draw_clipped(square, number);
        }
        let Some(triangle) = Triangle::new(corners, number) else { return };
        if self.placement.culled[usize::from(triangle.is_clockwise())] {
            return;
        }
        if self.placement.may_be_absent {
            return self.draw_partly(square, &triangle, number, pixels);
        }
        triangle.fill(self.grid, square, pixels, self);
    }

    #[cold]
    fn draw_clipped(&self, square: &mut Square, number: u32) {
        let corners = self.placement.mesh(self.scene).shape.triangle(self.index(number));
        let positions = corners.map(|p: Point3| self.placement.film_from_object.apply(p));
        let boxing = Boxing::new(self.grid, square);
        clip(self.grid, positions, |corners| {
            if let Some(pixels) = boxing.range(&corners) {
                self.draw(square, corners, number, pixels);
            }
        });
    }

    /// Draws what is there of a triangle.
    #[cold]
    fn draw_partly(&self, square: &mut Square, triangle: &Triangle, number: u32, pixels: [[i32; 2]; 2]) {
        let index = self.index(number);
        match presence(self.scene, self.placement, index) {
            Presence::None => {}
            Presence::Whole => triangle.fill(self.grid, square, pixels, self),
            Presence::Parts => triangle.fill(self.grid, square, pixels, &Partly { draw: self, index }),
        }
    }

    /// Index in the mesh of a triangle of the cluster.
    fn index(&self, number: u32) -> u32 {
        self.cluster.indices[number as usize % CLUSTER]
    }
}

impl Rules for Draw<'_> {
    fn is_first(&self, number: u32, shown: u32) -> bool {
        let rank = |number: u32| Seen::new(self.pieces, number).rank();
        rank(number) < rank(shown)
    }
}

/// Rules for a triangle that is there in parts.
struct Partly<'a> {
    draw: &'a Draw<'a>,
    index: u32,
}

impl Rules for Partly<'_> {
    fn is_first(&self, number: u32, shown: u32) -> bool {
        self.draw.is_first(number, shown)
    }
    fn is_there(&self, pixel: [i32; 2]) -> bool {
        let Draw { scene, grid, placement, .. } = self.draw;
        let corners = placement.mesh(scene).shape.triangle(self.index);
        let corners = corners.map(|p| placement.film_from_object.apply(p));
        is_there(scene, placement, self.index, barycentrics(grid, &corners, grid.film_position(pixel)))
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
