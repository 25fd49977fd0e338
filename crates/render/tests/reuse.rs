//! Shared paths, as a session decides about them.

mod common;

use common::*;
use umber_math::{DAffine3, DVec3};
use umber_render::Session;
use umber_scene::{Light, LightId, LightKind, MeshPatch, SceneEdit};

/// Samples a pixel with which the film is worth a trial.
const MANY: i64 = 1024;

/// A matt room with a small lamp; the camera is in there.
fn room(lamp: Light) -> Session {
    let session = session(0.9, MANY, &[umber_render::Aov::Color]);
    session.edit(setting("enableInteractive", 0)).unwrap();
    session.edit(mesh("/room", MeshPatch { ..cube() })).unwrap();
    bind(&session, "/room", "/matt", lambert(0.7, 0.0));
    let inner = DAffine3::from_translation(DVec3::new(-0.3, -0.6, -0.4)) * DAffine3::from_scale(DVec3::splat(0.3));
    session.edit(mesh("/box", MeshPatch { transform: Some(inner), ..cube() })).unwrap();
    session.edit(SceneEdit::Light(LightId::new("/lamp"), lamp)).unwrap();
    session
}

fn lamp() -> Light {
    let lamp = Light::new(LightKind::Sphere { radius: 0.1, treat_as_point: false });
    Light { intensity: 50.0, world_from_light: DAffine3::from_translation(DVec3::new(0.3, 0.5, 0.0)), ..lamp }
}

/// How many pixels share paths when the picture is done.
fn group_of(session: &Session) -> u32 {
    finish(session);
    session.stats().path_group
}

#[test]
fn paths_are_shared_where_it_pays() {
    assert!(group_of(&room(lamp())) > 1);
}

#[test]
fn paths_are_not_shared_where_that_is_switched_off_or_cannot_be() {
    let off = room(lamp());
    off.edit(setting("umber:pathReuse", 0)).unwrap();
    assert_eq!(group_of(&off), 1);
    assert_eq!(group_of(&room(Light { diffuse: 0.5, ..lamp() })), 1);
    // one scattering: nothing to share
    let direct = room(lamp());
    direct.edit(setting("umber:maxBounces", 1)).unwrap();
    assert_eq!(group_of(&direct), 1);
}

#[test]
fn threads_and_stops_change_nothing() {
    let picture = |threads, stops: u32| {
        let session = room(lamp());
        session.edit(setting("umber:threads", threads)).unwrap();
        for _ in 0..stops {
            session.start();
            std::thread::sleep(std::time::Duration::from_millis(60));
            session.stop();
        }
        assert!(group_of(&session) > 1);
        color(&session)
    };
    let whole = picture(1, 0);
    assert_eq!(whole, picture(3, 0));
    assert_eq!(whole, picture(2, 5));
}
