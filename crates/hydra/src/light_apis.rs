//! ShapingAPI and ShadowAPI of lights, by HdLight's parameter names.

use umber_math::Rgb;
use umber_scene::Light;

/// Parameters that [`set_numbers`] and [`set_text`] know.
pub const PARAMETERS: [&str; 11] = [
    "shaping:focus",
    "shaping:focusTint",
    "shaping:cone:angle",
    "shaping:cone:softness",
    "shaping:ies:file",
    "shaping:ies:angleScale",
    "shaping:ies:normalize",
    "shadow:color",
    "shadow:distance",
    "shadow:falloff",
    "shadow:falloffGamma",
];

/// Takes a parameter of one of the two schemas; `false` where it is of neither.
pub fn set_numbers(light: &mut Light, parameter: &str, numbers: &[f32]) -> bool {
    let (shaping, shadow) = (&mut light.shaping, &mut light.shadow);
    let color = |to: &mut Rgb| {
        if let &[r, g, b] = numbers {
            *to = Rgb::new(r, g, b);
        }
    };
    let Some(&number) = numbers.first() else { return false };
    match parameter {
        "shaping:focus" => shaping.focus = number,
        "shaping:focusTint" => color(&mut shaping.focus_tint),
        "shaping:cone:angle" => shaping.cone_angle_deg = number,
        "shaping:cone:softness" => shaping.cone_softness = number,
        "shaping:ies:angleScale" => shaping.ies_angle_scale = number,
        "shaping:ies:normalize" => shaping.ies_normalize = number != 0.0,
        "shadow:color" => color(&mut shadow.color),
        "shadow:distance" => shadow.distance = number,
        "shadow:falloff" => shadow.falloff = number,
        "shadow:falloffGamma" => shadow.falloff_gamma = number,
        _ => return false,
    }
    true
}

/// Takes a parameter that is text; `false` where it is of neither schema.
pub fn set_text(light: &mut Light, parameter: &str, text: &str) -> bool {
    if parameter != "shaping:ies:file" {
        return false;
    }
    light.shaping.ies_file = (!text.is_empty()).then(|| text.into());
    true
}
