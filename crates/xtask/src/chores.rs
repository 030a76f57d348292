//! Calling cargo.

use std::path::Path;
use std::process::Command;

/// The folder of the workspace, two above this package.
pub(crate) fn workspace_root() -> &'static Path {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    package.ancestors().nth(2).unwrap_or(package)
}

fn cargo_command(root: &Path) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root);
    command
}

/// Runs cargo with its output shown; an error when it fails.
pub(crate) fn cargo(root: &Path, arguments: &[&str]) -> Result<(), String> {
    show(cargo_command(root).args(arguments))
}

/// Builds the documentation of our libraries; a broken link in it is an error.
pub(crate) fn doc(root: &Path) -> Result<(), String> {
    let mut command = cargo_command(root);
    command.env("RUSTDOCFLAGS", "-D warnings");
    show(command.args(["doc", "--workspace", "--lib", "--no-deps", "--quiet"]))
}

fn show(command: &mut Command) -> Result<(), String> {
    let arguments: Vec<_> = command.get_args().map(|a| a.to_string_lossy()).collect();
    let line = format!("cargo {}", arguments.join(" "));
    println!("> {line}");
    let status = command.status().map_err(|cause| format!("{line}: {cause}"))?;
    if status.success() { Ok(()) } else { Err(format!("{line}: failed ({status})")) }
}

/// Runs cargo and gives its standard output back.
pub(crate) fn cargo_output(root: &Path, arguments: &[&str]) -> Result<Vec<u8>, String> {
    let line = format!("cargo {}", arguments.join(" "));
    let output = cargo_command(root).args(arguments).output().map_err(|cause| format!("{line}: {cause}"))?;
    if output.status.success() {
        Ok(output.stdout)
    } else {
        Err(format!("{line}: {}", String::from_utf8_lossy(&output.stderr)))
    }
}

/// All tests of the workspace, by `cargo nextest` where it is installed. It runs no doc tests, so these come first.
pub(crate) fn tests(root: &Path) -> Result<(), String> {
    if cargo_output(root, &["nextest", "--version"]).is_ok() {
        cargo(root, &["test", "--workspace", "--doc", "--quiet"])?;
        cargo(root, &["nextest", "run", "--workspace", "--no-fail-fast"])
    } else {
        cargo(root, &["test", "--workspace", "--no-fail-fast"])
    }
}
