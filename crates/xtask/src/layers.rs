//! The star of crates, as a check: who may depend on whom.
//!
//! Reads `cargo metadata`, so that renamed, optional, target-specific and build dependencies are seen as well.

use serde_json::Value;
use std::path::Path;

/// What one package of the workspace may import.
struct Layer {
    package: &'static str,
    /// Packages of the workspace that it may depend on.
    siblings: &'static [&'static str],
    /// Packages of the workspace that its tests may use besides.
    in_tests: &'static [&'static str],
    /// Packages from outside that it must do without, and why a reader may care.
    never: &'static [&'static str],
}

const TESTKIT: &[&str] = &["yamanami_testkit"];

/// Programs, windows, wires and scripting belong to the outermost crates.
const FRONT_ENDS: &[&str] = &["clap", "winit", "egui", "eframe", "egui-winit", "pyo3", "axum", "indicatif", "anyhow"];

/// The core knows no file, thread, clock or GPU.
const CORE_NEVER: &[&str] = &[
    "rayon", "tokio", "memmap2", "rusqlite", "image", "tiff", "wgpu", "clap", "winit", "egui", "pyo3", "axum",
];

/// Building and policy know no file format and no GPU, and also run in a browser.
const PURE_NEVER: &[&str] = &[
    "rusqlite", "memmap2", "tempfile", "image", "tiff", "wgpu", "tokio", "clap", "winit", "egui", "pyo3", "axum",
];

const LAYERS: &[Layer] = &[
    Layer { package: "yamanami_core", siblings: &[], in_tests: TESTKIT, never: CORE_NEVER },
    Layer { package: "yamanami_multires", siblings: &["yamanami_core"], in_tests: TESTKIT, never: PURE_NEVER },
    Layer { package: "yamanami_lod", siblings: &["yamanami_core"], in_tests: TESTKIT, never: PURE_NEVER },
    Layer { package: "yamanami_io", siblings: &["yamanami_core"], in_tests: TESTKIT, never: FRONT_ENDS },
    Layer { package: "yamanami_gpu", siblings: &["yamanami_core"], in_tests: TESTKIT, never: FRONT_ENDS },
    Layer { package: "yamanami_map", siblings: &["yamanami_core"], in_tests: TESTKIT, never: FRONT_ENDS },
    Layer { package: "yamanami_measure", siblings: &["yamanami_core"], in_tests: TESTKIT, never: FRONT_ENDS },
    Layer { package: "yamanami_testkit", siblings: &["yamanami_core"], in_tests: &[], never: FRONT_ENDS },
    Layer {
        package: "yamanami",
        siblings: &[
            "yamanami_core",
            "yamanami_multires",
            "yamanami_lod",
            "yamanami_io",
            "yamanami_gpu",
            "yamanami_map",
            "yamanami_measure",
        ],
        in_tests: TESTKIT,
        never: FRONT_ENDS,
    },
    Layer {
        package: "yamanami_serve",
        siblings: &["yamanami"],
        in_tests: TESTKIT,
        never: &["clap", "winit", "egui", "eframe", "pyo3", "indicatif"],
    },
    // the program generates synthetic terrain for trying and timing: the kit's
    Layer {
        package: "yamanami_cli",
        siblings: &["yamanami", "yamanami_serve", "yamanami_testkit"],
        in_tests: &[],
        never: &["pyo3"],
    },
    Layer {
        package: "yamanami_web",
        siblings: &["yamanami"],
        in_tests: TESTKIT,
        never: &["clap", "winit", "egui", "eframe", "pyo3", "axum", "tokio", "rusqlite", "memmap2"],
    },
    Layer { package: "yamanami_web_build", siblings: &[], in_tests: &[], never: &[] },
    Layer { package: "xtask", siblings: &[], in_tests: &[], never: &[] },
];

/// Edges of this workspace that no rule allows, one line each.
pub(crate) fn violations_of_workspace(root: &Path) -> Result<Vec<String>, String> {
    let bytes = crate::chores::cargo_output(root, &["metadata", "--no-deps", "--format-version", "1"])?;
    let metadata: Value = serde_json::from_slice(&bytes).map_err(|cause| format!("cargo metadata: {cause}"))?;
    violations(&metadata)
}

