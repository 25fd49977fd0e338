//! Colours, and what AOVs keep, of what is seen.

use umber_bvh::Hit;
use umber_geometry::geometric_normal;
use umber_math::{Normal3, Point3, Rgb, Vec3, Vector3};
use umber_settings::RasterColor;

use super::super::kept;
use super::numbers::{Batch, Seen};
use super::placement::Placement;
use super::project::{Grid, Homogeneous, Vertex};
use super::visibility::{NOTHING, Square};
use crate::film::{CenterHit, PixelSum, TILE, TileRect};
use crate::material::in_unit;
use crate::mesh::RenderMesh;
use crate::scene::RenderScene;
use crate::surface;

/// Shades pixels, tile by tile.
///
/// In steps that each go over all pixels: what waits for memory does so for many triangles at once, and arithmetic is
/// done for several pixels at once.
pub struct Shader<'a> {
    scene: &'a RenderScene,
    grid: &'a Grid,
    placements: &'a [Placement],
    batch: &'a Batch,
    /// The points of the batch's placements, projected.
    vertices: &'a [Vec<Vertex>],
    directions: Directions,
    /// Triangles seen in the tile.
    triangles: Vec<Triangle<'a>>,
    /// Index of the triangle of each pixel; [`NONE`] where there is none.
    which: Vec<u32>,
    facing: Vec<Facing>,
}

/// Of a pixel in which nothing is seen.
const NONE: u32 = u32::MAX;

/// The directions of view rays, render space: linear over the film.
#[derive(Clone, Copy)]
struct Directions {
    /// Through the film's middle.
    middle: Vec3,
    /// Change by one pixel across, and one up.
    across: Vec3,
    up: Vec3,
}

/// How a surface stands to the viewer, at a pixel.
#[derive(Clone, Copy)]
struct Facing {
    /// Shading normal and direction of the view ray, render space; neither of unit length.
    normal: Vec3,
    direction: Vec3,
    /// Its colour.
    base: Rgb,
}

impl Facing {
    #[inline]
    fn cos(&self) -> f32 {
        let squared = self.normal.length_squared() * self.direction.length_squared();
        let cos = self.normal.dot(self.direction).abs() / squared.sqrt();
        // what is not a number faces nothing
        if cos > 0.0 { cos.min(1.0) } else { 0.0 }
    }
}

/// What is the same for all pixels of a triangle.
struct Triangle<'a> {
    placement: &'a Placement,
    mesh: &'a RenderMesh,
    index: u32,
    /// Its corners on the film: position from `origin` and weight, by which the position is multiplied.
    corners: [[f32; 3]; 3],
    /// What the area opposite to each corner is multiplied by to be as its barycentric.
    scales: [f32; 3],
    /// The pixel where it was first seen.
    origin: [i32; 2],
    /// Of its corners, object space, not of unit length.
    normals: [Vec3; 3],
    /// The same for all of it; `None`: the mesh's displayColor.
    color: Option<Rgb>,
    emission: Rgb,
}

impl<'a> Shader<'a> {
    /// A shader of what the placements show; `batch`: of the last numbers, `vertices`: the points of its placements.
    pub fn new(
        scene: &'a RenderScene,
        grid: &'a Grid,
        placements: &'a [Placement],
        batch: &'a Batch,
        vertices: &'a [Vec<Vertex>],
    ) -> Self {
        let [middle, across, up] = grid.directions();
        let directions = Directions { middle, across, up };
        let (triangles, which, facing) = (Vec::new(), Vec::new(), Vec::new());
        Self { scene, grid, placements, batch, vertices, directions, triangles, which, facing }
    }

