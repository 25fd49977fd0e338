//! Rays that leave surfaces: which meet what they left, and which pass over what is near.
//!
//! Umber's leave as the renderer lets them, by [`SurfacePoint`](umber_geometry::SurfacePoint).

use umber_math::{DAffine3, DVec3, Normal3, Point3, Vec3, Vector3};

use super::{
    placed::Placed,
    shapes::{Mesh, ray_to},
    tally,
    textbook::{moeller_trumbore, spawn},
};
use crate::random::Random;

/// What became of rays that left a surface.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    /// Rays.
    pub rays: u64,
    /// Rays that met the triangle that they left.
    pub own: u64,
    /// Rays that failed otherwise: met another triangle where none is, or nothing where one is.
    pub wrong: u64,
    /// Rays that met the triangle that they left, or passed over one that is near, by a fixed offset and the
    /// textbook's test of triangles.
    pub textbook: u64,
}

/// Where this many spacings of the numbers fit into a mesh, it has a shape.
const RESOLUTION: f64 = 1000.0;

/// Whether a placed mesh has a shape: the numbers where it stands are close enough.
pub fn is_resolved(placed: &Placed) -> bool {
    f64::from(placed.radius()) > RESOLUTION * placed.spacing(placed.mesh.points[0].0.as_dvec3())
}

/// Whether a placed mesh also has an inside: not so where it is flat.
pub fn has_inside(placed: &Placed) -> bool {
    placed.thickness() > RESOLUTION * placed.spacing(placed.mesh.points[0].0.as_dvec3())
}

/// The unit normal of a triangle on the side of a vector, in double precision.
fn normal([a, b, c]: [DVec3; 3], toward: DVec3) -> DVec3 {
    let n = (b - a).cross(c - a).normalize_or_zero();
    if n.dot(toward) < 0.0 { -n } else { n }
}

/// A unit vector at least 10⁻⁴ to this side of a plane; one in four at a grazing angle.
fn leaving(n: Vec3, random: &mut Random) -> Vec3 {
    let grazing = if random.below(4) == 0 { 1e-2 } else { 1.0 };
    let d = random.direction();
    let (height, along) = (d.dot(n), d - n * d.dot(n));
    (along + n * height.abs().max(1e-2) * grazing).normalize()
}

/// Rays that meet a closed convex mesh from outside and leave it outwards: they meet nothing again.
pub fn outwards(placed: &Placed, count: usize) -> Counts {
    let (center, radius) = (placed.center(), placed.radius());
    let [rays, own, wrong, textbook] = tally(count, 0x0dd_ba11, |random, i| {
        let corners = placed.flattened(random.below(placed.mesh.triangles.len()));
        let target = random.point_of(corners, i.is_multiple_of(3));
        let first = ray_to(center.as_vec3() + random.direction() * radius * 4.0, target);
        let Some(hit) = placed.scene.closest_hit(&first) else { return [0; 4] };
        let corners = placed.corners(hit.triangle as usize);
        let n = normal(corners, -first.direction.0.as_dvec3());
        // At a silhouette edge the triangle behind it may be met, from inside.
        if n.dot(corners[0] - center) < 0.0 {
            return [0; 4];
        }
        let direction = Vector3(leaving(n.as_vec3(), random));
        let second = placed.scene.closest_hit(&placed.surface_point(&hit).spawn_ray(direction));
        let own = second.is_some_and(|s| s.triangle == hit.triangle);
        let fixed = spawn(&first, hit.t, Normal3(n.as_vec3()), direction);
        let textbook = moeller_trumbore(placed.flattened(hit.triangle as usize), &fixed).is_some();
        [1, u64::from(own), u64::from(second.is_some() && !own), u64::from(textbook)]
    });
    Counts { rays, own, wrong, textbook }
}

/// Rays that meet a closed convex mesh from inside, half of them at an edge, and go on inside: they meet it again.
pub fn inwards(placed: &Placed, half: Vec3, count: usize) -> Counts {
    let [rays, own, wrong] = tally(count, 0x00c0_ffee, |random, i| {
        let from = placed.render((random.cube() * half * 0.3).as_dvec3() + middle(&placed.mesh)).as_vec3();
        let corners = placed.flattened(random.below(placed.mesh.triangles.len()));
        let first = ray_to(from, random.point_of(corners, i.is_multiple_of(2)));
        let Some(hit) = placed.scene.closest_hit(&first) else { return [1, 0, 1] };
        let n = normal(placed.corners(hit.triangle as usize), -first.direction.0.as_dvec3());
        let direction = Vector3(leaving(n.as_vec3(), random));
        match placed.scene.closest_hit(&placed.surface_point(&hit).spawn_ray(direction)) {
            None => [1, 0, 1],
            Some(second) => [1, u64::from(second.triangle == hit.triangle), 0],
        }
    });
    Counts { rays, own, wrong, textbook: 0 }
}

fn middle(mesh: &Mesh) -> DVec3 {
    mesh.bounds().center().0.as_dvec3()
}

/// How many spacings of the numbers a near surface is away.
pub const NEAR: f64 = 4.0;
/// The part of the floor, about its middle, that rays leave.
const NEAR_CENTER: f32 = 0.01;

/// Rays that leave a floor of half-width one, seen from above, and meet a lid over it that is [`NEAR`] spacings of
/// the numbers away. Both stand at `center` in object space, a place that moves no corner; the transforms place them.
pub fn near_lid(transforms: &[DAffine3], center: Vec3, count: usize) -> Option<Counts> {
    let square = |y: f32, s: f32| {
        let corner = |x: f32, z: f32| Point3(Vec3::new(center.x + x * s, y, center.z + z * s));
        [corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 0.0)]
    };
    let floor = Mesh { points: square(center.y, 1.0).to_vec(), triangles: vec![[0, 1, 2]] };
    let below = Placed::new(floor.clone(), transforms);
    if !is_resolved(&below) {
        return None;
    }
    let gap = NEAR * below.spacing((center + NEAR_CENTER).as_dvec3());
    let lid = square((f64::from(center.y) + gap / below.height(DVec3::Y)) as f32, 2.0);
    let both = floor.points.iter().copied().chain(lid).collect();
    let both = Placed::new(Mesh { points: both, triangles: vec![[0, 1, 2], [3, 4, 5]] }, transforms);
    let up = normal(below.corners(0), below.render(DVec3::Y) - below.render(DVec3::ZERO)).as_vec3();
    let radius = below.radius();
    let [rays, own, wrong, textbook] = tally(count, 0x5caf_f01d, |random, _| {
        let near = center + (random.point_of(below.mesh.corners(0), false) - center) * NEAR_CENTER;
        let target = below.render(near.as_dvec3()).as_vec3();
        let first = ray_to(target + (up + random.cube() * 0.1) * radius, target);
        let Some(hit) = below.scene.closest_hit(&first) else { return [0; 4] };
        let direction = Vector3((up + random.direction() * 0.5).normalize());
        let second = both.scene.closest_hit(&below.surface_point(&hit).spawn_ray(direction));
        let own = second.is_some_and(|s| s.triangle == 0);
        let fixed = spawn(&first, hit.t, Normal3(up), direction);
        let textbook = moeller_trumbore(both.flattened(1), &fixed).is_none();
        [1, u64::from(own), u64::from(second.is_none()), u64::from(textbook)]
    });
    Some(Counts { rays, own, wrong, textbook })
}
