//! Meshes that emit, by their materials or as mesh lights: which triangles do, and a light for each place that shows them.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

use umber_bvh::{Child, InstanceBvh};
use umber_math::{DAffine3, DMat3, DVec3, Rgb};
use umber_scene::{Light, LightId, LightKind, MaterialSync, MeshId, SceneStore, Shaping};
use umber_shading::{EmitterMesh, EmitterTriangle, LightParams, LightProblem};

use super::{lights, materials};
use crate::emitter_index::EmitterIndex;
use crate::linking::LightLinks;
use crate::material::RenderMaterial;
use crate::mesh::{MeshShape, RenderMesh};
use crate::numbering::Numbering;

/// The lights of meshes, and how a hit finds its own.
#[derive(Default)]
pub struct Emitters {
    /// By the index's numbers; `None` where there is no light to choose, or a black one.
    pub lights: Vec<Option<umber_shading::Light>>,
    /// The links of those that there are, in their order.
    pub links: Vec<LightLinks>,
    /// From hits to numbers.
    pub index: EmitterIndex,
}

/// The light that shines from a mesh.
#[derive(Clone, Copy)]
pub struct MeshLight<'a> {
    id: &'a LightId,
    light: &'a Light,
    sync: MaterialSync,
}

/// The lights of a store that shine from meshes. Says which cannot.
pub fn mesh_lights<'a>(
    store: &'a SceneStore,
    warn: &mut dyn FnMut(&str, String),
) -> BTreeMap<&'a MeshId, MeshLight<'a>> {
    let mut by_mesh: BTreeMap<&MeshId, MeshLight> = BTreeMap::new();
    for (id, light) in store.lights().iter().filter(|(_, light)| light.visible) {
        let LightKind::Mesh { mesh, material_sync } = &light.kind else { continue };
        if !store.meshes().contains_key(mesh) {
            warn(id.path(), format!("there is no mesh <{mesh}> to shine from"));
        } else if let Some(other) = by_mesh.get(mesh) {
            warn(id.path(), format!("it is left out: <{}> shines from the same mesh", other.id));
        } else {
            if light.shaping != Shaping::default() {
                warn(id.path(), LightProblem::NotShaped.to_string());
            }
            by_mesh.insert(mesh, MeshLight { id, light, sync: *material_sync });
        }
    }
    by_mesh
}

impl MeshLight<'_> {
    /// Whether the mesh is shown as if it had no material.
    pub fn replaces_material(&self, mesh: &RenderMesh, materials: &[RenderMaterial]) -> bool {
        self.sync == MaterialSync::NoResponse || !has_material(mesh, materials)
    }
}

/// Whether any material that is understood is bound to a mesh or to faces of it, and shown.
fn has_material(mesh: &RenderMesh, materials: &[RenderMaterial]) -> bool {
    let black = materials::black(materials);
    used(mesh).iter().any(|m| *m != black && materials.get(*m as usize).is_some_and(|m| m.lobes.is_some()))
}

/// Materials of a mesh.
fn used(mesh: &RenderMesh) -> BTreeSet<u32> {
    match &mesh.face_materials {
        Some(faces) => faces.iter().copied().collect(),
        None => [mesh.material].into(),
    }
}

/// What decides about the triangles of an emitter, to tell whether it is still the same.
#[derive(PartialEq)]
struct Source {
    /// Radiance and presence by material.
    radiance: BTreeMap<u32, (Rgb, f32)>,
    material: u32,
    face_materials: Option<Arc<[u32]>>,
    two_sided: bool,
}

impl Source {
    fn is_black(&self) -> bool {
        self.radiance.values().all(|(radiance, _)| radiance.is_black())
    }
}

struct Made {
    shape: Arc<MeshShape>,
    source: Source,
    emitter: Option<Arc<EmitterMesh>>,
}

/// Keeps the emitters of meshes.
#[derive(Default)]
pub struct EmitterCompiler {
    made: BTreeMap<MeshId, Made>,
}

