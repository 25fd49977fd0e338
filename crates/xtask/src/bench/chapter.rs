//! `cargo xtask bench chapter`: the rasteriser and the mirror beside textbook methods in Python, and on the chess set.

use std::{path::Path, process::ExitCode};

use anyhow::Result;

use super::commit;
use crate::{process, render, workspace};

/// Measures with `tests/accuracy/chapter/measure.py`, which gets the `words`.
///
/// # Errors
/// Umber cannot be built, or the measure failed.
pub fn run(words: &[String], folder: &Path) -> Result<ExitCode> {
    let mut measure = render::usd_core_venv()?.command();
    measure.arg("tests/accuracy/chapter/measure.py").arg(folder).arg("docs/charts").args(words);
    measure.args(["--commit", &commit()?]);
    process::run(measure.current_dir(workspace::root()))?;
    Ok(ExitCode::SUCCESS)
}
