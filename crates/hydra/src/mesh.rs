//! Meshes.

use std::sync::Arc;

use umber_render::Message;
use umber_scene::{
    CulledFaces, GeomSubset, InstancerId, MaterialId, MeshId, MeshPatch, Orientation, Primvar, SceneEdit,
    SubdivisionScheme, Topology,
};

use crate::bridge::ffi;
use crate::convert::{affine, categories, interpolation, primvar_values, triples};
use crate::delegate::Delegate;
use crate::frame::purpose;
use crate::guard::{Outcome, guard, guard_refusal};
use crate::host::Host;

/// Primvars that Umber reads.
const PRIMVARS: [&str; 4] = [NORMALS, "displayColor", "displayOpacity", "st"];
const NORMALS: &str = "normals";

/// One `HdMesh`, and what a sync has pulled for it so far.
pub struct Mesh {
    host: Arc<Host>,
    id: MeshId,
    patch: MeshPatch,
    subsets: Vec<GeomSubset>,
    /// `UsdGeomImageable.visibility`, as Hydra resolves it.
    visible: bool,
    /// The render tag is one that is never shown.
    hidden: bool,
    double_sided: bool,
    cull_style: ffi::CullStyle,
    /// The scene knows it.
    sent: bool,
}

pub fn mesh_primvars() -> Outcome<Vec<String>> {
    guard(|| PRIMVARS.map(str::to_owned).to_vec())
}

pub fn new_mesh(delegate: &Delegate, path: &str) -> Outcome<Box<Mesh>> {
    guard(|| {
        Box::new(Mesh {
            host: delegate.host(),
            id: MeshId::new(path),
            patch: MeshPatch::default(),
            subsets: Vec::new(),
            visible: true,
            hidden: false,
            double_sided: false,
            cull_style: ffi::CullStyle::DontCare,
            sent: false,
        })
    })
}

impl Mesh {
    pub fn set_topology(
        &mut self,
        scheme: &str,
        orientation: &str,
        face_vertex_counts: &[i32],
        face_vertex_indices: &[i32],
        hole_indices: &[i32],
    ) -> Outcome {
        guard(|| {
            let scheme = match scheme {
                "catmullClark" => SubdivisionScheme::CatmullClark,
                "loop" => SubdivisionScheme::Loop,
                "bilinear" => SubdivisionScheme::Bilinear,
                _ => SubdivisionScheme::None,
            };
            let left = orientation == "leftHanded";
            self.patch.topology = Some(Arc::new(Topology {
                scheme,
                orientation: if left { Orientation::LeftHanded } else { Orientation::RightHanded },
                face_vertex_counts: face_vertex_counts.into(),
                face_vertex_indices: face_vertex_indices.into(),
                hole_indices: hole_indices.into(),
            }));
        })
    }

    pub fn clear_subsets(&mut self) -> Outcome {
        guard(|| {
            self.subsets.clear();
            self.patch.subsets = Some(Arc::default());
        })
    }

    pub fn add_subset(&mut self, material: &str, faces: &[i32]) -> Outcome {
        guard(|| {
            self.subsets.push(GeomSubset { material: material_id(material), faces: faces.into() });
            self.patch.subsets = Some(self.subsets.as_slice().into());
        })
    }

    pub fn set_points(&mut self, points: &[f32]) -> Outcome {
        guard(|| self.patch.points = Some(triples(points)))
    }

    pub fn set_primvar(
        &mut self,
        name: &str,
        spread: ffi::Interpolation,
        components: usize,
        values: &[f32],
    ) -> Outcome {
        guard(|| match (interpolation(spread), primvar_values(values, components)) {
            (Some(interpolation), Some(values)) => self.say_primvar(name, Some(Primvar { interpolation, values })),
            _ => {
                let text = format!("primvar '{name}' is ignored: {components} components, {spread:?} interpolation");
                self.host.say(Message::warning(Some(self.id.path()), text));
                self.say_primvar(name, None);
            }
        })
    }

    pub fn clear_primvar(&mut self, name: &str) -> Outcome {
        guard(|| self.say_primvar(name, None))
    }

    pub fn set_transform(&mut self, matrix: &[f64; 16]) -> Outcome {
        guard(|| self.patch.transform = Some(affine(matrix)))
    }

    pub fn set_visible(&mut self, visible: bool) -> Outcome {
        guard(|| {
            self.visible = visible;
            self.say_visibility();
        })
    }

    pub fn set_double_sided(&mut self, double_sided: bool) -> Outcome {
        guard(|| {
            self.double_sided = double_sided;
            self.patch.double_sided = Some(double_sided);
            self.say_culling();
        })
    }

    pub fn set_cull_style(&mut self, style: ffi::CullStyle) -> Outcome {
        guard(|| {
            self.cull_style = style;
            self.say_culling();
        })
    }

