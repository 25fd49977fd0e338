//! A mesh's triangles in small groups that lie close together: what a rasteriser draws or passes over at once.

use std::ops::Range;

use rayon::prelude::*;
use umber_bvh::prefetch;
use umber_math::{Bounds3, Point3, Vec3};

/// Triangles of a group, at most.
pub const CLUSTER: usize = 64;
/// Points that are projected at a time.
pub const LANES: usize = 8;
/// Triangles that one thread sorts by itself.
const SORTED_ALONE: usize = 1 << 12;

/// Eight points: their first coordinates, their second, their third.
pub type PointBlock = [[f32; LANES]; 3];

/// A group of triangles, with points of its own.
#[derive(Clone, Copy, Debug)]
pub struct Cluster<'a> {
    /// Its points, each once, object space; what the last block has beyond them repeats one.
    pub points: &'a [PointBlock],
    /// Corners of its triangles, among its points.
    pub corners: &'a [[u8; 3]],
    /// Which of the mesh's triangles those are.
    pub indices: &'a [u32],
}

impl Cluster<'_> {
    /// Asks for its points and corners, which drawing it reads.
    #[inline(always)]
    pub fn prefetch(&self) {
        prefetch(self.points);
        prefetch(self.corners);
    }
}

/// Groups of triangles.
#[derive(Clone, Debug, Default)]
pub struct Clusters {
    points: Vec<PointBlock>,
    corners: Vec<[u8; 3]>,
    indices: Vec<u32>,
    /// Of each group, and of their end.
    first_blocks: Vec<u32>,
    bounds: Vec<Bounds3>,
}

impl Clusters {
    /// Groups triangles: halves them by where they are, until few are left.
    pub fn new(points: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let center = |(index, t): (usize, &[u32; 3])| {
            let [a, b, c] = t.map(|i| points[i as usize]);
            (a + b + c, index as u32)
        };
        let mut order: Vec<(Vec3, u32)> = triangles.par_iter().enumerate().map(center).collect();
        halve(&mut order);
        let group = |order: &[(Vec3, u32)]| Group::new(points, triangles, order.iter().map(|(_, index)| *index));
        let groups: Vec<Group> = order.par_chunks(CLUSTER).map(group).collect();
        let mut all = Self { first_blocks: vec![0], ..Self::default() };
        for group in groups {
            all.points.extend(group.points);
            all.corners.extend(group.corners);
            all.indices.extend(group.indices);
            all.first_blocks.push(all.points.len() as u32);
            all.bounds.push(group.bounds);
        }
        all
    }

    /// Bytes they take.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.points)
            + size_of_val(&*self.corners)
            + size_of_val(&*self.indices)
            + size_of_val(&*self.first_blocks)
            + size_of_val(&*self.bounds)
    }
    /// How many groups there are.
    pub fn len(&self) -> usize {
        self.bounds.len()
    }
    /// How many points all groups have.
    pub fn point_count(&self) -> usize {
        self.points.len() * LANES
    }
    /// A box around a group, object space.
    pub fn bounds(&self, cluster: usize) -> Bounds3 {
        self.bounds[cluster]
    }
    /// Values at the points of all groups, of what gives those at the corners of any of the mesh's triangles; numbered
    /// as [`Clusters::points`] says.
    pub fn at_points<T: Copy + Default + Send>(&self, at_corners: impl Fn(u32) -> [T; 3] + Sync) -> Vec<T> {
        let of_group = |cluster: usize| {
            let mut values = vec![T::default(); self.points(cluster).len()];
            let Cluster { corners, indices, .. } = self.get(cluster);
            for (numbers, index) in corners.iter().zip(indices) {
                for (number, value) in numbers.iter().zip(at_corners(*index)) {
                    values[usize::from(*number)] = value;
                }
            }
            values
        };
        let groups: Vec<Vec<T>> = (0..self.len()).into_par_iter().map(of_group).collect();
        groups.concat()
    }
    /// Which of all groups' points are a group's.
    pub fn points(&self, cluster: usize) -> Range<usize> {
        let [first, end] = [cluster, cluster + 1].map(|i| self.first_blocks[i] as usize * LANES);
        first..end
    }
    /// A group.
    pub fn get(&self, cluster: usize) -> Cluster<'_> {
        let [first, end] = [cluster, cluster + 1].map(|i| self.first_blocks[i] as usize);
        let triangles = cluster * CLUSTER..self.indices.len().min((cluster + 1) * CLUSTER);
        let (corners, indices) = (&self.corners[triangles.clone()], &self.indices[triangles]);
        Cluster { points: &self.points[first..end], corners, indices }
    }
}

