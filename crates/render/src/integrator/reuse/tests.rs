//! Pictures with shared paths have the same mean as those without.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use umber_math::{DAffine3, DVec3, Rgb, Vec3};
use umber_scene::{
    Camera, CameraId, Light, LightId, LightKind, Material, MaterialId, MeshId, MeshPatch, PreviewSurface, SceneEdit,
    SceneStore, SubdivisionScheme, Topology,
};

use super::LARGEST_GROUP;
use crate::adaptive::{self, Plan};
use crate::compile::Compiler;
use crate::film::{self, Film};
use crate::integrator::{Goal, Stop, Target, render_tile};
use crate::scene::RenderScene;
use crate::{Aov, FilmDesc};

/// Pixels across, more than one tile.
const SIZE: usize = 24;
const SAMPLES: u32 = 8;
const SEEDS: u32 = 32;

fn cube(half: f64, middle: DVec3, material: &str) -> MeshPatch {
    let corner = |i: i32| Vec3::new((i >> 2 & 1) as f32, (i >> 1 & 1) as f32, (i & 1) as f32) * 2.0 - Vec3::ONE;
    let topology = Topology {
        scheme: SubdivisionScheme::None,
        face_vertex_counts: [4; 6].into(),
        face_vertex_indices: [0, 1, 3, 2, 4, 6, 7, 5, 0, 4, 5, 1, 2, 3, 7, 6, 0, 2, 6, 4, 1, 5, 7, 3].into(),
        ..Topology::default()
    };
    MeshPatch {
        topology: Some(Arc::new(topology)),
        points: Some((0..8).map(corner).collect()),
        transform: Some(DAffine3::from_scale_rotation_translation(
            DVec3::splat(half),
            glam::DQuat::from_rotation_y(half),
            middle,
        )),
        visible: Some(true),
        material: Some(Some(MaterialId::new(material))),
        ..MeshPatch::default()
    }
}

/// A box of one material in a room of another, with a lamp in it and a glowing thing; the camera is in there, too.
fn room(walls: PreviewSurface, thing: PreviewSurface) -> RenderScene {
    room_with(walls, thing, None)
}

/// The same with one thing more.
fn room_with(walls: PreviewSurface, thing: PreviewSurface, more: Option<MeshPatch>) -> RenderScene {
    let mut store = SceneStore::default();
    let camera = Camera {
        world_from_camera: DAffine3::from_translation(DVec3::new(0.0, 0.0, 1.2)),
        aperture: umber_math::DVec2::ONE,
        focal_length: 1.0,
        clipping_range: [0.01, 1e6],
        ..Camera::default()
    };
    let lamp = Light { intensity: 20.0, ..Light::new(LightKind::Sphere { radius: 0.2, treat_as_point: false }) };
    let lamp = Light { world_from_light: DAffine3::from_translation(DVec3::new(0.6, 0.7, -0.2)), ..lamp };
    let glow = PreviewSurface { emissive_color: Rgb::splat(2.0), ..walls.clone() };
    for edit in [
        SceneEdit::Camera(CameraId::new("/camera"), camera),
        SceneEdit::RenderCamera(CameraId::new("/camera")),
        SceneEdit::Material(MaterialId::new("/walls"), Material::Preview(walls)),
        SceneEdit::Material(MaterialId::new("/thing"), Material::Preview(thing)),
        SceneEdit::Material(MaterialId::new("/glow"), Material::Preview(glow)),
        SceneEdit::Mesh(MeshId::new("/room"), Box::new(cube(1.5, DVec3::ZERO, "/walls"))),
        SceneEdit::Mesh(MeshId::new("/box"), Box::new(cube(0.45, DVec3::new(-0.3, -0.5, -0.4), "/thing"))),
        SceneEdit::Mesh(MeshId::new("/ember"), Box::new(cube(0.1, DVec3::new(0.5, -0.8, -0.3), "/glow"))),
        SceneEdit::Light(LightId::new("/lamp"), lamp),
    ] {
        store.apply(edit).unwrap();
    }
    if let Some(patch) = more {
        store.apply(SceneEdit::Mesh(MeshId::new("/more"), Box::new(patch))).unwrap();
    }
    let (dirty, film) = (store.take_dirty(), FilmDesc::new(SIZE, SIZE, &[Aov::Color]));
    let scene = Compiler::default().compile(&store, dirty, &film, &AtomicBool::new(false), &mut |_| ());
    scene.unwrap_or_else(|_| panic!("no scene"))
}

