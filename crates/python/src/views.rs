//! Pictures: from the film to numpy arrays, and to the one file format that no Python package writes.

use std::fs::File;
use std::io::BufWriter;

use numpy::ndarray::Array3;
use numpy::{IntoPyArray, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use umber_render::Aov;

use crate::arrays::bad_value;

/// An AOV by its token.
pub fn aov(name: &str) -> PyResult<Aov> {
    Aov::from_name(name).ok_or_else(|| {
        let known: Vec<&str> = umber_render::AOVS.iter().map(|row| row.name).collect();
        bad_value(format!("unknown AOV '{name}' (known: {})", known.join(", ")))
    })
}

/// A picture of `rows` from the lowest up as an array of shape (height, width, components) from the
/// highest down.
fn picture<'py, T>(py: Python<'py>, rows: &[T], [height, width, components]: [usize; 3]) -> PyResult<Bound<'py, PyAny>>
where
    T: numpy::Element + Clone,
{
    let mut from_top = Vec::with_capacity(rows.len());
    rows.chunks_exact((width * components).max(1)).rev().for_each(|row| from_top.extend_from_slice(row));
    let array = Array3::from_shape_vec([height, width, components], from_top).map_err(|e| bad_value(e.to_string()))?;
    Ok(array.into_pyarray(py).into_any())
}

/// An AOV as it stands: float32 or int32, shape (height, width, components), row 0 at the top.
pub fn resolve<'py>(
    py: Python<'py>,
    session: &umber_render::Session,
    name: &str,
    [width, height]: [usize; 2],
) -> PyResult<Bound<'py, PyAny>> {
    let aov = aov(name)?;
    let format = aov.row().format;
    let shape = [height, width, format.components()];
    let missing = || bad_value(format!("the film does not keep the AOV '{name}'"));
    if format.is_integer() {
        let mut rows = vec![0i32; shape.iter().product()];
        let kept = session.resolve(aov, format, bytemuck::cast_slice_mut(&mut rows));
        return if kept { picture(py, &rows, shape) } else { Err(missing()) };
    }
    let mut rows = vec![0f32; shape.iter().product()];
    let kept = session.resolve(aov, format, bytemuck::cast_slice_mut(&mut rows));
    if kept { picture(py, &rows, shape) } else { Err(missing()) }
}

/// Writes a Radiance HDR file. `pixels`: float32, shape (height, width, 3), row 0 at the top.
#[pyfunction]
pub fn write_hdr(path: &str, pixels: PyReadonlyArray3<'_, f32>) -> PyResult<()> {
    let (height, width) = match pixels.shape() {
        [height, width, 3] => (*height, *width),
        shape => return Err(bad_value(format!("pixels must have shape (height, width, 3), not {shape:?}"))),
    };
    let samples = pixels.as_slice().map_err(|_| bad_value("pixels must be C-contiguous"))?;
    let rgb: Vec<image::Rgb<f32>> = samples.chunks_exact(3).map(|c| image::Rgb([c[0], c[1], c[2]])).collect();
    let file = BufWriter::new(File::create(path)?);
    image::codecs::hdr::HdrEncoder::new(file)
        .encode(&rgb, width, height)
        .map_err(|error| PyOSError::new_err(error.to_string()))
}
