//! Dome light: constant, or a map sampled by its luminance.

use std::sync::Arc;

use glam::{Mat3, Vec2};
use umber_math::{DVec3, Point3, Rgb, Vector3};
use umber_sampling::warp;

use super::LightSample;
use super::params::{Emission, LightParams, LightProblem};
use super::portal::Portals;
use crate::environment::{EnvironmentMap, ImagePlace};

/// A light that surrounds the scene. `normalize` has no effect on it.
///
/// The map is placed as UsdLuxDomeLight says, by OpenEXR's definition: in light space +Y is up, the middle of
/// the image looks along +Z, a quarter from its left edge along +X, its left and right edges along −Z, and a
/// quarter from its right edge along −X. Of the transform only the rotation counts (and a mirroring): scale and
/// shear are taken off, as directions have no size.
#[derive(Clone, Debug)]
pub struct DomeLight {
    pub(crate) emission: Emission,
    texture: Option<Arc<EnvironmentMap>>,
    /// Orthogonal.
    render_from_light: Mat3,
    /// Openings that guide sampling.
    pub(super) portals: Option<Box<Portals>>,
}

impl DomeLight {
    pub(crate) fn new(
        p: &LightParams,
        texture: Option<Arc<EnvironmentMap>>,
        problems: &mut Vec<LightProblem>,
    ) -> Result<Self, LightProblem> {
        let m = p.render_from_light.matrix3;
        // Gram-Schmidt, up first: the horizon stays level under a shear.
        let y = m.y_axis.normalize_or_zero();
        let z = (m.z_axis - y * m.z_axis.dot(y)).normalize_or_zero();
        let x = y.cross(z) * if m.determinant() < 0.0 { -1.0 } else { 1.0 };
        if y == DVec3::ZERO || z == DVec3::ZERO || m.determinant() == 0.0 {
            return Err(LightProblem::SingularTransform);
        }
        let render_from_light = Mat3::from_cols(x.as_vec3(), y.as_vec3(), z.as_vec3());
        Ok(Self { emission: Emission::new(p, 1.0, 1.0, problems), texture, render_from_light, portals: None })
    }
    #[inline]
    pub(crate) fn sample(&self, p: Point3, u: Vec2) -> Option<LightSample> {
        match &self.portals {
            None => self.sample_all(u),
            Some(portals) => portals.sample(self, p, u),
        }
    }
    /// As if there were no portals.
    #[inline]
    pub(super) fn sample_all(&self, u: Vec2) -> Option<LightSample> {
        let (wi_light, texel, pdf_solid_angle) = match &self.texture {
            Some(map) => map.sample(u),
            None => (warp::uniform_sphere(u), Rgb::WHITE, warp::UNIFORM_SPHERE_PDF_SOLID_ANGLE),
        };
        let wi = Vector3(self.render_from_light * wi_light.0).normalized();
        let radiance = self.emission.radiance * texel;
        let distance = f32::INFINITY;
        (pdf_solid_angle > 0.0).then_some(LightSample { wi, radiance, pdf_solid_angle, distance, is_delta: false })
    }
    #[inline]
    pub(crate) fn pdf_solid_angle(&self, p: Point3, wi: Vector3) -> f32 {
        self.pdf_at(p, wi, self.place_of(wi))
    }
    /// The same of a direction whose place in the map is known.
    #[inline]
    pub(super) fn pdf_at(&self, p: Point3, wi: Vector3, place: ImagePlace) -> f32 {
        let pdf_all = self.pdf_all_at(place);
        match &self.portals {
            None => pdf_all,
            Some(portals) => portals.pdf_solid_angle(pdf_all, p, wi),
        }
    }
    /// As if there were no portals.
    #[inline]
    pub(super) fn pdf_all_at(&self, place: ImagePlace) -> f32 {
        match &self.texture {
            Some(map) => map.pdf_at(place),
            None => warp::UNIFORM_SPHERE_PDF_SOLID_ANGLE,
        }
    }
    /// Where the map, if there is one, shows a direction.
    #[inline]
    pub(super) fn place_of(&self, wi: Vector3) -> ImagePlace {
        match &self.texture {
            Some(map) => map.place_of(Vector3(self.render_from_light.transpose() * wi.0)),
            None => ImagePlace::default(),
        }
    }
    #[inline]
    pub(super) fn radiance_at(&self, place: ImagePlace) -> Rgb {
        match &self.texture {
            Some(map) => self.emission.radiance * map.radiance_at(place),
            None => self.emission.radiance,
        }
    }
    pub(super) fn has_texture(&self) -> bool {
        self.texture.is_some()
    }
    /// Mean radiance over all directions.
    pub(crate) fn mean_radiance(&self) -> Rgb {
        self.emission.radiance * self.texture.as_ref().map_or(Rgb::WHITE, |t| t.mean_radiance())
    }
}
