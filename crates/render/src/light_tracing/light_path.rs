//! One light path: from a light by smooth surfaces to any, and to the camera.
//!
//! What it carries is the integrand of a path from the camera over its own density, both in area measure: BSDFs with
//! the cosines to shading normals on the light's side, as paths from the camera have them (Veach 1997, section 5.3).

use umber_bvh::Hit;
use umber_math::{Point3, Ray, Rgb, Vector3};
use umber_sampling::Sampler;
use umber_shading::{Bsdf, BsdfSample, LightSample, LobeKind, Receiver};

use super::LightTracing;
use super::chain::Link;
use crate::caustics::Guided;
use crate::film::FilmDesc;
use crate::integrator::path::{self, Vertex};
use crate::integrator::{found, tile};
use crate::scene::RenderScene;
use crate::surface::{self, SurfaceInteraction};

/// Vertex of a path whose light samples are those at a landing: numbers that nothing else here takes.
const LANDING_VERTEX: u32 = 8000;

/// What a light path brings to a pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Splat {
    pub pixel: u32,
    pub radiance: Rgb,
}

/// Where a light path met a rough surface, as who looks for caustics wants to know it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Landing {
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

/// A light path under way.
pub(super) struct LightPath {
    /// The side of a block of casters where it begins.
    pub side: usize,
    first: SurfaceInteraction,
    lit: Lit,
    /// How much of the light arrives at the first surface, once somebody has asked.
    arriving: Option<Rgb>,
    /// Whether it begins at a mirror, where a path from the camera cannot use a light sample.
    by_mirror: bool,
    /// Whether a diffuse lobe took it on from there, which focuses nothing.
    is_diffuse: bool,
    /// Density with which a path from the camera would find the light by a ray.
    pdf_of_rays: f32,
    /// The integrand over the density, without the light's visibility and what belongs to the next vertex.
    throughput: Rgb,
    /// *R* of [`super::chain`], without what belongs to the next vertex.
    ratio: f32,
    /// Luminance that shows along the ray from its end.
    luminance: f32,
    origin: Point3,
    ray: Ray,
}

/// The light sample that a path begins with.
struct Lit {
    sample: LightSample,
    light: u32,
    /// Density of the choice and the sample.
    pdf: f32,
}

/// A surface that a light path meets.
pub(super) struct Met {
    hit: Hit,
    surface: SurfaceInteraction,
    /// Back along the path.
    wi: Vector3,
    pub bsdf: Bsdf,
}

/// What a film sees of a light path.
struct Seen {
    pixel: u32,
    /// From the camera, to the surface.
    ray: Ray,
    radiance: Rgb,
    /// *R* of [`super::chain`].
    ratio: f32,
}

impl Met {
    pub fn point(&self) -> Point3 {
        self.surface.at.point
    }
}

impl LightPath {
    /// Begins where `u` says.
    pub fn begin(scene: &RenderScene, tracing: &LightTracing, u: f32, sampler: &mut Sampler) -> Option<Self> {
        let start = tracing.casters.sample(u, sampler.next_1d(), sampler.next_2d())?;
        let first = SurfaceInteraction::new(scene, &start.hit);
        let lit = Lit::new(scene, &first, start.is_front, sampler)?;
        let wi = lit.sample.wi;
        let bsdf = first.bsdf(wi);
        if !tracing.casts(scene, &bsdf, first.at.point) {
            return None;
        }
        let back = bsdf.sample(wi, sampler.next_1d(), sampler.next_2d())?;
        let by_mirror = back.lobe == LobeKind::Delta;
        // there a path from the camera has rays alone: they have to find the light as it is sampled
        if by_mirror && (bsdf.lifts(wi) || !lit.is_found_in_mirrors(scene)) {
            return None;
        }
        let pdf_area = tracing.casters.pdf_area(scene, &start.hit, start.is_front);
        let presence = if scene.partly_present { surface::presence(scene, &start.hit) } else { 1.0 };
        let out = cosine(&first, back.wi);
        let scale = presence * bsdf.cos_theta(wi) * out / (lit.pdf * pdf_area * back.pdf_solid_angle);
        let throughput = lit.sample.radiance * lit.reflected(scene, &bsdf, &back) * scale;
        (!throughput.is_black() && throughput.is_finite()).then(|| Self {
            side: start.side,
            arriving: None,
            by_mirror,
            is_diffuse: back.lobe == LobeKind::Diffuse,
            pdf_of_rays: if by_mirror { back.pdf_solid_angle } else { bsdf.pdf_solid_angle(back.wi, wi) },
            throughput,
            ratio: tracing.paths_a_sample * pdf_area * back.pdf_solid_angle / out,
            luminance: lit.luminance(&back),
            origin: first.at.point,
            ray: first.at.spawn_ray(back.wi),
            first,
            lit,
        })
    }

