//! What the tests share: meshes, rays, and the slow answer.
#![allow(dead_code)]

use std::sync::Arc;

use umber_bvh::{Child, Hit, Instance, InstanceBvh, MeshBvh};
use umber_geometry::watertight::ShearedRay;
use umber_math::{DAffine3, Point3, Ray, Vec3, Vector3};

/// Points and triangles.
#[derive(Clone, Default)]
pub struct Mesh {
    pub points: Vec<Point3>,
    pub triangles: Vec<[u32; 3]>,
}

/// A small generator (Marsaglia 2003, xorshift).
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }
    /// From 0 to 1.
    pub fn float(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1u64 << 24) as f32
    }
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() >> 16) as usize % n
    }
    /// From −1 to 1 in each axis.
    pub fn cube(&mut self) -> Vec3 {
        Vec3::new(self.float(), self.float(), self.float()) * 2.0 - 1.0
    }
    pub fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.cube();
            if (1e-3..=1.0).contains(&v.length()) {
                return v.normalize();
            }
        }
    }
}

/// Triangles anywhere in a cube of half-width one.
pub fn soup(count: u32, size: f32, random: &mut Random) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..count {
        let center = random.cube();
        mesh.points.extend([0; 3].map(|_| Point3(center + random.cube() * size)));
        mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    mesh
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
    let mut triangles = Vec::new();
    for (a, b, c) in (0..n).flat_map(|a| (a + 1..n).flat_map(move |b| (b + 1..n).map(move |c| (a, b, c)))) {
        if near(a, b) && near(b, c) && near(a, c) {
            triangles.push([a, b, c]);
        }
    }
    for _ in 0..levels {
        let mut middles = std::collections::HashMap::new();
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

impl Mesh {
    /// Each point moved by a function.
    pub fn map(mut self, f: impl Fn(Vec3) -> Vec3) -> Self {
        self.points.iter_mut().for_each(|p| p.0 = f(p.0));
        self
    }
    /// Both meshes as one.
    pub fn with(mut self, other: &Self) -> Self {
        let base = self.points.len() as u32;
        self.points.extend(&other.points);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|i| i + base)));
        self
    }
    pub fn vertices(&self, triangle: usize) -> [Point3; 3] {
        self.triangles[triangle].map(|i| self.points[i as usize])
    }
    /// The closest hit by the scalar test on every triangle: `t` and the smallest triangle index there.
    pub fn brute_force(&self, ray: &Ray) -> Option<(f32, u32)> {
        let sheared = ShearedRay::new(ray)?;
        let mut best: Option<(f32, u32)> = None;
        for i in 0..self.triangles.len() {
            let [a, b, c] = self.vertices(i);
            let end = best.map_or(ray.t_max, |b| b.0);
            if let Some(hit) = sheared.intersect(a, b, c, ray.t_min, end) {
                best = Some((hit.t, i as u32));
            }
        }
        best
    }
    /// One mesh, placed by the identity.
    pub fn scene(&self) -> InstanceBvh {
        InstanceBvh::build(vec![place(&Arc::new(MeshBvh::build(&self.points, &self.triangles)), 0, DAffine3::IDENTITY)])
    }
}

pub fn place(bvh: &Arc<MeshBvh>, mesh: u32, parent_from_child: DAffine3) -> Instance {
    Instance { child: Child::Mesh { bvh: bvh.clone(), mesh }, parent_from_child, tag: mesh }
}

pub fn answer(hit: Option<Hit>) -> Option<(f32, u32)> {
    hit.map(|h| (h.t, h.triangle))
}

pub fn ray_to(from: Vec3, to: Vec3) -> Ray {
    Ray::new(Point3(from), Vector3(to - from))
}
