//! The samples of a tile's pixels.

use std::ops::Range;

use umber_math::{Ray, Rgb, Vec2};
use umber_sampling::Sampler;
use umber_settings::{Integrator, Settings};

use super::primary::Primary;
use super::reuse::{self, Groups};
use super::{Goal, RadianceSample, Stop, TileWork, center, dimensions, mirror, path};
use crate::adaptive;
use crate::film::{Film, Samples, TileRect};
use crate::scene::RenderScene;

/// Renders a tile until every pixel has got where `goal` says. Ends early where stopped, between samples.
///
/// Each pixel adds its samples in their own order: the sums do not depend on who renders, nor on how
/// often it was stopped.
pub fn render_tile(scene: &RenderScene, film: &Film, tile: usize, goal: &Goal<'_>, stop: &Stop<'_>) -> TileWork {
    let mut work = TileWork::default();
    let (rect, mut samples, known) = {
        let tile = film.tile(tile);
        (tile.rect, tile.samples.clone(), tile.has_centers())
    };
    let pixels = rect.width * rect.height;
    if film.has_center_aovs() && !known && goal.stride == 1 {
        let hits: Vec<_> = (0..pixels).map(|i| center::trace(scene, rect.place(i), &mut work.rays)).collect();
        film.set_centers(tile, &hits);
    }
    samples.prepare(pixels, goal.parts());
    let pass = Pass { scene, view_min: film.desc().data_window_min, rect, goal, stop };
    if scene.path_group > 1 && goal.stride == 1 {
        pass.sample_in_groups(&mut samples, &mut work);
    } else {
        pass.sample_one_by_one(&mut samples, &mut work);
    }
    film.tile(tile).samples = samples;
    work
}

/// A final frame of at least so many samples a pixel takes every pixel's points by themselves.
pub(super) const MANY_SAMPLES: u32 = 16;

/// Whether the error is to be blue noise over pixels: where pictures of few samples are seen.
fn spreads_blue_noise(settings: &Settings) -> bool {
    settings.enable_interactive || settings.converged_samples_per_pixel < MANY_SAMPLES
}

/// Room for a group's paths, and for the rays from the camera that they begin with.
#[derive(Default)]
struct Members<'a> {
    primaries: Vec<Primary<'a>>,
    paths: Vec<reuse::Path<'a>>,
}

/// A tile in a pass.
struct Pass<'a> {
    scene: &'a RenderScene,
    /// Where the film lies in the view.
    view_min: [i32; 2],
    rect: TileRect,
    goal: &'a Goal<'a>,
    stop: &'a Stop<'a>,
}

impl<'a> Pass<'a> {
    /// Samples that the pixel at a column and a row is to have.
    fn count(&self, [x, y]: [usize; 2]) -> u32 {
        self.goal.count(x, y)
    }

    /// Brings one pixel after the other to its count, until it is stopped.
    fn sample_one_by_one(&self, samples: &mut Samples, work: &mut TileWork) {
        for i in 0..self.rect.width * self.rect.height {
            let [x, y] = self.rect.place(i);
            let stride = self.goal.stride;
            if stride > 1 && (x % stride != 0 || y % stride != 0) {
                continue;
            }
            if self.stop.late() {
                return;
            }
            let is_whole = match self.scene.settings.integrator {
                Integrator::Mirror => self.sample_mirror([x, y], samples, i, work),
                _ => self.sample_paths([x, y], samples, i, work),
            };
            if !is_whole {
                return;
            }
        }
    }

    /// Brings pixel `i` to its count by paths; false where stopped.
    fn sample_paths(&self, place: [usize; 2], samples: &mut Samples, i: usize, work: &mut TileWork) -> bool {
        let count = self.count(place);
        let mut begin = samples.count(i);
        while begin < count {
            let group = self.scene.splitting.group(begin);
            let primary = self.primary(place, begin, &mut work.rays);
            let end = group.end.min(count);
            for number in begin..end {
                if self.stop.cancelled() {
                    return false;
                }
                let mut rays = 0;
                let sample = path::radiance(&primary, &mut self.sampler(place, number), &mut rays);
                self.add(samples, i, number, sample, rays, work);
            }
            begin = end;
        }
        true
    }

