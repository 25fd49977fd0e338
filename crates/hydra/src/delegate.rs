//! The render delegate's own calls: settings, figures, messages, pausing, frames.

use std::sync::Arc;

use umber_render::{AOVS, Severity};
use umber_scene::{CameraId, SceneEdit};
use umber_settings::{TABLE, Value};

use crate::bridge::ffi;
use crate::buffer::hydra_format;
use crate::camera::{camera_of_matrices, conform_policy};
use crate::frame::{film, purposes};
use crate::guard::{Outcome, guard, guard_refusal};
use crate::host::Host;

/// One `HdRenderDelegate`.
pub struct Delegate {
    host: Arc<Host>,
}

/// Stands for a camera that the host describes by matrices alone: no prim can have this path.
const MATRIX_CAMERA: &str = "HdRenderPassState";

pub fn new_delegate() -> Outcome<Box<Delegate>> {
    guard(|| Box::new(Delegate { host: Arc::default() }))
}

pub fn setting_rows() -> Outcome<Vec<ffi::NamedValue>> {
    guard(|| TABLE.iter().map(|row| named(row.key, row.label, &row.default)).collect())
}

pub fn aov_rows() -> Outcome<Vec<ffi::AovDescription>> {
    let description = |row: &umber_render::AovRow| ffi::AovDescription {
        name: row.name.to_owned(),
        format: hydra_format(row.format),
        clear: row.clear,
    };
    guard(|| AOVS.iter().map(description).collect())
}

fn named(name: &str, label: &str, value: &Value) -> ffi::NamedValue {
    let kind = ffi::ValueKind::Bool;
    let mut out = ffi::Value { kind, bool_value: false, int_value: 0, float_value: 0.0, text_value: String::new() };
    match value {
        Value::Bool(v) => out.bool_value = *v,
        Value::Int(v) => (out.kind, out.int_value) = (ffi::ValueKind::Int, *v),
        Value::Float(v) => (out.kind, out.float_value) = (ffi::ValueKind::Float, *v),
        Value::Text(v) => (out.kind, out.text_value) = (ffi::ValueKind::Text, v.clone()),
    }
    ffi::NamedValue { name: name.to_owned(), label: label.to_owned(), value: out }
}

impl Delegate {
    /// What the delegate's prims share.
    pub fn host(&self) -> Arc<Host> {
        Arc::clone(&self.host)
    }

    pub fn set_setting(&self, key: &str, value: &ffi::Value) -> Outcome<bool> {
        if !TABLE.iter().any(|row| row.key == key) {
            return Ok(false);
        }
        let value = match value.kind {
            ffi::ValueKind::Bool => Value::Bool(value.bool_value),
            ffi::ValueKind::Int => Value::Int(value.int_value),
            ffi::ValueKind::Text => Value::Text(value.text_value.clone()),
            _ => Value::Float(value.float_value),
        };
        guard_refusal(|| self.host.edit(SceneEdit::Setting(key.to_owned(), value)))?;
        Ok(true)
    }

    pub fn stats(&self) -> Outcome<Vec<ffi::NamedValue>> {
        guard(|| self.host.session().stats().rows().iter().map(|(name, value)| named(name, "", value)).collect())
    }

    pub fn take_reports(&self) -> Outcome<Vec<ffi::Report>> {
        let report =
            |m: umber_render::Message| ffi::Report { is_error: m.severity == Severity::Error, text: m.to_string() };
        guard(|| self.host.take_messages().into_iter().map(report).collect())
    }

    pub fn set_paused(&self, paused: bool) -> Outcome {
        guard(|| self.host.session().set_paused(paused))
    }

    pub fn is_paused(&self) -> Outcome<bool> {
        guard(|| self.host.session().is_paused())
    }

    pub fn stop(&self) -> Outcome {
        guard(|| self.host.stop())
    }

    pub fn is_stopped(&self) -> Outcome<bool> {
        guard(|| self.host.is_stopped())
    }

    pub fn restart(&self) -> Outcome {
        guard(|| self.host.restart())
    }

    pub fn is_converged(&self) -> Outcome<bool> {
        guard(|| self.host.session().is_converged())
    }

    pub fn look_by_matrices(
        &self,
        world_to_view: &[f64; 16],
        projection: &[f64; 16],
        policy: ffi::WindowPolicy,
    ) -> Outcome {
        guard_refusal(|| {
            let id = CameraId::new(MATRIX_CAMERA);
            let camera = camera_of_matrices(world_to_view, projection, conform_policy(policy));
            self.host.edit(SceneEdit::Camera(id.clone(), camera))?;
            self.host.edit(SceneEdit::RenderCamera(id))
        })
    }

    pub fn render(&self, frame: &ffi::Frame) -> Outcome {
        if frame.aovs.is_empty() {
            return Ok(());
        }
        guard_refusal(|| {
            self.host.edit(SceneEdit::Purposes(purposes(&frame.render_tags)))?;
            self.host.render(film(frame));
            Ok::<_, umber_settings::SettingError>(())
        })
    }
}
