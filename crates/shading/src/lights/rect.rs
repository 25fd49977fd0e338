//! Rectangle light.

use std::f32::consts::PI;

use glam::{DVec3, Vec2};
use umber_math::{Bounds3, Point3, Ray, Rgb, Vector3};

use super::params::{Emission, LightParams, LightProblem};
use super::spherical_rect::SphericalRect;
use super::{LightHit, LightSample};

/// Rectangles whose squared diagonal is less than this part of their squared distance are sampled by area: there the
/// two hardly differ, and the solid angle costs more and loses its digits.
const SMALL: f64 = 1.0 / 6.0;

/// A rectangle that emits along −Z of light space; black seen from behind.
///
/// A transform with shear makes it a parallelogram, which is sampled by area.
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
        Ok(Self { emission, corner, edges, duals, center, diagonal_squared, rectangle, normal, area })
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
        let (to_light, pdf) = match self.view(p) {
            View::SolidAngle(r) => (r.sample(u), Some(1.0 / r.solid_angle)),
            View::Area => {
                let at = self.edges[0] * f64::from(u.x) + self.edges[1] * f64::from(u.y);
                (self.corner + at - p, None)
            }
        };
        let distance = to_light.length();
        let wi = to_light / distance;
        let pdf_solid_angle = pdf.unwrap_or_else(|| self.area_density(distance, wi)) as f32;
        let sample = LightSample {
            wi: Vector3(wi.as_vec3()),
            radiance: self.emission.radiance,
            pdf_solid_angle,
            distance: distance as f32,
            is_delta: false,
        };
        let is_usable = pdf_solid_angle.is_normal() && (sample.radiance / pdf_solid_angle).is_finite();
        (distance > 0.0 && is_usable).then_some(sample)
    }
    /// Density by solid angle of a point that is uniform by area.
    #[inline]
    fn area_density(&self, distance: f64, wi: DVec3) -> f64 {
        distance * distance / (self.area * -wi.dot(self.normal))
    }
    #[inline]
    pub(crate) fn pdf_solid_angle(&self, p: Point3, wi: Vector3) -> f32 {
        let (p, wi) = (p.0.as_dvec3(), wi.0.as_dvec3());
        let Some(t) = self.distance_along(p, wi).filter(|&t| t > 0.0 && self.is_lit(p)) else { return 0.0 };
        let pdf = match self.view(p) {
            View::SolidAngle(r) => 1.0 / r.solid_angle,
            View::Area => self.area_density(t, wi),
        } as f32;
        if pdf.is_finite() { pdf } else { 0.0 }
    }
    /// Parameter at which a ray meets the rectangle, from either side and at any sign.
    #[inline]
    fn distance_along(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        let t = (self.corner - origin).dot(self.normal) / direction.dot(self.normal);
        let at = origin + direction * t - self.corner;
        let [s, r] = self.duals.map(|dual| at.dot(dual));
        let inside = (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&r);
        (inside && t.is_finite()).then_some(t)
    }
    #[inline]
    pub(crate) fn intersect(&self, ray: &Ray) -> Option<LightHit> {
        let (o, d) = (ray.origin.0.as_dvec3(), ray.direction.0.as_dvec3());
        let t = self.distance_along(o, d)? as f32;
        let radiance = if d.dot(self.normal) < 0.0 { self.emission.radiance } else { Rgb::BLACK };
        (t > ray.t_min && t < ray.t_max).then_some(LightHit { t, radiance })
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
        self.emission.radiance * (PI * self.area as f32)
    }
}
