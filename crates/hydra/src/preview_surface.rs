//! UsdPreviewSurface's inputs by name.

use umber_math::Rgb;
use umber_scene::{OpacityMode, PreviewSurface};

/// Sets an input. False where there is none of that name, or it takes more numbers.
pub fn set_numbers(surface: &mut PreviewSurface, input: &str, numbers: &[f32]) -> bool {
    let color = match input {
        "diffuseColor" => Some(&mut surface.diffuse_color),
        "emissiveColor" => Some(&mut surface.emissive_color),
        "specularColor" => Some(&mut surface.specular_color),
        _ => None,
    };
    if let Some(color) = color {
        let &[r, g, b, ..] = numbers else { return false };
        *color = Rgb::new(r, g, b);
        return true;
    }
    let Some(&number) = numbers.first() else { return false };
    match input {
        "useSpecularWorkflow" => surface.use_specular_workflow = number != 0.0,
        "metallic" => surface.metallic = number,
        "roughness" => surface.roughness = number,
        "clearcoat" => surface.clearcoat = number,
        "clearcoatRoughness" => surface.clearcoat_roughness = number,
        "opacity" => surface.opacity = number,
        "opacityMode" => surface.opacity_mode = mode(number != 0.0),
        "opacityThreshold" => surface.opacity_threshold = number,
        "ior" => surface.ior = number,
        _ => return false,
    }
    true
}

/// Sets an input whose value is a word.
pub fn set_text(surface: &mut PreviewSurface, input: &str, text: &str) {
    if input == "opacityMode" {
        surface.opacity_mode = mode(text == "presence");
    }
}

/// MaterialX counts the modes: transparent is 0, presence 1.
fn mode(presence: bool) -> OpacityMode {
    if presence { OpacityMode::Presence } else { OpacityMode::Transparent }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inputs_by_name() {
        let mut surface = PreviewSurface::default();
        assert!(set_numbers(&mut surface, "emissiveColor", &[1.0, 2.0, 3.0]));
        assert!(!set_numbers(&mut surface, "diffuseColor", &[1.0]));
        assert!(!set_numbers(&mut surface, "displacement", &[1.0]));
        assert!(!set_numbers(&mut surface, "ior", &[]));
        set_text(&mut surface, "opacityMode", "presence");
        let want = PreviewSurface {
            emissive_color: Rgb::new(1.0, 2.0, 3.0),
            opacity_mode: OpacityMode::Presence,
            ..PreviewSurface::default()
        };
        assert_eq!(surface, want);
    }
}
