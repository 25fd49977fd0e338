//! One reflection: how much the view ray, reflected about the face, goes towards a light.
//!
//! No light travels here. It is the model with which a first ray tracer is often explained: grey, of one direction
//! to the light, without shadows.

use std::f32::consts::TAU;

use umber_geometry::geometric_normal;
use umber_math::{Ray, Rgb, Vec3, Vector3};
use umber_sampling::Sampler;

use super::RadianceSample;
use super::dimensions::{self, Draw};
use crate::scene::RenderScene;

/// Towards the light, unit, world space.
const TO_LIGHT: Vec3 = Vec3::splat(0.577_350_26);
/// Value of what reflects away from the light: 50 of 255.
const AWAY: f32 = 50.0 / 255.0;

/// Follows a ray from the camera to the nearest face that is there, and reflects it.
pub fn radiance(scene: &RenderScene, ray: Ray, sampler: &mut Sampler, rays: &mut u64) -> RadianceSample {
    let Some(hit) = scene.camera_hit(ray, rays, |_| 0.5) else {
        return RadianceSample { radiance: Rgb::BLACK, coverage: 0.0 };
    };
    let [a, b, c] = scene.meshes[hit.mesh as usize].shape.triangle(hit.triangle);
    // which side it is on does not matter here; render space is world space, moved
    let normal = scene.top.render_from_object(&hit.path).normal(geometric_normal(a, b, c)).normalized();
    let reflected = ray.direction - normal.as_vector() * (2.0 * ray.direction.dot_normal(normal));
    let reflected = roughened(reflected, scene.settings.mirror_roughness, sampler);
    let factor = TO_LIGHT.dot(reflected.0);
    let value = if factor > 0.0 { factor } else { AWAY };
    RadianceSample { radiance: Rgb::splat(value), coverage: 1.0 }
}

/// A direction with `roughness` times a normally distributed vector added, unit.
fn roughened(direction: Vector3, roughness: f32, sampler: &mut Sampler) -> Vector3 {
    if roughness == 0.0 {
        return direction;
    }
    (direction + Vector3(normal_vector(sampler)) * roughness).normalized()
}

/// Three independent numbers of the standard normal distribution (Box and Muller 1958).
fn normal_vector(sampler: &mut Sampler) -> Vec3 {
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
