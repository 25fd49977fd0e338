//! Python module `umber._umber`: the render session, fed with numpy arrays.
//!
//! Thin on purpose. What is in a stage is read in Python (package `umber.stage_reader`); here its
//! descriptions become [`umber_scene::SceneEdit`]s, and finished pictures become arrays.

mod arrays;
mod light_apis;
mod lights;
mod mesh;
mod session;
mod tables;
mod views;

use pyo3::prelude::*;

/// The module's contents.
#[pymodule]
fn _umber(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<session::Session>()?;
    module.add_function(wrap_pyfunction!(tables::settings, module)?)?;
    module.add_function(wrap_pyfunction!(tables::aovs, module)?)?;
    module.add_function(wrap_pyfunction!(views::write_hdr, module)?)?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))
}
