//! What a host says of a light, and its emission by UsdLux's rules.

use std::f64::consts::PI;
use std::sync::Arc;

use umber_math::blackbody::blackbody_rgb;
use umber_math::{DAffine3, DVec3, Rgb};

use super::shadow::{ShadowParams, ShadowShape};
use super::shaping::{Shaping, ShapingParams};
use super::{EmitterMesh, LightTexture};
use crate::EnvironmentMap;

/// Radiance (irradiance, intensity) above this is cut: products with it stay finite in single precision.
pub(crate) const BRIGHTEST: f64 = 1e30;

/// The shape of a light, in light space.
#[derive(Clone, Debug)]
pub enum LightKind {
    /// Shines along −Z from infinitely far.
    Distant {
        /// Angular diameter in degrees; 0 for parallel light.
        angle_deg: f32,
    },
    /// Surrounds the scene.
    Dome {
        /// Map that multiplies the colour.
        texture: Option<Arc<EnvironmentMap>>,
    },
    /// A rectangle in the XY plane around the origin that emits along −Z.
    Rect {
        /// Size along X.
        width: f32,
        /// Size along Y.
        height: f32,
    },
    /// A sphere around the origin that emits outwards.
    Sphere {
        /// Its radius.
        radius: f32,
        /// Shines like the sphere from afar, but from one point: no size, no soft shadow, not visible.
        treat_as_point: bool,
    },
    /// A disk in the XY plane around the origin that emits along −Z.
    Disk {
        /// Its radius.
        radius: f32,
    },
    /// A cylinder around the origin, along X, whose side emits outwards.
    Cylinder {
        /// Along X.
        length: f32,
        /// Its radius.
        radius: f32,
        /// Shines like the cylinder from afar, but from its axis: no width, not visible.
        treat_as_line: bool,
    },
    /// Triangles of a mesh; light space is the mesh's.
    Mesh {
        /// Those that emit.
        mesh: Arc<EmitterMesh>,
        /// How far rounding moves the triangles for rays, render-space units.
        clearance: f32,
    },
}

/// Everything a light is made from. Attribute meanings are UsdLux's.
#[derive(Clone, Debug)]
pub struct LightParams {
    /// Shape.
    pub kind: LightKind,
    /// Picture on a rect light; others have none.
    pub texture: Option<Arc<LightTexture>>,
    /// From light space to render space (world space moved, not turned or scaled).
    pub render_from_light: DAffine3,
    /// Colour, scene-linear.
    pub color: Rgb,
    /// Linear brightness.
    pub intensity: f32,
    /// Brightness in stops.
    pub exposure: f32,
    /// Divides by the size of the light.
    pub normalize: bool,
    /// Kelvin, where enabled.
    pub color_temperature: Option<f32>,
    /// Multiplier of the effect on diffuse lobes.
    pub diffuse: f32,
    /// Multiplier of the effect on glossy and mirror lobes.
    pub specular: f32,
    /// Whether the light casts shadows.
    pub shadow_enable: bool,
    /// Whether some things alone may cast shadows in its light.
    pub shadow_linked: bool,
    /// Whether the camera sees the light itself.
    pub camera_visible: bool,
    /// What its emission is multiplied by, by direction.
    pub shaping: ShapingParams,
    /// What its shadows are like.
    pub shadow: ShadowParams,
}

impl LightParams {
    /// A light of a shape with UsdLux's defaults, at the origin.
    pub fn new(kind: LightKind) -> Self {
        Self {
            kind,
            texture: None,
            render_from_light: DAffine3::IDENTITY,
            color: Rgb::WHITE,
            intensity: 1.0,
            exposure: 0.0,
            normalize: false,
            color_temperature: None,
            diffuse: 1.0,
            specular: 1.0,
            shadow_enable: true,
            shadow_linked: false,
            camera_visible: true,
            shaping: ShapingParams::default(),
            shadow: ShadowParams::default(),
        }
    }
}

