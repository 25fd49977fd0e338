//! Between numpy arrays and the scene's types: checked shapes, one copy each way.

use std::sync::Arc;

use numpy::{PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use umber_math::{DAffine3, DVec3};

/// Array of single-precision numbers, any shape.
pub type Floats<'py> = PyReadonlyArrayDyn<'py, f32>;
/// Array of double-precision numbers, any shape.
pub type Doubles<'py> = PyReadonlyArrayDyn<'py, f64>;
/// Array of whole numbers, any shape.
pub type Ints<'py> = PyReadonlyArrayDyn<'py, i32>;

/// A `ValueError`.
pub fn bad_value(what: impl Into<String>) -> PyErr {
    PyValueError::new_err(what.into())
}

fn contiguous<'a, T: numpy::Element>(array: &'a PyReadonlyArrayDyn<'_, T>, what: &str) -> PyResult<&'a [T]> {
    array.as_slice().map_err(|_| bad_value(format!("{what} must be C-contiguous")))
}

/// A list of whole numbers.
pub fn ints(array: &Ints<'_>, what: &str) -> PyResult<Arc<[i32]>> {
    Ok(contiguous(array, what)?.into())
}

/// A list of numbers; shape (n,) or (n, 1).
pub fn scalars(array: &Floats<'_>, what: &str) -> PyResult<Arc<[f32]>> {
    Ok(contiguous(array, what)?.into())
}

/// A list of vectors; shape (n, components of `V`).
pub fn vectors<V: bytemuck::Pod>(array: &Floats<'_>, what: &str) -> PyResult<Arc<[V]>> {
    let width = size_of::<V>() / size_of::<f32>();
    match array.shape() {
        [_, w] if *w == width => Ok(bytemuck::cast_slice(contiguous(array, what)?).into()),
        shape => Err(bad_value(format!("{what} must have shape (n, {width}), not {shape:?}"))),
    }
}

/// Reads a matrix in USD's layout: row vectors, translation in the last row.
fn affine_from_rows(m: &[f64]) -> DAffine3 {
    DAffine3::from_cols(
        DVec3::new(m[0], m[1], m[2]),
        DVec3::new(m[4], m[5], m[6]),
        DVec3::new(m[8], m[9], m[10]),
        DVec3::new(m[12], m[13], m[14]),
    )
}

/// A transform; shape (4, 4) in USD's layout.
pub fn transform(array: &Doubles<'_>, what: &str) -> PyResult<DAffine3> {
    match array.shape() {
        [4, 4] => Ok(affine_from_rows(contiguous(array, what)?)),
        shape => Err(bad_value(format!("{what} must have shape (4, 4), not {shape:?}"))),
    }
}

/// A list of transforms; shape (n, 4, 4) in USD's layout.
pub fn transforms(array: &Doubles<'_>, what: &str) -> PyResult<Arc<[DAffine3]>> {
    match array.shape() {
        [_, 4, 4] => Ok(contiguous(array, what)?.chunks_exact(16).map(affine_from_rows).collect()),
        shape => Err(bad_value(format!("{what} must have shape (n, 4, 4), not {shape:?}"))),
    }
}
