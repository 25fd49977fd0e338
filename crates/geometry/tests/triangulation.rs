//! Triangulation against meshes made to break it.

use umber_geometry::{MeshProblem, Orientation, Topology, TriangleMesh, geometric_normal, triangulate};
use umber_math::{Point3, Vec3};

fn topology(counts: &[i32], indices: &[i32]) -> Topology {
    Topology { face_vertex_counts: counts.into(), face_vertex_indices: indices.into(), ..Default::default() }
}

fn grid(n: usize) -> Vec<Point3> {
    (0..n).map(|i| Point3::new((i % 4) as f32, (i / 4) as f32, 0.0)).collect()
}

fn area(mesh: &TriangleMesh, p: &[Point3]) -> f32 {
    let one = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| p[i as usize].0);
        (b - a).cross(c - a).z / 2.0
    };
    mesh.triangles.iter().map(one).sum()
}

#[test]
fn quads_split_along_the_shorter_diagonal() {
    let p = [(0., 0.), (4., 0.), (5., 1.), (1., 1.)].map(|(x, y)| Point3::new(x, y, 0.0));
    let (mesh, problems) = triangulate(&topology(&[4], &[0, 1, 2, 3]), &p);
    assert!(problems.is_empty());
    assert_eq!(mesh.triangles, [[0, 1, 3], [1, 2, 3]]);
    assert_eq!((mesh.corners, mesh.elements), (vec![[0, 1, 3], [1, 2, 3]], vec![0, 0]));
}

#[test]
fn concave_quads_split_along_the_diagonal_inside() {
    // An arrowhead whose shorter diagonal lies outside, with the dent at each corner in turn.
    let p = [(10., 0.), (0., 1.), (1., 0.), (0., -1.)].map(|(x, y)| Point3::new(x, y, 0.0));
    for shift in 0..4 {
        let indices: Vec<i32> = (0..4).map(|i| (i + shift) % 4).collect();
        let (mesh, _) = triangulate(&topology(&[4], &indices), &p);
        assert!(mesh.triangles.iter().all(|t| t.contains(&0) && t.contains(&2)), "{mesh:?}");
        assert_eq!(area(&mesh, &p), 9.0);
    }
}

#[test]
fn concave_polygons_keep_their_area_in_any_plane() {
    let star: Vec<(f32, f32)> = (0..14)
        .map(|i| (i as f32 / 14.0 * std::f32::consts::TAU, if i % 2 == 0 { 3.0 } else { 1.0 }))
        .map(|(a, r)| (r * a.cos(), r * a.sin()))
        .collect();
    let indices: Vec<i32> = (0..14).collect();
    for (x, y) in
        [(Vec3::X, Vec3::Y), (Vec3::Y, Vec3::X), (Vec3::Z, Vec3::Y), (Vec3::new(1., 2., 0.), Vec3::new(0., 1., -3.))]
    {
        let p: Vec<Point3> = star.iter().map(|&(a, b)| Point3(x * a + y * b)).collect();
        let (mesh, problems) = triangulate(&topology(&[14], &indices), &p);
        assert!(problems.is_empty());
        assert_eq!(mesh.len(), 12);
        let total: Vec3 =
            mesh.triangles.iter().map(|t| t.map(|i| p[i as usize].0)).map(|[a, b, c]| (b - a).cross(c - a)).sum();
        let want: f32 = 14.0 * 3.0 * 1.0 * (std::f32::consts::TAU / 14.0).sin();
        assert!((total.length() - want * x.cross(y).length()).abs() < 1e-3 * total.length());
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| p[i as usize]);
            assert!(geometric_normal(a, b, c).0.dot(total) >= 0.0, "a triangle is turned over");
        }
    }
}

#[test]
fn left_handed_faces_are_reversed_with_their_corners() {
    let mut t = topology(&[3], &[0, 1, 4]);
    t.orientation = Orientation::LeftHanded;
    let (mesh, _) = triangulate(&t, &grid(8));
    assert_eq!((mesh.triangles[0], mesh.corners[0]), ([0, 4, 1], [0, 2, 1]));
}

#[test]
fn every_defect_is_told_once_and_the_other_faces_kept() {
    let mut p = grid(12);
    p[11].0.y = f32::NAN;
    //           good  few  range few  NaN   flat  good  range
    let counts = [4, 2, 3, 0, 3, 3, -7, 3, 3];
    let indices = [0, 1, 5, 4, 0, 1, 0, 1, 37, 0, 1, 11, 0, 1, 2, 1, 2, 6, -1, 0, 4];
    let (mesh, problems) = triangulate(&topology(&counts, &indices), &p);
    assert_eq!(mesh.elements, [0, 0, 7]);
    assert_eq!(mesh.corners[2], [15, 16, 17]);
    let told: Vec<String> = problems.iter().map(ToString::to_string).collect();
    assert_eq!(
        told,
        [
            "2 faces skipped: fewer than 3 corners (first: face 1)",
            "2 faces skipped: corner index 37 is beyond the 12 points (first: face 2)",
            "1 faces skipped: point 11 is not finite (first: face 4)",
            "1 faces skipped: their area is zero (first: face 5)",
            "1 faces skipped: corner count -7 is negative (first: face 6)",
        ]
    );
}

#[test]
fn counts_and_holes_that_do_not_fit_are_told() {
    let mut t = topology(&[3, 3, 4, 3], &[0, 1, 4, 1, 5, 4, 0, 1]);
    t.hole_indices = [0, 4, -1].into();
    let (mesh, problems) = triangulate(&t, &grid(8));
    assert_eq!(mesh.elements, [1]);
    assert_eq!(
        problems,
        [
            MeshProblem::HoleOutOfRange { holes: 2, index: 4, faces: 4 },
            MeshProblem::CountsPastIndices { faces: 2, first_face: 2, needed: 10, indices: 8 },
        ]
    );
    let (mesh, problems) = triangulate(&topology(&[3], &[0, 1, 4, 7, 7]), &grid(8));
    assert_eq!(mesh.len(), 1);
    assert_eq!(problems, [MeshProblem::LeftoverIndices { left: 2, used: 3 }]);
}

#[test]
fn empty_and_extreme_counts_do_not_panic() {
    assert!(triangulate(&topology(&[], &[]), &[]).0.is_empty());
    let (mesh, problems) = triangulate(&topology(&[i32::MAX, i32::MIN, 3], &[0, 1, 2]), &grid(3));
    assert!(mesh.is_empty());
    assert_eq!(problems.len(), 2);
}
