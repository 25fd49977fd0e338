//! What a pilot tells of pixels: how much their samples vary, and what they cost.
//!
//! The variance that counts is not that of single samples: points of a pixel are spread evenly, and where that serves,
//! at an edge or in light that comes straight, their mean is far better than as many independent samples would be.
//! So it is read off the means of two runs of samples, the halves of the pilot.

use std::iter::Sum;
use std::ops::{Div, Range};

use glam::DVec3;
use rayon::prelude::*;

use super::color;
use crate::film::{self, Film};

/// Pixels to each side over which means are pooled; and, in several windows, relative variances, of which the geometric
/// mean counts: small windows keep edges, large ones learn of spikes that few pixels met where all could have.
///
/// Measured when the halves of a pixel decided, windows of 2 and 12 took 1.02 to 1.05 times as many rays to the same error
/// on metal, and as many on chess; one of 1 beside these changed nothing, and would often meet no light where that is rare.
const MEAN_RADIUS: usize = 3;
const RADII: [usize; 4] = [2, 4, 8, 16];
/// Pixels to each side over which rays are pooled.
const RAY_RADIUS: usize = 1;

/// What is held to be true of a pixel.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Estimate {
    /// Relative variance times samples, the mean of the channels'.
    pub variance: f64,
    /// Rays of the pilot's samples.
    pub rays: f64,
}

/// What the other colour's pixels tell of those of colour `of`; of others it means nothing. Empty where there are none.
/// `by_tile`: the same of all of a tile.
///
/// Within a window a pixel is held to vary as the square of its rays: what is beside a thing that scatters light again
/// and again, and does not itself, is not taken to be as noisy.
pub(super) fn estimates(film: &Film, of: usize, by_tile: bool) -> Vec<Estimate> {
    let (width, told) = (film.desc().width, 1 - of);
    let Some(pilot) = Pilot::of(film, told) else { return Vec::new() };
    let rays = pooled(&pilot.rays, width, RAY_RADIUS, told);
    let squares: Vec<f64> = rays.iter().map(|rays| rays * rays).collect();
    // a window's variance over what it would be, were each pixel's the square of its rays
    let windows = RADII.map(|radius| {
        let [variances, squares] = [&pilot.variances, &squares].map(|plane| pooled(plane, width, radius, told));
        variances.into_iter().zip(squares).map(|(variance, square)| variance / square).collect::<Vec<_>>()
    });
    let root = 1.0 / RADII.len() as f64;
    // roots first: products could leave what numbers can hold
    let geometric_mean = |i: usize| windows.iter().map(|window| window[i].powf(root)).product::<f64>();
    let all: Vec<f64> = (0..rays.len()).into_par_iter().map(|i| squares[i] * geometric_mean(i)).collect();
    // the mean of the smallest windows is not biased
    let of_smallest: f64 = windows[0].iter().zip(&squares).map(|(window, square)| window * square).sum();
    let of_all: f64 = all.iter().sum();
    let scale = if of_all > 0.0 { of_smallest / of_all } else { 1.0 };
    let estimate = |(variance, rays)| Estimate { variance: scale * variance, rays };
    let estimates: Vec<Estimate> = all.into_iter().zip(rays).map(estimate).collect();
    if by_tile { means_of_tiles(film, of, &estimates) } else { estimates }
}

/// The pilot of the pixels of a colour; 0 in place of the others.
struct Pilot {
    /// Relative variance times samples.
    variances: Vec<f64>,
    rays: Vec<f64>,
}

impl Pilot {
    /// `None` where no pixel has the colour.
    fn of(film: &Film, told: usize) -> Option<Self> {
        let (width, pixels) = (film.desc().width, film.desc().width * film.desc().height);
        let (mut means, mut deviations) = (vec![DVec3::ZERO; pixels], vec![DVec3::ZERO; pixels]);
        let (mut samples, mut rays) = (vec![0.0; pixels], vec![0.0; pixels]);
        let light = film.light();
        for index in 0..film.tile_count() {
            let tile = film.tile(index);
            let places = (0..tile.rect.width * tile.rect.height).map(|i| (i, tile.rect.place(i)));
            for (i, [x, y]) in places.filter(|(_, place)| color(*place) == told) {
                let (at, halves) = (y * width + x, tile.samples.sums(i));
                // where the count of a pixel weighs its light paths, these are no part of what decides about it: the
                // first half went without
                means[at] = if light[told].begins_late() {
                    halves[0].radiance()
                } else {
                    film::radiance(halves) + tile.light(i, &light, at)[told].0.as_dvec3()
                };
                deviations[at] = film::deviation(halves);
                samples[at] = tile.samples.count(i).into();
                rays[at] = tile.samples.rays(i).max(1).into();
            }
        }
        let count = rays.iter().filter(|rays| **rays > 0.0).count();
        let floor = film::error_floor(film::luminance(means.iter().sum::<DVec3>() / count.max(1) as f64));
        let smooth = pooled(&means, width, MEAN_RADIUS, told);
        let variance = |i: usize| samples[i] * film::relative_variance(deviations[i], smooth[i], floor);
        (count > 0).then(|| Self { variances: (0..pixels).map(variance).collect(), rays })
    }
}

/// In place of each pixel of a colour the mean of its tile's.
fn means_of_tiles(film: &Film, of: usize, pixels: &[Estimate]) -> Vec<Estimate> {
    let mut means = vec![Estimate::default(); pixels.len()];
    for index in 0..film.tile_count() {
        let rect = film.tile(index).rect;
        let places = || (0..rect.width * rect.height).map(|i| rect.place(i)).filter(|place| color(*place) == of);
        let at = |[x, y]: [usize; 2]| y * film.desc().width + x;
        let mean = |value: fn(&Estimate) -> f64| {
            places().map(|place| value(&pixels[at(place)])).sum::<f64>() / places().count() as f64
        };
        let mean = Estimate { variance: mean(|pixel| pixel.variance), rays: mean(|pixel| pixel.rays) };
        places().for_each(|place| means[at(place)] = mean);
    }
    means
}

/// Means of the pixels of a colour over windows of 2 · `radius` + 1 pixels square, cut at the borders.
fn pooled<T>(plane: &[T], width: usize, radius: usize, told: usize) -> Vec<T>
where
    T: Copy + Send + Sync + Sum + Div<f64, Output = T>,
{
    let height = plane.len() / width.max(1);
    let window = |at: usize, size: usize| at.saturating_sub(radius)..(at + radius + 1).min(size);
    let told_of = |columns: Range<usize>, y: usize| {
        let first = columns.start + usize::from(color([columns.start, y]) != told);
        (first..columns.end).step_by(2)
    };
    let along: Vec<T> = (0..plane.len())
        .into_par_iter()
        .map(|i| told_of(window(i % width, width), i / width).map(|x| plane[i / width * width + x]).sum())
        .collect();
    let across = |i: usize| {
        let (columns, rows) = (window(i % width, width), window(i / width, height));
        // half of them, and the middle one where they are odd and it has the colour, as the corners do
        let is_of_corner = color([columns.start, rows.start]) == told;
        let count = (columns.len() * rows.len() + usize::from(is_of_corner)) / 2;
        rows.map(|y| along[y * width + i % width]).sum::<T>() / count as f64
    };
    (0..plane.len()).into_par_iter().map(across).collect()
}