    pub fn set_material(&mut self, path: &str) -> Outcome {
        guard(|| self.patch.material = Some(material_id(path)))
    }

    pub fn set_instancer(&mut self, path: &str, indices: &[i32]) -> Outcome {
        guard(|| {
            self.patch.instancer = Some((!path.is_empty()).then(|| InstancerId::new(path)));
            self.patch.instance_indices = Some(indices.into());
        })
    }

    pub fn set_prim_id(&mut self, prim_id: i32) -> Outcome {
        guard(|| self.patch.prim_id = Some(prim_id))
    }

    pub fn set_categories(&mut self, names: &[&str]) -> Outcome {
        guard(|| self.patch.categories = Some(categories(names)))
    }

    pub fn set_render_tag(&mut self, tag: &str) -> Outcome {
        let purpose = purpose(tag);
        self.hidden = purpose.is_none();
        self.patch.purpose = purpose;
        self.say_visibility();
        if self.sent { self.commit() } else { Ok(()) }
    }

    pub fn commit(&mut self) -> Outcome {
        let patch = Box::new(std::mem::take(&mut self.patch));
        self.sent = true;
        guard_refusal(|| self.host.edit(SceneEdit::Mesh(self.id.clone(), patch)))
    }

    pub fn remove(&mut self) -> Outcome {
        self.sent = false;
        guard_refusal(|| self.host.edit(SceneEdit::RemoveMesh(self.id.clone())))
    }

    fn say_primvar(&mut self, name: &str, primvar: Option<Primvar>) {
        if name == NORMALS {
            self.patch.normals = Some(primvar);
        } else {
            self.patch.primvars.insert(name.into(), primvar);
        }
    }

    fn say_visibility(&mut self) {
        self.patch.visible = Some(self.visible && !self.hidden);
    }

    fn say_culling(&mut self) {
        use ffi::CullStyle as Style;
        let culled = match self.cull_style {
            Style::Back => CulledFaces::Back,
            Style::Front => CulledFaces::Front,
            Style::BackUnlessDoubleSided if !self.double_sided => CulledFaces::Back,
            Style::FrontUnlessDoubleSided if !self.double_sided => CulledFaces::Front,
            _ => CulledFaces::None,
        };
        self.patch.culled_faces = Some(culled);
    }
}

fn material_id(path: &str) -> Option<MaterialId> {
    (!path.is_empty()).then(|| MaterialId::new(path))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delegate::new_delegate;
    use umber_scene::Purpose;

    #[test]
    fn culling_and_visibility_combine() {
        let delegate = new_delegate().unwrap();
        let mut mesh = new_mesh(&delegate, "/m").unwrap();
        mesh.set_cull_style(ffi::CullStyle::BackUnlessDoubleSided).unwrap();
        assert_eq!(mesh.patch.culled_faces, Some(CulledFaces::Back));
        mesh.set_double_sided(true).unwrap();
        assert_eq!(mesh.patch.culled_faces, Some(CulledFaces::None));
        mesh.set_visible(true).unwrap();
        mesh.set_render_tag("hidden").unwrap();
        assert_eq!((mesh.patch.visible, mesh.patch.purpose), (Some(false), None));
        mesh.set_render_tag("proxy").unwrap();
        assert_eq!((mesh.patch.visible, mesh.patch.purpose), (Some(true), Some(Purpose::Proxy)));
    }

    #[test]
    fn a_tag_is_sent_at_once_only_where_the_mesh_is_known() {
        let delegate = new_delegate().unwrap();
        let mut mesh = new_mesh(&delegate, "/m").unwrap();
        mesh.set_render_tag("guide").unwrap();
        assert!(mesh.patch.purpose.is_some());
        mesh.commit().unwrap();
        mesh.set_render_tag("proxy").unwrap();
        assert!(mesh.patch.purpose.is_none());
    }

    #[test]
    fn subsets_and_primvars() {
        let delegate = new_delegate().unwrap();
        let mut mesh = new_mesh(&delegate, "/m").unwrap();
        mesh.clear_subsets().unwrap();
        mesh.add_subset("/k", &[0, 1]).unwrap();
        mesh.add_subset("", &[2]).unwrap();
        let subsets = mesh.patch.subsets.clone().unwrap();
        assert_eq!((subsets.len(), subsets[1].material.is_none()), (2, true));
        mesh.set_primvar("normals", ffi::Interpolation::Vertex, 3, &[0.0, 0.0, 1.0]).unwrap();
        assert!(matches!(mesh.patch.normals, Some(Some(_))));
        mesh.set_primvar("st", ffi::Interpolation::Instance, 2, &[0.0, 0.0]).unwrap();
        mesh.clear_primvar("displayColor").unwrap();
        // what cannot be used does not leave an older value standing
        assert!(mesh.patch.primvars.len() == 2 && mesh.patch.primvars.values().all(Option::is_none));
        assert_eq!(delegate.host().take_messages().len(), 1);
    }
}
