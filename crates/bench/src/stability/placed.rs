//! Meshes placed by transforms, nested as instances are.

use std::sync::Arc;

use umber_bvh::{Child, Hit, Instance, InstanceBvh, MeshBvh};
use umber_geometry::{SurfacePoint, surface_point};
use umber_math::{DAffine3, DMat3, DVec3, Point3};

use super::shapes::Mesh;

/// Transforms, outermost first, under a name.
#[derive(Clone)]
pub struct Placement {
    /// What they do.
    pub name: &'static str,
    /// From each child's space to its parent's.
    pub transforms: Vec<DAffine3>,
}

/// A mesh at a place.
pub struct Placed {
    /// Object space.
    pub mesh: Mesh,
    /// The hierarchy.
    pub scene: InstanceBvh,
    transforms: Vec<DAffine3>,
    render_from_object: DAffine3,
}

impl Placed {
    /// A group a transform.
    pub fn new(mesh: Mesh, transforms: &[DAffine3]) -> Self {
        let bvh = Arc::new(MeshBvh::build(&mesh.points, &mesh.triangles));
        let mut child = Child::Mesh { bvh, mesh: 0 };
        let (outer, inner) = transforms.split_first().map_or((DAffine3::IDENTITY, &[][..]), |(o, i)| (*o, i));
        for &parent_from_child in inner.iter().rev() {
            let instances = vec![Instance { child, parent_from_child, tag: 0 }];
            child = Child::Group(Arc::new(InstanceBvh::build(instances)));
        }
        let scene = InstanceBvh::build(vec![Instance { child, parent_from_child: outer, tag: 0 }]);
        let render_from_object = transforms.iter().fold(DAffine3::IDENTITY, |m, t| m * *t);
        Self { mesh, scene, transforms: transforms.to_vec(), render_from_object }
    }

    /// A point in render space, in double precision.
    pub fn render(&self, object: DVec3) -> DVec3 {
        self.render_from_object.transform_point3(object)
    }
    /// The corners of a triangle in render space, in double precision.
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.mesh.corners(triangle).map(|p| self.render(p.0.as_dvec3()))
    }
    /// The corners of a triangle in render space, rounded, as one without instances would have them.
    pub fn flattened(&self, triangle: usize) -> [Point3; 3] {
        self.corners(triangle).map(|p| Point3(p.as_vec3()))
    }
    /// Where a ray met the mesh, as the renderer has it.
    pub fn surface_point(&self, hit: &Hit) -> SurfacePoint {
        surface_point(self.mesh.corners(hit.triangle as usize), hit.barycentrics, self.scene.transforms(&hit.path))
    }
    /// The largest distance from the middle of the mesh's box to a point, render space.
    pub fn radius(&self) -> f32 {
        let center = self.center();
        self.mesh.points.iter().map(|p| self.render(p.0.as_dvec3()).distance(center)).fold(0.0, f64::max) as f32
    }
    /// The middle of the mesh's box in render space.
    pub fn center(&self) -> DVec3 {
        self.render(self.mesh.bounds().center().0.as_dvec3())
    }
    /// At most half of what it measures where it is thinnest, render space.
    pub fn thickness(&self) -> f64 {
        let m = self.render_from_object.matrix3.inverse();
        let squares = [m.x_axis, m.y_axis, m.z_axis].map(DVec3::length_squared);
        f64::from(self.mesh.bounds().size().min_element()) * 0.5 / squares.iter().sum::<f64>().sqrt()
    }
    /// How far apart numbers are at a point of the object, in render-space units: the sum over all spaces in which
    /// a ray that starts there is rounded.
    pub fn spacing(&self, object: DVec3) -> f64 {
        let ulp = |p: DVec3| {
            let x = p.abs().max_element() as f32;
            f64::from(x.next_up() - x)
        };
        let (mut point, mut sum) = (object, ulp(object) * stretch(&self.render_from_object.matrix3));
        for level in (0..self.transforms.len()).rev().filter(|&l| self.transforms[l] != DAffine3::IDENTITY) {
            point = self.transforms[level].transform_point3(point);
            let outwards = self.transforms[..level].iter().fold(DMat3::IDENTITY, |m, t| m * t.matrix3);
            sum += ulp(point) * stretch(&outwards);
        }
        sum
    }
    /// By how much a step along a unit normal, object space, leads away from its plane, render space.
    pub fn height(&self, normal_object: DVec3) -> f64 {
        1.0 / (self.render_from_object.matrix3.inverse().transpose() * normal_object).length()
    }
}

/// The largest factor by which a matrix lengthens an axis.
fn stretch(m: &DMat3) -> f64 {
    m.x_axis.length().max(m.y_axis.length()).max(m.z_axis.length())
}

/// A turn about no axis in particular.
fn turn(by: f64) -> DAffine3 {
    DAffine3::from_axis_angle(DVec3::new(0.36, 0.48, 0.8), by)
}

fn scale(by: f64) -> DAffine3 {
    DAffine3::from_scale(DVec3::splat(by))
}

fn shear() -> DAffine3 {
    DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::new(1.5, 1.0, 0.0), DVec3::new(-0.7, 0.4, 1.0)))
}

/// The ways in which meshes are placed, at a distance from the origin in units; each scales by `by`.
pub fn placements(distance: f64, by: f64) -> Vec<Placement> {
    let out = DVec3::new(1.0, -0.7, 0.4) * distance;
    let away = DAffine3::from_translation(out);
    let flat = DAffine3::from_scale(DVec3::new(10.0, 1.0, 0.1));
    // Back by what leads out, seen from the turned space between.
    let back = DAffine3::from_translation(turn(-2.0).transform_vector3(-out));
    let step = |x: f64| DAffine3::from_translation(DVec3::new(x, 2.0 * x, -x));
    let place = |name, transforms: Vec<DAffine3>| Placement { name, transforms };
    vec![
        place("moved", vec![away * scale(by)]),
        place("turned", vec![away * turn(0.7) * scale(by)]),
        place("mirrored", vec![away * turn(1.1) * DAffine3::from_scale(DVec3::new(by, -by, by))]),
        place("sheared", vec![away * turn(0.3) * shear() * turn(2.1) * scale(by)]),
        place("flattened", vec![away * turn(0.9) * flat * turn(0.4) * scale(by)]),
        place("two deep", vec![away * turn(0.5) * scale(50.0), step(3.0) * turn(2.5) * scale(by / 50.0)]),
        place(
            "three deep",
            vec![away * turn(0.5), step(by) * turn(2.5) * scale(by) * shear(), step(0.1) * turn(1.2) * scale(0.2)],
        ),
        place("there and back", vec![away * turn(2.0), back * turn(0.2), step(by) * scale(by)]),
    ]
}
