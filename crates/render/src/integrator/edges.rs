//! Pixels through which the rim of something that shines runs, and the rays from the camera that their samples take.
//!
//! At the rim of a lamp, or of what stands before a bright sky, most of a pixel's error is how much of it shines. A ray
//! from the camera tells that, and costs little beside a path: so there several of them go before each path, and what
//! shines is their mean ([`Primary`](super::primary::Primary)).
//!
//! Which pixels these are, and how many rays pay, is found before the picture, on a lattice of rays that are no part of
//! it: whatever they find, nothing is biased (Kirk & Arvo 1991, "Unbiased sampling techniques for image synthesis").

mod lamps;
mod lattice;

use rayon::prelude::*;
use umber_settings::{Integrator, Settings};

use self::lattice::{Lattice, Seen};
use super::Stop;
use super::tile::MANY_SAMPLES;
use crate::film::FilmDesc;
use crate::scene::RenderScene;

/// Most rays of a sample.
const MOST_RAYS: f64 = 8.0;
/// How much of a pixel its neighbours' further corners stand for: a lamp may look in between its own.
const SHARE_AROUND: f64 = 0.03;
/// How much of a pixel a small lamp that reaches into it stands for.
const SHARE_OF_LAMP: f64 = 0.05;

/// Rays from the camera of each sample of a pixel.
pub(crate) struct EdgeMap {
    width: usize,
    rays: Vec<u8>,
}

/// Whether edges are looked for.
pub(crate) fn are_looked_for(settings: &Settings) -> bool {
    settings.edge_rays
        && matches!(settings.integrator, Integrator::Path | Integrator::Direct)
        && settings.converged_samples_per_pixel >= MANY_SAMPLES
}

impl EdgeMap {
    /// Looks for edges; `None` where none are found, or where it was stopped. Counts rays.
    pub fn find(scene: &RenderScene, film: &FilmDesc, stop: &Stop<'_>, rays: &mut u64) -> Option<Self> {
        let lamps = lamps::find(scene, film, stop, rays);
        let lattice = Lattice::trace(scene, film, &lamps, stop, rays)?;
        let of_pixel = |i: usize| {
            let [x, y] = [i % film.width, i / film.width];
            if !lattice.is_fine(x, y) {
                return 0;
            }
            rays_for(|corner| lattice.seen([x, y], corner), lamps.get(&i))
        };
        let map: Vec<u8> = (0..film.width * film.height).into_par_iter().map(of_pixel).collect();
        map.iter().any(|rays| *rays > 0).then_some(Self { width: film.width, rays: map })
    }

    /// How many pixels need more rays than others have.
    pub fn pixels(&self) -> u64 {
        self.rays.iter().filter(|rays| **rays > 0).count() as u64
    }

    /// Rays of each sample of the pixel at a column and a row; 0 where it needs no more than others have.
    #[inline]
    pub fn rays(&self, [x, y]: [usize; 2]) -> u32 {
        u32::from(self.rays[y * self.width + x])
    }
}

/// How many rays pay in a pixel, by what is seen at the 16 points of the lattice around it, of which column and row 1
/// and 2 are its corners.
///
/// Of `n` rays at a straight rim, which are spread evenly, the squared error falls about as `n`⁻¹·⁵. Where one ray more
/// is to bring as much as its cost brings elsewhere, their number goes as the relative variance of what shines to the
/// power of 0.4. The factor is reckoned from the errors and costs of 64 samples of many lamps and of the chess set.
fn rays_for(seen: impl Fn([usize; 2]) -> Option<Seen>, lamp: Option<&Seen>) -> u8 {
    let (mut weights, mut emitted, mut squared, mut all) = (0.0, 0.0, 0.0, 0.0);
    let around = (0..16).filter_map(|i| {
        let [column, row] = [i % 4, i / 4];
        let is_corner = (1..3).contains(&column) && (1..3).contains(&row);
        Some((if is_corner { (1.0 - SHARE_AROUND) / 4.0 } else { SHARE_AROUND / 12.0 }, seen([column, row])?))
    });
    for (weight, seen) in around.chain(lamp.map(|lamp| (SHARE_OF_LAMP, *lamp))) {
        weights += weight;
        let [shines, shows] = [seen.emitted, seen.radiance].map(f64::from);
        emitted += weight * shines;
        squared += weight * shines * shines;
        all += weight * shows;
    }
    let variance = (squared * weights - emitted * emitted) / (all * all);
    // not a number where all is black
    let rays = 2.0 * variance.max(0.0).powf(0.4);
    // powers of two: such runs of points are spread best
    if rays >= 0.5f64.sqrt() { rays.min(MOST_RAYS).log2().round().exp2() as u8 } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rays of a pixel that sees `lit` from some of the points of the lattice, in light that all reflect.
    fn rays(lit: f32, reflected: f32, shines: impl Fn(usize, usize) -> bool) -> u8 {
        rays_for(
            |[column, row]| {
                let emitted = if shines(column, row) { lit } else { 0.0 };
                Some(Seen { emitted, radiance: emitted + reflected })
            },
            None,
        )
    }

    #[test]
    fn rims_take_more_rays_the_brighter_they_are_beside_the_pixel() {
        let corner = |column, row| column == 1 && row == 1;
        assert_eq!(rays(1.0, 0.3, |_, _| false), 0);
        assert_eq!(rays(1.0, 0.3, |_, _| true), 0);
        assert_eq!(rays(0.0, 0.0, corner), 0);
        let of = [0.1, 1.0, 100.0].map(|lit| rays(lit, 0.3, corner));
        assert!(of[0] < of[1] && of[1] < of[2], "{of:?}");
        // beside a lamp that may look in, a lamp's light is looked for, and the sky's is not
        let outside = |column, _| column == 0;
        assert_eq!(rays(100.0, 0.3, outside), 8);
        assert!(rays(1.0, 0.3, outside) <= 1);
    }
}
