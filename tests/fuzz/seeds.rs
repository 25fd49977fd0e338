//! The seeds of the fuzz targets, checked as the targets do.

#[path = "checks/mod.rs"]
mod checks;

use std::{fs, path::Path};

use arbitrary::{Arbitrary, Unstructured};

/// Checks every file of a folder beside this file.
fn check_all<T: for<'a> Arbitrary<'a>>(target: &str, check: fn(T)) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/fuzz/seeds").join(target);
    let mut files: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    assert!(!files.is_empty(), "no seeds for {target}");
    for file in files {
        println!("{}", file.display());
        let bytes = fs::read(file).unwrap();
        check(T::arbitrary_take_rest(Unstructured::new(&bytes)).expect("a seed that can be read"));
    }
}

#[test]
fn meshes() {
    check_all("mesh", checks::mesh::check);
}

#[test]
fn instances() {
    check_all("instances", checks::instances::check);
}

#[test]
fn bounds() {
    check_all("bounds", checks::bounds::check);
}
