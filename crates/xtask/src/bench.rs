//! `cargo xtask bench`: measures beside other libraries and textbook methods, into target/bench and docs/charts.

use std::{
    fs,
    path::Path,
    process::{Command, ExitCode},
};

use anyhow::{Context, Result};

mod chapter;
mod efficiency;
mod report;

use crate::{process, render, workspace};

/// Stages whose triangles are measured, by the name that charts give them, from the folder of assets
/// beside the checkout. Those that are not there are left out.
const STAGES: [(&str, &str); 2] = [
    ("OpenChessSet", "usdwg/full_assets/OpenChessSet/chess_set_cam.usda"),
    ("dream_apartment", "gltf_cc/dream-apartment/dream-apartment_cam.usda"),
];

/// Arguments of `cargo xtask bench`.
#[derive(clap::Args)]
pub struct Arguments {
    /// What to measure, and flags, passed on: `rays [--rays N] [--rounds N] [--scene NAME]`, `stability [--rays N]`,
    /// `efficiency [--scene NAME ...] [--rounds N] [--samples N ...]`, `report [--scene NAME ...] [--rounds N]
    /// [--only scenes|parsimony|stability|document ...]`, `chapter [--pictures N]`. See `rays
    /// --help`.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, required = true, value_name = "WHAT FLAGS")]
    words: Vec<String>,
}

/// Runs the command.
///
/// # Errors
/// No Python for the stages that are there, or a measure failed.
pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    let folder = workspace::target().join("bench");
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    if arguments.words.first().is_some_and(|what| what == "efficiency") {
        return efficiency::run(&arguments.words[1..], &folder);
    }
    if arguments.words.first().is_some_and(|what| what == "report") {
        return report::run(&arguments.words[1..], &folder);
    }
    if arguments.words.first().is_some_and(|what| what == "stability") {
        stability(&arguments.words[1..], &folder)?;
        return Ok(ExitCode::SUCCESS);
    }
    if arguments.words.first().is_some_and(|what| what == "chapter") {
        return chapter::run(&arguments.words[1..], &folder);
    }
    let of_stages = arguments.words.first().is_some_and(|what| what == "rays");
    for (name, stage) in STAGES.into_iter().filter(|_| of_stages) {
        dump(&workspace::root().join("../shared/assets").join(stage), &folder.join(name).with_extension("tri"))?;
    }
    let dumps = if of_stages { vec!["--dumps".into(), folder.display().to_string()] } else { Vec::new() };
    measure(&[&arguments.words[..], &dumps].concat(), &folder)?;
    Ok(ExitCode::SUCCESS)
}

/// Whether a measure prints how to call it, and nothing is measured.
fn asks_for_help(words: &[String]) -> bool {
    words.iter().any(|word| word == "--help" || word == "-h")
}

/// Counts the failures of rays and samples, and draws their charts.
fn stability(words: &[String], folder: &Path) -> Result<()> {
    measure(&[&["stability".to_string()], words].concat(), folder)
}

/// Calls the benchmarks in Rust.
fn measure(words: &[String], folder: &Path) -> Result<()> {
    let mut cargo = process::cargo();
    cargo.args(["run", "--quiet", "--release", "--package", "umber-bench", "--"]).args(words);
    cargo.arg("--out").arg(folder).args(["--out", "docs/charts", "--commit", &commit()?]);
    process::run(cargo.current_dir(workspace::root()))
}

/// Dumps the triangles of a stage, once.
fn dump(stage: &Path, out: &Path) -> Result<()> {
    if !stage.exists() {
        println!("not measured, for want of it: {}", stage.display());
        return Ok(());
    }
    if out.exists() {
        return Ok(());
    }
    // Under another name until it is whole.
    let part = out.with_extension("part");
    let script = workspace::root().join("crates/bench/dump_triangles.py");
    process::quiet(render::tools_venv()?.command().arg(script).arg(stage).arg(&part))?;
    fs::rename(&part, out).with_context(|| out.display().to_string())
}

/// The commit that is checked out.
fn commit() -> Result<String> {
    let mut git = Command::new("git");
    git.args(["describe", "--always", "--dirty"]).current_dir(workspace::root());
    Ok(process::quiet(&mut git)?.trim().to_string())
}
