//! Light paths from smooth surfaces, as a session decides about them.

mod common;

use std::sync::Arc;
use std::time::Duration;

use common::*;
use umber_math::{DAffine3, DVec3, Rgb};
use umber_render::Session;
use umber_scene::{
    Camera, CameraId, InstancerId, InstancerPatch, Light, LightId, LightKind, Material, MeshPatch, PreviewSurface,
    Projection, SceneEdit,
};

/// Samples a pixel with which the film is worth a search.
const MANY: i64 = 1024;
const SEEDS: i64 = 10;

fn scene() -> Session {
    let session = metal_and_lamp(MANY);
    session.edit(setting("enableInteractive", 0)).unwrap();
    session.edit(setting("umber:pathReuse", 0)).unwrap();
    session
}

fn metal(roughness: f32, opacity: f32) -> Material {
    let metal = PreviewSurface { diffuse_color: Rgb::splat(0.9), metallic: 1.0, roughness, ..Default::default() };
    Material::Preview(PreviewSurface { opacity, ..metal })
}

fn light_paths(session: &Session) -> u64 {
    finish(session);
    session.stats().light_paths
}

#[test]
fn light_is_traced_where_there_are_caustics() {
    let with = |change: &dyn Fn(&Session)| {
        let session = scene();
        change(&session);
        light_paths(&session)
    };
    let pixels = (SIZE * SIZE) as u64;
    assert_eq!(with(&|_| {}), pixels * MANY as u64 / 32);
    let set = |key: &'static str, value: i64| {
        move |session: &Session| {
            session.edit(setting(key, value)).unwrap();
        }
    };
    assert_eq!(with(&set("umber:lightTracing", 0)), 0);
    assert_eq!(with(&set("umber:maxBounces", 1)), 0);
    assert_eq!(with(&set("convergedSamplesPerPixel", 64)), 0);
    assert_eq!(with(&|session| bind(session, "/box", "/metal", metal(0.8, 1.0))), 0);
    // somebody watches: the first eight samples go without
    assert_eq!(with(&set("enableInteractive", 1)), pixels * (MANY as u64 - 8) / 32);
}

#[test]
fn threads_and_stops_change_nothing() {
    for (interactive, target) in [(0, -1.0), (1, -1.0), (0, 1e-4)] {
        let picture = |threads, stops: u32| {
            let session = scene();
            session.edit(setting("umber:threads", threads)).unwrap();
            session.edit(setting("enableInteractive", interactive)).unwrap();
            session.edit(number("convergedVariance", target)).unwrap();
            for _ in 0..stops {
                session.start();
                std::thread::sleep(Duration::from_millis(19));
                session.stop();
            }
            assert!(light_paths(&session) > 0);
            color(&session)
        };
        let whole = picture(1, 0);
        assert!(whole == picture(3, 0), "interactive {interactive}, target {target}: threads");
        assert!(whole == picture(2, 9), "interactive {interactive}, target {target}: stops");
    }
}

/// Pictures of a scene, with light paths or without.
fn pictures(change: &dyn Fn(&Session), traced: i64) -> Vec<Vec<f64>> {
    let session = scene();
    session.edit(setting("umber:lightTracing", traced)).unwrap();
    change(&session);
    let picture = |seed| {
        session.edit(setting("umber:seed", seed + 100 * traced)).unwrap();
        assert_eq!(light_paths(&session) > 0, traced == 1, "seed {seed}");
        block_sums(&color(&session), SIZE)
    };
    (0..SEEDS).map(picture).collect()
}

#[track_caller]
fn assert_unbiased(what: &str, change: &dyn Fn(&Session)) {
    assert_same_means(what, &pictures(change, 0), &pictures(change, 1));
}

#[test]
fn the_mean_stays_whatever_the_lobes() {
    for (what, roughness) in [("glossy", 0.3), ("narrow", 0.15), ("a mirror", 0.0)] {
        assert_unbiased(what, &|session| bind(session, "/box", "/metal", metal(roughness, 1.0)));
    }
    // smooth and rough at once: it begins light paths, ends them, and is led
    let coated =
        PreviewSurface { diffuse_color: Rgb::splat(0.6), clearcoat: 1.0, roughness: 0.3, ..Default::default() };
    assert_unbiased("a coated floor", &|session| bind(session, "/floor", "/coated", Material::Preview(coated.clone())));
}

