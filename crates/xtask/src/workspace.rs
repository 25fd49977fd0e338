//! Where things are.

use std::{
    env, fs,
    path::{Path, PathBuf},
    time::SystemTime,
};

use anyhow::{Context, Result};

/// The repository's root.
pub fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.ancestors().nth(2).unwrap_or(here).to_path_buf()
}

/// Cargo's target folder, which holds everything that is built.
pub fn target() -> PathBuf {
    env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), |dir| root().join(dir))
}

/// The per-user cache folder of Umber: what is worth keeping over checkouts.
///
/// # Errors
/// Neither `XDG_CACHE_HOME` nor `HOME` is set.
pub fn cache() -> Result<PathBuf> {
    let set = |name| env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let base = set("XDG_CACHE_HOME")
        .or_else(|| set("HOME").map(|home| home.join(".cache")))
        .context("neither XDG_CACHE_HOME nor HOME is set: no place for a per-user cache")?;
    Ok(base.join("umber"))
}

/// Does `work` unless the file `note` says that it was done for the same `state`; notes it then.
///
/// # Errors
/// Those of `work`, and where the note cannot be written.
pub fn once(note: &Path, state: &str, work: impl FnOnce() -> Result<()>) -> Result<()> {
    if fs::read_to_string(note).is_ok_and(|done| done == state) {
        return Ok(());
    }
    work()?;
    fs::write(note, state).with_context(|| note.display().to_string())
}

/// A text that changes when a source of the product does: every file of `crates` and the workspace's own
/// manifests, with size and time of change.
///
/// # Errors
/// A folder cannot be read.
pub fn sources_state() -> Result<String> {
    let root = root();
    let mut lines = Vec::new();
    for part in ["crates", "Cargo.toml", "Cargo.lock"] {
        note_files(&root.join(part), &mut lines)?;
    }
    lines.sort();
    Ok(lines.join("\n"))
}

fn note_files(path: &Path, lines: &mut Vec<String>) -> Result<()> {
    let about = fs::metadata(path).with_context(|| path.display().to_string())?;
    if about.is_dir() {
        for entry in fs::read_dir(path).with_context(|| path.display().to_string())? {
            let entry = entry?;
            let name = entry.file_name();
            // What Python and its tools leave among the sources is none, and xtask is no part of the product.
            let name = name.to_string_lossy();
            if !["__pycache__", "xtask"].contains(&name.as_ref()) && !name.ends_with(".so") && !name.starts_with('.') {
                note_files(&entry.path(), lines)?;
            }
        }
        return Ok(());
    }
    let changed = about.modified()?.duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default().as_nanos();
    lines.push(format!("{} {} {changed}", path.display(), about.len()));
    Ok(())
}
