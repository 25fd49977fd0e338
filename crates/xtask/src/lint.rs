//! `cargo xtask lint`: everything that is checked without running the renderer.

mod order;

use std::process::{Command, ExitCode};

use anyhow::{Result, bail};

use crate::{hydra, process, render, usd::UsdBuild, workspace};

type Check = fn() -> Result<()>;

/// Runs the command: all checks, then says which failed.
///
/// # Errors
/// None: a check that cannot run has failed.
pub fn run() -> Result<ExitCode> {
    let checks: [(&str, Check); 6] = [
        ("crate order", order::check),
        ("formatting", formatting),
        ("clippy", clippy),
        ("documentation", documentation),
        ("C++", cpp),
        ("Python", python),
    ];
    let mut failed = Vec::new();
    for (name, check) in checks {
        println!("{name}");
        if let Err(error) = check() {
            eprintln!("{error:#}");
            failed.push(name);
        }
    }
    if failed.is_empty() {
        println!("all checks passed");
        return Ok(ExitCode::SUCCESS);
    }
    println!("failed: {}", failed.join(", "));
    Ok(ExitCode::FAILURE)
}

fn cargo(arguments: &[&str]) -> Command {
    let mut command = process::cargo();
    command.args(arguments).current_dir(workspace::root());
    command
}

fn formatting() -> Result<()> {
    process::run(&mut cargo(&["fmt", "--all", "--check"]))
}

fn clippy() -> Result<()> {
    process::run(&mut cargo(&[
        "clippy",
        "--quiet",
        "--keep-going",
        "--workspace",
        "--all-targets",
        "--",
        "-D",
        "warnings",
    ]))
}

fn documentation() -> Result<()> {
    process::run(cargo(&["doc", "--quiet", "--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings"))
}

/// The shim compiles with warnings as errors: building the delegate is the check.
fn cpp() -> Result<()> {
    match UsdBuild::find()? {
        Some(usd) => hydra::build(&usd).and_then(|plugins| hydra::host_command(&usd, &plugins)).map(drop),
        None => {
            println!("  not checked, for want of an OpenUSD with imaging");
            Ok(())
        }
    }
}

fn python() -> Result<()> {
    let venv = render::tools_venv()?;
    for arguments in [["check", "--quiet"].as_slice(), &["format", "--check", "--quiet"]] {
        let mut ruff = venv.command();
        ruff.args(["-m", "ruff"])
            .args(arguments)
            .args(["crates/python", "plugInfo", "tests"])
            .current_dir(workspace::root());
        if process::status(&mut ruff)? != 0 {
            bail!("ruff {} failed", arguments[0]);
        }
    }
    Ok(())
}
