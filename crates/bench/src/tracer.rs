//! What is measured: anything that answers single rays.

use std::sync::Arc;

use umber_bvh::{Child, Instance, InstanceBvh, MeshBvh};
use umber_math::Ray;

use crate::scenes::Scene;

/// Answers rays, one at a time.
pub trait Tracer {
    /// How many rays hit something, by closest-hit queries.
    fn count_closest(&self, rays: &[Ray]) -> usize;
    /// How many rays hit something, by any-hit queries.
    fn count_any(&self, rays: &[Ray]) -> usize;
    /// Parameter of the closest hit.
    fn closest(&self, ray: &Ray) -> Option<f32>;
    /// Whether anything is hit.
    fn any(&self, ray: &Ray) -> bool;
}

/// Our own hierarchy, two levels as the renderer uses it: a flat scene is one instance at the identity.
pub struct UmberScene {
    /// The top level.
    pub top: InstanceBvh,
    meshes: Vec<Arc<MeshBvh>>,
}

impl UmberScene {
    /// Builds it, on the threads of the rayon pool that this runs in.
    pub fn build(scene: &Scene) -> Self {
        let meshes: Vec<_> = scene.meshes.iter().map(|m| Arc::new(MeshBvh::build(&m.points, &m.triangles))).collect();
        let place = |i: &crate::scenes::Placement| Instance {
            child: Child::Mesh { bvh: meshes[i.mesh].clone(), mesh: i.mesh as u32 },
            parent_from_child: i.transform,
            tag: 0,
        };
        let top = InstanceBvh::build(scene.instances.iter().map(place).collect());
        Self { top, meshes }
    }

    /// What the hierarchies take, in bytes, without points and indices.
    pub fn hierarchy_bytes(&self) -> usize {
        self.top.memory_bytes() + self.meshes.iter().map(|m| m.memory_bytes()).sum::<usize>()
    }
}

impl Tracer for UmberScene {
    fn count_closest(&self, rays: &[Ray]) -> usize {
        rays.iter().filter(|r| self.top.closest_hit(r).is_some()).count()
    }
    fn count_any(&self, rays: &[Ray]) -> usize {
        rays.iter().filter(|r| self.top.any_hit(r)).count()
    }
    fn closest(&self, ray: &Ray) -> Option<f32> {
        self.top.closest_hit(ray).map(|h| h.t)
    }
    fn any(&self, ray: &Ray) -> bool {
        self.top.any_hit(ray)
    }
}
