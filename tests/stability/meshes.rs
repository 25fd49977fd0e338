//! Closed meshes, rays and random numbers for the tests.

use std::collections::HashMap;
use std::sync::Arc;

use umber_bvh::{Child, Instance, InstanceBvh, MeshBvh};
use umber_math::{DAffine3, Point3, Ray, Vec3, Vector3};

/// Points and triangles.
#[derive(Clone, Default)]
pub struct Mesh {
    pub points: Vec<Point3>,
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
    /// Its hierarchy, placed by the identity.
    pub fn scene(&self) -> InstanceBvh {
        self.placed(DAffine3::IDENTITY)
    }
    /// Its hierarchy, placed by a transform.
    pub fn placed(&self, parent_from_child: DAffine3) -> InstanceBvh {
        let bvh = Arc::new(MeshBvh::build(&self.points, &self.triangles));
        InstanceBvh::build(vec![Instance { child: Child::Mesh { bvh, mesh: 0 }, parent_from_child, tag: 0 }])
    }
}

/// A small generator (Marsaglia 2003, "Xorshift RNGs").
pub struct Random(pub u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }
    /// From 0 to 1, without 1.
    pub fn float(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1u64 << 24) as f32
    }
    /// From 0 to `n`, without `n`.
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() >> 16) as usize % n
    }
    /// From −1 to 1 in each axis.
    pub fn cube(&mut self) -> Vec3 {
        Vec3::new(self.float(), self.float(), self.float()) * 2.0 - 1.0
    }
    /// A unit vector, uniform over the sphere.
    pub fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.cube();
            if (1e-3..=1.0).contains(&v.length()) {
                return v.normalize();
            }
        }
    }
    /// A point of a triangle; on an edge or a corner where `at_edge`.
    pub fn point_of(&mut self, [a, b, c]: [Point3; 3], at_edge: bool) -> Vec3 {
        let (u, v) = (self.float(), if at_edge { 0.0 } else { self.float() });
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        a.0 + (b.0 - a.0) * u + (c.0 - a.0) * v
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
    Mesh { points: points.into_iter().map(Point3).collect(), triangles }
}

/// A closed box of half-width one, each side two triangles.
pub fn cube() -> Mesh {
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0;
    let mut mesh = Mesh { points: (0..8).map(|i| Point3(corner(i))).collect(), triangles: Vec::new() };
    for [a, b, c, d] in [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]] {
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
    mesh
}

/// A ray from a point towards another, which lies at `t` = 1.
pub fn ray_to(from: Vec3, to: Vec3) -> Ray {
    Ray::new(Point3(from), Vector3(to - from))
}
