//! More rays from the camera where the rims of bright things run, as a session decides about them.

mod common;

use common::*;
use umber_math::{DAffine3, DVec3, Rgb};
use umber_render::{Aov, FilmDesc, Session};
use umber_scene::{Light, LightId, LightKind, Material, PreviewSurface, SceneEdit};

const SAMPLES: i64 = 32;
const SEEDS: i64 = 10;
const PIXELS: usize = SIZE * SIZE;

fn lamp(radius: f32, at: DVec3, intensity: f32) -> Light {
    let lamp = Light::new(LightKind::Sphere { radius, treat_as_point: false });
    Light { intensity, world_from_light: DAffine3::from_translation(at), ..lamp }
}

fn add_lamp(session: &Session, path: &str, radius: f32, at: DVec3, intensity: f32) {
    session.edit(SceneEdit::Light(LightId::new(path), lamp(radius, at, intensity))).unwrap();
}

fn add_sky(session: &Session, intensity: f32) {
    let sky = Light { intensity, ..Light::new(LightKind::Dome { texture: None }) };
    session.edit(SceneEdit::Light(LightId::new("/sky"), sky)).unwrap();
}

/// A matt box, half of it before a bright lamp.
fn scene() -> Session {
    let session = session(6.0, SAMPLES, &[Aov::Color]);
    session.edit(setting("enableInteractive", 0)).unwrap();
    session.edit(mesh("/box", cube())).unwrap();
    bind(&session, "/box", "/matt", lambert(0.7, 0.0));
    add_lamp(&session, "/lamp", 0.7, DVec3::new(1.7, 0.8, -2.0), 10.0);
    session
}

fn edge_pixels(session: &Session) -> u64 {
    finish(session);
    session.stats().edge_pixels
}

#[test]
fn edges_are_found_where_something_bright_ends() {
    let with = |change: &dyn Fn(&Session)| {
        let session = scene();
        change(&session);
        edge_pixels(&session) as f64
    };
    let set = |key: &'static str, value: i64| {
        move |session: &Session| {
            session.edit(setting(key, value)).unwrap();
        }
    };
    // a circle of 2.1 pixels' radius, a fourth of which the box hides, and the pixels beside
    let rim = with(&|_| {});
    assert!((8.0..40.0).contains(&rim), "{rim}");
    assert_eq!(with(&set("umber:edgeRays", 0)), 0.0);
    assert_eq!(with(&set("convergedSamplesPerPixel", 8)), 0.0);
    assert_eq!(with(&set("umber:maxBounces", 0)), rim);
    // who watches has to wait for them
    assert_eq!(with(&set("enableInteractive", 1)), rim);
    // what the camera does not see has no rim
    let hidden = Light { camera_visible: false, ..lamp(0.7, DVec3::new(1.7, 0.8, -2.0), 10.0) };
    let hide = |session: &Session| {
        session.edit(SceneEdit::Light(LightId::new("/lamp"), hidden.clone())).unwrap();
    };
    assert_eq!(with(&hide), 0.0);
    // before a sky that is no brighter than the box there is little to gain
    let before_sky = |intensity| {
        with(&|session: &Session| {
            add_lamp(session, "/lamp", 0.7, DVec3::new(0.0, 0.0, 9.0), 10.0);
            add_sky(session, intensity);
        })
    };
    assert!(before_sky(0.02) < before_sky(2.0), "{} {}", before_sky(0.02), before_sky(2.0));
    assert_eq!(before_sky(0.0), 0.0);
}

#[test]
fn lamps_smaller_than_pixels_are_found_wherever_they_are() {
    let session = scene();
    let lamps = 24;
    for i in 0..lamps {
        // spread by the golden ratio, apart from each other
        let place = |step: f64| (f64::from(i) * step).fract() * 4.0 - 2.0;
        let at = DVec3::new(place(0.618_034), place(1.0 / 24.0), 1.5);
        add_lamp(&session, &format!("/small{i}"), 0.02, at, 1000.0);
    }
    let few = edge_pixels(&scene());
    let many = edge_pixels(&session);
    assert!(many >= few + lamps as u64, "{many} of {few}");
}

#[test]
fn threads_and_stops_change_nothing() {
    let long = || {
        let session = scene();
        session.edit(setting("convergedSamplesPerPixel", 4096)).unwrap();
        session
    };
    assert_same_for_threads_and_stops(PIXELS, long, |session| assert!(edge_pixels(session) > 0));
}

/// Pictures of a scene, with rays for edges or without; of one of their channels.
fn pictures(change: &dyn Fn(&Session), edge_rays: i64, channel: usize) -> Vec<Vec<f64>> {
    let session = scene();
    session.edit(setting("umber:edgeRays", edge_rays)).unwrap();
    change(&session);
    let picture = |seed| {
        session.edit(setting("umber:seed", seed + 100 * edge_rays)).unwrap();
        assert_eq!(edge_pixels(&session) > 0, edge_rays == 1, "seed {seed}");
        let of_channel: Vec<[f32; 4]> = color(&session).iter().map(|pixel| [pixel[channel]; 4]).collect();
        block_sums(&of_channel, SIZE)
    };
    (0..SEEDS).map(picture).collect()
}

