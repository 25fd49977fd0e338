//! Distant light: a disk of constant radiance on the sky, or parallel light.

use std::f64::consts::PI;

use glam::Vec2;
use umber_math::{DVec3, Frame, Normal3, Rgb, Vector3};
use umber_sampling::warp;

use super::LightSample;
use super::params::{Emission, LightParams, LightProblem, distant_size_factor};

/// Half angles below this (radians) are parallel light: single-precision directions no longer resolve the disk.
const LEAST_HALF_ANGLE: f64 = 1e-5;

/// A light from infinitely far, along −Z of light space.
#[derive(Clone, Debug)]
pub struct DistantLight {
    pub(crate) emission: Emission,
    /// z points to the middle of the disk.
    frame: Frame,
    /// `1 − cos` of the half angle; zero for parallel light, whose `emission.radiance` is then its irradiance.
    one_minus_cos: f32,
    /// Irradiance on a surface that faces it.
    irradiance: Rgb,
}

impl DistantLight {
    /// Without a size, `angle` 0, the irradiance is the light's colour × intensity, normalised or not.
    pub(crate) fn new(p: &LightParams, angle_deg: f32, problems: &mut Vec<LightProblem>) -> Result<Self, LightProblem> {
        let to_light = p.render_from_light.matrix3 * DVec3::Z;
        let direction = to_light.normalize_or_zero();
        if direction == DVec3::ZERO {
            return Err(LightProblem::SingularTransform);
        }
        if angle_deg.is_nan() {
            problems.push(LightProblem::NotFinite("angle"));
        } else if angle_deg < 0.0 {
            problems.push(LightProblem::Negative("angle"));
        }
        let half_angle = (f64::from(angle_deg.max(0.0)).to_radians() * 0.5).min(PI);
        let size_factor = distant_size_factor(half_angle);
        let is_parallel = half_angle < LEAST_HALF_ANGLE;
        // A tiny disk without `normalize` lights as little as its size says.
        let scale = if is_parallel && half_angle > 0.0 { size_factor } else { 1.0 };
        let emission = Emission::new(p, size_factor, scale, problems);
        let one_minus_cos = if is_parallel { 0.0 } else { 2.0 * (half_angle * 0.5).sin().powi(2) };
        // Beyond a right angle the disk wraps behind the surface: that part is not received.
        let received = if is_parallel { 1.0 } else { PI * half_angle.min(PI * 0.5).sin().powi(2) };
        let irradiance = emission.radiance * received as f32;
        Ok(Self {
            emission,
            frame: Frame::from_normal(Normal3(direction.as_vec3())),
            one_minus_cos: one_minus_cos as f32,
            irradiance,
        })
    }
    #[inline]
    pub(crate) fn sample(&self, u: Vec2) -> Option<LightSample> {
        let is_delta = self.one_minus_cos == 0.0;
        let (wi, pdf_solid_angle) = if is_delta {
            (self.frame.normal.as_vector(), 1.0)
        } else {
            let local = warp::uniform_cone(u, self.one_minus_cos);
            (self.frame.from_local(local).normalized(), warp::uniform_cone_pdf_solid_angle(self.one_minus_cos))
        };
        Some(LightSample { wi, radiance: self.emission.radiance, pdf_solid_angle, distance: f32::INFINITY, is_delta })
    }
    #[inline]
    pub(crate) fn pdf_solid_angle(&self, wi: Vector3) -> f32 {
        if self.is_within(wi) { warp::uniform_cone_pdf_solid_angle(self.one_minus_cos) } else { 0.0 }
    }
    #[inline]
    pub(crate) fn radiance(&self, wi: Vector3) -> Option<Rgb> {
        self.is_within(wi).then_some(self.emission.radiance)
    }
    /// By the chord, not the cosine: |a − b|² = 2 (1 − cos) keeps its precision for small angles.
    #[inline]
    fn is_within(&self, wi: Vector3) -> bool {
        let chord = wi - self.frame.normal.as_vector();
        self.one_minus_cos > 0.0 && chord.length_squared() <= 2.0 * self.one_minus_cos
    }
    /// Irradiance on a surface that faces the light.
    #[inline]
    pub(crate) fn irradiance(&self) -> Rgb {
        self.irradiance
    }
    pub(crate) fn is_delta(&self) -> bool {
        self.one_minus_cos == 0.0
    }
}
