//! Coverage on the grid, and what hides what; what pictures show is tested through sessions (`tests/integrators.rs`).

use std::sync::Arc;
use std::time::Duration;

use umber_math::{DAffine3, DVec2, DVec3, Point3, Vec3};
use umber_scene::{Camera, CameraId, MeshId, MeshPatch, Projection, SceneEdit, SubdivisionScheme, Topology};
use umber_settings::Value;

use super::boxing::{Around, Boxing};
use super::clip::clip;
use super::fill::{Rules, Triangle};
use super::project::{Grid, Homogeneous, Vertex, Vertices};
use super::short::{BATCH, Batch, Short};
use super::square::{NOTHING, Square};
use crate::camera::RenderCamera;
use crate::clusters::LANES;
use crate::{Aov, BufferFormat, FilmDesc, Session};

const SIZE: usize = 80;

fn grid(projection: Projection) -> Grid {
    grid_of(projection, SIZE)
}

/// Of a film of so many pixels across and down.
fn grid_of(projection: Projection, size: usize) -> Grid {
    let camera = Camera {
        projection,
        aperture: DVec2::ONE,
        focal_length: 1.0,
        clipping_range: [0.1, 100.0],
        ..Camera::default()
    };
    let film = FilmDesc::new(size, size, &[]);
    Grid::new(RenderCamera::new(&camera, &film, DAffine3::IDENTITY).unwrap().view(), size, size)
}

/// Of what is as near, the smaller number is seen.
struct ByNumber;

impl Rules for ByNumber {
    fn is_first(&self, number: u32, shown: u32) -> bool {
        number < shown
    }
}

/// A triangle with its number and what its box holds.
type Boxed = (u32, [Vertex; 3], [[i32; 2]; 2]);

/// Draws triangles as clusters' are drawn, several at a time; those whose edges are not short by themselves.
fn draw_batches(grid: &Grid, square: &mut Square, triangles: &[Boxed]) {
    let mut batch = Batch::default();
    for some in triangles.chunks(BATCH) {
        some.iter().enumerate().for_each(|(i, (_, corners, pixels))| batch.set(i, *corners, *pixels));
        let short = Short::new(grid, &batch);
        let (covering, count) = short.covering(grid, &batch, some.len());
        for &i in &covering[..count] {
            let (number, corners, pixels) = some[i];
            if !short.is_short(grid, i) {
                draw_alone(grid, square, &some[i]);
            } else if short.area(i) != 0.0 {
                short.fill(i, square, pixels, number, &ByNumber);
            }
            assert_eq!(batch.corners(i), corners);
        }
    }
}

fn draw_alone(grid: &Grid, square: &mut Square, (number, corners, pixels): &Boxed) {
    if let Some(triangle) = Triangle::new(*corners, *number) {
        triangle.fill(grid, square, *pixels, &ByNumber);
    }
}

/// The numbers that are seen at each pixel, of triangles that are drawn in some order.
fn seen<'a>(grid: &Grid, triangles: impl Iterator<Item = (u32, &'a [Vertex; 3])> + Clone) -> Vec<u32> {
    let size = [grid.width, grid.height].map(|v| v as usize);
    let (mut square, mut batched, mut numbers) = (Square::new(), Square::new(), vec![NOTHING; size[0] * size[1]]);
    for index in 0..Square::counts(grid).into_iter().product() {
        square.start(grid, index);
        batched.start(grid, index);
        let boxing = Boxing::new(grid, &square);
        let boxed = triangles.clone().filter_map(|(number, t)| Some((number, *t, boxing.range(t)?)));
        let boxed: Vec<_> = boxed.collect();
        boxed.iter().for_each(|triangle| draw_alone(grid, &mut square, triangle));
        draw_batches(grid, &mut batched, &boxed);
        assert_eq!(square.shown(), batched.shown());
        let ([x, y], [width, height]) = (square.first, square.size.map(|v| v as usize));
        for y in y..y + height as i32 {
            let at = y as usize * size[0] + x as usize;
            numbers[at..at + width].copy_from_slice(square.row([x, y], width));
        }
    }
    numbers
}

/// How many of the triangles cover each pixel, each drawn alone.
fn covered(grid: &Grid, triangles: &[[Vertex; 3]]) -> Vec<u32> {
    let mut counts = vec![0; SIZE * SIZE];
    for corners in triangles {
        let alone = seen(grid, std::iter::once((0, corners)));
        counts.iter_mut().zip(alone).for_each(|(count, number)| *count += u32::from(number != NOTHING));
    }
    counts
}

/// A vertex at a film position from the film's middle.
fn at(grid: &Grid, x: f64, y: f64) -> Vertex {
    grid.place(Homogeneous { x, y, distance: 1.0 })
}

