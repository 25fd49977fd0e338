//! What choosing one of many lights costs, and how much noise is left.
//!
//! `cargo run --release -p umber-shading --example light_choice`

use std::time::Instant;

use glam::{DAffine3, DVec3};
use umber_math::{Normal3, Point3};
use umber_sampling::Sampler;
use umber_shading::{Light, LightKind, LightParams, LightSampler, Receiver};

/// Lamps strewn over a city of 100 units: rects and spheres, bright and dim.
fn lamps(count: u32) -> Vec<Light> {
    let lamp = |i: u32| {
        let mut s = Sampler::new(1, [i, 7], 0);
        let ([x, y], [z, w]): ([f32; 2], [f32; 2]) = (s.next_2d().into(), s.next_2d().into());
        let kind = if i.is_multiple_of(2) {
            LightKind::Rect { width: 0.3, height: 0.3 }
        } else {
            LightKind::Sphere { radius: 0.1, treat_as_point: false }
        };
        let turn = DAffine3::from_rotation_x(f64::from(w) * 1.5) * DAffine3::from_rotation_z(f64::from(x) * 6.0);
        let place = DVec3::new(f64::from(x) - 0.5, f64::from(y) - 0.5, 0.05 + 0.1 * f64::from(z)) * 100.0;
        let intensity = 10f32.powf(2.0 * w);
        let render_from_light = DAffine3::from_translation(place) * turn;
        Light::new(&LightParams { render_from_light, intensity, ..LightParams::new(kind) }).expect("a light").0
    };
    (0..count).map(lamp).collect()
}

/// Points of the ground, of walls and of ceilings.
fn receivers() -> Vec<Receiver> {
    let receiver = |i: u32| {
        let mut s = Sampler::new(2, [i, 9], 0);
        let ([x, y], [z, w]): ([f32; 2], [f32; 2]) = (s.next_2d().into(), s.next_2d().into());
        let normal = match i % 4 {
            0 | 1 => Normal3::new(0.0, 0.0, 1.0),
            2 => Normal3::new((w * 6.3).cos(), (w * 6.3).sin(), 0.0),
            _ => Normal3::new(0.0, 0.0, -1.0),
        };
        let height = if i % 4 < 2 { 0.0 } else { z * 10.0 };
        Receiver { point: Point3::new(100.0 * x - 50.0, 100.0 * y - 50.0, height), normal, clearance: 0.0 }
    };
    (0..512).map(receiver).collect()
}

/// Irradiance by one light over the probability of having chosen it.
fn estimate(lights: &[Light], receiver: &Receiver, (index, pmf): (usize, f32), sampler: &mut Sampler) -> f64 {
    let Some(s) = lights[index].sample_for(receiver, sampler.next_2d()) else { return 0.0 };
    f64::from(s.radiance.0.x * s.wi.dot_normal(receiver.normal).max(0.0) / (s.pdf_solid_angle * pmf))
}

struct Outcome {
    /// Mean over the receivers of the variance, over the squared mean irradiance.
    relative_variance: f64,
    nanoseconds: f64,
}

fn measure(
    lights: &[Light],
    receivers: &[Receiver],
    choose: impl Fn(&Receiver, f32) -> Option<(usize, f32)>,
) -> Outcome {
    let samples = 512;
    let (mut variance, mut mean) = (0.0, 0.0);
    for (receiver, number) in receivers.iter().zip(0..) {
        // Known exactly but for where on each light.
        let exact: f64 = (0..lights.len())
            .map(|i| estimate(lights, receiver, (i, 1.0), &mut Sampler::new(5, [number, i as u32], 0)))
            .sum();
        mean += exact / receivers.len() as f64;
        for i in 0..samples {
            let mut s = Sampler::new(i, [number, 1], 0);
            let value = choose(receiver, s.next_1d()).map_or(0.0, |c| estimate(lights, receiver, c, &mut s));
            variance += (value - exact).powi(2) / (samples as f64 * receivers.len() as f64);
        }
    }
    // The fastest round: other work on the machine only slows.
    let (rounds, mut checksum, mut fastest) = (400, 0.0, f64::INFINITY);
    for round in 0..rounds {
        let u = (round as f32 + 0.5) / rounds as f32;
        let started = Instant::now();
        for receiver in receivers {
            checksum += choose(receiver, u).map_or(0.0, |c| c.1);
        }
        fastest = fastest.min(started.elapsed().as_secs_f64());
    }
    let nanoseconds = fastest * 1e9 / receivers.len() as f64;
    assert!(checksum > 0.0);
    Outcome { relative_variance: variance / (mean * mean), nanoseconds }
}

fn main() {
    let receivers = receivers();
    println!("lights   build ms   choice ns   relative variance   evenly   error at the same count");
    for count in [2, 10, 16, 17, 100, 1000, 10_000] {
        let lights = lamps(count);
        let started = Instant::now();
        let sampler = LightSampler::new(&lights, 80.0);
        let build = started.elapsed().as_secs_f64() * 1e3;
        let chosen = measure(&lights, &receivers, |r, u| sampler.sample(r, u));
        let evenly = measure(&lights, &receivers, |_, u| {
            Some((((u * count as f32) as usize).min(lights.len() - 1), 1.0 / count as f32))
        });
        println!(
            "{count:6} {build:10.1} {:11.0} {:19.2} {:8.1} {:25.3}",
            chosen.nanoseconds,
            chosen.relative_variance,
            evenly.relative_variance,
            (chosen.relative_variance / evenly.relative_variance).sqrt(),
        );
    }
}
