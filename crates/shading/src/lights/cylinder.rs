//! Cylinder light, and the line light that `treatAsLine` makes of it.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec2, DVec3, Vec2};
use umber_math::{Bounds3, Frame, Normal3, Point3, Ray, Rgb, Vector3};

use super::params::{BRIGHTEST, Emission, LightParams, LightProblem};
use super::{LightHit, LightSample};

/// A cylinder along X that emits outwards from its side; its ends and its inside are black.
///
/// Any transform is taken as it is: the cylinder may be elliptic and its ends oblique. It is sampled in a space where
/// it is round, there nearly uniformly in solid angle: exactly so around the axis, and along it for each such angle.
/// As a line, it shines from its axis as the cylinder does from afar, in the mean over the directions around it.
#[derive(Clone, Debug)]
pub struct CylinderLight {
    /// For a line, `radiance` is the radiant intensity per length, square to it.
    pub(crate) emission: Emission,
    center: DVec3,
    /// From a space where the cylinder is round and lies along X; its columns are about unit.
    render_from_round: DMat3,
    round_from_render: DMat3,
    /// How much `round_from_render` changes volumes.
    volume_ratio: f64,
    half_length: f64,
    /// In the round space; zero for a line.
    radius: f64,
    bounds: Bounds3,
    /// π² × intensity per length × length of a line, π A L of a cylinder.
    power: Rgb,
}

/// A point's surroundings in the round space, seen across the axis.
struct Across {
    /// From the axis.
    distance: f64,
    /// Unit, from the point to the axis, and square to that; components along Y and Z.
    inward: DVec2,
    /// The ends along X, seen from the point.
    ends: [f64; 2],
}

/// The stretch of a line at a distance, between two ends along it: elevations above the perpendicular.
struct Stretch {
    distance: f64,
    ends: [f64; 2],
    /// Difference of the sines of the elevations of the ends.
    sines: f64,
}

impl Stretch {
    #[inline]
    fn new(distance: f64, ends: [f64; 2]) -> Self {
        let [s0, s1] = ends.map(|x| x / x.hypot(distance));
        let sines = if ends[0] * ends[1] > 0.0 {
            // On one side both are near one: by the difference of their squares.
            let [r0, r1] = ends.map(|x| x * x + distance * distance);
            distance / r0 * (distance / r1) * (ends[1] - ends[0]) * (ends[1] + ends[0]) / (s0 + s1)
        } else {
            s1 - s0
        };
        Self { distance, ends, sines }
    }
    /// A place along the line, uniform in the sine of its elevation.
    #[inline]
    fn sample(&self, u: f64) -> f64 {
        // Counted from the end nearer to the perpendicular, on the positive side.
        let is_negative = self.ends[0] + self.ends[1] < 0.0;
        let start = if is_negative { -self.ends[1] } else { self.ends[0] };
        let (hypotenuse, u) = (start.hypot(self.distance), if is_negative { 1.0 - u } else { u });
        let sine = start / hypotenuse;
        // 1 − sine, without cancellation.
        let rest = if start > 0.0 {
            (self.distance / hypotenuse).powi(2) / (1.0 + sine) - u * self.sines
        } else {
            1.0 - sine - u * self.sines
        };
        let x = self.distance * (1.0 - rest) / (rest * (2.0 - rest)).max(f64::MIN_POSITIVE).sqrt();
        (if is_negative { -x } else { x }).clamp(self.ends[0], self.ends[1])
    }
}