/// Numbers that look random, from 0 to 1.
fn noise(seed: &mut u32) -> f64 {
    *seed = seed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((*seed >> ((*seed >> 28) + 4)) ^ *seed).wrapping_mul(277_803_737);
    f64::from(word >> 22 ^ word) / f64::from(u32::MAX)
}

/// What a square is said to hide changes nothing there: blocks of points before and behind what its left half shows.
#[test]
fn hidden_points_have_hidden_triangles() {
    let (mut seed, mut hidden, mut behind) = (5, [0; 2], 0);
    for projection in [Projection::Perspective, Projection::Orthographic] {
        let middle = if projection == Projection::Perspective { 0.5 } else { -20.0 };
        for size in [1, 31, 80] {
            let grid = grid_of(projection, size);
            let squares = Square::counts(&grid).into_iter().product::<usize>();
            for case in 0..400 {
                let mut random = |least: f64, most: f64| least + (most - least) * noise(&mut seed);
                let mut square = Square::new();
                square.start(&grid, case % squares);
                let half = 0.5 * size as f64;
                let screen = [[-half, -3.0 * half], [-half, 3.0 * half], [0.2 * half, 0.0]];
                let screen = screen.map(|[x, y]| Vertex { nearness: middle, ..at(&grid, x, y) });
                let boxed = |corners: [Vertex; 3], square: &Square| {
                    Some((corners, Boxing::new(&grid, square).range(&corners)?))
                };
                if let Some((corners, pixels)) = boxed(screen, &square) {
                    draw_alone(&grid, &mut square, &(1000, corners, pixels));
                }
                let (place, extent) = ([random(-half, half), random(-half, half)], random(0.1, 0.1 * half + 1.0));
                let off = (case % 10 == 9).then_some(case / 10 % LANES);
                let mut points = Vertices { x: [0; LANES], y: [0; LANES], nearness: [0.0; LANES] };
                for i in 0..LANES {
                    let [x, y] = place.map(|v| v + random(-extent, extent));
                    let vertex = if off == Some(i) { Vertex::OFF_GRID } else { at(&grid, x, y) };
                    let nearness = middle - middle.abs() * random(-0.02, 0.3) as f32;
                    (points.x[i], points.y[i], points.nearness[i]) = (vertex.x, vertex.y, nearness);
                }
                let mut around = Around::NOTHING;
                around.add(&points);
                if !around.is_hidden(&Boxing::new(&grid, &square), &square) {
                    continue;
                }
                assert_eq!(off, None);
                let shown = square.shown();
                let triples = (0..LANES).map(|i| [i, (i + 1) % LANES, (i + 3) % LANES].map(|i| points.get(i)));
                for (number, (corners, pixels)) in
                    (0..).zip(triples.filter_map(|t| boxed(t, &square)).collect::<Vec<_>>())
                {
                    draw_alone(&grid, &mut square, &(number, corners, pixels));
                    behind += 1;
                }
                assert_eq!(shown, square.shown());
                hidden[usize::from(projection == Projection::Perspective)] += 1;
            }
        }
    }
    assert!(hidden.iter().all(|count| *count > 100) && behind > 100, "{hidden:?} {behind}");
}

