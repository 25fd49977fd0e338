//! A box test may never lose a triangle that the triangle test would find.

use umber_bench::stability::{boxes, shapes};
use umber_math::{Point3, Ray, Vec3, Vector3};

use crate::rays;

#[test]
fn no_triangle_is_lost_to_its_box() {
    let mut lost_by_slabs = 0;
    for distance in [0.0, 10.0, 1e3, 1e5, 1e7] {
        let counts = boxes::at(distance, rays(100_000));
        println!("distance {distance:e}: {counts:?}");
        assert_eq!(counts.lost, 0, "distance {distance:e}");
        lost_by_slabs += counts.textbook_lost;
    }
    assert!(lost_by_slabs > 0, "plain slabs lost none");
}

#[test]
fn rays_in_the_plane_of_a_box_side_are_kept() {
    let scene = shapes::cube().scene();
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