/// What is wrong with a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LightProblem {
    /// A quantity is negative; it counts as zero.
    #[error("{0} is negative; it counts as zero")]
    Negative(&'static str),
    /// A quantity is NaN or infinite; it counts as zero.
    #[error("{0} is not a finite number; it counts as zero")]
    NotFinite(&'static str),
    /// A quantity is NaN or infinite; its default stands in.
    #[error("{0} is not a finite number; it is ignored")]
    Ignored(&'static str),
    /// A distant, dome or mesh light with shaping, which lights with a place and a shape of their own alone have.
    #[error("shaping has no effect on distant, dome and mesh lights")]
    NotShaped,
    /// The light is brighter than can be rendered; it is dimmed to a radiance of 10³⁰.
    #[error("the light is brighter than can be rendered; its radiance is cut to 1e30")]
    TooBright,
    /// The transform collapses space or is not finite; the light emits nothing.
    #[error("the transform is singular or not finite; the light emits nothing")]
    SingularTransform,
    /// The shape has no area; the light emits nothing.
    #[error("the light's shape has no area; it emits nothing")]
    NoArea,
}

/// What all lights have.
#[derive(Clone, Debug)]
pub(crate) struct Emission {
    /// Radiance, before a texture; irradiance or intensity of lights without size.
    pub radiance: Rgb,
    pub diffuse: f32,
    pub specular: f32,
    pub shadow_enable: bool,
    pub shadow_linked: bool,
    pub camera_visible: bool,
    pub shaping: Option<Box<Shaping>>,
    pub shadow: Option<ShadowShape>,
}

impl Emission {
    /// `intensity · 2^exposure · color · temperature colour / size_factor · scale`, cut to what is finite.
    pub fn new(p: &LightParams, size_factor: f64, scale: f64, problems: &mut Vec<LightProblem>) -> Self {
        let mut usable = |v: f32, name: &'static str| {
            if !v.is_finite() {
                problems.push(LightProblem::NotFinite(name));
                0.0
            } else if v < 0.0 {
                problems.push(LightProblem::Negative(name));
                0.0
            } else {
                v
            }
        };
        let intensity = f64::from(usable(p.intensity, "intensity"));
        let [r, g, b] = p.color.0.to_array().map(|c| f64::from(usable(c, "color")));
        let (diffuse, specular) = (usable(p.diffuse, "diffuse"), usable(p.specular, "specular"));
        // Exposure may be negative; not finite it counts as zero stops.
        let exposure = usable(p.exposure.abs(), "exposure").copysign(p.exposure);
        let tint = p.color_temperature.map_or(Rgb::WHITE, blackbody_rgb);
        let power = intensity * f64::from(exposure).exp2() * scale / if p.normalize { size_factor } else { 1.0 };
        let exact = DVec3::new(r, g, b) * tint.0.as_dvec3() * if intensity > 0.0 { power } else { 0.0 };
        // A NaN could only come of zero times infinity.
        let radiance = DVec3::from(exact.to_array().map(|v| if v.is_nan() { 0.0 } else { v.min(BRIGHTEST) }));
        if exact.max_element() > BRIGHTEST {
            problems.push(LightProblem::TooBright);
        }
        problems.dedup();
        let radiance = Rgb(radiance.as_vec3());
        let (shadow_enable, shadow_linked, camera_visible) = (p.shadow_enable, p.shadow_linked, p.camera_visible);
        let shadow = ShadowShape::new(&p.shadow, problems).filter(|_| shadow_enable);
        let shaping = Shaping::new(p, problems);
        Self { radiance, diffuse, specular, shadow_enable, shadow_linked, camera_visible, shaping, shadow }
    }
}

/// UsdLux's size factor of a distant light of half angle θ: π sin² θ, and 2 π − that beyond a right angle.
pub(crate) fn distant_size_factor(half_angle: f64) -> f64 {
    let sin_squared = half_angle.sin().powi(2);
    if half_angle <= 0.0 {
        1.0
    } else if half_angle <= PI * 0.5 {
        sin_squared * PI
    } else {
        (2.0 - sin_squared) * PI
    }
}
