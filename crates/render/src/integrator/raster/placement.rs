//! Which mesh stands where, as far as it can be seen: instances multiplied out.

use glam::Mat3;
use umber_bvh::{Child, InstanceBvh, InstancePath, MAX_DEPTH};
use umber_math::{Bounds3, DAffine3};
use umber_scene::CulledFaces;

use super::super::Stop;
use super::project::{FilmFromObject, Grid};
use crate::mesh::RenderMesh;
use crate::scene::RenderScene;

/// A mesh at a place.
#[derive(Clone, Debug)]
pub struct Placement {
    /// The instances that it was reached through.
    pub path: InstancePath,
    /// Its mesh, as the scene numbers it.
    pub mesh: u32,
    /// From its space to the film.
    pub film_from_object: FilmFromObject,
    /// From its normals to render space's; they get another length.
    pub render_from_normal: Mat3,
    /// Whether triangles that wind anticlockwise on the film are looked through, and those that wind clockwise.
    pub culled: [bool; 2],
    /// Whether parts of it may be looked through for their opacity.
    pub may_be_absent: bool,
}

impl Placement {
    /// What is placed.
    pub fn mesh<'a>(&self, scene: &'a RenderScene) -> &'a RenderMesh {
        &scene.meshes[self.mesh as usize]
    }
}

/// All meshes that may be on the film, in the order of their paths; some where stopped.
pub fn visible(scene: &RenderScene, grid: &Grid, stop: &Stop<'_>) -> Vec<Placement> {
    let mut walk = Walk {
        scene,
        stop,
        grid,
        mirrored: scene.camera.view().mirrored,
        may_be_absent: scene.meshes.iter().map(|m| scene.partly_present && m.may_be_absent(&scene.materials)).collect(),
        found: Vec::new(),
    };
    walk.group(&scene.top, &DAffine3::IDENTITY, &mut Vec::with_capacity(MAX_DEPTH));
    walk.found
}

struct Walk<'a> {
    scene: &'a RenderScene,
    stop: &'a Stop<'a>,
    grid: &'a Grid,
    /// Whether the camera is.
    mirrored: bool,
    /// By mesh.
    may_be_absent: Vec<bool>,
    found: Vec<Placement>,
}

impl Walk<'_> {
    fn group(&mut self, group: &InstanceBvh, render_from_group: &DAffine3, path: &mut Vec<u32>) {
        if path.len() == MAX_DEPTH {
            return;
        }
        let mut skipped = group.skipped().iter().peekable();
        for (index, instance) in (0..).zip(group.instances()) {
            if self.stop.now() {
                return;
            }
            if skipped.next_if_eq(&&index).is_some() {
                continue;
            }
            let render_from_child = *render_from_group * instance.parent_from_child;
            path.push(index);
            match &instance.child {
                Child::Mesh { mesh, bvh } => self.mesh(*mesh, bvh.bounds(), &render_from_child, path),
                Child::Group(inner) => {
                    let film_from_child = self.grid.film_from_object(&render_from_child);
                    if !inner.bounds().is_empty() && !self.grid.misses(&film_from_child, inner.bounds()) {
                        self.group(inner, &render_from_child, path);
                    }
                }
            }
            path.pop();
        }
    }

    fn mesh(&mut self, mesh: u32, bounds: Bounds3, render_from_object: &DAffine3, path: &[u32]) {
        let film_from_object = self.grid.film_from_object(render_from_object);
        if bounds.is_empty() || self.grid.misses(&film_from_object, bounds) {
            return;
        }
        let Some(path) = InstancePath::from_slice(path) else { return };
        // a triangle's normal is that of its moved corners: on the film it winds anticlockwise where that faces the
        // camera, unless the camera mirrors
        let [facing, away] = match self.scene.meshes[mesh as usize].culled_faces {
            CulledFaces::None => [false, false],
            CulledFaces::Back => [false, true],
            CulledFaces::Front => [true, false],
        };
        let culled = if self.mirrored { [away, facing] } else { [facing, away] };
        let may_be_absent = self.may_be_absent[mesh as usize];
        // the inverse transpose
        let render_from_normal = render_from_object.matrix3.inverse().transpose().as_mat3();
        self.found.push(Placement { path, mesh, film_from_object, render_from_normal, culled, may_be_absent });
    }
}