/// A group under construction.
struct Group {
    points: Vec<PointBlock>,
    corners: Vec<[u8; 3]>,
    indices: Vec<u32>,
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
        let point = |i: &u32| points[*i as usize];
        let block = |used: &[u32]| -> PointBlock {
            std::array::from_fn(|axis| std::array::from_fn(|lane| point(used.get(lane).unwrap_or(&used[0]))[axis]))
        };
        Self {
            points: used.chunks(LANES).map(block).collect(),
            corners: indices.clone().map(|index| triangles[index as usize].map(local)).collect(),
            indices: indices.collect(),
            bounds: Bounds3::of_points(used.iter().map(|i| Point3(point(i)))),
        }
    }
}

/// Sorts what lies somewhere so that each [`CLUSTER`] of them lie close together: across the longest side of the box
/// around them into halves, and those in turn.
fn halve(order: &mut [(Vec3, u32)]) {
    if order.len() <= CLUSTER {
        return;
    }
    let size = Bounds3::of_points(order.iter().map(|(center, _)| Point3(*center))).size();
    let axis = if size.max_element() == size.x { 0 } else { 1 + usize::from(size.z > size.y) };
    let middle = (order.len() / 2).next_multiple_of(CLUSTER);
    order.select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
    let (low, high) = order.split_at_mut(middle);
    if low.len() > SORTED_ALONE {
        rayon::join(|| halve(low), || halve(high));
    } else {
        halve(low);
        halve(high);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_triangle_is_in_one_group_and_in_its_box() {
        let points: Vec<Vec3> =
            (0..600).map(|i| Vec3::new((i % 7) as f32, (i % 11) as f32, (i * i % 13) as f32)).collect();
        let triangles: Vec<[u32; 3]> = (0..200).map(|i| [i * 3, i * 3 + 1, i * 3 + 2]).collect();
        let clusters = Clusters::new(&points, &triangles);
        assert_eq!(clusters.len(), 200usize.div_ceil(CLUSTER));
        let mut seen = vec![false; triangles.len()];
        for cluster in 0..clusters.len() {
            let around = clusters.bounds(cluster);
            let Cluster { points: blocks, corners, indices } = clusters.get(cluster);
            for (corners, index) in corners.iter().zip(indices) {
                assert!(!std::mem::replace(&mut seen[*index as usize], true));
                for (local, i) in corners.iter().map(|i| usize::from(*i)).zip(triangles[*index as usize]) {
                    let (block, lane) = (local / LANES, local % LANES);
                    let point = Vec3::from(blocks[block].map(|lanes| lanes[lane]));
                    assert_eq!(point, points[i as usize]);
                    assert_eq!(around.with_point(Point3(point)), around);
                }
            }
        }
        assert!(seen.iter().all(|s| *s));
        let values = clusters.at_points(|triangle| triangles[triangle as usize]);
        for cluster in 0..clusters.len() {
            let (values, Cluster { corners, indices, .. }) = (&values[clusters.points(cluster)], clusters.get(cluster));
            for (corners, index) in corners.iter().zip(indices) {
                assert_eq!(corners.map(|i| values[usize::from(i)]), triangles[*index as usize]);
            }
        }
    }
}
