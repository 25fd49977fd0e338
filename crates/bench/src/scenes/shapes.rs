//! Meshes made by formula.

use std::f32::consts::{PI, TAU};

use umber_math::{Point3, Vec3};

use super::Mesh;
use crate::random::Random;

impl Mesh {
    /// Both meshes as one.
    pub fn with(mut self, other: &Self) -> Self {
        let base = self.points.len() as u32;
        self.points.extend(&other.points);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|i| i + base)));
        self
    }

    /// Each point moved by a function.
    pub fn moved(mut self, f: impl Fn(Vec3) -> Vec3) -> Self {
        self.points.iter_mut().for_each(|p| p.0 = f(p.0));
        self
    }
}

/// A grid of quads, two triangles each, over parameters from 0 to 1.
fn grid(rows: u32, columns: u32, at: impl Fn(f32, f32) -> Vec3) -> Mesh {
    let mut mesh = Mesh::default();
    let row = columns + 1;
    for i in 0..=rows {
        for j in 0..=columns {
            mesh.points.push(Point3(at(i as f32 / rows as f32, j as f32 / columns as f32)));
            if i < rows && j < columns {
                let k = i * row + j;
                mesh.triangles.extend([[k, k + 1, k + row], [k + 1, k + row + 1, k + row]]);
            }
        }
    }
    mesh
}

/// A sphere of radius about one, displaced by waves: `4 n²` triangles.
pub fn bumpy_sphere(n: u32) -> Mesh {
    grid(n, 2 * n, |i, j| {
        let (a, b) = (i * PI, j * TAU);
        let bump = (a * 13.0).sin() * (b * 11.0).cos() * 0.1 + (a * 71.0).sin() * (b * 67.0).sin() * 0.03;
        Vec3::new(a.sin() * b.cos(), a.cos(), a.sin() * b.sin()) * (1.0 + bump)
    })
}

/// A pot's outline turned about the y axis, of height and radius about one, standing on zero.
pub fn lathe(rows: u32, columns: u32) -> Mesh {
    grid(rows, columns, |i, j| {
        let radius = (i * PI).sin().sqrt() * (0.7 + 0.2 * (i * 5.0).cos());
        let a = j * TAU;
        Vec3::new(radius * a.cos(), i, radius * a.sin())
    })
}

/// A bowl with a flat floor through the origin, of the given radius.
pub fn bowl(rows: u32, columns: u32, radius: f32) -> Mesh {
    grid(rows, columns, |i, j| {
        let a = j * TAU;
        Vec3::new(i * radius * a.cos(), (i - 0.6).max(0.0) * radius, i * radius * a.sin())
    })
}

/// A box around the origin.
pub fn cuboid(half: Vec3) -> Mesh {
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0;
    let mut mesh = Mesh { points: (0..8).map(|i| Point3(corner(i) * half)).collect(), triangles: Vec::new() };
    for [a, b, c, d] in [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]] {
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
    mesh
}

/// Long thin triangles anywhere in a cube of half-width 2, turned any way.
pub fn needles(count: u32, length: f32, width: f32) -> Mesh {
    let mut random = Random(0x1234_5678_9abc_def1);
    let mut mesh = Mesh::default();
    for i in 0..count {
        let center = random.cube() * 2.0;
        let along = random.direction();
        let across = along.cross(random.direction()).normalize_or(Vec3::X);
        let ends =
            [-along * length * 0.5, along * length * 0.5 + across * width, along * length * 0.5 - across * width];
        mesh.points.extend(ends.map(|e| Point3(center + e)));
        mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    mesh
}
