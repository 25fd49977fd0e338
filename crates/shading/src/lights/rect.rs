//! Rectangle light.

use std::f32::consts::PI;
use std::sync::Arc;

use glam::{DVec3, Vec2};
use umber_math::{Bounds3, Point3, Ray, Rgb, Vector3};

use super::params::{Emission, LightParams, LightProblem};
use super::spherical_rect::SphericalRect;
use super::{LightHit, LightSample, LightTexture};

/// Rectangles whose squared diagonal is less than this part of their squared distance are sampled by area: there it
/// differs little, and the solid angle costs more and loses its digits. Half leaves an error of 3 % more in a Cornell box
/// than a sixth does, in 7 to 10 % less time.
const SMALL: f64 = 0.5;
/// More than rounding adds to a product of two numbers.
const BEYOND: f64 = 1.0 + 1e-12;

/// A rectangle that emits along −Z of light space; black seen from behind.
///
/// A transform with shear makes it a parallelogram, which is sampled by area.
///
/// Seen from the front with +Y up, a texture stands upright: by UsdLux its first pixel lies at +X +Y, its last one at
/// −X −Y. It takes half of the samples, by its luminance; the other half is uniform in solid angle, as without one.
#[derive(Clone, Debug)]
pub struct RectLight {
    pub(crate) emission: Emission,
    /// The corner at −X −Y, and the edges from it.
    corner: DVec3,
    edges: [DVec3; 2],
    /// Their products with a point of the plane, relative to the corner, are its coordinates along the edges.
    duals: [DVec3; 2],
    center: DVec3,
    diagonal_squared: f64,
    /// Unit edges and their lengths, where they are perpendicular.
    rectangle: Option<([DVec3; 2], [f64; 2])>,
    /// Unit, on the emitting side.
    normal: DVec3,
    area: f64,
    texture: Option<Arc<LightTexture>>,
}

/// How a point sees the rectangle.
enum View {
    SolidAngle(SphericalRect),
    Area,
}