/// A fan around a point covers its polygon without a hole, wherever its edges go: also through pixels' middles, at
/// which the corners of every other fan are. What lies on an edge shows the first of the triangles that share it,
/// whoever is drawn first.
#[test]
fn triangles_that_share_edges_leave_no_hole() {
    let grid = grid(Projection::Orthographic);
    let mut seed = 1;
    let mut shared = 0;
    for fan in 0..60 {
        let snap = |v: f64| if fan % 2 == 0 { v } else { v.floor() + 0.5 };
        let middle = [snap(noise(&mut seed) * 10.0 - 5.0), snap(noise(&mut seed) * 10.0 - 5.0)];
        let count = 3 + fan % 9;
        let rim: Vec<[f64; 2]> = (0..count)
            .map(|i| {
                let angle = std::f64::consts::TAU * (i as f64 + 0.4 * noise(&mut seed)) / count as f64;
                let radius = 6.0 + 30.0 * noise(&mut seed);
                [snap(middle[0] + radius * angle.cos()), snap(middle[1] + radius * angle.sin())]
            })
            .collect();
        let corners = |i: usize| [middle, rim[i], rim[(i + 1) % count]];
        let triangles: Vec<[Vertex; 3]> = (0..count)
            .map(|i| {
                let [a, b, c] = corners(i).map(|p| at(&grid, p[0], p[1]));
                // either winding covers the same
                if i % 2 == 0 { [a, b, c] } else { [a, c, b] }
            })
            .collect();
        let alone: Vec<Vec<u32>> = triangles.iter().map(|t| covered(&grid, std::slice::from_ref(t))).collect();
        let numbered = (0..).zip(&triangles);
        let together = [seen(&grid, numbered.clone()), seen(&grid, numbered.collect::<Vec<_>>().into_iter().rev())];
        assert_eq!(together[0], together[1], "fan {fan}: the order matters");
        for i in 0..SIZE * SIZE {
            let by: Vec<usize> = (0..count).filter(|t| alone[*t][i] > 0).collect();
            shared += u32::from(by.len() > 1);
            assert_eq!(together[0][i], by.first().map_or(NOTHING, |t| *t as u32), "fan {fan}");
            // what is inside one of them, reckoned apart, is covered
            let half = SIZE as f64 / 2.0;
            let (x, y) = ((i % SIZE) as f64 + 0.5 - half, (i / SIZE) as f64 + 0.5 - half);
            let inside = (0..count).any(|t| {
                let side = |k: usize| {
                    let (a, b) = (corners(t)[k], corners(t)[(k + 1) % 3]);
                    (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])
                };
                let sides = [side(0), side(1), side(2)];
                // on the fan's inner edges, too: they are shared
                let least = if fan % 2 == 0 { 1e-3 } else { 0.0 };
                sides.iter().all(|s| *s >= least) || sides.iter().all(|s| *s <= -least)
            });
            assert!(!by.is_empty() || !inside, "fan {fan}: a hole at {x} {y}");
        }
    }
    assert!(shared > 100, "edges went through few middles: {shared}");
}

/// Triangles from less than a pixel to some ten pixels, many of them flat or of no area, near one another and as near
/// as one another: drawn several at a time as each by itself, on films of any size.
#[test]
fn triangles_with_short_edges_are_drawn_as_others() {
    let mut seed = 11;
    for film in [2, 31, SIZE, 1000] {
        let grid = grid_of(Projection::Perspective, film);
        let reach = 0.75 * film.min(SIZE) as f64;
        let mut short = [0; 2];
        for round in 0..40 {
            let size = 0.3 * 1.12f64.powi(round);
            let triangles: Vec<[Vertex; 3]> = (0..300)
                .map(|i| {
                    let middle = [0.0; 2].map(|_: f64| reach * (noise(&mut seed) - 0.5));
                    let mut corner = || {
                        let at = middle.map(|v| v + size * (noise(&mut seed) - 0.5));
                        let [x, y] = if i % 3 == 0 { at.map(|v| (2.0 * v).round() / 2.0) } else { at };
                        let distance = if i % 2 == 0 { 1.0 } else { 1.0 + noise(&mut seed) };
                        grid.place(Homogeneous { x: x * distance, y: y * distance, distance })
                    };
                    [corner(), corner(), corner()]
                })
                .collect();
            for t in &triangles {
                let longest = t.iter().flat_map(|a| t.map(|b| (a.x - b.x).abs().max((a.y - b.y).abs()))).max();
                short[usize::from(longest <= Some(grid.short))] += 1;
            }
            let numbers = seen(&grid, (0..).zip(&triangles));
            assert!(film < SIZE || round < 20 || numbers.iter().filter(|n| **n != NOTHING).count() > 50);
        }
        assert!(short[1] > 200 && (film > SIZE || short[0] > 1000), "{short:?} of {film} pixels");
    }
}

/// What is cut off at the near plane and around the film covers what rays meet.
#[test]
fn clipped_triangles_cover_what_lies_between_near_and_far() {
    let grid = grid(Projection::Perspective);
    let film_from_camera = grid.film_from_object(&DAffine3::IDENTITY);
    let mut seed = 7;
    let mut cut = 0;
    for _ in 0..200 {
        let mut point = |reach: f32| {
            Vec3::new(noise(&mut seed) as f32 - 0.5, noise(&mut seed) as f32 - 0.5, noise(&mut seed) as f32 - 0.7)
                * reach
        };
        let corners = [point(4.0), point(4.0), point(900.0)];
        let positions = corners.map(|p| film_from_camera.apply(Point3(p)));
        cut += u32::from(positions.map(|p| grid.place(p)).iter().any(Vertex::is_off_grid));
        let mut parts = Vec::new();
        clip(&grid, positions, |part| parts.push(part));
        let counts = covered(&grid, &parts);
        let normal = (corners[1] - corners[0]).as_dvec3().cross((corners[2] - corners[0]).as_dvec3());
        for (i, n) in counts.iter().enumerate() {
            let half = SIZE as f64 / 2.0;
            let pixel = [(i % SIZE) as f64 + 0.5 - half, (i / SIZE) as f64 + 0.5 - half];
            let ray = DVec3::new(pixel[0] / SIZE as f64, pixel[1] / SIZE as f64, -1.0);
            let t = corners[0].as_dvec3().dot(normal) / ray.dot(normal);
            let side = |k: usize| {
                let (a, b) = (corners[k].as_dvec3(), corners[(k + 1) % 3].as_dvec3());
                let toward = (b - a).cross(ray * t - a).dot(normal) / normal.length();
                // distance from the edge
                toward / (b - a).length()
            };
            let least = side(0).min(side(1)).min(side(2)).min(t - 0.1).min(100.0 - t);
            let margin = 1e-4 * t.abs().max(1.0);
            if least.abs() > margin {
                assert_eq!(*n > 0, least > 0.0, "{corners:?} at {pixel:?}: {least}");
            }
        }
    }
    assert!(cut > 100, "few were cut: {cut}");
}

