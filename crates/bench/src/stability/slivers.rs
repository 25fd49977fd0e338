//! Triangles that get ever thinner.

use umber_geometry::watertight::ShearedRay;
use umber_math::{Point3, Ray, Vec3};

use super::{
    closed::{self, Counts as Closed, Inside},
    shapes::{Mesh, icosphere, ray_to},
    tally,
    textbook::moeller_trumbore,
};

/// Rays that go through the inside of slivers, as double precision has it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    /// Rays.
    pub rays: u64,
    /// Rays that missed, by Umber's test.
    pub missed: u64,
    /// Rays that missed, by the textbook's test.
    pub textbook_missed: u64,
}

/// How far inside a ray has to pass, in parts of the triangle.
const INSIDE: f64 = 0.05;

/// Whether a ray passes well inside of a triangle, by volumes in double precision.
fn is_inside([a, b, c]: [Point3; 3], ray: &Ray) -> bool {
    let origin = ray.origin.0.as_dvec3();
    let [a, b, c] = [a, b, c].map(|p| p.0.as_dvec3() - origin);
    let d = ray.direction.0.as_dvec3();
    let volumes = [b.cross(c).dot(d), c.cross(a).dot(d), a.cross(b).dot(d)];
    let sum: f64 = volumes.iter().sum();
    sum != 0.0 && volumes.iter().all(|v| v / sum > INSIDE)
}

/// Triangles one unit long and `1 / ratio` high, at the origin, turned at random, seen from ten units away.
pub fn at(ratio: f32, count: usize) -> Counts {
    let [rays, missed, textbook_missed] = tally(count, 0x0511_7e75, |random, _| {
        let along = random.direction();
        let up = along.cross(random.direction()).normalize_or(along.any_orthonormal_vector());
        let tip = along * (random.float() - 0.5) + up / ratio;
        let corners = [along * -0.5, along * 0.5, tip].map(Point3);
        let target = (corners[0].0 + corners[1].0 + corners[2].0) / 3.0;
        let normal = along.cross(up);
        let ray = ray_to(target + (normal + random.cube() * 0.5) * 10.0, target);
        if !is_inside(corners, &ray) {
            return [0; 3]; // rounding moved the ray or a corner
        }
        let [a, b, c] = corners;
        let ours = ShearedRay::new(&ray).and_then(|r| r.intersect(a, b, c, 0.0, f32::INFINITY));
        [1, u64::from(ours.is_none()), u64::from(moeller_trumbore(corners, &ray).is_none())]
    });
    Counts { rays, missed, textbook_missed }
}

/// A closed sphere, flattened so that its width is `ratio` times its height: rays through edges and vertices that
/// leak, by Umber's method and by the textbook's.
pub fn closed(ratio: f32, count: usize) -> [Closed; 2] {
    let flat = Vec3::new(1.0, 1.0, 1.0 / ratio);
    let mesh: Mesh = icosphere(2).map(|p| p * flat);
    let (scene, inside) = (mesh.scene(), Inside { center: Vec3::ZERO, half: flat * 0.3 });
    [
        closed::from_inside(&mesh, inside, count, |r| scene.closest_hit(r).is_some()),
        closed::from_inside(&mesh, inside, count, |r| closed::textbook_hit(&mesh, r)),
    ]
}
