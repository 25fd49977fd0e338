//! Normals made from the points of a mesh.

use umber_math::{Normal3, Point3, Vec3};

use crate::TriangleMesh;

/// Unit normal of a triangle, on the side from which it is counter-clockwise; zero where its area is zero.
///
/// In the space of the points. Computed in double precision, so that slivers far from the origin keep theirs.
pub fn geometric_normal(p0: Point3, p1: Point3, p2: Point3) -> Normal3 {
    let (a, b, c) = (p0.0.as_dvec3(), p1.0.as_dvec3(), p2.0.as_dvec3());
    Normal3((b - a).cross(c - a).normalize_or_zero().as_vec3())
}

/// Unit normal of each point: the mean of its triangles' normals, weighted by their angles there
/// (Thürmer and Wüthrich 1998, "Computing Vertex Normals from Polygonal Facets").
///
/// One a point; zero where undefined (a point of no triangle, or of such as cancel out).
pub fn smooth_normals(mesh: &TriangleMesh, points: &[Point3]) -> Vec<Normal3> {
    let mut sums = vec![Vec3::ZERO; points.len()];
    for triangle in &mesh.triangles {
        let Some(p) = positions(triangle, points) else { continue };
        let normal = geometric_normal(p[0], p[1], p[2]).0;
        for (corner, &point) in triangle.iter().enumerate() {
            sums[point as usize] += normal * corner_angle(p, corner);
        }
    }
    sums.into_iter().map(|n| Normal3(n.normalize_or_zero())).collect()
}

fn positions(triangle: &[u32; 3], points: &[Point3]) -> Option<[Point3; 3]> {
    let [a, b, c] = triangle.map(|i| points.get(i as usize).copied());
    Some([a?, b?, c?])
}

/// Angle at a corner, in radians; zero where an edge has no length.
fn corner_angle(p: [Point3; 3], corner: usize) -> f32 {
    let [a, b, c] = [0, 1, 2].map(|k| p[(corner + k) % 3].0.as_dvec3());
    let (u, v) = (b - a, c - a);
    let angle = u.cross(v).length().atan2(u.dot(v));
    if angle.is_finite() { angle as f32 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cube_corner_is_the_diagonal_however_its_faces_are_split() {
        let points = [(0., 0., 0.), (1., 0., 0.), (0., 1., 0.), (0., 0., 1.), (1., 1., 0.)]
            .map(|(x, y, z)| Point3::new(x, y, z));
        // Three faces meet at the origin; the one in z = 0 as two triangles.
        let triangles = vec![[0, 1, 3], [0, 3, 2], [0, 4, 1], [0, 2, 4]];
        let mesh = TriangleMesh { triangles, ..Default::default() };
        let n = smooth_normals(&mesh, &points)[0];
        assert!((n.0 - Vec3::splat(-1.0).normalize()).length() < 1e-6, "{n:?}");
    }

    #[test]
    fn undefined_normals_are_zero_and_bad_indices_pass() {
        let points = [Point3::ZERO, Point3::new(1., 0., 0.), Point3::new(2., 0., 0.), Point3::new(f32::NAN, 0., 0.)];
        let mesh = TriangleMesh { triangles: vec![[0, 1, 2], [0, 1, 9], [0, 1, 3]], ..Default::default() };
        let normals = smooth_normals(&mesh, &points);
        assert_eq!(normals.len(), 4);
        assert!(normals.iter().all(|n| n.0 == Vec3::ZERO), "{normals:?}");
    }
}
