//! Shaping of a light's emission by direction: focus, cone and IES profile (`UsdLuxShapingAPI`, OpenUSD 25.08).

use std::f32::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

use glam::{Mat3, Vec3};
use umber_math::{DMat3, DVec3, Rgb, Vector3};

use super::params::{BRIGHTEST, LightKind, LightParams, LightProblem};
use crate::IesProfile;

/// An IES profile on a light.
#[derive(Clone, Debug)]
pub struct IesParams {
    /// The profile.
    pub profile: Arc<IesProfile>,
    /// `inputs:shaping:ies:angleScale`.
    pub angle_scale: f32,
    /// `inputs:shaping:ies:normalize`.
    pub normalize: bool,
}

/// What a host says of a light's shaping; the default shapes nothing.
#[derive(Clone, Debug)]
pub struct ShapingParams {
    /// `inputs:shaping:focus`.
    pub focus: f32,
    /// `inputs:shaping:focusTint`, scene-linear.
    pub focus_tint: Rgb,
    /// `inputs:shaping:cone:angle`, degrees off the axis; from 180 on there is no cone.
    pub cone_angle_deg: f32,
    /// `inputs:shaping:cone:softness`.
    pub cone_softness: f32,
    /// `inputs:shaping:ies:file` and what goes with it.
    pub ies: Option<IesParams>,
}

impl Default for ShapingParams {
    fn default() -> Self {
        Self { focus: 0.0, focus_tint: Rgb::BLACK, cone_angle_deg: 180.0, cone_softness: 0.0, ies: None }
    }
}

/// The angle off the axis (radians) from which the light fades, and the one where it ends.
#[derive(Clone, Copy, Debug)]
struct SpotCone {
    fade: f32,
    end: f32,
}

/// A profile, with its candela's factor.
#[derive(Clone, Debug)]
struct Ies {
    profile: Arc<IesProfile>,
    angle_scale: f32,
    factor: f32,
}

/// A factor on a light's emission, by direction.
///
/// Directions are those of light space without its scale and shear, so that a cone's angle is the angle that one
/// sees. The axis is −Z, and the angle off it is the profile's vertical angle. Its horizontal angle 0 is −X, 90°
/// is −Y: with −Z downwards it runs anticlockwise as seen from above, as LM-63 has it.
#[derive(Clone, Debug)]
pub(crate) struct Shaping {
    /// Orthogonal.
    light_from_render: Mat3,
    cone: Option<SpotCone>,
    /// 0 for none.
    focus: f32,
    focus_tint: Rgb,
    ies: Option<Ies>,
    /// Angles off the axis, radians, outside which nothing is emitted.
    support: [f32; 2],
    /// Flux over what it would be without shaping.
    power_share: f32,
}

