//! The frozen scene: what integrators read. It has no setters.

use std::sync::Arc;

use umber_bvh::{Hit, InstanceBvh};
use umber_geometry::SurfacePoint;
use umber_math::{Point3, Ray, Vector3};
use umber_scene::CulledFaces;
use umber_settings::Settings;
use umber_shading::Bsdf;

use crate::camera::RenderCamera;
use crate::caustics::{CausticMap, Guided};
use crate::compile::InstanceNumber;
use crate::integrator::edges::EdgeMap;
use crate::integrator::splitting::Splitting;
use crate::light_set::LightSet;
use crate::light_tracing::LightTracing;
use crate::linking::Linking;
use crate::material::RenderMaterial;
use crate::mesh::RenderMesh;
use crate::surface;

/// A scene as it was when it was compiled, in render space: world space, moved so that the camera is
/// near the origin.
pub struct RenderScene {
    /// Camera.
    pub camera: RenderCamera,
    /// Settings.
    pub settings: Settings,
    /// Hierarchy over all geometry.
    pub top: Arc<InstanceBvh>,
    /// What the tags of the hierarchy's instances mean.
    pub numbers: Arc<[InstanceNumber]>,
    /// Mesh instances, nested ones multiplied out.
    pub instance_count: u64,
    /// Meshes, as the hierarchy numbers them.
    pub meshes: Arc<[RenderMesh]>,
    /// Materials, as the meshes number them.
    pub materials: Arc<[RenderMaterial]>,
    /// Lights.
    pub lights: Arc<LightSet>,
    /// Which lights reach what, where not all reach all.
    pub linking: Option<Arc<Linking>>,
    /// Whether any surface may let rays pass: where none does, nobody asks.
    pub partly_present: bool,
    /// Where caustics lie, where that was looked for and found.
    pub caustics: Option<CausticMap>,
    /// How caustics are found from the other end, where that pays.
    pub(crate) light_tracing: Option<LightTracing>,
    /// Pixels of a group that shares paths; 1 where none are shared.
    pub path_group: usize,
    /// Which samples of a pixel begin with the same ray.
    pub(crate) splitting: Splitting,
    /// Which pixels need more rays from the camera, where that was looked for and any was found.
    pub(crate) edges: Option<EdgeMap>,
}

/// Rays that went through surfaces which are not there end after so many of them.
pub(crate) const MAX_PASSES: u32 = 1024;

impl RenderScene {
    /// The BSDF at a vertex of a path, 0 for the first behind the camera, led to where caustics there come from.
    #[inline(always)]
    pub fn guided(&self, bsdf: Bsdf, point: Point3, bounce: u32) -> Guided<'_> {
        let is_led = bsdf.scatters() && (self.light_tracing.is_none() || bounce > 0);
        let places = self.caustics.as_ref().filter(|_| is_led).and_then(|map| map.places(point));
        Guided::new(bsdf, point, places)
    }

    /// The nearest surface on a ray that is there. `chance(n)` gives the n-th number in [0, 1) that
    /// decides about partly present surfaces. Counts rays.
    pub fn closest_hit(&self, ray: Ray, rays: &mut u64, chance: impl FnMut(u32) -> f32) -> Option<Hit> {
        self.first_hit(ray, rays, chance, |_, _| true)
    }

    /// As [`closest_hit`](Self::closest_hit), for a camera ray: culled faces are looked through.
    pub fn camera_hit(&self, ray: Ray, rays: &mut u64, chance: impl FnMut(u32) -> f32) -> Option<Hit> {
        self.first_hit(ray, rays, chance, |hit, direction| !self.culls(hit, direction))
    }

    /// The nearest surface that is there and `seen`.
    #[inline(always)]
    fn first_hit(
        &self,
        mut ray: Ray,
        rays: &mut u64,
        mut chance: impl FnMut(u32) -> f32,
        seen: impl Fn(&Hit, Vector3) -> bool,
    ) -> Option<Hit> {
        for pass in 0..MAX_PASSES {
            *rays += 1;
            let hit = self.top.closest_hit(&ray)?;
            if seen(&hit, ray.direction) {
                let presence = if self.partly_present { surface::presence(self, &hit) } else { 1.0 };
                if presence >= 1.0 || presence > 0.0 && chance(pass) < presence {
                    return Some(hit);
                }
            }
            ray.t_min = hit.t;
        }
        None
    }

    pub(crate) fn culls(&self, hit: &Hit, direction: Vector3) -> bool {
        let culled = self.meshes[hit.mesh as usize].culled_faces;
        if culled == CulledFaces::None {
            return false;
        }
        let away = surface::SurfaceInteraction::new(self, hit).at.normal.as_vector().dot(direction) > 0.0;
        away == (culled == CulledFaces::Back)
    }

    /// How much of the light passes along a ray: 0 or 1, or between where surfaces are partly there.
    #[inline]
    pub fn transmittance(&self, mut ray: Ray, rays: &mut u64) -> f32 {
        *rays += 1;
        if !self.partly_present {
            return if self.top.any_hit(&ray) { 0.0 } else { 1.0 };
        }
        let mut through = 1.0;
        for _ in 0..MAX_PASSES {
            let Some(hit) = self.top.closest_hit(&ray) else { return through };
            through *= 1.0 - surface::presence(self, &hit);
            if through <= 0.0 {
                return 0.0;
            }
            *rays += 1;
            ray.t_min = hit.t;
        }
        0.0
    }

    /// How much passes from one surface to another along a straight line: 0 or 1, or between where surfaces are partly
    /// there. Shapes of lights that reach `from` stand in the way. Counts rays.
    pub fn visibility(&self, from: &surface::SurfaceInteraction, to: &SurfacePoint, rays: &mut u64) -> f32 {
        let direction = (to.point - from.at.point).normalized();
        let start = from.at.spawn_ray(direction).origin;
        let end = to.spawn_ray(-direction).origin;
        let along = end - start;
        let distance = along.length();
        let ray = Ray { t_max: distance * (1.0 - 4.0 * f32::EPSILON), ..Ray::new(start, along * (1.0 / distance)) };
        if self.light_on(&ray, Some(from.links)).is_some() { 0.0 } else { self.transmittance(ray, rays) }
    }

    /// Calls `meet` with the distance and the presence of each surface on a ray, the nearest first, until it says
    /// that it has seen enough; of those that cast shadows in a light. Counts rays.
    pub fn occluders(&self, mut ray: Ray, light: u32, rays: &mut u64, mut meet: impl FnMut(f32, f32) -> bool) {
        for _ in 0..MAX_PASSES {
            *rays += 1;
            let Some(hit) = self.top.closest_hit(&ray) else { return };
            let presence = || if self.partly_present { surface::presence(self, &hit) } else { 1.0 };
            if self.casts_shadow(&hit, light) && !meet(hit.t, presence()) {
                return;
            }
            ray.t_min = hit.t;
        }
    }

    /// The number of the instance at a hit, as Hydra counts: the innermost instancer's number runs fastest.
    pub fn instance_id(&self, hit: &Hit) -> i32 {
        let levels = 0..hit.path.as_slice().len();
        let tags = levels.filter_map(|level| self.top.instance_at(&hit.path, level)).map(|i| i.tag);
        tags.map(|tag| self.numbers[tag as usize]).fold(0u32, |id, n| id.wrapping_mul(n.count).wrapping_add(n.position))
            as i32
    }
}