    /// Brings pixel `i` to its count by mirrored rays; false where stopped.
    fn sample_mirror(&self, place: [usize; 2], samples: &mut Samples, i: usize, work: &mut TileWork) -> bool {
        for number in samples.count(i)..self.count(place) {
            if self.stop.cancelled() {
                return false;
            }
            let mut rays = 0;
            let sampler = || self.sampler(place, number);
            let sample = if number == 0 {
                mirror::radiance(self.scene, self.ray(place, Vec2::splat(0.5)), sampler, &mut rays)
            } else {
                let mut sampler = sampler();
                mirror::radiance(self.scene, self.jittered_ray(place, &mut sampler), || sampler, &mut rays)
            };
            self.add(samples, i, number, sample, rays, work);
        }
        true
    }

    /// Brings groups of pixels, which share their paths, to one count after the other, until it is stopped.
    fn sample_in_groups(&self, samples: &mut Samples, work: &mut TileWork) {
        let rect = self.rect;
        let count = rect.width * rect.height;
        let most = (0..count).map(|i| self.count(rect.place(i))).max().unwrap_or(0);
        let least = (0..count).map(|i| samples.count(i)).min().unwrap_or(0);
        let groups =
            Groups::new(self.scene.path_group, self.scene.settings.seed.into(), self.in_view([rect.x, rect.y]));
        let mut pixels = Vec::with_capacity(count);
        let mut members = Members::default();
        reuse::runs(least..most).all(|run| {
            (0..self.goal.parts()).all(|part| {
                let is_in = |place: &[usize; 2]| self.goal.part(*place) == part && self.count(*place) > run.start;
                pixels.clear();
                pixels.extend((0..count).map(|i| rect.place(i)).filter(is_in));
                groups.each(&mut pixels, run.start, &mut |group| {
                    self.sample_group(group, run.clone(), samples, &mut members, work)
                })
            })
        });
    }

    /// Takes a run of samples of those pixels of a group that are to have them; false where stopped.
    fn sample_group(
        &self,
        group: &[[usize; 2]],
        run: Range<u32>,
        samples: &mut Samples,
        Members { primaries, paths }: &mut Members<'a>,
        work: &mut TileWork,
    ) -> bool {
        let mut end = 0;
        for number in run {
            let members = || (0..).zip(group).filter(|(_, place)| self.count(**place) > number);
            // they have their samples all together
            let is_done = |place: &[usize; 2]| samples.count(self.rect.index(*place)) > number;
            if members().next().is_none_or(|(_, place)| is_done(place)) {
                continue;
            }
            if self.stop.now() {
                return false;
            }
            if number >= end {
                end = self.scene.splitting.group(number).end;
                primaries.clear();
                primaries.extend(group.iter().map(|place| self.primary(*place, number, &mut work.rays)));
            }
            paths.clear();
            paths.extend(members().map(|(member, &place): (usize, _)| {
                reuse::trace(&primaries[member], &mut self.sampler(place, number))
            }));
            reuse::share(self.scene, paths);
            for (path, (member, &place)) in paths.iter().zip(members()) {
                let sample = primaries[member].sample(path.reflected);
                self.add(samples, self.rect.index(place), number, sample, path.rays, work);
            }
        }
        true
    }

    /// Adds sample number `number` of pixel `i`, which took so many rays. Those from the camera that it may share with
    /// others are one more of the first one's, however many they are.
    #[inline]
    fn add(
        &self,
        samples: &mut Samples,
        i: usize,
        number: u32,
        sample: RadianceSample,
        rays: u64,
        work: &mut TileWork,
    ) {
        samples.add(i, self.goal.half(number), kept(self.scene, sample.radiance), sample.coverage);
        if self.goal.parts() > 1 {
            let is_first = self.scene.splitting.group(number).start == number;
            samples.add_rays(i, rays + u64::from(is_first));
        }
        work.samples += 1;
        work.rays += rays;
    }