#[track_caller]
fn assert_unbiased(what: &str, change: &dyn Fn(&Session)) {
    for (channel, name) in [(0, "red"), (3, "alpha")] {
        assert_same_means(&format!("{what}, {name}"), &pictures(change, 0, channel), &pictures(change, 1, channel));
    }
}

#[test]
fn the_mean_stays() {
    let set = |key: &'static str, value: f64| {
        move |session: &Session| {
            session.edit(number(key, value)).unwrap();
        }
    };
    assert_unbiased("as it is", &|_| {});
    assert_unbiased("watched", &|session| {
        session.edit(setting("enableInteractive", 1)).unwrap();
    });
    assert_unbiased("adaptive", &set("convergedVariance", 1e-4));
    assert_unbiased("before a sky", &|session| add_sky(session, 1.0));
    assert_unbiased("partly there", &|session| {
        let matt = PreviewSurface { diffuse_color: Rgb::splat(0.7), opacity: 0.5, ..PreviewSurface::default() };
        bind(session, "/box", "/matt", Material::Preview(PreviewSurface { opacity_threshold: 0.0, ..matt }));
    });
    // each ray is clamped by itself; what is reflected is far below
    assert_unbiased("clamped", &set("umber:fireflyClamp", 4.0));
    assert_unbiased("part of a view", &|session| {
        let mut film = FilmDesc::new(SIZE, SIZE, &[Aov::Color]);
        film.data_window_min = [3, 1];
        film.display_window = Some([0.0, 0.0, 30.0, 30.0]);
        session.set_film(film);
    });
    // a glowing box
    assert_unbiased("glowing", &|session| bind(session, "/box", "/matt", lambert(0.7, 3.0)));
}

/// With as many samples as are worth the trials that decide about these.
#[test]
fn the_mean_stays_with_split_and_with_shared_paths() {
    let pictures = |edge_rays: i64, reuse: i64| {
        let session = scene();
        // inside of a room with the lamp in it
        session.edit(camera_at(0.9)).unwrap();
        add_lamp(&session, "/lamp", 0.1, DVec3::new(0.3, 0.5, 0.0), 50.0);
        for (key, value) in [("umber:edgeRays", edge_rays), ("umber:pathReuse", reuse)] {
            session.edit(setting(key, value)).unwrap();
        }
        session.edit(setting("convergedSamplesPerPixel", 1024)).unwrap();
        session.edit(setting("umber:maxBounces", 2)).unwrap();
        let mut decided = 0;
        let mut picture = |seed| {
            session.edit(setting("umber:seed", seed + 100 * edge_rays + 1000 * reuse)).unwrap();
            assert_eq!(edge_pixels(&session) > 0, edge_rays == 1);
            let stats = session.stats();
            decided += usize::from(if reuse == 1 { stats.path_group > 1 } else { stats.samples_a_ray > 1 });
            block_sums(&color(&session), SIZE)
        };
        let pictures: Vec<_> = (0..SEEDS).map(&mut picture).collect();
        // a trial may be wrong now and then
        assert!(decided > SEEDS as usize / 2, "{decided}");
        pictures
    };
    for reuse in [0, 1] {
        assert_same_means(&format!("shared {reuse}"), &pictures(0, reuse), &pictures(1, reuse));
    }
}

#[test]
fn rims_have_less_noise() {
    // of pictures of the same samples, pixel by pixel
    let variance = |edge_rays: i64, change: &dyn Fn(&Session)| {
        let session = scene();
        change(&session);
        session.edit(setting("umber:edgeRays", edge_rays)).unwrap();
        let picture = |seed| {
            session.edit(setting("umber:seed", seed)).unwrap();
            finish(&session);
            color(&session)
        };
        let pictures: Vec<_> = (0..SEEDS).map(picture).collect();
        let of_pixel = |i: usize| {
            let mean = pictures.iter().map(|p| f64::from(p[i][0])).sum::<f64>() / SEEDS as f64;
            pictures.iter().map(|p| (f64::from(p[i][0]) - mean).powi(2)).sum::<f64>()
        };
        (0..PIXELS).map(of_pixel).sum::<f64>()
    };
    // of the sky that is reflected there is noise as well
    for (what, most, change) in [
        ("alone", 0.5, &(|_: &Session| {}) as &dyn Fn(&Session)),
        ("lamp smaller than a pixel", 0.1, &|session| {
            add_lamp(session, "/lamp", 0.03, DVec3::new(2.1, 0.9, -2.0), 3000.0)
        }),
        ("before a sky", 0.8, &|session| add_sky(session, 3.0)),
    ] {
        let [without, with] = [0, 1].map(|edge_rays| variance(edge_rays, change));
        println!("{what}: {:.3}", with / without);
        assert!(with < most * without, "{what}: {with} of {without}");
    }
}
