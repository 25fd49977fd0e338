//! Caustics: led to where they come from, paths have the same mean and less variance.

mod common;

use common::*;
use umber_render::Session;

/// Samples a pixel with which the film is worth a search, and with which it is not.
const MANY: i64 = 1024;
const FEW: i64 = MANY / 4;

fn scene(samples: i64) -> Session {
    let session = metal_and_lamp(samples);
    session.edit(setting("enableInteractive", 0)).unwrap();
    // the error at the lamp's edge is not that of caustics
    session.edit(setting("umber:pathSplitting", 0)).unwrap();
    session
}

/// Mean over pixels and seeds, its squared standard error, and the pixels' mean variance by one sample.
fn moments(session: &Session, samples: i64, seeds: i64) -> (f64, f64, f64) {
    let picture = |seed| {
        session.edit(setting("umber:seed", seed)).unwrap();
        finish(session);
        color(session).iter().map(|p| f64::from(p[0] + p[1] + p[2]) / 3.0).collect::<Vec<f64>>()
    };
    let pictures: Vec<_> = (0..seeds).map(picture).collect();
    let (n, pixels) = (seeds as f64, (SIZE * SIZE) as f64);
    let (mut mean, mut variance) = (0.0, 0.0);
    for i in 0..SIZE * SIZE {
        let of_pixel = pictures.iter().map(|p| p[i]).sum::<f64>() / n;
        variance += pictures.iter().map(|p| (p[i] - of_pixel).powi(2)).sum::<f64>() / (n - 1.0);
        mean += of_pixel;
    }
    (mean / pixels, variance / n / pixels.powi(2), variance / pixels * samples as f64)
}

#[test]
fn the_mean_stays_and_the_variance_falls() {
    let (few, few_error, few_variance) = moments(&scene(FEW), FEW, 32);
    let (many, many_error, many_variance) = moments(&scene(MANY), MANY, 8);
    let z = (many - few) / (few_error + many_error).sqrt();
    println!("means {few} and {many}, z {z}; variances of a sample {few_variance} and {many_variance}");
    assert!(z.abs() < 4.0, "{few} and {many}: z = {z}");
    assert!(many_variance < 0.5 * few_variance, "{few_variance} and {many_variance}");
}

#[test]
fn threads_change_nothing() {
    let picture = |threads| {
        let session = scene(MANY);
        session.edit(setting("umber:threads", threads)).unwrap();
        finish(&session);
        color(&session)
    };
    assert_eq!(picture(1), picture(3));
}
