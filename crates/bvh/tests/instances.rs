//! Nested instances against the same triangles flattened.

mod common;

use std::sync::Arc;

use common::{Mesh, Random, icosphere, place, ray_to, soup};
use umber_bvh::{Child, Instance, InstanceBvh, InstancePath, MAX_DEPTH, MeshBvh, SimdLevel};
use umber_geometry::surface_point;
use umber_math::{DAffine3, DVec3, Point3, Ray, Vec3, Vector3};

fn some_transform(random: &mut Random, spread: f64) -> DAffine3 {
    let mut d = || f64::from(random.cube().x);
    let scale = DVec3::new(1.0 + 0.5 * d(), 1.0 + 0.5 * d(), -1.0 + 0.5 * d());
    DAffine3::from_translation(DVec3::new(d(), d(), d()) * spread)
        * DAffine3::from_rotation_x(d() * 3.0)
        * DAffine3::from_rotation_z(d() * 3.0)
        * DAffine3::from_scale(scale)
}

/// A mesh's path, transform and number.
type Placement = (Vec<u32>, DAffine3, u32);

/// A scene of three levels, and where each of its meshes stands by path.
fn nested(random: &mut Random) -> (InstanceBvh, Vec<Placement>, [Mesh; 2]) {
    let meshes = [icosphere(2), soup(60, 0.5, random)];
    let built = meshes.each_ref().map(|m| Arc::new(MeshBvh::build(&m.points, &m.triangles)));
    let (mut flat, mut outer) = (Vec::new(), Vec::new());
    for i in 0..4u32 {
        let group_place = some_transform(random, 20.0);
        let mut inner = Vec::new();
        for j in 0..5u32 {
            let mesh = (i + j) % 2;
            let m = if j == 0 { DAffine3::IDENTITY } else { some_transform(random, 5.0) };
            inner.push(place(&built[mesh as usize], mesh, m));
            flat.push((vec![i, j], group_place * m, mesh));
        }
        let group = Child::Group(Arc::new(InstanceBvh::build(inner)));
        outer.push(Instance { child: group, parent_from_child: group_place, tag: i });
    }
    let alone = some_transform(random, 20.0);
    outer.push(place(&built[0], 0, alone));
    flat.push((vec![4], alone, 0));
    (InstanceBvh::build(outer), flat, meshes)
}

#[test]
fn nested_hits_are_the_flattened_ones() {
    let mut random = Random(21);
    let (scene, flat, meshes) = nested(&mut random);
    assert!(scene.skipped().is_empty());
    let flattened: Vec<Mesh> = flat
        .iter()
        .map(|(_, m, k)| meshes[*k as usize].clone().map(|p| m.transform_point3(p.as_dvec3()).as_vec3()))
        .collect();
    let (mut hits, mut close_calls) = (0, 0);
    for _ in 0..4000 {
        let aim = flat[random.below(flat.len())].1.translation.as_vec3() + random.cube() * 2.0;
        let ray = ray_to(random.cube() * 40.0, aim);
        let got = scene.closest_hit(&ray);
        for &level in SimdLevel::available() {
            assert_eq!(scene.closest_hit_on(level, &ray), got, "{level:?}");
            assert_eq!(scene.any_hit_on(level, &ray), got.is_some(), "{level:?}");
        }
        let want = flattened
            .iter()
            .enumerate()
            .filter_map(|(i, m)| m.brute_force(&ray).map(|(t, triangle)| (t, i, triangle)))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        match (got, want) {
            (None, None) => {}
            (Some(hit), Some((t, i, triangle))) if (hit.t - t).abs() <= 1e-4 => {
                hits += 1;
                let same = hit.path.as_slice() == flat[i].0 && hit.triangle == triangle && hit.mesh == flat[i].2;
                close_calls += usize::from(!same);
                check_transform(&scene, &hit, &ray, &meshes);
            }
            // Rounding may let a ray pass a silhouette on one way and not on the other.
            _ => close_calls += 1,
        }
    }
    assert!(hits > 1000, "{hits}");
    assert!(close_calls < 10, "{close_calls} rays disagree");
}

