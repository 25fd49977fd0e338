//! Lights, in render space (world space moved: directions agree).
//!
//! Radiometry is UsdLux's (OpenUSD 25.08, `UsdLuxLightAPI`): radiance is intensity · 2^exposure · color, times
//! the colour of the temperature, divided by the size with `normalize`.

mod cluster;
mod cylinder;
mod disk;
mod distant;
mod dome;
mod mesh;
mod params;
mod portal;
mod receiver;
mod rect;
mod select;
mod shadow;
mod shaping;
mod sphere;
mod spherical_rect;
mod texture;
mod tree;
mod triangle;

use std::f32::consts::PI;
use std::sync::Arc;

use glam::{DVec3, Vec2};
use umber_math::{Bounds3, Point3, Ray, Rgb, Vector3};

use crate::environment::ImagePlace;
use cluster::Cone;
pub use cylinder::CylinderLight;
pub use disk::DiskLight;
pub use distant::DistantLight;
pub use dome::DomeLight;
pub use mesh::{EmitterMesh, EmitterTriangle, MeshLight};
use params::Emission;
pub use params::{LightKind, LightParams, LightProblem};
pub use portal::Portal;
pub use receiver::Receiver;
pub use rect::RectLight;
pub use select::LightSampler;
pub use shadow::{ShadowParams, ShadowShape};
pub use shaping::{IesParams, ShapingParams};
pub use sphere::SphereLight;
pub use texture::LightTexture;

/// A direction to a light.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// To the light, render space, unit.
    pub wi: Vector3,
    /// Radiance that arrives if nothing is in between; of a delta light, the irradiance on a surface that faces it.
    pub radiance: Rgb,
    /// Density of the direction; 1 for a delta light.
    pub pdf_solid_angle: f32,
    /// To the sampled point of the light; infinite for distant and dome lights.
    pub distance: f32,
    /// Whether no ray could find the direction by chance.
    pub is_delta: bool,
}

impl LightSample {
    /// Of a point of a light that has a size. `to_light`: from the receiver, of the length `distance`; `density`: of its
    /// direction. `None` where that is too large or too small to be divided by.
    #[inline]
    fn of_point(to_light: DVec3, distance: f64, density: f64, radiance: Rgb) -> Option<Self> {
        let pdf_solid_angle = density as f32;
        let is_usable = distance > 0.0 && pdf_solid_angle.is_normal() && (radiance / pdf_solid_angle).is_finite();
        is_usable.then(|| Self {
            wi: Vector3((to_light / distance).as_vec3()),
            radiance,
            pdf_solid_angle,
            distance: distance as f32,
            is_delta: false,
        })
    }
}

/// A ray's hit with a light's shape.
#[derive(Clone, Copy, Debug)]
pub struct LightHit {
    /// Ray parameter.
    pub t: f32,
    /// Radiance towards the ray's origin; black on a side that does not emit.
    pub radiance: Rgb,
    /// Whether it is a side that emits; also where a texture is black there.
    pub is_front: bool,
}

/// Light that arrives from a distant or dome light.
#[derive(Clone, Copy, Debug)]
pub struct FromInfinity {
    /// Unit, towards the light.
    wi: Vector3,
    /// Radiance.
    pub radiance: Rgb,
    /// Where a dome's map shows it.
    place: ImagePlace,
}

/// A light.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant)] // rectangles are common, and met without a detour
pub enum Light {
    /// From infinitely far, one direction.
    Distant(DistantLight),
    /// From infinitely far, all directions.
    Dome(DomeLight),
    /// A rectangle.
    Rect(RectLight),
    /// A sphere or a point.
    Sphere(SphereLight),
    /// A disk or an ellipse.
    Disk(DiskLight),
    /// A cylinder or a line.
    Cylinder(CylinderLight),
    /// The triangles of a mesh, which rays meet as geometry.
    Mesh(Box<MeshLight>),
}

