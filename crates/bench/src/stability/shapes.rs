//! Meshes and rays.

use std::{collections::HashMap, sync::Arc};

use umber_bvh::{Child, Instance, InstanceBvh, MeshBvh};
use umber_math::{Bounds3, DAffine3, Point3, Ray, Vec3, Vector3};

/// Points and triangles.
#[derive(Clone, Default)]
pub struct Mesh {
    /// Points.
    pub points: Vec<Point3>,
    /// Points of each triangle, counter-clockwise from outside where it is closed.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Each point moved by a function.
    pub fn map(mut self, f: impl Fn(Vec3) -> Vec3) -> Self {
        self.points.iter_mut().for_each(|p| p.0 = f(p.0));
        self
    }
    /// The corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [Point3; 3] {
        self.triangles[triangle].map(|i| self.points[i as usize])
    }
    /// The box around its points.
    pub fn bounds(&self) -> Bounds3 {
        Bounds3::of_points(self.points.iter().copied())
    }
    /// Its hierarchy, placed by the identity.
    pub fn scene(&self) -> InstanceBvh {
        let bvh = Arc::new(MeshBvh::build(&self.points, &self.triangles));
        let child = Child::Mesh { bvh, mesh: 0 };
        InstanceBvh::build(vec![Instance { child, parent_from_child: DAffine3::IDENTITY, tag: 0 }])
    }
    /// Each triangle's vertices in the order that faces away from a point inside.
    fn outwards(mut self) -> Self {
        for triangle in &mut self.triangles {
            let [a, b, c] = triangle.map(|i| self.points[i as usize].0);
            if (b - a).cross(c - a).dot(a) < 0.0 {
                triangle.swap(1, 2);
            }
        }
        self
    }
}

/// A unit sphere of `20 · 4^levels` triangles, closed, every vertex shared.
pub fn icosphere(levels: u32) -> Mesh {
    let g = (1.0 + 5f32.sqrt()) / 2.0;
    let mut points: Vec<Vec3> = Vec::new();
    for s in [1.0, -1.0] {
        for t in [g, -g] {
            points.extend([Vec3::new(s, t, 0.0), Vec3::new(0.0, s, t), Vec3::new(t, 0.0, s)].map(Vec3::normalize));
        }
    }
    let n = points.len() as u32;
    let edge = points.iter().skip(1).map(|p| p.distance(points[0])).fold(f32::MAX, f32::min) * 1.01;
    let near = |a: u32, b: u32| points[a as usize].distance(points[b as usize]) < edge;
    let triples = (0..n).flat_map(|a| (a + 1..n).flat_map(move |b| (b + 1..n).map(move |c| [a, b, c])));
    let mut triangles: Vec<[u32; 3]> = triples.filter(|&[a, b, c]| near(a, b) && near(b, c) && near(a, c)).collect();
    for _ in 0..levels {
        let mut middles = HashMap::new();
        let mut split = Vec::new();
        for [a, b, c] in triangles {
            let mut middle = |a: u32, b: u32| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    points.push((points[a as usize] + points[b as usize]).normalize());
                    points.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            split.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        triangles = split;
    }
    Mesh { points: points.into_iter().map(Point3).collect(), triangles }.outwards()
}

/// A closed box of half-width one, each side two triangles.
pub fn cube() -> Mesh {
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0;
    let mut mesh = Mesh { points: (0..8).map(|i| Point3(corner(i))).collect(), triangles: Vec::new() };
    for [a, b, c, d] in [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]] {
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
    mesh.outwards()
}

/// A ray from a point towards another, which lies at `t` = 1.
pub fn ray_to(from: Vec3, to: Vec3) -> Ray {
    Ray::new(Point3(from), Vector3(to - from))
}
