//! Rays a second on about a million triangles, one thread, beside obvhs' own compressed wide BVH.
//!
//! `cargo run --release -p umber-bvh --example rays [-- ROUNDS]`: a displaced sphere in a box seen
//! from inside, as primary rays, diffuse bounces from what these hit, and shadow rays to a light.
//! Prints the median of the rounds, both libraries taking turns.

use std::{sync::Arc, time::Instant};

use obvhs::{BvhBuildParams, cwbvh::builder::build_cwbvh_from_tris, ray::RayHit, triangle::Triangle};
use umber_bvh::{Child, Instance, InstanceBvh, MeshBvh, SimdLevel};
use umber_geometry::geometric_normal;
use umber_math::{DAffine3, Frame, Point3, Ray, Vec3, Vector3};

/// Rays of each kind.
const RAYS: usize = 1 << 20;

/// A small generator (Marsaglia 2003, xorshift), enough to scatter rays.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }
    fn direction(&mut self) -> Vec3 {
        let z = 1.0 - 2.0 * self.next();
        let (r, a) = ((1.0 - z * z).max(0.0).sqrt(), std::f32::consts::TAU * self.next());
        Vec3::new(r * a.cos(), r * a.sin(), z)
    }
}

type Mesh = (Vec<Point3>, Vec<[u32; 3]>);

/// A bumpy sphere of `2 · 2n · n` triangles in a box of twelve.
fn scene(n: u32) -> Mesh {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..=n {
        for j in 0..=2 * n {
            let (a, b) = (i as f32 / n as f32 * std::f32::consts::PI, j as f32 / n as f32 * std::f32::consts::PI);
            let bump = (a * 13.0).sin() * (b * 11.0).cos() * 0.1 + (a * 71.0).sin() * (b * 67.0).sin() * 0.03;
            let p = Vec3::new(a.sin() * b.cos(), a.cos(), a.sin() * b.sin()) * (1.0 + bump);
            points.push(Point3(p));
            if i < n && j < 2 * n {
                let (k, row) = (i * (2 * n + 1) + j, 2 * n + 1);
                triangles.extend([[k, k + 1, k + row], [k + 1, k + row + 1, k + row]]);
            }
        }
    }
    let base = points.len() as u32;
    points.extend((0..8).map(|i| Point3(Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 6.0 - 3.0)));
    for [a, b, c, d] in [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]] {
        triangles.extend([[base + a, base + b, base + c], [base + a, base + c, base + d]]);
    }
    (points, triangles)
}

/// Primary, diffuse and shadow rays.
fn rays(bvh: &InstanceBvh, (points, triangles): &Mesh) -> [Vec<Ray>; 3] {
    let mut random = Random(0x9e3779b97f4a7c15);
    let side = (RAYS as f32).sqrt() as usize;
    let eye = Point3::new(0.3, 0.8, 2.8);
    let pixel = |i: usize| {
        let (x, y) = ((i % side) as f32 / side as f32 - 0.5, (i / side) as f32 / side as f32 - 0.5);
        Ray::new(eye, Vector3(Vec3::new(x * 1.2, -y * 1.2 - 0.25, -1.0).normalize()))
    };
    let primary: Vec<Ray> = (0..RAYS).map(pixel).collect();
    let light = Point3::new(2.0, 2.7, 1.5);
    let (mut diffuse, mut shadow) = (Vec::new(), Vec::new());
    for ray in &primary {
        let Some(hit) = bvh.closest_hit(ray) else { continue };
        let [a, b, c] = triangles[hit.triangle as usize].map(|i| points[i as usize]);
        let n = geometric_normal(a, b, c).facing(-ray.direction);
        let from = ray.at(hit.t) + n.as_vector() * 1e-4;
        let local = (random.direction() + Vec3::Z).normalize_or(Vec3::Z);
        diffuse.push(Ray::new(from, Frame::from_normal(n).from_local(Vector3(local))));
        let jitter = Vector3(random.direction() * 0.3);
        shadow.push(Ray { t_max: 1.0, ..Ray::new(from, light + jitter - from) });
    }
    [primary, diffuse, shadow]
}

fn rate(rays: &[Ray], mut trace: impl FnMut(&Ray) -> bool) -> (f64, usize) {
    let start = Instant::now();
    let hits = rays.iter().filter(|r| trace(r)).count();
    (rays.len() as f64 / start.elapsed().as_secs_f64() / 1e6, hits)
}

fn median(mut v: Vec<f64>) -> f64 {
    v.sort_by(f64::total_cmp);
    v[v.len() / 2]
}

fn main() {
    let rounds: usize = std::env::args().nth(1).and_then(|a| a.parse().ok()).unwrap_or(5);
    let mesh = scene(500);
    let start = Instant::now();
    let built = Arc::new(MeshBvh::build(&mesh.0, &mesh.1));
    let seconds = start.elapsed().as_secs_f64();
    let bytes = built.memory_bytes() + mesh.0.len() * 12 + mesh.1.len() * 12;
    println!(
        "{} triangles, built in {seconds:.2} s, {:.1} bytes a triangle with the mesh",
        mesh.1.len(),
        bytes as f64 / mesh.1.len() as f64
    );
    let child = Child::Mesh { bvh: built, mesh: 0 };
    let bvh = InstanceBvh::build(vec![Instance { child, parent_from_child: DAffine3::IDENTITY, tag: 0 }]);
    let sets = rays(&bvh, &mesh);

    let tris: Vec<Triangle> = mesh
        .1
        .iter()
        .map(|t| t.map(|i| mesh.0[i as usize].0.into()))
        .map(|[v0, v1, v2]| Triangle { v0, v1, v2 })
        .collect();
    let peer = build_cwbvh_from_tris(&tris, BvhBuildParams::medium_build(), &mut Default::default());
    let ordered: Vec<Triangle> = peer.primitive_indices.iter().map(|&i| tris[i as usize]).collect();
    let peer_ray = |r: &Ray| obvhs::ray::Ray::new(r.origin.0.into(), r.direction.0.into(), r.t_min, r.t_max);

    for (name, set, any) in [("primary", &sets[0], false), ("diffuse", &sets[1], false), ("any hit", &sets[2], true)] {
        let levels = SimdLevel::available();
        let mut figures = vec![Vec::new(); levels.len() + 1];
        let mut hits = vec![0; levels.len() + 1];
        for _ in 0..rounds {
            for (i, &level) in levels.iter().enumerate() {
                let (speed, n) = if any {
                    rate(set, |r| bvh.any_hit_on(level, r))
                } else {
                    rate(set, |r| bvh.closest_hit_on(level, r).is_some())
                };
                figures[i].push(speed);
                hits[i] = n;
            }
            let (speed, n) = rate(set, |r| {
                let test = |ray: &obvhs::ray::Ray, id: usize| ordered[id].intersect(ray);
                if any {
                    !peer.ray_traverse_miss(peer_ray(r), test)
                } else {
                    peer.ray_traverse(peer_ray(r), &mut RayHit::none(), test)
                }
            });
            figures[levels.len()].push(speed);
            hits[levels.len()] = n;
        }
        print!("{name}:");
        for (i, figure) in figures.into_iter().enumerate() {
            let label = levels.get(i).map_or("obvhs".into(), |l| format!("{l:?}"));
            print!("  {label} {:.2} M rays/s ({} hits)", median(figure), hits[i]);
        }
        println!();
    }
}
