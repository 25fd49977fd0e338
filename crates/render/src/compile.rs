//! From the editable store to a frozen [`RenderScene`], reusing what did not change.

#[cfg(test)]
mod emitter_tests;
mod emitters;
mod instances;
mod lights;
mod materials;
mod membership;
mod mesh;
mod profiles;

use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use umber_bvh::InstanceBvh;
use umber_math::{DAffine3, DVec3};
use umber_scene::{Dirty, Light, LightKind, MaterialId, Mesh, MeshDirty, MeshId, SceneStore};

pub use emitters::Emitters;
pub use instances::InstanceNumber;
pub use membership::Membership;

use crate::camera::RenderCamera;
use crate::integrator::{self, splitting::Splitting};
use crate::light_set::LightSet;
use crate::linking::Linking;
use crate::material::RenderMaterial;
use crate::mesh::{MeshAttributes, MeshShape, RenderMesh};
use crate::scene::RenderScene;
use crate::{FilmDesc, Message};
use emitters::EmitterCompiler;
use lights::LightCompiler;

/// The camera stands at most this far from render space's origin in each axis, scene units: render
/// space only moves when the camera has gone farther, so that nearly all camera moves rebuild nothing.
const ORIGIN_REACH: f64 = 4096.0;

/// What the last compile built.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Built {
    /// Meshes whose hierarchy was built.
    pub meshes: u64,
    /// Whether the top level was.
    pub top_level: bool,
}

struct CompiledMesh {
    shape: Arc<MeshShape>,
    attributes: Arc<MeshAttributes>,
    warnings: Vec<String>,
}

struct TopLevel {
    /// Where render space's origin was in world space when it was placed.
    origin: DVec3,
    bvh: Arc<InstanceBvh>,
    numbers: Arc<[InstanceNumber]>,
    instance_count: u64,
    membership: Option<Membership>,
    /// Meshes by their index in the hierarchy.
    shown: Vec<MeshId>,
}

/// Keeps what earlier compiles made, by path.
#[derive(Default)]
pub struct Compiler {
    pending: Dirty,
    meshes: BTreeMap<MeshId, CompiledMesh>,
    top: Option<TopLevel>,
    materials: BTreeMap<MaterialId, u32>,
    render_meshes: Arc<[RenderMesh]>,
    render_materials: Arc<[RenderMaterial]>,
    lights: LightCompiler,
    emitters: EmitterCompiler,
    /// None before the first compile: building even an empty one here, outside of the session's pool, would start rayon's
    /// own.
    light_set: Option<Arc<LightSet>>,
    linking: Option<Arc<Linking>>,
    said: HashSet<Message>,
    built: Built,
}

/// Why there is no render scene.
#[derive(Debug)]
pub enum NoScene {
    /// Something newer is to be rendered.
    Cancelled,
    /// It cannot be rendered: there is nothing to look through, say.
    Unrenderable(Message),
}

impl Compiler {
    /// What the last compile built.
    pub fn built(&self) -> Built {
        self.built
    }

    /// Compiles what is dirty of a store, beside what an earlier call left. New warnings go to `say`, each once.
    ///
    /// # Errors
    /// Cancelled (then the next call goes on), or without a usable camera.
    pub fn compile(
        &mut self,
        store: &SceneStore,
        dirty: Dirty,
        film: &FilmDesc,
        cancel: &AtomicBool,
        say: &mut dyn FnMut(Message),
    ) -> Result<RenderScene, NoScene> {
        merge(&mut self.pending, dirty);
        let mut warnings = Vec::new();
        let mut warn = |prim: &str, text: String| warnings.push(Message::warning(Some(prim), text));
        let result = self.update(store, film, cancel, &mut warn);
        for warning in warnings {
            if self.said.insert(warning.clone()) {
                say(warning);
            }
        }
        result
    }