/// A scene's meshes, as the hierarchy numbers them.
pub struct Shown<'a> {
    /// Ids.
    pub ids: &'a [MeshId],
    /// Meshes.
    pub meshes: &'a [RenderMesh],
    /// Their materials.
    pub materials: &'a [RenderMaterial],
    /// Where they stand.
    pub top: &'a InstanceBvh,
}

impl EmitterCompiler {
    /// Whether the last compile found any.
    pub fn in_use(&self) -> bool {
        !self.made.is_empty()
    }

    /// Makes the lights of all meshes that emit.
    pub fn compile(&mut self, shown: &Shown, store: &SceneStore, warn: &mut dyn FnMut(&str, String)) -> Emitters {
        let by_light = mesh_lights(store, warn);
        let mut kept = std::mem::take(&mut self.made);
        if by_light.is_empty() && shown.materials.iter().all(|m| m.emission.is_black()) {
            return Emitters::default();
        }
        let mut placer =
            Placer { emitters: Vec::new(), lights: Vec::new(), links: Vec::new(), numberings: HashMap::new(), warn };
        for (id, mesh) in shown.ids.iter().zip(shown.meshes) {
            let light = by_light.get(id).copied();
            let source = source(light, mesh, shown, store.meshes().get(id).is_some_and(|m| m.double_sided));
            if light.is_none() && source.is_black() {
                placer.emitters.push(None);
                continue;
            }
            if let Some(l) = light.filter(|_| source.is_black()) {
                let text = "the material of its mesh does not glow, and materialGlowTintsLight multiplies by that: it lights nothing";
                (placer.warn)(l.id.path(), text.into());
            }
            let old = kept.remove(id).filter(|m| Arc::ptr_eq(&m.shape, &mesh.shape) && m.source == source);
            let made = old.unwrap_or_else(|| {
                let emitter = emitter(mesh, &source).map(Arc::new);
                Made { shape: Arc::clone(&mesh.shape), source, emitter }
            });
            let glows = light.is_some_and(|l| !l.replaces_material(mesh, shown.materials));
            placer.emitters.push(Some(Emitter { light, emitter: made.emitter.clone(), glows }));
            self.made.insert(id.clone(), made);
        }
        let numbering = placer.place(shown.top, &mut Vec::new(), DAffine3::IDENTITY);
        let kinds = placer.emitters.iter().map(|e| e.as_ref().map(|e| e.glows)).collect();
        Emitters { lights: placer.lights, links: placer.links, index: EmitterIndex::new(numbering, kinds) }
    }
}

/// What the light's own radiance is multiplied with, by material.
fn source(light: Option<MeshLight>, mesh: &RenderMesh, shown: &Shown, double_sided: bool) -> Source {
    let glow = |m: u32| shown.materials.get(m as usize).map_or(Rgb::BLACK, |m| m.emission);
    let by_glow = match light {
        None => true,
        Some(light) => light.sync == MaterialSync::GlowTintsLight && has_material(mesh, shown.materials),
    };
    let radiance = |m: u32| if by_glow { glow(m) } else { Rgb::WHITE };
    let presence = |m: u32| shown.materials.get(m as usize).map_or(1.0, |m| m.presence);
    Source {
        radiance: used(mesh).into_iter().map(|m| (m, (radiance(m), presence(m)))).collect(),
        material: mesh.material,
        face_materials: mesh.face_materials.clone(),
        two_sided: by_glow || double_sided,
    }
}

/// `None` where nothing of it emits.
fn emitter(mesh: &RenderMesh, source: &Source) -> Option<EmitterMesh> {
    let triangles = (0..mesh.shape.mesh.len() as u32).filter_map(|index| {
        let (radiance, presence) = *source.radiance.get(&mesh.material_of(index))?;
        let corners = || mesh.shape.triangle(index);
        (!radiance.is_black()).then(|| EmitterTriangle { index, corners: corners(), radiance, presence })
    });
    EmitterMesh::new(triangles, source.two_sided)
}

struct Emitter<'a> {
    light: Option<MeshLight<'a>>,
    emitter: Option<Arc<EmitterMesh>>,
    /// Whether camera and mirrors see the material's glow, whatever the light shines.
    glows: bool,
}