#[test]
fn the_mean_stays_whatever_the_light() {
    let lamp = |kind: LightKind, intensity: f32| {
        let turned = DAffine3::from_rotation_x(-1.2) * DAffine3::from_rotation_y(-0.7);
        let at = DAffine3::from_translation(DVec3::new(-2.0, 0.5, 0.5)) * turned;
        Light { intensity, world_from_light: at, ..Light::new(kind) }
    };
    let light = |light: Light| {
        move |session: &Session| {
            session.edit(SceneEdit::Light(LightId::new("/lamp"), light.clone())).unwrap();
            // narrower lobes are too noisy without light paths for their mean to be known
            bind(session, "/box", "/metal", metal(0.3, 1.0));
        }
    };
    let point = lamp(LightKind::Sphere { radius: 0.15, treat_as_point: true }, 40.0);
    assert_unbiased("a point", &light(point));
    assert_unbiased("a sun", &light(lamp(LightKind::Distant { angle_deg: 2.0 }, 20.0)));
    let rect = lamp(LightKind::Rect { width: 0.4, height: 0.3 }, 300.0);
    assert_unbiased("multipliers", &light(Light { diffuse: 0.5, specular: 1.5, ..rect }));
}

#[test]
fn the_mean_stays_whatever_the_camera() {
    let camera = |camera: Camera| {
        let id = CameraId::new("/camera");
        move |session: &Session| {
            session.edit(SceneEdit::Camera(id.clone(), camera.clone())).unwrap();
        }
    };
    let scaled = DAffine3::from_translation(DVec3::new(0.5, 1.0, 5.5)) * DAffine3::from_rotation_x(-0.2);
    let scaled = Camera {
        world_from_camera: scaled * DAffine3::from_scale(DVec3::splat(3.0)),
        aperture: umber_math::DVec2::ONE,
        focal_length: 1.2,
        clipping_range: [0.01, 1e6],
        ..Camera::default()
    };
    assert_unbiased("scaled", &camera(scaled.clone()));
    let aperture = umber_math::DVec2::splat(1.6);
    assert_unbiased("orthographic", &camera(Camera { projection: Projection::Orthographic, aperture, ..scaled }));
}

#[test]
fn the_mean_stays_whatever_the_geometry() {
    assert_unbiased("half there", &|session| bind(session, "/box", "/metal", metal(0.15, 0.5)));
    let squeezed = |at: DVec3| DAffine3::from_translation(at) * DAffine3::from_scale(DVec3::new(0.2, 0.7, 0.4));
    assert_unbiased("instances", &|session| {
        let at: Arc<[DAffine3]> = [squeezed(DVec3::new(-0.5, 0.2, 0.0)), squeezed(DVec3::new(0.7, 0.0, 0.5))].into();
        let boxes = InstancerId::new("/boxes");
        let instancer = InstancerPatch { transforms: Some(at), visible: Some(true), ..Default::default() };
        session.edit(SceneEdit::Instancer(boxes.clone(), instancer)).unwrap();
        session
            .edit(mesh(
                "/box",
                MeshPatch { instancer: Some(Some(boxes)), instance_indices: Some([0, 1].into()), ..Default::default() },
            ))
            .unwrap();
    });
}

#[test]
fn the_mean_stays_beside_the_other_ways() {
    assert_unbiased("somebody watches", &|session| {
        session.edit(setting("enableInteractive", 1)).unwrap();
    });
    assert_unbiased("adaptive", &|session| {
        session.edit(number("convergedVariance", 1e-4)).unwrap();
    });
    assert_unbiased("shared", &|session| {
        session.edit(setting("umber:pathReuse", 1)).unwrap();
        session.edit(setting("umber:maxBounces", 3)).unwrap();
        // a matt room around it: most of the error is in the light that has bounced
        let room = DAffine3::from_scale(DVec3::new(7.0, 5.0, 8.0));
        session.edit(mesh("/room", MeshPatch { transform: Some(room), ..cube() })).unwrap();
        bind(session, "/room", "/walls", lambert(0.8, 0.0));
        finish(session);
        assert!(session.stats().path_group > 1);
    });
}
