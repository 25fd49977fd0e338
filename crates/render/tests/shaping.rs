//! Spots, profiles and strange shadows in whole pictures.

mod common;

use common::*;
use umber_math::{DAffine3, DVec3, Rgb};
use umber_render::{Aov, Session};
use umber_scene::{Light, LightId, LightKind, MeshPatch, SceneEdit, Shadow, Shaping};

const POINT: LightKind = LightKind::Sphere { radius: 0.5, treat_as_point: true };

/// A camera at 3 looks at the box's upper face, at 1, 4 wide: its own 2 are the middle half of the picture.
fn face(light: Light, more: impl FnOnce(&Session)) -> (Vec<[f32; 4]>, Vec<String>) {
    let session = session(3.0, 64, &[Aov::Color]);
    session.edit(mesh("/box", cube())).unwrap();
    bind(&session, "/box", "/m", lambert(0.5, 0.0));
    session.edit(setting("umber:maxBounces", 1)).unwrap();
    session.edit(SceneEdit::Light(LightId::new("/l"), light)).unwrap();
    more(&session);
    finish(&session);
    (color(&session), session.take_messages().into_iter().map(|m| format!("{:?} {}", m.prim, m.text)).collect())
}
/// A light over the middle of the face.
fn over(height: f64, kind: LightKind) -> Light {
    Light { world_from_light: DAffine3::from_translation(DVec3::new(0.0, 0.0, 1.0 + height)), ..Light::new(kind) }
}
/// The middle of a pixel on the face's plane.
fn place(pixel: usize) -> (f32, f32) {
    let across = |i: usize| ((i as f32 + 0.5) / SIZE as f32 - 0.5) * 2.0;
    (across(pixel % SIZE), across(pixel / SIZE))
}

/// A spot on a plane: E = I cos³ / h², times the cone's and the focus's factor, and nothing outside the cone.
#[test]
fn a_spot_on_a_plane() {
    let tint = Rgb::new(0.0, 0.5, 1.0);
    let shaping =
        Shaping { focus: 2.0, focus_tint: tint, cone_angle_deg: 50.0, cone_softness: 0.5, ..Shaping::default() };
    let height = 0.6f32;
    let (pixels, messages) = face(Light { shaping, intensity: 8.0, ..over(f64::from(height), POINT) }, |_| {});
    assert_eq!(messages, [""; 0]);
    let intensity = 8.0 * std::f32::consts::PI * 0.25;
    let outgoing = |x: f32, y: f32| {
        let cos = height / (x * x + y * y + height * height).sqrt();
        let t = ((cos.acos().to_degrees() - 25.0) / 25.0).clamp(0.0, 1.0);
        let soft = 1.0 - t * t * (3.0 - 2.0 * t);
        let irradiance = intensity * cos.powi(3) / (height * height) * soft;
        tint.lerp(Rgb::WHITE, cos * cos).0 * (irradiance * 0.5 / std::f32::consts::PI)
    };
    let mut lit = 0;
    for (i, pixel) in pixels.iter().enumerate() {
        let (x, y) = place(i);
        let within = |k: usize| ((k as f32 + 0.5) / 8.0 - 0.5) * 2.0 / SIZE as f32;
        let parts = (0..64).map(|k| outgoing(x + within(k % 8), y + within(k / 8)));
        let want = parts.sum::<umber_math::Vec3>() / 64.0;
        let got = umber_math::Vec3::new(pixel[0], pixel[1], pixel[2]);
        assert!((got - want).abs().max_element() < 0.02 * want.max_element() + 3e-3, "({x}, {y}): {got}, not {want}");
        let outside = (x * x + y * y).sqrt() > height * 50f32.to_radians().tan() + 0.07;
        assert!(!outside || got == umber_math::Vec3::ZERO, "({x}, {y}): {got} outside the cone");
        lit += u32::from(got.x > 0.0);
    }
    assert!(lit > 150, "{lit}");
}

