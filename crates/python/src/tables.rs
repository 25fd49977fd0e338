//! The tables of settings and AOVs, and setting values, in Python's types.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use umber_settings::Value;

/// A value in its Python type.
pub fn value_to_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::Bool(v) => v.into_pyobject(py)?.to_owned().into_any(),
        Value::Int(v) => v.into_pyobject(py)?.into_any(),
        Value::Float(v) => v.into_pyobject(py)?.into_any(),
        Value::Text(v) => v.into_pyobject(py)?.into_any(),
    })
}

/// Rows of the settings table: dicts with key, default, range, choices, label and doc.
#[pyfunction]
pub fn settings(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let row = |setting: &umber_settings::Setting| {
        let dict = PyDict::new(py);
        dict.set_item("key", setting.key)?;
        dict.set_item("default", value_to_python(py, &setting.default)?)?;
        dict.set_item("range", setting.range)?;
        dict.set_item("choices", setting.choices)?;
        dict.set_item("label", setting.label)?;
        dict.set_item("doc", setting.doc)?;
        Ok(dict)
    };
    umber_settings::TABLE.iter().map(row).collect()
}

/// Rows of the AOV table: dicts with name, components, integer and clear.
#[pyfunction]
pub fn aovs(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let row = |aov: &umber_render::AovRow| {
        let dict = PyDict::new(py);
        dict.set_item("name", aov.name)?;
        dict.set_item("components", aov.format.components())?;
        dict.set_item("integer", aov.format.is_integer())?;
        dict.set_item("clear", aov.clear)?;
        Ok(dict)
    };
    umber_render::AOVS.iter().map(row).collect()
}
