//! What is traced: made here, or dumped from USD stages.

mod dump;
mod shapes;

use std::path::Path;

use anyhow::Result;
use umber_math::{Bounds3, DAffine3, DVec3, Point3, Vec3};

use crate::random::Random;

/// Points and triangles.
#[derive(Clone, Default)]
pub struct Mesh {
    /// Positions.
    pub points: Vec<Point3>,
    /// Triples of point indices.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// The same surface with every triangle split into `sides²`.
    #[must_use]
    pub fn refined(&self, sides: u32) -> Self {
        let mut fine = Self::default();
        let n = sides.max(1);
        // Rows from the first corner on: row i holds i + 1 points.
        let at = |i: u32, j: u32| i * (i + 1) / 2 + j;
        for triangle in &self.triangles {
            let first = fine.points.len() as u32;
            let [a, b, c] = triangle.map(|p| self.points[p as usize].0);
            for i in 0..=n {
                let (part, left) = (i as f32 / n as f32, 1.0 / i.max(1) as f32);
                let (from, to) = (a.lerp(b, part), a.lerp(c, part));
                fine.points.extend((0..=i).map(|j| Point3(from.lerp(to, j as f32 * left))));
            }
            for i in 0..n {
                for j in 0..=i {
                    fine.triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)].map(|p| first + p));
                    if j < i {
                        fine.triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)].map(|p| first + p));
                    }
                }
            }
        }
        fine
    }
}

/// A mesh at a place.
pub struct Placement {
    /// Which mesh.
    pub mesh: usize,
    /// From the mesh's space to the world.
    pub transform: DAffine3,
}

/// Meshes, where they stand, and from where they are seen.
pub struct Scene {
    /// Its name, as charts show it.
    pub name: String,
    /// The meshes.
    pub meshes: Vec<Mesh>,
    /// Where they stand.
    pub instances: Vec<Placement>,
    /// Where the camera is, world.
    pub eye: Vec3,
    /// What it looks at, world.
    pub target: Vec3,
    /// Width and height of its picture at distance one.
    pub width: f32,
}

/// Width of a picture at distance one, unless a stage's camera says another.
const WIDTH: f32 = 1.2;
/// Side of the square of instances.
const INSTANCES_A_SIDE: usize = 317;

impl Scene {
    fn flat(name: &str, mesh: Mesh, eye: Vec3, target: Vec3) -> Self {
        let instances = vec![Placement { mesh: 0, transform: DAffine3::IDENTITY }];
        Self { name: name.into(), meshes: vec![mesh], instances, eye, target, width: WIDTH }
    }

    /// Whether it is one mesh where it is: then no library is made to go through an instance that moves rays.
    pub fn is_flat(&self) -> bool {
        self.instances.len() == 1 && self.instances[0].transform == DAffine3::IDENTITY
    }

    /// The same scene with every triangle split into `sides²`.
    #[must_use]
    pub fn refined(mut self, sides: u32) -> Self {
        if sides > 1 {
            self.meshes = self.meshes.iter().map(|mesh| mesh.refined(sides)).collect();
            self.name += &format!(", each triangle in {}", sides * sides);
        }
        self
    }

    /// Bytes of points and indices.
    pub fn geometry_bytes(&self) -> usize {
        let bytes = |m: &Mesh| size_of_val(&m.points[..]) + size_of_val(&m.triangles[..]);
        self.meshes.iter().map(bytes).sum()
    }

    /// Number of triangles that are stored.
    pub fn triangle_count(&self) -> usize {
        self.meshes.iter().map(|m| m.triangles.len()).sum()
    }

    /// A box around all points, world.
    pub fn bounds(&self) -> Bounds3 {
        let boxes: Vec<_> = self.meshes.iter().map(|m| Bounds3::of_points(m.points.iter().copied())).collect();
        let corners = |i: &Placement| {
            let t = i.transform;
            boxes[i.mesh].corners().map(|c| Point3(t.transform_point3(c.0.as_dvec3()).as_vec3()))
        };
        Bounds3::of_points(self.instances.iter().flat_map(corners))
    }
}

/// All scenes: those made here, and the dumps (`*.tri`) that lie in a folder.
///
/// # Errors
/// A dump cannot be read.
pub fn all(dumps: &Path) -> Result<Vec<Scene>> {
    let mut scenes = dump::read_all(dumps)?;
    scenes.extend([displaced(), slivers(), teapot_in_stadium(), instances()]);
    Ok(scenes)
}

/// A bumpy sphere of about a million triangles in a box, seen from inside the box.
fn displaced() -> Scene {
    let mesh = shapes::bumpy_sphere(500).with(&shapes::cuboid(Vec3::splat(3.0)));
    Scene::flat("displaced, 1 M", mesh, Vec3::new(0.3, 0.8, 2.8), Vec3::new(0.3, 0.1, 0.0))
}

/// A hundred thousand needles, a thousand times longer than wide, in a box.
fn slivers() -> Scene {
    let mesh = shapes::needles(100_000, 1.0, 1e-3).with(&shapes::cuboid(Vec3::splat(3.0)));
    Scene::flat("slivers", mesh, Vec3::new(0.0, 0.0, 2.9), Vec3::ZERO)
}

/// Something of size one, finely tessellated, on the floor of a bowl of size 10⁴ made of few triangles.
fn teapot_in_stadium() -> Scene {
    let pot = shapes::lathe(400, 250);
    let bowl = shapes::bowl(24, 64, 1e4);
    let mesh = pot.with(&bowl).moved(|p| p + Vec3::new(300.0, 0.0, -200.0));
    let center = Vec3::new(300.0, 0.5, -200.0);
    Scene::flat("teapot in a stadium", mesh, center + Vec3::new(1.5, 1.2, 2.0), center)
}

/// A hundred thousand turned and scaled instances of one mesh, over and through each other.
fn instances() -> Scene {
    let mut random = Random(0x2545_f491_4f6c_dd1d);
    let place = |i: usize| {
        let (x, z) = ((i % INSTANCES_A_SIDE) as f64, (i / INSTANCES_A_SIDE) as f64);
        let half = INSTANCES_A_SIDE as f64 / 2.0;
        let height = f64::from(random.float()) * 2.0;
        let turn =
            DAffine3::from_axis_angle(random.direction().as_dvec3().normalize(), f64::from(random.float()) * 6.0);
        let scale = DAffine3::from_scale(DVec3::splat(0.25 + 0.35 * f64::from(random.float())));
        let place = DAffine3::from_translation(DVec3::new(x - half, height, z - half));
        Placement { mesh: 0, transform: place * turn * scale }
    };
    let instances = (0..INSTANCES_A_SIDE * INSTANCES_A_SIDE).map(place).collect();
    Scene {
        name: "instances, 100 k".into(),
        meshes: vec![shapes::bumpy_sphere(40)],
        instances,
        eye: Vec3::new(0.0, 12.0, 60.0),
        target: Vec3::new(0.0, 0.0, 20.0),
        width: WIDTH,
    }
}