    fn update(
        &mut self,
        store: &SceneStore,
        film: &FilmDesc,
        cancel: &AtomicBool,
        warn: &mut dyn FnMut(&str, String),
    ) -> Result<RenderScene, NoScene> {
        self.built = Built::default();
        let no_camera = |text: &str| NoScene::Unrenderable(Message::error(None, text));
        let camera = store.camera().ok_or_else(|| no_camera("no camera to look through"))?;
        let origin = render_origin(camera.world_from_camera.translation);
        let render_from_world = DAffine3::from_translation(-origin);
        let render_camera = RenderCamera::new(camera, film, render_from_world).ok_or_else(|| {
            no_camera("the camera cannot be looked through: its transform is singular, or its aperture is empty")
        })?;

        self.compile_meshes(store, cancel, warn)?;
        let dirty = std::mem::take(&mut self.pending);
        let placed_anew = dirty.meshes.values().any(|d| d.topology || d.points || d.placement || d.links);
        let elsewhere = self.top.as_ref().is_none_or(|top| top.origin != origin);
        let top_stale = elsewhere || dirty.instancers || dirty.instancer_links || dirty.purposes || placed_anew;
        if top_stale {
            self.place(store, origin, warn);
        }
        if !dirty.materials.is_empty() || self.render_materials.is_empty() {
            (self.materials, self.render_materials) = materials::compile(store.materials(), warn);
        }
        let surfaces_stale = top_stale || !dirty.meshes.is_empty() || !dirty.materials.is_empty();
        let is_mesh_light = |light: &Light| matches!(light.kind, LightKind::Mesh { .. });
        let has_mesh_lights = store.lights().values().any(is_mesh_light);
        if surfaces_stale || !dirty.lights.is_empty() && (has_mesh_lights || self.emitters.in_use()) {
            self.bind(store, warn);
        }
        let emitting = || self.render_materials.iter().any(|m| !m.emission.is_black());
        let emitters_stale = surfaces_stale && (self.emitters.in_use() || has_mesh_lights || emitting());
        if !dirty.lights.is_empty() || top_stale || emitters_stale {
            let bounds = self.top.as_ref().map(|t| t.bvh.bounds()).unwrap_or_default();
            let emitters = self.emit(store, warn);
            let (light_set, links) = self.lights.compile(store.lights(), render_from_world, bounds, emitters, warn);
            let membership = self.top.as_ref().and_then(|top| top.membership.as_ref());
            self.linking = Linking::new(membership, &links, &light_set).map(Arc::new);
            self.light_set = Some(Arc::new(light_set));
        }
        Ok(self.scene(render_camera, store))
    }

    fn scene(&self, camera: RenderCamera, store: &SceneStore) -> RenderScene {
        let (top, numbers, instance_count) = match &self.top {
            Some(top) => (Arc::clone(&top.bvh), Arc::clone(&top.numbers), top.instance_count),
            None => (Arc::new(InstanceBvh::build(Vec::new())), Arc::default(), 0),
        };
        let partly_present =
            self.render_meshes.iter().any(|mesh| mesh.may_be_absent(&self.render_materials)) && instance_count > 0;
        RenderScene {
            camera,
            settings: integrator::settings(store.settings()),
            top,
            numbers,
            instance_count,
            meshes: Arc::clone(&self.render_meshes),
            materials: Arc::clone(&self.render_materials),
            lights: self.light_set.clone().unwrap_or_default(),
            linking: self.linking.clone(),
            partly_present,
            caustics: None,
            light_tracing: None,
            path_group: 1,
            splitting: Splitting::NONE,
            edges: None,
        }
    }

    /// Compiles shapes and attributes of dirty meshes, side by side.
    fn compile_meshes(
        &mut self,
        store: &SceneStore,
        cancel: &AtomicBool,
        warn: &mut dyn FnMut(&str, String),
    ) -> Result<(), NoScene> {
        self.meshes.retain(|id, _| store.meshes().contains_key(id));
        let stale: Vec<(&MeshId, &Mesh, Option<&CompiledMesh>, MeshDirty)> = store
            .meshes()
            .iter()
            .filter_map(|(id, mesh)| {
                let old = self.meshes.get(id);
                let dirty = if old.is_none() { MeshDirty::ALL } else { *self.pending.meshes.get(id)? };
                (dirty.topology || dirty.points || dirty.attributes).then_some((id, mesh, old, dirty))
            })
            .collect();
        let compiled: Vec<Option<(MeshId, CompiledMesh, bool)>> = stale
            .par_iter()
            .map(|(id, mesh, old, dirty)| {
                if cancel.load(Ordering::Relaxed) {
                    return None;
                }
                let mut warnings = Vec::new();
                let mut say = |text| warnings.push(text);
                let built =
                    dirty.topology || dirty.points || old.is_some_and(|old| mesh::lacks_corners(&old.shape, mesh));
                let shape = match old {
                    Some(old) if !built => Arc::clone(&old.shape),
                    _ => {
                        let older = old.filter(|_| !dirty.topology).map(|old| &*old.shape);
                        Arc::new(mesh::compile_shape(mesh, older, &mut say))
                    }
                };
                let attributes = Arc::new(mesh::compile_attributes(mesh, &shape, &mut say));
                Some(((*id).clone(), CompiledMesh { shape, attributes, warnings }, built))
            })
            .collect();
        let mut cancelled = false;
        for entry in compiled {
            let Some((id, mut mesh, built)) = entry else {
                cancelled = true;
                continue;
            };
            mesh.warnings.drain(..).for_each(|text| warn(id.path(), text));
            self.built.meshes += u64::from(built);
            let left = self.pending.meshes.entry(id.clone()).or_insert(MeshDirty::ALL);
            *left = MeshDirty {
                placement: left.placement || built,
                topology: false,
                points: false,
                attributes: false,
                ..*left
            };
            self.meshes.insert(id, mesh);
        }
        if cancelled { Err(NoScene::Cancelled) } else { Ok(()) }
    }

