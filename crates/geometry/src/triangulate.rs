//! Faces of any size to triangles.

use umber_math::Point3;

use crate::{
    ElementId, MeshProblem, Orientation, Topology, TriangleIndex,
    ear_clipping::{clip_ears, cross_of, newell_normal},
};

/// The triangles of a mesh, counter-clockwise as seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    /// Point index of each vertex.
    pub triangles: Vec<[u32; 3]>,
    /// Face-vertex index of each vertex, for faceVarying primvars; empty where there are none.
    pub corners: Vec<[u32; 3]>,
    /// The authored face of each triangle.
    pub elements: Vec<u32>,
}

impl TriangleMesh {
    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }
    /// The authored face of a triangle; `None` where there is no such triangle.
    pub fn element(&self, triangle: TriangleIndex) -> Option<ElementId> {
        self.elements.get(triangle.0 as usize).map(|&e| ElementId(e))
    }
    /// Memory held, in bytes.
    pub fn memory_bytes(&self) -> usize {
        12 * (self.triangles.capacity() + self.corners.capacity()) + 4 * self.elements.capacity()
    }
}

/// Splits the faces of a mesh into triangles.
///
/// Quads are split along the shorter diagonal that lies inside, convex faces as a fan, concave ones
/// by clipping ears; a face of `n` corners always gives `n − 2` triangles, so that neighbours share
/// whole edges. Holes are left out, and left-handed winding is reversed. Faces that do not hold are
/// left out too, and told: one problem a kind.
pub fn triangulate(topology: &Topology, points: &[Point3]) -> (TriangleMesh, Vec<MeshProblem>) {
    let mut problems = Vec::new();
    let holes = hole_mask(topology, &mut problems);
    let mut builder = Builder::new(topology, points);
    let counts = &topology.face_vertex_counts;
    let indices = &topology.face_vertex_indices;
    let mut start = 0usize;
    for (face, &count) in counts.iter().enumerate() {
        let Ok(size) = usize::try_from(count) else {
            let negative = || MeshProblem::NegativeCount { faces: 0, first_face: face, count };
            tally(&mut problems, negative);
            continue;
        };
        let end = start.saturating_add(size);
        let is_hole = holes.get(face).copied().unwrap_or(false);
        if end > indices.len() {
            let past =
                || MeshProblem::CountsPastIndices { faces: 0, first_face: face, needed: end, indices: indices.len() };
            tally(&mut problems, past);
        } else if !is_hole && let Err(problem) = builder.add_face(face, start, &indices[start..end]) {
            tally(&mut problems, || problem);
        }
        start = end;
    }
    if start < indices.len() {
        problems.push(MeshProblem::LeftoverIndices { left: indices.len() - start, used: start });
    }
    (builder.mesh, problems)
}

/// Which faces are holes; empty where none is.
fn hole_mask(topology: &Topology, problems: &mut Vec<MeshProblem>) -> Vec<bool> {
    let faces = topology.face_vertex_counts.len();
    if topology.hole_indices.is_empty() {
        return Vec::new();
    }
    let mut mask = vec![false; faces];
    for &index in topology.hole_indices.iter() {
        match usize::try_from(index).ok().and_then(|i| mask.get_mut(i)) {
            Some(hole) => *hole = true,
            None => tally(problems, || MeshProblem::HoleOutOfRange { holes: 0, index, faces }),
        }
    }
    mask
}

/// Counts a problem: under the earlier one of its kind, or as a new one.
fn tally(problems: &mut Vec<MeshProblem>, problem: impl FnOnce() -> MeshProblem) {
    let problem = problem();
    let kind = std::mem::discriminant(&problem);
    let at = problems.iter().position(|p| std::mem::discriminant(p) == kind).unwrap_or_else(|| {
        problems.push(problem);
        problems.len() - 1
    });
    match &mut problems[at] {
        MeshProblem::TooFewCorners { faces, .. }
        | MeshProblem::NegativeCount { faces, .. }
        | MeshProblem::CountsPastIndices { faces, .. }
        | MeshProblem::IndexOutOfRange { faces, .. }
        | MeshProblem::NonFinitePoint { faces, .. }
        | MeshProblem::ZeroArea { faces, .. } => *faces += 1,
        MeshProblem::HoleOutOfRange { holes, .. } => *holes += 1,
        MeshProblem::LeftoverIndices { .. } | MeshProblem::AttributeTooShort { .. } => {}
    }
}

