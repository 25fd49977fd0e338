//! Light paths from smooth surfaces, as a session decides about them.

mod common;

use std::sync::Arc;

use common::*;
use umber_math::{DAffine3, DVec3, Rgb};
use umber_render::{Aov, FilmDesc, Session};
use umber_scene::{
    Camera, CameraId, InstancerId, InstancerPatch, Light, LightId, LightKind, Material, MeshPatch, PreviewSurface,
    Projection, SceneEdit,
};

/// Samples a pixel with which the film is worth a search.
const MANY: i64 = 1024;
const SEEDS: i64 = 10;
/// Edge of a film that is worth one with few samples.
const WIDE: usize = 240;

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

/// A second smooth surface beside the box, which becomes less smooth: lobes as narrow as they were are too noisy
/// without light paths for their mean to be known.
fn add_wall(session: &Session, roughness: f32) {
    let wall = DAffine3::from_translation(DVec3::new(-0.6, -0.6, -0.8)) * DAffine3::from_rotation_y(0.5);
    let wall = wall * DAffine3::from_scale(DVec3::new(0.1, 0.9, 1.2));
    session.edit(mesh("/wall", MeshPatch { transform: Some(wall), ..cube() })).unwrap();
    bind(session, "/wall", "/smooth", metal(roughness, 1.0));
    bind(session, "/box", "/metal", metal(0.3, 1.0));
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
    // somebody watches: passes end at 1, 2, 3, 4, 6 and 9 samples, which go without
    assert_eq!(with(&set("enableInteractive", 1)), pixels * (MANY as u64 - 9) / 32);
}

#[test]
fn threads_and_stops_change_nothing() {
    assert_same_for_threads_and_stops(SIZE * SIZE, scene, |session| assert!(light_paths(session) > 0));
}

/// The red of a film of an edge, summed up to one of [`SIZE`].
fn shrunk(color: &[[f32; 4]], edge: usize) -> Vec<[f32; 4]> {
    let (step, mut small) = (edge / SIZE, vec![[0.0; 4]; SIZE * SIZE]);
    for (i, pixel) in color.iter().enumerate() {
        small[i / edge / step * SIZE + i % edge / step][0] += pixel[0];
    }
    small
}

/// Pictures of a scene, with light paths or without, of an edge.
fn pictures(edge: usize, change: &dyn Fn(&Session), traced: i64) -> Vec<Vec<f64>> {
    let session = scene();
    session.edit(setting("umber:lightTracing", traced)).unwrap();
    change(&session);
    let picture = |seed| {
        session.edit(setting("umber:seed", seed + 100 * traced)).unwrap();
        assert_eq!(light_paths(&session) > 0, traced == 1, "seed {seed}");
        block_sums(&shrunk(&color_of(&session, edge * edge), edge), SIZE)
    };
    (0..SEEDS).map(picture).collect()
}

#[track_caller]
fn assert_unbiased(what: &str, change: &dyn Fn(&Session)) {
    assert_same_means(what, &pictures(SIZE, change, 0), &pictures(SIZE, change, 1));
}

#[test]
fn the_mean_stays_whatever_the_lobes() {
    for (what, roughness) in [("glossy", 0.3), ("narrow", 0.15), ("a mirror", 0.0)] {
        assert_unbiased(what, &|session| bind(session, "/box", "/metal", metal(roughness, 1.0)));
    }
    // light that two smooth surfaces pass on
    for (what, roughness) in [("glossy and glossy", 0.3), ("glossy and a mirror", 0.0)] {
        assert_unbiased(what, &|session| {
            add_wall(session, roughness);
        });
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
    // what mirrors show of a light is not always what its samples see
    let wide = lamp(LightKind::Sphere { radius: 0.5, treat_as_point: false }, 40.0);
    assert_unbiased("a mirror's without shadows", &|session| {
        light(Light { shadow_enable: false, ..wide.clone() })(session);
        add_wall(session, 0.0);
    });
    assert_unbiased("a mirror's that glows", &|session| {
        session.edit(SceneEdit::RemoveLight(LightId::new("/lamp"))).unwrap();
        let at = DAffine3::from_translation(DVec3::new(-2.0, 0.5, 0.5)) * DAffine3::from_scale(DVec3::splat(0.4));
        session.edit(mesh("/lamp_mesh", MeshPatch { transform: Some(at), ..cube() })).unwrap();
        bind(session, "/lamp_mesh", "/glow", lambert(0.0, 40.0));
        add_wall(session, 0.0);
    });
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
    // of few samples much are those that were taken before light paths
    let short = |session: &Session| {
        session.set_film(FilmDesc::new(WIDE, WIDE, &[Aov::Color]));
        session.edit(setting("enableInteractive", 1)).unwrap();
        session.edit(setting("convergedSamplesPerPixel", 20)).unwrap();
    };
    assert_same_means("somebody watches, of few samples", &pictures(WIDE, &short, 0), &pictures(WIDE, &short, 1));
    assert_unbiased("two bounces, of a part of the view", &|session| {
        let part = FilmDesc {
            display_window: Some([0.0, 0.0, 40.0, 40.0]),
            data_window_min: [13, 5],
            pixel_aspect: 1.5,
            ..FilmDesc::new(SIZE, SIZE, &[Aov::Color])
        };
        session.set_film(part);
        session.edit(setting("umber:maxBounces", 2)).unwrap();
    });
    assert_unbiased("adaptive", &|session| {
        session.edit(number("convergedVariance", 1e-4)).unwrap();
    });
    assert_unbiased("shared", &|session| {
        session.edit(setting("umber:pathReuse", 1)).unwrap();
        session.edit(setting("umber:maxBounces", 3)).unwrap();
        // little metal in a matt room: most of the error is in the light that has bounced
        let small = DAffine3::from_translation(DVec3::new(0.9, -1.2, 0.0)) * DAffine3::from_scale(DVec3::splat(0.3));
        session.edit(mesh("/box", MeshPatch { transform: Some(small), ..cube() })).unwrap();
        let room = DAffine3::from_scale(DVec3::new(7.0, 5.0, 8.0));
        session.edit(mesh("/room", MeshPatch { transform: Some(room), ..cube() })).unwrap();
        bind(session, "/room", "/walls", lambert(0.9, 0.0));
        finish(session);
        assert!(session.stats().path_group > 1);
    });
}
