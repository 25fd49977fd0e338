//! Photons from lights, by smooth surfaces, to rough ones.
//!
//! They start on smooth surfaces that the camera, or what it sees, sees: there light is sampled as for any surface,
//! so that all kinds of lights are found, and which surfaces they are linked to.

use std::ops::Range;

use rayon::prelude::*;
use umber_math::{Point3, Ray, Vec2, Vector3};
use umber_sampling::Sampler;
use umber_shading::LobeKind;

use super::aim::Guided;
use crate::film::FilmDesc;
use crate::integrator::Stop;
use crate::integrator::path::{self, Vertex};
use crate::scene::RenderScene;
use crate::surface::SurfaceInteraction;

/// Bounces of a path that looks for smooth surfaces.
const BOUNCES: u32 = 3;
/// Smooth surfaces that a photon meets before it ends.
const REFLECTIONS: u32 = 4;
/// Photons from each smooth point that a path meets.
const PHOTONS: u32 = 4;
/// Paths that one thread follows at a time.
const BATCH: usize = 256;
/// Vertex of a path whose light samples are those at a landing: numbers that nothing else here takes.
const LANDING_VERTEX: u32 = 8000;
/// Distinguishes its random numbers from those of the picture.
const STREAM: u64 = 3 << 32;

/// Where a photon met a rough surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Landing {
    pub point: Point3,
    /// The smooth point that it came from.
    pub origin: Point3,
    /// How much it matters to the variance there, on a scale of its own.
    pub weight: f32,
    /// Luminance that a ray of the BSDF which meets its origin would bring.
    pub reflected: f32,
    /// Luminance that direct light has there, an estimate by one sample.
    pub direct: f32,
}

/// Where photons land that paths through a film send out, by the paths' numbers; in an order that only the seed decides.
/// Of some alone, where stopped.
pub(super) fn landings(
    scene: &RenderScene,
    film: &FilmDesc,
    paths: Range<u32>,
    stop: &Stop<'_>,
    rays: &mut u64,
) -> Vec<Landing> {
    let batches: Vec<(Vec<Landing>, u64)> = (0..paths.len() as u32)
        .into_par_iter()
        .step_by(BATCH)
        .map(|batch| {
            let (mut landings, mut rays) = (Vec::new(), 0);
            for number in paths.clone().skip(batch as usize).take(BATCH) {
                if stop.now() {
                    break;
                }
                follow(scene, film, number, &mut landings, &mut rays);
            }
            (landings, rays)
        })
        .collect();
    *rays += batches.iter().map(|(_, rays)| rays).sum::<u64>();
    batches.into_iter().flat_map(|(landings, _)| landings).collect()
}

/// Follows a path from the camera, and sends photons from the smooth surfaces that it meets.
fn follow(scene: &RenderScene, film: &FilmDesc, number: u32, landings: &mut Vec<Landing>, rays: &mut u64) {
    let mut sampler = Sampler::new(STREAM | u64::from(scene.settings.seed), [number, 0], 0);
    let at = sampler.next_2d();
    let mut ray = scene.camera.ray(at * Vec2::new(film.width as f32, film.height as f32));
    for bounce in 0..BOUNCES.min(scene.settings.max_bounces) {
        let Some(surface) = met(scene, ray, bounce == 0, &mut sampler, rays) else { return };
        let wo = -ray.direction;
        let bsdf = surface.bsdf(wo);
        if bsdf.is_black() {
            return;
        }
        if bsdf.focuses() {
            for _ in 0..PHOTONS {
                landings.extend(photon(scene, &surface, wo, &mut sampler, rays));
            }
        }
        let Some(sample) = bsdf.sample(wo, sampler.next_1d(), sampler.next_2d()) else { return };
        ray = surface.at.spawn_ray(sample.wi);
    }
}

/// The surface that a ray meets.
fn met(
    scene: &RenderScene,
    ray: Ray,
    is_camera: bool,
    sampler: &mut Sampler,
    rays: &mut u64,
) -> Option<SurfaceInteraction> {
    let chance = |_| sampler.next_1d();
    let hit = if is_camera { scene.camera_hit(ray, rays, chance) } else { scene.closest_hit(ray, rays, chance) };
    hit.map(|hit| SurfaceInteraction::new(scene, &hit))
}

/// Sends a photon from a light by a smooth surface on: where it lands.
fn photon(
    scene: &RenderScene,
    surface: &SurfaceInteraction,
    wo: Vector3,
    sampler: &mut Sampler,
    rays: &mut u64,
) -> Option<Landing> {
    let receiver = path::receiver(surface, wo);
    let (index, pmf) = scene.choose_light(surface.links, &receiver, || sampler.next_1d())?;
    let light = &scene.lights.lights()[index as usize];
    let to_light = light.sample_for(&receiver, sampler.next_2d())?;
    let bsdf = surface.bsdf(to_light.wi);
    let sample = bsdf.sample(to_light.wi, sampler.next_1d(), sampler.next_2d())?;
    if sample.lobe == LobeKind::Diffuse {
        return None;
    }
    let is_mirror = sample.lobe == LobeKind::Delta;
    if is_mirror && (to_light.is_delta || !scene.is_found_by_rays(index)) {
        return None;
    }
    let visible = scene.arriving(path::shadow_ray(surface, &to_light), index, surface.links, rays);
    if visible <= 0.0 {
        return None;
    }
    let cosine = bsdf.cos_theta(to_light.wi);
    let reflectance = sample.f * (sample.cos_theta / sample.pdf_solid_angle);
    let irradiance = to_light.radiance * (visible * cosine / to_light.pdf_solid_angle);
    let mut flux = (irradiance * reflectance).luminance() / pmf;
    // a lobe narrower than the light shows the light as it is; a wider one spreads what arrives
    let spread = if is_mirror { f32::INFINITY } else { sample.pdf_solid_angle / to_light.pdf_solid_angle };
    let spread = if to_light.is_delta { spread } else { spread.min(1.0) };
    let mut radiance = (to_light.radiance * reflectance).luminance() * visible * spread;
    let (mut origin, mut ray) = (surface.at.point, surface.at.spawn_ray(sample.wi));
    for _ in 0..REFLECTIONS {
        let there = met(scene, ray, false, sampler, rays)?;
        let wo = -ray.direction;
        let bsdf = there.bsdf(wo);
        if bsdf.scatters() {
            let reflected = bsdf.albedo(wo).luminance() * radiance;
            let (point, weight) = (there.at.point, flux * radiance);
            let vertex = Vertex { surface: there, guided: Guided::new(bsdf, point, None), wo, bounce: LANDING_VERTEX };
            // photons to come go on with the numbers that follow
            let mut sampler = *sampler;
            let direct = path::direct(scene, &vertex, &mut sampler, rays).luminance();
            return (weight.is_finite() && weight > 0.0).then_some(Landing {
                point,
                origin,
                weight,
                reflected,
                direct,
            });
        }
        let sample = bsdf.sample(wo, sampler.next_1d(), sampler.next_2d())?;
        let reflectance = (sample.f * (sample.cos_theta / sample.pdf_solid_angle)).luminance();
        (flux, radiance) = (flux * reflectance, radiance * reflectance);
        (origin, ray) = (there.at.point, there.at.spawn_ray(sample.wi));
    }
    None
}
