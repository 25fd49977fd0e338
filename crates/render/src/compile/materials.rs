//! Materials by index, and which face has which.

use std::collections::BTreeMap;
use std::sync::Arc;

use umber_math::Rgb;
use umber_scene::{Material, MaterialId, Mesh, OpacityMode};
use umber_shading::Lobes;

use crate::material::{RenderMaterial, in_unit};
use crate::mesh::NO_MATERIAL;

/// All materials and behind them a black one, and their index by path. Says what of their emission cannot be used.
pub fn compile(
    materials: &BTreeMap<MaterialId, Material>,
    warn: &mut dyn FnMut(&str, String),
) -> (BTreeMap<MaterialId, u32>, Arc<[RenderMaterial]>) {
    for (id, material) in materials {
        if let Material::Preview(surface) = material
            && let Some(problem) = emission_problem(surface.emissive_color)
        {
            warn(id.path(), problem.to_owned());
        }
    }
    let indices = materials.keys().cloned().zip(0..).collect();
    let lobes = Some(Lobes::lambert(Rgb::BLACK));
    let black = RenderMaterial { lobes, base_color: Some(Rgb::BLACK), emission: Rgb::BLACK, presence: 1.0 };
    (indices, materials.values().map(compile_one).chain([black]).collect())
}

/// Index of the black material.
pub fn black(materials: &[RenderMaterial]) -> u32 {
    materials.len() as u32 - 1
}

/// What is wrong with an `emissiveColor`.
fn emission_problem(color: Rgb) -> Option<&'static str> {
    let any = |test: fn(f32) -> bool| color.0.to_array().into_iter().any(test);
    if any(f32::is_nan) {
        Some("emissiveColor is not a number; it counts as zero")
    } else if any(|c| c < 0.0) {
        Some("emissiveColor is negative; it counts as zero")
    } else if any(|c| c > 1e30) {
        Some("emissiveColor is brighter than can be rendered; it is cut to 1e30")
    } else {
        None
    }
}

fn compile_one(material: &Material) -> RenderMaterial {
    match material {
        Material::Unknown => RenderMaterial { lobes: None, base_color: None, emission: Rgb::BLACK, presence: 1.0 },
        Material::Preview(surface) => {
            let base_color = Some(base_color(surface));
            let surface = preview_surface(surface);
            let (emission, presence) = (surface.emission(), surface.presence());
            RenderMaterial { lobes: Some(surface.lobes()), base_color, emission, presence }
        }
    }
}

/// What a metal reflects, or a surface that is none.
fn base_color(s: &umber_scene::PreviewSurface) -> Rgb {
    let has_diffuse = !(s.use_specular_workflow && s.diffuse_color.is_black());
    in_unit(if has_diffuse { s.diffuse_color } else { s.specular_color })
}

fn preview_surface(s: &umber_scene::PreviewSurface) -> umber_shading::PreviewSurface {
    umber_shading::PreviewSurface {
        diffuse_color: s.diffuse_color,
        emissive_color: s.emissive_color,
        use_specular_workflow: s.use_specular_workflow,
        specular_color: s.specular_color,
        metallic: s.metallic,
        roughness: s.roughness,
        clearcoat: s.clearcoat,
        clearcoat_roughness: s.clearcoat_roughness,
        opacity: s.opacity,
        opacity_mode: match s.opacity_mode {
            OpacityMode::Transparent => umber_shading::OpacityMode::Transparent,
            OpacityMode::Presence => umber_shading::OpacityMode::Presence,
        },
        opacity_threshold: s.opacity_threshold,
        ior: s.ior,
    }
}

/// Material indices of a mesh.
pub struct MeshMaterials {
    /// Of the faces that no subset names.
    pub whole: u32,
    /// Of each face, where subsets name any.
    pub faces: Option<Arc<[u32]>>,
}

/// Finds the materials of a mesh. Says which bindings lead nowhere.
pub fn of_mesh(mesh: &Mesh, indices: &BTreeMap<MaterialId, u32>, say: &mut dyn FnMut(String)) -> MeshMaterials {
    let mut find = |id: &Option<MaterialId>| {
        let Some(id) = id else { return NO_MATERIAL };
        indices.get(id).copied().unwrap_or_else(|| {
            say(format!("material <{id}> does not exist: displayColor is shown"));
            NO_MATERIAL
        })
    };
    let whole = find(&mesh.material);
    let subsets: Vec<(u32, &[i32])> = mesh
        .subsets
        .iter()
        .filter(|subset| subset.material.is_some())
        .map(|subset| (find(&subset.material), &*subset.faces))
        .collect();
    if subsets.is_empty() {
        return MeshMaterials { whole, faces: None };
    }
    let mut faces = vec![whole; mesh.topology.face_vertex_counts.len()];
    let mut beyond = 0usize;
    for (material, face) in subsets.iter().flat_map(|(m, faces)| faces.iter().map(move |f| (*m, *f))) {
        match usize::try_from(face).ok().and_then(|f| faces.get_mut(f)) {
            Some(of_face) => *of_face = material,
            None => beyond += 1,
        }
    }
    if beyond > 0 {
        say(format!("{beyond} faces of material subsets ignored: the mesh has only {}", faces.len()));
    }
    MeshMaterials { whole, faces: Some(faces.into()) }
}
