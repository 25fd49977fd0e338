//! Dim paths that end at random, as a session has them.

mod common;

use common::*;
use umber_math::{DAffine3, DVec3, Rgb};
use umber_render::{Aov, Session};
use umber_scene::{Light, LightId, LightKind, Material, MeshPatch, PreviewSurface, SceneEdit};

/// Samples a pixel with which the film is worth trials and searches.
const SAMPLES: i64 = 1024;
const SEEDS: i64 = 10;
/// So many scattering events before paths may end that none does.
const NEVER: i64 = 1024;

/// A room with a small lamp and a box, seen from inside.
fn room(samples: i64, walls: Material, inner: Material) -> Session {
    let session = session(0.9, samples, &[Aov::Color]);
    session.edit(setting("enableInteractive", 0)).unwrap();
    session.edit(setting("umber:maxBounces", 4)).unwrap();
    session.edit(mesh("/room", cube())).unwrap();
    bind(&session, "/room", "/walls", walls);
    let at = DAffine3::from_translation(DVec3::new(-0.3, -0.5, -0.4)) * DAffine3::from_scale(DVec3::splat(0.4));
    session.edit(mesh("/box", MeshPatch { transform: Some(at), ..cube() })).unwrap();
    bind(&session, "/box", "/inner", inner);
    let at = DAffine3::from_translation(DVec3::new(0.3, 0.5, 0.0));
    let lamp = Light::new(LightKind::Sphere { radius: 0.1, treat_as_point: false });
    let lamp = Light { intensity: 50.0, world_from_light: at, ..lamp };
    session.edit(SceneEdit::Light(LightId::new("/lamp"), lamp)).unwrap();
    session
}

/// With a dark box: most paths that meet it end there.
fn dark_box(samples: i64, shared: i64) -> Session {
    let session = room(samples, lambert(0.8, 0.0), lambert(0.05, 0.0));
    session.edit(setting("umber:pathReuse", shared)).unwrap();
    session
}

/// Pictures where paths may end after so many scattering events, and the rays that all took.
fn pictures(session: &Session, bounces: i64, check: &dyn Fn(&Session)) -> (Vec<Vec<f64>>, u64) {
    session.edit(setting("umber:rouletteBounces", bounces)).unwrap();
    let mut rays = 0;
    let picture = |seed| {
        session.edit(setting("umber:seed", seed + 100 * bounces)).unwrap();
        finish(session);
        check(session);
        rays += session.stats().rays;
        block_sums(&color(session), SIZE)
    };
    ((0..SEEDS).map(picture).collect(), rays)
}

/// That paths end, and that the mean stays.
fn assert_unbiased(what: &str, session: &Session, check: &dyn Fn(&Session)) {
    let [(whole, all), (ended, fewer)] = [NEVER, 1].map(|bounces| pictures(session, bounces, check));
    assert!(fewer as f64 <= 0.98 * all as f64, "{what}: {fewer} rays of {all}");
    assert_same_means(what, &whole, &ended);
}

#[test]
fn the_mean_stays_of_paths_alone() {
    assert_unbiased("alone", &dark_box(SAMPLES / 4, 0), &|session| assert_eq!(session.stats().path_group, 1));
}

#[test]
fn the_mean_stays_of_shared_paths() {
    assert_unbiased("shared", &dark_box(SAMPLES, 1), &|session| assert!(session.stats().path_group > 1));
}

#[test]
fn the_mean_stays_of_paths_that_are_led() {
    let metal = PreviewSurface { diffuse_color: Rgb::splat(0.9), metallic: 1.0, roughness: 0.15, ..Default::default() };
    let session = room(SAMPLES, lambert(0.2, 0.0), Material::Preview(metal));
    session.edit(setting("umber:pathReuse", 0)).unwrap();
    assert_unbiased("led", &session, &|session| assert!(session.stats().light_paths > 0));
}
