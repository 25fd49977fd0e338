//! Meshes and rays, as read from bytes, and the slow answer.

use arbitrary::Arbitrary;
use umber_bvh::Hit;
use umber_geometry::watertight::{ShearedRay, TriangleHit};
use umber_math::{Point3, Ray, Vec3, Vector3};

use super::values::{Share, Triple, Value};

/// Most triangles of a mesh.
const MAX_TRIANGLES: usize = 256;

/// Points and triangles.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    pub points: Vec<Point3>,
    pub triangles: Vec<[u32; 3]>,
}

/// A mesh as read from bytes.
#[derive(Arbitrary, Debug)]
pub struct MeshInput {
    points: Vec<Triple>,
    triangles: Vec<[u8; 3]>,
    copies: Option<Copies>,
}

/// The mesh over and over, each time moved and scaled on.
#[derive(Arbitrary, Debug)]
struct Copies {
    count: u8,
    step: Triple,
    growth: Value,
}

impl MeshInput {
    pub fn mesh(&self) -> Mesh {
        let points: Vec<Point3> = self.points.iter().map(|p| p.point()).collect();
        let count = points.len() as u32;
        // The last few are out of range.
        let index = |i: u8| match i {
            0..250 => u32::from(i) % count.max(1),
            250.. => count.saturating_add(u32::from(i - 250) * (u32::MAX / 5)),
        };
        let triangles: Vec<[u32; 3]> = self.triangles.iter().take(MAX_TRIANGLES).map(|t| t.map(index)).collect();
        let mut mesh = Mesh { points: points.clone(), triangles: triangles.clone() };
        if let Some(Copies { count: copies, step, growth }) = &self.copies {
            let (mut offset, mut scale) = (Vec3::ZERO, 1.0);
            for copy in 1..=u32::from(*copies) {
                if mesh.triangles.len() + triangles.len() > MAX_TRIANGLES {
                    break;
                }
                (offset, scale) = (offset + step.vector(), scale * growth.0);
                mesh.points.extend(points.iter().map(|p| Point3(p.0 * scale + offset)));
                mesh.triangles.extend(triangles.iter().map(|t| t.map(|i| i.saturating_add(copy * count))));
            }
        }
        mesh
    }
}

impl Mesh {
    /// The vertices of a triangle that may be hit.
    pub fn vertices(&self, triangle: usize) -> Option<[Point3; 3]> {
        let [a, b, c] = self.triangles.get(triangle)?.map(|i| self.points.get(i as usize).copied());
        Some([a?, b?, c?])
    }

    /// Whether a triangle has all its points, and they are finite.
    pub fn is_sound(&self, triangle: usize) -> bool {
        self.vertices(triangle).is_some_and(|p| p.iter().all(|p| p.is_finite()))
    }

    /// A point on one of the triangles, or the origin.
    pub fn point_on(&self, on: On) -> Vec3 {
        let count = self.triangles.len().max(1);
        let [a, b, c] = self.vertices(usize::from(on.triangle) % count).unwrap_or([Point3::ZERO; 3]).map(|p| p.0);
        let (b1, b2) = (on.b1.get(), on.b2.get());
        a + (b - a) * b1 + (c - a) * (b2 * (1.0 - b1))
    }

    /// The closest hit by the scalar test on every one of the triangles, smallest index first.
    pub fn brute_force(&self, triangles: impl Iterator<Item = usize>, ray: &Ray) -> Option<(u32, TriangleHit)> {
        let sheared = ShearedRay::new(ray)?;
        let t_min = if ray.t_min > 0.0 { ray.t_min } else { 0.0 };
        let mut best: Option<(u32, TriangleHit)> = None;
        for i in triangles {
            let Some([a, b, c]) = self.vertices(i) else { continue };
            let end = best.map_or(ray.t_max, |(_, hit)| hit.t);
            if let Some(hit) = sheared.intersect(a, b, c, t_min, end) {
                best = Some((i as u32, hit));
            }
        }
        best
    }
}

/// A ray as read from bytes: anywhere, or aimed at a triangle.
#[derive(Arbitrary, Clone, Copy, Debug)]
pub struct RayInput {
    origin: Place,
    aim: Aim,
    ends: Option<(Value, Value)>,
}

#[derive(Arbitrary, Clone, Copy, Debug)]
enum Place {
    At(Triple),
    On(On),
}

/// A point on some triangle.
#[derive(Arbitrary, Clone, Copy, Debug)]
pub struct On {
    /// Which of all that there are.
    pub triangle: u16,
    b1: Share,
    b2: Share,
}

#[derive(Arbitrary, Clone, Copy, Debug)]
enum Aim {
    Along(Triple),
    /// At a place, the direction scaled.
    At(Place, Value),
    /// At a place, the direction of length one.
    Toward(Place),
}

impl RayInput {
    /// The ray, given where points on triangles are.
    pub fn ray(&self, point_on: impl Fn(On) -> Vec3) -> Ray {
        let place = |p: Place| match p {
            Place::At(p) => p.vector(),
            Place::On(on) => point_on(on),
        };
        let origin = place(self.origin);
        let direction = match self.aim {
            Aim::Along(d) => d.vector(),
            Aim::At(p, scale) => (place(p) - origin) * scale.0,
            Aim::Toward(p) => (place(p) - origin).normalize_or_zero(),
        };
        let ray = Ray::new(Point3(origin), Vector3(direction));
        match self.ends {
            None => ray,
            Some((Value(t_min), Value(t_max))) => Ray { t_min, t_max, ..ray },
        }
    }
}

/// What makes two hits the same, bit for bit.
pub fn bits(t: f32, barycentrics: [f32; 3]) -> [u32; 4] {
    let [b0, b1, b2] = barycentrics;
    [t, b0, b1, b2].map(f32::to_bits)
}

/// What must be so of every hit.
pub fn check_hit(hit: &Hit, ray: &Ray) {
    assert!(hit.t.is_finite() && hit.t > ray.t_min.max(0.0) && hit.t < ray.t_max, "{hit:?} {ray:?}");
    assert!(hit.barycentrics.iter().all(|b| (0.0..=1.0 + 1e-5).contains(b)), "{hit:?} {ray:?}");
    let sum: f32 = hit.barycentrics.iter().sum();
    assert!((sum - 1.0).abs() < 1e-5, "{hit:?} {ray:?}");
}
