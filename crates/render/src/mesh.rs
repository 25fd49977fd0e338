//! Meshes as rays meet them.

use std::sync::{Arc, OnceLock};

use umber_bvh::MeshBvh;
use umber_geometry::{Attribute, Interpolation, TriangleMesh};
use umber_math::{Point3, Vec2, Vec3};
use umber_scene::CulledFaces;

use crate::clusters::Clusters;
use crate::material::RenderMaterial;

/// Points and triangles of a mesh with their hierarchy: what topology and points make.
pub struct MeshShape {
    /// Points, object space.
    pub points: Arc<[Vec3]>,
    /// Triangles.
    pub mesh: TriangleMesh,
    /// Hierarchy over the triangles.
    pub bvh: Arc<MeshBvh>,
    /// Made when a rasteriser first asks for them.
    clusters: OnceLock<Clusters>,
}

impl MeshShape {
    /// Of points, their triangles and the hierarchy over them.
    pub fn new(points: Arc<[Vec3]>, mesh: TriangleMesh, bvh: Arc<MeshBvh>) -> Self {
        Self { points, mesh, bvh, clusters: OnceLock::new() }
    }
    /// Its triangles by where they are.
    pub fn clusters(&self) -> &Clusters {
        self.clusters.get_or_init(|| Clusters::new(&self.points, &self.mesh.triangles))
    }
    /// The corners of a triangle, object space.
    #[inline]
    pub fn triangle(&self, triangle: u32) -> [Point3; 3] {
        let [a, b, c] = self.mesh.triangles[triangle as usize];
        [Point3(self.points[a as usize]), Point3(self.points[b as usize]), Point3(self.points[c as usize])]
    }
    /// Bytes it takes.
    pub fn memory_bytes(&self) -> usize {
        let clusters = self.clusters.get().map_or(0, Clusters::memory_bytes);
        size_of_val(&*self.points) + self.mesh.memory_bytes() + self.bvh.memory_bytes() + clusters
    }
}

/// What spreads over a mesh. It belongs to the shape that it was compiled for.
#[derive(Debug, Default)]
pub struct MeshAttributes {
    /// Shading normals, object space; `None`: flat.
    pub normals: Option<Attribute<Vec3>>,
    /// `displayColor`.
    pub display_color: Option<Attribute<Vec3>>,
    /// `displayOpacity`.
    pub display_opacity: Option<Attribute<f32>>,
    /// `st`.
    pub st: Option<Attribute<Vec2>>,
    /// Of [`RenderMesh::cluster_normals`]; made when a rasteriser first asks for them.
    pub(crate) cluster_normals: OnceLock<Option<Vec<Vec3>>>,
}

impl MeshAttributes {
    /// Bytes that are made of them for rasterisers.
    pub fn raster_bytes(&self) -> usize {
        self.cluster_normals.get().map_or(0, |normals| size_of_val(normals.as_deref().unwrap_or_default()))
    }
    /// Whether each triangle has one shading normal.
    pub fn is_flat(&self) -> bool {
        self.normals
            .as_ref()
            .is_none_or(|n| matches!(n.interpolation(), Interpolation::Constant | Interpolation::Uniform))
    }
}

/// Index of a material that means: none bound, show displayColor.
pub const NO_MATERIAL: u32 = u32::MAX;

/// A mesh of a render scene.
#[derive(Clone)]
pub struct RenderMesh {
    /// Shape.
    pub shape: Arc<MeshShape>,
    /// Attributes.
    pub attributes: Arc<MeshAttributes>,
    /// Material of the faces that no subset names.
    pub material: u32,
    /// Material of each face, where subsets differ from it.
    pub face_materials: Option<Arc<[u32]>>,
    /// Faces that the camera looks through.
    pub culled_faces: CulledFaces,
    /// Value of the `primId` AOV.
    pub prim_id: i32,
}

impl RenderMesh {
    /// Index of the material of a triangle.
    #[inline]
    pub fn material_of(&self, triangle: u32) -> u32 {
        match &self.face_materials {
            Some(materials) => materials[self.shape.mesh.elements[triangle as usize] as usize],
            None => self.material,
        }
    }

    /// Shading normals at the points of its clusters, object space, numbered as [`Clusters::points`] says. `None` where
    /// its points have none of their own.
    pub fn cluster_normals(&self) -> Option<&[Vec3]> {
        let MeshShape { mesh, .. } = &*self.shape;
        let of_points =
            |n: &&Attribute<Vec3>| matches!(n.interpolation(), Interpolation::Varying | Interpolation::Vertex);
        let normals = self.attributes.normals.as_ref().filter(of_points);
        let make = || normals.map(|n| self.shape.clusters().at_points(|triangle| n.at_vertices(mesh, triangle)));
        let all = self.attributes.cluster_normals.get_or_init(make).as_deref();
        debug_assert!(all.is_none_or(|all| all.len() == self.shape.clusters().point_count()));
        all
    }

    /// Whether some of its surface may let rays pass.
    pub fn may_be_absent(&self, materials: &[RenderMaterial]) -> bool {
        let absent = |material: u32| match materials.get(material as usize) {
            Some(material) if material.lobes.is_some() => material.presence < 1.0,
            _ => self
                .attributes
                .display_opacity
                .as_ref()
                .is_some_and(|a| a.values().iter().any(|o| o.is_nan() || *o < 1.0)),
        };
        match &self.face_materials {
            Some(faces) => faces.iter().any(|m| absent(*m)),
            None => absent(self.material),
        }
    }
}
