//! A box test may never lose a triangle that the triangle test would find.

use umber_math::{Bounds3, Point3, Ray, Vec3, Vector3};

use crate::meshes::{Random, ray_to};
use crate::rays;
use crate::textbook::slabs;
use umber_geometry::watertight::ShearedRay;

/// A triangle whose box is flat or nearly so, somewhere at this distance, and a ray at it.
fn case(distance: f32, random: &mut Random) -> ([Point3; 3], Ray) {
    let center = random.direction() * distance;
    let flat = [Vec3::new(1.0, 1.0, 0.0), Vec3::new(0.0, 1.0, 1.0), Vec3::new(1.0, 1e-4, 1.0)][random.below(3)];
    let corners = [0; 3].map(|_| Point3(center + random.cube() * flat));
    let target = random.point_of(corners, true);
    (corners, ray_to(center + random.direction() * 3.0, target))
}

#[test]
fn no_triangle_is_lost_to_its_box() {
    let count = rays(200_000);
    let mut lost_in_all = 0;
    for distance in [0.0, 10.0, 1e3, 1e5] {
        let mut random = Random(0x5ca1_ab1e_0ddb_a115);
        let (mut found, mut lost_by_slabs, mut lost) = (0, 0, 0);
        // The hierarchy of two triangles has a node with two boxes.
        for _ in 0..count / 100 {
            let cases: Vec<_> = (0..100).map(|_| case(distance, &mut random)).collect();
            let mesh = crate::meshes::Mesh {
                points: cases.iter().flat_map(|c| c.0).collect(),
                triangles: (0..100).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
            };
            let scene = mesh.scene();
            for (corners, ray) in &cases {
                let [a, b, c] = *corners;
                let hit = ShearedRay::new(ray).and_then(|r| r.intersect(a, b, c, 0.0, f32::INFINITY));
                if hit.is_none() {
                    continue;
                }
                found += 1;
                lost_by_slabs += usize::from(!slabs(&Bounds3::of_points(*corners), ray));
                lost += usize::from(!scene.any_hit(ray));
            }
        }
        println!("distance {distance:e}: of {found} hits the hierarchy loses {lost}, plain slabs {lost_by_slabs}");
        assert_eq!(lost, 0, "distance {distance:e}");
        lost_in_all += lost_by_slabs;
    }
    assert!(lost_in_all > 0, "plain slabs lost none");
}

#[test]
fn rays_in_the_plane_of_a_box_side_are_kept() {
    let mesh = crate::meshes::cube();
    let scene = mesh.scene();
    // Along the sides, where zero times infinity is met.
    for axis in 0..3 {
        for side in [-1.0f32, 1.0] {
            let (mut from, mut along) = (Vec3::splat(0.25), Vec3::ZERO);
            from[axis] = side;
            along[(axis + 1) % 3] = 1.0;
            let ray = Ray::new(Point3(from), Vector3(along));
            assert!(scene.any_hit(&ray), "{ray:?}");
        }
    }
}