    /// Finds what is seen in a tile. False where nothing is.
    pub fn look(&mut self, square: &Square, rect: TileRect) -> bool {
        self.triangles.clear();
        self.which.clear();
        let mut below = [(NOTHING, NONE); TILE];
        for y in rect.y..rect.y + rect.height {
            let mut before = (NOTHING, NONE);
            let numbers = square.row([rect.x as i32, y as i32], rect.width);
            for ((x, &number), below) in (rect.x..).zip(numbers).zip(&mut below) {
                // mostly the triangle of the pixel before or below; one of an earlier batch has no number any more
                if number == NOTHING || number != before.0 {
                    before = if number != NOTHING && number == below.0 {
                        *below
                    } else {
                        let pixel = [x as i32, y as i32];
                        (number, self.take(square.seen(self.batch, pixel), pixel))
                    };
                }
                *below = before;
                self.which.push(before.1);
            }
        }
        !self.triangles.is_empty()
    }

    /// Index of a triangle that is seen.
    #[inline]
    fn take(&mut self, seen: Option<Seen>, pixel: [i32; 2]) -> u32 {
        let Some(seen) = seen else { return NONE };
        let triangle = self.triangle(seen, pixel);
        self.triangles.push(triangle);
        self.triangles.len() as u32 - 1
    }

    /// Colours of the tile that was looked at.
    pub fn colors(&mut self, rect: TileRect, sums: &mut Vec<PixelSum>) {
        if self.scene.settings.raster_color == RasterColor::Shaded {
            return self.headlit(rect, sums);
        }
        let triangles = self.which.iter().map(|which| self.triangles.get(*which as usize));
        sums.extend(triangles.map(|triangle| match triangle {
            Some(triangle) => PixelSum::of(self.random_color(triangle), 1.0),
            None => PixelSum::of(Rgb::BLACK, 0.0),
        }));
    }

    /// Colours, lit from the eye.
    fn headlit(&mut self, rect: TileRect, sums: &mut Vec<PixelSum>) {
        self.facing.clear();
        for (y, which) in (rect.y..).zip(self.which.chunks_exact(rect.width)) {
            for (x, &which) in (rect.x..).zip(which) {
                let pixel = [x as i32, y as i32];
                let direction = self.direction(pixel);
                let Some(triangle) = self.triangles.get(which as usize) else {
                    self.facing.push(Facing { normal: direction, direction, base: Rgb::BLACK });
                    continue;
                };
                let barycentrics = triangle.barycentrics(pixel);
                let base = triangle.color.unwrap_or_else(|| triangle.display_color(barycentrics));
                self.facing.push(Facing { normal: triangle.shading_normal(barycentrics), direction, base });
            }
        }
        for facing in &mut self.facing {
            facing.base *= facing.cos();
        }
        sums.extend(self.facing.iter().zip(&self.which).map(
            |(facing, which)| match self.triangles.get(*which as usize) {
                Some(triangle) => PixelSum::of(kept(self.scene, facing.base + triangle.emission), 1.0),
                None => PixelSum::of(Rgb::BLACK, 0.0),
            },
        ));
    }

    /// What AOVs keep of the tile that was looked at.
    pub fn centers(&self, rect: TileRect) -> Vec<Option<CenterHit>> {
        let triangle = |i: usize| self.triangles.get(self.which[i] as usize);
        pixels(rect).enumerate().map(|(i, pixel)| Some(self.center(triangle(i)?, pixel))).collect()
    }

