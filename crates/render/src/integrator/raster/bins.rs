//! Which clusters of triangles may be seen in which square of the film.

use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use super::super::Stop;
use super::placement::Placement;
use super::project::Grid;
use super::reach::Reach;
use super::shade::is_lit;
use super::square::{SQUARE, Square};
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
        // here, where all threads are at work; each mesh in one job, as what waits for a mesh may not be given it again
        let mut meshes: Vec<u32> = placements.iter().map(|placement| placement.mesh).collect();
        meshes.sort_unstable();
        meshes.dedup();
        meshes.par_iter().map(|mesh| &scene.meshes[*mesh as usize]).filter(|_| !stop.now()).for_each(|mesh| {
            mesh.shape.clusters();
            if is_lit(scene) {
                mesh.cluster_normals();
            }
        });
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
