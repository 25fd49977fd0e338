//! Light from triangles: densities, closed forms, choice among them.

use std::f32::consts::PI;
use std::sync::Arc;

use glam::{DAffine3, DVec3, Vec2, Vec3};
use umber_math::{Normal3, Point3, Rgb, Vector3};
use umber_sampling::Sampler;
use umber_sampling::chi2::{Chi2Options, test_sphere};
use umber_shading::{
    EmitterMesh, EmitterTriangle, Light, LightKind, LightParams, LightProblem, LightSampler, Receiver,
};

type Corners = [[f32; 3]; 3];

fn emitter(triangles: &[Corners], two_sided: bool) -> Arc<EmitterMesh> {
    let made = triangles.iter().zip(0..).map(|(corners, index)| EmitterTriangle {
        index,
        corners: corners.map(Point3::from),
        radiance: Rgb::WHITE,
        presence: 1.0,
    });
    Arc::new(EmitterMesh::new(made, two_sided).unwrap())
}

fn params(mesh: &Arc<EmitterMesh>) -> LightParams {
    LightParams::new(LightKind::Mesh { mesh: Arc::clone(mesh), clearance: 0.0 })
}

fn light(triangles: &[Corners], two_sided: bool) -> Light {
    Light::new(&params(&emitter(triangles, two_sided))).unwrap().0
}

/// Whether a direction from the origin leads through a triangle.
fn meets(corners: &Corners, w: Vector3) -> bool {
    let c = corners.map(|c| Vec3::from(c).as_dvec3());
    let w = w.0.as_dvec3();
    let side = |a: DVec3, b: DVec3| a.cross(b).dot(w);
    let sides = [side(c[0], c[1]), side(c[1], c[2]), side(c[2], c[0])];
    let towards = c[0].cross(c[1]).dot(c[2]) * sides[0] > 0.0;
    towards && (sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0))
}

/// Density of a direction from the origin: of all triangles on it.
fn density(light: &Light, triangles: &[Corners], w: Vector3) -> f32 {
    let mesh = light.as_mesh().unwrap();
    let receiver = Receiver::all_around(Point3::ZERO);
    let on_it = triangles.iter().zip(0..).filter(|(corners, _)| meets(corners, w));
    on_it.map(|(_, index)| mesh.pdf_solid_angle(&receiver, index, w)).sum()
}

const OVERHEAD: Corners = [[-1.0, -1.0, 2.0], [1.5, -0.5, 2.0], [0.0, 2.0, 2.0]];

#[test]
fn sampled_densities_stand_the_chi_squared_test() {
    let near = [[-1.0, -1.0, 0.02], [1.5, -0.5, 0.02], [0.0, 2.0, 0.02]];
    let needle = [[-3.0, 0.5, 0.7], [3.0, 0.7, 0.7], [3.0, 0.5, 0.8]];
    let grazing = [[1.0, 0.0, 0.05], [4.0, -2.0, 0.9], [4.0, 2.0, 0.4]];
    let beside = [[2.0, 0.0, 2.0], [2.0, 1.0, 0.5], [2.5, -1.0, 0.4]];
    let scenes: [(&str, Vec<Corners>); 6] = [
        ("overhead", vec![OVERHEAD]),
        ("near", vec![near]),
        ("needle", vec![needle]),
        ("grazing", vec![grazing]),
        ("two", vec![OVERHEAD, beside]),
        ("behind one another", vec![OVERHEAD, OVERHEAD.map(|c| c.map(|v| 1.7 * v))]),
    ];
    let o = Chi2Options { min_depth: 3, ..Chi2Options::default() };
    for (name, triangles) in &scenes {
        let light = light(triangles, true);
        let sample = |u| {
            let s = light.sample(Point3::ZERO, u)?;
            assert!((s.wi.length() - 1.0).abs() < 1e-5 && s.pdf_solid_angle > 0.0, "{name}: {s:?}");
            Some(s.wi)
        };
        let outcome = test_sphere(o, sample, |w| density(&light, triangles, w));
        let accepted = outcome.accepted(0.01, scenes.len());
        assert!(accepted && (outcome.integral - 1.0).abs() < 5e-3, "{name}: {outcome:?}");
    }
}

