//! Which clusters of triangles may be seen in which square of the film.

use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;
use umber_math::{Point3, Vec3};

use super::super::Stop;
use super::placement::Placement;
use super::project::Grid;
use super::reach::Reach;
use super::square::{NOTHING, SQUARE, Square};
use crate::clusters::{CLUSTER, Cluster, LANES};
use crate::scene::RenderScene;

/// Clusters that one thread looks at, at a time.
const RUN: usize = 256;

/// A cluster of a placement, in a square that it may be seen in.
#[derive(Clone, Copy, Debug, Default)]
pub struct Entry {
    /// Its nearness at most.
    pub nearness: f32,
    /// Index of the placement.
    pub placement: u32,
    /// Index of the cluster in the placement's mesh.
    pub cluster: u32,
    /// First and last column, first and last row of the square that it may cover.
    pub pixels: [[u8; 2]; 2],
}

/// An entry with its triangles at hand.
#[derive(Clone, Copy, Debug)]
pub struct Piece<'a> {
    /// Where it may be seen.
    pub entry: Entry,
    /// Its triangles.
    pub cluster: Cluster<'a>,
}

impl<'a> Piece<'a> {
    /// That of an entry.
    #[inline]
    pub fn new(scene: &'a RenderScene, placements: &[Placement], entry: Entry) -> Self {
        let clusters = placements[entry.placement as usize].mesh(scene).shape.clusters();
        Self { entry, cluster: clusters.get(entry.cluster as usize) }
    }
}

/// More entries of a square, 67 million, have no numbers left: of those in front that many are drawn.
pub const MOST_ENTRIES: usize = NOTHING as usize / CLUSTER;

/// Number of a triangle among those of a square's pieces, of which there are [`MOST_ENTRIES`].
#[inline(always)]
pub fn number(piece: usize, triangle: u32) -> u32 {
    (piece * CLUSTER) as u32 + triangle
}

/// What has a number.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    /// Index of the placement.
    pub placement: u32,
    /// Triangle of its mesh.
    pub triangle: u32,
    /// The cluster that has it.
    cluster: Cluster<'a>,
    /// Its corners there.
    corners: [u8; 3],
}

impl<'a> Seen<'a> {
    /// By its number among the pieces of a square.
    #[inline(always)]
    pub fn new(pieces: &[Piece<'a>], number: u32) -> Self {
        let (Piece { entry, cluster }, at) = (pieces[number as usize / CLUSTER], number as usize % CLUSTER);
        Self { placement: entry.placement, triangle: cluster.indices[at], cluster, corners: cluster.corners[at] }
    }

    /// Its corners, object space.
    #[inline(always)]
    pub fn corners(&self) -> [Point3; 3] {
        let [a, b, c] = self.corners;
        [self.corner(a), self.corner(b), self.corner(c)]
    }

    #[inline(always)]
    fn corner(&self, number: u8) -> Point3 {
        let (block, lane) = (&self.cluster.points[usize::from(number) / LANES], usize::from(number) % LANES);
        Point3(Vec3::new(block[0][lane], block[1][lane], block[2][lane]))
    }

    /// Of what is as near, the smallest is seen: the one that a ray meets first.
    pub fn rank(&self) -> (u32, u32) {
        (self.placement, self.triangle)
    }
}

/// The entries of all squares.
#[derive(Debug, Default)]
pub struct Bins {
    entries: Vec<Entry>,
    /// Index of each square's first entry, and of the end.
    starts: Vec<usize>,
}

impl Bins {
    /// Of all clusters; some where stopped.
    pub fn new(scene: &RenderScene, grid: &Grid, placements: &[Placement], stop: &Stop<'_>) -> Self {
        // here, where all threads are at work
        placements.par_iter().filter(|_| !stop.now()).for_each(|placement| _ = placement.mesh(scene).shape.clusters());
        let runs: Vec<(usize, Range<usize>)> = (0..placements.len())
            .filter(|_| !stop.now())
            .flat_map(|placement| {
                let count = placements[placement].mesh(scene).shape.clusters().len();
                let ranges = (0..count).step_by(RUN).map(move |start| start..(start + RUN).min(count));
                ranges.map(move |clusters| (placement, clusters))
            })
            .collect();
        let found = |(placement, clusters): &(usize, Range<usize>)| {
            let mut found = Vec::with_capacity(if stop.now() { 0 } else { 2 * RUN });
            if !stop.now() {
                let reaches = Reaches { scene, grid, placement: &placements[*placement], clusters: clusters.clone() };
                for (cluster, reach) in Arch::new().dispatch(reaches) {
                    let entry = Entry { placement: *placement as u32, cluster, ..Entry::default() };
                    spread(grid, entry, &reach, |square, entry| found.push((square, entry)));
                }
            }
            found
        };
        let found: Vec<Vec<(usize, Entry)>> = runs.par_iter().map(found).collect();
        Self::sorted(Square::counts(grid).into_iter().product(), &found)
    }

    /// By the squares, of which there are `count`.
    fn sorted(count: usize, found: &[Vec<(usize, Entry)>]) -> Self {
        let mut ends = vec![0; count + 1];
        found.iter().flatten().for_each(|(square, _)| ends[square + 1] += 1);
        for i in 0..count {
            ends[i + 1] += ends[i];
        }
        let starts = ends.clone();
        let mut entries = vec![Entry::default(); ends[count]];
        for (square, entry) in found.iter().flatten() {
            entries[ends[*square]] = *entry;
            ends[*square] += 1;
        }
        Self { entries, starts }
    }

    /// How many squares there are.
    pub fn square_count(&self) -> usize {
        self.starts.len() - 1
    }
    /// The entries of a square, in no order.
    pub fn square(&self, index: usize) -> &[Entry] {
        &self.entries[self.starts[index]..self.starts[index + 1]]
    }
}

/// Finds what clusters of a placement reach, those that reach anything; compiled for the processor's vector unit.
struct Reaches<'a> {
    scene: &'a RenderScene,
    grid: &'a Grid,
    placement: &'a Placement,
    clusters: Range<usize>,
}

impl WithSimd for Reaches<'_> {
    type Output = Vec<(u32, Reach)>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let clusters = self.placement.mesh(self.scene).shape.clusters();
        let mut reaches = Vec::with_capacity(self.clusters.len());
        for cluster in self.clusters {
            if let Some(reach) = self.grid.reach(&self.placement.film_from_object, clusters.bounds(cluster)) {
                reaches.push((cluster as u32, reach));
            }
        }
        reaches
    }
}

/// Calls `take` with each square that is reached.
fn spread(grid: &Grid, entry: Entry, reach: &Reach, mut take: impl FnMut(usize, Entry)) {
    let [columns, _] = Square::counts(grid);
    let edge = SQUARE as i32;
    let [[x0, x1], [y0, y1]] = reach.pixels;
    // first and last pixel of a square, of those from `low` to `high`
    let part = |square: i32, low: i32, high: i32| {
        [(low - square * edge).max(0) as u8, (high - square * edge).min(edge - 1) as u8]
    };
    for row in y0 / edge..=y1 / edge {
        for column in x0 / edge..=x1 / edge {
            let pixels = [part(column, x0, x1), part(row, y0, y1)];
            take(row as usize * columns + column as usize, Entry { nearness: reach.nearness, pixels, ..entry });
        }
    }
}
