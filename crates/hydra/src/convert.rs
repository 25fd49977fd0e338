//! Hydra's plain numbers as the scene's types.

use std::sync::Arc;

use bytemuck::cast_slice;
use glam::{DAffine3, DMat3, DVec3, Vec2, Vec3, Vec4};
use umber_scene::{Category, Interpolation, PrimvarValues};

use crate::bridge::ffi;

/// Numbers in a matrix as C++ hands it over: `GfMatrix4d`, row after row.
const MATRIX: usize = 16;

/// The transform of a `GfMatrix4d`. Gf multiplies row vectors from the left, so that its rows are the
/// columns here; its last column is dropped.
pub fn affine(m: &[f64]) -> DAffine3 {
    let row = |i: usize| DVec3::new(m[4 * i], m[4 * i + 1], m[4 * i + 2]);
    DAffine3 { matrix3: DMat3::from_cols(row(0), row(1), row(2)), translation: row(3) }
}

/// Transforms of matrices that follow each other.
pub fn affines(m: &[f64]) -> Arc<[DAffine3]> {
    m.chunks_exact(MATRIX).map(affine).collect()
}

/// A set of categories, in an order that does not depend on Hydra's.
pub fn categories(names: &[&str]) -> Arc<[Category]> {
    let mut set: Vec<Category> = names.iter().map(|name| Category::new(name)).collect();
    set.sort_unstable();
    set.dedup();
    set.into()
}

/// Triples of numbers that follow each other.
pub fn triples(v: &[f32]) -> Arc<[Vec3]> {
    cast_slice::<f32, Vec3>(&v[..v.len() / 3 * 3]).into()
}

/// Primvar values of one to four components; `None` for any other number of them.
pub fn primvar_values(v: &[f32], components: usize) -> Option<PrimvarValues> {
    let whole = v.len().checked_div(components)? * components;
    let v = &v[..whole];
    Some(match components {
        1 => PrimvarValues::Float(v.into()),
        2 => PrimvarValues::Float2(cast_slice::<f32, Vec2>(v).into()),
        3 => PrimvarValues::Float3(triples(v)),
        4 => PrimvarValues::Float4(v.chunks_exact(4).map(Vec4::from_slice).collect()),
        _ => return None,
    })
}

/// How a primvar's values spread; `None` where they belong to instances.
pub fn interpolation(said: ffi::Interpolation) -> Option<Interpolation> {
    Some(match said {
        ffi::Interpolation::Constant => Interpolation::Constant,
        ffi::Interpolation::Uniform => Interpolation::Uniform,
        ffi::Interpolation::Varying => Interpolation::Varying,
        ffi::Interpolation::Vertex => Interpolation::Vertex,
        ffi::Interpolation::FaceVarying => Interpolation::FaceVarying,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_become_columns() {
        let m: Vec<f64> = (0..32).map(f64::from).collect();
        let both = affines(&m);
        assert_eq!(both.len(), 2);
        assert_eq!(both[0].matrix3.x_axis, DVec3::new(0.0, 1.0, 2.0));
        assert_eq!(both[1].translation, DVec3::new(28.0, 29.0, 30.0));
    }

    #[test]
    fn primvars_of_all_sizes() {
        let v = [1.0, 2.0, 3.0, 4.0, 5.0];
        assert_eq!(primvar_values(&v, 1).unwrap().len(), 5);
        assert_eq!(primvar_values(&v, 2).unwrap().len(), 2);
        assert_eq!(primvar_values(&v, 4), Some(PrimvarValues::Float4(Arc::new([Vec4::new(1.0, 2.0, 3.0, 4.0)]))));
        assert_eq!(primvar_values(&v, 0), None);
        assert_eq!(primvar_values(&v, 5), None);
    }
}