/// Lambert's formula for the irradiance of a polygon.
fn irradiance(corners: &[DVec3], n: DVec3) -> f64 {
    let unit: Vec<DVec3> = corners.iter().map(|c| c.normalize()).collect();
    let edge = |i: usize| {
        let (a, b) = (unit[i], unit[(i + 1) % unit.len()]);
        let cross = a.cross(b);
        if cross == DVec3::ZERO { 0.0 } else { cross.normalize().dot(n) * cross.length().atan2(a.dot(b)) }
    };
    (0.5 * (0..unit.len()).map(edge).sum::<f64>()).abs()
}

#[test]
fn irradiance_of_a_triangle_is_lamberts() {
    for (scale, distance) in [(1.0, 1.0), (1e-3, 1.0), (1.0, 1e-2), (1e-5, 100.0), (1e3, 0.1), (1e-4, 1e-6)] {
        let corners = OVERHEAD.map(|[x, y, _]| [x * scale, y * scale, distance]);
        let light = light(&[corners], false);
        // The winding faces up: seen from above.
        let eye = Point3::new(0.3 * scale, 0.2 * scale, 2.0 * distance);
        let relative = corners.map(|c| Vec3::from(c).as_dvec3() - eye.0.as_dvec3());
        let want = irradiance(&relative, DVec3::NEG_Z);
        let (mut sum, samples) = (0.0, 1 << 12);
        for i in 0..samples {
            let s = light.sample(eye, Sampler::new(1, [3, 4], i).next_2d()).unwrap();
            sum += f64::from(s.radiance.0.x * -s.wi.z() / s.pdf_solid_angle);
        }
        let got = sum / f64::from(samples);
        assert!((got / want - 1.0).abs() < 2e-3, "size {scale} at {distance}: {got}, not {want}");
        assert!(light.sample(Point3::ZERO, Vec2::splat(0.5)).is_none(), "it has one side");
    }
}

/// A grid of triangles over a square, facing down, as one mesh.
fn ceiling(cells: u32) -> Vec<Corners> {
    let at = |i: u32, j: u32| [i as f32 / cells as f32 * 4.0 - 2.0, j as f32 / cells as f32 * 4.0 - 2.0, 1.0];
    let cell = |i: u32, j: u32| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, c, b], [a, d, c]]
    };
    (0..cells).flat_map(|i| (0..cells).flat_map(move |j| cell(i, j))).collect()
}

#[test]
fn many_triangles_are_as_good_as_few() {
    let square = [[-2.0, -2.0], [2.0, -2.0], [2.0, 2.0], [-2.0, 2.0]].map(|[x, y]| DVec3::new(x, y, 1.0));
    let up = Receiver { point: Point3::ZERO, normal: Normal3::new(0.0, 0.0, 1.0), clearance: 0.0 };
    let want = irradiance(&square, DVec3::Z);
    for (cells, limit) in [(1, 0.35), (16, 0.6), (128, 0.6)] {
        let light = light(&ceiling(cells), false);
        let (mut sum, mut squares, samples) = (0.0, 0.0, 1 << 14);
        for i in 0..samples {
            let s = light.sample_for(&up, Sampler::new(1, [3, 4], i).next_2d());
            let value = s.map_or(0.0, |s| f64::from(s.wi.z() / s.pdf_solid_angle));
            sum += value;
            squares += value * value;
        }
        let mean = sum / f64::from(samples);
        let variance = squares / f64::from(samples) / (mean * mean) - 1.0;
        assert!((mean / want - 1.0).abs() < 1e-2, "{cells}: {mean}, not {want}");
        assert!(variance < limit, "{cells} cells a side: relative variance {variance}");
    }
}