impl Shaping {
    /// `None` where nothing is shaped: nothing is asked for, or the light has no place.
    pub fn new(p: &LightParams, problems: &mut Vec<LightProblem>) -> Option<Box<Self>> {
        let cleaned = cleaned(&p.shaping, problems);
        let cone = (cleaned.cone_angle_deg < 180.0).then(|| {
            let end = cleaned.cone_angle_deg.to_radians();
            SpotCone { fade: end * (1.0 - cleaned.cone_softness.clamp(0.0, 1.0)), end }
        });
        let focus_tint = cleaned.focus_tint;
        let focus = if focus_tint == Rgb::WHITE { 0.0 } else { cleaned.focus };
        if cone.is_none() && focus == 0.0 && cleaned.ies.is_none() {
            return None;
        }
        if matches!(p.kind, LightKind::Distant { .. } | LightKind::Dome { .. } | LightKind::Mesh { .. }) {
            problems.push(LightProblem::NotShaped);
            return None;
        }
        let ies = cleaned.ies.map(|IesParams { profile, angle_scale, normalize }| {
            let mean = profile.mean();
            let factor = if normalize && mean > 0.0 { 1.0 / mean } else { 1.0 };
            Ies { profile, angle_scale, factor: if factor.is_finite() { factor } else { 0.0 } }
        });
        let light_from_render = rotation(p.render_from_light.matrix3).transpose();
        let support = support(cone, ies.as_ref());
        let mut shaping = Self { light_from_render, cone, focus, focus_tint, ies, support, power_share: 0.0 };
        shaping.power_share = shaping.share(is_flat(&p.kind));
        Some(Box::new(shaping))
    }
    /// Radiance (irradiance, intensity) that leaves in a direction, render space, unit.
    #[inline]
    pub fn shape(&self, radiance: Rgb, emitted: Vector3) -> Rgb {
        let shaped = radiance * self.factor(self.light_from_render * -emitted.0);
        Rgb(shaped.0.min(Vec3::splat(BRIGHTEST as f32)))
    }
    /// The factor, by the direction in light space towards the light, unit: its polar angle is that off the axis.
    #[inline]
    fn factor(&self, w: Vec3) -> Rgb {
        let off_axis = w.x.hypot(w.y).atan2(w.z);
        let mut factor = Rgb::WHITE;
        if let Some(cone) = self.cone {
            if off_axis > cone.end || off_axis.is_nan() {
                return Rgb::BLACK;
            }
            if off_axis > cone.fade {
                let t = (off_axis - cone.fade) / (cone.end - cone.fade);
                factor = Rgb::splat(1.0 - t * t * (3.0 - 2.0 * t));
            }
        }
        if let Some(ies) = &self.ies {
            factor *= ies.sample(off_axis, w);
        }
        if self.focus > 0.0 {
            factor *= self.focus_tint.lerp(Rgb::WHITE, w.z.abs().min(1.0).powf(self.focus));
        }
        if factor.is_finite() { factor } else { Rgb::BLACK }
    }
    /// Flux over that of the unshaped light, an estimate. Zero only where nothing is emitted.
    pub fn power_share(&self) -> f32 {
        self.power_share
    }
    /// Whether no direction gets any light.
    pub fn is_black(&self) -> bool {
        self.power_share == 0.0
    }
    /// The mean factor over the emission of a flat light (by the cosine, one side) or a round one (all around).
    fn share(&self, flat: bool) -> f32 {
        let [low, high] = if flat { self.support.map(|a| a.min(FRAC_PI_2)) } else { self.support };
        let is_dark = self.ies.as_ref().is_some_and(|i| i.profile.is_black() || i.factor == 0.0);
        if is_dark || low >= high {
            return 0.0;
        }
        // Both ends of the range are looked at closely: there narrow beams are.
        let half = f64::from(high - low) * 0.5;
        let mut sum = 0.0;
        for i in 0..SHARE_STEPS {
            let (from, to) = [i, i + 1].map(|i| half * (f64::from(i) / f64::from(SHARE_STEPS)).powi(3)).into();
            let within = (from + to) * 0.5;
            for angle in [f64::from(low) + within, f64::from(high) - within] {
                let area = if flat { 2.0 * angle.cos() } else { 0.5 };
                sum += f64::from(self.mean_around(angle as f32)) * angle.sin() * area * (to - from);
            }
        }
        (sum as f32).clamp(f32::MIN_POSITIVE, BRIGHTEST as f32)
    }
    /// Luminance of the factor at an angle off the axis, averaged around it.
    fn mean_around(&self, off_axis: f32) -> f32 {
        let count = if self.ies.as_ref().is_some_and(|i| !i.profile.is_axial()) { AROUND } else { 1 };
        let (sin, cos) = off_axis.sin_cos();
        let at = |i: u32| {
            let around = (i as f32 + 0.5) / count as f32 * TAU;
            self.factor(Vec3::new(sin * around.cos(), sin * around.sin(), cos)).luminance()
        };
        (0..count).map(at).sum::<f32>() / count as f32
    }
    /// Its beam, for choosing among lights.
    pub fn beam(&self) -> Beam {
        let [low, mut high] = self.support;
        let end = high;
        if self.focus > 0.0 && self.focus_tint.is_black() && end <= FRAC_PI_2 {
            // Beyond this the focus leaves hardly anything; behind the light it would leave as much as before it.
            high = high.min((1e-6f32.ln() / self.focus).exp().acos().max(low + 1e-3));
        }
        let width = (high - low) / CELLS as f32;
        let mut cells = [0f32; CELLS];
        for (i, cell) in cells.iter_mut().enumerate() {
            let within = |k: u32| low + (i as f32 + (k as f32 + 0.5) / 3.0) * width;
            *cell = (0..3).map(|k| self.mean_around(within(k))).fold(0.0, f32::max);
        }
        let peak = cells.iter().copied().fold(0.0, f32::max).max(f32::MIN_POSITIVE);
        let axis = self.light_from_render.transpose() * Vec3::NEG_Z;
        Beam { axis, low, end, cells_per_radian: 1.0 / width, cells: cells.map(|c| (c / peak).max(FLOOR)), peak }
    }
}

/// Steps of each half of the integral over the angle off the axis.
const SHARE_STEPS: u32 = 128;
/// Directions around the axis that stand for all.
const AROUND: u32 = 16;
/// Cells of a beam.
const CELLS: usize = 32;
/// Least brightness of a beam where it may shine at all, relative to its peak.
const FLOOR: f32 = 1e-5;

impl Ies {
    #[inline]
    fn sample(&self, off_axis: f32, w: Vec3) -> f32 {
        let vertical = vertical_angle(off_axis, self.angle_scale);
        let around = if self.profile.is_axial() { 0.0 } else { w.y.atan2(w.x) };
        self.profile.intensity(vertical, around) * self.factor
    }
}

/// `applyAngleScale` of UsdLux: the profile's vertical angle at an angle off the light's axis, radians.
///
/// A negative scale is about π, as the schema's text says; its formula leaves the shift back by π out.
#[inline]
fn vertical_angle(off_axis: f32, angle_scale: f32) -> f32 {
    if angle_scale > 0.0 {
        off_axis / angle_scale
    } else if angle_scale < 0.0 {
        PI - (PI - off_axis) / -angle_scale
    } else {
        off_axis
    }
}

