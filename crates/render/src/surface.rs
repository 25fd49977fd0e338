//! A surface where a ray met it.

use umber_bvh::Hit;
use umber_geometry::{geometric_normal, watertight::hit_point};
use umber_math::float::{gamma, offset_ray_origin};
use umber_math::{Frame, Normal3, Point3, Ray, Rgb, Vec2, Vec3, Vector3};
use umber_shading::{Bsdf, Lobes};

use crate::mesh::RenderMesh;
use crate::scene::RenderScene;

/// Albedo where neither a material is bound nor a displayColor authored (UsdPreviewSurface's fallback).
const FALLBACK_COLOR: Vec3 = Vec3::splat(0.18);

/// An evaluated hit: everything in render space unless it says otherwise.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceInteraction {
    /// The point, to within `error` in each axis.
    pub point: Point3,
    /// Bound of the point's rounding error.
    pub error: Vec3,
    /// Unit normal of the triangle, on the side that its winding names.
    pub geometric_normal: Normal3,
    /// Unit interpolated normal, on the geometric normal's side.
    pub shading_normal: Normal3,
    /// Emitted radiance.
    pub emission: Rgb,
    lobes: Lobes,
}

impl SurfaceInteraction {
    /// Evaluates a hit.
    pub fn new(scene: &RenderScene, hit: &Hit) -> Self {
        let mesh = &scene.meshes[hit.mesh as usize];
        let render_from_object = scene.top.render_from_object(&hit.path);
        let [p0, p1, p2] = mesh.shape.triangle(hit.triangle);
        let (point_object, error_object) = hit_point(p0, p1, p2, hit.barycentrics);
        let point = render_from_object.point(point_object);
        let error = point_error(&render_from_object, point_object, error_object, point);

        let to_render = |n: Normal3| render_from_object.normal(n).normalized();
        let geometric = to_render(geometric_normal(p0, p1, p2));
        let geometric = if render_from_object.flips_handedness() { -geometric } else { geometric };
        let shading = match &mesh.attributes.normals {
            Some(normals) => {
                let n = to_render(Normal3(normals.eval(&mesh.shape.mesh, hit.triangle, hit.barycentrics)));
                if n.0 == Vec3::ZERO { geometric } else { n.facing(geometric.as_vector()) }
            }
            None => geometric,
        };
        let material = scene.materials.get(mesh.material_of(hit.triangle) as usize);
        let lobes = material.and_then(|m| m.lobes).unwrap_or_else(|| Lobes::lambert(display_color(mesh, hit)));
        Self {
            point,
            error,
            geometric_normal: geometric,
            shading_normal: shading,
            emission: material.map_or(Rgb::BLACK, |m| m.emission),
            lobes,
        }
    }

    /// Its reflection towards `wo`, unit.
    pub fn bsdf(&self, wo: Vector3) -> Bsdf {
        let geometric = self.geometric_normal.facing(wo);
        let shading = self.shading_normal.facing(geometric.as_vector());
        Bsdf::new(self.lobes, Frame::from_normal(shading), geometric)
    }

    /// A ray that leaves the surface.
    pub fn spawn_ray(&self, direction: Vector3) -> Ray {
        Ray::new(offset_ray_origin(self.point, self.error, self.geometric_normal, direction), direction)
    }
}

/// Bound of the error of a point brought to render space, and of rays that start there when they are
/// taken back to object space (pbrt-v4 section 6.8.4).
fn point_error(t: &umber_math::Transform, p_object: Point3, error_object: Vec3, p: Point3) -> Vec3 {
    let (forward, inverse) = (t.forward(), t.inverse());
    if *forward == glam::Affine3A::IDENTITY {
        return error_object;
    }
    let magnitude = |m: &glam::Affine3A, v: Vec3| {
        let [x, y, z] = [m.matrix3.x_axis, m.matrix3.y_axis, m.matrix3.z_axis].map(|a| Vec3::from(a.abs()));
        x * v.x + y * v.y + z * v.z
    };
    let translated = |m: &glam::Affine3A, v: Vec3| magnitude(m, v.abs()) + Vec3::from(m.translation.abs());
    let there = translated(forward, p_object.0) * gamma(4);
    let and_back = translated(inverse, p.0) * gamma(4);
    there + magnitude(forward, error_object + and_back)
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
