//! Shaping of lights by the formulas of UsdLux' ShapingAPI, and what it does to sampling and choosing.

mod formulas;
mod odd_numbers;
mod sampling;

use std::sync::Arc;

use glam::Vec2;
use umber_math::{Point3, Rgb, Vector3};
use umber_shading::{IesParams, IesProfile, Light, LightKind, LightParams, ShapingParams};

const RECT: LightKind = LightKind::Rect { width: 0.5, height: 0.25 };
const BALL: LightKind = LightKind::Sphere { radius: 0.5, treat_as_point: false };
const POINT: LightKind = LightKind::Sphere { radius: 0.5, treat_as_point: true };

fn shaped(kind: LightKind, shaping: ShapingParams) -> LightParams {
    LightParams { shaping, ..LightParams::new(kind) }
}
fn cone(angle: f32, softness: f32) -> ShapingParams {
    ShapingParams { cone_angle_deg: angle, cone_softness: softness, ..ShapingParams::default() }
}
fn light(p: &LightParams) -> Light {
    let (light, problems) = Light::new(p).unwrap();
    assert_eq!(problems, []);
    light
}
fn ies(text: &str, angle_scale: f32, normalize: bool) -> ShapingParams {
    let profile = Arc::new(IesProfile::from_text(text).unwrap());
    ShapingParams { ies: Some(IesParams { profile, angle_scale, normalize }), ..ShapingParams::default() }
}
/// The direction in light space at an angle off the axis −Z and around it; 0 around is −X, 90° −Y.
fn emitted(off_axis_deg: f32, around_deg: f32) -> Vector3 {
    let (sin, cos) = off_axis_deg.to_radians().sin_cos();
    let (y, x) = around_deg.to_radians().sin_cos();
    Vector3::new(-sin * x, -sin * y, -cos)
}
/// What a point light's shaping multiplies its intensity by, by the angles of [`emitted`], degrees.
fn factors(shaping: &ShapingParams) -> impl Fn(f32, f32) -> Rgb + use<> {
    let (with, without) = (light(&shaped(POINT, shaping.clone())), light(&LightParams::new(POINT)));
    move |off_axis_deg, around_deg| {
        let at = Point3::ZERO + emitted(off_axis_deg, around_deg) * 7.0;
        let seen = |l: &Light| l.sample(at, Vec2::splat(0.5)).unwrap().radiance.0;
        Rgb(seen(&with) / seen(&without))
    }
}
fn factor(shaping: &ShapingParams, off_axis_deg: f32, around_deg: f32) -> Rgb {
    factors(shaping)(off_axis_deg, around_deg)
}
fn close(got: f32, want: f32, tolerance: f32) -> bool {
    (got - want).abs() <= tolerance
}

/// LM-63 text with this many vertical and horizontal angles, then the angles and the candela.
fn lm63(vertical: &[f32], horizontal: &[f32], candela: &[f32]) -> String {
    let list = |v: &[f32]| v.iter().map(f32::to_string).collect::<Vec<_>>().join(" ");
    let (v, h) = (vertical.len(), horizontal.len());
    let (vertical, horizontal, candela) = (list(vertical), list(horizontal), list(candela));
    format!(
        "IESNA:LM-63-2002\n[TEST] x\nTILT=NONE\n1 -1 1 {v} {h} 1 2 0 0 0\n1 1 9\n{vertical}\n{horizontal}\n{candela}\n"
    )
}