/// Collects triangles face by face.
struct Builder<'a> {
    points: &'a [Point3],
    left_handed: bool,
    mesh: TriangleMesh,
    /// Positions of the face at hand, and its triangles as corners of it: kept to save allocations.
    positions: Vec<glam::DVec3>,
    local: Vec<[u32; 3]>,
}

impl<'a> Builder<'a> {
    fn new(topology: &Topology, points: &'a [Point3]) -> Self {
        let corners = topology.face_vertex_indices.len();
        let triangles = corners.saturating_sub(2 * topology.face_vertex_counts.len());
        let mesh = TriangleMesh {
            triangles: Vec::with_capacity(triangles),
            corners: Vec::with_capacity(triangles),
            elements: Vec::with_capacity(triangles),
        };
        let left_handed = topology.orientation == Orientation::LeftHanded;
        Self { points, left_handed, mesh, positions: Vec::new(), local: Vec::new() }
    }

    /// Adds one face, whose corners begin at face-vertex index `start`.
    fn add_face(&mut self, face: usize, start: usize, indices: &[i32]) -> Result<(), MeshProblem> {
        if indices.len() < 3 {
            return Err(MeshProblem::TooFewCorners { faces: 0, first_face: face });
        }
        self.positions.clear();
        for &index in indices {
            let point = usize::try_from(index)
                .ok()
                .and_then(|i| self.points.get(i))
                .ok_or(MeshProblem::IndexOutOfRange { faces: 0, first_face: face, index, points: self.points.len() })?;
            if !point.is_finite() {
                return Err(MeshProblem::NonFinitePoint { faces: 0, first_face: face, point: index as usize });
            }
            self.positions.push(point.0.as_dvec3());
        }
        self.local.clear();
        split_face(&self.positions, &mut self.local);
        let area = |t: &[u32; 3]| cross_of(t.map(|i| self.positions[i as usize])).length_squared();
        if self.local.iter().all(|t| area(t) == 0.0) {
            return Err(MeshProblem::ZeroArea { faces: 0, first_face: face });
        }
        for &[a, b, c] in &self.local {
            let corner = if self.left_handed { [a, c, b] } else { [a, b, c] };
            self.mesh.triangles.push(corner.map(|i| indices[i as usize] as u32));
            self.mesh.corners.push(corner.map(|i| start as u32 + i));
            self.mesh.elements.push(face as u32);
        }
        Ok(())
    }
}

/// Triangles of one face of at least three corners, as indices of its corners.
fn split_face(p: &[glam::DVec3], out: &mut Vec<[u32; 3]>) {
    match p.len() {
        3 => out.push([0, 1, 2]),
        4 => split_quad(p, out),
        n => {
            let normal = newell_normal(p);
            if is_convex(p, normal) {
                out.extend((2..n as u32).map(|i| [0, i - 1, i]));
            } else {
                clip_ears(p, normal, out);
            }
        }
    }
}

/// Splits along the shorter of the diagonals that lie inside the quad.
fn split_quad(p: &[glam::DVec3], out: &mut Vec<[u32; 3]>) {
    let normal = newell_normal(p);
    let inside = |[a, b]: [[usize; 3]; 2]| {
        cross_of(a.map(|i| p[i])).dot(normal) > 0.0 && cross_of(b.map(|i| p[i])).dot(normal) > 0.0
    };
    let (first, second) = ([[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]);
    let shorter_first = p[0].distance_squared(p[2]) <= p[1].distance_squared(p[3]);
    let chosen = match (inside(first), inside(second)) {
        (true, false) => first,
        (false, true) => second,
        _ if shorter_first => first,
        _ => second,
    };
    out.extend(chosen.map(|t| t.map(|i| i as u32)));
}

/// Whether a fan from corner 0 covers the face without folding over: every corner turns the same
/// way, and no triangle of the fan is turned over (as in a star that winds twice).
fn is_convex(p: &[glam::DVec3], normal: glam::DVec3) -> bool {
    let n = p.len();
    let turns = (0..n).all(|i| cross_of([p[i], p[(i + 1) % n], p[(i + 2) % n]]).dot(normal) >= 0.0);
    turns && (2..n).all(|i| cross_of([p[0], p[i - 1], p[i]]).dot(normal) >= 0.0)
}
