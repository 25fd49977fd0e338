//! A room with a window under a dome: portals save noise and change nothing else.

mod common;

use std::sync::Arc;

use common::*;
use umber_math::{DAffine3, DVec3, Vec3};
use umber_render::{Aov, Session};
use umber_scene::{Light, LightId, LightKind, MeshPatch, SceneEdit, SubdivisionScheme, Topology};

const BLOCK: usize = 6;
const SEEDS: i64 = 8;

/// A room from −2 to 2 along each axis. The wall on the right has a window of 1 × 0.8 around (2, 0.4, 0.2).
fn room() -> MeshPatch {
    let mut points: Vec<Vec3> = (0..8)
        .map(|i| Vec3::new((i >> 2 & 1) as f32, (i >> 1 & 1) as f32, (i & 1) as f32) * 4.0 - Vec3::splat(2.0))
        .collect();
    for (y, z) in [(0.0, -0.3), (0.8, -0.3), (0.8, 0.7), (0.0, 0.7)] {
        points.push(Vec3::new(2.0, y, z));
    }
    // corners of the right wall: 4 (−y −z), 6 (+y −z), 7 (+y +z), 5 (−y +z); around the window four quads
    let faces = [
        [0, 1, 3, 2],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
        [4, 6, 9, 8],
        [6, 7, 10, 9],
        [7, 5, 11, 10],
        [5, 4, 8, 11],
    ];
    let topology = Topology {
        scheme: SubdivisionScheme::None,
        face_vertex_counts: [4; 9].into(),
        face_vertex_indices: faces.concat().into(),
        ..Topology::default()
    };
    MeshPatch {
        topology: Some(Arc::new(topology)),
        points: Some(points.into()),
        transform: Some(DAffine3::IDENTITY),
        visible: Some(true),
        ..MeshPatch::default()
    }
}

/// A portal that lets light go along −X, its middle at `x`, `y`, `z`.
fn portal(middle: [f64; 3], width: f32, height: f32) -> Light {
    let turned = DAffine3::from_rotation_y(std::f64::consts::FRAC_PI_2);
    let world_from_light = DAffine3::from_translation(DVec3::from(middle)) * turned;
    Light { world_from_light, ..Light::new(LightKind::Portal { width, height }) }
}

fn dome_with(session: &Session, portals: &[(&str, Light)]) {
    for (path, portal) in portals {
        session.edit(SceneEdit::Light(LightId::new(path), portal.clone())).unwrap();
    }
    let portals = portals.iter().map(|(path, _)| LightId::new(path)).collect();
    let dome = Light { portals, ..Light::new(LightKind::Dome { texture: None }) };
    session.edit(SceneEdit::Light(LightId::new("/dome"), dome)).unwrap();
}

fn in_the_room(samples: i64, portals: &[(&str, Light)]) -> Session {
    let session = session(1.9, samples, &[Aov::Color]);
    session.edit(mesh("/room", room())).unwrap();
    bind(&session, "/room", "/m", lambert(0.6, 0.0));
    dome_with(&session, portals);
    session
}

/// Means of the picture's blocks and their variances over several seeds.
fn blocks(portals: &[(&str, Light)]) -> Vec<[f64; 2]> {
    let session = in_the_room(8, portals);
    let across = SIZE / BLOCK;
    let mut sums = vec![[0f64; 2]; across * across];
    for seed in 0..SEEDS {
        session.edit(setting("umber:seed", seed)).unwrap();
        finish(&session);
        let pixels = color(&session);
        for (block, sum) in sums.iter_mut().enumerate() {
            let (x0, y0) = (block % across * BLOCK, block / across * BLOCK);
            let within = (0..BLOCK * BLOCK).map(|i| pixels[(y0 + i / BLOCK) * SIZE + x0 + i % BLOCK]);
            let mean = within.map(|p| f64::from(p[0])).sum::<f64>() / (BLOCK * BLOCK) as f64;
            *sum = [sum[0] + mean, sum[1] + mean * mean];
        }
    }
    assert_messages(&session, &[]);
    let n = SEEDS as f64;
    sums.iter().map(|[sum, squares]| [sum / n, (squares - sum * sum / n) / (n - 1.0)]).collect()
}

fn worst_z(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    let z = |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]).abs() / ((a[1] + b[1]) / SEEDS as f64).sqrt();
    a.iter().zip(b).map(z).fold(0.0, f64::max)
}

/// With the window as portal, with a part of it, with a portal where there is no window, and with all of them: the
/// same picture. The window alone saves noise.
#[test]
fn portals_change_noise_alone() {
    let window = || ("/window", portal([2.0, 0.4, 0.2], 1.0, 0.8));
    let half = || ("/half", portal([2.0, 0.4, 0.45], 0.5, 0.8));
    let wall = || ("/wall", portal([2.0, -1.0, 1.0], 0.8, 0.8));
    let plain = blocks(&[]);
    let guided = blocks(&[window()]);
    for other in [&guided, &blocks(&[half()]), &blocks(&[wall()]), &blocks(&[window(), half(), wall()])] {
        let z = worst_z(&plain, other);
        assert!(z < 6.0, "a block differs by {z} standard errors");
    }
    let noise = |blocks: &[[f64; 2]]| blocks.iter().map(|b| b[1] / (b[0] * b[0])).sum::<f64>();
    let saved = noise(&plain) / noise(&guided);
    println!("variance without portals over that with them: {saved:.1}");
    assert!(saved > 4.0, "variance is only {saved} times lower");
}

/// Portals that do not exist, have no area or are no portals are named; the picture is made without them.
#[test]
fn broken_portals_are_named() {
    let broken = [
        ("/flat", portal([2.0, 0.4, 0.2], 0.0, 0.8)),
        ("/ball", Light::new(LightKind::Sphere { radius: 0.1, treat_as_point: false })),
        ("/hidden", Light { visible: false, ..portal([2.0, 0.4, 0.2], 1.0, 0.8) }),
    ];
    let session = in_the_room(1, &broken);
    let portals = ["/flat", "/ball", "/hidden", "/nowhere"].map(LightId::new).into();
    let dome = Light { portals, ..Light::new(LightKind::Dome { texture: None }) };
    session.edit(SceneEdit::Light(LightId::new("/dome"), dome)).unwrap();
    finish(&session);
    assert_messages(
        &session,
        &["/flat>: the light's shape has no area", "/ball is not a portal", "no such portal: /nowhere"],
    );
    assert!(color(&session).iter().all(|p| p[0].is_finite()));
    assert_eq!(session.stats().lights, 2);
}

/// A portal that moves or goes shows at once.
#[test]
fn portals_can_be_edited() {
    let session = in_the_room(4, &[("/window", portal([2.0, 0.4, 0.2], 1.0, 0.8))]);
    finish(&session);
    let first = color(&session);
    session.edit(SceneEdit::Light(LightId::new("/window"), portal([2.0, 0.4, 0.2], 0.9, 0.8))).unwrap();
    finish(&session);
    let second = color(&session);
    assert_ne!(first, second);
    session.edit(SceneEdit::RemoveLight(LightId::new("/window"))).unwrap();
    finish(&session);
    assert_messages(&session, &["no such portal: /window"]);
    assert_ne!(second, color(&session));
}
