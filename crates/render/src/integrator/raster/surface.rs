//! Surfaces of triangles that are seen in a square: what is the same for all pixels of one.

use glam::Mat3;
use umber_geometry::{Interpolation, geometric_normal};
use umber_math::{DVec3, Point3, Rgb, Vec3};

use super::pieces::{Piece, Seen};
use super::placement::Placement;
use super::project::{FilmFromObject, Grid};
use super::square::SQUARE;
use crate::clusters::LANES;
use crate::material::in_unit;
use crate::mesh::RenderMesh;
use crate::scene::RenderScene;
use crate::surface::FALLBACK_COLOR;

/// A number of each of the surfaces that are made together.
type Each<T> = [T; LANES];

/// A pixel, from the square's first.
pub type SquarePixel = [u8; 2];

const _: () = assert!(SQUARE <= 1 << u8::BITS);

/// A surface.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Surface {
    normal: Form<Vec3>,
    base: Rgb,
    /// Emitted radiance.
    pub emission: Rgb,
    /// The pixel from which forms count.
    origin: SquarePixel,
    /// Which of the colours that vary it has, from 1 on; 0 where it has one everywhere.
    varying: u16,
}

/// What is linear over the film.
#[derive(Clone, Copy, Debug)]
struct Form<T> {
    /// At the first pixel.
    start: T,
    /// Change by one pixel across, and one up.
    across: T,
    up: T,
}

impl Form<f32> {
    #[inline(always)]
    fn at(&self, [x, y]: [f32; 2]) -> f32 {
        self.start + self.across * x + self.up * y
    }
}

impl Form<Vec3> {
    /// What has the `values` where the weights stand alone.
    #[inline(always)]
    fn weighed(values: [Vec3; 3], weights: &[Form<f32>; 3]) -> Self {
        let ([p, q, r], [a, b, c]) = (values, weights);
        Self {
            start: p * a.start + q * b.start + r * c.start,
            across: p * a.across + q * b.across + r * c.across,
            up: p * a.up + q * b.up + r * c.up,
        }
    }
    #[inline(always)]
    fn at(&self, [x, y]: [f32; 2]) -> Vec3 {
        self.start + self.across * x + self.up * y
    }
}

impl Surface {
    /// From the pixel from which its forms count to another.
    #[inline(always)]
    fn offset(&self, pixel: SquarePixel) -> [f32; 2] {
        [0, 1].map(|axis| (i32::from(pixel[axis]) - i32::from(self.origin[axis])) as f32)
    }
    /// Shading normal at a pixel, render space, not of unit length; zero, or not a number, where those of its corners
    /// are or cancel out.
    #[inline(always)]
    pub fn normal(&self, pixel: SquarePixel) -> Vec3 {
        self.normal.at(self.offset(pixel))
    }
}

/// The surfaces that are seen in a square.
#[derive(Debug, Default)]
pub struct Surfaces {
    surfaces: Vec<Surface>,
    /// Colours that vary: a form over another, for perspective.
    colors: Vec<(Form<Vec3>, Form<f32>)>,
}

