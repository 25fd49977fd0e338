//! Maps from the unit square to disks, spheres, cones and triangles, with their densities.
//!
//! All maps keep neighbours together, so that stratified points stay stratified. Directions are in a local
//! space whose z axis is the pole.

use std::f32::consts::{FRAC_1_PI, FRAC_PI_2, FRAC_PI_4, PI};

use glam::{Vec2, Vec3};
use umber_math::Vector3;

/// A uniform point in the unit disk.
///
/// Shirley & Chiu 1997, "A Low Distortion Map Between Disk and Square".
#[inline]
pub fn concentric_disk(u: Vec2) -> Vec2 {
    let o = u * 2.0 - Vec2::ONE;
    // Without branches: half of them would be mispredicted. The angle from the nearer axis is within an eighth turn.
    let steep = o.y.abs() >= o.x.abs();
    let (r, across) = if steep { (o.y, o.x) } else { (o.x, o.y) };
    let ratio = if r == 0.0 { 0.0 } else { across / r };
    let (sin, cos) = sin_cos_eighth(FRAC_PI_4 * ratio);
    if steep { Vec2::new(r * sin, r * cos) } else { Vec2::new(r * cos, r * sin) }
}

/// Sine and cosine of an angle within an eighth of a turn to either side, to two roundings of one: Taylor's series.
#[inline]
fn sin_cos_eighth(x: f32) -> (f32, f32) {
    let y = x * x;
    let sin = x * (1.0 + y * (-1.0 / 6.0 + y * (1.0 / 120.0 + y * (-1.0 / 5040.0 + y * (1.0 / 362_880.0)))));
    let cos = 1.0 + y * (-0.5 + y * (1.0 / 24.0 + y * (-1.0 / 720.0 + y * (1.0 / 40_320.0))));
    (sin, cos)
}

/// The point of the unit square that [`concentric_disk`] maps to `p`.
#[inline]
pub fn concentric_disk_inverse(p: Vec2) -> Vec2 {
    let (r, phi) = (p.length(), p.y.atan2(p.x));
    if r == 0.0 {
        return Vec2::splat(0.5);
    }
    let o = if phi.abs() < FRAC_PI_4 {
        Vec2::new(r, r * phi / FRAC_PI_4)
    } else if phi.abs() > 3.0 * FRAC_PI_4 {
        let from_negative_x = if phi > 0.0 { phi - PI } else { phi + PI };
        Vec2::new(-r, -r * from_negative_x / FRAC_PI_4)
    } else if phi > 0.0 {
        Vec2::new(r * (FRAC_PI_2 - phi) / FRAC_PI_4, r)
    } else {
        Vec2::new(r * (FRAC_PI_2 + phi) / FRAC_PI_4, -r)
    };
    (o + Vec2::ONE) * 0.5
}

/// Density of [`concentric_disk`] by area.
pub const UNIFORM_DISK_PDF_AREA: f32 = FRAC_1_PI;

/// A direction of the hemisphere around z with density proportional to the cosine. Malley's method.
#[inline]
pub fn cosine_hemisphere(u: Vec2) -> Vector3 {
    let d = concentric_disk(u);
    Vector3::new(d.x, d.y, (1.0 - d.length_squared()).max(0.0).sqrt())
}

/// Density of [`cosine_hemisphere`] by solid angle.
#[inline]
pub fn cosine_hemisphere_pdf_solid_angle(cos_theta: f32) -> f32 {
    cos_theta.max(0.0) * FRAC_1_PI
}

/// A uniform direction of the whole sphere.
#[inline]
pub fn uniform_sphere(u: Vec2) -> Vector3 {
    uniform_cone(u, 2.0)
}

/// Density of [`uniform_sphere`] by solid angle.
pub const UNIFORM_SPHERE_PDF_SOLID_ANGLE: f32 = FRAC_1_PI / 4.0;

/// A uniform direction of the cone around z whose half angle θ has `one_minus_cos_max = 1 − cos θ`, in (0, 2].
///
/// Given that way, not by the cosine, narrow cones keep their relative precision.
#[inline]
pub fn uniform_cone(u: Vec2, one_minus_cos_max: f32) -> Vector3 {
    let d = concentric_disk(u);
    let one_minus_cos = d.length_squared() * one_minus_cos_max;
    let sin_over_r = (one_minus_cos_max * (2.0 - one_minus_cos)).max(0.0).sqrt();
    Vector3::new(d.x * sin_over_r, d.y * sin_over_r, 1.0 - one_minus_cos)
}

/// Density of [`uniform_cone`] by solid angle, inside the cone.
#[inline]
pub fn uniform_cone_pdf_solid_angle(one_minus_cos_max: f32) -> f32 {
    0.5 * FRAC_1_PI / one_minus_cos_max
}

/// `1 − cos θ` from `sin² θ` for θ in [0, π/2], without cancellation.
#[inline]
pub fn one_minus_cos_from_sin_squared(sin_squared: f32) -> f32 {
    sin_squared / (1.0 + (1.0 - sin_squared).max(0.0).sqrt())
}

/// Barycentric coordinates, summing to one, of a uniform point in a triangle.
///
/// Heitz 2019, "A Low-Distortion Map Between Triangle and Square". Its density by area is one over the triangle's.
#[inline]
pub fn uniform_triangle(u: Vec2) -> Vec3 {
    let b = if u.x < u.y { Vec2::new(u.x * 0.5, u.y - u.x * 0.5) } else { Vec2::new(u.x - u.y * 0.5, u.y * 0.5) };
    Vec3::new(b.x, b.y, (1.0 - b.x - b.y).max(0.0))
}
