//! Links, shadows and shaping of mesh lights.

use umber_scene::{Category, Shadow, Shaping};

use super::*;

/// A floor that a tetrahedron beside the picture lights, and the picture's mean. `wall`: one stands in between.
fn lit_floor(light: impl Fn(Light) -> Light, wall: bool) -> (RenderScene, [f64; 3]) {
    let mut stage = Stage::new();
    let category = |name: &str| Some(Arc::from([Category::new(name)]));
    stage.mesh("/floor", MeshPatch { categories: category("floor"), ..MeshPatch::default() });
    // beside the picture: all that is seen of it is what it lights
    let transform = Some(at(4.5, 0.0, 1.5));
    stage.mesh("/tetrahedron", MeshPatch { transform, categories: category("lamp"), ..tetrahedron() });
    if wall {
        let corners = [[3.2, -9.0, -1.0], [3.2, 9.0, -1.0], [3.2, 9.0, 9.0], [3.2, -9.0, 9.0]];
        stage.mesh("/wall", MeshPatch { material: bound("/black"), ..polygons(&corners, &[&[0, 1, 2, 3]]) });
        stage.material("/black", surface(0.0, [0.0; 3], 1.0));
    }
    let kind = LightKind::Mesh { mesh: MeshId::new("/tetrahedron"), material_sync: MaterialSync::NoResponse };
    let own = light(Light { intensity: 5.0, ..Light::new(kind) });
    stage.edit(SceneEdit::Light(LightId::new("/tetrahedron"), own));
    // Another light, which lights nothing: the mesh light's number is not the emitter's.
    let other = Light { light_link: Some(Category::new("nothing")), ..Light::new(LightKind::Disk { radius: 1.0 }) };
    stage.edit(SceneEdit::Light(LightId::new("/a"), Light { world_from_light: at(0.0, 0.0, 9.0), ..other }));
    let (mut scene, said) = stage.compile();
    assert_eq!(said, Vec::<String>::new());
    scene.settings.max_bounces = 1;
    let seen = picture(&scene, 64, 1).map(|(mean, _)| mean);
    (scene, seen)
}

/// A mesh light's links are its own: by light samples and by rays that meet the mesh alike.
#[test]
fn mesh_lights_are_linked() {
    let linked = |to: &'static str| move |light| Light { light_link: Some(Category::new(to)), ..light };
    let (scene, all) = lit_floor(|light| light, false);
    assert_eq!(scene.lights.lights().len(), 2);
    let (_, to_floor) = lit_floor(linked("floor"), false);
    assert!(all[0] > 1e-3 && all == to_floor, "{all:?}, linked {to_floor:?}");
    for others in ["lamp", "nothing"] {
        assert_eq!(lit_floor(linked(others), false).1, [0.0; 3], "linked to {others}");
    }
}

/// Where something is between, a mesh light's shadow has its colour; what is in no shadow collection casts none. The
/// mesh itself does not stand in its light's way.
#[test]
fn mesh_lights_have_shadows() {
    let colored = |light: Light| {
        let shadow = Shadow { color: Rgb::new(1.0, 0.5, 0.0), ..light.shadow };
        Light { shadow, ..light }
    };
    let (_, open) = lit_floor(|light| light, false);
    let close = |got: f64, want: f64| (got - want).abs() < 0.02 * open[0];
    let compare = |got: [f64; 3], want: [f64; 3]| {
        assert!((0..3).all(|c| close(got[c], want[c])), "{got:?}, not {want:?}; open {open:?}");
    };
    compare(lit_floor(|light| light, true).1, [0.0; 3]);
    compare(lit_floor(colored, true).1, [open[0], 0.5 * open[1], 0.0]);
    let by = |name: &'static str| move |light| Light { shadow_link: Some(Category::new(name)), ..light };
    compare(lit_floor(by("floor"), true).1, open);
    compare(lit_floor(by("nothing"), true).1, open);
}

#[test]
fn shaping_of_a_mesh_light_is_told() {
    let mut stage = Stage::new();
    stage.mesh("/tetrahedron", tetrahedron());
    let kind = LightKind::Mesh { mesh: MeshId::new("/tetrahedron"), material_sync: MaterialSync::NoResponse };
    let shaping = Shaping { cone_angle_deg: 30.0, ..Shaping::default() };
    stage.edit(SceneEdit::Light(LightId::new("/l"), Light { shaping, ..Light::new(kind) }));
    let (scene, said) = stage.compile();
    assert_eq!(scene.lights.lights().len(), 1);
    assert!(said.len() == 1 && said[0].contains("/l") && said[0].contains("shaping has no effect"), "{said:?}");
}
