//! Materials: UsdPreviewSurface with constant inputs.

use std::sync::Arc;

use umber_render::Message;
use umber_scene::{MaterialId, PreviewSurface, SceneEdit};

use crate::delegate::Delegate;
use crate::guard::{Outcome, guard, guard_refusal};
use crate::host::Host;
use crate::preview_surface::{set_numbers, set_text};

/// Node types that describe a UsdPreviewSurface: USD's own, and the one of MaterialX' library.
const PREVIEW_SURFACE: [&str; 2] = ["UsdPreviewSurface", "ND_UsdPreviewSurface_surfaceshader"];

/// One `HdMaterial`.
pub struct Material {
    host: Arc<Host>,
    id: MaterialId,
    material: umber_scene::Material,
}

pub fn new_material(delegate: &Delegate, path: &str) -> Outcome<Box<Material>> {
    guard(|| {
        let material = umber_scene::Material::Unknown;
        Box::new(Material { host: delegate.host(), id: MaterialId::new(path), material })
    })
}

impl Material {
    pub fn set_surface(&mut self, node_type: &str) -> Outcome {
        guard(|| {
            self.material = umber_scene::Material::Unknown;
            if PREVIEW_SURFACE.contains(&node_type) {
                self.material = umber_scene::Material::Preview(PreviewSurface::default());
            } else if !node_type.is_empty() {
                self.warn(format!("surface shader '{node_type}' is not supported: displayColor is shown"));
            }
        })
    }

    pub fn set_numbers(&mut self, input: &str, numbers: &[f32]) -> Outcome {
        guard(|| {
            if let umber_scene::Material::Preview(surface) = &mut self.material {
                set_numbers(surface, input, numbers);
            }
        })
    }

    pub fn set_text(&mut self, input: &str, text: &str) -> Outcome {
        guard(|| {
            if let umber_scene::Material::Preview(surface) = &mut self.material {
                set_text(surface, input, text);
            }
        })
    }

    pub fn set_connection(&mut self, input: &str, node_type: &str, output: &str, fallback: &[f32]) -> Outcome {
        guard(|| {
            let umber_scene::Material::Preview(surface) = &mut self.material else { return };
            let taken = set_numbers(surface, input, selected(output, fallback));
            let instead = if taken { "the node's fallback" } else { "the input's own value" };
            self.warn(format!(
                "input '{input}' is connected to a {node_type}, which is not supported: {instead} is used"
            ));
        })
    }

    pub fn commit(&self) -> Outcome {
        guard_refusal(|| self.host.edit(SceneEdit::Material(self.id.clone(), self.material.clone())))
    }

    pub fn remove(&self) -> Outcome {
        guard_refusal(|| self.host.edit(SceneEdit::RemoveMaterial(self.id.clone())))
    }

    fn warn(&self, text: String) {
        self.host.say(Message::warning(Some(self.id.path()), text));
    }
}

/// Components of a texture's value that an output stands for.
fn selected<'a>(output: &str, value: &'a [f32]) -> &'a [f32] {
    let channel = match output {
        "r" => 0..1,
        "g" => 1..2,
        "b" => 2..3,
        "a" => 3..4,
        "rgb" => 0..3,
        _ => 0..value.len(),
    };
    value.get(channel).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delegate::new_delegate;
    use umber_math::Rgb;

    #[test]
    fn connections_take_the_fallback_and_warn() {
        let delegate = new_delegate().unwrap();
        let mut material = new_material(&delegate, "/m").unwrap();
        material.set_surface("UsdPreviewSurface").unwrap();
        material.set_numbers("roughness", &[0.25]).unwrap();
        material.set_connection("diffuseColor", "UsdUVTexture", "rgb", &[1.0, 0.5, 0.25, 0.0]).unwrap();
        material.set_connection("metallic", "UsdUVTexture", "g", &[1.0, 0.5, 0.25, 0.0]).unwrap();
        material.set_connection("roughness", "Noise", "out", &[]).unwrap();
        let umber_scene::Material::Preview(surface) = &material.material else { panic!("not a preview surface") };
        assert_eq!(surface.diffuse_color, Rgb::new(1.0, 0.5, 0.25));
        assert_eq!((surface.metallic, surface.roughness), (0.5, 0.25));
        let messages = delegate.host().take_messages();
        assert_eq!(messages.len(), 3);
        assert!(messages[2].text.contains("roughness") && messages[2].text.contains("own value"));
    }

    #[test]
    fn unknown_shaders_are_named() {
        let delegate = new_delegate().unwrap();
        let mut material = new_material(&delegate, "/m").unwrap();
        material.set_surface("ND_standard_surface_surfaceshader").unwrap();
        assert_eq!(material.material, umber_scene::Material::Unknown);
        assert!(delegate.host().take_messages()[0].text.contains("ND_standard_surface_surfaceshader"));
        material.set_surface("").unwrap();
        assert!(delegate.host().take_messages().is_empty());
    }
}