fn check_transform(scene: &InstanceBvh, hit: &umber_bvh::Hit, ray: &Ray, meshes: &[Mesh; 2]) {
    let triangle = meshes[hit.mesh as usize].vertices(hit.triangle as usize);
    let back = surface_point(triangle, hit.barycentrics, scene.transforms(&hit.path)).point;
    assert!(back.distance(ray.at(hit.t)) < 1e-3, "{back:?} is not {:?}", ray.at(hit.t));
    let last = hit.path.as_slice().len() - 1;
    let shown = scene.instance_at(&hit.path, last).map(|i| i.tag);
    assert_eq!(shown, Some(hit.mesh));
    assert!(scene.instance_at(&hit.path, last + 1).is_none());
}

#[test]
fn bad_transforms_are_skipped_and_told() {
    let mesh = icosphere(1);
    let built = Arc::new(MeshBvh::build(&mesh.points, &mesh.triangles));
    let bad = [
        DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0)),
        DAffine3::from_translation(DVec3::new(f64::NAN, 0.0, 0.0)),
        DAffine3::from_translation(DVec3::new(0.0, f64::INFINITY, 0.0)),
        DAffine3::from_scale(DVec3::splat(1e300)),
        DAffine3::from_scale(DVec3::splat(1e-200)),
    ];
    let mut instances: Vec<Instance> = bad.iter().map(|m| place(&built, 7, *m)).collect();
    instances.insert(2, place(&built, 9, DAffine3::from_translation(DVec3::new(0.0, 0.0, 5.0))));
    let scene = InstanceBvh::build(instances);
    assert_eq!(scene.skipped(), [0, 1, 3, 4, 5]);
    assert_eq!(scene.instance_count(), 6);
    let hit = scene.closest_hit(&ray_to(Vec3::ZERO, Vec3::Z)).unwrap();
    assert_eq!((hit.mesh, hit.path.as_slice()), (9, &[2][..]));
    assert!((hit.t - 4.0).abs() < 0.1);
}

#[test]
fn nesting_goes_to_the_limit_and_no_deeper() {
    let mesh = icosphere(1);
    let step = DAffine3::from_translation(DVec3::X);
    let mut instance = place(&Arc::new(MeshBvh::build(&mesh.points, &mesh.triangles)), 3, step);
    for level in 1..=MAX_DEPTH {
        let group = InstanceBvh::build(vec![instance]);
        assert!(group.skipped().is_empty());
        let hit =
            group.closest_hit(&ray_to(Vec3::new(level as f32, 0.1, -9.0), Vec3::new(level as f32, 0.1, 0.0))).unwrap();
        assert_eq!(hit.path.as_slice().len(), level);
        let moved = group.render_from_object(&hit.path).point(Point3::ZERO);
        assert_eq!(moved, Point3::new(level as f32, 0.0, 0.0));
        instance = Instance { child: Child::Group(Arc::new(group)), parent_from_child: step, tag: 0 };
    }
    let too_deep = InstanceBvh::build(vec![instance]);
    assert_eq!(too_deep.skipped(), [0]);
    assert!(too_deep.bounds().is_empty());
}

#[test]
fn coinciding_instances_give_the_first() {
    let mesh = icosphere(1);
    let built = Arc::new(MeshBvh::build(&mesh.points, &mesh.triangles));
    let scene = InstanceBvh::build((0..50).map(|i| place(&built, i, DAffine3::IDENTITY)).collect());
    let mut random = Random(22);
    for _ in 0..500 {
        let hit = scene.closest_hit(&ray_to(random.cube() * 4.0, random.cube() * 0.3));
        assert!(hit.is_none_or(|h| h.mesh == 0 && h.path.as_slice() == [0]), "{hit:?}");
    }
}