impl Surfaces {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.surfaces.clear();
        self.colors.clear();
    }
    /// One, in the order in which they were added.
    #[inline(always)]
    pub fn get(&self, index: u16) -> Option<&Surface> {
        self.surfaces.get(usize::from(index))
    }
    /// The colour of one at a pixel.
    #[inline(always)]
    pub fn base(&self, surface: &Surface, pixel: SquarePixel) -> Rgb {
        match usize::from(surface.varying) {
            0 => surface.base,
            varying => {
                let (color, whole) = &self.colors[varying - 1];
                let offset = surface.offset(pixel);
                in_unit(Rgb(color.at(offset) / whole.at(offset)))
            }
        }
    }

    /// Adds those of triangles of one placement, [`LANES`] at most: by their numbers among a square's pieces, each with
    /// a pixel where it is seen. `first`: the square's first column and row.
    #[inline(always)]
    pub fn add(
        &mut self,
        scene: &RenderScene,
        grid: &Grid,
        placement: &Placement,
        first: [i32; 2],
        pieces: &[Piece<'_>],
        found: &[(u32, SquarePixel)],
    ) {
        let mesh = placement.mesh(scene);
        let mut corners = Corners::default();
        for (i, (number, [x, y])) in found.iter().take(LANES).enumerate() {
            let seen = Seen::new(pieces, *number);
            let pixel = [first[0] + i32::from(*x), first[1] + i32::from(*y)];
            corners.set(i, mesh, &seen, grid.film_position(pixel));
        }
        let weights = corners.weights(grid, &placement.film_from_object);
        // exact where the corners have one normal
        let of_normals = if mesh.attributes.is_flat() { &Forms::FIRST_ALONE } else { &weights };
        let [x, y, z] = corners.normals(&placement.render_from_normal, of_normals);
        for (i, (number, origin)) in found.iter().take(LANES).enumerate() {
            let seen = Seen::new(pieces, *number);
            // which triangle of the mesh it is, is read from far away: only where it matters
            let material = match &mesh.face_materials {
                Some(_) => mesh.material_of(seen.triangle()),
                None => mesh.material,
            };
            let material = scene.materials.get(material as usize);
            let (base, varying) = match material.and_then(|m| m.base_color) {
                Some(color) => (color, 0),
                None => self.display_color(mesh, &seen, &[weights[0].get(i), weights[1].get(i), weights[2].get(i)]),
            };
            let emission = material.map_or(Rgb::BLACK, |m| m.emission);
            let normal = Form {
                start: Vec3::new(x.start[i], y.start[i], z.start[i]),
                across: Vec3::new(x.across[i], y.across[i], z.across[i]),
                up: Vec3::new(x.up[i], y.up[i], z.up[i]),
            };
            self.surfaces.push(Surface { normal, base, emission, origin: *origin, varying });
        }
    }

    /// What a mesh displays on a triangle: a colour, or one that varies.
    #[inline(always)]
    fn display_color(&mut self, mesh: &RenderMesh, seen: &Seen<'_, '_>, weights: &[Form<f32>; 3]) -> (Rgb, u16) {
        let Some(color) = &mesh.attributes.display_color else { return (in_unit(Rgb(FALLBACK_COLOR)), 0) };
        let corners = color.at_vertices(&mesh.shape.mesh, seen.triangle());
        match color.interpolation() {
            Interpolation::Constant | Interpolation::Uniform => (in_unit(Rgb(corners[0])), 0),
            Interpolation::Varying | Interpolation::Vertex | Interpolation::FaceVarying => {
                let sum = |weight: fn(&Form<f32>) -> f32| weights.iter().map(weight).sum();
                let whole = Form { start: sum(|w| w.start), across: sum(|w| w.across), up: sum(|w| w.up) };
                self.colors.push((Form::weighed(corners, weights), whole));
                // a square has few enough pixels
                (Rgb::BLACK, self.colors.len() as u16)
            }
        }
    }
}

/// Corners of triangles whose surfaces are made together: by corner and coordinate.
#[derive(Default)]
struct Corners {
    points: [[Each<f32>; 3]; 3],
    normals: [[Each<f32>; 3]; 3],
    /// Film positions of the pixels from which forms count.
    places: [Each<f64>; 2],
}

impl Corners {
    #[inline(always)]
    fn set(&mut self, i: usize, mesh: &RenderMesh, seen: &Seen<'_, '_>, place: [f64; 2]) {
        (self.places[0][i], self.places[1][i]) = (place[0], place[1]);
        // where its points have none
        let normals = if seen.has_normals() { [Vec3::ZERO; 3] } else { corner_normals(mesh, seen) };
        for (k, other) in normals.into_iter().enumerate() {
            let (corner, normal) = (seen.corner(k).0.to_array(), seen.normal(k).unwrap_or(other).to_array());
            for axis in 0..3 {
                (self.points[k][axis][i], self.normals[k][axis][i]) = (corner[axis], normal[axis]);
            }
        }
    }

