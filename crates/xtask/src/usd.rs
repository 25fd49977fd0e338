//! The OpenUSD with imaging that the delegate is built for.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

use anyhow::{Context, Result, ensure};

use crate::{
    python::{self, Venv},
    sdk::Sdk,
};

/// What `cargo xtask` says where there is none.
pub const MISSING: &str = "No OpenUSD with imaging is found: the Hydra delegate needs its headers and libraries.
Either name an installation: PXR_USD_ROOT=<the prefix that holds its include/ and lib/>,
or assemble one: cargo xtask sdk --headers <an OpenUSD source tree, version 25.08>";

/// Packages that the host tests and drivers need beside OpenUSD.
pub const HOST_REQUIREMENTS: &str = "tests/hosts/requirements.txt";

/// An OpenUSD with imaging: headers, libraries and Python modules.
pub struct UsdBuild {
    /// Include folders: OpenUSD, Python, TBB.
    pub include: Vec<PathBuf>,
    /// Folder of the libraries.
    pub library_dir: PathBuf,
    /// Names to link, as `-l` takes them.
    pub libraries: Vec<String>,
    /// Folder of the Python package `pxr`.
    pub python_path: PathBuf,
    /// The assembled SDK, where it is one: Blender comes with it.
    pub sdk: Option<Sdk>,
}

impl UsdBuild {
    /// `PXR_USD_ROOT`'s, or else the newest SDK of the cache; none where there is neither.
    ///
    /// # Errors
    /// `PXR_USD_ROOT` is set but names no OpenUSD, or Python headers are missing.
    pub fn find() -> Result<Option<Self>> {
        match env::var_os("PXR_USD_ROOT").filter(|value| !value.is_empty()) {
            Some(prefix) => Self::from_prefix(Path::new(&prefix)).map(Some),
            None => Sdk::newest()?.map(Self::from_sdk).transpose(),
        }
    }

    fn from_prefix(prefix: &Path) -> Result<Self> {
        let prefix = prefix.canonicalize().with_context(|| format!("PXR_USD_ROOT is {}", prefix.display()))?;
        let header = prefix.join("include/pxr/pxr.h");
        ensure!(header.exists(), "PXR_USD_ROOT holds no OpenUSD: there is no {}", header.display());
        let library_dir = prefix.join("lib");
        let libraries = libraries_in(&library_dir)?;
        ensure!(!libraries.is_empty(), "PXR_USD_ROOT has no libusd_*.so in {}", library_dir.display());
        let include = vec![prefix.join("include"), python::include(Path::new("python3"))?];
        Ok(Self { include, library_dir, libraries, python_path: prefix.join("lib/python"), sdk: None })
    }

    fn from_sdk(sdk: Sdk) -> Result<Self> {
        Ok(Self {
            include: vec![sdk.include(), python::include(&sdk.venv().python())?],
            library_dir: sdk.library_dir(),
            libraries: vec!["usd_ms".into()],
            python_path: sdk.python_path(),
            sdk: Some(sdk),
        })
    }

    /// The environment whose interpreter loads its Python modules, with the hosts' requirements installed.
    ///
    /// # Errors
    /// A package cannot be had.
    pub fn venv(&self) -> Result<Venv> {
        let Some(sdk) = &self.sdk else {
            let ask = "import sys; print('%d.%d' % sys.version_info[:2])";
            let version = crate::process::quiet(Command::new("python3").args(["-c", ask]))?;
            return Venv::in_target("hosts", &[version.trim()], HOST_REQUIREMENTS);
        };
        let venv = sdk.venv();
        venv.require(HOST_REQUIREMENTS)?;
        Ok(venv)
    }
}

/// Link names of the OpenUSD libraries in `dir`: the monolithic one where there is one.
fn libraries_in(dir: &Path) -> Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(dir).with_context(|| dir.display().to_string())? {
        let file = entry?.file_name();
        let name = file.to_string_lossy();
        let stem = name.strip_suffix(".so").or_else(|| name.strip_suffix(".dylib"));
        names
            .extend(stem.and_then(|stem| stem.strip_prefix("lib")).filter(|n| n.starts_with("usd_")).map(String::from));
    }
    names.sort();
    if let Some(monolithic) = names.iter().find(|name| matches!(name.as_str(), "usd_ms" | "usd_m")) {
        return Ok(vec![monolithic.clone()]);
    }
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::libraries_in;

    #[test]
    fn monolithic_library_stands_for_all() {
        let dir = tempfile("monolithic", &["libusd_ms.so", "libusd_tf.so", "libtbb.so.12"]);
        assert_eq!(libraries_in(&dir).unwrap(), ["usd_ms"]);
        let dir = tempfile("separate", &["libusd_tf.so", "libusd_hd.so", "libboost.so", "usd_x.so"]);
        assert_eq!(libraries_in(&dir).unwrap(), ["usd_hd", "usd_tf"]);
    }

    fn tempfile(name: &str, files: &[&str]) -> std::path::PathBuf {
        let dir = std::env::temp_dir().join(format!("umber-xtask-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&dir).unwrap();
        files.iter().for_each(|file| std::fs::write(dir.join(file), "").unwrap());
        dir
    }
}
