//! The paths of a group, joined.

use umber_math::Rgb;

use super::LARGEST_GROUP;
use super::trace::{Onwards, Path, Second};
use crate::scene::RenderScene;

/// What a member of a group gets from a second vertex, but for densities: reflectance at both vertices, and geometry.
#[derive(Clone, Copy)]
struct Share {
    member: usize,
    /// Of the light sample's radiance.
    of_light: Rgb,
    /// Of what the ray onwards brings.
    of_onwards: Rgb,
}

/// Densities with which the members together make a second vertex, and directions from there.
#[derive(Default)]
struct Density {
    /// By area.
    point: f32,
    /// The same, times that of the light sample's direction by the BSDF.
    with_light: f32,
    /// The same, times that of the direction onwards.
    with_onwards: f32,
}

/// Adds to the radiance of each of up to [`LARGEST_GROUP`] paths what their second vertices, taken together, bring.
pub(in crate::integrator) fn share(scene: &RenderScene, paths: &mut [Path<'_>]) {
    let mut sums = [Rgb::BLACK; LARGEST_GROUP];
    let mut rays = [0; LARGEST_GROUP];
    for (owner, path) in paths.iter().enumerate() {
        if let Some(second) = path.second.as_ref().filter(|second| second.brings_anything()) {
            add_shares(scene, paths, owner, second, &mut sums, &mut rays);
        }
    }
    for (path, (sum, rays)) in paths.iter_mut().zip(sums.into_iter().zip(rays)) {
        path.radiance += sum;
        path.rays += rays;
    }
}

impl Second<'_> {
    fn brings_anything(&self) -> bool {
        self.light.is_some() || self.onwards.is_some()
    }
}

/// Adds what the second vertex of path number `owner` brings to all.
fn add_shares(
    scene: &RenderScene,
    paths: &[Path<'_>],
    owner: usize,
    second: &Second<'_>,
    sums: &mut [Rgb; LARGEST_GROUP],
    rays: &mut [u64; LARGEST_GROUP],
) {
    let mut density = Density::default();
    let mut shares = [None; LARGEST_GROUP];
    for (member, (path, share)) in paths.iter().zip(&mut shares).enumerate() {
        // a path sees its own second vertex; through what is partly there, with the chance that it did
        let is_seen = member == owner && !scene.partly_present;
        *share = join(scene, path, second, is_seen, &mut density, &mut rays[member])
            .map(|[of_light, of_onwards]| Share { member, of_light, of_onwards });
    }
    let light = second.light_over_density(&density);
    let onwards = second.onwards.as_ref().map_or(Rgb::BLACK, |onwards| onwards.over_density(scene, &density));
    for share in shares.into_iter().flatten() {
        sums[share.member] += share.of_light * light + share.of_onwards * onwards;
    }
}

/// Joins the first vertex of a path to a second vertex, and adds the densities with which the path makes it. Gives
/// what of the light sample and of the way onwards comes to the path; `None` where the vertices do not see each other.
#[inline]
fn join(
    scene: &RenderScene,
    path: &Path<'_>,
    second: &Second<'_>,
    is_seen: bool,
    density: &mut Density,
    rays: &mut u64,
) -> Option<[Rgb; 2]> {
    let first = path.first.as_ref()?;
    let (at, guided) = (&second.vertex.surface.at, &second.vertex.guided);
    let to_second = at.point - first.surface.at.point;
    let squared = to_second.length_squared();
    let wi = to_second * (1.0 / squared.sqrt());
    let value = first.guided.evaluate(first.wo, wi);
    let area_from_solid_angle = wi.dot_normal(at.normal).abs() / squared;
    let unoccluded = value.pdf_solid_angle * area_from_solid_angle;
    // false for what is not a number, too
    if !(unoccluded > 0.0 && unoccluded.is_finite()) {
        return None;
    }
    let visible = if is_seen { 1.0 } else { scene.visibility(&first.surface, at, rays) };
    if visible <= 0.0 {
        return None;
    }
    let pdf_area = unoccluded * visible;
    density.point += pdf_area;
    let reflected = value.f() * (first.guided.bsdf.cos_theta(wi) * area_from_solid_angle * visible);
    let of_light = second.light.as_ref().map_or(Rgb::BLACK, |light| {
        let value = guided.evaluate(-wi, light.wi);
        density.with_light += pdf_area * value.pdf_solid_angle;
        reflected * value.f()
    });
    let of_onwards = second.onwards.as_ref().map_or(Rgb::BLACK, |onwards| {
        let value = guided.evaluate(-wi, onwards.wi);
        density.with_onwards += pdf_area * value.pdf_solid_angle;
        reflected * value.f()
    });
    Some([of_light, of_onwards])
}

impl Second<'_> {
    /// What the light sample brings: irradiance over the density of the vertex, weighed against rays of all members.
    fn light_over_density(&self, density: &Density) -> Rgb {
        let Some(light) = self.light.as_ref().filter(|_| density.point > 0.0) else { return Rgb::BLACK };
        let mis_weight_light = light.mis_weight_light(density.with_light / density.point);
        let cos_theta = self.vertex.guided.bsdf.cos_theta(light.wi);
        light.radiance * light.multiplier * (cos_theta * mis_weight_light / density.point)
    }
}

impl Onwards {
    /// What the way onwards brings: irradiance over the density of the vertex and the direction. Lights that the ray meets
    /// are weighed against light samples of all members.
    fn over_density(&self, scene: &RenderScene, density: &Density) -> Rgb {
        // false for what is not a number, too
        if !(density.with_onwards > 0.0) {
            return Rgb::BLACK;
        }
        let origin = self.origin.with_pdf(density.with_onwards / density.point);
        let arriving = self.met.radiance(scene, self.wi, origin) + self.reflected;
        arriving * (self.cos_theta / (self.survival * density.with_onwards))
    }
}
