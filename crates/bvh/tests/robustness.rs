//! Input that makes no sense neither panics nor hangs; what is sound in it is still hit.

mod common;

use std::sync::Arc;

use common::{Mesh, Random, answer, icosphere, place, ray_to, soup};
use umber_bvh::{BoundsBvh, InstanceBvh, MeshBvh, SimdLevel};
use umber_math::{Bounds3, DAffine3, DVec3, Point3, Ray, Vec3, Vector3};

const STRANGE: [f32; 12] = [
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::MAX,
    f32::MIN,
    1e30,
    f32::MIN_POSITIVE,
    1e-45,
    -1e-40,
    0.0,
    -0.0,
    1.0,
];

fn strange(random: &mut Random) -> Vec3 {
    let mut pick = || STRANGE[random.below(STRANGE.len())];
    Vec3::new(pick(), pick(), pick())
}

#[test]
fn strange_rays_give_the_same_on_every_unit() {
    let mut random = Random(31);
    let scene = icosphere(3).scene();
    for _ in 0..20_000 {
        let origin = if random.float() < 0.5 { random.cube() } else { strange(&mut random) };
        let direction = if random.float() < 0.3 { random.direction() } else { strange(&mut random) };
        let mut ray = Ray::new(Point3(origin), Vector3(direction));
        if random.float() < 0.3 {
            (ray.t_min, ray.t_max) = (strange(&mut random).x, strange(&mut random).y);
        }
        let first = scene.closest_hit_on(SimdLevel::Portable, &ray);
        assert!(first.is_none_or(|h| h.t.is_finite()), "{ray:?} hits at {first:?}");
        for &level in SimdLevel::available() {
            assert_eq!(scene.closest_hit_on(level, &ray), first, "{level:?} {ray:?}");
            assert_eq!(scene.any_hit_on(level, &ray), first.is_some(), "{level:?} {ray:?}");
        }
        if !origin.is_finite() || !direction.is_finite() || direction == Vec3::ZERO {
            assert!(first.is_none());
        }
    }
}

#[test]
fn strange_points_leave_the_other_triangles_alone() {
    let mut random = Random(32);
    for _ in 0..50 {
        let mut mesh = icosphere(2);
        let sound = mesh.clone();
        for _ in 0..40 {
            let p = strange(&mut random);
            let at = mesh.points.len() as u32;
            mesh.points.push(Point3(p));
            mesh.triangles.push([at, random.below(at as usize) as u32, random.below(at as usize) as u32]);
        }
        mesh.triangles.push([0, 1, 1_000_000]);
        let built = MeshBvh::build(&mesh.points, &mesh.triangles);
        assert!(built.skipped() >= 1 && built.skipped() <= 41);
        assert_eq!(built.skipped() + built.triangle_count(), mesh.triangles.len());
        let scene = InstanceBvh::build(vec![place(&Arc::new(built), 0, DAffine3::IDENTITY)]);
        for _ in 0..50 {
            let ray = ray_to(random.cube() * 3.0, random.cube() * 0.2);
            let (Some((t, _)), Some(hit)) = (sound.brute_force(&ray), scene.closest_hit(&ray)) else {
                panic!("{ray:?} misses the sphere");
            };
            assert!(hit.t <= t, "{ray:?}");
        }
    }
}

#[test]
fn empty_scenes_are_missed() {
    let ray = ray_to(Vec3::ZERO, Vec3::ONE);
    let nothing = Mesh::default().scene();
    assert!(nothing.closest_hit(&ray).is_none() && !nothing.any_hit(&ray) && nothing.bounds().is_empty());
    let nothing = InstanceBvh::build(Vec::new());
    assert!(nothing.closest_hit(&ray).is_none() && nothing.instances().is_empty());
    BoundsBvh::build(&[Bounds3::EMPTY]).traverse(&ray, |_, _| panic!("an empty box was met"));
}