    fn center(&self, triangle: &Triangle<'_>, pixel: [i32; 2]) -> CenterHit {
        let (scene, placement, mesh) = (self.scene, triangle.placement, triangle.mesh);
        let corners = mesh.shape.triangle(triangle.index).map(|p| placement.film_from_object.apply(p));
        let barycentrics = barycentrics(self.grid, &corners, self.grid.film_position(pixel));
        let [p, q, r] = mesh.shape.triangle(triangle.index).map(|p| p.0);
        let point = Point3(p * barycentrics[0] + q * barycentrics[1] + r * barycentrics[2]);
        let depths = scene.camera.depths_at(placement.film_from_object.apply(point).distance as f32);
        // USD's tools show normals towards the viewer; render space is world space, moved
        let normal = Normal3(triangle.shading_normal(barycentrics)).normalized();
        let normal = normal.facing(Vector3(-self.direction(pixel)));
        let hit = Hit { t: 0.0, barycentrics, mesh: placement.mesh, triangle: triangle.index, path: placement.path };
        CenterHit {
            depth: depths.projected,
            camera_depth: depths.camera,
            normal: normal.0.to_array(),
            neye: scene.camera.eye_normal(normal).0.to_array(),
            prim_id: mesh.prim_id,
            instance_id: scene.instance_id(&hit),
            element_id: mesh.shape.mesh.elements[triangle.index as usize] as i32,
            st: surface::st(scene, &hit).to_array(),
        }
    }

    /// Of the view ray through a pixel's middle, not of unit length.
    #[inline]
    fn direction(&self, pixel: [i32; 2]) -> Vec3 {
        let [x, y] = self.grid.film_position(pixel).map(|v| v as f32);
        self.directions.middle + self.directions.across * x + self.directions.up * y
    }

    #[inline]
    fn triangle(&self, seen: Seen, origin: [i32; 2]) -> Triangle<'a> {
        let placement = &self.placements[seen.placement as usize];
        let (mesh, index) = (placement.mesh(self.scene), seen.triangle);
        let material = self.scene.materials.get(mesh.material_of(index) as usize);
        let normals = match &mesh.attributes.normals {
            Some(normals) => normals.at_vertices(&mesh.shape.mesh, index),
            None => [face_normal(mesh.shape.triangle(index)); 3],
        };
        let (corners, scales) = self.corners(placement, seen, origin);
        let (color, emission) = (material.and_then(|m| m.base_color), material.map_or(Rgb::BLACK, |m| m.emission));
        Triangle { placement, mesh, index, corners, scales, origin, normals, color, emission }
    }

    /// Corners and scales of a triangle.
    #[inline]
    fn corners(&self, placement: &Placement, seen: Seen, origin: [i32; 2]) -> ([[f32; 3]; 3], [f32; 3]) {
        let shape = &placement.mesh(self.scene).shape;
        let projected = seen.placement.checked_sub(self.batch.placements.start as u32);
        if let Some(vertices) = projected.and_then(|at| self.vertices.get(at as usize)) {
            let corners = shape.mesh.triangles[seen.triangle as usize].map(|i| vertices[i as usize]);
            if !corners.iter().any(Vertex::is_off_grid) {
                let to_pixels = 1.0 / (1u32 << self.grid.subpixel_bits) as f32;
                let middle =
                    [self.grid.center(origin[0], self.grid.width), self.grid.center(origin[1], self.grid.height)];
                let from_origin =
                    |v: Vertex| [(v.x - middle[0]) as f32 * to_pixels, (v.y - middle[1]) as f32 * to_pixels, 1.0];
                let scale = |v: Vertex| if self.grid.is_perspective { v.nearness } else { 1.0 };
                return (corners.map(from_origin), corners.map(scale));
            }
        }
        let [x, y] = self.grid.film_position(origin);
        let from_origin = |p: Point3| {
            let p = placement.film_from_object.apply(p);
            let weight = self.grid.weight(&p);
            [(p.x - x * weight) as f32, (p.y - y * weight) as f32, weight as f32]
        };
        (shape.triangle(seen.triangle).map(from_origin), [1.0; 3])
    }

    /// A colour that looks like no other polygon's, or no other prim's.
    fn random_color(&self, triangle: &Triangle<'_>) -> Rgb {
        let by_polygon = self.scene.settings.raster_color == RasterColor::Random;
        let mesh = triangle.mesh;
        let polygon = if by_polygon { mesh.shape.mesh.elements[triangle.index as usize] } else { u32::MAX };
        Rgb(random_color([mesh.prim_id as u32, polygon]))
    }
}

