//! Headers: copied from a source tree, and the two that OpenUSD's own build would generate.

use std::{
    fs,
    io::Read,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, bail, ensure};

use super::Version;
use crate::python::Venv;

/// Parts of OpenUSD whose headers a delegate may see, directly or not.
const PARTS: [&str; 5] = ["base", "external", "imaging", "usd", "usdImaging"];
/// Folders of those parts that hold programs, plugins and tests.
const SKIPPED: [&str; 3] = ["bin", "plugin", "testenv"];
/// Where C++ compilers look by themselves.
const SYSTEM_INCLUDE: [&str; 3] = ["/usr/include", "/usr/local/include", "/opt/homebrew/include"];

/// A source tree of OpenUSD.
pub struct SourceTree {
    root: PathBuf,
}

impl SourceTree {
    /// The tree in `root`, checked to be `version` as far as it says.
    ///
    /// # Errors
    /// It is no OpenUSD source tree, or of another version.
    pub fn open(root: &Path, version: &Version) -> Result<Self> {
        ensure!(
            root.join("pxr/pxr.h.in").exists(),
            "{} is no OpenUSD source tree: there is no pxr/pxr.h.in in it",
            root.display()
        );
        let defaults = root.join("cmake/defaults/Version.cmake");
        match fs::read_to_string(&defaults) {
            Ok(text) => {
                let has = (cmake_number(&text, "PXR_MINOR_VERSION"), cmake_number(&text, "PXR_PATCH_VERSION"));
                let (year, month) = version.numbers();
                ensure!(
                    has == (Some(year), Some(month)),
                    "{} says that this tree is not OpenUSD {}",
                    defaults.display(),
                    version.usd
                );
            }
            Err(_) => eprintln!(
                "warning: {} is absent, so that the tree's version cannot be checked; taken to be {}",
                defaults.display(),
                version.usd
            ),
        }
        Ok(Self { root: root.to_path_buf() })
    }

    /// Copies the headers into the folder `include`; gives their number.
    ///
    /// # Errors
    /// A file cannot be read or written.
    pub fn copy_headers(&self, include: &Path) -> Result<usize> {
        let mut copied = 0;
        for part in PARTS {
            copied += copy_tree(&self.root.join("pxr").join(part), &include.join("pxr").join(part))?;
        }
        Ok(copied)
    }

    /// Generates the headers that depend on how the library was built.
    ///
    /// # Errors
    /// A template has a placeholder that is not known here.
    pub fn generate_headers(&self, include: &Path, version: &Version) -> Result<()> {
        let (year, month) = version.numbers();
        let values = [
            ("PXR_MAJOR_VERSION", "0".to_string()),
            ("PXR_MINOR_VERSION", year.to_string()),
            ("PXR_PATCH_VERSION", month.to_string()),
            ("PXR_VERSION", (year * 100 + month).to_string()),
            ("PXR_USE_NAMESPACES", "1".to_string()),
            ("PXR_EXTERNAL_NAMESPACE", "pxr".to_string()),
            ("PXR_INTERNAL_NAMESPACE", version.internal_namespace()),
            ("PXR_PYTHON_SUPPORT_ENABLED", "1".to_string()),
            ("PXR_PREFER_SAFETY_OVER_SPEED", "1".to_string()),
            ("PXR_WORK_IMPL_HEADER", "\"pxr/base/work/workTBB/impl.h\"".to_string()),
        ];
        for name in ["pxr/pxr.h", "pxr/base/work/impl.h"] {
            let template = self.root.join(format!("{name}.in"));
            if template.exists() {
                let text = fs::read_to_string(&template).with_context(|| template.display().to_string())?;
                let text = fill_in(&text, &values).with_context(|| template.display().to_string())?;
                fs::write(include.join(name), text).with_context(|| name.to_string())?;
            }
        }
        Ok(())
    }
}

