//! Rays through the edges and vertices of closed meshes.
//!
//! Rays from inside *leak* where they meet nothing. Rays from outside are walked from crossing to crossing as the
//! renderer passes through what is not there: on from a hit, only hits at a larger parameter count. They must enter
//! and leave in turn. A *double hit* is a crossing that goes the same way as the one before it: two triangles met
//! where there is one surface. A *leak* is a walk that does not begin by entering or does not end by leaving.

use umber_bvh::InstanceBvh;
use umber_math::{Ray, Vec3};

use super::{
    shapes::{Mesh, ray_to},
    tally,
    textbook::moeller_trumbore,
};
use crate::random::Random;

/// What became of rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Rays.
    pub rays: u64,
    /// Rays that passed through the surface without meeting it.
    pub leaks: u64,
    /// Rays that met the surface twice in one place.
    pub doubles: u64,
}

/// The insides of a mesh, from where rays go and through which they go.
#[derive(Clone, Copy)]
pub struct Inside {
    /// The middle.
    pub center: Vec3,
    /// Half-widths of the box around it.
    pub half: Vec3,
}

impl Inside {
    fn point(&self, random: &mut Random) -> Vec3 {
        self.center + random.cube() * self.half
    }
}

/// A vertex one time in four, else a point of an edge.
fn target(mesh: &Mesh, random: &mut Random, case: usize) -> Vec3 {
    let corners = mesh.corners(random.below(mesh.triangles.len()));
    if case.is_multiple_of(4) { corners[0].0 } else { random.point_of(corners, true) }
}

/// Rays from inside; `hit` tells whether a ray meets the mesh. No double hits are looked for.
pub fn from_inside(mesh: &Mesh, inside: Inside, count: usize, hit: impl Fn(&Ray) -> bool + Sync) -> Counts {
    let [leaks] = tally(count, 0x1dea_5eed, |random, i| {
        let target = target(mesh, random, i);
        [u64::from(!hit(&ray_to(inside.point(random), target)))]
    });
    Counts { rays: count as u64, leaks, doubles: 0 }
}

/// Rays from outside, through an edge or vertex towards the inside; `crossings` gives whether each crossing of a
/// ray, in their order, enters.
pub fn from_outside(
    mesh: &Mesh,
    inside: Inside,
    count: usize,
    crossings: impl Fn(&Ray, &mut Vec<bool>) + Sync,
) -> Counts {
    let [leaks, doubles] = tally(count, 0x0075_1de5, |random, i| {
        let target = target(mesh, random, i);
        let out = target - inside.point(random);
        let mut enters = Vec::new();
        crossings(&ray_to(target + out * 2.0, target), &mut enters);
        let doubled = enters.windows(2).any(|pair| pair[0] == pair[1]);
        let closed = enters.first() == Some(&true) && enters.last() == Some(&false);
        [u64::from(!closed), u64::from(doubled)]
    });
    Counts { rays: count as u64, leaks, doubles }
}

fn enters(mesh: &Mesh, triangle: usize, ray: &Ray) -> bool {
    let [a, b, c] = mesh.corners(triangle).map(|p| p.0.as_dvec3());
    (b - a).cross(c - a).dot(ray.direction.0.as_dvec3()) < 0.0
}

/// The crossings of a ray by closest hits.
pub fn walk(mesh: &Mesh, scene: &InstanceBvh, ray: &Ray, crossings: &mut Vec<bool>) {
    let mut ray = *ray;
    while let Some(hit) = scene.closest_hit(&ray) {
        crossings.push(enters(mesh, hit.triangle as usize, &ray));
        ray.t_min = hit.t;
    }
}

/// The crossings of a ray by the textbook's test of every triangle; those at one parameter are one.
pub fn textbook_walk(mesh: &Mesh, ray: &Ray, crossings: &mut Vec<bool>) {
    let met = (0..mesh.triangles.len()).filter_map(|i| Some((moeller_trumbore(mesh.corners(i), ray)?, i)));
    let mut met: Vec<(f32, usize)> = met.collect();
    met.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    met.dedup_by_key(|m| m.0);
    crossings.extend(met.iter().map(|&(_, i)| enters(mesh, i, ray)));
}

/// Whether the textbook's test of every triangle finds a hit.
pub fn textbook_hit(mesh: &Mesh, ray: &Ray) -> bool {
    (0..mesh.triangles.len()).any(|i| moeller_trumbore(mesh.corners(i), ray).is_some())
}
