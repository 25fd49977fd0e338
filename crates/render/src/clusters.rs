//! A mesh's triangles in small groups that lie close together: what a rasteriser draws or passes over at once.

use rayon::prelude::*;
use umber_math::{Bounds3, Point3, Vec3};

/// Triangles of a group, at most.
pub const CLUSTER: usize = 64;
/// Points that are projected at a time.
pub const LANES: usize = 8;
/// Bits of a coordinate by which triangles are sorted.
const BITS: u32 = 10;

/// Eight points: their first coordinates, their second, their third.
pub type PointBlock = [[f32; LANES]; 3];

/// A triangle of a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClusterTriangle {
    /// Its corners, among the group's points.
    pub corners: [u8; 3],
    /// Which of the mesh's it is.
    pub index: u32,
}

/// A group of triangles, with points of its own.
#[derive(Clone, Copy, Debug)]
pub struct Cluster<'a> {
    /// Its points, each once, object space; what the last block has beyond them repeats one.
    pub points: &'a [PointBlock],
    /// Its triangles.
    pub triangles: &'a [ClusterTriangle],
}

/// Groups of triangles.
#[derive(Clone, Debug, Default)]
pub struct Clusters {
    points: Vec<PointBlock>,
    triangles: Vec<ClusterTriangle>,
    /// Of each group, and of their end.
    first_blocks: Vec<u32>,
    bounds: Vec<Bounds3>,
}

impl Clusters {
    /// Groups triangles along a Morton curve. `bounds`: around all.
    pub fn new(points: &[Vec3], triangles: &[[u32; 3]], bounds: Bounds3) -> Self {
        let scale = bounds.size().max(Vec3::splat(f32::MIN_POSITIVE)).recip() * (1 << BITS) as f32 / 3.0;
        let key = |(index, t): (usize, &[u32; 3])| {
            let [a, b, c] = t.map(|i| points[i as usize]);
            // the casts saturate, and take what is not a number for zero
            let cell = ((a + b + c - bounds.min * 3.0) * scale).to_array().map(|v| (v as u32).min((1 << BITS) - 1));
            u64::from(morton(cell)) << 32 | index as u64
        };
        let mut keys: Vec<u64> = triangles.par_iter().enumerate().map(key).collect();
        keys.par_sort_unstable();
        let group = |keys: &[u64]| Group::new(points, triangles, keys.iter().map(|key| *key as u32));
        let groups: Vec<Group> = keys.par_chunks(CLUSTER).map(group).collect();
        let mut all = Self { first_blocks: vec![0], ..Self::default() };
        for group in groups {
            all.points.extend(group.points);
            all.triangles.extend(group.triangles);
            all.first_blocks.push(all.points.len() as u32);
            all.bounds.push(group.bounds);
        }
        all
    }

    /// Bytes they take.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.points)
            + size_of_val(&*self.triangles)
            + size_of_val(&*self.first_blocks)
            + size_of_val(&*self.bounds)
    }
    /// How many groups there are.
    pub fn len(&self) -> usize {
        self.bounds.len()
    }
    /// A box around a group, object space.
    pub fn bounds(&self, cluster: usize) -> Bounds3 {
        self.bounds[cluster]
    }
    /// A group.
    pub fn get(&self, cluster: usize) -> Cluster<'_> {
        let [first, end] = [cluster, cluster + 1].map(|i| self.first_blocks[i] as usize);
        let start = cluster * CLUSTER;
        let triangles = &self.triangles[start..self.triangles.len().min(start + CLUSTER)];
        Cluster { points: &self.points[first..end], triangles }
    }
}

/// A group under construction.
struct Group {
    points: Vec<PointBlock>,
    triangles: Vec<ClusterTriangle>,
    bounds: Bounds3,
}

impl Group {
    /// Of some of a mesh's triangles.
    fn new(points: &[Vec3], triangles: &[[u32; 3]], indices: impl Iterator<Item = u32> + Clone) -> Self {
        let mut used: Vec<u32> = indices.clone().flat_map(|index| triangles[index as usize]).collect();
        used.sort_unstable();
        used.dedup();
        // each triangle has three at most: their numbers fit in a byte
        let local = |point: u32| used.partition_point(|p| *p < point) as u8;
        let triangle = |index: u32| ClusterTriangle { corners: triangles[index as usize].map(local), index };
        let point = |i: &u32| points[*i as usize];
        let block = |used: &[u32]| -> PointBlock {
            std::array::from_fn(|axis| std::array::from_fn(|lane| point(used.get(lane).unwrap_or(&used[0]))[axis]))
        };
        Self {
            points: used.chunks(LANES).map(block).collect(),
            triangles: indices.map(triangle).collect(),
            bounds: Bounds3::of_points(used.iter().map(|i| Point3(point(i)))),
        }
    }
}

/// The bits of three numbers in turn.
fn morton(cell: [u32; 3]) -> u32 {
    let spread = |v: u32| (0..BITS).fold(0, |bits, i| bits | (v >> i & 1) << (3 * i));
    spread(cell[0]) | spread(cell[1]) << 1 | spread(cell[2]) << 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_triangle_is_in_one_group_and_in_its_box() {
        let points: Vec<Vec3> =
            (0..600).map(|i| Vec3::new((i % 7) as f32, (i % 11) as f32, (i * i % 13) as f32)).collect();
        let triangles: Vec<[u32; 3]> = (0..200).map(|i| [i * 3, i * 3 + 1, i * 3 + 2]).collect();
        let bounds = Bounds3::of_points(points.iter().map(|p| Point3(*p)));
        let clusters = Clusters::new(&points, &triangles, bounds);
        assert_eq!(clusters.len(), 200usize.div_ceil(CLUSTER));
        let mut seen = vec![false; triangles.len()];
        for cluster in 0..clusters.len() {
            let around = clusters.bounds(cluster);
            let Cluster { points: blocks, triangles: group } = clusters.get(cluster);
            for triangle in group {
                assert!(!std::mem::replace(&mut seen[triangle.index as usize], true));
                for (local, i) in triangle.corners.into_iter().zip(triangles[triangle.index as usize]) {
                    let (block, lane) = (usize::from(local) / LANES, usize::from(local) % LANES);
                    let point = Vec3::from(blocks[block].map(|lanes| lanes[lane]));
                    assert_eq!(point, points[i as usize]);
                    assert_eq!(around.with_point(Point3(point)), around);
                }
            }
        }
        assert!(seen.iter().all(|s| *s));
    }
}