struct Placer<'a> {
    /// By mesh.
    emitters: Vec<Option<Emitter<'a>>>,
    lights: Vec<Option<umber_shading::Light>>,
    links: Vec<LightLinks>,
    /// Of groups, by their address.
    numberings: HashMap<usize, Arc<Numbering>>,
    warn: &'a mut dyn FnMut(&str, String),
}

impl Placer<'_> {
    /// Numbers what emits below a group and makes its lights; `above` are the transforms that lead to the group.
    fn place(&mut self, group: &InstanceBvh, above: &mut Vec<DAffine3>, render_from_group: DAffine3) -> Numbering {
        let mut numbering = Numbering::default();
        let start = self.lights.len();
        for instance in group.instances() {
            let before = (self.lights.len() - start) as u32;
            let render_from_child = render_from_group * instance.parent_from_child;
            above.push(instance.parent_from_child);
            let inner = match &instance.child {
                Child::Group(inner) => {
                    let made = self.place(inner, above, render_from_child);
                    let address = Arc::as_ptr(inner) as usize;
                    Some(Arc::clone(self.numberings.entry(address).or_insert_with(|| Arc::new(made))))
                }
                Child::Mesh { mesh, .. } => {
                    if let Some(Some(emitter)) = self.emitters.get(*mesh as usize) {
                        let made = emitter.place(above, render_from_child, self.warn);
                        let links = || emitter.light.map_or_else(LightLinks::default, |l| lights::links(l.light));
                        self.links.extend(made.is_some().then(links));
                        self.lights.push(made);
                    }
                    None
                }
            };
            above.pop();
            numbering.push(before, inner);
        }
        numbering
    }
}

impl Emitter<'_> {
    fn place(
        &self,
        transforms: &[DAffine3],
        render_from_object: DAffine3,
        warn: &mut dyn FnMut(&str, String),
    ) -> Option<umber_shading::Light> {
        let mesh = self.emitter.as_ref()?;
        let clearance = clearance(mesh.bounds().corners().map(|c| c.0.as_dvec3()), transforms);
        let kind = umber_shading::LightKind::Mesh { mesh: Arc::clone(mesh), clearance };
        let params = match &self.light {
            Some(light) => lights::params(light.light, kind, render_from_object),
            None => LightParams { render_from_light: render_from_object, ..LightParams::new(kind) },
        };
        // Instances that are squashed are told of where they are placed.
        let mut say = |problem: LightProblem| match &self.light {
            Some(light) if problem != LightProblem::SingularTransform => warn(light.id.path(), problem.to_string()),
            _ => {}
        };
        match umber_shading::Light::new(&params) {
            Ok((made, problems)) => {
                problems.into_iter().for_each(say);
                (!made.is_black()).then_some(made)
            }
            Err(problem) => {
                say(problem);
                None
            }
        }
    }
}

/// Half the spacing of numbers next to one in single precision, with room for three components and two roundings.
const ROUNDING: f64 = 8.0 * (f32::EPSILON * 0.5) as f64;

/// How far, in render space, the rounding of places in each space on the way moves a mesh within a box, as a ray sees it.
fn clearance(corners: [DVec3; 8], transforms: &[DAffine3]) -> f32 {
    let mut corners = corners;
    let largest = |corners: &[DVec3; 8]| corners.iter().map(|c| c.abs().max_element()).fold(0.0, f64::max);
    // In object space first, then outwards; what is left of the way stretches it.
    let (mut sum, mut rest) = (0.0, transforms);
    loop {
        let outwards = rest.iter().fold(DMat3::IDENTITY, |m, t| m * t.matrix3);
        sum += largest(&corners) * stretch(&outwards);
        let Some((last, outer)) = rest.split_last() else { break };
        corners = corners.map(|c| last.transform_point3(c));
        rest = outer;
    }
    (sum * ROUNDING) as f32
}

/// By how much a matrix lengthens a vector at most, or a little more.
fn stretch(m: &DMat3) -> f64 {
    (m.x_axis.length_squared() + m.y_axis.length_squared() + m.z_axis.length_squared()).sqrt()
}
