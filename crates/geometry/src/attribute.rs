//! Values that spread over a mesh.

use std::{
    ops::{Add, Mul},
    sync::Arc,
};

use umber_math::{Vec2, Vec3};

use crate::{Interpolation, MeshProblem, TriangleMesh};

/// What an attribute can hold: values that can be blended.
pub trait AttributeValue: Copy + Default + Add<Output = Self> + Mul<f32, Output = Self> {}
impl AttributeValue for f32 {}
impl AttributeValue for Vec2 {}
impl AttributeValue for Vec3 {}
impl AttributeValue for glam::Vec4 {}

/// A primvar's values, known to be enough for the mesh it was checked against.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute<T> {
    values: Arc<[T]>,
    interpolation: Interpolation,
}

impl<T: AttributeValue> Attribute<T> {
    /// Checks the number of values against the topology's sizes.
    ///
    /// More values than needed are accepted, as USD does; fewer are an error that names both sizes.
    pub fn new(
        values: impl Into<Arc<[T]>>,
        interpolation: Interpolation,
        face_count: usize,
        point_count: usize,
        corner_count: usize,
    ) -> Result<Self, MeshProblem> {
        let values = values.into();
        let needed = match interpolation {
            Interpolation::Constant => 1,
            Interpolation::Uniform => face_count,
            Interpolation::Varying | Interpolation::Vertex => point_count,
            Interpolation::FaceVarying => corner_count,
        };
        if values.len() < needed {
            return Err(MeshProblem::AttributeTooShort { interpolation, needed, given: values.len() });
        }
        Ok(Self { values, interpolation })
    }

    /// How the values spread.
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }

    /// The values.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// The value at barycentric coordinates of a triangle.
    ///
    /// `mesh` is the triangulation of the topology that the attribute was checked against; what it
    /// lacks reads as zero.
    #[inline]
    pub fn eval(&self, mesh: &TriangleMesh, triangle: u32, barycentrics: [f32; 3]) -> T {
        let t = triangle as usize;
        match self.interpolation {
            Interpolation::Constant => self.value(0),
            Interpolation::Uniform => mesh.elements.get(t).map_or(T::default(), |&face| self.value(face)),
            Interpolation::Varying | Interpolation::Vertex => self.blend(mesh.triangles.get(t), barycentrics),
            Interpolation::FaceVarying => self.blend(mesh.corners.get(t), barycentrics),
        }
    }

    /// The values at the three vertices of a triangle (all alike where constant or uniform).
    #[inline]
    pub fn at_vertices(&self, mesh: &TriangleMesh, triangle: u32) -> [T; 3] {
        let Some([a, b, c]) = self.indices_at_vertices(mesh, triangle) else { return [T::default(); 3] };
        [self.value(a), self.value(b), self.value(c)]
    }

    /// Indices of the values at a triangle's vertices; `None` where the mesh lacks the triangle.
    #[inline]
    fn indices_at_vertices(&self, mesh: &TriangleMesh, triangle: u32) -> Option<[u32; 3]> {
        let t = triangle as usize;
        match self.interpolation {
            Interpolation::Constant => Some([0; 3]),
            Interpolation::Uniform => mesh.elements.get(t).map(|&face| [face; 3]),
            Interpolation::Varying | Interpolation::Vertex => mesh.triangles.get(t).copied(),
            Interpolation::FaceVarying => mesh.corners.get(t).copied(),
        }
    }

    #[inline]
    fn value(&self, index: u32) -> T {
        self.values.get(index as usize).copied().unwrap_or_default()
    }

    #[inline]
    fn blend(&self, indices: Option<&[u32; 3]>, b: [f32; 3]) -> T {
        let Some(&[i0, i1, i2]) = indices else { return T::default() };
        self.value(i0) * b[0] + self.value(i1) * b[1] + self.value(i2) * b[2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_triangles() -> TriangleMesh {
        TriangleMesh {
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            corners: vec![[0, 1, 2], [3, 4, 5]],
            elements: vec![0, 1],
        }
    }

    #[test]
    fn each_interpolation_reads_its_own_index() {
        let mesh = two_triangles();
        let b = [0.25, 0.25, 0.5];
        let eval = |v: Vec<f32>, i| Attribute::new(v, i, 2, 4, 6).unwrap().eval(&mesh, 1, b);
        assert_eq!(eval(vec![7.0, 1.0], Interpolation::Constant), 7.0);
        assert_eq!(eval(vec![7.0, 9.0], Interpolation::Uniform), 9.0);
        assert_eq!(eval(vec![4.0, 99.0, 8.0, 16.0], Interpolation::Vertex), 11.0);
        assert_eq!(eval(vec![4.0, 99.0, 8.0, 16.0], Interpolation::Varying), 11.0);
        assert_eq!(eval(vec![0.0, 0.0, 0.0, 4.0, 8.0, 16.0], Interpolation::FaceVarying), 11.0);
    }

    #[test]
    fn too_few_values_name_both_sizes() {
        let problem = Attribute::new(vec![Vec3::ZERO; 5], Interpolation::FaceVarying, 2, 4, 6).unwrap_err();
        assert_eq!(problem.to_string(), "5 values given where FaceVarying interpolation needs 6");
        assert!(Attribute::new(vec![Vec2::ZERO; 9], Interpolation::FaceVarying, 2, 4, 6).is_ok());
        assert!(Attribute::new(Vec::<f32>::new(), Interpolation::Constant, 0, 0, 0).is_err());
    }

    #[test]
    fn a_triangle_that_is_not_there_reads_as_zero() {
        for i in [Interpolation::Uniform, Interpolation::Vertex, Interpolation::FaceVarying] {
            let a = Attribute::new(vec![1.0f32; 6], i, 2, 4, 6).unwrap();
            assert_eq!(a.eval(&two_triangles(), 2, [1.0, 0.0, 0.0]), 0.0);
        }
    }
}
