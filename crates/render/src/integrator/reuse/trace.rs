//! A pixel's path, in parts that others can use.

use umber_math::{Rgb, Vector3};
use umber_sampling::Sampler;
use umber_shading::{Bsdf, LobeKind};

use crate::integrator::found::{Met, Origin};
use crate::integrator::path::{self, Arriving, Scattering, Vertex, Walk};
use crate::integrator::primary::Primary;

/// Second vertices with no lobe as wide as this are not shared: what they reflect to one pixel, hardly another sees.
const LEAST_ALPHA: f32 = 0.05;

/// Whether what a second vertex reflects is shared.
#[inline]
pub(crate) fn is_shared(bsdf: &Bsdf) -> bool {
    bsdf.is_wider_than(LEAST_ALPHA)
}

/// A path from the camera.
pub(in crate::integrator) struct Path<'a> {
    /// Radiance so far of what the first vertex reflects: what cannot be shared, and then the rest.
    pub reflected: Rgb,
    /// Rays traced for it, without that from the camera.
    pub rays: u64,
    /// Where it is joined to second vertices; `None` where all that it finds is its own.
    pub(super) first: Option<Vertex<'a>>,
    /// What others may use.
    pub(super) second: Option<Second<'a>>,
}

/// The second vertex of a path, and what arrives there.
pub(super) struct Second<'a> {
    pub vertex: Vertex<'a>,
    /// By a light sample.
    pub light: Option<Arriving>,
    /// By a ray of the BSDF.
    pub onwards: Option<Onwards>,
}

/// The way of a path from its second vertex on.
pub(super) struct Onwards {
    pub wi: Vector3,
    pub cos_theta: f32,
    /// Chance with which roulette let it go on.
    pub survival: f32,
    /// What the ray meets, and how it was found.
    pub met: Met,
    pub origin: Origin,
    /// Radiance that what it meets reflects.
    pub reflected: Rgb,
}

/// Traces a path on from what a ray from the camera met, whose own cost is not counted.
pub(in crate::integrator) fn trace<'a>(primary: &Primary<'a>, sampler: &mut Sampler) -> Path<'a> {
    let mut path = Path { reflected: Rgb::BLACK, rays: 0, first: None, second: None };
    match primary.first {
        Some((mut walk, first)) if first.guided.bsdf.scatters() => path.go_on(&mut walk, first, sampler),
        Some((mut walk, first)) => path.reflected = walk.on_from(&first, sampler, &mut path.rays),
        None => {}
    }
    path
}

impl<'a> Path<'a> {
    /// Traces the rest from the first vertex.
    fn go_on(&mut self, walk: &mut Walk<'a>, first: Vertex<'a>, sampler: &mut Sampler) {
        self.reflected += path::direct(walk.scene, &first, sampler, &mut self.rays);
        let scattering = walk.scatter(&first, sampler);
        self.first = Some(first);
        let Some(Scattering { sample, .. }) = scattering else { return };
        let found = walk.find(sampler, &mut self.rays);
        self.reflected += walk.throughput * found.radiance;
        let Some(second) = found.vertex else { return };
        if sample.lobe == LobeKind::Delta || !is_shared(&second.guided.bsdf) {
            self.reflected += walk.on_from(&second, sampler, &mut self.rays);
            return;
        }
        let light = path::arriving(walk.scene, &second, sampler, &mut self.rays);
        let to_second = walk.take_throughput();
        let onwards = walk.scatter(&second, sampler).and_then(|scattering| {
            let sample = &scattering.sample;
            let throughput = walk.take_throughput();
            let (met, origin) = (walk.meet(sampler, &mut self.rays), walk.origin);
            let next = walk.vertex(&met);
            let reflected = next.map_or(Rgb::BLACK, |vertex| walk.on_from(&vertex, sampler, &mut self.rays));
            if sample.lobe == LobeKind::Delta {
                let arriving = reflected + met.radiance(walk.scene, sample.wi, origin);
                self.reflected += to_second * throughput * arriving;
                return None;
            }
            let (wi, cos_theta, survival) = (sample.wi, sample.cos_theta, scattering.survival);
            Some(Onwards { wi, cos_theta, survival, met, origin, reflected })
        });
        self.second = Some(Second { vertex: second, light, onwards });
    }
}
