//! Who is right where two answers differ: every triangle near the ray, in double precision, without a hierarchy.

use umber_math::{DAffine3, DVec3, Ray};

use crate::scenes::{Mesh, Scene};

/// Looks through a scene, instance by instance.
pub struct Referee<'a> {
    scene: &'a Scene,
    /// What each instance shows, in world space: center and radius.
    balls: Vec<(DVec3, f64)>,
}

impl<'a> Referee<'a> {
    /// For one scene.
    pub fn new(scene: &'a Scene) -> Self {
        let own: Vec<_> = scene.meshes.iter().map(ball).collect();
        let placed = |mesh: usize, m: DAffine3| {
            let (center, radius) = own[mesh];
            let stretch = m.matrix3.x_axis.length_squared() + m.matrix3.y_axis.length_squared();
            (m.transform_point3(center), radius * (stretch + m.matrix3.z_axis.length_squared()).sqrt())
        };
        Self { scene, balls: scene.instances.iter().map(|i| placed(i.mesh, i.transform)).collect() }
    }

    /// Parameter of the closest hit.
    pub fn closest(&self, ray: &Ray) -> Option<f64> {
        let (o, d) = (ray.origin.0.as_dvec3(), ray.direction.0.as_dvec3());
        let meets = |&(center, radius): &(DVec3, f64)| {
            let to = center - o;
            let nearest = (to.dot(d) / d.length_squared()).max(0.0);
            (to - d * nearest).length_squared() <= radius * radius
        };
        let near = self.scene.instances.iter().zip(&self.balls).filter(|(_, ball)| meets(ball)).map(|(i, _)| i);
        let of_instance = |i: &crate::scenes::Placement| {
            let m = i.transform.inverse();
            let (o, d) = (m.transform_point3(o), m.transform_vector3(d));
            of_mesh(&self.scene.meshes[i.mesh], o, d)
                .filter(|t| *t > f64::from(ray.t_min) && *t < f64::from(ray.t_max))
                .fold(f64::INFINITY, f64::min)
        };
        let t = near.map(of_instance).fold(f64::INFINITY, f64::min);
        t.is_finite().then_some(t)
    }
}

/// A ball around a mesh.
fn ball(mesh: &Mesh) -> (DVec3, f64) {
    let points = || mesh.points.iter().map(|p| p.0.as_dvec3());
    let center = points().sum::<DVec3>() / mesh.points.len().max(1) as f64;
    (center, points().map(|p| p.distance(center)).fold(0.0, f64::max))
}

/// Parameters of all hits with a mesh: signed volumes, edges and all.
fn of_mesh(mesh: &Mesh, o: DVec3, d: DVec3) -> impl Iterator<Item = f64> {
    mesh.triangles.iter().filter_map(move |triangle| {
        let [a, b, c] = triangle.map(|i| mesh.points[i as usize].0.as_dvec3() - o);
        let [u, v, w] = [(c, b), (a, c), (b, a)].map(|(p, q)| d.dot(p.cross(q)));
        let same_side = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
        let volume = u + v + w;
        let n = (b - a).cross(c - a);
        (same_side && volume != 0.0).then(|| n.dot(a) / n.dot(d))
    })
}
