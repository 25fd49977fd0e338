//! Disk light: an ellipse where it is scaled unevenly.

use std::f32::consts::PI;

use glam::{DVec2, DVec3, Vec2};
use umber_math::{Bounds3, Point3, Ray, Rgb, Vector3};
use umber_sampling::warp;

use super::params::{Emission, LightParams, LightProblem};
use super::spherical_rect::SphericalRect;
use super::{LightHit, LightSample};

/// Solid angles below this (steradians) lose their digits; the disk is then sampled by area.
const LEAST_SOLID_ANGLE: f64 = 1e-4;

/// A disk that emits along −Z of light space; black seen from behind.
///
/// Any transform makes it an ellipse, which is lit, met and sized exactly. From afar it is sampled by area; from
/// nearby, where that would be noisy, uniformly in the solid angle of a rectangle around it, and what falls beside
/// the ellipse is refused (at most 1 − π/4 of the samples of a disk seen from its axis, fewer from nearby).
#[derive(Clone, Debug)]
pub struct DiskLight {
    pub(crate) emission: Emission,
    center: DVec3,
    /// Unit, along the ellipse's long and short axis.
    axes: [DVec3; 2],
    /// Half its length and width.
    radii: DVec2,
    /// Unit, on the emitting side.
    normal: DVec3,
    area: f64,
}

/// How a point samples the ellipse.
enum View {
    SolidAngle(SphericalRect),
    Area,
}

impl DiskLight {
    pub(crate) fn new(p: &LightParams, radius: f32, problems: &mut Vec<LightProblem>) -> Result<Self, LightProblem> {
        let m = p.render_from_light;
        if radius.is_nan() || radius <= 0.0 {
            return Err(LightProblem::NoArea);
        }
        let [u, v] = [m.matrix3.x_axis, m.matrix3.y_axis].map(|axis| axis * f64::from(radius));
        if !m.translation.is_finite() || m.matrix3.x_axis.cross(m.matrix3.y_axis) == DVec3::ZERO {
            return Err(LightProblem::SingularTransform);
        }
        // The ellipse is u cos t + v sin t; its axes are where the distance from the centre is extreme.
        let (sin, cos) = (0.5 * (2.0 * u.dot(v)).atan2(u.length_squared() - v.length_squared())).sin_cos();
        let half_axes = [u * cos + v * sin, v * cos - u * sin];
        let radii = DVec2::from(half_axes.map(DVec3::length));
        let cross = u.cross(v);
        let area = std::f64::consts::PI * cross.length();
        let is_normal = |v: f64| (v as f32).is_normal();
        if !(is_normal(area) && is_normal(radii.x * radii.x) && is_normal(radii.y * radii.y)) {
            return Err(LightProblem::NoArea);
        }
        // −Z may lie in the plane when z is squashed; then −(x × y), as without a transform.
        let along = if m.matrix3.z_axis.dot(cross) < 0.0 { cross } else { -cross };
        Ok(Self {
            emission: Emission::new(p, area, 1.0, problems),
            center: m.translation,
            axes: [half_axes[0] / radii.x, half_axes[1] / radii.y],
            radii,
            normal: along.normalize(),
            area,
        })
    }
    /// A point in the ellipse's own coordinates: along its axes, and above it.
    #[inline]
    fn local(&self, p: DVec3) -> (DVec2, f64) {
        let q = p - self.center;
        (DVec2::new(q.dot(self.axes[0]), q.dot(self.axes[1])), q.dot(self.normal))
    }
    #[inline]
    fn contains(&self, at: DVec2) -> bool {
        (at / self.radii).length_squared() <= 1.0
    }
    #[inline]
    fn view(&self, p: DVec3) -> View {
        let (at, height) = self.local(p);
        let (aside, radius, h2) = (at.length(), self.radii.max_element(), height * height);
        let (nearest, farthest) = ((aside - radius).max(0.0), aside + radius);
        if farthest * farthest + h2 < 2.0 * (nearest * nearest + h2) {
            return View::Area;
        }
        // A nearly round one has its rectangle turned so that a side, not a corner, is next to the point.
        let is_round = self.radii.max_element() < 1.5 * self.radii.min_element();
        let turn = if is_round && aside > 0.0 { at / aside } else { DVec2::X };
        let axes = [turn, turn.perp()];
        let half = axes.map(|axis| (axis * self.radii).length());
        let axes = axes.map(|axis| self.axes[0] * axis.x + self.axes[1] * axis.y);
        let corner = self.center - axes[0] * half[0] - axes[1] * half[1];
        match SphericalRect::new(corner - p, axes, half.map(|h| 2.0 * h)) {
            Some(rect) if rect.solid_angle >= LEAST_SOLID_ANGLE => View::SolidAngle(rect),
            _ => View::Area,
        }
    }
    #[inline]
    fn is_lit(&self, p: DVec3) -> bool {
        (p - self.center).dot(self.normal) > 0.0
    }
    #[inline]
    pub(crate) fn sample(&self, p: Point3, u: Vec2) -> Option<LightSample> {
        let p = p.0.as_dvec3();
        if !self.is_lit(p) {
            return None;
        }
        let (to_light, pdf) = match self.view(p) {
            View::SolidAngle(rect) => {
                let to_light = rect.sample(u);
                if !self.contains(self.local(p + to_light).0) {
                    return None;
                }
                (to_light, Some(1.0 / rect.solid_angle))
            }
            View::Area => {
                let at = warp::concentric_disk(u).as_dvec2() * self.radii;
                (self.center + self.axes[0] * at.x + self.axes[1] * at.y - p, None)
            }
        };
        let distance = to_light.length();
        let density = pdf.unwrap_or_else(|| self.area_density(distance, to_light / distance));
        LightSample::of_point(to_light, distance, density, self.emission.radiance)
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
            View::SolidAngle(rect) => 1.0 / rect.solid_angle,
            View::Area => self.area_density(t, wi),
        } as f32;
        if pdf.is_finite() { pdf } else { 0.0 }
    }
    /// Parameter at which a ray meets the ellipse, from either side and at any sign.
    #[inline]
    fn distance_along(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        let t = (self.center - origin).dot(self.normal) / direction.dot(self.normal);
        (t.is_finite() && self.contains(self.local(origin + direction * t).0)).then_some(t)
    }
    #[inline]
    pub(crate) fn intersect(&self, ray: &Ray) -> Option<LightHit> {
        let (o, d) = (ray.origin.0.as_dvec3(), ray.direction.0.as_dvec3());
        let t = self.distance_along(o, d)? as f32;
        let is_front = d.dot(self.normal) < 0.0;
        let radiance = if is_front { self.emission.radiance } else { Rgb::BLACK };
        (t > ray.t_min && t < ray.t_max).then_some(LightHit { t, radiance, is_front })
    }
    pub(crate) fn bounds(&self) -> Bounds3 {
        let [a, b] = [self.axes[0] * self.radii.x, self.axes[1] * self.radii.y];
        let half = (a * a + b * b).to_array().map(f64::sqrt);
        let corners = [self.center - DVec3::from(half), self.center + DVec3::from(half)];
        Bounds3::of_points(corners.map(|c| Point3(c.as_vec3())))
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
