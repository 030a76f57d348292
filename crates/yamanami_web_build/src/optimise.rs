//! Makes the wasm smaller by Binaryen's wasm-opt, where that is installed and knows the module's instructions.

use std::path::Path;
use std::process::Command;

/// What rustc's wasm uses beyond the first version.
const FEATURES: [&str; 6] = [
    "--enable-bulk-memory",
    "--enable-mutable-globals",
    "--enable-multivalue",
    "--enable-nontrapping-float-to-int",
    "--enable-reference-types",
    "--enable-sign-ext",
];

/// Optimises a module in place; a line that says what came of it. The module stays as it is where the program is missing or
/// refuses it.
pub(crate) fn optimise(module: &Path) -> Result<String, String> {
    let failed = |cause: std::io::Error| format!("{}: {cause}", module.display());
    let smaller = module.with_extension("smaller");
    let before = std::fs::metadata(module).map_err(failed)?.len();
    let run = Command::new("wasm-opt").args(FEATURES).arg("-Os").arg(module).arg("-o").arg(&smaller).output();
    let skipped = match run {
        Ok(output) if output.status.success() => {
            std::fs::rename(&smaller, module).map_err(failed)?;
            let after = std::fs::metadata(module).map_err(failed)?.len();
            return Ok(format!("wasm-opt: {before} to {after} bytes"));
        }
        Ok(output) => {
            let text = String::from_utf8_lossy(&output.stderr);
            format!("it refused the module: {}", text.lines().next().unwrap_or("no word why"))
        }
        Err(_) => "not installed".to_owned(),
    };
    if smaller.exists() {
        std::fs::remove_file(&smaller).map_err(failed)?;
    }
    Ok(format!("wasm-opt: skipped ({skipped})"))
}
