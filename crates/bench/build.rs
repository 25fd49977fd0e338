//! Finds Embree 3, which the measures are taken beside. Without it they are taken alone.

use std::{path::Path, process::Command};

const LIBRARY: &str = "libembree3.so";

fn main() {
    println!("cargo::rustc-check-cfg=cfg(embree)");
    println!("cargo::rerun-if-env-changed=EMBREE_LIB_DIR");
    println!("cargo::rerun-if-changed=build.rs");
    let Some(file) = find() else {
        // Looked for at each build, so that it is found once installed.
        println!("cargo::rerun-if-changed={LIBRARY}");
        return;
    };
    println!("cargo::rerun-if-changed={file}");
    if let Some(folder) = Path::new(&file).parent() {
        println!("cargo::rustc-link-search=native={}", folder.display());
    }
    println!("cargo::rustc-link-lib=dylib=embree3");
    println!("cargo::rustc-cfg=embree");
}

/// The library, in `EMBREE_LIB_DIR` or wherever the C compiler would find it.
fn find() -> Option<String> {
    if let Ok(folder) = std::env::var("EMBREE_LIB_DIR") {
        let file = Path::new(&folder).join(LIBRARY);
        return file.exists().then(|| file.display().to_string());
    }
    let asked = Command::new("cc").arg(format!("-print-file-name={LIBRARY}")).output().ok()?;
    let file = String::from_utf8(asked.stdout).ok()?.trim().to_string();
    (Path::new(&file).is_absolute() && Path::new(&file).exists()).then_some(file)
}
