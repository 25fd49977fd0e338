//! From object space to the film: homogeneous positions, and their places on a fine integer grid.

use umber_math::{DAffine3, DVec2, DVec3, Point3, Vec3};
use umber_scene::Projection;

use super::square;
use crate::camera::View;
use crate::clusters::{LANES, PointBlock};

/// Bits of a coordinate on the grid: edge functions of such coordinates are exact in 64 bits.
const COORDINATE_BITS: u32 = 29;
/// Less than any coordinate on the grid.
const OFF: i32 = -1 << (COORDINATE_BITS + 1);
/// Edges no longer than this, grid units, have edge functions of 52 bits, and half a step more of them fits in a
/// floating-point number.
const MOST_SHORT: i32 = 1 << 25;
/// Added to a number of less than 32 bits, it leaves its nearest integer in the lowest bits.
pub const ROUNDER: f64 = 6_755_399_441_055_744.0;
/// Least weight of a homogeneous position: what is nearer to the eye is cut off.
const LEAST_DISTANCE: f64 = 1e-30;
/// The near plane is moved by this factor, as the camera moves the near ends of its rays.
const NEAR_SLACK: f64 = 1.0 - 16.0 * f32::EPSILON as f64;

/// A position before the division by its weight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Homogeneous {
    /// Film position from the film's middle, pixels with y up, times the weight.
    pub x: f64,
    /// As `x`.
    pub y: f64,
    /// Distance from the camera along the view axis.
    pub distance: f64,
}

impl Homogeneous {
    /// The position at `t` of the way to another.
    pub fn toward(self, o: Self, t: f64) -> Self {
        let at = |a: f64, b: f64| a + (b - a) * t;
        Self { x: at(self.x, o.x), y: at(self.y, o.y), distance: at(self.distance, o.distance) }
    }
}

/// A projected vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// Film position from the film's middle, in grid units, y up.
    pub x: i32,
    /// As `x`.
    pub y: i32,
    /// Larger is nearer, and linear over a projected triangle: one over the distance along the view axis; that
    /// distance, negative, for orthographic cameras.
    pub nearness: f32,
}

impl Vertex {
    /// Stands for a vertex that has no place on the grid: its triangles must be clipped.
    pub const OFF_GRID: Self = Self { x: OFF, y: OFF, nearness: 0.0 };

    /// Whether it is [`Vertex::OFF_GRID`].
    #[inline(always)]
    pub fn is_off_grid(&self) -> bool {
        self.x == OFF
    }
}

/// Some projected vertices, as [`Vertex`].
#[derive(Clone, Copy, Debug)]
pub struct Vertices {
    /// Coordinates of each.
    pub x: [i32; LANES],
    /// As `x`.
    pub y: [i32; LANES],
    /// Of each.
    pub nearness: [f32; LANES],
}

impl Vertices {
    /// One of them.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Vertex {
        Vertex { x: self.x[i], y: self.y[i], nearness: self.nearness[i] }
    }
}

/// The film's grid.
#[derive(Clone, Copy, Debug)]
pub struct Grid {
    /// Pixels across.
    pub width: i32,
    /// Pixels down.
    pub height: i32,
    /// Grid units in a pixel: two to this power.
    pub subpixel_bits: u32,
    /// Edges that are no longer, either way, have edge functions that fit in 32 bits, in pixels times grid units: in the
    /// triangle's box and a few pixels beside it.
    pub short: i32,
    /// Largest film position from the middle that has a place on the grid, pixels.
    pub guard: f64,
    /// Whether positions are divided by their distance.
    pub is_perspective: bool,
    /// Distance of the near plane.
    pub near: f64,
    /// Distance of the far plane.
    pub far: f64,
    /// Its nearness: what is to be seen has more.
    pub far_nearness: f32,
    view: View,
}

impl Grid {
    /// The grid of a film of so many pixels.
    pub fn new(view: View, width: usize, height: usize) -> Self {
        // half the film, and as much again around it
        let guard_bits = usize::BITS - width.max(height).max(2).leading_zeros();
        let is_perspective = view.projection == Projection::Perspective;
        let near = (view.near * NEAR_SLACK).max(if is_perspective { LEAST_DISTANCE } else { 0.0 });
        let subpixel_bits = COORDINATE_BITS - guard_bits;
        // of an edge of l pixels, and what is l + n pixels away, no more than 2 l (l + n) grid units
        let n = square::LANES as f64;
        let unit = f64::from(1u32 << subpixel_bits);
        let short = (0.25 * n * n + f64::from(1u32 << 29) / unit).sqrt() - 0.5 * n;
        Self {
            width: width as i32,
            height: height as i32,
            subpixel_bits,
            short: ((short * unit) as i32).min(MOST_SHORT),
            guard: f64::from(1u32 << guard_bits),
            is_perspective,
            near,
            far: view.far,
            far_nearness: (if is_perspective { 1.0 / view.far } else { -view.far }) as f32,
            view,
        }
    }

