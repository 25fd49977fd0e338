//! Sphere light: seen as a uniform disk of directions; or a point.

use std::f32::consts::PI;

use glam::Vec2;
use umber_math::{Bounds3, Frame, Normal3, Point3, Ray, Rgb, Vector3};
use umber_sampling::warp;

use super::params::{BRIGHTEST, Emission, LightParams, LightProblem};
use super::{LightHit, LightSample};

/// A sphere that emits outwards.
///
/// Under a non-uniform scale or a shear it stays a sphere, of the same volume as the ellipsoid would have: its
/// radius is scaled by the cube root of the transform's determinant. Inside the sphere there is no light.
#[derive(Clone, Debug)]
pub struct SphereLight {
    /// For a point light, `radiance` is the radiant intensity.
    pub(crate) emission: Emission,
    center: Point3,
    /// Zero for a point light.
    radius: f32,
}

impl SphereLight {
    /// Treated as a point, the intensity is that of the sphere from afar: π r² × its radiance.
    pub(crate) fn new(
        p: &LightParams,
        radius: f32,
        treat_as_point: bool,
        problems: &mut Vec<LightProblem>,
    ) -> Result<Self, LightProblem> {
        use std::f64::consts::PI;
        let scale = p.render_from_light.matrix3.determinant().abs().cbrt();
        let center = p.render_from_light.translation.as_vec3();
        if !scale.is_finite() || !center.is_finite() {
            return Err(LightProblem::SingularTransform);
        }
        let radius = f64::from(radius) * scale;
        let is_sphere = radius > 0.0 && (radius as f32).is_normal() && ((radius * radius) as f32).is_normal();
        if treat_as_point {
            // Normalised, the radius cancels: π r² / (4 π r²), and may be zero.
            let cross_section = if p.normalize { 0.25 } else { PI * radius * radius };
            if cross_section <= 0.0 || cross_section.is_nan() {
                return Err(LightProblem::NoArea);
            }
            let emission = Emission::new(p, 1.0, cross_section, problems);
            return Ok(Self { emission, center: Point3(center), radius: 0.0 });
        }
        if scale == 0.0 {
            return Err(LightProblem::SingularTransform);
        }
        if !is_sphere {
            return Err(LightProblem::NoArea);
        }
        let emission = Emission::new(p, 4.0 * PI * radius * radius, 1.0, problems);
        Ok(Self { emission, center: Point3(center), radius: radius as f32 })
    }
    #[inline]
    pub(crate) fn sample(&self, p: Point3, u: Vec2) -> Option<LightSample> {
        let to_center = self.center - p;
        let distance_squared = to_center.length_squared();
        if self.radius == 0.0 {
            return self.sample_point(to_center, distance_squared);
        }
        let one_minus_cos = self.one_minus_cos(distance_squared)?;
        let distance = distance_squared.sqrt();
        let frame = Frame::from_normal(Normal3((to_center / distance).0));
        let local = warp::uniform_cone(u, one_minus_cos);
        // Along the sampled direction to the near side, written so that nothing cancels for far, small spheres.
        let sin_squared = local.x() * local.x() + local.y() * local.y();
        let half_chord = (self.radius * self.radius - distance_squared * sin_squared).max(0.0).sqrt();
        Some(LightSample {
            wi: frame.from_local(local).normalized(),
            radiance: self.emission.radiance,
            pdf_solid_angle: warp::uniform_cone_pdf_solid_angle(one_minus_cos),
            distance: (distance * local.z() - half_chord).max(0.0),
            is_delta: false,
        })
    }
    fn sample_point(&self, to_center: Vector3, distance_squared: f32) -> Option<LightSample> {
        let distance = distance_squared.sqrt();
        // A point in the light itself would receive infinitely much.
        let irradiance = Rgb((self.emission.radiance / distance_squared).0.min(glam::Vec3::splat(BRIGHTEST as f32)));
        let sample = LightSample {
            wi: to_center / distance,
            radiance: irradiance,
            pdf_solid_angle: 1.0,
            distance,
            is_delta: true,
        };
        (distance > 0.0 && distance.is_finite() && irradiance.is_finite()).then_some(sample)
    }
    #[inline]
    pub(crate) fn pdf_solid_angle(&self, p: Point3, wi: Vector3) -> f32 {
        let to_center = self.center - p;
        let Some(one_minus_cos) = self.one_minus_cos(to_center.length_squared()) else { return 0.0 };
        let chord = wi - to_center.normalized();
        let is_within = chord.length_squared() <= 2.0 * one_minus_cos;
        if is_within { warp::uniform_cone_pdf_solid_angle(one_minus_cos) } else { 0.0 }
    }
    /// `1 − cos` of the half angle under which the sphere is seen; `None` from inside it, and for a point light.
    #[inline]
    fn one_minus_cos(&self, distance_squared: f32) -> Option<f32> {
        let sin_squared = self.radius * self.radius / distance_squared;
        (sin_squared > f32::MIN_POSITIVE && sin_squared < 1.0)
            .then(|| warp::one_minus_cos_from_sin_squared(sin_squared))
    }
    /// The nearest hit with the sphere; from inside it is a hit that emits nothing.
    ///
    /// Haines et al. 2019, "Precision Improvements for Ray/Sphere Intersection".
    #[inline]
    pub(crate) fn intersect(&self, ray: &Ray) -> Option<LightHit> {
        if self.radius == 0.0 {
            return None;
        }
        let (f, d) = (ray.origin - self.center, ray.direction);
        let a = d.length_squared();
        let b = -f.dot(d);
        let nearest = f + d * (b / a);
        let discriminant = self.radius * self.radius - nearest.length_squared();
        if !(discriminant >= 0.0 && a > 0.0) {
            return None;
        }
        let q = b + (a * discriminant).sqrt().copysign(b);
        let c = f.length_squared() - self.radius * self.radius;
        let (t0, t1) = (c / q, q / a);
        let (near, far) = (t0.min(t1), t0.max(t1));
        let within = |t: f32| t > ray.t_min && t < ray.t_max;
        if within(near) {
            return Some(LightHit { t: near, radiance: self.emission.radiance, is_front: true });
        }
        within(far).then_some(LightHit { t: far, radiance: Rgb::BLACK, is_front: false })
    }
    pub(crate) fn bounds(&self) -> Bounds3 {
        let r = glam::Vec3::splat(self.radius);
        Bounds3 { min: self.center.0 - r, max: self.center.0 + r }
    }
    /// Radiant flux: 4 π² r² L, or 4 π I.
    pub(crate) fn power(&self) -> Rgb {
        let size = if self.radius == 0.0 { 1.0 } else { PI * self.radius * self.radius };
        self.emission.radiance * (4.0 * PI * size)
    }
    pub(crate) fn is_delta(&self) -> bool {
        self.radius == 0.0
    }
}
