//! Triangles behind box tests.

use umber_geometry::watertight::ShearedRay;
use umber_math::{Bounds3, Point3, Ray, Vec3};

use super::{
    shapes::{Mesh, ray_to},
    tally,
    textbook::slabs,
};
use crate::random::Random;

/// Hits of the triangle test, and those lost to box tests before it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    /// Hits.
    pub hits: u64,
    /// Not found through Umber's hierarchy.
    pub lost: u64,
    /// Whose triangle's box is missed by plain slabs.
    pub textbook_lost: u64,
}

/// Triangles of a hierarchy.
const TOGETHER: usize = 100;

/// A triangle whose box is flat or nearly so, somewhere at this distance, and a ray at it.
fn case(distance: f32, random: &mut Random) -> ([Point3; 3], Ray) {
    let center = random.direction() * distance;
    let flat = [Vec3::new(1.0, 1.0, 0.0), Vec3::new(0.0, 1.0, 1.0), Vec3::new(1.0, 1e-4, 1.0)][random.below(3)];
    let corners = [0; 3].map(|_| Point3(center + random.cube() * flat));
    let target = random.point_of(corners, true);
    (corners, ray_to(center + random.direction() * 3.0, target))
}

/// Flat triangles of one unit at a distance from the origin, in units, and about `count` rays at their edges.
pub fn at(distance: f32, count: usize) -> Counts {
    let [hits, lost, textbook_lost] = tally(count.div_ceil(TOGETHER), 0x5ca1_ab1e, |random, _| {
        let cases: Vec<_> = (0..TOGETHER).map(|_| case(distance, random)).collect();
        let scene = Mesh {
            points: cases.iter().flat_map(|c| c.0).collect(),
            triangles: (0..TOGETHER as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        }
        .scene();
        let mut counts = [0; 3];
        for (corners, ray) in &cases {
            let [a, b, c] = *corners;
            if ShearedRay::new(ray).and_then(|r| r.intersect(a, b, c, 0.0, f32::INFINITY)).is_some() {
                counts[0] += 1;
                counts[1] += u64::from(!scene.any_hit(ray));
                counts[2] += u64::from(!slabs(&Bounds3::of_points(*corners), ray));
            }
        }
        counts
    });
    Counts { hits, lost, textbook_lost }
}
