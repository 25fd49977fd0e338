//! What is the same for all pixels of a tile that show one triangle.

use umber_geometry::{Interpolation, geometric_normal};
use umber_math::{DVec3, Point3, Rgb, Vec3};

use super::bins::Seen;
use super::placement::Placement;
use super::project::{FilmFromObject, Grid};
use crate::material::in_unit;
use crate::mesh::RenderMesh;
use crate::scene::RenderScene;
use crate::surface::FALLBACK_COLOR;

/// A triangle that is seen in a tile.
pub struct VisibleTriangle<'a> {
    /// Where its mesh stands.
    pub placement: &'a Placement,
    /// Its mesh.
    pub mesh: &'a RenderMesh,
    /// Which of the mesh's it is.
    pub index: u32,
    /// The pixel from which its forms count.
    origin: [i32; 2],
    normal: Form<Vec3>,
    base: Base,
    /// Emitted radiance.
    pub emission: Rgb,
}

/// What is linear over the film.
#[derive(Clone, Copy)]
struct Form<T> {
    /// At the first pixel.
    start: T,
    /// Change by one pixel across, and one up.
    across: T,
    up: T,
}

/// The colour of a triangle.
enum Base {
    /// The same everywhere.
    Same(Rgb),
    /// A form over another: perspective.
    Varying(Box<(Form<Vec3>, Form<f32>)>),
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

impl<'a> VisibleTriangle<'a> {
    /// A triangle that is seen at a pixel, with the shading normals of its corners.
    #[inline(always)]
    pub fn new(
        scene: &'a RenderScene,
        grid: &Grid,
        placement: &'a Placement,
        seen: &Seen<'_>,
        normals: &Option<[Vec3; 3]>,
        origin: [i32; 2],
    ) -> Self {
        let (mesh, index) = (placement.mesh(scene), seen.triangle);
        let corners = seen.corners();
        let weights = weights(grid, &placement.film_from_object, &corners, origin);
        let material = scene.materials.get(mesh.material_of(index) as usize);
        let normal = match normals {
            Some([a, b, c]) => {
                let to_render = &placement.render_from_normal;
                Form::weighed([to_render.mul_vec3(*a), to_render.mul_vec3(*b), to_render.mul_vec3(*c)], &weights)
            }
            None => {
                let normal = placement.render_from_normal * face_normal(corners);
                Form { start: normal, across: Vec3::ZERO, up: Vec3::ZERO }
            }
        };
        let base = match material.and_then(|m| m.base_color) {
            Some(color) => Base::Same(color),
            None => display_color(mesh, index, &weights),
        };
        let emission = material.map_or(Rgb::BLACK, |m| m.emission);
        Self { placement, mesh, index, origin, normal, base, emission }
    }

    /// Shading normal at a pixel, not of unit length, and its colour.
    #[inline(always)]
    pub fn at(&self, pixel: [i32; 2]) -> (Vec3, Rgb) {
        let at = [(pixel[0] - self.origin[0]) as f32, (pixel[1] - self.origin[1]) as f32];
        let normal = self.normal.at(at);
        // neither zero nor what is not a number
        let normal = if normal.length_squared() > 0.0 { normal } else { self.face_normal() };
        let base = match &self.base {
            Base::Same(color) => *color,
            Base::Varying(forms) => in_unit(Rgb(forms.0.at(at) / forms.1.at(at))),
        };
        (normal, base)
    }

    /// Shading normal, render space, not of unit length.
    pub fn shading_normal(&self, barycentrics: [f32; 3]) -> Vec3 {
        let normals = self.mesh.attributes.normals.as_ref();
        let normal = normals.map(|n| n.eval(&self.mesh.shape.mesh, self.index, barycentrics));
        match normal.filter(|n| n.length_squared() > 0.0) {
            Some(normal) => self.placement.render_from_normal * normal,
            None => self.face_normal(),
        }
    }

    #[cold]
    fn face_normal(&self) -> Vec3 {
        self.placement.render_from_normal * face_normal(self.mesh.shape.triangle(self.index))
    }
}

/// What a mesh displays on a triangle.
#[inline(always)]
fn display_color(mesh: &RenderMesh, index: u32, weights: &[Form<f32>; 3]) -> Base {
    let Some(color) = &mesh.attributes.display_color else { return Base::Same(in_unit(Rgb(FALLBACK_COLOR))) };
    let corners = color.at_vertices(&mesh.shape.mesh, index);
    match color.interpolation() {
        Interpolation::Constant | Interpolation::Uniform => Base::Same(in_unit(Rgb(corners[0]))),
        Interpolation::Varying | Interpolation::Vertex | Interpolation::FaceVarying => {
            let sum = |weight: fn(&Form<f32>) -> f32| weights.iter().map(weight).sum();
            let whole = Form { start: sum(|w| w.start), across: sum(|w| w.across), up: sum(|w| w.up) };
            Base::Varying(Box::new((Form::weighed(corners, weights), whole)))
        }
    }
}

/// Weights of a triangle's corners, from a pixel on, that are as the barycentrics: at that pixel they have the sum one.
///
/// A corner's is as the volume that the film position spans with the other two, all homogeneous.
#[inline(always)]
fn weights(grid: &Grid, film_from_object: &FilmFromObject, corners: &[Point3; 3], origin: [i32; 2]) -> [Form<f32>; 3] {
    let [x, y] = grid.film_position(origin);
    let mut places = [DVec3::ZERO; 3];
    for (place, corner) in places.iter_mut().zip(corners) {
        let p = film_from_object.apply(*corner);
        let weight = grid.weight(&p);
        *place = DVec3::new(p.x - x * weight, p.y - y * weight, weight);
    }
    let [a, b, c] = places;
    let volumes = [b.cross(c), c.cross(a), a.cross(b)];
    let scale = 1.0 / (volumes[0].z + volumes[1].z + volumes[2].z);
    let mut weights = [Form { start: 1.0 / 3.0, across: 0.0, up: 0.0 }; 3];
    // else seen edge on, by rounding alone
    if scale.is_finite() {
        for (weight, volume) in weights.iter_mut().zip(volumes) {
            let [across, up, start] = (volume * scale).as_vec3().to_array();
            *weight = Form { start, across, up };
        }
    }
    weights
}

/// Of a triangle of any size, unit, object space.
fn face_normal([a, b, c]: [Point3; 3]) -> Vec3 {
    geometric_normal(a, b, c).0
}