impl CylinderLight {
    pub(crate) fn new(
        p: &LightParams,
        length: f32,
        radius: f32,
        treat_as_line: bool,
        problems: &mut Vec<LightProblem>,
    ) -> Result<Self, LightProblem> {
        let m = p.render_from_light.matrix3;
        let center = p.render_from_light.translation;
        let stretch = m.x_axis.length();
        if stretch == 0.0 || !center.is_finite() || !m.is_finite() {
            return Err(LightProblem::SingularTransform);
        }
        let (length, radius) = (f64::from(length), f64::from(radius));
        let half_length = length * stretch * 0.5;
        if half_length.is_nan() || half_length <= 0.0 || !(half_length as f32).is_normal() {
            return Err(LightProblem::NoArea);
        }
        let area = length * radius * girth(m);
        let along = m.x_axis / stretch;
        let lit = if treat_as_line {
            // Normalised, the radius cancels and may be zero.
            let per_radiance = if p.normalize { 1.0 } else { area } / (PI * 2.0 * half_length);
            if !per_radiance.is_finite() || per_radiance <= 0.0 {
                return Err(LightProblem::NoArea);
            }
            let frame = Frame::from_normal(Normal3(along.as_vec3()));
            let y = frame.tangent.0.as_dvec3();
            let y = (y - along * y.dot(along)).normalize();
            let emission = Emission::new(p, 1.0, per_radiance, problems);
            (emission, DMat3::from_cols(along, y, along.cross(y)), 0.0, PI * PI * 2.0 * half_length)
        } else {
            let scale = (m.y_axis.length() * m.z_axis.length()).sqrt();
            if scale == 0.0 || m.determinant() == 0.0 {
                return Err(LightProblem::SingularTransform);
            }
            let radius = radius * scale;
            let is_normal = |v: f64| (v as f32).is_normal();
            if radius.is_nan() || radius <= 0.0 || !(is_normal(area) && is_normal(radius * radius)) {
                return Err(LightProblem::NoArea);
            }
            let round = DMat3::from_cols(along, m.y_axis / scale, m.z_axis / scale);
            (Emission::new(p, area, 1.0, problems), round, radius, PI * area)
        };
        let (emission, render_from_round, round_radius, flux) = lit;
        let round_from_render = render_from_round.inverse();
        let volume_ratio = round_from_render.determinant().abs();
        if !(round_from_render.is_finite() && volume_ratio > 0.0 && volume_ratio.is_finite()) {
            return Err(LightProblem::SingularTransform);
        }
        let [y, z] = [render_from_round.y_axis, render_from_round.z_axis].map(|axis| axis * round_radius);
        let reach = along.abs() * half_length + DVec3::from((y * y + z * z).to_array().map(f64::sqrt));
        let bounds = Bounds3::of_points([center - reach, center + reach].map(|c| Point3(c.as_vec3())));
        let power = emission.radiance * flux as f32;
        let radius = round_radius;
        Ok(Self {
            emission,
            center,
            render_from_round,
            round_from_render,
            volume_ratio,
            half_length,
            radius,
            bounds,
            power,
        })
    }
    /// `None` from the axis, and from within the cylinder or what continues it beyond its ends.
    #[inline]
    fn across(&self, p: DVec3) -> Option<Across> {
        let at = self.round_from_render * (p - self.center);
        let beside = DVec2::new(at.y, at.z);
        let distance = beside.length();
        let ends = [-self.half_length - at.x, self.half_length - at.x];
        let is_outside = distance > self.radius && distance.is_finite() && ends[0].is_finite();
        is_outside.then(|| Across { distance, inward: -beside / distance, ends })
    }
    /// From the point to the side, across the axis, under an angle from the direction to the axis.
    #[inline]
    fn distance_to_side(&self, across: &Across, sin: f64, cos: f64) -> f64 {
        let (d, r) = (across.distance, self.radius);
        (d - r) * (d + r) / (d * cos + (r * r - d * d * sin * sin).max(0.0).sqrt())
    }
    #[inline]
    pub(crate) fn sample(&self, p: Point3, u: Vec2) -> Option<LightSample> {
        let across = self.across(p.0.as_dvec3())?;
        if self.radius == 0.0 {
            return self.sample_line(&across, f64::from(u.y));
        }
        let widest = (self.radius / across.distance).asin();
        let (sin, cos) = ((2.0 * f64::from(u.x) - 1.0) * widest).sin_cos();
        let stretch = Stretch::new(self.distance_to_side(&across, sin, cos), across.ends);
        let side = (across.inward * cos + across.inward.perp() * sin) * stretch.distance;
        let to_light_round = DVec3::new(stretch.sample(f64::from(u.y)), side.x, side.y);
        let to_light = self.render_from_round * to_light_round;
        let distance = to_light.length();
        let turned = (distance / to_light_round.length()).powi(3) * self.volume_ratio;
        let density = turned / (2.0 * widest * stretch.sines);
        LightSample::of_point(to_light, distance, density, self.emission.radiance)
    }
    /// A point of the line, in proportion to the irradiance that it gives a surface facing it: all give the same.
    fn sample_line(&self, across: &Across, u: f64) -> Option<LightSample> {
        let stretch = Stretch::new(across.distance, across.ends);
        let side = across.inward * across.distance;
        let to_light = self.render_from_round * DVec3::new(stretch.sample(u), side.x, side.y);
        let distance = to_light.length();
        let per_intensity = (stretch.sines / across.distance) as f32;
        // A point on the line itself would receive infinitely much.
        let irradiance = Rgb((self.emission.radiance * per_intensity).0.min(glam::Vec3::splat(BRIGHTEST as f32)));
        let sample = LightSample {
            wi: Vector3((to_light / distance).as_vec3()),
            radiance: irradiance,
            pdf_solid_angle: 1.0,
            distance: distance as f32,
            is_delta: true,
        };
        (distance > 0.0 && sample.distance.is_finite() && per_intensity > 0.0 && irradiance.is_finite())
            .then_some(sample)
    }
    #[inline]
    pub(crate) fn pdf_solid_angle(&self, p: Point3, wi: Vector3) -> f32 {
        if self.radius == 0.0 {
            return 0.0;
        }
        let Some(across) = self.across(p.0.as_dvec3()) else { return 0.0 };
        let w = self.round_from_render * wi.0.as_dvec3();
        let aside = DVec2::new(w.y, w.z);
        let length = aside.length();
        let (sin, cos) = (aside.dot(across.inward.perp()) / length, aside.dot(across.inward) / length);
        let is_met = cos > 0.0 && across.distance * sin.abs() < self.radius;
        if !is_met {
            return 0.0;
        }
        let stretch = Stretch::new(self.distance_to_side(&across, sin, cos), across.ends);
        let x = stretch.distance * w.x / length;
        if !(across.ends[0]..=across.ends[1]).contains(&x) {
            return 0.0;
        }
        let widest = (self.radius / across.distance).asin();
        let turned = w.length().powi(-3) * self.volume_ratio;
        let pdf = (turned / (2.0 * widest * stretch.sines)) as f32;
        if pdf.is_finite() { pdf } else { 0.0 }
    }
    /// The nearest hit with the closed cylinder; only the outside of its side emits.
    #[inline]
    pub(crate) fn intersect(&self, ray: &Ray) -> Option<LightHit> {
        if self.radius == 0.0 {
            return None;
        }
        let o = self.round_from_render * (ray.origin.0.as_dvec3() - self.center);
        let d = self.round_from_render * ray.direction.0.as_dvec3();
        let (beside, aside) = (DVec2::new(o.y, o.z), DVec2::new(d.y, d.z));
        let a = aside.length_squared();
        let discriminant = self.radius * self.radius * a - beside.perp_dot(aside).powi(2);
        let through_side = if a == 0.0 && beside.length() <= self.radius {
            [f64::NEG_INFINITY, f64::INFINITY]
        } else if a > 0.0 && discriminant >= 0.0 {
            let (middle, half) = (-beside.dot(aside) / a, discriminant.sqrt() / a);
            [middle - half, middle + half]
        } else {
            return None;
        };
        let ends = [(-self.half_length - o.x) / d.x, (self.half_length - o.x) / d.x];
        let through_ends = match d.x != 0.0 {
            true => [ends[0].min(ends[1]), ends[0].max(ends[1])],
            false if o.x.abs() <= self.half_length => [f64::NEG_INFINITY, f64::INFINITY],
            false => return None,
        };
        let enters = through_side[0].max(through_ends[0]);
        let leaves = through_side[1].min(through_ends[1]);
        let within = |t: f64| (t as f32) > ray.t_min && (t as f32) < ray.t_max;
        if enters > leaves || enters.is_nan() || leaves.is_nan() {
            return None;
        }
        if within(enters) {
            let is_front = through_side[0] >= through_ends[0];
            let radiance = if is_front { self.emission.radiance } else { Rgb::BLACK };
            return Some(LightHit { t: enters as f32, radiance, is_front });
        }
        within(leaves).then_some(LightHit { t: leaves as f32, radiance: Rgb::BLACK, is_front: false })
    }
    pub(crate) fn bounds(&self) -> Bounds3 {
        self.bounds
    }
    /// Radiant flux.
    pub(crate) fn power(&self) -> Rgb {
        self.power
    }
    pub(crate) fn is_delta(&self) -> bool {
        self.radius == 0.0
    }
}

/// Area of the side of a cylinder of unit length and radius along X after a transform.
fn girth(m: DMat3) -> f64 {
    // The trapezoidal rule, which is nearly exact for a smooth periodic function.
    const STEPS: u32 = 2048;
    let [y, z] = [m.x_axis.cross(m.y_axis), m.x_axis.cross(m.z_axis)];
    let step = |i: u32| {
        let (sin, cos) = (TAU * f64::from(i) / f64::from(STEPS)).sin_cos();
        (z * cos - y * sin).length()
    };
    (0..STEPS).map(step).sum::<f64>() * TAU / f64::from(STEPS)
}