/// An area spot over a face, found by light samples and rays, and (its shadow being tinted) by light samples alone.
#[test]
fn both_ways_give_the_same_picture() {
    let shaping = Shaping { cone_angle_deg: 60.0, cone_softness: 0.7, focus: 1.0, ..Shaping::default() };
    let sum = |shadow: Shadow| {
        let kind = LightKind::Rect { width: 1.0, height: 1.0 };
        let (pixels, _) = face(Light { shaping: shaping.clone(), shadow, ..over(0.7, kind) }, |_| {});
        pixels.iter().map(|p| p[0]).sum::<f32>()
    };
    let (by_both, by_samples) = (sum(Shadow::default()), sum(Shadow { color: Rgb::splat(0.1), ..Shadow::default() }));
    assert!((by_both / by_samples - 1.0).abs() < 5e-3, "{by_both} {by_samples}");
}

/// How bright the face is in the shadow of a small lid at this height over it, beside the lid as the camera sees it.
fn lidded(height: f32, shadow: Shadow) -> [f32; 3] {
    let light = Light { shadow, intensity: 8.0, ..over(1.5, POINT) };
    let lid = |session: &Session| {
        let flat = cube().points.unwrap().iter().map(|p| *p * umber_math::Vec3::new(0.2, 0.2, 1e-3)).collect();
        let at = DAffine3::from_translation(DVec3::new(0.0, 0.0, f64::from(1.0 + height)));
        let patch = MeshPatch { points: Some(flat), transform: Some(at), prim_id: Some(8), ..cube() };
        session.edit(mesh("/lid", patch)).unwrap();
    };
    let (pixels, messages) = face(light, lid);
    assert_eq!(messages, [""; 0]);
    let edge = 0.2 * (1.5 / (1.5 - height)) * 0.5 + 0.1 / (1.0 - height * 0.5);
    let pixel = (0..pixels.len()).find(|&i| place(i).0 > edge && place(i).1 > 0.0).unwrap();
    [pixels[pixel][0], pixels[pixel][1], pixels[pixel][2]]
}

#[test]
fn shadows_have_their_colour_and_reach() {
    let plain = Shadow::default();
    let height = 0.9;
    let dark = lidded(height, plain.clone());
    assert_eq!(dark, [0.0; 3]);
    let [full, ..] = lidded(height, Shadow { color: Rgb::WHITE, ..plain.clone() });
    assert!(full > 0.1, "{full}");
    let close = |got: [f32; 3], want: [f32; 3]| {
        assert!((0..3).all(|c| (got[c] - want[c] * full).abs() < 0.03 * full), "{got:?}, not {want:?} of {full}");
    };
    close(lidded(height, Shadow { color: Rgb::new(0.25, 0.5, 0.75), ..plain.clone() }), [0.25, 0.5, 0.75]);
    close(lidded(height, Shadow { distance: 0.5, ..plain.clone() }), [1.0; 3]);
    close(lidded(height, Shadow { distance: 1.2, ..plain.clone() }), [0.0; 3]);
    // The lid is about 0.9 away, straight up: between 0.5, where the shadow is full, and 1.3, where it ends.
    let slope = (height / (height * height + 0.04f32).sqrt()).recip();
    let through = (height * slope - 0.5) / 0.8;
    close(lidded(height, Shadow { distance: 1.3, falloff: 0.8, ..plain.clone() }), [through; 3]);
    let squared = Shadow { distance: 1.3, falloff: 0.8, falloff_gamma: 2.0, ..plain };
    close(lidded(height, squared), [1.0 - (1.0 - through).powi(2); 3]);
}

