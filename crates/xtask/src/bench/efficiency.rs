//! `cargo xtask bench efficiency`: error over time, beside Mitsuba 3 and Cycles where they can be had.

use std::{
    path::Path,
    process::{Command, ExitCode},
};

use anyhow::Result;

use super::{asks_for_help, commit};
use crate::{process, python::Venv, render, sdk::Sdk, workspace};

/// Versions of Python that Mitsuba and usd-core have packages for.
const PYTHONS: [&str; 3] = ["3.11", "3.12", "3.13"];

/// Measures with `tests/accuracy/efficiency/measure.py`, which gets the `words`, and draws the charts.
///
/// # Errors
/// Umber cannot be built, or a measure failed.
pub fn run(words: &[String], folder: &Path) -> Result<ExitCode> {
    let record = folder.join("efficiency_measured.json");
    let commit = commit()?;
    let mut measure = render::usd_core_venv()?.command();
    measure.arg("tests/accuracy/efficiency/measure.py").arg(&record).args(words).args(["--commit", &commit]);
    add_peers(&mut measure)?;
    process::run(measure.current_dir(workspace::root()))?;
    if !asks_for_help(words) {
        draw("efficiency", &record, folder)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Names the interpreters of the peers that can be had.
///
/// # Errors
/// There is no place for a cache.
pub fn add_peers(measure: &mut Command) -> Result<()> {
    // A peer that cannot be had takes no part; the measure says so.
    match Venv::in_target("mitsuba", &PYTHONS, "tests/accuracy/efficiency/requirements.txt") {
        Ok(mitsuba) => _ = measure.arg("--mitsuba").arg(mitsuba.python()),
        Err(error) => eprintln!("no Mitsuba: {error:#}"),
    }
    if let Some(sdk) = Sdk::newest()? {
        measure.arg("--cycles").arg(sdk.venv().python());
    }
    Ok(())
}

/// Draws the charts of a record under a name, into the folder and docs/charts.
///
/// # Errors
/// The record cannot be read, or a chart not be written.
pub fn draw(name: &str, record: &Path, folder: &Path) -> Result<()> {
    let mut cargo = process::cargo();
    cargo.args(["run", "--quiet", "--release", "--package", "umber-bench", "--", "efficiency"]).arg(record);
    cargo.args(["--name", name, "--out"]).arg(folder).args(["--out", "docs/charts"]);
    process::run(cargo.current_dir(workspace::root()))
}
