//! A mesh's triangles in small groups that lie close together: what a rasteriser draws or passes over at once.

use umber_math::{Bounds3, Point3, Vec3};

/// Triangles of a group, at most.
pub const CLUSTER: usize = 64;
/// Bits of a coordinate by which triangles are sorted.
const BITS: u32 = 10;

/// A triangle of a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClusterTriangle {
    /// Its points.
    pub points: [u32; 3],
    /// Which of the mesh's it is.
    pub index: u32,
}

/// Groups of triangles.
#[derive(Clone, Debug, Default)]
pub struct Clusters {
    triangles: Vec<ClusterTriangle>,
    bounds: Vec<Bounds3>,
}

impl Clusters {
    /// Groups triangles along a Morton curve. `bounds`: around all.
    pub fn new(points: &[Vec3], triangles: &[[u32; 3]], bounds: Bounds3) -> Self {
        let corners = |t: &[u32; 3]| t.map(|i| points[i as usize]);
        let scale = bounds.size().max(Vec3::splat(f32::MIN_POSITIVE)).recip() * (1 << BITS) as f32 / 3.0;
        let key = |(index, t): (u32, &[u32; 3])| {
            let [a, b, c] = corners(t);
            // the casts saturate, and take what is not a number for zero
            let cell = ((a + b + c - bounds.min * 3.0) * scale).to_array().map(|v| (v as u32).min((1 << BITS) - 1));
            u64::from(morton(cell)) << 32 | u64::from(index)
        };
        let mut keys: Vec<u64> = (0..).zip(triangles).map(key).collect();
        keys.sort_unstable();
        let taken = |key: u64| ClusterTriangle { points: triangles[key as u32 as usize], index: key as u32 };
        let triangles: Vec<ClusterTriangle> = keys.into_iter().map(taken).collect();
        let around =
            |group: &[ClusterTriangle]| Bounds3::of_points(group.iter().flat_map(|t| corners(&t.points)).map(Point3));
        let bounds = triangles.chunks(CLUSTER).map(around).collect();
        Self { triangles, bounds }
    }

    /// Bytes they take.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.triangles) + size_of_val(&*self.bounds)
    }
    /// How many groups there are.
    pub fn len(&self) -> usize {
        self.bounds.len()
    }
    /// A box around a group, object space.
    pub fn bounds(&self, cluster: usize) -> Bounds3 {
        self.bounds[cluster]
    }
    /// The triangles of a group.
    pub fn triangles(&self, cluster: usize) -> &[ClusterTriangle] {
        let start = cluster * CLUSTER;
        &self.triangles[start..self.triangles.len().min(start + CLUSTER)]
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
            for triangle in clusters.triangles(cluster) {
                assert_eq!(triangle.points, triangles[triangle.index as usize]);
                assert!(!std::mem::replace(&mut seen[triangle.index as usize], true));
                for i in triangle.points {
                    assert_eq!(around.with_point(Point3(points[i as usize])), around);
                }
            }
        }
        assert!(seen.iter().all(|s| *s));
    }
}