    /// Follows it to the next surface.
    pub fn meet(&self, scene: &RenderScene, sampler: &mut Sampler, rays: &mut u64) -> Option<Met> {
        let hit = scene.closest_hit(self.ray, rays, |_| sampler.next_1d())?;
        let surface = SurfaceInteraction::new(scene, &hit);
        let wi = -self.ray.direction;
        let bsdf = surface.bsdf(wi);
        // the shape of a light would end a path from the camera
        let before = Ray { t_max: hit.t, ..self.ray };
        let ends = bsdf.is_black() || scene.light_on(&before, Some(surface.links)).is_some();
        (!ends).then_some(Met { hit, surface, wi, bsdf })
    }

    /// Goes on from a smooth surface; `None` where it ends there.
    pub fn reflect(&mut self, met: &Met, sampler: &mut Sampler) -> Option<()> {
        let Met { surface, wi, bsdf, .. } = met;
        let back = bsdf.sample(*wi, sampler.next_1d(), sampler.next_2d())?;
        let (f, pdf_onwards) = if back.lobe == LobeKind::Delta {
            if bsdf.lifts(*wi) {
                return None;
            }
            (back.f, back.pdf_solid_angle)
        } else {
            let value = bsdf.evaluate(back.wi, *wi);
            (value.f(), value.pdf_solid_angle)
        };
        let (into, out) = (cosine(surface, *wi), cosine(surface, back.wi));
        let reflectance = f * (bsdf.cos_theta(*wi) / back.pdf_solid_angle);
        self.throughput *= reflectance * (out / into);
        self.ratio *= back.pdf_solid_angle / pdf_onwards * (into / out);
        self.luminance *= reflectance.luminance();
        (self.origin, self.ray) = (surface.at.point, surface.at.spawn_ray(back.wi));
        (!self.throughput.is_black() && self.throughput.is_finite()).then_some(())
    }

    /// What a film sees of it at a surface.
    pub fn splat(
        &mut self,
        scene: &RenderScene,
        film: &FilmDesc,
        met: &Met,
        sampler: &mut Sampler,
        rays: &mut u64,
    ) -> Option<Splat> {
        let Seen { pixel, ray, radiance, ratio } = self.seen(scene, film, met)?;
        let radiance = radiance * self.weight(scene, ratio);
        if radiance.is_black() || !radiance.is_finite() {
            return None;
        }
        let radiance = tile::finite(radiance * self.arriving(scene, rays));
        let end = (met.surface.at.spawn_ray(-ray.direction).origin - ray.origin).dot(ray.direction);
        let to_surface = Ray { t_max: end * (1.0 - 4.0 * f32::EPSILON), ..ray };
        let is_hidden = radiance.is_black()
            || scene.light_on(&to_surface, None).is_some()
            || scene.camera_hit(to_surface, rays, |_| sampler.next_1d()).is_some();
        (!is_hidden).then_some(Splat { pixel, radiance })
    }

    /// The same where nothing is in between, before it is weighed.
    fn seen(&self, scene: &RenderScene, film: &FilmDesc, met: &Met) -> Option<Seen> {
        let Met { hit, surface, wi, .. } = met;
        let (place, ray) = scene.camera.seen(surface.at.point)?;
        let is_inside = |place: f32, size: usize| place >= 0.0 && place < size as f32;
        if !is_inside(place.x, film.width) || !is_inside(place.y, film.height) || scene.culls(hit, ray.direction) {
            return None;
        }
        let wo = -ray.direction;
        let bsdf = surface.bsdf(wo);
        let (value, into) = (bsdf.evaluate(wo, *wi), cosine(surface, *wi));
        let density = scene.camera.pixels_over_area(ray.direction, ray.t_max) * cosine(surface, wo);
        Some(Seen {
            pixel: place.y as u32 * film.width as u32 + place.x as u32,
            ray,
            radiance: self.throughput * value.f() * (bsdf.cos_theta(*wi) / into * density),
            ratio: self.ratio * into / (density * value.pdf_solid_angle),
        })
    }

