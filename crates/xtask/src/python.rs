//! Python interpreters and virtual environments.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use anyhow::{Context, Result, ensure};

use crate::{process, workspace};

/// An interpreter on the search path of one of the versions `major.minor`, by its full path.
///
/// # Errors
/// There is none.
pub fn interpreter(versions: &[&str]) -> Result<PathBuf> {
    let own = versions.iter().map(|version| format!("python{version}"));
    let found = ["python3".into(), "python".into()].into_iter().chain(own).find_map(|name: String| {
        let ask = "import sys; print('%d.%d' % sys.version_info[:2]); print(sys.executable)";
        let said = process::quiet(Command::new(name).args(["-c", ask])).ok()?;
        let (has, path) = said.trim().split_once('\n')?;
        versions.contains(&has).then(|| PathBuf::from(path))
    });
    found.with_context(|| {
        let versions = versions.join(" or ");
        format!("Python {versions} is needed and not on the search path: install it (with its headers and venv).")
    })
}

/// Folder of the headers of the interpreter `python`.
///
/// # Errors
/// The headers are not installed.
pub fn include(python: &Path) -> Result<PathBuf> {
    let ask = "import sysconfig; print(sysconfig.get_path('include'))";
    let dir = PathBuf::from(process::quiet(Command::new(python).args(["-c", ask]))?.trim());
    ensure!(
        dir.join("Python.h").exists(),
        "the headers of {} are missing (no Python.h in {}): install its development package.",
        python.display(),
        dir.display()
    );
    Ok(dir)
}

/// A virtual environment.
pub struct Venv {
    dir: PathBuf,
}

impl Venv {
    /// The environment in `dir`, whether or not it stands already.
    pub fn at(dir: PathBuf) -> Self {
        Self { dir }
    }

    /// An environment `name` of the target folder, made with an interpreter of one of the `versions`, that holds what
    /// the file `requirements` (from the repository's root) pins.
    ///
    /// # Errors
    /// No such interpreter, or an installation failed.
    pub fn in_target(name: &str, versions: &[&str], requirements: &str) -> Result<Self> {
        let venv = Self::at(workspace::target().join("venv").join(name));
        if !venv.python().exists() {
            venv.create(&interpreter(versions)?)?;
        }
        venv.require(requirements)?;
        Ok(venv)
    }

    /// Its folder.
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// Its interpreter.
    pub fn python(&self) -> PathBuf {
        self.dir.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" })
    }

    /// A command for its interpreter, untouched by another Python that the user's shell is set up for.
    pub fn command(&self) -> Command {
        let mut command = Command::new(self.python());
        command.env("VIRTUAL_ENV", &self.dir).env_remove("PYTHONPATH").env_remove("PYTHONHOME");
        command
    }

    /// Makes it, anew if it stands.
    ///
    /// # Errors
    /// The interpreter cannot make environments.
    pub fn create(&self, python: &Path) -> Result<()> {
        eprintln!("python environment {}", self.dir.display());
        process::quiet(Command::new(python).args(["-m", "venv", "--clear"]).arg(&self.dir))?;
        Ok(())
    }

    /// Installs with pip.
    ///
    /// # Errors
    /// A package cannot be had.
    pub fn install<S: AsRef<std::ffi::OsStr>>(&self, arguments: impl IntoIterator<Item = S>) -> Result<()> {
        let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-input"];
        process::quiet(self.command().args(pip).args(arguments))?;
        Ok(())
    }

    /// Sees to it that what the file `requirements` pins is installed.
    ///
    /// # Errors
    /// The file cannot be read or a package cannot be had.
    pub fn require(&self, requirements: &str) -> Result<()> {
        let file = workspace::root().join(requirements);
        let wanted = fs::read_to_string(&file).with_context(|| file.display().to_string())?;
        self.once("requirements", &wanted, || self.install([Path::new("--requirement"), &file]))
    }

    /// Does `work` unless it was done here before for the same `state`.
    ///
    /// # Errors
    /// Those of `work`, and where the state cannot be noted.
    pub fn once(&self, name: &str, state: &str, work: impl FnOnce() -> Result<()>) -> Result<()> {
        workspace::once(&self.dir.join(format!("umber-{name}.done")), state, work)
    }
}