#[test]
fn no_triangle_that_lights_a_receiver_is_left_out() {
    // A bumpy surface all around; receivers in it and outside, of any orientation.
    let mut random = Sampler::new(7, [0, 0], 0);
    let mut vector = || {
        let (a, b) = (random.next_2d(), random.next_2d());
        Vec3::new(a.x, a.y, b.x) * 2.0 - 1.0
    };
    let triangles: Vec<Corners> = (0..300)
        .map(|_| {
            let (center, e1, e2) = (vector() * 3.0, vector() * 0.4, vector() * 0.4);
            [center, center + e1, center + e2].map(Into::into)
        })
        .collect();
    for two_sided in [false, true] {
        let mut p = params(&emitter(&triangles, two_sided));
        // Stretched and mirrored: the tree works in the mesh's own space.
        p.render_from_light = DAffine3::from_scale(DVec3::new(1.0, -2.0, 0.5)) * DAffine3::from_rotation_x(0.6);
        let light = Light::new(&p).unwrap().0;
        let mesh = light.as_mesh().unwrap();
        for _ in 0..30 {
            let point = Point3(vector() * 4.0);
            let receiver = Receiver { point, normal: Normal3(vector()).normalized(), clearance: 0.0 };
            let mut total = 0.0;
            for (index, corners) in (0..).zip(&triangles) {
                let placed = corners.map(|c| p.render_from_light.transform_point3(Vec3::from(c).as_dvec3()));
                let (center, normal) =
                    ((placed[0] + placed[1] + placed[2]) / 3.0, (placed[1] - placed[0]).cross(placed[2] - placed[0]));
                let to = center - point.0.as_dvec3();
                let wi = Vector3(to.normalize().as_vec3());
                // Clear of both horizons: its middle is seen.
                let above = wi.dot_normal(receiver.normal) > 1e-3;
                // Mirrored, the winding names the other side.
                let radiance = mesh.radiance(index, wi, Normal3(normal.normalize().as_vec3()));
                let pdf = mesh.pdf_solid_angle(&receiver, index, wi);
                assert!(pdf > 0.0 || !above || radiance.is_black(), "triangle {index} from {receiver:?}");
                total += radiance.0.x;
            }
            assert!(total > 0.0);
        }
    }
}

#[test]
fn power_normalisation_and_problems() {
    let mesh = emitter(&[OVERHEAD], false);
    let mut p = LightParams { normalize: true, intensity: 6.0, ..params(&mesh) };
    p.render_from_light = DAffine3::from_scale(DVec3::new(2.0, 3.0, 1.0));
    let [a, b, c] = OVERHEAD.map(|c| Vec3::from(c) * Vec3::new(2.0, 3.0, 1.0));
    let area = 0.5 * (b - a).cross(c - a).length();
    let light = Light::new(&p).unwrap().0;
    let radiance = light.as_mesh().unwrap().radiance(0, Vector3::new(0.0, 0.0, -1.0), Normal3::new(0.0, 0.0, 1.0));
    assert!((radiance.0.x * area / 6.0 - 1.0).abs() < 1e-5);
    let same = LightParams { render_from_light: DAffine3::from_scale(DVec3::splat(2.0)), ..params(&mesh) };
    let [a, b, c] = OVERHEAD.map(|c| Vec3::from(c) * 2.0);
    let area = 0.5 * (b - a).cross(c - a).length();
    assert!((Light::new(&same).unwrap().0.power_estimate(1.0) / (PI * area) - 1.0).abs() < 1e-5);
    let flat = LightParams { render_from_light: DAffine3::from_scale(DVec3::new(1.0, 1.0, 0.0)), ..params(&mesh) };
    assert!(matches!(Light::new(&flat), Err(LightProblem::SingularTransform)));
    let black = |corners: Corners, radiance| EmitterTriangle {
        index: 0,
        corners: corners.map(Point3::from),
        radiance,
        presence: 1.0,
    };
    assert!(EmitterMesh::new([black(OVERHEAD, Rgb::BLACK)], true).is_none());
    assert!(EmitterMesh::new([black([[1.0; 3]; 3], Rgb::WHITE)], true).is_none());
    assert!(EmitterMesh::new([black([[f32::NAN; 3]; 3], Rgb::WHITE)], true).is_none());
    assert!(EmitterMesh::new([], true).is_none());
}

/// Among other lights a mesh is chosen by where it faces.
#[test]
fn a_mesh_is_chosen_where_it_shines() {
    let down = light(&ceiling(4), false);
    let lamp = LightParams {
        render_from_light: DAffine3::from_translation(DVec3::new(3.0, 0.0, 0.0)),
        ..LightParams::new(LightKind::Sphere { radius: 0.1, treat_as_point: false })
    };
    let sampler = LightSampler::new(&[down, Light::new(&lamp).unwrap().0], 5.0);
    let at = |z: f32| Receiver::all_around(Point3::new(0.0, 0.0, z));
    assert!(sampler.pmf(&at(0.0), 0) > 0.5 && sampler.pmf(&at(1.5), 0) == 0.0);
}