    /// Weights of a triangle's corners, from its pixel on, that are as the barycentrics: at that pixel they have the
    /// sum one.
    ///
    /// A corner's is as the volume that the film position spans with the other two, all homogeneous.
    #[inline(always)]
    fn weights(&self, grid: &Grid, film_from_object: &FilmFromObject) -> [Forms; 3] {
        let mut weights = [Forms::default(); 3];
        let [a, b, c] = &self.points;
        for i in 0..LANES {
            let (x, y) = (self.places[0][i], self.places[1][i]);
            let place = |corner: &[Each<f32>; 3]| {
                let p = film_from_object.apply(Point3(Vec3::new(corner[0][i], corner[1][i], corner[2][i])));
                let weight = grid.weight(&p);
                DVec3::new(p.x - x * weight, p.y - y * weight, weight)
            };
            let (a, b, c) = (place(a), place(b), place(c));
            let volumes = [b.cross(c), c.cross(a), a.cross(b)];
            let scale = 1.0 / (volumes[0].z + volumes[1].z + volumes[2].z);
            // else seen edge on, by rounding alone
            let is_usual = scale.abs() <= f64::MAX;
            for k in 0..3 {
                let volume = volumes[k] * scale;
                weights[k].start[i] = if is_usual { volume.z as f32 } else { 1.0 / 3.0 };
                weights[k].across[i] = if is_usual { volume.x as f32 } else { 0.0 };
                weights[k].up[i] = if is_usual { volume.y as f32 } else { 0.0 };
            }
        }
        weights
    }

    /// Shading normals by coordinate, render space.
    #[inline(always)]
    fn normals(&self, render_from_normal: &Mat3, weights: &[Forms; 3]) -> [Forms; 3] {
        let mut normals = [Forms::default(); 3];
        let [a, b, c] = &self.normals;
        for i in 0..LANES {
            let moved = |n: &[Each<f32>; 3]| render_from_normal.mul_vec3(Vec3::new(n[0][i], n[1][i], n[2][i]));
            let (a, b, c) = (moved(a), moved(b), moved(c));
            let [p, q, r] = weights;
            let start = a * p.start[i] + b * q.start[i] + c * r.start[i];
            let across = a * p.across[i] + b * q.across[i] + c * r.across[i];
            let up = a * p.up[i] + b * q.up[i] + c * r.up[i];
            for axis in 0..3 {
                normals[axis].start[i] = start[axis];
                normals[axis].across[i] = across[axis];
                normals[axis].up[i] = up[axis];
            }
        }
        normals
    }
}

/// Forms of surfaces that are made together.
#[derive(Clone, Copy, Default)]
struct Forms {
    start: Each<f32>,
    across: Each<f32>,
    up: Each<f32>,
}

impl Forms {
    const ZERO: Self = Self { start: [0.0; LANES], across: [0.0; LANES], up: [0.0; LANES] };
    /// Weights by which the first of three values counts everywhere, and no other.
    const FIRST_ALONE: [Self; 3] = [Self { start: [1.0; LANES], ..Self::ZERO }, Self::ZERO, Self::ZERO];

    #[inline(always)]
    fn get(&self, i: usize) -> Form<f32> {
        Form { start: self.start[i], across: self.across[i], up: self.up[i] }
    }
}

/// Shading normals of a triangle's corners, object space, of a mesh whose points have none.
fn corner_normals(mesh: &RenderMesh, seen: &Seen<'_, '_>) -> [Vec3; 3] {
    match &mesh.attributes.normals {
        Some(normals) => normals.at_vertices(&mesh.shape.mesh, seen.triangle()),
        None => [unit_normal([seen.corner(0), seen.corner(1), seen.corner(2)]); 3],
    }
}

/// Shading normal of a triangle, render space, not of unit length.
pub fn shading_normal(placement: &Placement, mesh: &RenderMesh, triangle: u32, barycentrics: [f32; 3]) -> Vec3 {
    let normals = mesh.attributes.normals.as_ref();
    let normal = normals.map(|n| n.eval(&mesh.shape.mesh, triangle, barycentrics));
    match normal.filter(|n| n.length_squared() > 0.0) {
        Some(normal) => placement.render_from_normal * normal,
        None => face_normal(placement, mesh, triangle),
    }
}

/// The normal of a triangle itself, render space, not of unit length.
pub fn face_normal(placement: &Placement, mesh: &RenderMesh, triangle: u32) -> Vec3 {
    placement.render_from_normal * unit_normal(mesh.shape.triangle(triangle))
}

/// Of a triangle of any size, object space.
fn unit_normal([a, b, c]: [Point3; 3]) -> Vec3 {
    geometric_normal(a, b, c).0
}
