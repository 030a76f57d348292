//! The browser viewer: compiles its wasm and has it put together into `target/web`.

use crate::chores;
use std::path::{Path, PathBuf};
use std::process::Command;

const TARGET: &str = "wasm32-unknown-unknown";
/// Where Debian keeps its compiler for the web and that compiler's library as source: `scripts/wasm-env` uses them.
const DEBIAN: [&str; 2] = ["/usr/bin/rustc", "/usr/lib/rustlib/src/rust/library/std/Cargo.toml"];

/// Compiles `yamanami_web` and writes the viewer.
pub(crate) fn build(root: &Path) -> Result<(), String> {
    let wasm = compile(root)?;
    let path = |path: PathBuf| path.display().to_string();
    let [page, out] = ["crates/yamanami_web/page", "target/web"].map(|folder| path(root.join(folder)));
    let arguments = ["run", "--quiet", "--package", "yamanami_web_build", "--", &path(wasm), &page, &out];
    chores::cargo(root, &arguments)?;
    println!("the viewer is in {out}");
    Ok(())
}

/// The compiled wasm.
fn compile(root: &Path) -> Result<PathBuf, String> {
    let build = ["build", "--package", "yamanami_web", "--profile", "web", "--target", TARGET];
    let target_dir = if is_installed() {
        chores::cargo(root, &build)?;
        std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), |folder| root.join(folder))
    } else if DEBIAN.iter().all(|file| Path::new(file).exists()) {
        compile_by_debian(root, &build)?
    } else {
        return Err(format!(
            "web: the target {TARGET} is not installed. Please run `rustup target add {TARGET}`, or on Debian \
             `bash scripts/wasm-env`, which installs its compiler for the web"
        ));
    };
    Ok(target_dir.join(TARGET).join("web/yamanami_web.wasm"))
}

/// Whether the compiler in use has a standard library for the target.
fn is_installed() -> bool {
    let print = Command::new("rustc").args(["--print", "target-libdir", "--target", TARGET]).output();
    let folder = print.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned()).unwrap_or_default();
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten();
    files.into_iter().any(|file| file.file_name().to_string_lossy().starts_with("libstd-"))
}

/// Compiles with Debian's compiler, in the environment that `scripts/wasm-env` makes; gives the folder of its targets. The
/// environment is this one command's only: the host's crates keep their own compiler.
fn compile_by_debian(root: &Path, build: &[&str]) -> Result<PathBuf, String> {
    let script = "source scripts/wasm-env >&2 && \"${CARGO:-cargo}\" \"$@\" --target-dir \"$YAMANAMI_WASM_TARGET_DIR\" >&2 \
                  && printf %s \"$YAMANAMI_WASM_TARGET_DIR\"";
    println!("> cargo {} (by scripts/wasm-env)", build.join(" "));
    let mut command = Command::new("bash");
    command.current_dir(root).args(["-c", script, "wasm-env"]).args(build).stderr(std::process::Stdio::inherit());
    let output = command.output().map_err(|cause| format!("bash: {cause}"))?;
    if !output.status.success() {
        return Err("web: the wasm could not be compiled".into());
    }
    Ok(PathBuf::from(String::from_utf8_lossy(&output.stdout).into_owned()))
}