    fn place(&mut self, store: &SceneStore, origin: DVec3, warn: &mut dyn FnMut(&str, String)) {
        let shown: Vec<instances::ShownMesh> = store
            .meshes()
            .iter()
            .filter(|(_, mesh)| mesh.visible && store.shows(mesh.purpose))
            .filter_map(|(id, mesh)| Some((id, mesh, &self.meshes.get(id)?.shape)))
            .filter(|(_, _, shape)| !shape.mesh.is_empty())
            .enumerate()
            .map(|(index, (id, mesh, shape))| instances::ShownMesh { id, mesh, shape, index: index as u32 })
            .collect();
        let render_from_world = DAffine3::from_translation(-origin);
        let placed = instances::place(
            &shown,
            store.instancers(),
            render_from_world,
            self.top.as_ref().map(|top| &*top.bvh),
            warn,
        );
        self.built.top_level = true;
        self.top = Some(TopLevel {
            origin,
            bvh: Arc::new(placed.top),
            numbers: placed.numbers.into(),
            instance_count: placed.instance_count,
            membership: placed.membership,
            shown: shown.iter().map(|m| m.id.clone()).collect(),
        });
    }

    /// Meshes in the order of the hierarchy, with their materials.
    fn bind(&mut self, store: &SceneStore, warn: &mut dyn FnMut(&str, String)) {
        let mesh_lights = emitters::mesh_lights(store, &mut |_, _| {});
        let shown = self.top.iter().flat_map(|top| &top.shown);
        let described = shown.filter_map(|id| Some((id, store.meshes().get(id)?, self.meshes.get(id)?)));
        self.render_meshes = described
            .map(|(id, mesh, compiled)| {
                let materials = materials::of_mesh(mesh, &self.materials, &mut |text| warn(id.path(), text));
                let mut mesh_as_shown = RenderMesh {
                    shape: Arc::clone(&compiled.shape),
                    attributes: Arc::clone(&compiled.attributes),
                    material: materials.whole,
                    face_materials: materials.faces,
                    culled_faces: mesh.culled_faces,
                    prim_id: mesh.prim_id,
                };
                let light = mesh_lights.get(id);
                if light.is_some_and(|l| l.replaces_material(&mesh_as_shown, &self.render_materials)) {
                    mesh_as_shown.material = materials::black(&self.render_materials);
                    mesh_as_shown.face_materials = None;
                }
                mesh_as_shown
            })
            .collect();
    }

    /// The lights of meshes that emit.
    fn emit(&mut self, store: &SceneStore, warn: &mut dyn FnMut(&str, String)) -> Emitters {
        let Some(top) = &self.top else { return Emitters::default() };
        let shown = emitters::Shown {
            ids: &top.shown,
            meshes: &self.render_meshes,
            materials: &self.render_materials,
            top: &top.bvh,
        };
        self.emitters.compile(&shown, store, warn)
    }
}

fn merge(pending: &mut Dirty, new: Dirty) {
    for (id, what) in new.meshes {
        pending.meshes.entry(id).or_default().merge(what);
    }
    pending.instancers |= new.instancers;
    pending.instancer_links |= new.instancer_links;
    pending.camera |= new.camera;
    pending.lights.extend(new.lights);
    pending.materials.extend(new.materials);
    pending.purposes |= new.purposes;
    pending.settings |= new.settings;
}

/// Render space's origin in world space for a camera at `camera`.
fn render_origin(camera: DVec3) -> DVec3 {
    let cell = 2.0 * ORIGIN_REACH;
    let origin = (camera / cell).round() * cell;
    if origin.is_finite() { origin } else { DVec3::ZERO }
}
