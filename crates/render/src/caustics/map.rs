//! Where caustics lie, and from where their light comes.

use std::array;

use rayon::prelude::*;
use rustc_hash::FxHashMap;
use umber_math::{Point3, Vec3};

use super::aim::{PLACES, Places};
use crate::light_tracing::Landing;

/// Edge of a cell at a distance of 1 from the camera.
const CELL: f32 = 1.0 / 64.0;
/// A reflection counts as a caustic where, met by a ray of the BSDF, it is so many times what direct light gives.
const BRIGHT: f32 = 4.0;
/// More landings, where most surfaces are smooth, would take long to sort.
const MOST_LANDINGS: usize = 1 << 16;
/// Of the distance between two places, the radius that each gets; and the least and the most, of a cell's edge.
const RADIUS: f32 = 1.5;
const RADIUS_BOUNDS: [f32; 2] = [0.02, 1.0];

/// The cells of space that caustics lie in, and for each the places that they come from.
#[derive(Debug)]
pub(crate) struct CausticMap {
    eye: Point3,
    /// Numbers of their places.
    cells: FxHashMap<Cell, u32>,
    places: Vec<Places>,
}

/// A cube of space, by a number of its own. They grow with the distance from the camera, by powers of two.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
struct Cell(u64);

impl Cell {
    /// That of a point, given from the camera.
    #[inline]
    fn of(point: Vec3) -> Self {
        const EXPONENT_BITS: u32 = 8;
        const BIAS: i32 = 127;
        let exponent = (point.length_squared().to_bits() >> (31 - EXPONENT_BITS) & 0xff) as i32 - BIAS;
        let level = exponent >> 1;
        // a level is at most half an exponent: its power is a normal number
        let at = (point * (power_of_two(-level) / CELL)).floor().as_i16vec3();
        let bits = |i: i16| u64::from(i as u16);
        Self(bits(level as i16) << 48 | bits(at.x) << 32 | bits(at.y) << 16 | bits(at.z))
    }
    /// Power of two of the edge, over [`CELL`].
    fn level(self) -> i32 {
        i32::from((self.0 >> 48) as i16)
    }
    fn edge(self) -> f32 {
        CELL * power_of_two(self.level())
    }
    /// That of a point and those of the points one edge away along each axis, each cell once.
    fn around(point: Vec3) -> impl Iterator<Item = Self> {
        let edge = Self::of(point).edge();
        let step = |i: usize, shift: u32| (i / 3usize.pow(shift) % 3) as f32 * edge - edge;
        let mut cells: [Self; 27] = array::from_fn(|i| Self::of(point + Vec3::new(step(i, 0), step(i, 1), step(i, 2))));
        cells.sort_unstable();
        (0..cells.len()).filter(move |i| *i == 0 || cells[*i] != cells[*i - 1]).map(move |i| cells[i])
    }
}

#[inline]
fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits(((exponent + 127) as u32) << 23)
}

impl CausticMap {
    /// Seen from `eye`, from where light paths landed; `None` where no caustics are found.
    pub fn new(eye: Point3, landings: &[Landing]) -> Option<Self> {
        let (cells, places): (Vec<Cell>, Vec<Places>) = cells(&landings[..landings.len().min(MOST_LANDINGS)], eye);
        // few bytes a cell, as most points are in none
        let cells: FxHashMap<Cell, u32> = cells.into_iter().zip(0..).collect();
        (!cells.is_empty()).then_some(Self { eye, cells, places })
    }

    /// The places that caustics at a point come from; `None` where there are none.
    #[inline]
    pub fn places(&self, point: Point3) -> Option<&Places> {
        self.cells.get(&Cell::of(point.0 - self.eye.0)).map(|number| &self.places[*number as usize])
    }
}

/// The cells that caustics lie in, seen from `eye`, and for each the places that they come from.
fn cells(landings: &[Landing], eye: Point3) -> (Vec<Cell>, Vec<Places>) {
    // each counts in the cells around its own too: few landings are to fill many cells
    let of_landing =
        |(i, landing): (usize, &Landing)| Cell::around(landing.point.0 - eye.0).map(move |cell| (cell, i as u32));
    let mut entries: Vec<(Cell, u32)> = landings.par_iter().enumerate().flat_map_iter(of_landing).collect();
    entries.par_sort_unstable();
    let cells = entries.par_chunk_by(|a, b| a.0 == b.0).filter_map(|entries| {
        let cell = entries[0].0;
        Some((cell, places(entries.iter().map(|(_, i)| &landings[*i as usize]), cell.edge())?))
    });
    cells.unzip()
}

