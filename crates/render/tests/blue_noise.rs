//! Pictures of few samples, whose error is blue noise over pixels.

mod common;

use common::*;
use umber_math::{DAffine3, DVec3};
use umber_render::{Aov, FilmDesc, Session};
use umber_scene::{Light, LightId, LightKind, MeshPatch, SceneEdit};
use umber_settings::Value;

/// Pixels to each side.
const SIDE: usize = 64;
/// Standard deviation of the blur that stands for the eye, in pixels.
const EYE: f64 = 1.5;

/// A wall, and a box whose shadow on it is soft.
fn soft_shadow(samples: i64) -> Session {
    let session = session(6.0, samples, &[Aov::Color]);
    session.set_film(FilmDesc::new(SIDE, SIDE, &[Aov::Color]));
    let at = |place: DVec3, size: DVec3| Some(DAffine3::from_translation(place) * DAffine3::from_scale(size));
    let wall = at(DVec3::new(0.0, 0.0, -2.5), DVec3::new(8.0, 8.0, 0.5));
    session.edit(mesh("/wall", MeshPatch { transform: wall, ..cube() })).unwrap();
    session.edit(mesh("/box", MeshPatch { transform: at(DVec3::ZERO, DVec3::splat(0.8)), ..cube() })).unwrap();
    bind(&session, "/wall", "/light", lambert(0.8, 0.0));
    bind(&session, "/box", "/dark", lambert(0.4, 0.0));
    let lamp = Light { intensity: 8.0, ..Light::new(LightKind::Rect { width: 2.0, height: 2.0 }) };
    let lamp = Light { world_from_light: DAffine3::from_translation(DVec3::new(-2.6, 2.2, 4.0)), ..lamp };
    session.edit(SceneEdit::Light(LightId::new("/lamp"), lamp)).unwrap();
    session.edit(setting("umber:maxBounces", 1)).unwrap();
    session
}

fn picture(session: &Session, seed: i64) -> Vec<f64> {
    session.edit(setting("umber:seed", seed)).unwrap();
    finish(session);
    color_of(session, SIDE * SIDE).iter().map(|p| f64::from(p[0])).collect()
}

/// Where nobody watches: with 16 samples or more, each pixel has its points by itself.
fn final_frame(samples: i64) -> Session {
    let session = soft_shadow(samples);
    session.edit(setting("enableInteractive", 0)).unwrap();
    session
}

/// Gaussian blur; beyond the borders is nothing.
fn blurred(picture: &[f64]) -> Vec<f64> {
    let reach = (4.0 * EYE) as i64;
    let along = |picture: &[f64], step: [i64; 2]| -> Vec<f64> {
        let at = |i: usize, offset: i64| {
            let (x, y) = ((i % SIDE) as i64 + offset * step[0], (i / SIDE) as i64 + offset * step[1]);
            let inside = (0..SIDE as i64).contains(&x) && (0..SIDE as i64).contains(&y);
            if inside { picture[y as usize * SIDE + x as usize] } else { 0.0 }
        };
        let weight = |offset: i64| (-(offset * offset) as f64 / (2.0 * EYE * EYE)).exp();
        let sum = (-reach..=reach).map(weight).sum::<f64>();
        let of_pixel = |i| (-reach..=reach).map(|o| weight(o) * at(i, o)).sum::<f64>() / sum;
        (0..picture.len()).map(of_pixel).collect()
    };
    along(&along(picture, [1, 0]), [0, 1])
}