impl RectLight {
    pub(crate) fn new(
        p: &LightParams,
        width: f32,
        height: f32,
        problems: &mut Vec<LightProblem>,
    ) -> Result<Self, LightProblem> {
        let m = p.render_from_light;
        if !(width > 0.0 && height > 0.0) {
            return Err(LightProblem::NoArea);
        }
        let edges = [m.matrix3.x_axis * f64::from(width), m.matrix3.y_axis * f64::from(height)];
        let corner = m.translation - edges[0] * 0.5 - edges[1] * 0.5;
        if !corner.is_finite() || m.matrix3.x_axis.cross(m.matrix3.y_axis) == DVec3::ZERO {
            return Err(LightProblem::SingularTransform);
        }
        let cross = edges[0].cross(edges[1]);
        let area = cross.length();
        let is_normal = |v: f64| (v as f32).is_normal();
        if !(is_normal(area) && edges.iter().all(|e| is_normal(e.length_squared()))) {
            return Err(LightProblem::NoArea);
        }
        // −Z may lie in the plane when z is squashed; then −(x × y), as without a transform.
        let along = if m.matrix3.z_axis.dot(cross) < 0.0 { cross } else { -cross };
        let lengths = edges.map(|e| e.length());
        let axes = [edges[0] / lengths[0], edges[1] / lengths[1]];
        let rectangle = (axes[0].dot(axes[1]).abs() < 1e-6).then_some((axes, lengths));
        let emission = Emission::new(p, area, 1.0, problems);
        let diagonal_squared = (edges[0] + edges[1]).length_squared().max((edges[0] - edges[1]).length_squared());
        let duals = [edges[1].cross(cross), cross.cross(edges[0])].map(|d| d / (area * area));
        let (center, normal) = (m.translation, along / area);
        let texture = p.texture.clone();
        Ok(Self { emission, corner, edges, duals, center, diagonal_squared, rectangle, normal, area, texture })
    }
    #[inline]
    fn view(&self, p: DVec3) -> View {
        if self.diagonal_squared < SMALL * p.distance_squared(self.center) {
            return View::Area;
        }
        let whole = self.rectangle.and_then(|(axes, lengths)| SphericalRect::new(self.corner - p, axes, lengths));
        whole.map_or(View::Area, View::SolidAngle)
    }
    #[inline]
    fn is_lit(&self, p: DVec3) -> bool {
        (p - self.corner).dot(self.normal) > 0.0
    }
    #[inline]
    pub(crate) fn sample(&self, p: Point3, u: Vec2) -> Option<LightSample> {
        let p = p.0.as_dvec3();
        if !self.is_lit(p) {
            return None;
        }
        let view = self.view(p);
        let to_light = match &self.texture {
            Some(texture) if u.x < 0.5 => self.point(texture.sample(Vec2::new(2.0 * u.x, u.y)).0) - p,
            Some(_) => self.sample_shape(&view, p, Vec2::new(2.0 * u.x - 1.0, u.y)),
            None => self.sample_shape(&view, p, u),
        };
        let distance = to_light.length();
        let uv = self.texture.as_ref().map(|_| self.uv(p + to_light));
        let density = self.density(&view, distance, to_light / distance, uv);
        LightSample::of_point(to_light, distance, density, self.radiance(uv))
    }
    /// To a point of the shape, uniform in solid angle or by area.
    #[inline]
    fn sample_shape(&self, view: &View, p: DVec3, u: Vec2) -> DVec3 {
        match view {
            View::SolidAngle(r) => r.sample(u),
            View::Area => {
                let at = self.edges[0] * f64::from(u.x) + self.edges[1] * f64::from(u.y);
                self.corner + at - p
            }
        }
    }
    /// Density by solid angle with which a place, in the texture's coordinates where there is one, is sampled.
    #[inline]
    fn density(&self, view: &View, distance: f64, wi: DVec3, uv: Option<Vec2>) -> f64 {
        let of_shape = match view {
            View::SolidAngle(r) => 1.0 / r.solid_angle,
            View::Area => self.area_density(distance, wi),
        };
        match (&self.texture, uv) {
            (Some(texture), Some(uv)) => {
                0.5 * (of_shape + f64::from(texture.pdf(uv)) * self.area_density(distance, wi))
            }
            (Some(_), None) => 0.5 * of_shape,
            (None, _) => of_shape,
        }
    }
    #[inline]
    fn radiance(&self, uv: Option<Vec2>) -> Rgb {
        match (&self.texture, uv) {
            (Some(texture), Some(uv)) => self.emission.radiance * texture.at(uv),
            _ => self.emission.radiance,
        }
    }
    /// The point that shows a place of the texture.
    #[inline]
    fn point(&self, uv: Vec2) -> DVec3 {
        self.corner + self.edges[0] * f64::from(1.0 - uv.x) + self.edges[1] * f64::from(1.0 - uv.y)
    }
    /// Density by solid angle of a point that is uniform by area.
    #[inline]
    fn area_density(&self, distance: f64, wi: DVec3) -> f64 {
        distance * distance / (self.area * -wi.dot(self.normal))
    }
    #[inline]
    pub(crate) fn pdf_solid_angle(&self, p: Point3, wi: Vector3) -> f32 {
        let (p, wi) = (p.0.as_dvec3(), wi.0.as_dvec3());
        let Some((t, uv)) = self.meets(p, wi).filter(|&(t, _)| t > 0.0 && self.is_lit(p)) else { return 0.0 };
        let pdf = self.density(&self.view(p), t, wi, Some(uv)) as f32;
        if pdf.is_finite() { pdf } else { 0.0 }
    }
    /// Parameter at which a ray meets the rectangle, from either side and at any sign, and where in the texture.
    #[inline]
    fn meets(&self, origin: DVec3, direction: DVec3) -> Option<(f64, Vec2)> {
        let t = (self.corner - origin).dot(self.normal) / direction.dot(self.normal);
        let [s, r] = self.coordinates(origin + direction * t);
        let inside = (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&r);
        (inside && t.is_finite()).then(|| (t, Vec2::new((1.0 - s) as f32, (1.0 - r) as f32)))
    }
    /// Coordinates of a point of the plane along the edges, which may be skew: 0 … 1 within the shape.
    #[inline]
    fn coordinates(&self, point: DVec3) -> [f64; 2] {
        let at = point - self.corner;
        [at.dot(self.duals[0]), at.dot(self.duals[1])]
    }
    /// The place of the texture that a point of the shape shows.
    #[inline]
    fn uv(&self, point: DVec3) -> Vec2 {
        let [s, r] = self.coordinates(point);
        Vec2::new((1.0 - s) as f32, (1.0 - r) as f32).clamp(Vec2::ZERO, Vec2::ONE)
    }
    #[inline]
    pub(crate) fn intersect(&self, ray: &Ray) -> Option<LightHit> {
        let (o, d) = (ray.origin.0.as_dvec3(), ray.direction.0.as_dvec3());
        let (height, fall) = ((self.corner - o).dot(self.normal), d.dot(self.normal));
        // most rays go the other way, or end before its plane: these need no division
        let (least, most) = (fall.abs() * f64::from(ray.t_min), fall.abs() * f64::from(ray.t_max) * BEYOND);
        let along = if fall < 0.0 { -height } else { height };
        if !(along >= least && along <= most) {
            return None;
        }
        let (t, uv) = self.meets(o, d)?;
        let (t, is_front) = (t as f32, fall < 0.0);
        let radiance = if is_front { self.radiance(Some(uv)) } else { Rgb::BLACK };
        (t > ray.t_min && t < ray.t_max).then_some(LightHit { t, radiance, is_front })
    }
    /// How large it looks from a point, about, as a solid angle; zero where none of its light arrives.
    #[inline]
    pub(crate) fn apparent_size(&self, p: Point3) -> f32 {
        let to_point = p.0.as_dvec3() - self.center;
        let height = to_point.dot(self.normal);
        let radius_squared = 0.25 * self.diagonal_squared;
        let softened = to_point.length_squared() + radius_squared;
        // low above its plane the far side counts as well
        let size = self.area * (height + 0.5 * radius_squared.sqrt()) / (softened * softened.sqrt());
        if height > 0.0 { size as f32 } else { 0.0 }
    }
    pub(crate) fn bounds(&self) -> Bounds3 {
        let [a, b] = self.edges;
        let corners = [DVec3::ZERO, a, b, a + b];
        Bounds3::of_points(corners.map(|c| Point3((self.corner + c).as_vec3())))
    }
    /// The direction it faces, render space, unit.
    pub(crate) fn facing(&self) -> Vector3 {
        Vector3(self.normal.as_vec3())
    }
    /// Radiant flux: π A L.
    pub(crate) fn power(&self) -> Rgb {
        let mean = self.texture.as_ref().map_or(Rgb::WHITE, |texture| texture.mean());
        self.emission.radiance * mean * (PI * self.area as f32)
    }
}
