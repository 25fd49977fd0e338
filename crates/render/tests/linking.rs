//! Light and shadow linking: against the same scene built without it.

mod common;

use std::sync::Arc;

use common::*;
use umber_math::{DAffine3, DVec3, Rgb};
use umber_render::{Aov, Session};
use umber_scene::{
    Category, InstancerId, InstancerPatch, Light, LightId, LightKind, Material, MeshPatch, PreviewSurface, SceneEdit,
};

const LEFT: &str = "/left";
const RIGHT: &str = "/right";

fn set(names: &[&str]) -> Arc<[Category]> {
    names.iter().map(|name| Category::new(name)).collect()
}

fn at(x: f64, y: f64, z: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, y, z))
}

fn light(session: &Session, path: &str, light: Light) {
    session.edit(SceneEdit::Light(LightId::new(path), light)).unwrap();
}

fn linked(light: Light, to: &str) -> Light {
    Light { light_link: Some(Category::new(to)), ..light }
}

fn shadowed_by(light: Light, by: &str) -> Light {
    Light { shadow_link: Some(Category::new(by)), ..light }
}

/// Two cubes side by side, the left one in category `l`, the right one in `r`; direct light alone.
fn cubes(samples: i64, material: &Material) -> Session {
    let session = session(8.0, samples, &[Aov::Color, Aov::PrimId]);
    session.edit(setting("umber:maxBounces", 1)).unwrap();
    for (path, x, prim_id, category) in [(LEFT, -1.7, 1, "l"), (RIGHT, 1.7, 2, "r")] {
        let categories = Some(set(&[category, "both"]));
        let patch = MeshPatch { transform: Some(at(x, 0.0, 0.0)), prim_id: Some(prim_id), categories, ..cube() };
        session.edit(mesh(path, patch)).unwrap();
        bind(&session, path, "/m", material.clone());
    }
    session
}

/// Glossy over diffuse: both ways of finding a light count.
fn glossy() -> Material {
    let surface = PreviewSurface { diffuse_color: Rgb::splat(0.4), roughness: 0.3, ..PreviewSurface::default() };
    Material::Preview(surface)
}

/// A light that reaches the left cube, and one before it that would shadow it there.
fn far_light() -> Light {
    let kind = LightKind::Sphere { radius: 2.0, treat_as_point: false };
    Light { world_from_light: at(0.0, 1.0, 24.0), intensity: 40.0, ..Light::new(kind) }
}

fn near_light() -> Light {
    let kind = LightKind::Sphere { radius: 1.5, treat_as_point: false };
    Light { world_from_light: at(-0.9, 0.5, 12.0), intensity: 20.0, color: Rgb::new(0.2, 0.5, 1.0), ..Light::new(kind) }
}

/// Pixels around which all is the same prim.
fn inside(session: &Session, prim: i32) -> Vec<usize> {
    let prims = ids(session, Aov::PrimId);
    let around = |i: usize| {
        let (x, y) = (i % SIZE, i / SIZE);
        (1..SIZE - 1).contains(&x)
            && (1..SIZE - 1).contains(&y)
            && (y - 1..=y + 1).all(|y| (x - 1..=x + 1).all(|x| prims[y * SIZE + x] == prim))
    };
    let found: Vec<usize> = (0..SIZE * SIZE).filter(|i| around(*i)).collect();
    assert!(found.len() > 8, "the cube is not seen");
    found
}

fn at_pixels(session: &Session, pixels: &[usize]) -> Vec<[f32; 4]> {
    let all = color(session);
    pixels.iter().map(|i| all[*i]).collect()
}

fn mean(pixels: &[[f32; 4]]) -> f32 {
    pixels.iter().map(|p| p[0] + p[1] + p[2]).sum::<f32>() / pixels.len() as f32
}