#[test]
fn points_that_are_no_numbers_cover_nothing() {
    let grid = grid(Projection::Perspective);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let good = Homogeneous { x: 0.0, y: 0.0, distance: 1.0 };
        let triangle = [good, Homogeneous { x: 9.0, ..good }, Homogeneous { y: bad, ..good }];
        assert!(grid.place(triangle[2]).is_off_grid());
        clip(&grid, triangle, |_| panic!("{bad} covers something"));
    }
}

/// Triangles that pierce one another, of many meshes: the same as the path integrator sees.
#[test]
fn meshes_hide_one_another() {
    let ids = |integrator: &str| {
        let session = Session::new();
        session.set_film(FilmDesc::new(SIZE, SIZE, &[Aov::PrimId, Aov::ElementId]));
        let camera = Camera {
            world_from_camera: DAffine3::from_translation(DVec3::new(0.0, 0.0, 30.0)),
            aperture: DVec2::ONE,
            focal_length: 1.0,
            clipping_range: [0.1, 1e4],
            ..Camera::default()
        };
        let (id, word) = (CameraId::new("/camera"), Value::Text(integrator.into()));
        session.edit(SceneEdit::Camera(id.clone(), camera)).unwrap();
        session.edit(SceneEdit::RenderCamera(id)).unwrap();
        session.edit(SceneEdit::Setting("umber:integrator".into(), word)).unwrap();
        session.edit(SceneEdit::Setting("convergedSamplesPerPixel".into(), Value::Int(1))).unwrap();
        let mut seed = 3;
        for i in 0..120 {
            let points: Vec<Vec3> = (0..12)
                .map(|k| {
                    let place = Vec3::new(noise(&mut seed) as f32, noise(&mut seed) as f32, noise(&mut seed) as f32)
                        * 9.0
                        - 4.5;
                    // one, behind the others, has its corners far beside the film, all of them
                    let far = [[-1e5, -1e5], [1e5, -1e5], [0.0, 1e5]][k % 3];
                    if i == 60 && k < 3 { Vec3::new(far[0], far[1], place.x - 15.0) } else { place }
                })
                .collect();
            let place = DVec3::new(noise(&mut seed) - 0.5, noise(&mut seed) - 0.5, noise(&mut seed) - 0.5) * 16.0;
            let topology = Topology {
                scheme: SubdivisionScheme::None,
                face_vertex_counts: [3; 4].into(),
                face_vertex_indices: (0..12).collect(),
                ..Topology::default()
            };
            let patch = MeshPatch {
                topology: Some(Arc::new(topology)),
                points: Some(points.into()),
                transform: Some(DAffine3::from_translation(place)),
                visible: Some(true),
                prim_id: Some(i),
                ..MeshPatch::default()
            };
            session.edit(SceneEdit::Mesh(MeshId::new(&format!("/m{i}")), Box::new(patch))).unwrap();
        }
        session.start();
        assert!(session.wait(Duration::from_secs(60)));
        [Aov::PrimId, Aov::ElementId].map(|aov| {
            let mut out = vec![0u8; SIZE * SIZE * 4];
            assert!(session.resolve(aov, BufferFormat::Int32, &mut out));
            bytemuck::cast_slice::<u8, i32>(&out).to_vec()
        })
    };
    let (path, raster) = (ids("path"), ids("raster"));
    let differing = (0..SIZE * SIZE).filter(|i| path[0][*i] != raster[0][*i] || path[1][*i] != raster[1][*i]).count();
    assert!(path[0].iter().filter(|id| **id >= 0).count() > SIZE * SIZE / 2);
    assert!(differing <= 2, "{differing} pixels differ");
}
