//! Builds cpp_shim against an OpenUSD and links it into the delegate's library.
//!
//! - `UMBER_USD_INCLUDE`: include folders, ':'-separated (OpenUSD's, Python's, oneTBB's);
//! - `UMBER_USD_LIBRARY_DIR`: the folder of OpenUSD's libraries, written into the library's rpath;
//! - `UMBER_USD_LIBRARIES`: names of the libraries to link, ':'-separated; `usd_ms` where unset.
//!
//! Without the first two no C++ is built: the library then holds the Rust half alone, and no host
//! can load it.

use std::env;
use std::path::{Path, PathBuf};

fn main() {
    for name in ["UMBER_USD_INCLUDE", "UMBER_USD_LIBRARY_DIR", "UMBER_USD_LIBRARIES"] {
        println!("cargo:rerun-if-env-changed={name}");
    }
    println!("cargo:rerun-if-changed=src/bridge.rs");
    let shim = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cpp_shim");
    println!("cargo:rerun-if-changed={}", shim.display());

    let (Some(include), Some(library_dir)) = (variable("UMBER_USD_INCLUDE"), variable("UMBER_USD_LIBRARY_DIR")) else {
        println!(
            "cargo:warning=hdUmber is built without its C++ half: run `cargo xtask hydra`, or set UMBER_USD_INCLUDE \
             and UMBER_USD_LIBRARY_DIR"
        );
        return;
    };
    compile(&shim, &include);
    let libraries = variable("UMBER_USD_LIBRARIES").unwrap_or_else(|| "usd_ms".into());
    link(&library_dir, &libraries);
}

fn variable(name: &str) -> Option<String> {
    env::var(name).ok().filter(|value| !value.is_empty())
}

/// Objects are linked as such: from an archive, those that only register themselves would be dropped.
fn compile(shim: &Path, include: &str) {
    let mut build = cxx_build::bridge("src/bridge.rs");
    build.std("c++17").files(sources(shim)).include(shim);
    for folder in env::split_paths(include) {
        build.flag("-isystem").flag(folder);
    }
    for define in ["MFB_PACKAGE_NAME", "MFB_ALT_PACKAGE_NAME"] {
        build.define(define, "hdUmber");
    }
    build.define("MFB_PACKAGE_MODULE", "HdUmber");
    // OpenUSD includes <ext/hash_set>, which announces its age by a #warning of this group.
    build.flag("-Wall").flag("-Wextra").flag("-Werror").flag("-Wno-deprecated");
    // Tf diagnostics name the file: as it lies in the project, not on the machine that built it.
    build.flag(format!("-ffile-prefix-map={}=cpp_shim", shim.display()));
    // Frame pointers and debug sections of template-heavy code only make the library large.
    build.debug(false).opt_level(2);
    for object in build.compile_intermediates() {
        println!("cargo:rustc-cdylib-link-arg={}", object.display());
    }
}

fn sources(shim: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(shim).expect("cpp_shim lies beside crates");
    let mut files: Vec<PathBuf> =
        entries.flatten().map(|e| e.path()).filter(|p| p.extension().is_some_and(|e| e == "cpp")).collect();
    files.sort();
    files
}

fn link(library_dir: &str, libraries: &str) {
    println!("cargo:rustc-cdylib-link-arg=-L{library_dir}");
    for library in libraries.split(':') {
        println!("cargo:rustc-cdylib-link-arg=-l{library}");
    }
    println!("cargo:rustc-cdylib-link-arg=-lstdc++");
    println!("cargo:rustc-cdylib-link-arg=-Wl,-rpath,{library_dir}");
}