/// Each cube has its own light: on it, every pixel is as if the other light were not there at all, bit by bit.
#[test]
fn linked_lights_are_as_lights_of_scenes_of_their_own() {
    let suns = [false, true].map(|with_sun| {
        let sun = Light { intensity: 3000.0, ..Light::new(LightKind::Distant { angle_deg: 5.0 }) };
        let (far, near) = (if with_sun { sun } else { far_light() }, near_light());
        let solo = |light_: &Light| {
            let session = cubes(16, &glossy());
            light(&session, "/a", light_.clone());
            finish(&session);
            session
        };
        let both = cubes(16, &glossy());
        light(&both, "/a", linked(far.clone(), "l"));
        light(&both, "/b", linked(near.clone(), "r"));
        finish(&both);
        assert_messages(&both, &[]);
        let (left, right) = (inside(&both, 1), inside(&both, 2));
        assert_eq!(at_pixels(&both, &left), at_pixels(&solo(&far), &left));
        assert_eq!(at_pixels(&both, &right), at_pixels(&solo(&near), &right));
        let unlinked = cubes(16, &glossy());
        light(&unlinked, "/a", far);
        light(&unlinked, "/b", near);
        finish(&unlinked);
        assert_ne!(at_pixels(&both, &left), at_pixels(&unlinked, &left));
        mean(&at_pixels(&both, &left))
    });
    assert!(suns.iter().all(|mean| *mean > 0.01), "nothing is lit: {suns:?}");
}

/// Many lights, of which few reach one cube: on it, every pixel is as if the others were not there at all, bit by bit.
#[test]
fn few_of_many_lights_are_as_lights_of_a_scene_of_their_own() {
    let lamp = |i: usize| {
        let kind = LightKind::Sphere { radius: 0.7, treat_as_point: false };
        Light {
            world_from_light: at(1.6 * i as f64 - 6.4, 1.0, 9.0 + (i % 3) as f64),
            intensity: 9.0,
            ..Light::new(kind)
        }
    };
    let render = |others: bool| {
        let session = cubes(16, &glossy());
        for i in (0..9).filter(|i| others || i % 4 == 1) {
            let category = if i % 4 == 1 { "l" } else { "r" };
            light(&session, &format!("/lamp{i}"), linked(lamp(i), category));
        }
        finish(&session);
        session
    };
    let (many, few) = (render(true), render(false));
    let left = inside(&many, 1);
    assert_eq!(at_pixels(&many, &left), at_pixels(&few, &left));
    assert!(mean(&at_pixels(&many, &left)) > 0.01);
}

/// Many lights, more than are weighed one by one: sums of pictures, in the mean.
#[test]
fn many_linked_lights_add_up() {
    let lamp = |i: usize| {
        let kind = LightKind::Rect { width: 1.0, height: 1.0 };
        let (x, y) = ((i % 7) as f64 - 3.0, (i / 7) as f64 - 2.0);
        Light { world_from_light: at(2.0 * x, 2.0 * y, 11.0 + (i % 3) as f64), intensity: 4.0, ..Light::new(kind) }
    };
    let render = |links: bool, wanted: fn(usize) -> bool| {
        let session = cubes(256, &glossy());
        for i in (0..35).filter(|i| wanted(*i)) {
            let category = if i % 3 == 0 { "l" } else { "r" };
            light(&session, &format!("/lamp{i}"), if links { linked(lamp(i), category) } else { lamp(i) });
        }
        finish(&session);
        [1, 2].map(|prim| mean(&at_pixels(&session, &inside(&session, prim))))
    };
    let all = render(true, |_| true);
    let [left, _] = render(false, |i| i % 3 == 0);
    let [_, right] = render(false, |i| i % 3 != 0);
    assert!((all[0] / left - 1.0).abs() < 0.01, "{all:?}: left {left}");
    assert!((all[1] / right - 1.0).abs() < 0.01, "{all:?}: right {right}");
}

/// Links that leave nothing out change nothing, bit by bit.
#[test]
fn links_that_cover_everything_cost_and_change_nothing() {
    let picture = |edit: fn(Light) -> Light| {
        let session = cubes(8, &glossy());
        light(&session, "/a", edit(far_light()));
        light(&session, "/b", edit(near_light()));
        finish(&session);
        (color(&session), session.stats().rays)
    };
    let plain = picture(|light| light);
    assert_eq!(plain, picture(|light| linked(light, "both")));
    assert_eq!(plain, picture(|light| shadowed_by(light, "both")));
}

