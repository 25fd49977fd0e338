//! `cargo xtask bench report`: docs/speed-and-accuracy.md with all that it shows.

use std::{path::Path, process::ExitCode};

use anyhow::Result;

use super::{asks_for_help, commit, efficiency, stability};
use crate::{process, render, workspace};

/// Rays at each point of the stability charts: a fifth of what `bench stability` takes.
const RAYS: &str = "200000";
/// The record that is kept, with what earlier runs measured.
const KNOWN: &str = "docs/charts/report.json";

/// Measures with `tests/accuracy/efficiency/report.py`, which gets the `words`; counts the failures of rays; draws the
/// charts and writes the document. `--only document` draws and writes from what is known, without measuring.
///
/// # Errors
/// Umber cannot be built, or a measure failed.
pub fn run(words: &[String], folder: &Path) -> Result<ExitCode> {
    let record = folder.join("report_measured.json");
    let commit = commit()?;
    let venv = render::usd_core_venv()?;
    let only = parts(words);
    let wants = |part: &str| only.is_empty() || only.contains(&part);
    if wants("scenes") || wants("parsimony") {
        let mut measure = venv.command();
        measure.arg("tests/accuracy/efficiency/report.py").arg(&record).args(words);
        measure.args(["--commit", &commit, "--known", KNOWN]);
        efficiency::add_peers(&mut measure)?;
        process::run(measure.current_dir(workspace::root()))?;
        if asks_for_help(words) {
            return Ok(ExitCode::SUCCESS);
        }
        efficiency::draw("report", &record, folder)?;
    } else {
        efficiency::draw("report", &workspace::root().join(KNOWN), folder)?;
    }
    // Part of a report leaves out what takes all scenes.
    if wants("stability") && !words.iter().any(|word| word == "--scene") {
        stability(&["--rays".into(), RAYS.into()], folder)?;
    }
    let mut document = venv.command();
    document.args(["tests/accuracy/efficiency/document.py", "docs/charts", "docs/speed-and-accuracy.md"]);
    process::run(document.current_dir(workspace::root()))?;
    Ok(ExitCode::SUCCESS)
}

/// What stands after `--only`; nothing: all.
fn parts(words: &[String]) -> Vec<&str> {
    let after = words.iter().skip_while(|word| *word != "--only").skip(1);
    after.map(String::as_str).take_while(|word| !word.starts_with("--")).collect()
}

#[cfg(test)]
mod tests {
    use super::parts;

    fn parts_of(line: &str) -> Vec<String> {
        let words: Vec<String> = line.split_whitespace().map(String::from).collect();
        parts(&words).into_iter().map(String::from).collect()
    }

    #[test]
    fn parts_are_what_stands_after_the_flag() {
        assert_eq!(parts_of("--rounds 3"), Vec::<String>::new());
        assert_eq!(parts_of("--only stability"), ["stability"]);
        assert_eq!(parts_of("--scene chess --only scenes parsimony --rounds 3"), ["scenes", "parsimony"]);
    }
}