/// Whether `library` has symbols in the internal `namespace`.
///
/// # Errors
/// The library cannot be read.
pub fn library_has_namespace(library: &Path, namespace: &str) -> Result<bool> {
    let symbol = format!("{namespace}__pxrReserved__");
    let mut file = fs::File::open(library).with_context(|| library.display().to_string())?;
    let (mut window, mut kept) = (vec![0; 1 << 22], 0);
    loop {
        let read = file.read(&mut window[kept..])?;
        let filled = kept + read;
        if window[..filled].windows(symbol.len()).any(|bytes| bytes == symbol.as_bytes()) {
            return Ok(true);
        }
        if read == 0 {
            return Ok(false);
        }
        // A symbol may lie across two windows.
        kept = filled.min(symbol.len() - 1);
        window.copy_within(filled - kept..filled, 0);
    }
}

/// Adds oneTBB's headers to `include` where the system has none.
///
/// # Errors
/// The package cannot be had.
pub fn add_tbb(include: &Path, venv: &Venv) -> Result<()> {
    if SYSTEM_INCLUDE.iter().any(|dir| Path::new(dir).join("oneapi/tbb/version.h").exists()) {
        return Ok(());
    }
    println!("no oneTBB headers on the system: taken from the package tbb-devel");
    venv.install(["--no-deps", "tbb-devel==2021.13.1"])?;
    for part in ["oneapi", "tbb"] {
        copy_tree(&venv.dir().join("include").join(part), &include.join(part))?;
    }
    Ok(())
}

/// Copies the headers of `from`, folder by folder; gives their number.
fn copy_tree(from: &Path, to: &Path) -> Result<usize> {
    let mut copied = 0;
    fs::create_dir_all(to).with_context(|| to.display().to_string())?;
    for entry in fs::read_dir(from).with_context(|| from.display().to_string())? {
        let (path, name) = entry.map(|entry| (entry.path(), entry.file_name()))?;
        if path.is_dir() {
            if !SKIPPED.iter().any(|skipped| name == *skipped) {
                copied += copy_tree(&path, &to.join(&name))?;
            }
        } else if path.extension().is_some_and(|kind| kind == "h" || kind == "hpp") {
            fs::copy(&path, to.join(&name)).with_context(|| path.display().to_string())?;
            copied += 1;
        }
    }
    Ok(copied)
}

/// The number that `text` sets the CMake variable `name` to.
fn cmake_number(text: &str, name: &str) -> Option<u32> {
    let line = text.lines().find(|line| line.trim_start().starts_with(&format!("set({name} ")))?;
    let value = line.split_once(name)?.1;
    value.split(|c: char| !c.is_ascii_digit()).find(|digits| !digits.is_empty())?.parse().ok()
}

/// `text` with every `@NAME@` replaced.
fn fill_in(text: &str, values: &[(&str, String)]) -> Result<String> {
    let mut filled = text.to_string();
    for (name, value) in values {
        filled = filled.replace(&format!("@{name}@"), value);
    }
    if let Some(rest) = filled.split('@').nth(1) {
        bail!("the placeholder @{rest}@ is not known");
    }
    Ok(filled)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn version_is_read_from_cmake() {
        let text = "set(PXR_MAJOR_VERSION \"0\")\nset(PXR_MINOR_VERSION \"25\")\nset(PXR_PATCH_VERSION \"8\") # Must not have leading 0\n";
        assert_eq!(cmake_number(text, "PXR_MINOR_VERSION"), Some(25));
        assert_eq!(cmake_number(text, "PXR_PATCH_VERSION"), Some(8));
        assert_eq!(cmake_number(text, "PXR_VERSION"), None);
    }

    #[test]
    fn unknown_placeholder_is_an_error() {
        let values = [("A", "1".to_string())];
        assert_eq!(fill_in("#define A @A@\n", &values).unwrap(), "#define A 1\n");
        assert!(fill_in("@B@", &values).unwrap_err().to_string().contains("@B@"));
    }

    #[test]
    fn namespace_is_found_across_windows() {
        let file = std::env::temp_dir().join(format!("umber-namespace-{}", std::process::id()));
        let mut bytes = vec![b'x'; (1 << 22) - 10];
        bytes.extend_from_slice(b"pxrBlender_v25_08__pxrReserved__");
        fs::write(&file, bytes).unwrap();
        assert!(library_has_namespace(&file, "pxrBlender_v25_08").unwrap());
        assert!(!library_has_namespace(&file, "pxrBlender_v25_02").unwrap());
        fs::remove_file(&file).unwrap();
    }
}