fn violations(metadata: &Value) -> Result<Vec<String>, String> {
    let packages = metadata["packages"].as_array().ok_or("cargo metadata lists no packages")?;
    let names: Vec<&str> = packages.iter().filter_map(|p| p["name"].as_str()).collect();
    let mut found = Vec::new();
    for package in packages {
        let name = package["name"].as_str().unwrap_or_default();
        let Some(layer) = LAYERS.iter().find(|l| l.package == name) else {
            found.push(format!(
                "{name}: not in the table of layers (crates/xtask/src/layers.rs); add what it may import"
            ));
            continue;
        };
        for dependency in package["dependencies"].as_array().into_iter().flatten() {
            let to = dependency["name"].as_str().unwrap_or_default();
            let in_tests = dependency["kind"].as_str() == Some("dev");
            found.extend(complaint(layer, to, in_tests, names.contains(&to)));
        }
    }
    found.sort();
    Ok(found)
}

/// What is wrong with one edge, if anything.
fn complaint(layer: &Layer, to: &str, in_tests: bool, is_ours: bool) -> Option<String> {
    let from = layer.package;
    if layer.siblings.contains(&to) || (in_tests && layer.in_tests.contains(&to)) {
        return None;
    }
    if is_ours {
        let allowed = if layer.siblings.is_empty() { "nothing of ours".into() } else { layer.siblings.join(", ") };
        let section = if in_tests { "dev-dependency" } else { "dependency" };
        return Some(format!("{from}: {section} on {to}; it may import {allowed}"));
    }
    (!in_tests && layer.never.contains(&to)).then(|| format!("{from}: must do without {to}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn found(from: &str, to: &str, kind: Option<&str>) -> Vec<String> {
        let metadata = json!({ "packages": [
            { "name": from, "dependencies": [{ "name": to, "kind": kind }] },
            { "name": "yamanami_core", "dependencies": [] },
            { "name": "yamanami_io", "dependencies": [] },
            { "name": "yamanami_testkit", "dependencies": [] },
        ]});
        violations(&metadata).unwrap()
    }

    #[test]
    fn the_workspace_keeps_its_layers() {
        assert_eq!(violations_of_workspace(crate::chores::workspace_root()), Ok(Vec::new()));
    }

    #[test]
    fn siblings_do_not_meet_and_nothing_looks_upward() {
        assert_eq!(found("yamanami_lod", "yamanami_core", None), Vec::<String>::new());
        let message = found("yamanami_lod", "yamanami_io", None);
        assert_eq!(message, ["yamanami_lod: dependency on yamanami_io; it may import yamanami_core"]);
        assert_eq!(found("yamanami_core", "yamanami_io", Some("build")).len(), 1);
        assert_eq!(found("yamanami_cli", "yamanami_core", None).len(), 1, "the program sees the facade only");
        assert_eq!(found("yamanami_testkit", "yamanami_io", None).len(), 1);
    }

    #[test]
    fn tests_may_use_the_kit_and_the_product_may_not() {
        assert!(found("yamanami_io", "yamanami_testkit", Some("dev")).is_empty());
        assert_eq!(found("yamanami_io", "yamanami_testkit", None).len(), 1);
        assert_eq!(found("yamanami_gpu", "yamanami_io", Some("dev")).len(), 1);
    }

    #[test]
    fn heavy_strangers_are_kept_out() {
        assert_eq!(found("yamanami", "clap", None), ["yamanami: must do without clap"]);
        assert_eq!(found("yamanami_multires", "wgpu", None).len(), 1);
        assert!(found("yamanami_gpu", "wgpu", None).is_empty());
        assert!(found("yamanami_core", "rayon", Some("dev")).is_empty());
    }

    #[test]
    fn a_new_crate_must_enter_the_table() {
        assert!(found("yamanami_extra", "yamanami_core", None)[0].contains("not in the table"));
    }
}
