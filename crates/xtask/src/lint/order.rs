//! The order of the crates: which may depend on which.

use std::collections::BTreeSet;

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use crate::{process, workspace};

/// What each crate may depend on; what those depend on comes with them. Rows depend on rows above alone.
const TABLE: [(&str, &[&str]); 12] = [
    ("umber-math", &[]),
    ("umber-settings", &[]),
    ("umber-sampling", &["umber-math"]),
    ("umber-geometry", &["umber-math"]),
    ("umber-bvh", &["umber-math", "umber-geometry"]),
    ("umber-shading", &["umber-math", "umber-sampling"]),
    ("umber-scene", &["umber-settings", "umber-geometry"]),
    ("umber-render", &["umber-bvh", "umber-shading", "umber-scene"]),
    ("umber-hydra", &["umber-render"]),
    ("umber-python", &["umber-render"]),
    ("umber-bench", &["umber-render"]),
    ("xtask", &[]),
];

/// Checks the workspace against the table. What only tests depend on is free.
///
/// # Errors
/// A crate depends on one that it may not know, or is not in the table.
pub fn check() -> Result<()> {
    let mut cargo = process::cargo();
    cargo.args(["metadata", "--format-version", "1", "--no-deps"]).current_dir(workspace::root());
    let metadata: Value = serde_json::from_str(&process::quiet(&mut cargo)?)?;
    let wrong = violations(&metadata).context("cargo metadata is not as expected")?;
    ensure!(wrong.is_empty(), "{}", wrong.join("\n"));
    Ok(())
}

/// What is wrong, a line each; none where `metadata` is not what cargo gives.
fn violations(metadata: &Value) -> Option<Vec<String>> {
    let mut wrong = Vec::new();
    for package in metadata["packages"].as_array()? {
        let name = package["name"].as_str()?;
        if !TABLE.iter().any(|(row, _)| *row == name) {
            wrong.push(format!("{name} is not in the table of crates/xtask/src/lint/order.rs"));
            continue;
        }
        let may = below(name);
        for dependency in package["dependencies"].as_array()? {
            let other = dependency["name"].as_str()?;
            let ours = dependency["path"].is_string() && dependency["kind"] != "dev";
            if ours && !may.contains(other) {
                wrong.push(format!("{name} depends on {other}, which is not below it"));
            }
        }
    }
    Some(wrong)
}

/// All that `name` may depend on.
fn below(name: &str) -> BTreeSet<&'static str> {
    let direct = TABLE.iter().find(|(row, _)| *row == name).map_or(&[][..], |(_, below)| below);
    direct.iter().flat_map(|other| below(other).into_iter().chain([*other])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_is_in_order() {
        for (row, (name, depends)) in TABLE.iter().enumerate() {
            let above = &TABLE[..row];
            assert!(depends.iter().all(|other| above.iter().any(|(name, _)| name == other)), "{name}");
        }
    }

    #[test]
    fn upward_edge_is_found() {
        let package = |name: &str, on: &str, kind: Value| serde_json::json!({ "name": name, "dependencies": [{ "name": on, "path": "/", "kind": kind }] });
        let found = |package| violations(&serde_json::json!({ "packages": [package] })).unwrap();
        assert!(found(package("umber-hydra", "umber-math", Value::Null)).is_empty());
        assert!(found(package("umber-scene", "umber-render", "dev".into())).is_empty());
        assert_eq!(found(package("umber-scene", "umber-render", Value::Null)).len(), 1);
        assert_eq!(found(package("umber-new", "umber-render", Value::Null)).len(), 1);
    }
}