/// A floor below a cube that hangs in the light, looked at from below the cube; the cube is out of the picture.
fn floor(samples: i64, edit: impl Fn(Light) -> Light, kind: LightKind, with_cube: bool) -> f32 {
    let session = session(1.5, samples, &[Aov::Color]);
    session.edit(setting("umber:maxBounces", 1)).unwrap();
    let floor = DAffine3::from_scale_rotation_translation(
        DVec3::new(20.0, 20.0, 0.5),
        glam::DQuat::IDENTITY,
        DVec3::new(0.0, 0.0, -0.5),
    );
    let categories = Some(set(&["floor"]));
    session.edit(mesh("/floor", MeshPatch { transform: Some(floor), categories, ..cube() })).unwrap();
    bind(&session, "/floor", "/m", glossy());
    if with_cube {
        let categories = Some(set(&["cube"]));
        let patch = MeshPatch { transform: Some(at(0.8, 0.0, 4.0)), categories, ..cube() };
        session.edit(mesh("/cube", patch)).unwrap();
        bind(&session, "/cube", "/m", glossy());
    }
    let place = at(0.0, 0.0, 12.0);
    light(&session, "/l", edit(Light { intensity: 10.0, world_from_light: place, ..Light::new(kind) }));
    finish(&session);
    assert_messages(&session, &[]);
    mean(&color(&session))
}

/// What is not in a light's shadow collection casts no shadow in it; what is casts the same as ever.
#[test]
fn only_linked_things_cast_shadows() {
    let kinds = [
        LightKind::Sphere { radius: 2.0, treat_as_point: false },
        LightKind::Rect { width: 3.0, height: 2.0 },
        LightKind::Distant { angle_deg: 20.0 },
        LightKind::Dome { texture: None },
    ];
    for kind in kinds {
        let render = |edit: fn(Light) -> Light, with_cube| floor(128, edit, kind.clone(), with_cube);
        let (open, shadowed) = (render(|l| l, false), render(|l| l, true));
        let close = |got: f32, want: f32| (got / want - 1.0).abs() < 0.01;
        assert!(shadowed < 0.93 * open, "the cube casts no shadow: {kind:?}");
        for edit in [|l| shadowed_by(l, "floor"), |l| shadowed_by(l, "nothing")] {
            let got = render(edit, true);
            assert!(close(got, open), "{kind:?}: {got}, not {open}");
        }
        let got = render(|l| shadowed_by(l, "cube"), true);
        assert!(close(got, shadowed), "{kind:?}: {got}, not {shadowed}");
    }
}

/// Instances of one mesh, each with categories of its own, or all with the instancer's.
#[test]
fn instances_are_linked_one_by_one() {
    let render = |categories: Vec<Arc<[Category]>>, nested: bool| {
        let session = session(8.0, 8, &[Aov::Color, Aov::InstanceId]);
        let id = InstancerId::new("/i");
        let patch = InstancerPatch {
            transforms: Some([at(-1.7, 0.0, 0.0), at(1.7, 0.0, 0.0)].into()),
            categories: Some(categories.into()),
            ..InstancerPatch::default()
        };
        session.edit(SceneEdit::Instancer(id.clone(), patch)).unwrap();
        let inner = InstancerId::new("/inner");
        if nested {
            let patch = InstancerPatch {
                parent: Some(Some(id.clone())),
                parent_indices: Some([0, 1].into()),
                transforms: Some([DAffine3::IDENTITY].into()),
                // what the outermost instancer says counts
                categories: Some([set(&["l"])].into()),
                ..InstancerPatch::default()
            };
            session.edit(SceneEdit::Instancer(inner.clone(), patch)).unwrap();
        }
        let instancer = Some(Some(if nested { inner } else { id }));
        let instance_indices: Arc<[i32]> = if nested { [0].into() } else { [0, 1].into() };
        let categories = Some(set(&["l"]));
        let patch = MeshPatch { instancer, instance_indices: Some(instance_indices), categories, ..cube() };
        session.edit(mesh("/cube", patch)).unwrap();
        light(&session, "/a", linked(far_light(), "l"));
        finish(&session);
        let (pixels, instances) = (color(&session), ids(&session, Aov::InstanceId));
        [0, 1].map(|instance| {
            let of_it = pixels.iter().zip(&instances).filter(|(_, id)| **id == instance);
            of_it.map(|(pixel, _)| pixel[0]).fold(0.0, f32::max)
        })
    };
    for nested in [false, true] {
        let [lit, dark] = render(vec![set(&["l"]), set(&["other"])], nested);
        assert!(lit > 0.02 && dark < 0.1 * lit, "{lit} {dark}");
        let [dark, lit] = render(vec![set(&[]), set(&["l"])], nested);
        assert!(lit > 0.02 && dark < 0.1 * lit, "{lit} {dark}");
        let both = render(vec![set(&["l"])], nested);
        assert!(both.iter().all(|lit| *lit > 0.02), "{both:?}");
        let neither = render(Vec::new(), nested);
        assert!(neither.iter().all(|dark| *dark == 0.0), "{neither:?}");
    }
}