fn rms(a: &[f64], b: &[f64]) -> f64 {
    (a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
}

/// A picture of which every pixel comes from another one of 64 pictures than its neighbours: its error is white noise.
fn mixed(pictures: &[Vec<f64>]) -> Vec<f64> {
    (0..SIDE * SIDE).map(|i| pictures[i % SIDE % 8 * 8 + i / SIDE % 8][i]).collect()
}

/// Root of the mean over pictures of the mean squared error.
fn error(pictures: &[Vec<f64>], reference: &[f64]) -> f64 {
    (pictures.iter().map(|p| rms(p, reference).powi(2)).sum::<f64>() / pictures.len() as f64).sqrt()
}

/// As the eye sees it, the error is smaller than that of pixels which are independent; by itself, each is as good.
#[test]
fn the_error_of_few_samples_is_averaged_by_the_eye() {
    let reference = picture(&final_frame(512), 99);
    let seen = |pictures: &[Vec<f64>]| pictures.iter().map(|p| blurred(p)).collect::<Vec<_>>();
    // in adaptive pictures pixels of either colour differ among themselves, which lie further apart
    for (samples, variance, most) in [(1, -1.0, 0.55), (2, -1.0, 0.95), (8, -1.0, 1.1), (1, 0.0, 0.7), (2, 0.0, 0.98)] {
        let session = soft_shadow(samples);
        session.edit(SceneEdit::Setting("convergedVariance".into(), Value::Float(variance))).unwrap();
        let blue: Vec<_> = (0..64).map(|seed| picture(&session, seed)).collect();
        let turned = |by: usize| [&blue[by..], &blue[..by]].concat();
        let white: Vec<_> = (0..8).map(|i| mixed(&turned(7 * i))).collect();
        let ratio = error(&seen(&blue), &blurred(&reference)) / error(&seen(&white), &blurred(&reference));
        let each = error(&blue, &reference) / error(&white, &reference);
        println!("{samples} samples, variance {variance}: blurred {ratio}, each pixel {each}");
        assert!(ratio < most, "{samples} samples, variance {variance}: {ratio}");
        assert!((each - 1.0).abs() < 0.05, "{samples} samples, variance {variance}: {each}");
    }
}

/// Mean and squared standard error of a block of pixels' mean, over pictures.
fn block(pictures: &[Vec<f64>], pixels: &[usize]) -> (f64, f64) {
    let n = pictures.len() as f64;
    let mean_of = |p: &Vec<f64>| pixels.iter().map(|i| p[*i]).sum::<f64>() / pixels.len() as f64;
    let means: Vec<f64> = pictures.iter().map(mean_of).collect();
    let mean = means.iter().sum::<f64>() / n;
    (mean, means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0) / n)
}

/// Equal counts, and the two colours of adaptive sampling.
#[test]
fn the_mean_over_seeds_is_that_of_final_frames() {
    const BLOCK: usize = 4;
    const ACROSS: usize = SIDE / BLOCK;
    let session = final_frame(16);
    let references: Vec<_> = (0..64).map(|seed| picture(&session, 1000 + seed)).collect();
    for (samples, variance) in [(1, -1.0), (3, -1.0), (4, 0.0)] {
        let session = soft_shadow(samples);
        session.edit(SceneEdit::Setting("convergedVariance".into(), Value::Float(variance))).unwrap();
        let pictures: Vec<_> = (0..96).map(|seed| picture(&session, seed)).collect();
        let z = |pixels: &[usize]| {
            let ((a, va), (b, vb)) = (block(&pictures, pixels), block(&references, pixels));
            (a - b) / (va + vb).sqrt().max(1e-9)
        };
        let of_block = |b: usize| {
            let (x, y) = (b % ACROSS * BLOCK, b / ACROSS * BLOCK);
            z(&(0..BLOCK * BLOCK).map(|i| (y + i / BLOCK) * SIDE + x + i % BLOCK).collect::<Vec<_>>())
        };
        let whole = z(&(0..SIDE * SIDE).collect::<Vec<_>>());
        let scores: Vec<f64> = (0..ACROSS * ACROSS).map(of_block).collect();
        let squares = scores.iter().map(|z| z * z).sum::<f64>() / scores.len() as f64;
        println!("{samples} samples: z of the picture {whole}, mean square over blocks {squares}");
        assert!(whole.abs() < 3.5, "{samples} samples: {whole}");
        assert!(scores.iter().all(|z| z.abs() < 4.5), "{samples} samples: {scores:?}");
        // 256 blocks: the mean square of as many normal numbers is 1 ± 0.09
        assert!(squares < 1.4, "{samples} samples: {squares}");
    }
}

/// Wherever somebody watches, and in final frames of few samples.
#[test]
fn it_is_used_where_few_samples_are_seen() {
    for (samples, the_same) in [(1, true), (15, true), (16, false)] {
        let watched = picture(&soft_shadow(samples), 5);
        assert_eq!(picture(&final_frame(samples), 5) == watched, the_same, "{samples} samples");
    }
}
