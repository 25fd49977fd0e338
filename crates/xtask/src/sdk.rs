//! `cargo xtask sdk`: an OpenUSD with imaging, without building OpenUSD.
//!
//! Blender as a Python module (the wheel `bpy`) carries a whole OpenUSD in one library, with its Python
//! modules, but no headers. Those come from a source tree of the same version. Both together stand in
//! the per-user cache like an installation:
//!
//! ```text
//! openusd-25.08/
//!     include/    headers, two of them generated
//!     venv/       Python environment with the wheel: libraries, Python modules, Blender
//!     sdk.json    what it was made from; written last
//! ```

mod headers;
mod versions;

use std::{
    fs,
    path::{Path, PathBuf},
    process::ExitCode,
};

use anyhow::{Context, Result, ensure};
use serde::{Deserialize, Serialize};

use crate::{
    process,
    python::{self, Venv},
    usd::HOST_REQUIREMENTS,
    workspace,
};
use versions::Version;

/// Arguments of `cargo xtask sdk`.
#[derive(clap::Args)]
pub struct Arguments {
    /// An OpenUSD source tree of that version: the folder that holds `pxr`.
    #[arg(long, value_name = "DIR")]
    headers: PathBuf,
    /// Version of OpenUSD.
    #[arg(long, default_value = "25.08", value_parser = versions::parse)]
    usd_version: &'static Version,
}

/// What an SDK was made from.
#[derive(Serialize, Deserialize, PartialEq, Eq, Debug)]
struct Manifest {
    usd: String,
    bpy: String,
    python: String,
}

/// An SDK in the cache.
pub struct Sdk {
    root: PathBuf,
    version: &'static Version,
}

impl Sdk {
    /// The newest whole SDK of the cache.
    ///
    /// # Errors
    /// There is no place for a cache.
    pub fn newest() -> Result<Option<Self>> {
        let cache = workspace::cache()?;
        let places = versions::TABLE.iter().map(|version| Self { root: place(&cache, version), version });
        Ok(places.into_iter().find(Self::is_whole))
    }

    /// Folder of the headers.
    pub fn include(&self) -> PathBuf {
        self.root.join("include")
    }

    /// Folder of the libraries.
    pub fn library_dir(&self) -> PathBuf {
        self.site_packages().join("bpy/lib")
    }

    /// Folder of the Python package `pxr`.
    pub fn python_path(&self) -> PathBuf {
        let blender = self.version.blender();
        self.site_packages().join(format!("bpy/{blender}/python/lib/python{}/site-packages", self.version.python))
    }

    /// Its Python environment.
    pub fn venv(&self) -> Venv {
        Venv::at(self.root.join("venv"))
    }

    /// MaterialX's standard library, for `PXR_MTLX_STDLIB_SEARCH_PATHS`.
    pub fn materialx_library(&self) -> PathBuf {
        self.library_dir().join("materialx/libraries")
    }

    fn site_packages(&self) -> PathBuf {
        self.root.join(format!("venv/lib/python{}/site-packages", self.version.python))
    }

    fn is_whole(&self) -> bool {
        let manifest = fs::read(self.root.join("sdk.json")).ok().and_then(|text| serde_json::from_slice(&text).ok());
        manifest == Some(self.version.manifest()) && self.venv().python().exists() && self.library_dir().is_dir()
    }
}

/// Runs the command.
///
/// # Errors
/// The source tree is of another version, Python is missing, or a package cannot be had.
pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    let version = arguments.usd_version;
    let cache = workspace::cache()?;
    let sdk = Sdk { root: place(&cache, version), version };
    if sdk.is_whole() {
        println!("OpenUSD {} stands already: {}", version.usd, sdk.root.display());
        return Ok(ExitCode::SUCCESS);
    }
    let tree = headers::SourceTree::open(&arguments.headers, version)?;
    let python = python::interpreter(&[version.python])?;
    python::include(&python)?;

    fs::create_dir_all(&cache).with_context(|| cache.display().to_string())?;
    let draft = Sdk { root: cache.join(format!(".openusd-{}.{}", version.usd, std::process::id())), version };
    let made = assemble(&draft, &tree, &python).and_then(|()| put_in_place(&draft.root, &sdk.root));
    if made.is_err() {
        // What is left of the draft is of no use; that it may stay behind is not the error to report.
        let _ = fs::remove_dir_all(&draft.root);
    }
    made?;
    println!("OpenUSD {} (from bpy {}) is ready: {}", version.usd, version.bpy, sdk.root.display());
    Ok(ExitCode::SUCCESS)
}

/// Makes all of an SDK in its own folder.
fn assemble(sdk: &Sdk, tree: &headers::SourceTree, python: &Path) -> Result<()> {
    let version = sdk.version;
    let copied = tree.copy_headers(&sdk.include())?;
    println!("{copied} headers");
    let venv = sdk.venv();
    venv.create(python)?;
    println!("installing bpy {} (some 400 MB, once)", version.bpy);
    venv.install([format!("bpy=={}", version.bpy)])?;
    venv.require(HOST_REQUIREMENTS)?;
    let library = sdk.library_dir().join("libusd_ms.so");
    let namespace = version.internal_namespace();
    ensure!(
        headers::library_has_namespace(&library, &namespace)?,
        "{} does not use the namespace {namespace}: this wheel is another OpenUSD",
        library.display()
    );
    process::quiet(venv.command().env("PYTHONPATH", sdk.python_path()).args(["-c", "from pxr import UsdImagingGL"]))
        .context("the wheel's OpenUSD does not load here: it needs the X11 and OpenGL libraries of a desktop")?;
    tree.generate_headers(&sdk.include(), version)?;
    headers::add_tbb(&sdk.include(), &venv)?;
    let manifest = serde_json::to_string_pretty(&version.manifest())?;
    fs::write(sdk.root.join("sdk.json"), manifest + "\n").context("sdk.json")
}

/// Moves the finished `draft` to `place`, in the stead of what an earlier run left there.
fn put_in_place(draft: &Path, place: &Path) -> Result<()> {
    if place.exists() {
        let old = draft.with_extension("old");
        fs::rename(place, &old).with_context(|| place.display().to_string())?;
        fs::remove_dir_all(&old).with_context(|| old.display().to_string())?;
    }
    fs::rename(draft, place).with_context(|| place.display().to_string())
}

fn place(cache: &Path, version: &Version) -> PathBuf {
    cache.join(format!("openusd-{}", version.usd))
}
