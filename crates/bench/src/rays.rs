//! The rays: what a path tracer asks, kind by kind.

use umber_geometry::geometric_normal;
use umber_math::{Frame, Normal3, Point3, Ray, Vec3, Vector3};

use crate::{
    random::Random,
    scenes::{Mesh, Scene},
    tracer::UmberScene,
};

/// Rays of one kind.
pub struct RaySet {
    /// Its name.
    pub name: &'static str,
    /// Whether any hit will do.
    pub any: bool,
    /// The rays, in the order in which they are asked.
    pub rays: Vec<Ray>,
}

/// How far secondary rays start before the surface, as a part of the way to it.
const STEP_BACK: f32 = 1e-4;
/// Size of the light, and its height above the camera, as a part of the distance to what that looks at.
const LIGHT: f32 = 0.3;

/// About `count` rays of each kind: from the camera through pixels in rows; from what these hit, by
/// the cosine of the angle; from there to an area light near the camera; and between random points
/// of the scene's box.
pub fn sets(scene: &Scene, umber: &UmberScene, count: usize) -> Vec<RaySet> {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let primary = primary(scene, count);
    let light = scene.eye + Vec3::Y * (scene.target - scene.eye).length() * LIGHT;
    let size = (scene.target - scene.eye).length() * LIGHT;
    let (mut diffuse, mut shadow) = (Vec::new(), Vec::new());
    for ray in &primary {
        let Some(hit) = umber.top.closest_hit(ray) else { continue };
        let to_render = umber.top.render_from_object(&hit.path);
        let local = normal(&scene.meshes[hit.mesh as usize], hit.triangle);
        let n = to_render.normal(local).normalized().facing(-ray.direction);
        let from = ray.at(hit.t * (1.0 - STEP_BACK));
        let cosine = (random.direction() + Vec3::Z).normalize_or(Vec3::Z);
        diffuse.push(Ray::new(from, Frame::from_normal(n).from_local(Vector3(cosine))));
        let to = Point3(light + random.cube() * size);
        shadow.push(Ray { t_max: 1.0, ..Ray::new(from, to - from) });
    }
    vec![
        RaySet { name: "primary", any: false, rays: primary },
        RaySet { name: "diffuse", any: false, rays: diffuse },
        RaySet { name: "any hit", any: true, rays: shadow },
        RaySet { name: "incoherent", any: false, rays: incoherent(scene, count, &mut random) },
    ]
}

fn primary(scene: &Scene, count: usize) -> Vec<Ray> {
    let side = (count as f32).sqrt() as usize;
    let toward = (scene.target - scene.eye).normalize_or(Vec3::NEG_Z);
    let right = toward.cross(Vec3::Y).normalize_or(Vec3::X);
    let up = right.cross(toward);
    let pixel = |i: usize| {
        let at = |k: usize| (k as f32 + 0.5) / side as f32 - 0.5;
        let direction = toward + right * (scene.width * at(i % side)) - up * (scene.width * at(i / side));
        Ray::new(Point3(scene.eye), Vector3(direction.normalize()))
    };
    (0..side * side).map(pixel).collect()
}

fn incoherent(scene: &Scene, count: usize, random: &mut Random) -> Vec<Ray> {
    let bounds = scene.bounds();
    let (center, half) = (bounds.center().0, bounds.size() * 0.5);
    let ray = |_| Ray::new(Point3(center + random.cube() * half), Vector3(random.direction()));
    (0..count).map(ray).collect()
}

fn normal(mesh: &Mesh, triangle: u32) -> Normal3 {
    let [a, b, c] = mesh.triangles[triangle as usize].map(|i| mesh.points[i as usize]);
    geometric_normal(a, b, c)
}