/// A profile that cannot be used is named, and the light shines without it.
#[test]
fn missing_profiles_are_named() {
    let shine = |shaping: Shaping| {
        let (pixels, messages) = face(Light { shaping, ..over(0.6, POINT) }, |_| {});
        assert!(pixels.iter().flatten().all(|v| v.is_finite()));
        (pixels.iter().map(|p| p[0]).sum::<f32>(), messages)
    };
    let (plain, none) = shine(Shaping::default());
    assert_eq!(none, [""; 0]);
    let file = std::env::temp_dir().join(format!("umber-broken-{}.ies", std::process::id()));
    std::fs::write(&file, "IESNA:LM-63-2002\nTILT=NONE\n1 1000").unwrap();
    for path in ["/nowhere/lamp.ies".into(), file.clone(), std::env::temp_dir()] {
        let (sum, messages) = shine(Shaping { ies_file: Some(path.clone()), ..Shaping::default() });
        assert!(sum == plain && messages.len() == 1, "{sum} {plain} {messages:?}");
        assert!(messages[0].contains("/l") && messages[0].contains(path.to_str().unwrap()), "{messages:?}");
    }
    // One that can be read halves the light that a profile of a half gives.
    std::fs::write(&file, "TILT=NONE\n1 1 1 2 1 1 2 0 0 0\n1 1 1\n0 180\n0\n0.5 0.5\n").unwrap();
    let (sum, messages) = shine(Shaping { ies_file: Some(file.clone()), ..Shaping::default() });
    assert!((sum / plain - 0.5).abs() < 1e-4 && messages.is_empty(), "{sum} {plain} {messages:?}");
    std::fs::remove_file(file).unwrap();
}

/// Whatever numbers a light has, the picture is finite, and what was mended is said once.
#[test]
fn odd_numbers_give_no_nan() {
    let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, -1.0, 0.0, 1e-38];
    let kinds = [
        POINT,
        LightKind::Sphere { radius: 0.3, treat_as_point: false },
        LightKind::Rect { width: 0.5, height: 0.5 },
        LightKind::Distant { angle_deg: 5.0 },
        LightKind::Dome { texture: None },
    ];
    for (v, i) in odd.into_iter().zip(0u64..) {
        for kind in &kinds {
            let session = session(3.0, 2, &[Aov::Color]);
            session.edit(mesh("/box", cube())).unwrap();
            let base = over(0.8, kind.clone());
            let shaping = |change: &dyn Fn(&mut Shaping)| {
                let mut light =
                    Light { shaping: Shaping { cone_angle_deg: 40.0, ..Shaping::default() }, ..base.clone() };
                change(&mut light.shaping);
                light
            };
            let shadow = |change: &dyn Fn(&mut Shadow)| {
                let mut light = base.clone();
                change(&mut light.shadow);
                light
            };
            let lights = [
                Light { intensity: v, ..base.clone() },
                Light { exposure: v, ..base.clone() },
                Light { color: Rgb::new(v, 1.0, v), ..base.clone() },
                Light { color_temperature: Some(v), ..base.clone() },
                Light { diffuse: v, specular: v, ..base.clone() },
                shaping(&|s| s.cone_angle_deg = v),
                shaping(&|s| s.cone_softness = v),
                shaping(&|s| (s.focus, s.focus_tint) = (v, Rgb::splat(0.5))),
                shaping(&|s| (s.focus, s.focus_tint) = (2.0, Rgb::splat(v))),
                shadow(&|s| s.color = Rgb::splat(v)),
                shadow(&|s| s.distance = v),
                shadow(&|s| (s.distance, s.falloff) = (1.0, v)),
                shadow(&|s| (s.distance, s.falloff, s.falloff_gamma) = (1.0, 1.0, v)),
            ];
            for (light, n) in lights.into_iter().zip(0..) {
                session.edit(SceneEdit::Light(LightId::new(&format!("/l{n}")), light)).unwrap();
            }
            finish(&session);
            let pixels = color(&session);
            assert!(pixels.iter().flatten().all(|v| v.is_finite()), "{v} ({i}) on {kind:?}");
            let messages = session.take_messages();
            assert!(v.is_finite() || messages.len() > 5, "{v}: {} messages", messages.len());
        }
    }
}