/// Edits of categories and of links show, and build no mesh.
#[test]
fn links_can_be_edited() {
    let session = cubes(8, &glossy());
    light(&session, "/a", linked(far_light(), "l"));
    let means = |session: &Session| {
        finish(session);
        [1, 2].map(|prim| mean(&at_pixels(session, &inside(session, prim))))
    };
    let [left, right] = means(&session);
    assert!(left > 0.02 && right == 0.0, "{left} {right}");
    let edit = |path: &str, names: &[&str]| {
        session.edit(mesh(path, MeshPatch { categories: Some(set(names)), ..MeshPatch::default() })).unwrap()
    };
    assert!(edit(RIGHT, &["l"]) && !edit(RIGHT, &["l"]));
    let [left, right] = means(&session);
    assert!(left > 0.02 && right > 0.02, "{left} {right}");
    assert_eq!(session.stats().built_meshes, 0);
    assert!(edit(LEFT, &[]));
    let [left, right] = means(&session);
    assert!(left == 0.0 && right > 0.02, "{left} {right}");
    light(&session, "/a", far_light());
    let [left, right] = means(&session);
    assert!(left > 0.02 && right > 0.02, "{left} {right}");
    light(&session, "/a", linked(far_light(), "no such category"));
    assert_eq!(means(&session), [0.0, 0.0]);
    assert_eq!(session.stats().built_meshes, 0);
}

/// The camera sees a light that it is not linked to, and so does a mirror that the light is linked to.
#[test]
fn the_camera_sees_all_lights() {
    let session = session(8.0, 4, &[Aov::Color]);
    let kind = LightKind::Sphere { radius: 2.0, treat_as_point: false };
    light(&session, "/l", Light { intensity: 3.0, ..linked(shadowed_by(Light::new(kind), "none"), "none") });
    session.edit(mesh("/cube", MeshPatch { transform: Some(at(0.0, 0.0, -9.0)), ..cube() })).unwrap();
    finish(&session);
    assert_eq!(color(&session)[SIZE * SIZE / 2 + SIZE / 2], [3.0, 3.0, 3.0, 1.0]);
    let mirror =
        PreviewSurface { metallic: 1.0, roughness: 0.0, diffuse_color: Rgb::WHITE, ..PreviewSurface::default() };
    let reflected = |to: &str| {
        let session = cubes(16, &Material::Preview(mirror.clone()));
        let kind = LightKind::Sphere { radius: 8.0, treat_as_point: false };
        let ball = Light { intensity: 3.0, world_from_light: at(0.0, 0.0, 24.0), ..Light::new(kind) };
        light(&session, "/l", shadowed_by(linked(ball, to), "none"));
        finish(&session);
        let pixels = inside(&session, 1);
        at_pixels(&session, &pixels).iter().map(|p| p[0]).fold(0.0, f32::max)
    };
    assert!(reflected("l") > 2.5 && reflected("r") == 0.0);
}
