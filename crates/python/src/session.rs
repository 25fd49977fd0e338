//! The class `Session`.

use std::sync::Mutex;
use std::time::Duration;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use umber_render::{FilmDesc, Severity};
use umber_scene::SceneEdit;
use umber_settings::{SettingError, Settings};

use crate::arrays::bad_value;
use crate::lights::{PyCamera, PyLight, PyMaterial};
use crate::mesh::{PyInstancer, PyMesh, purpose};
use crate::tables::value_to_python;
use crate::views;

/// A scene, its film and the thread that renders it.
///
/// Edits take the dataclasses of `umber.description`. Transforms are float64 of shape (4, 4) in
/// USD's layout: row vectors, translation in the last row.
#[pyclass(frozen, module = "umber._umber")]
pub struct Session {
    render: umber_render::Session,
    /// Width and height of the film, pixels.
    size: Mutex<[usize; 2]>,
}

fn setting_error(error: &SettingError) -> PyErr {
    bad_value(error.to_string())
}

impl Session {
    fn apply(&self, edit: SceneEdit) -> PyResult<bool> {
        self.render.edit(edit).map_err(|error| setting_error(&error))
    }
    fn size(&self) -> [usize; 2] {
        *self.size.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

#[pymethods]
impl Session {
    #[new]
    fn new() -> Self {
        Self { render: umber_render::Session::new(), size: Mutex::new([0, 0]) }
    }

    /// Inserts or replaces a mesh. True where that changes the picture, as for all edits.
    fn mesh(&self, mesh: PyMesh<'_>) -> PyResult<bool> {
        self.apply(mesh.edit()?)
    }

    /// Inserts or replaces an instancer.
    fn instancer(&self, instancer: PyInstancer<'_>) -> PyResult<bool> {
        self.apply(instancer.edit()?)
    }

    /// Inserts or replaces a light.
    fn light(&self, light: PyLight<'_>) -> PyResult<bool> {
        self.apply(light.edit()?)
    }

    /// Inserts or replaces a material.
    fn material(&self, material: PyMaterial) -> PyResult<bool> {
        self.apply(material.edit()?)
    }

    /// Inserts or replaces a camera and looks through it.
    fn camera(&self, camera: PyCamera<'_>) -> PyResult<bool> {
        let [insert, look] = camera.edits()?;
        Ok(self.apply(insert)? | self.apply(look)?)
    }

    /// Names the purposes that are shown, beside the default purpose.
    fn purposes(&self, names: Vec<String>) -> PyResult<bool> {
        let shown = names.iter().map(|name| purpose(name)).collect::<PyResult<_>>()?;
        self.apply(SceneEdit::Purposes(shown))
    }

    /// Sets a row of the settings table from text. `ValueError` says what is wrong with it.
    fn set(&self, key: &str, text: &str) -> PyResult<bool> {
        let mut parsed = Settings::default();
        parsed.set_from_text(key, text).map_err(|error| setting_error(&error))?;
        match parsed.get(key) {
            Some(value) => self.apply(SceneEdit::Setting(key.to_owned(), value)),
            None => Ok(false),
        }
    }

    /// Sets size and content of the picture. True where it is another one than before.
    fn set_film(&self, width: usize, height: usize, aovs: Vec<String>) -> PyResult<bool> {
        let aovs = aovs.iter().map(|name| views::aov(name)).collect::<PyResult<Vec<_>>>()?;
        *self.size.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = [width, height];
        Ok(self.render.set_film(FilmDesc::new(width, height, &aovs)))
    }

    /// Renders on; returns at once.
    fn start(&self) {
        self.render.start();
    }

    /// Stops and waits until no thread renders. The film keeps its samples.
    fn stop(&self, py: Python<'_>) {
        py.detach(|| self.render.stop());
    }

    /// Waits until the picture is finished or `seconds` are over. True where it is finished.
    fn wait(&self, py: Python<'_>, seconds: f64) -> PyResult<bool> {
        let time = Duration::try_from_secs_f64(seconds).map_err(|error| bad_value(error.to_string()))?;
        Ok(py.detach(|| self.render.wait(time)))
    }

    /// Whether the picture of everything said so far is finished.
    fn is_converged(&self) -> bool {
        self.render.is_converged()
    }

    /// An AOV as it stands: float32 or int32, shape (height, width, components), row 0 at the top.
    fn resolve<'py>(&self, py: Python<'py>, aov: &str) -> PyResult<Bound<'py, PyAny>> {
        views::resolve(py, &self.render, aov, self.size())
    }

    /// How far it is and what it costs, by Hydra's names.
    fn stats<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (name, value) in self.render.stats().rows() {
            dict.set_item(name, value_to_python(py, &value)?)?;
        }
        Ok(dict)
    }

    /// Warnings and errors since the last call: (whether it is an error, text naming the prim).
    fn messages(&self) -> Vec<(bool, String)> {
        let text = |m: umber_render::Message| (m.severity == Severity::Error, m.to_string());
        self.render.take_messages().into_iter().map(text).collect()
    }
}