    /// What leads from object space to homogeneous positions.
    pub fn film_from_object(&self, render_from_object: &DAffine3) -> FilmFromObject {
        let camera = self.view.camera_from_render * *render_from_object;
        let rows = camera.matrix3.transpose();
        let row = |axis: DVec3, translation: f64| Row { axis, translation };
        let depth = row(-rows.z_axis, -camera.translation.z);
        let (min, step) = (self.view.screen_min, self.view.screen_step);
        let across = |r: Row, min: f64, step: f64, pixels: i32| {
            // film position of screen position zero, from the film's middle
            let shift = -min / step - 0.5 * f64::from(pixels);
            if self.is_perspective {
                r.times(1.0 / step).plus(depth.times(shift))
            } else {
                let r = r.times(1.0 / step);
                Row { translation: r.translation + shift, ..r }
            }
        };
        FilmFromObject {
            x: across(row(rows.x_axis, camera.translation.x), min.x, step.x, self.width),
            y: across(row(rows.y_axis, camera.translation.y), min.y, step.y, self.height),
            distance: depth,
        }
    }

    /// Directions of view rays, render space, not of unit length: through the film's middle, and their change by one
    /// pixel across and one up.
    pub fn directions(&self) -> [Vec3; 3] {
        let render_from_camera = self.view.camera_from_render.matrix3.inverse();
        let (min, step) = (self.view.screen_min, self.view.screen_step);
        let middle = min + step * 0.5 * DVec2::new(self.width.into(), self.height.into());
        let directions = if self.is_perspective {
            [DVec3::new(middle.x, middle.y, -1.0), DVec3::new(step.x, 0.0, 0.0), DVec3::new(0.0, step.y, 0.0)]
        } else {
            [DVec3::NEG_Z, DVec3::ZERO, DVec3::ZERO]
        };
        directions.map(|d| (render_from_camera * d).as_vec3())
    }

    /// The weight that a position is divided by.
    #[inline(always)]
    pub fn weight(&self, p: &Homogeneous) -> f64 {
        if self.is_perspective { p.distance } else { 1.0 }
    }

    /// The place of a position, [`Vertex::OFF_GRID`] where it has none.
    #[inline(always)]
    pub fn place(&self, p: Homogeneous) -> Vertex {
        let scale = 1.0 / self.weight(&p);
        let (x, y) = (p.x * scale, p.y * scale);
        // false for what is not a number, too
        let on_grid = (p.distance >= self.near) & (x.abs() < self.guard) & (y.abs() < self.guard);
        let vertex = self.vertex(x, y, scale, p.distance);
        Vertex {
            x: if on_grid { vertex.x } else { Vertex::OFF_GRID.x },
            y: if on_grid { vertex.y } else { Vertex::OFF_GRID.y },
            nearness: vertex.nearness,
        }
    }

    /// The place of a position that was clipped: where rounding leads beside the grid, its nearest place.
    pub fn place_clipped(&self, p: Homogeneous) -> Vertex {
        let scale = 1.0 / self.weight(&p);
        let on = |v: f64| (v * scale).clamp(-self.guard, self.guard);
        self.vertex(on(p.x), on(p.y), scale, p.distance)
    }

    #[inline(always)]
    fn vertex(&self, x: f64, y: f64, scale: f64, distance: f64) -> Vertex {
        let unit = f64::from(1u32 << self.subpixel_bits);
        let nearness = if self.is_perspective { scale } else { -distance };
        Vertex {
            x: (x * unit + ROUNDER).to_bits() as i32,
            y: (y * unit + ROUNDER).to_bits() as i32,
            nearness: nearness as f32,
        }
    }

    /// The middle of a pixel, grid units. `pixels`: of the film in that direction.
    #[inline(always)]
    pub fn center(&self, pixel: i32, pixels: i32) -> i32 {
        (2 * pixel + 1 - pixels) << (self.subpixel_bits - 1)
    }

    /// A pixel's middle, from the film's, pixels.
    #[inline(always)]
    pub fn film_position(&self, [x, y]: [i32; 2]) -> [f64; 2] {
        [f64::from(x) + 0.5 - 0.5 * f64::from(self.width), f64::from(y) + 0.5 - 0.5 * f64::from(self.height)]
    }

    /// The places of some points; `film_from_object`: of their object.
    #[inline(always)]
    pub fn place_block(&self, film_from_object: &FilmFromObject, [x, y, z]: &PointBlock) -> Vertices {
        let mut vertices = Vertices { x: [0; LANES], y: [0; LANES], nearness: [0.0; LANES] };
        for i in 0..LANES {
            let vertex = self.place(film_from_object.apply(Point3(Vec3::new(x[i], y[i], z[i]))));
            (vertices.x[i], vertices.y[i], vertices.nearness[i]) = (vertex.x, vertex.y, vertex.nearness);
        }
        vertices
    }
}

/// A linear form of a point.
#[derive(Clone, Copy, Debug)]
struct Row {
    axis: DVec3,
    translation: f64,
}

impl Row {
    fn times(self, factor: f64) -> Self {
        Self { axis: self.axis * factor, translation: self.translation * factor }
    }
    fn plus(self, o: Self) -> Self {
        Self { axis: self.axis + o.axis, translation: self.translation + o.translation }
    }
    #[inline(always)]
    fn of(&self, p: DVec3) -> f64 {
        self.axis.x * p.x + (self.axis.y * p.y + (self.axis.z * p.z + self.translation))
    }
}

/// Brings points of an object to the film.
#[derive(Clone, Copy, Debug)]
pub struct FilmFromObject {
    x: Row,
    y: Row,
    distance: Row,
}

impl FilmFromObject {
    /// The homogeneous position of a point.
    #[inline(always)]
    pub fn apply(&self, p: Point3) -> Homogeneous {
        let p = p.0.as_dvec3();
        Homogeneous { x: self.x.of(p), y: self.y.of(p), distance: self.distance.of(p) }
    }
}
