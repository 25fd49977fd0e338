//! The clusters that a square draws, with their triangles at hand, and the numbers of those.

use umber_bvh::prefetch;
use umber_math::{Point3, Vec3};

use super::bins::Entry;
use super::placement::Placement;
use super::shade::is_lit;
use super::square::NOTHING;
use crate::clusters::{CLUSTER, Cluster, LANES};
use crate::scene::RenderScene;

/// An entry with its triangles at hand.
#[derive(Clone, Copy, Debug)]
pub struct Piece<'a> {
    /// Where it may be seen.
    pub entry: Entry,
    /// Its triangles.
    pub cluster: Cluster<'a>,
    /// Shading normals at the cluster's points, object space, where its mesh has such and surfaces are lit.
    normals: Option<&'a [Vec3]>,
}

impl<'a> Piece<'a> {
    /// That of an entry.
    #[inline]
    pub fn new(scene: &'a RenderScene, placements: &[Placement], entry: Entry) -> Self {
        let (mesh, index) = (placements[entry.placement as usize].mesh(scene), entry.cluster as usize);
        let clusters = mesh.shape.clusters();
        let normals = if is_lit(scene) { mesh.cluster_normals() } else { None };
        let normals = normals.map(|normals| &normals[clusters.points(index)]);
        Self { entry, cluster: clusters.get(index), normals }
    }
    /// Asks for what shading reads and drawing does not.
    #[inline(always)]
    pub fn prefetch_normals(&self) {
        prefetch(self.normals.unwrap_or_default());
    }
}

/// A square has numbers for so many pieces, 67 million: of more entries, that many in front are looked at.
pub const MOST_ENTRIES: usize = NOTHING as usize / CLUSTER;

/// Number of a triangle among those of a square's pieces, of which there are [`MOST_ENTRIES`] at most.
#[inline(always)]
pub fn number(piece: usize, triangle: u32) -> u32 {
    (piece * CLUSTER) as u32 + triangle
}

/// What has a number.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'p, 'a> {
    piece: &'p Piece<'a>,
    /// Which triangle of its cluster.
    at: usize,
}

impl<'p, 'a> Seen<'p, 'a> {
    /// By its number among the pieces of a square.
    #[inline(always)]
    pub fn new(pieces: &'p [Piece<'a>], number: u32) -> Self {
        Self { piece: &pieces[number as usize / CLUSTER], at: number as usize % CLUSTER }
    }
    /// Index of the placement.
    #[inline(always)]
    pub fn placement(&self) -> u32 {
        self.piece.entry.placement
    }
    /// Triangle of its mesh.
    #[inline(always)]
    pub fn triangle(&self) -> u32 {
        self.piece.cluster.indices[self.at]
    }

    /// One of its corners, object space.
    #[inline(always)]
    pub fn corner(&self, k: usize) -> Point3 {
        let number = self.number(k);
        let (block, lane) = (&self.piece.cluster.points[number / LANES], number % LANES);
        Point3(Vec3::new(block[0][lane], block[1][lane], block[2][lane]))
    }
    /// Whether its points have shading normals.
    #[inline(always)]
    pub fn has_normals(&self) -> bool {
        self.piece.normals.is_some()
    }
    /// Shading normal of one of its corners, object space, where points have such.
    #[inline(always)]
    pub fn normal(&self, k: usize) -> Option<Vec3> {
        Some(self.piece.normals?[self.number(k)])
    }
    /// Number of a corner among the cluster's points.
    #[inline(always)]
    fn number(&self, k: usize) -> usize {
        usize::from(self.piece.cluster.corners[self.at][k])
    }

    /// Of what is as near, the smallest is seen: the one that a ray meets first.
    pub fn rank(&self) -> (u32, u32) {
        (self.placement(), self.triangle())
    }
}
