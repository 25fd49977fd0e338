//! The paths of a group, joined.

use umber_math::{Rgb, Vector3};

use super::LARGEST_GROUP;
use super::trace::{Onwards, Path, Second};
use crate::scene::RenderScene;

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
    debug_assert!(paths.len() <= LARGEST_GROUP);
    let mut sums = [Rgb::BLACK; LARGEST_GROUP];
    let mut rays = [0; LARGEST_GROUP];
    for (owner, path) in paths.iter().enumerate() {
        if let Some(second) = path.second.as_ref().filter(|second| second.brings_anything()) {
            add_shares(scene, paths, owner, second, &mut sums, &mut rays);
        }
    }
    for (path, (sum, rays)) in paths.iter_mut().zip(sums.into_iter().zip(rays)) {
        path.reflected += sum;
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
        // its own it has met; where surfaces are partly there, that has the chance of having got through, as others' has
        let is_met = member == owner && !scene.partly_present;
        *share = join(scene, path, second, is_met, &mut density, &mut rays[member]);
    }
    let light = second.light_over_density(&density);
    let onwards = second.onwards.as_ref().map_or(Rgb::BLACK, |onwards| onwards.over_density(scene, &density));
    for (sum, share) in sums.iter_mut().zip(shares) {
        let Some([of_light, of_onwards]) = share else { continue };
        *sum += of_light * light + of_onwards * onwards;
    }
}

/// Joins the first vertex of a path to a second vertex, and adds the densities with which the path makes it. Gives the
/// reflectance at both, with what lies between, of the light sample's radiance and of what comes from onwards; `None`
/// where the path could not have met the second vertex on its side.
#[inline]
fn join(
    scene: &RenderScene,
    path: &Path<'_>,
    second: &Second<'_>,
    is_met: bool,
    density: &mut Density,
    rays: &mut u64,
) -> Option<[Rgb; 2]> {
    let first = path.first.as_ref()?;
    let (at, guided) = (&second.vertex.surface.at, &second.vertex.guided);
    let to_second = at.point - first.surface.at.point;
    let squared = to_second.length_squared();
    let wi = to_second * (1.0 / squared.sqrt());
    let facing = -wi.dot_normal(at.normal) * second.vertex.wo.dot_normal(at.normal).signum();
    let value = first.guided.evaluate(first.wo, wi);
    let unoccluded = value.pdf_solid_angle * (facing / squared);
    // what is not a number is not above 0 either
    let is_possible = facing > 0.0 && unoccluded > 0.0 && unoccluded.is_finite();
    let f = value.f();
    if !is_possible || f.is_black() {
        return None;
    }
    let visible = if is_met { 1.0 } else { scene.visibility(&first.surface, at, rays) };
    if visible <= 0.0 {
        return None;
    }
    let pdf_area = unoccluded * visible;
    density.point += pdf_area;
    let reflected = f * (first.guided.bsdf.cos_theta(wi) * (facing / squared) * visible);
    // no path goes where nothing is reflected: of that no density counts
    let evaluate = |direction: Vector3, density: &mut f32| {
        let value = guided.evaluate(-wi, direction);
        let f = value.f();
        *density += if f.is_black() { 0.0 } else { pdf_area * value.pdf_solid_angle };
        reflected * f
    };
    let of_light = second.light.as_ref().map_or(Rgb::BLACK, |light| evaluate(light.wi, &mut density.with_light));
    let of_onwards =
        second.onwards.as_ref().map_or(Rgb::BLACK, |onwards| evaluate(onwards.wi, &mut density.with_onwards));
    Some([of_light, of_onwards])
}

impl Second<'_> {
    /// What the light sample brings: irradiance over the density of the vertex, weighed against rays of all members.
    fn light_over_density(&self, density: &Density) -> Rgb {
        let Some(light) = self.light.as_ref().filter(|_| density.point > 0.0) else { return Rgb::BLACK };
        let mis_weight_light = light.mis_weight_light(density.with_light / density.point);
        let cos_theta = self.vertex.guided.bsdf.cos_theta(light.wi);
        finite(light.radiance * light.multiplier * (cos_theta * mis_weight_light / density.point))
    }
}

impl Onwards {
    /// What the way onwards brings: irradiance over the density of the vertex and the direction. Lights that the ray
    /// meets are weighed against light samples of all members.
    fn over_density(&self, scene: &RenderScene, density: &Density) -> Rgb {
        if density.with_onwards <= 0.0 || density.with_onwards.is_nan() {
            return Rgb::BLACK;
        }
        let origin = self.origin.with_pdf(density.with_onwards / density.point);
        let arriving = self.met.radiance(scene, self.wi, origin) + self.reflected;
        finite(arriving * (self.cos_theta / (self.survival * density.with_onwards)))
    }
}

/// One bad value is not to be shared.
fn finite(radiance: Rgb) -> Rgb {
    if radiance.is_finite() { radiance } else { Rgb::BLACK }
}