/// The pixels of a tile, row by row.
fn pixels(rect: TileRect) -> impl Iterator<Item = [i32; 2]> {
    let row = move |y: usize| (rect.x..rect.x + rect.width).map(move |x| [x as i32, y as i32]);
    (rect.y..rect.y + rect.height).flat_map(row)
}

impl Triangle<'_> {
    /// The barycentrics at a pixel's middle, precise enough for colours.
    #[inline]
    fn barycentrics(&self, pixel: [i32; 2]) -> [f32; 3] {
        let [x, y] = [0, 1].map(|axis| (pixel[axis] - self.origin[axis]) as f32);
        let [a, b, c] = self.corners.map(|[px, py, weight]| [px - x * weight, py - y * weight]);
        let area = |p: [f32; 2], q: [f32; 2]| p[0] * q[1] - p[1] * q[0];
        let [of_a, of_b, of_c] = self.scales;
        let weights = [area(b, c) * of_a, area(c, a) * of_b, area(a, b) * of_c];
        let sum = weights[0] + weights[1] + weights[2];
        // seen edge on, by rounding alone
        if sum == 0.0 { [1.0 / 3.0; 3] } else { weights.map(|w| (w / sum).clamp(0.0, 1.0)) }
    }

    /// Not of unit length; render space.
    #[inline(always)]
    fn shading_normal(&self, barycentrics: [f32; 3]) -> Vec3 {
        let [a, b, c] = self.normals;
        let normal = a * barycentrics[0] + b * barycentrics[1] + c * barycentrics[2];
        // neither zero nor what is not a number
        let usable = normal.length_squared() > 0.0;
        let normal = if usable { normal } else { self.face_normal() };
        self.placement.render_from_normal * normal
    }

    #[cold]
    fn face_normal(&self) -> Vec3 {
        face_normal(self.mesh.shape.triangle(self.index))
    }

    fn display_color(&self, barycentrics: [f32; 3]) -> Rgb {
        let color = self.mesh.attributes.display_color.as_ref();
        let color = color.map_or(surface::FALLBACK_COLOR, |c| c.eval(&self.mesh.shape.mesh, self.index, barycentrics));
        in_unit(Rgb(color))
    }
}

/// Of a triangle of any size, unit, object space.
fn face_normal([a, b, c]: [Point3; 3]) -> Vec3 {
    geometric_normal(a, b, c).0
}

/// The barycentrics at a film position from the film's middle; each between 0 and 1.
#[inline]
pub fn barycentrics(grid: &Grid, corners: &[Homogeneous; 3], [x, y]: [f64; 2]) -> [f32; 3] {
    let [a, b, c] = corners.map(|p| {
        let weight = grid.weight(&p);
        [p.x - x * weight, p.y - y * weight]
    });
    // each is as the area that the position spans with the other two
    let area = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
    let areas = [area(b, c), area(c, a), area(a, b)];
    let scale = 1.0 / (areas[0] + areas[1] + areas[2]);
    let weights = areas.map(|area| (area * scale) as f32);
    // seen edge on, by rounding alone
    if scale.is_finite() { weights.map(|w| w.clamp(0.0, 1.0)) } else { [1.0 / 3.0; 3] }
}

/// A colour from a hash.
fn random_color(of: [u32; 2]) -> Vec3 {
    // Murmur3's mixing (Appleby 2011)
    let mix = |mut h: u32| {
        h = (h ^ h >> 16).wrapping_mul(0x85eb_ca6b);
        h = (h ^ h >> 13).wrapping_mul(0xc2b2_ae35);
        h ^ h >> 16
    };
    let hash = of.into_iter().fold(0x9e37_79b9, |h: u32, v| mix(h.rotate_left(5) ^ v).wrapping_add(h));
    let channel = |shift: u32| 0.05 + 0.95 / 1023.0 * (hash >> shift & 1023) as f32;
    Vec3::new(channel(0), channel(10), channel(20))
}