/// The places that a cell's caustics come from: of all, as often as they matter. `None` where nothing is a caustic.
fn places<'a>(landings: impl ExactSizeIterator<Item = &'a Landing> + Clone, edge: f32) -> Option<Places> {
    let direct = landings.clone().map(|landing| landing.direct).sum::<f32>() / landings.len() as f32;
    let bright = || landings.clone().filter(|landing| landing.reflected > BRIGHT * direct);
    let sum: f64 = bright().map(|landing| f64::from(landing.weight)).sum();
    // systematic resampling: one for each PLACES-th part of the weights
    let (mut passed, mut count, mut centers) = (0.0, 0, [Point3::default(); PLACES]);
    for landing in bright() {
        passed += f64::from(landing.weight) / sum;
        while count < PLACES && (count as f64 + 0.5) / PLACES as f64 <= passed {
            centers[count] = landing.origin;
            count += 1;
        }
    }
    if count < PLACES {
        return None;
    }
    // the same follow each other
    let mut last = (centers[0], radius(centers[0], &centers, edge));
    let sphere = |center: Point3| {
        if center != last.0 {
            last = (center, radius(center, &centers, edge));
        }
        last
    };
    Some(Places::new(centers.map(sphere)))
}

/// How far around a place there may be others: as far as from it to the second of those that are known.
fn radius(center: Point3, centers: &[Point3; PLACES], edge: f32) -> f32 {
    let [mut nearest, mut second] = [f32::INFINITY; 2];
    for distance in centers.map(|other| other.distance(center)) {
        if 0.0 < distance && distance < nearest {
            (nearest, second) = (distance, nearest);
        } else if nearest < distance && distance < second {
            second = distance;
        }
    }
    let [least, most] = RADIUS_BOUNDS.map(|bound| bound * edge);
    let known = [second, nearest].into_iter().find(|distance| distance.is_finite());
    known.map_or(0.25 * edge, |distance| (RADIUS * distance).clamp(least, most))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_grow_with_the_distance() {
        let of = |x: f32| Cell::of(Vec3::new(x, 0.0, 0.0));
        assert_eq!(
            (of(1.0).edge(), of(1.9).edge(), of(2.0).edge(), of(1024.0).edge()),
            (CELL, CELL, 2.0 * CELL, 1024.0 * CELL)
        );
        let [a, b] = [1.001, 1.001 + CELL].map(of);
        assert_eq!((a.level(), b.0 - a.0), (0, 1 << 32));
        assert_eq!(of(1.999).level() + 1, of(2.001).level());
        for odd in [0.0, f32::MIN_POSITIVE, 1e-30, 1e30, f32::MAX, f32::INFINITY, f32::NAN, -f32::NAN] {
            assert!(of(odd).edge() > 0.0);
        }
    }

    #[test]
    fn what_lies_around_a_point_has_each_cell_once() {
        assert_eq!(Cell::around(Vec3::new(0.0, 0.0, 1.5)).count(), 27);
        // where cells grow, cells of both sizes
        let around: Vec<_> = Cell::around(Vec3::new(0.0, 0.0, 2.0)).collect();
        assert!(around.windows(2).all(|pair| pair[0] < pair[1]));
        assert!(around.iter().any(|cell| cell.level() == 0) && around.iter().any(|cell| cell.level() == 1));
    }

    fn landing(x: f32, weight: f32, reflected: f32) -> Landing {
        Landing { point: Point3::default(), origin: Point3(Vec3::new(x, 0.0, 0.0)), weight, reflected, direct: 1.0 }
    }

    #[test]
    fn places_are_as_many_as_their_weights() {
        let landings = [landing(1.0, 3.0, 100.0), landing(2.0, 1.0, 100.0), landing(3.0, 100.0, 2.0)];
        let at = |x: f32| (Point3(Vec3::new(x, 0.0, 0.0)), 0.75f32);
        let expected: [_; PLACES] = array::from_fn(|i| at(if i < 6 { 1.0 } else { 2.0 }));
        // what is no brighter than direct light is no caustic, whatever its weight
        let edge = 0.75;
        let [a, b, c] = &landings;
        assert_eq!(places([a, b, c].into_iter(), edge), Some(Places::new(expected)));
        assert_eq!(places([c].into_iter(), edge), None);
    }

    #[test]
    fn places_reach_as_far_as_the_second_of_the_others() {
        let at = |x: f32| Point3(Vec3::new(x, 0.0, 0.0));
        let mut centers = [at(0.0); PLACES];
        let radius = |centers: &_| radius(at(0.0), centers, 100.0);
        assert_eq!(radius(&centers), 25.0);
        // however often each is there
        centers[5] = at(3.0);
        assert_eq!(radius(&centers), 4.5);
        centers[2] = at(3.0);
        assert_eq!(radius(&centers), 4.5);
        (centers[3], centers[6]) = (at(5.0), at(4.0));
        assert_eq!(radius(&centers), 6.0);
    }
}