fn matt(albedo: f32) -> PreviewSurface {
    PreviewSurface {
        diffuse_color: Rgb::splat(albedo),
        use_specular_workflow: true,
        specular_color: Rgb::BLACK,
        ..PreviewSurface::default()
    }
}

/// Luminance of each pixel, for one seed.
fn picture(scene: &mut RenderScene, group: usize, seed: u32, target: Target<'_>) -> Vec<f64> {
    (scene.path_group, scene.settings.seed) = (group, seed);
    scene.settings.enable_interactive = false;
    let film = Film::new(FilmDesc::new(SIZE, SIZE, &[Aov::Color]));
    let (goal, cancel) = (Goal { samples: SAMPLES, stride: 1, target }, AtomicBool::new(false));
    let stop = Stop { cancel: &cancel, deadline: None };
    let mut pixels = vec![0.0; SIZE * SIZE];
    for index in 0..film.tile_count() {
        render_tile(scene, &film, index, &goal, &stop);
        let tile = film.tile(index);
        for i in 0..tile.rect.width * tile.rect.height {
            let [x, y] = tile.rect.place(i);
            pixels[y * SIZE + x] = film::radiance(tile.samples.sums(i)).dot(umber_math::DVec3::ONE);
        }
    }
    pixels
}

/// Mean and variance of values.
fn moments(values: impl Iterator<Item = f64> + Clone) -> [f64; 2] {
    let n = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / n;
    [mean, values.map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)]
}

/// The difference of two means over its standard error, where a sum of some pixels is known for each seed.
fn z(alone: &[Vec<f64>], shared: &[Vec<f64>], pixels: &[usize]) -> f64 {
    let of = |pictures: &[Vec<f64>]| moments(pictures.iter().map(|p| pixels.iter().map(|i| p[*i]).sum::<f64>()));
    let ([a, va], [b, vb]) = (of(alone), of(shared));
    // where the lamp is seen nothing varies
    if va + vb > 0.0 { (a - b) / ((va + vb) / f64::from(SEEDS)).sqrt() } else { 0.0 }
}

/// The variance of shared paths over that of paths alone, the mean over pixels; the means agree.
fn ratio_of_variances(mut scene: RenderScene, target: Target<'_>) -> f64 {
    let mut pictures =
        |group, first| (first..first + SEEDS).map(|seed| picture(&mut scene, group, seed, target)).collect::<Vec<_>>();
    let (alone, shared) = (pictures(1, 5001), pictures(LARGEST_GROUP, 9001));
    let whole = z(&alone, &shared, &(0..SIZE * SIZE).collect::<Vec<_>>());
    assert!(whole.abs() < 4.0, "the whole: z = {whole}");
    // what one place loses another must not gain
    let squares: f64 = (0..SIZE * SIZE).map(|i| z(&alone, &shared, &[i]).powi(2)).sum();
    let mean_square = squares / (SIZE * SIZE) as f64;
    assert!(mean_square < 1.3, "z² of pixels: {mean_square}");
    for line in 0..SIZE {
        let column = z(&alone, &shared, &(0..SIZE).map(|y| y * SIZE + line).collect::<Vec<_>>());
        let row = z(&alone, &shared, &(0..SIZE).map(|x| line * SIZE + x).collect::<Vec<_>>());
        assert!(column.abs() < 4.5 && row.abs() < 4.5, "column and row {line}: {column} and {row}");
    }
    // relative to brightness, as the edges of the lamp would drown all else
    let variance = |pictures: &[Vec<f64>]| {
        let relative = |i: usize| {
            let [mean, variance] = moments(pictures.iter().map(|p| p[i]));
            variance / (mean * mean)
        };
        (0..SIZE * SIZE).map(relative).sum::<f64>()
    };
    let ratio = variance(&shared) / variance(&alone);
    println!("z {whole}, z² of pixels {mean_square}, ratio of variances {ratio}");
    ratio
}

