//! Where light paths begin: points of smooth surfaces, on either side.

use std::collections::HashMap;
use std::sync::Arc;

use rayon::prelude::*;
use umber_bvh::{Child, Hit, InstanceBvh, InstancePath};
use umber_math::{DAffine3, Vec2};
use umber_sampling::{Distribution1D, warp};

use crate::mesh::RenderMesh;
use crate::numbering::Numbering;
use crate::scene::RenderScene;

/// Triangles of a block, by their numbers: those of a mesh that follow each other mostly lie together.
const BLOCK: usize = 64;
/// Most blocks of a scene.
const MOST_BLOCKS: usize = 1 << 18;
/// Part of the paths that begin anywhere on the fronts or backs of instances that brought something, and part of those
/// that begin anywhere at all.
const NEARBY: f64 = 0.1;
const ANYWHERE: f64 = 0.01;

/// An instance of a mesh that has smooth surfaces.
#[derive(Debug)]
struct Caster {
    mesh: u32,
    path: InstancePath,
    render_from_object: DAffine3,
    /// Number of its first block.
    first_block: usize,
}

/// Smooth surfaces of a scene: triangles, in blocks of either side.
#[derive(Debug)]
pub(super) struct Casters {
    casters: Vec<Caster>,
    numbering: Numbering,
    /// By mesh.
    areas: Vec<MeshAreas>,
    /// Front and back of each block.
    sides: Distribution1D,
}

/// Areas of a mesh's smooth triangles, object space, and their sums by blocks; empty where none is smooth.
#[derive(Debug, Default)]
struct MeshAreas {
    triangles: Vec<f32>,
    blocks: Vec<f32>,
}

/// A point where a light path begins.
pub(super) struct Start {
    pub hit: Hit,
    /// Whether on the side that the winding names.
    pub is_front: bool,
    /// Number of the side of the block that it was chosen by.
    pub side: usize,
}

impl Casters {
    /// Of a scene, each taken by its area; `None` where there are none, or too many.
    pub fn new(scene: &RenderScene) -> Option<Self> {
        let is_smooth: Vec<bool> =
            scene.materials.iter().map(|m| m.lobes.is_some_and(|lobes| lobes.focuses())).collect();
        let areas: Vec<MeshAreas> = scene.meshes.par_iter().map(|mesh| MeshAreas::new(mesh, &is_smooth)).collect();
        let mut placer = Placer {
            areas: &areas,
            casters: Vec::new(),
            blocks: Vec::new(),
            path: Vec::new(),
            numberings: HashMap::new(),
        };
        let numbering = placer.place(&scene.top, DAffine3::IDENTITY)?;
        let (casters, blocks) = (placer.casters, placer.blocks);
        let sides: Vec<f32> = blocks.iter().flat_map(|area| [*area; 2]).collect();
        (!casters.is_empty()).then(|| Self { casters, numbering, areas, sides: Distribution1D::new(&sides) })
    }

    /// Learns from what paths brought, by the side of the block where each began.
    pub fn learn(&mut self, brought: impl Iterator<Item = (usize, f32)>) {
        let mut sums = vec![0.0; self.sides.bins()];
        brought.for_each(|(side, luminance)| sums[side] += f64::from(luminance));
        let all: f64 = sums.iter().sum();
        if all <= 0.0 || !all.is_finite() {
            return;
        }
        let (mut anywhere, mut nearby) = (Vec::with_capacity(sums.len()), Vec::with_capacity(sums.len()));
        for caster in &self.casters {
            let blocks = &self.areas[caster.mesh as usize].blocks;
            let of_caster = &sums[2 * caster.first_block..2 * (caster.first_block + blocks.len())];
            let brings = [0, 1].map(|side| of_caster.iter().skip(side).step_by(2).any(|sum| *sum > 0.0));
            for area in blocks.iter().map(|area| f64::from(area * caster.scale())) {
                anywhere.extend([area; 2]);
                nearby.extend(brings.map(|brings| if brings { area } else { 0.0 }));
            }
        }
        let parts = [(1.0 - NEARBY - ANYWHERE, sums), (NEARBY, nearby), (ANYWHERE, anywhere)];
        let scales = parts.each_ref().map(|(part, weights)| part / weights.iter().sum::<f64>());
        let weight = |side| (0..parts.len()).map(|i| scales[i] * parts[i].1[side]).sum::<f64>() as f32;
        let weights: Vec<f32> = (0..self.sides.bins()).map(weight).collect();
        self.sides = Distribution1D::new(&weights);
    }

    /// Takes a point.
    pub fn sample(&self, u_side: f32, u_triangle: f32, u: Vec2) -> Option<Start> {
        let (side, ..) = self.sides.sample_discrete(u_side);
        let block = side / 2;
        let caster = &self.casters[self.casters.partition_point(|caster| caster.first_block <= block) - 1];
        let triangle = self.areas[caster.mesh as usize].sample(block - caster.first_block, u_triangle)?;
        let barycentrics = warp::uniform_triangle(u).to_array();
        let hit = Hit { t: 0.0, barycentrics, mesh: caster.mesh, triangle, path: caster.path };
        Some(Start { hit, is_front: side % 2 == 0, side })
    }