#[test]
fn far_instances_lose_nothing() {
    // A unit sphere ten million away, seen from close by: exact since the ray is moved in double precision.
    let mesh = icosphere(3);
    let built = Arc::new(MeshBvh::build(&mesh.points, &mesh.triangles));
    let far = DVec3::new(1e7, 0.0, 0.0);
    let m =
        DAffine3::from_translation(far) * DAffine3::from_rotation_y(0.7) * DAffine3::from_scale(DVec3::splat(100.0));
    let scene = InstanceBvh::build(vec![place(&built, 0, m)]);
    let eye = (far + DVec3::new(0.0, 0.0, 400.0)).as_vec3();
    let ray = Ray::new(Point3(eye), Vector3(-Vec3::Z));
    let hit = scene.closest_hit(&ray).unwrap();
    assert!((hit.t - 300.0).abs() < 1.0, "{}", hit.t);
    let at = surface_point(mesh.vertices(hit.triangle as usize), hit.barycentrics, [].iter()).point;
    let world = scene.render_from_object_double(&hit.path).transform_point3(at.0.as_dvec3());
    assert!((world - (eye.as_dvec3() - DVec3::Z * f64::from(hit.t))).length() < 1e-3, "{world}");
}

#[test]
fn paths_that_lead_nowhere_are_none() {
    let (scene, ..) = nested(&mut Random(23));
    let path = |p: &[u32]| InstancePath::from_slice(p).unwrap();
    assert!(scene.instance_at(&path(&[99]), 0).is_none());
    assert!(scene.instance_at(&path(&[4, 0]), 1).is_none());
    assert!(scene.instance_at(&InstancePath::default(), 0).is_none());
    assert!(InstancePath::from_slice(&[0; MAX_DEPTH + 1]).is_none());
}

#[test]
fn moved_instances_are_found_where_they_are() {
    let mut random = Random(24);
    let ball = icosphere(2);
    let built = Arc::new(MeshBvh::build(&ball.points, &ball.triangles));
    let stand = |i: u32| DAffine3::from_translation(DVec3::new(f64::from(i % 20) * 3.0, 0.0, f64::from(i / 20) * 3.0));
    let before: Vec<Instance> = (0..400).map(|i| place(&built, i, stand(i))).collect();
    let scene = InstanceBvh::build(before.clone());
    let mut after = before.clone();
    for i in [0, 7, 399] {
        after[i].parent_from_child = stand(i as u32) * some_transform(&mut random, 1.0);
    }
    let moved = scene.moved(&after).expect("three of four hundred moved a little");
    let rebuilt = InstanceBvh::build(after.clone());
    assert_eq!(moved.bounds(), rebuilt.bounds());
    let mut on_moved = 0;
    for n in 0..4000 {
        let aim = after[[0, 7, 399, random.below(400)][n % 4]].parent_from_child.translation.as_vec3();
        let ray = ray_to(random.cube() * 40.0, aim + random.cube() * 0.5);
        let hit = moved.closest_hit(&ray);
        assert_eq!(hit, rebuilt.closest_hit(&ray));
        on_moved += usize::from(hit.is_some_and(|h| [0, 7, 399].contains(&h.mesh)));
        if let Some(hit) = hit {
            assert_eq!(moved.render_from_object_double(&hit.path), after[hit.mesh as usize].parent_from_child);
        }
    }
    assert!(on_moved > 1000);

    let scattered: Vec<Instance> = (0..400).map(|i| place(&built, i, some_transform(&mut random, 200.0))).collect();
    assert!(scene.moved(&scattered).is_none(), "the tree is worth nothing any more");
    assert!(scene.moved(&after[1..]).is_none(), "fewer instances");
    let mut singular = before.clone();
    singular[5].parent_from_child = DAffine3::ZERO;
    assert!(scene.moved(&singular).is_none(), "one cannot be placed");
    let other = Arc::new(MeshBvh::build(&ball.points, &ball.triangles));
    let mut exchanged = before;
    exchanged[5] = place(&other, 5, stand(5));
    assert!(scene.moved(&exchanged).is_none(), "another mesh");
}