    /// Its part of the three ways that make the path, by the power heuristic. `ratio`: *R*.
    fn weight(&self, scene: &RenderScene, ratio: f32) -> f32 {
        let is_found = self.by_mirror || !self.lit.sample.is_delta && scene.is_found_by_rays(self.lit.light);
        let by_rays = if is_found { self.pdf_of_rays / self.lit.pdf } else { 0.0 };
        let by_samples = if self.by_mirror { 0.0 } else { 1.0 };
        let others = by_rays * by_rays + by_samples;
        // what is no number is what paths from the camera take for one that light paths do not make
        if ratio.is_finite() { 1.0 / (1.0 + others / (ratio * ratio)) } else { 0.0 }
    }

    /// How much of the light arrives at the first surface.
    fn arriving(&mut self, scene: &RenderScene, rays: &mut u64) -> Rgb {
        let Self { first, lit, .. } = self;
        *self.arriving.get_or_insert_with(|| path::visible(scene, first, &lit.sample, lit.light, rays))
    }

    /// What it says about caustics where it met a surface that shows them.
    pub fn landing(
        &mut self,
        scene: &RenderScene,
        met: &Met,
        sampler: &mut Sampler,
        rays: &mut u64,
    ) -> Option<Landing> {
        let Met { surface, wi: wo, bsdf, .. } = *met;
        if !bsdf.scatters() || self.is_diffuse {
            return None;
        }
        let flux = (self.throughput * self.arriving(scene, rays)).luminance();
        let (point, guided) = (surface.at.point, Guided::new(bsdf, surface.at.point, None));
        let vertex = Vertex { surface, guided, wo, bounce: LANDING_VERTEX, link: Link::default() };
        // the path goes on with the numbers that follow
        let direct = path::direct(scene, &vertex, &mut { *sampler }, rays).luminance();
        let (weight, reflected) = (flux * self.luminance, bsdf.albedo(wo).luminance() * self.luminance);
        let is_usable = weight.is_finite() && weight > 0.0;
        is_usable.then_some(Landing { point, origin: self.origin, weight, reflected, direct })
    }
}

impl Lit {
    /// At a point, on one of its sides.
    fn new(scene: &RenderScene, surface: &SurfaceInteraction, is_front: bool, sampler: &mut Sampler) -> Option<Self> {
        let normal = if is_front { surface.at.normal } else { -surface.at.normal };
        let receiver = Receiver { point: surface.at.point, normal, clearance: surface.at.clearance };
        let (light, pmf) = scene.choose_light(surface.links, &receiver, || sampler.next_1d())?;
        let sample = scene.lights.lights()[light as usize].sample_for(&receiver, sampler.next_2d())?;
        let pdf = pmf * sample.pdf_solid_angle;
        (sample.wi.dot_normal(normal) > 0.0).then_some(Self { sample, light, pdf })
    }
    /// Whether rays from mirrors find the light, with the radiance and the shadows of its samples.
    fn is_found_in_mirrors(&self, scene: &RenderScene) -> bool {
        found::is_found_in_mirrors(scene, self.light) && !self.sample.is_delta
    }
    /// The BSDF's value for it and a direction away from it, as the light scales lobes.
    fn reflected(&self, scene: &RenderScene, bsdf: &Bsdf, back: &BsdfSample) -> Rgb {
        let light = &scene.lights.lights()[self.light as usize];
        if back.lobe == LobeKind::Delta {
            return back.f * light.specular();
        }
        let value = bsdf.evaluate(back.wi, self.sample.wi);
        value.diffuse * light.diffuse() + value.glossy * light.specular()
    }
    /// Luminance that shows in the surface: a lobe narrower than the light shows it as it is, a wider one spreads it.
    fn luminance(&self, back: &BsdfSample) -> f32 {
        let reflectance = back.f * (back.cos_theta / back.pdf_solid_angle);
        let is_mirror = back.lobe == LobeKind::Delta;
        let spread = if is_mirror { f32::INFINITY } else { back.pdf_solid_angle / self.sample.pdf_solid_angle };
        let spread = if self.sample.is_delta { spread } else { spread.min(1.0) };
        (self.sample.radiance * reflectance).luminance() * spread
    }
}

/// To the geometric normal.
fn cosine(surface: &SurfaceInteraction, direction: Vector3) -> f32 {
    direction.dot_normal(surface.at.normal).abs()
}

#[cfg(test)]
mod tests;