impl Light {
    /// A light and what of its description had to be mended.
    ///
    /// # Errors
    /// Where the light has no shape left to emit from: a singular transform, no area. Leave it out.
    pub fn new(desc: &LightParams) -> Result<(Self, Vec<LightProblem>), LightProblem> {
        if !desc.render_from_light.is_finite() {
            return Err(LightProblem::SingularTransform);
        }
        let mut problems = Vec::new();
        let light = match &desc.kind {
            LightKind::Distant { angle_deg } => Self::Distant(DistantLight::new(desc, *angle_deg, &mut problems)?),
            LightKind::Dome { texture } => Self::Dome(DomeLight::new(desc, texture.clone(), &mut problems)?),
            LightKind::Rect { width, height } => Self::Rect(RectLight::new(desc, *width, *height, &mut problems)?),
            LightKind::Sphere { radius, treat_as_point } => {
                Self::Sphere(SphereLight::new(desc, *radius, *treat_as_point, &mut problems)?)
            }
            LightKind::Disk { radius } => Self::Disk(DiskLight::new(desc, *radius, &mut problems)?),
            LightKind::Cylinder { length, radius, treat_as_line } => {
                Self::Cylinder(CylinderLight::new(desc, *length, *radius, *treat_as_line, &mut problems)?)
            }
            LightKind::Mesh { mesh, clearance } => {
                Self::Mesh(Box::new(MeshLight::new(desc, Arc::clone(mesh), *clearance, &mut problems)?))
            }
        };
        Ok((light, problems))
    }
    /// A direction from `p` to the light; `None` where none of its light arrives.
    #[inline]
    pub fn sample(&self, p: Point3, u: Vec2) -> Option<LightSample> {
        let mut sample = match self {
            Self::Distant(l) => l.sample(u),
            Self::Dome(l) => l.sample(p, u),
            Self::Rect(l) => l.sample(p, u),
            Self::Sphere(l) => l.sample(p, u),
            Self::Disk(l) => l.sample(p, u),
            Self::Cylinder(l) => l.sample(p, u),
            Self::Mesh(l) => l.sample(&Receiver::all_around(p), u),
        }?;
        if let Some(shaping) = &self.emission().shaping {
            sample.radiance = shaping.shape(sample.radiance, -sample.wi);
        }
        Some(sample)
    }
    /// As [`Light::sample`]; a light of many parts chooses those that shine on the receiver's side.
    #[inline]
    pub fn sample_for(&self, receiver: &Receiver, u: Vec2) -> Option<LightSample> {
        match self {
            Self::Mesh(l) => l.sample(receiver, u),
            _ => self.sample(receiver.point, u),
        }
    }
    /// Density with which [`Light::sample`] makes `wi`, unit; zero for delta lights, and for meshes, whose density is
    /// that of a triangle ([`MeshLight::pdf_solid_angle`]).
    #[inline]
    pub fn pdf_solid_angle(&self, p: Point3, wi: Vector3) -> f32 {
        match self {
            Self::Distant(l) => l.pdf_solid_angle(wi),
            Self::Dome(l) => l.pdf_solid_angle(p, wi),
            Self::Rect(l) => l.pdf_solid_angle(p, wi),
            Self::Sphere(l) => l.pdf_solid_angle(p, wi),
            Self::Disk(l) => l.pdf_solid_angle(p, wi),
            Self::Cylinder(l) => l.pdf_solid_angle(p, wi),
            Self::Mesh(_) => 0.0,
        }
    }
    /// The nearest hit with a light that has a place and a size, and is not geometry itself.
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<LightHit> {
        let mut hit = match self {
            Self::Distant(_) | Self::Dome(_) | Self::Mesh(_) => None,
            Self::Rect(l) => l.intersect(ray),
            Self::Sphere(l) => l.intersect(ray),
            Self::Disk(l) => l.intersect(ray),
            Self::Cylinder(l) => l.intersect(ray),
        }?;
        if let Some(shaping) = &self.emission().shaping {
            hit.radiance = shaping.shape(hit.radiance, -ray.direction.normalized());
            hit.is_front &= !hit.radiance.is_black();
        }
        Some(hit)
    }
    /// What arrives along `wi`, unit, from a distant or dome light; `None` where it sends nothing that way.
    #[inline]
    pub fn from_infinity(&self, wi: Vector3) -> Option<FromInfinity> {
        match self {
            Self::Distant(l) => {
                l.radiance(wi).map(|radiance| FromInfinity { wi, radiance, place: ImagePlace::default() })
            }
            Self::Dome(l) => {
                let place = l.place_of(wi);
                Some(FromInfinity { wi, radiance: l.radiance_at(place), place })
            }
            Self::Rect(_) | Self::Sphere(_) | Self::Disk(_) | Self::Cylinder(_) | Self::Mesh(_) => None,
        }
    }
    /// As [`Light::pdf_solid_angle`], of what this light sends from infinity.
    #[inline]
    pub fn pdf_from_infinity(&self, p: Point3, found: &FromInfinity) -> f32 {
        match self {
            Self::Dome(l) => l.pdf_at(p, found.wi, found.place),
            _ => self.pdf_solid_angle(p, found.wi),
        }
    }
    /// Luminance of the flux that the light sends into a scene of the given radius, an estimate.
    pub fn power_estimate(&self, scene_radius: f32) -> f32 {
        let disk = PI * scene_radius * scene_radius;
        let shaped = self.emission().shaping.as_ref().map_or(1.0, |s| s.power_share());
        let whole = match self {
            Self::Distant(l) => l.irradiance().luminance() * disk,
            Self::Dome(l) => l.mean_radiance().luminance() * 4.0 * PI * disk,
            Self::Rect(l) => l.power().luminance(),
            Self::Sphere(l) => l.power().luminance(),
            Self::Disk(l) => l.power().luminance(),
            Self::Cylinder(l) => l.power().luminance(),
            Self::Mesh(l) => l.power(),
        };
        whole * shaped
    }
    /// The box around a light that has a place.
    pub fn bounds(&self) -> Option<Bounds3> {
        match self {
            Self::Distant(_) | Self::Dome(_) => None,
            Self::Rect(l) => Some(l.bounds()),
            Self::Sphere(l) => Some(l.bounds()),
            Self::Disk(l) => Some(l.bounds()),
            Self::Cylinder(l) => Some(l.bounds()),
            Self::Mesh(l) => Some(l.bounds()),
        }
    }
    /// The directions that it faces, each shining into a cosine lobe; all where it shines all around. Without shaping.
    fn cone(&self) -> Cone {
        match self {
            Self::Rect(l) => Cone::flat(l.facing().0, false),
            Self::Disk(l) => Cone::flat(l.facing().0, false),
            Self::Mesh(l) => l.cone(),
            Self::Distant(_) | Self::Dome(_) | Self::Sphere(_) | Self::Cylinder(_) => Cone::ALL,
        }
    }
    /// The mesh, where it is one.
    #[inline]
    pub fn as_mesh(&self) -> Option<&MeshLight> {
        if let Self::Mesh(light) = self { Some(light) } else { None }
    }
    /// Whether it is infinitely far: met by rays that leave the scene.
    #[inline]
    pub fn is_infinite(&self) -> bool {
        matches!(self, Self::Distant(_) | Self::Dome(_))
    }
    /// Whether it has no size, so that no ray can find it by chance.
    #[inline]
    pub fn is_delta(&self) -> bool {
        match self {
            Self::Distant(l) => l.is_delta(),
            Self::Sphere(l) => l.is_delta(),
            Self::Cylinder(l) => l.is_delta(),
            Self::Dome(_) | Self::Rect(_) | Self::Disk(_) | Self::Mesh(_) => false,
        }
    }
    /// Whether it emits nothing.
    pub fn is_black(&self) -> bool {
        let emission = self.emission();
        emission.radiance.is_black() || emission.shaping.as_ref().is_some_and(|s| s.is_black())
    }
    /// Whether it casts shadows.
    #[inline]
    pub fn shadow_enable(&self) -> bool {
        self.emission().shadow_enable
    }
    /// Its shadows, where they are unlike those of nature.
    #[inline]
    pub fn shadow_shape(&self) -> Option<&ShadowShape> {
        self.emission().shadow.as_ref()
    }
    /// Whether rays that meet it by chance must not count, as they could not tell what light samples see of it.
    #[inline]
    pub fn found_by_samples_alone(&self) -> bool {
        let emission = self.emission();
        !emission.shadow_enable || emission.shadow.is_some()
    }
    /// Whether rays that follow the BSDF find it as well as any sample of it could: all around, and the same
    /// everywhere. Then it is not chosen, and costs no shadow rays.
    pub fn is_left_to_rays(&self) -> bool {
        let is_plain = |dome: &DomeLight| !dome.has_texture() && dome.portals.is_none();
        let odd_shadows = self.emission().shadow_linked || self.found_by_samples_alone();
        matches!(self, Self::Dome(dome) if is_plain(dome) && !odd_shadows)
    }
    /// Whether the camera sees the light itself.
    #[inline]
    pub fn camera_visible(&self) -> bool {
        self.emission().camera_visible
    }
    /// Multiplier of its effect on diffuse lobes.
    #[inline]
    pub fn diffuse(&self) -> f32 {
        self.emission().diffuse
    }
    /// Multiplier of its effect on glossy and mirror lobes.
    #[inline]
    pub fn specular(&self) -> f32 {
        self.emission().specular
    }
    #[inline]
    fn emission(&self) -> &Emission {
        match self {
            Self::Distant(l) => &l.emission,
            Self::Dome(l) => &l.emission,
            Self::Rect(l) => &l.emission,
            Self::Sphere(l) => &l.emission,
            Self::Disk(l) => &l.emission,
            Self::Cylinder(l) => &l.emission,
            Self::Mesh(l) => &l.emission,
        }
    }
}