    /// Density by area with which [`sample`](Self::sample) takes the point of a hit, on a side of it.
    #[inline]
    pub fn pdf_area(&self, scene: &RenderScene, hit: &Hit, is_front: bool) -> f32 {
        let areas = &self.areas[hit.mesh as usize];
        if areas.triangles.is_empty() {
            return 0.0;
        }
        let caster = &self.casters[self.numbering.number(&hit.path) as usize];
        let side = 2 * (caster.first_block + hit.triangle as usize / BLOCK) + usize::from(!is_front);
        let pmf = self.sides.pmf(side) * areas.pmf(hit.triangle);
        let corners = scene.meshes[hit.mesh as usize].shape.triangle(hit.triangle);
        let [a, b, c] = corners.map(|c| caster.render_from_object.transform_point3(c.0.as_dvec3()));
        (f64::from(pmf) / (0.5 * (b - a).cross(c - a).length())) as f32
    }
}

impl Caster {
    /// By how much areas grow, but for what stretches them more one way than another.
    fn scale(&self) -> f32 {
        self.render_from_object.matrix3.determinant().abs().powf(2.0 / 3.0) as f32
    }
}

impl MeshAreas {
    fn new(mesh: &RenderMesh, is_smooth: &[bool]) -> Self {
        let is_smooth = |triangle: u32| is_smooth.get(mesh.material_of(triangle) as usize).copied().unwrap_or(false);
        let count = mesh.shape.mesh.len() as u32;
        if !(0..count).any(is_smooth) {
            return Self::default();
        }
        let area = |triangle: u32| {
            let [a, b, c] = mesh.shape.triangle(triangle).map(|c| c.0.as_dvec3());
            if is_smooth(triangle) { (0.5 * (b - a).cross(c - a).length()) as f32 } else { 0.0 }
        };
        let triangles: Vec<f32> = (0..count).map(area).collect();
        let blocks = triangles.chunks(BLOCK).map(|block| block.iter().sum()).collect();
        Self { triangles, blocks }
    }
    /// Takes a triangle of a block.
    fn sample(&self, block: usize, u: f32) -> Option<u32> {
        let mut left = u * self.blocks[block];
        let triangles = (block * BLOCK..).zip(self.triangles.iter().skip(block * BLOCK).take(BLOCK));
        let mut last = None;
        for (triangle, area) in triangles.filter(|(_, area)| **area > 0.0) {
            last = Some(triangle as u32);
            if left < *area {
                break;
            }
            left -= area;
        }
        last
    }
    /// Chance of a triangle within its block.
    #[inline]
    fn pmf(&self, triangle: u32) -> f32 {
        self.triangles[triangle as usize] / self.blocks[triangle as usize / BLOCK]
    }
}

/// Lists the casters of a hierarchy.
struct Placer<'a> {
    areas: &'a [MeshAreas],
    casters: Vec<Caster>,
    /// Areas of the blocks.
    blocks: Vec<f32>,
    /// Leads to the group under way.
    path: Vec<u32>,
    /// Of groups, by their address; `None` where they have no casters.
    numberings: HashMap<usize, Option<Arc<Numbering>>>,
}

impl Placer<'_> {
    /// Adds those below a group, and numbers them; `None` where they are too many.
    fn place(&mut self, group: &InstanceBvh, render_from_group: DAffine3) -> Option<Numbering> {
        let mut numbering = Numbering::default();
        let start = self.casters.len();
        for (index, instance) in (0..).zip(group.instances()) {
            let before = (self.casters.len() - start) as u32;
            let render_from_child = render_from_group * instance.parent_from_child;
            self.path.push(index);
            let inner = match &instance.child {
                Child::Group(inner) => self.place_inner(inner, render_from_child)?,
                Child::Mesh { mesh, .. } => {
                    self.add(*mesh, render_from_child)?;
                    None
                }
            };
            self.path.pop();
            numbering.push(before, inner);
        }
        Some(numbering)
    }
    /// The same for a group in a group; the inner `None` where there are none.
    fn place_inner(&mut self, group: &Arc<InstanceBvh>, render_from_group: DAffine3) -> Option<Option<Arc<Numbering>>> {
        let address = Arc::as_ptr(group) as usize;
        if let Some(None) = self.numberings.get(&address) {
            return Some(None);
        }
        let start = self.casters.len();
        let made = self.place(group, render_from_group)?;
        let made = || (self.casters.len() > start).then(|| Arc::new(made));
        Some(self.numberings.entry(address).or_insert_with(made).clone())
    }
    fn add(&mut self, mesh: u32, render_from_object: DAffine3) -> Option<()> {
        let areas = &self.areas[mesh as usize];
        if areas.triangles.is_empty() {
            return Some(());
        }
        // the hierarchy leaves out what lies deeper
        let Some(path) = InstancePath::from_slice(&self.path) else { return Some(()) };
        let caster = Caster { mesh, path, render_from_object, first_block: self.blocks.len() };
        self.blocks.extend(areas.blocks.iter().map(|area| area * caster.scale()));
        self.casters.push(caster);
        (self.blocks.len() <= MOST_BLOCKS).then_some(())
    }
}
