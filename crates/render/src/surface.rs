//! A surface where a ray met it.

use std::iter;

use umber_bvh::{Hit, Placement};
use umber_geometry::{SurfacePoint, surface_point};
use umber_math::{Frame, Normal3, Rgb, Vec2, Vec3, Vector3};
use umber_shading::{Bsdf, Lobes};

use crate::linking::Links;
use crate::mesh::RenderMesh;
use crate::scene::RenderScene;

/// Albedo where neither a material is bound nor a displayColor authored (UsdPreviewSurface's fallback).
pub(crate) const FALLBACK_COLOR: Vec3 = Vec3::splat(0.18);

/// An evaluated hit: everything in render space unless it says otherwise.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceInteraction {
    /// Where, with the triangle's normal; rays leave from it.
    pub at: SurfacePoint,
    /// Unit interpolated normal, on the geometric normal's side.
    pub shading_normal: Normal3,
    /// Emitted radiance.
    pub emission: Rgb,
    /// Which lights reach it.
    pub links: Links,
    lobes: Lobes,
}

impl SurfaceInteraction {
    /// Evaluates a hit.
    pub fn new(scene: &RenderScene, hit: &Hit) -> Self {
        let mesh = &scene.meshes[hit.mesh as usize];
        let (triangle, top) = (mesh.shape.triangle(hit.triangle), &scene.top);
        let placement = top.placement(&hit.path);
        let at = match placement {
            Placement::AsItIs => surface_point(triangle, hit.barycentrics, iter::empty()),
            Placement::Once { exact, .. } => surface_point(triangle, hit.barycentrics, iter::once(exact)),
            Placement::Nested => surface_point(triangle, hit.barycentrics, top.transforms(&hit.path)),
        };
        let geometric = at.normal;
        let shading = match &mesh.attributes.normals {
            Some(normals) => {
                let n = Normal3(normals.eval(&mesh.shape.mesh, hit.triangle, hit.barycentrics));
                let n = match placement {
                    Placement::AsItIs => n,
                    Placement::Once { rounded, .. } => rounded.normal(n),
                    Placement::Nested => top.render_from_object(&hit.path).normal(n),
                };
                let n = n.normalized();
                if n.0 == Vec3::ZERO { geometric } else { n.facing(geometric.as_vector()) }
            }
            None => geometric,
        };
        let material = scene.materials.get(mesh.material_of(hit.triangle) as usize);
        let lobes = material.and_then(|m| m.lobes).unwrap_or_else(|| Lobes::lambert(display_color(mesh, hit)));
        let (emission, links) = (material.map_or(Rgb::BLACK, |m| m.emission), scene.links_at(hit));
        Self { at, shading_normal: shading, emission, links, lobes }
    }

    /// Its reflection towards `wo`, unit.
    pub fn bsdf(&self, wo: Vector3) -> Bsdf {
        let geometric = self.at.normal.facing(wo);
        let shading = self.shading_normal.facing(geometric.as_vector());
        Bsdf::new(self.lobes, Frame::from_normal(shading), geometric)
    }
}

fn display_color(mesh: &RenderMesh, hit: &Hit) -> Rgb {
    let color = mesh.attributes.display_color.as_ref();
    Rgb(color.map_or(FALLBACK_COLOR, |c| c.eval(&mesh.shape.mesh, hit.triangle, hit.barycentrics)))
}

/// Probability that a ray meets the surface at a hit instead of passing through.
pub fn presence(scene: &RenderScene, hit: &Hit) -> f32 {
    let mesh = &scene.meshes[hit.mesh as usize];
    match scene.materials.get(mesh.material_of(hit.triangle) as usize) {
        Some(material) if material.lobes.is_some() => material.presence,
        _ => {
            let opacity = mesh.attributes.display_opacity.as_ref();
            let opacity = opacity.map_or(1.0, |o| o.eval(&mesh.shape.mesh, hit.triangle, hit.barycentrics));
            if opacity.is_nan() { 0.0 } else { opacity.clamp(0.0, 1.0) }
        }
    }
}

/// Texture coordinates at a hit; zero where the mesh has none.
pub fn st(scene: &RenderScene, hit: &Hit) -> Vec2 {
    let mesh = &scene.meshes[hit.mesh as usize];
    let st = mesh.attributes.st.as_ref();
    st.map_or(Vec2::ZERO, |st| st.eval(&mesh.shape.mesh, hit.triangle, hit.barycentrics))
}
