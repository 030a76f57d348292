//! Puts the browser viewer together: JavaScript for the compiled wasm, the page's files beside it, and what it all weighs.
//!
//! Called by `cargo xtask web` with the compiled wasm, the folder of the page and the folder to write.

mod weigh;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use wasm_bindgen_cli_support::Bindgen;

/// Name of the module that the page imports, less `.js`.
const MODULE: &str = "yamanami_web";

fn main() -> ExitCode {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [wasm, page, out] = arguments.as_slice() else {
        eprintln!("usage: yamanami_web_build WASM PAGE-FOLDER OUT-FOLDER");
        return ExitCode::from(2);
    };
    match put_together(wasm, page, out) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("yamanami_web_build: {message}");
            ExitCode::FAILURE
        }
    }
}

/// Writes the whole viewer into a folder, which then holds nothing else.
fn put_together(wasm: &Path, page: &Path, out: &Path) -> Result<(), String> {
    let parent = out.parent().ok_or("the folder to write has no parent")?;
    std::fs::create_dir_all(parent).map_err(|cause| format!("{}: {cause}", parent.display()))?;
    let fresh = tempfile::tempdir_in(parent).map_err(|cause| format!("{}: {cause}", parent.display()))?;
    bind(wasm, fresh.path())?;
    copy_page(page, fresh.path())?;
    println!("{}", weigh::table(fresh.path())?);
    swap_in(fresh.path(), out)
}

/// JavaScript for the wasm, as a module that a page imports without a bundler.
fn bind(wasm: &Path, out: &Path) -> Result<(), String> {
    let failed = |cause: &dyn std::fmt::Display| format!("{}: {cause}", wasm.display());
    let mut bindgen = Bindgen::new();
    bindgen.web(true).map_err(|cause| failed(&cause))?;
    // with the path left out a plain `init()` would not know where the wasm is
    bindgen.omit_default_module_path(false).typescript(false).out_name(MODULE).input_path(wasm);
    bindgen.remove_name_section(true).remove_producers_section(true);
    bindgen.generate(out).map_err(|cause| failed(&format!("{cause:#}")))
}

/// Copies the files of the page, all in one folder.
fn copy_page(page: &Path, out: &Path) -> Result<(), String> {
    let failed = |cause: std::io::Error| format!("{}: {cause}", page.display());
    for entry in std::fs::read_dir(page).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        if entry.file_type().map_err(failed)?.is_file() {
            std::fs::copy(entry.path(), out.join(entry.file_name())).map_err(failed)?;
        }
    }
    Ok(())
}

/// Puts the fresh folder where the old one was.
fn swap_in(fresh: &Path, out: &Path) -> Result<(), String> {
    let failed = |cause: std::io::Error| format!("{}: {cause}", out.display());
    if out.exists() {
        std::fs::remove_dir_all(out).map_err(failed)?;
    }
    std::fs::create_dir_all(out).map_err(failed)?;
    for entry in std::fs::read_dir(fresh).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        std::fs::rename(entry.path(), out.join(entry.file_name())).map_err(failed)?;
    }
    Ok(())
}
