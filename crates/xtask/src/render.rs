//! `cargo xtask render`: a picture of a stage, through any of the hosts.

use std::{
    path::PathBuf,
    process::{Command, ExitCode},
};

use anyhow::{Context, Result, ensure};
use clap::ValueEnum;

use crate::{
    hydra, process,
    python::Venv,
    usd::{self, UsdBuild},
    workspace,
};

/// Arguments of `cargo xtask render`.
#[derive(clap::Args)]
pub struct Arguments {
    /// STAGE OUT and flags, passed on: those of usdrecord, --imageHeight N, --set KEY=VALUE, --aovs A,B, --stats;
    /// and --host usd-core, hydra or blender.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, required = true, value_name = "STAGE OUT FLAGS")]
    words: Vec<String>,
}

/// Who reads the stage and asks for the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Host {
    /// The Python front end, without Hydra.
    UsdCore,
    /// OpenUSD's own recorder, with the delegate.
    Hydra,
    /// Blender, with the delegate.
    Blender,
}

/// Exit code for arguments that make no sense.
const BAD_ARGUMENTS: u8 = 2;

/// Runs the command. The exit code is the host's: 0 done, 1 no picture, 2 bad arguments.
///
/// # Errors
/// Something that the host needs cannot be set up.
pub fn run(arguments: Arguments) -> Result<ExitCode> {
    let (host, words) = match take_host(arguments.words) {
        Ok(taken) => taken,
        Err(what) => {
            eprintln!("{what}");
            return Ok(ExitCode::from(BAD_ARGUMENTS));
        }
    };
    let Some(mut command) = (match host {
        Host::UsdCore => Some(usd_core()?),
        Host::Hydra | Host::Blender => delegate_host(host)?,
    }) else {
        eprintln!("{}", usd::MISSING);
        return Ok(ExitCode::FAILURE);
    };
    let code = process::status(command.args(words))?;
    Ok(ExitCode::from(u8::try_from(code).unwrap_or(1)))
}

/// The host that `--host` names, wherever it stands, and the other words.
fn take_host(words: Vec<String>) -> Result<(Host, Vec<String>), String> {
    let (mut host, mut rest) = (Host::UsdCore, Vec::new());
    let mut words = words.into_iter();
    while let Some(word) = words.next() {
        let named = match word.strip_prefix("--host") {
            Some("") => words.next().ok_or("--host: usd-core, hydra or blender")?,
            Some(value) if value.starts_with('=') => value[1..].to_string(),
            _ => {
                rest.push(word);
                continue;
            }
        };
        host = Host::from_str(&named, false).map_err(|_| format!("--host {named}: usd-core, hydra or blender"))?;
    }
    Ok((host, rest))
}

/// The Python front end's command line.
fn usd_core() -> Result<Command> {
    let mut command = usd_core_venv()?.command();
    command.args(["-m", "umber", "record"]);
    Ok(command)
}

/// The environment of the usd-core front end, with the package built from the sources as they are.
///
/// # Errors
/// No Python, a package that cannot be had, or sources that do not compile.
pub fn usd_core_venv() -> Result<Venv> {
    let venv = tools_venv()?;
    venv.once("package", &workspace::sources_state()?, || {
        eprintln!("building the Python package");
        let wheels = workspace::target().join("wheels");
        let manifest = workspace::root().join("crates/python/Cargo.toml");
        let mut build = venv.command();
        build.args(["-m", "maturin", "build", "--release", "--quiet", "--manifest-path"]).arg(manifest);
        build.arg("--interpreter").arg(venv.python());
        process::quiet(build.arg("--out").arg(&wheels))?;
        let wheel = newest(&wheels)?;
        venv.install([PathBuf::from("--force-reinstall"), "--no-deps".into(), wheel])
    })?;
    Ok(venv)
}

/// Versions of Python that usd-core and all that is pinned beside it have packages for.
const PYTHONS: [&str; 3] = ["3.11", "3.12", "3.13"];

/// The environment of the usd-core front end as the package index gives it: its tools, without our package.
///
/// # Errors
/// No Python, or a package that cannot be had.
pub fn tools_venv() -> Result<Venv> {
    Venv::in_target("usd-core", &PYTHONS, "tests/requirements.txt")
}

/// The wheel built last.
fn newest(wheels: &std::path::Path) -> Result<PathBuf> {
    let entries = std::fs::read_dir(wheels).with_context(|| wheels.display().to_string())?;
    let dated = entries.flatten().filter_map(|entry| Some((entry.metadata().ok()?.modified().ok()?, entry.path())));
    let wheels = dated.filter(|(_, path)| path.extension().is_some_and(|kind| kind == "whl"));
    Ok(wheels.max().context("maturin built no wheel")?.1)
}

/// The driver script of a host that loads the delegate; none where there is no OpenUSD with imaging.
fn delegate_host(host: Host) -> Result<Option<Command>> {
    let Some(usd) = UsdBuild::find()? else { return Ok(None) };
    ensure!(
        host != Host::Blender || usd.sdk.is_some(),
        "PXR_USD_ROOT names an OpenUSD without Blender: unset it to render in the Blender of `cargo xtask sdk`."
    );
    let plugins = hydra::build(&usd)?;
    let mut command = hydra::host_command(&usd, &plugins)?;
    let script = if host == Host::Blender { "blender_render.py" } else { "hydra_record.py" };
    command.arg(workspace::root().join("tests/hosts").join(script));
    Ok(Some(command))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taken(words: &[&str]) -> Result<(Host, Vec<String>), String> {
        take_host(words.iter().map(ToString::to_string).collect())
    }

    #[test]
    fn host_may_stand_anywhere() {
        assert_eq!(taken(&["a", "b"]).unwrap(), (Host::UsdCore, vec!["a".into(), "b".into()]));
        assert_eq!(taken(&["a", "--host", "hydra", "-w", "8"]).unwrap().0, Host::Hydra);
        assert_eq!(taken(&["--host=blender", "a"]).unwrap(), (Host::Blender, vec!["a".into()]));
    }

    #[test]
    fn unknown_host_is_named() {
        assert!(taken(&["--host", "maya"]).unwrap_err().contains("maya"));
        assert!(taken(&["a", "--host"]).is_err());
        assert_eq!(taken(&["--hosts", "a"]).unwrap().1.len(), 2);
    }
}
