//! Several samples with one ray from the camera, as a session decides about them.

mod common;

use std::sync::Arc;

use common::*;
use umber_math::{DAffine3, DVec3, Vec3};
use umber_render::{Aov, FilmDesc, Session};
use umber_scene::{Light, LightId, LightKind, MeshPatch, SceneEdit, SubdivisionScheme, Topology};

/// Edge of a film that is worth a trial, in pixels, and samples of each.
const EDGE: usize = 48;
const SAMPLES: i64 = 256;

fn shone_on(samples: i64, treat_as_point: bool) -> Session {
    let session = session(0.9, samples, &[]);
    session.set_film(FilmDesc::new(EDGE, EDGE, &[Aov::Color]));
    session.edit(setting("enableInteractive", 0)).unwrap();
    session.edit(setting("umber:pathReuse", 0)).unwrap();
    let lamp = Light::new(LightKind::Sphere { radius: 0.1, treat_as_point });
    let at = DAffine3::from_translation(DVec3::new(0.3, 0.5, 0.0));
    let lamp = Light { intensity: 50.0, world_from_light: at, ..lamp };
    session.edit(SceneEdit::Light(LightId::new("/lamp"), lamp)).unwrap();
    session
}

/// A matt room with a small lamp, seen from inside: its error is the noise of light.
fn room(samples: i64) -> Session {
    let session = shone_on(samples, false);
    session.edit(mesh("/room", cube())).unwrap();
    bind(&session, "/room", "/matt", lambert(0.7, 0.0));
    session
}

/// Squares smaller than a pixel, with gaps, and a light without size: their error is that of where rays go.
fn small_squares() -> Session {
    let session = shone_on(SAMPLES, true);
    let (per_side, spacing) = (120, 0.015f32);
    let corners = [(0.0, 0.0), (0.5, 0.0), (0.5, 0.5), (0.0, 0.5)];
    let square = |i: usize| {
        let at = |n: usize| n as f32 - 0.5 * per_side as f32;
        let corner = move |(x, y): (f32, f32)| spacing * Vec3::new(at(i % per_side) + x, at(i / per_side) + y, 0.0);
        corners.into_iter().map(corner)
    };
    let count = per_side * per_side;
    let topology = Topology {
        scheme: SubdivisionScheme::None,
        face_vertex_counts: vec![4; count].into(),
        face_vertex_indices: (0..4 * count as i32).collect::<Vec<_>>().into(),
        ..Topology::default()
    };
    let points: Vec<Vec3> = (0..count).flat_map(square).collect();
    let patch = MeshPatch { topology: Some(Arc::new(topology)), points: Some(points.into()), ..cube() };
    session.edit(mesh("/squares", patch)).unwrap();
    bind(&session, "/squares", "/matt", lambert(0.7, 0.0));
    session
}

/// How many samples begin with each ray when the picture is done.
fn share_of(session: &Session) -> u32 {
    finish(session);
    session.stats().samples_a_ray
}

#[test]
fn paths_are_split_where_the_error_is_in_the_light_and_not_where_it_is_in_what_is_seen() {
    let (room, squares) = (room(SAMPLES), small_squares());
    for seed in 0..4 {
        for (session, share) in [(&room, 4), (&squares, 1)] {
            session.edit(setting("umber:seed", seed)).unwrap();
            assert_eq!(share_of(session), share, "seed {seed}");
        }
    }
}

#[test]
fn paths_are_not_split_where_that_is_switched_off_or_brings_nothing() {
    let with = |key: &str, value| {
        let session = room(SAMPLES);
        session.edit(setting(key, value)).unwrap();
        share_of(&session)
    };
    assert_eq!(with("umber:pathSplitting", 1), 4);
    assert_eq!(with("umber:pathSplitting", 0), 1);
    assert_eq!(with("umber:maxBounces", 0), 1);
    assert_eq!(with("convergedSamplesPerPixel", 8), 1);
}

#[test]
fn threads_and_stops_change_nothing() {
    assert_same_for_threads_and_stops(EDGE * EDGE, || room(SAMPLES), |session| assert_eq!(share_of(session), 4));
}

#[test]
fn the_mean_stays() {
    const SEEDS: i64 = 10;
    let blocks = |splitting: i64, group: i64| {
        let session = room(SAMPLES);
        session.edit(setting("umber:pathSplitting", splitting)).unwrap();
        session.edit(setting("umber:pathReuse", group)).unwrap();
        let mut split = 0;
        let mut picture = |seed| {
            session.edit(setting("umber:seed", seed)).unwrap();
            split += usize::from(share_of(&session) > 1);
            block_sums(&color_of(&session, EDGE * EDGE), EDGE)
        };
        let pictures: Vec<_> = (0..SEEDS).map(|seed| picture(seed + 100 * splitting + 1000 * group)).collect();
        // a trial may be wrong now and then
        assert!(if splitting == 1 { split > SEEDS as usize / 2 } else { split == 0 }, "{split}");
        pictures
    };
    for group in [0, 1] {
        assert_same_means(&format!("shared {group}"), &blocks(0, group), &blocks(1, group));
    }
}
