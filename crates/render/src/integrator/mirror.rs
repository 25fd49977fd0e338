//! One reflection: how much the view ray, reflected about the face, goes towards a light.
//!
//! No light travels here. It is the model with which a first ray tracer is often explained: grey, of one direction
//! to the light, without shadows.

use std::f32::consts::TAU;

use umber_bvh::{Hit, Placement};
use umber_math::{DVec3, Ray, Rgb, Vec3, Vector3};
use umber_sampling::Sampler;

use super::RadianceSample;
use super::dimensions::{self, Draw};
use crate::scene::RenderScene;

/// Towards the light, unit, world space.
const TO_LIGHT: Vec3 = Vec3::splat(0.577_350_26);
/// Value of what reflects away from the light: 50 of 255.
const AWAY: f32 = 50.0 / 255.0;

/// Follows a ray from the camera to the nearest face that is there, and reflects it. `sampler` is asked for where the
/// mirror is rough.
pub fn radiance(scene: &RenderScene, ray: Ray, sampler: impl FnOnce() -> Sampler, rays: &mut u64) -> RadianceSample {
    let Some(hit) = scene.camera_hit(ray, rays, |_| 0.5) else {
        return RadianceSample { radiance: Rgb::BLACK, coverage: 0.0 };
    };
    let reflected = Vector3(reflect(ray.direction.0.as_dvec3(), normal(scene, &hit)).as_vec3());
    let reflected = roughened(reflected, scene.settings.mirror_roughness, sampler);
    let factor = TO_LIGHT.dot(reflected.0);
    let value = if factor > 0.0 { factor } else { AWAY };
    RadianceSample { radiance: Rgb::splat(value), coverage: 1.0 }
}

/// Along the normal of the face that was hit, of any length and side; render space is world space, moved.
fn normal(scene: &RenderScene, hit: &Hit) -> DVec3 {
    let [a, b, c] = scene.meshes[hit.mesh as usize].shape.triangle(hit.triangle);
    let a = a.0.as_dvec3();
    let (to_b, to_c) = (b.0.as_dvec3() - a, c.0.as_dvec3() - a);
    match scene.top.placement(&hit.path) {
        Placement::AsItIs => to_b.cross(to_c),
        Placement::Once { exact, .. } => (exact.matrix3 * to_b).cross(exact.matrix3 * to_c),
        Placement::Nested => {
            let exact = scene.top.render_from_object_double(&hit.path);
            (exact.matrix3 * to_b).cross(exact.matrix3 * to_c)
        }
    }
}

/// A direction reflected about a normal of any length; of a normal without length, the direction itself.
fn reflect(direction: DVec3, normal: DVec3) -> DVec3 {
    let squared = normal.length_squared();
    if squared > 0.0 { direction - normal * (2.0 * direction.dot(normal) / squared) } else { direction }
}

/// A direction with `roughness` times a normally distributed vector added, unit.
fn roughened(direction: Vector3, roughness: f32, sampler: impl FnOnce() -> Sampler) -> Vector3 {
    if roughness == 0.0 {
        return direction;
    }
    (direction + Vector3(normal_vector(sampler())) * roughness).normalized()
}

/// Three independent numbers of the standard normal distribution (Box and Muller 1958).
fn normal_vector(mut sampler: Sampler) -> Vec3 {
    let mut pair = |draw| {
        sampler.start_dimension(dimensions::vertex(0, draw));
        let u = sampler.next_2d();
        // u.x is below 1
        let radius = (-2.0 * (1.0 - u.x).ln()).sqrt();
        let (sin, cos) = (TAU * u.y).sin_cos();
        [radius * cos, radius * sin]
    };
    let ([x, y], [z, _]) = (pair(Draw::MirrorNoise), pair(Draw::MirrorNoiseThird));
    Vec3::new(x, y, z)
}