    /// The number of a pixel within the whole view, so that a part of it has the same samples, where paths are neither
    /// shared nor split, and no edges are found: groups end with the film, and trials and searches are made of it.
    fn in_view(&self, [x, y]: [usize; 2]) -> [u32; 2] {
        [(x as i32 + self.view_min[0]) as u32, (y as i32 + self.view_min[1]) as u32]
    }
    /// The points of a sample of a pixel.
    fn sampler(&self, place: [usize; 2], number: u32) -> Sampler {
        let (seed, pixel) = (self.scene.settings.seed.into(), self.in_view(place));
        match () {
            () if !spreads_blue_noise(&self.scene.settings) => Sampler::new(seed, pixel, number),
            () if self.goal.parts() > 1 => adaptive::blue_noise(seed, pixel, number),
            () => Sampler::blue_noise(seed, pixel, number),
        }
    }
    fn ray(&self, [x, y]: [usize; 2], in_pixel: Vec2) -> Ray {
        self.scene.camera.ray(Vec2::new(x as f32, y as f32) + in_pixel)
    }
    fn jittered_ray(&self, place: [usize; 2], sampler: &mut Sampler) -> Ray {
        sampler.start_dimension(dimensions::FILM);
        self.ray(place, sampler.next_2d())
    }

    /// What sample number `number` of a pixel begins with, and those that share its rays from the camera.
    fn primary(&self, place: [usize; 2], number: u32, rays: &mut u64) -> Primary<'a> {
        let corner = Vec2::new(place[0] as f32, place[1] as f32);
        let draw = |number| self.sampler(place, number);
        Primary::of_samples(self.scene, corner, number, self.scene.splitting, draw, rays)
    }
}

/// What a pixel keeps of a sample's radiance.
pub(super) fn kept(scene: &RenderScene, radiance: Rgb) -> Rgb {
    clamped(finite(radiance), scene.settings.firefly_clamp)
}

/// Whether [`kept`] changes none of some channels, at a setting of `umber:fireflyClamp`.
#[inline(always)]
pub(super) fn keeps(clamp: f32, channels: &[f32]) -> bool {
    let largest = if clamp > 0.0 { clamp.min(LARGEST) } else { LARGEST };
    channels.iter().fold(true, |all, v| all & (*v >= 0.0) & (*v <= largest))
}

/// The same hue, with no channel above `largest`; 0 is no bound.
fn clamped(radiance: Rgb, largest: f32) -> Rgb {
    let channel = radiance.max_channel();
    if largest > 0.0 && channel > largest { radiance * (largest / channel) } else { radiance }
}

/// What a channel is cut to.
const LARGEST: f32 = 1e30;

/// Nothing may poison a pixel: what is not a number counts as black, what is too large is cut.
pub(crate) fn finite(radiance: Rgb) -> Rgb {
    if radiance.0.is_nan() { Rgb::BLACK } else { Rgb(radiance.0.clamp(glam::Vec3::ZERO, glam::Vec3::splat(LARGEST))) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn what_is_kept_as_it_is_is_known_beforehand() {
        for clamp in [0.0, 2.0] {
            for odd in [0.0, 1.0, 2.0, 2.0f32.next_up(), 1e30, 1e30f32.next_up(), f32::INFINITY, f32::NAN, -1.0] {
                for place in 0..3 {
                    let mut channels = [0.5; 3];
                    channels[place] = odd;
                    let color = Rgb(Vec3::from(channels));
                    assert_eq!(keeps(clamp, &channels), clamped(finite(color), clamp) == color, "{odd}, clamp {clamp}");
                }
            }
        }
    }
}