/// The inverse of [`vertical_angle`].
fn off_axis_angle(vertical: f32, angle_scale: f32) -> f32 {
    if angle_scale > 0.0 {
        vertical * angle_scale
    } else if angle_scale < 0.0 {
        PI - (PI - vertical) * -angle_scale
    } else {
        vertical
    }
}

fn support(cone: Option<SpotCone>, ies: Option<&Ies>) -> [f32; 2] {
    let end = cone.map_or(PI, |c| c.end);
    let Some(ies) = ies else { return [0.0, end] };
    let (first, last) = ies.profile.vertical_range();
    let [low, high] = [first, last].map(|v| off_axis_angle(v, ies.angle_scale));
    // A hair more, as the profile is read a hair beyond its ends.
    [(low - 1e-4).clamp(0.0, end), (high + 1e-4).clamp(0.0, end)]
}

/// Whether the light's shape is flat, so that it shines to one side, by the cosine.
fn is_flat(kind: &LightKind) -> bool {
    matches!(kind, LightKind::Rect { .. } | LightKind::Disk { .. })
}

/// What remains when what is no number is left out.
fn cleaned(p: &ShapingParams, problems: &mut Vec<LightProblem>) -> ShapingParams {
    let default = ShapingParams::default();
    let mut usable = |v: f32, name: &'static str, otherwise: f32| {
        if !v.is_finite() {
            problems.push(LightProblem::Ignored(name));
            return otherwise;
        }
        v
    };
    let mut focus = usable(p.focus, "shaping:focus", default.focus);
    let tint = p.focus_tint.0.to_array().map(|c| usable(c, "shaping:focusTint", 0.0));
    let mut cone_angle_deg = usable(p.cone_angle_deg, "shaping:cone:angle", default.cone_angle_deg);
    let cone_softness = usable(p.cone_softness, "shaping:cone:softness", default.cone_softness);
    let ies = p
        .ies
        .as_ref()
        .map(|ies| IesParams { angle_scale: usable(ies.angle_scale, "shaping:ies:angleScale", 0.0), ..ies.clone() });
    let mut positive = |v: &mut f32, name: &'static str| {
        if *v < 0.0 {
            *v = 0.0;
            problems.push(LightProblem::Negative(name));
        }
    };
    positive(&mut focus, "shaping:focus");
    positive(&mut cone_angle_deg, "shaping:cone:angle");
    let mut focus_tint = tint;
    focus_tint.iter_mut().for_each(|c| positive(c, "shaping:focusTint"));
    problems.dedup();
    ShapingParams { focus, focus_tint: Rgb::from(focus_tint), cone_angle_deg, cone_softness, ies }
}

/// The rotation (and mirroring) of a matrix, −Z first: the axis stays under a scale and a shear.
fn rotation(m: DMat3) -> Mat3 {
    let mirror = if m.determinant() < 0.0 { -1.0 } else { 1.0 };
    let flat = m.x_axis.cross(m.y_axis);
    let z = m.z_axis.try_normalize().or(flat.try_normalize()).unwrap_or(DVec3::Z);
    let y = (m.y_axis - z * m.y_axis.dot(z)).try_normalize().unwrap_or_else(|| z.any_orthonormal_vector());
    let x = y.cross(z) * mirror;
    Mat3::from_cols(x.as_vec3(), y.as_vec3(), z.as_vec3())
}

/// Where a shaped light shines, for choosing among lights: brightness by the angle off an axis.
#[derive(Clone, Debug)]
pub(crate) struct Beam {
    /// Render space, unit.
    pub axis: Vec3,
    /// The angle off the axis, radians, where the first cell begins.
    low: f32,
    /// The angle beyond which there is nothing.
    pub end: f32,
    cells_per_radian: f32,
    /// Relative to the peak; what is beyond the last cell counts as least.
    cells: [f32; CELLS],
    /// The largest factor.
    pub peak: f32,
}

impl Beam {
    /// How much of the light a point may see, relative to its peak; `radius_squared` is of the light's bounds.
    /// Zero only where none of it arrives.
    #[inline]
    pub fn toward(&self, to_point: Vec3, radius_squared: f32) -> f32 {
        let distance_squared = to_point.length_squared();
        if distance_squared <= radius_squared {
            return 1.0;
        }
        let along = to_point.dot(self.axis);
        let off_axis = to_point.cross(self.axis).length().atan2(along);
        // From the point the light's parts are seen under angles that differ by this much.
        let slack = (radius_squared / distance_squared).sqrt().asin() + 1e-3;
        let (from, to) = (off_axis - slack - self.low, off_axis + slack - self.low);
        if off_axis - slack > self.end || to < 0.0 {
            return 0.0;
        }
        let cell = |angle: f32| (angle * self.cells_per_radian).floor().clamp(-1e4, 1e4) as i32;
        let (from, to) = (cell(from), cell(to));
        let inside = |i: i32| i.clamp(0, CELLS as i32) as usize;
        let sum: f32 = self.cells[inside(from)..inside(to + 1)].iter().sum();
        (sum / (to + 1 - from) as f32).max(FLOOR)
    }
}
