//! Adaptive sampling, limits of time, the first picture, and the clamp.

mod common;

use std::time::{Duration, Instant};

use common::*;
use umber_render::{Aov, FilmDesc, Session};

fn pictures(session: &Session, seeds: i64) -> Vec<Vec<f64>> {
    let picture = |seed| {
        session.edit(setting("umber:seed", seed)).unwrap();
        finish(session);
        color(session).iter().map(|p| f64::from(p[0] + p[1] + p[2]) / 3.0).collect()
    };
    (0..seeds).map(picture).collect()
}

/// Mean and squared standard error of a block of pixels' mean, over pictures.
fn block(pictures: &[Vec<f64>], pixels: &[usize]) -> (f64, f64) {
    let n = pictures.len() as f64;
    let means: Vec<f64> =
        pictures.iter().map(|p| pixels.iter().map(|i| p[*i]).sum::<f64>() / pixels.len() as f64).collect();
    let mean = means.iter().sum::<f64>() / n;
    (mean, means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0) / n)
}

#[test]
fn the_mean_is_that_of_equal_counts() {
    let session = metal_and_lamp(64);
    session.edit(setting("enableInteractive", 0)).unwrap();
    let equal = pictures(&session, 64);
    session.edit(number("convergedVariance", 0.02)).unwrap();
    let adaptive = pictures(&session, 64);
    // the decision was one: neither all that is allowed, nor the pilot alone
    let taken = session.stats().mean_samples_per_pixel;
    assert!(taken > 17.0 && taken < 60.0, "{taken}");
    let z = |pixels: &[usize]| {
        let ((a, va), (b, vb)) = (block(&adaptive, pixels), block(&equal, pixels));
        (a - b) / (va + vb).sqrt().max(1e-12)
    };
    let all: Vec<usize> = (0..SIZE * SIZE).collect();
    assert!(z(&all).abs() < 3.0, "{}", z(&all));
    const BLOCK: usize = 4;
    let blocks = (0..(SIZE / BLOCK).pow(2)).map(|b| {
        let (x, y) = (b % (SIZE / BLOCK) * BLOCK, b / (SIZE / BLOCK) * BLOCK);
        (0..BLOCK * BLOCK).map(|i| (y + i / BLOCK) * SIZE + x + i % BLOCK).collect::<Vec<_>>()
    });
    let scores: Vec<f64> = blocks.map(|pixels| z(&pixels)).collect();
    let squares = scores.iter().map(|z| z * z).sum::<f64>() / scores.len() as f64;
    println!("{taken} samples, z of the picture {}, rms z of blocks {}", z(&all), squares.sqrt());
    assert!(scores.iter().all(|z| z.abs() < 4.0), "{scores:?}");
    // 36 blocks: the mean square of as many normal numbers is 1 ± 0.24
    assert!(squares < 1.8, "{squares}");
}

#[test]
fn the_same_adaptive_picture_whatever_the_threads_and_the_stops() {
    for interactive in [0, 1] {
        let render = |threads: i64, interrupt: bool, limit: i64| {
            let session = metal_and_lamp(64);
            session.edit(setting("umber:threads", threads)).unwrap();
            session.edit(number("convergedVariance", 0.02)).unwrap();
            session.edit(setting("enableInteractive", interactive)).unwrap();
            session.edit(setting("umber:timeLimit", limit)).unwrap();
            // who watches, or has little time, has the first samples before edges are looked for
            session.edit(setting("umber:edgeRays", interactive)).unwrap();
            while interrupt && !session.is_converged() {
                session.start();
                std::thread::sleep(Duration::from_micros(500));
                session.stop();
            }
            finish(&session);
            let stats = session.stats();
            assert!(stats.relative_variance > 0.0 && stats.percent_done == 100.0);
            (color(&session), stats.mean_samples_per_pixel.to_bits())
        };
        let one = render(1, false, 0);
        assert_eq!(one, render(2, false, 0));
        assert_eq!(one, render(8, false, 0));
        assert_eq!(one, render(2, true, 0));
        // small passes, whoever watches
        assert_eq!(one, render(2, true, 1000));
    }
}

#[test]
fn the_target_is_met_or_all_samples_are_taken() {
    let session = metal_and_lamp(1024);
    session.edit(number("convergedVariance", 0.01)).unwrap();
    finish(&session);
    let stats = session.stats();
    assert!(stats.mean_samples_per_pixel < 1000.0, "{}", stats.mean_samples_per_pixel);
    assert!(stats.relative_variance < 0.015, "{}", stats.relative_variance);
    session.edit(number("convergedVariance", 0.0)).unwrap();
    session.edit(setting("convergedSamplesPerPixel", 40)).unwrap();
    finish(&session);
    // the background has no error: the pilot is enough for it, and nothing is for the rest
    let (mean, least) = (session.stats().mean_samples_per_pixel, session.stats().samples_per_pixel);
    assert!(least == 16 && mean > 25.0 && mean < 40.0, "{mean}, {least}");
    for samples in [1, 2, 3] {
        session.edit(setting("convergedSamplesPerPixel", samples)).unwrap();
        finish(&session);
        assert_eq!(session.stats().mean_samples_per_pixel, samples as f64);
        assert!(color(&session).iter().flatten().all(|v| v.is_finite()));
    }
}

#[test]
fn a_limit_of_time_ends_the_picture() {
    for variance in [-1.0, 0.0] {
        let session = metal_and_lamp(1 << 24);
        session.edit(number("convergedVariance", variance)).unwrap();
        session.edit(setting("enableInteractive", 0)).unwrap();
        session.edit(number("umber:timeLimit", 0.3)).unwrap();
        let started = Instant::now();
        finish(&session);
        let seconds = session.stats().render_seconds;
        assert!((0.3..0.8).contains(&seconds), "{seconds} s, {:?} in all", started.elapsed());
        assert!(color(&session).iter().flatten().all(|v| v.is_finite()));
        assert!(session.stats().percent_done == 100.0 && session.stats().mean_samples_per_pixel > 0.0);
    }
    // too short for anything
    let session = metal_and_lamp(64);
    session.set_film(FilmDesc::new(SIZE, SIZE, &[Aov::Color]));
    session.edit(number("umber:timeLimit", 1e-9)).unwrap();
    finish(&session);
    assert!(color(&session).iter().flatten().all(|v| v.is_finite()));
}

#[test]
fn the_clamp_bounds_every_sample() {
    let session = metal_and_lamp(1);
    let brightest = |session: &Session| {
        finish(session);
        color(session).iter().flat_map(|p| [p[0], p[1], p[2]]).fold(0.0, f32::max)
    };
    assert!(brightest(&session) > 2.0);
    session.edit(number("umber:fireflyClamp", 0.5)).unwrap();
    let clamped = brightest(&session);
    assert!(clamped > 0.499 && clamped <= 0.5001, "{clamped}");
}
