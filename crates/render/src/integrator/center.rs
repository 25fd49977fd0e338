//! What is seen through the middle of a pixel, for AOVs that have no mean.

use umber_bvh::Hit;
use umber_math::{Normal3, Vec2, Vector3};

use crate::camera::Depths;
use crate::film::CenterHit;
use crate::scene::RenderScene;
use crate::surface::{self, SurfaceInteraction};

/// Traces the ray through the middle of a film pixel. Surfaces that are more than half there count.
pub fn trace(scene: &RenderScene, pixel: [usize; 2], rays: &mut u64) -> Option<CenterHit> {
    let ray = scene.camera.ray(Vec2::new(pixel[0] as f32 + 0.5, pixel[1] as f32 + 0.5));
    let hit = scene.camera_hit(ray, rays, |_| 0.5)?;
    let surface = SurfaceInteraction::new(scene, &hit);
    Some(seen(scene, &hit, scene.camera.depths(surface.at.point), surface.shading_normal, ray.direction))
}

/// What AOVs keep of a hit of the view ray along `direction`, with its depths and its unit shading normal.
pub fn seen(scene: &RenderScene, hit: &Hit, depths: Depths, normal: Normal3, direction: Vector3) -> CenterHit {
    let mesh = &scene.meshes[hit.mesh as usize];
    // USD's tools show normals towards the viewer
    let normal = normal.facing(-direction);
    CenterHit {
        depth: depths.projected,
        camera_depth: depths.camera,
        // render space is world space, moved
        normal: normal.0.to_array(),
        neye: scene.camera.eye_normal(normal).0.to_array(),
        prim_id: mesh.prim_id,
        instance_id: scene.instance_id(hit),
        element_id: mesh.shape.mesh.elements[hit.triangle as usize] as i32,
        st: surface::st(scene, hit).to_array(),
    }
}