#[test]
fn triangles_that_grow_over_many_orders_of_magnitude_are_hit() {
    // One inside the other, from 10⁻²⁰ to 10⁶: their tree is deep, and their determinants underflow.
    let mut mesh = Mesh::default();
    for i in 0..3000u32 {
        let s = 1.02f32.powi(i as i32) * 1e-20;
        mesh.points.extend([Vec3::new(s, 0.0, s), Vec3::new(-s, s, s), Vec3::new(-s, -s, s)].map(Point3));
        mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    let scene = mesh.scene();
    for i in 0..100 {
        let tilt = i as f32 * 0.01 - 0.5;
        let ray =
            Ray { t_min: 1e-20 * (i as f32).exp2(), ..Ray::new(Point3::ZERO, Vector3::new(tilt, 0.1 * tilt, 1.0)) };
        assert_eq!(answer(scene.closest_hit(&ray)), mesh.brute_force(&ray));
    }
}

#[test]
fn refitted_is_as_rebuilt() {
    let mut random = Random(33);
    let mesh = soup(500, 0.2, &mut random);
    let mut built = MeshBvh::build(&mesh.points, &mesh.triangles);
    let mut moved = mesh.clone().map(|p| Vec3::new(p.y * 2.0 + p.x, p.z - 3.0, p.x * p.y));
    moved.points[7].0.x = f32::NAN;
    built.refit(&moved.points, &moved.triangles);
    let scene = InstanceBvh::build(vec![place(&Arc::new(built), 0, DAffine3::IDENTITY)]);
    let mut hits = 0;
    for _ in 0..3000 {
        let ray = ray_to(random.cube() * 5.0, moved.points[8 + random.below(1400)].0);
        let want = moved.brute_force(&ray);
        hits += usize::from(want.is_some());
        assert_eq!(answer(scene.closest_hit(&ray)), want);
    }
    assert!(hits > 1000);
}

#[test]
fn boxes_are_all_met_and_the_end_is_respected() {
    let mut random = Random(34);
    let boxes: Vec<Bounds3> = (0..300)
        .map(|i| match i {
            0 => Bounds3 { min: Vec3::NAN, max: Vec3::ONE },
            1 => Bounds3 { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY },
            _ => Bounds3::of_points([Point3(random.cube()), Point3(random.cube())]),
        })
        .collect();
    let bvh = BoundsBvh::build(&boxes);
    assert!(bvh.memory_bytes() > 300 * 4);
    for _ in 0..500 {
        let ray = ray_to(random.cube() * 3.0, random.cube());
        let mut met = Vec::new();
        bvh.traverse(&ray, |i, _| {
            met.push(i);
            None
        });
        for (i, b) in boxes.iter().enumerate().skip(2) {
            let entry = entry(b, &ray);
            assert_eq!(met.contains(&(i as u32)), entry.is_some(), "box {i} {b:?} {ray:?}");
        }
        assert!(!met.contains(&0) && !met.contains(&1));
        let mut nearest = f32::INFINITY;
        bvh.traverse(&ray, |i, t_max| {
            assert_eq!(t_max, nearest);
            nearest = nearest.min(entry(&boxes[i as usize], &ray)?);
            Some(nearest)
        });
        let want = boxes[2..].iter().filter_map(|b| entry(b, &ray)).fold(f32::INFINITY, f32::min);
        assert_eq!(nearest, want);
    }
}

/// Where a ray enters a box, in double precision.
fn entry(b: &Bounds3, ray: &Ray) -> Option<f32> {
    let (o, d): (DVec3, DVec3) = (ray.origin.0.as_dvec3(), ray.direction.0.as_dvec3());
    let (t0, t1) = ((b.min.as_dvec3() - o) / d, (b.max.as_dvec3() - o) / d);
    let (near, far) = (t0.min(t1).max_element().max(0.0), t0.max(t1).min_element());
    (near <= far).then_some(near as f32)
}

#[test]
fn refitting_ends_where_building_pays() {
    let mesh = icosphere(4);
    let built = MeshBvh::build(&mesh.points, &mesh.triangles);
    let bent = mesh.clone().map(|p| p + Vec3::new(0.1 * (3.0 * p.y).sin(), 0.0, 0.0));
    let fitted = built.refitted(&bent.points, &bent.triangles).expect("the shape is much the same");
    // Small steps add up: the cost is compared with that of the tree when built.
    let (mut fitted, mut steps) = (Some(fitted), 0);
    while let Some(bvh) = fitted.take() {
        steps += 1;
        assert!(steps < 50, "it is fitted for ever");
        let twisted = mesh.clone().map(|p| turned(p.y * 0.7 * steps as f32, p) * (1.0 + 0.3 * (p.x * 9.0).sin()));
        fitted = bvh.refitted(&twisted.points, &twisted.triangles);
    }
    assert!(steps > 1, "it was never fitted");
    assert!(built.refitted(&mesh.points, &mesh.triangles[1..]).is_none(), "other triangles");
}

/// A point turned about the y axis.
fn turned(angle: f32, p: Vec3) -> Vec3 {
    let (s, c) = angle.sin_cos();
    Vec3::new(c * p.x + s * p.z, p.y, c * p.z - s * p.x)
}