#[test]
fn a_matt_room_has_the_same_mean_and_much_less_variance() {
    assert!(ratio_of_variances(room(matt(0.7), matt(0.4)), Target::Even) < 0.35);
}

#[test]
fn pixels_of_each_color_of_an_adaptive_picture_share_as_well() {
    assert!(ratio_of_variances(room(matt(0.7), matt(0.4)), Target::Pilot(SAMPLES)) < 0.45);
}

/// By paths that are shared or not, with blue noise or without, wherever the film lies in the view.
#[test]
fn the_samples_of_a_color_do_not_depend_on_the_counts_of_the_other() {
    let mut scene = room(matt(0.7), matt(0.4));
    for (group, watched, corner) in
        [(1, false, [0, 0]), (LARGEST_GROUP, false, [-3, 0]), (LARGEST_GROUP, true, [2, -5])]
    {
        (scene.path_group, scene.settings.enable_interactive) = (group, watched);
        let picture = |others: u32| {
            let plan = Plan::of([SIZE; 2], |place| if adaptive::color(place) == 0 { 24 } else { others });
            let film = Film::new(FilmDesc { data_window_min: corner, ..FilmDesc::new(SIZE, SIZE, &[Aov::Color]) });
            let (goal, cancel) =
                (Goal { samples: 64, stride: 1, target: Target::Planned(&plan) }, AtomicBool::new(false));
            let mut pixels = vec![DVec3::ZERO; SIZE * SIZE];
            for index in 0..film.tile_count() {
                render_tile(&scene, &film, index, &goal, &Stop { cancel: &cancel, deadline: None });
                let tile = film.tile(index);
                for i in 0..tile.rect.width * tile.rect.height {
                    let [x, y] = tile.rect.place(i);
                    pixels[y * SIZE + x] = film::radiance(tile.samples.sums(i));
                }
            }
            [0, 1].map(|of| {
                let places = (0..SIZE * SIZE).filter(|i| adaptive::color([i % SIZE, i / SIZE]) == of);
                places.map(|i| pixels[i]).collect::<Vec<_>>()
            })
        };
        let [few, many] = [picture(16), picture(48)];
        assert!(few[0] == many[0], "groups of {group}, watched {watched}");
        assert!(few[1] != many[1]);
    }
}

#[test]
fn shiny_things_have_the_same_mean() {
    let shiny = |roughness| PreviewSurface { roughness, ..matt(0.5) };
    let coated =
        PreviewSurface { clearcoat: 1.0, clearcoat_roughness: 0.0, use_specular_workflow: false, ..shiny(0.6) };
    let metal = PreviewSurface { metallic: 1.0, use_specular_workflow: false, ..shiny(0.35) };
    assert!(ratio_of_variances(room(coated, metal), Target::Even) < 1.0);
}

/// Groups that straddle the screen have floor on both sides of it, of which only one is lit.
#[test]
fn the_sides_of_a_thin_screen_are_told_apart() {
    let screen = |corners: [[f32; 3]; 4]| {
        let topology = Topology {
            scheme: SubdivisionScheme::None,
            face_vertex_counts: [4].into(),
            face_vertex_indices: [0, 1, 2, 3].into(),
            ..Topology::default()
        };
        MeshPatch {
            topology: Some(Arc::new(topology)),
            points: Some(corners.map(Vec3::from).into_iter().collect()),
            ..cube(1.0, DVec3::ZERO, "/walls")
        }
    };
    // towards the camera, from the floor up, seen edge on
    let upright = screen([[0.0, -1.5, -1.5], [0.0, -1.5, 1.0], [0.0, 0.9, 1.0], [0.0, 0.9, -1.5]]);
    let upright = MeshPatch { transform: Some(DAffine3::IDENTITY), ..upright };
    assert!(ratio_of_variances(room_with(matt(0.7), matt(0.7), Some(upright)), Target::Even) < 0.6);
}

#[test]
fn things_that_are_partly_there_have_the_same_mean() {
    let gauze = PreviewSurface { opacity: 0.5, ..matt(0.6) };
    assert!(ratio_of_variances(room(matt(0.7), gauze), Target::Even) < 0.5);
}
