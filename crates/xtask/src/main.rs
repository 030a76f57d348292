//! Project chores, run as `cargo xtask CHORE`.

mod chores;
mod layers;
mod tidy;
mod web;

use std::path::Path;
use std::process::ExitCode;

const USAGE: &str = "usage: cargo xtask CHORE

  layers   fail on a dependency that ARCHITECTURE.md does not allow
  tidy     fail on a file that breaks the house rules
  web      the browser viewer, compiled to wasm and put together in target/web
  ci       fmt --check, tidy, layers, clippy and doc -D warnings, all tests";

fn main() -> ExitCode {
    let chore = std::env::args().nth(1).unwrap_or_default();
    let root = chores::workspace_root();
    let outcome = match chore.as_str() {
        "layers" => check("layers", layers::violations_of_workspace(root)),
        "tidy" => check("tidy", tidy::violations(root)),
        "web" => web::build(root),
        "ci" => ci(root),
        "help" | "--help" | "-h" => {
            println!("{USAGE}");
            Ok(())
        }
        other => {
            eprintln!("unknown chore `{other}`\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

/// Everything that must hold before a change lands, cheapest first; the test runner's summary comes last.
fn ci(root: &Path) -> Result<(), String> {
    chores::cargo(root, &["fmt", "--all", "--check"])?;
    check("tidy", tidy::violations(root))?;
    check("layers", layers::violations_of_workspace(root))?;
    chores::cargo(root, &["clippy", "--workspace", "--all-targets", "--quiet", "--", "-D", "warnings"])?;
    chores::doc(root)?;
    chores::tests(root)
}

/// Turns a list of violations into an outcome, with one line for good news.
fn check(name: &str, found: Result<Vec<String>, String>) -> Result<(), String> {
    let violations = found.map_err(|cause| format!("{name}: {cause}"))?;
    if violations.is_empty() {
        println!("{name}: all rules hold");
        return Ok(());
    }
    Err(format!("{}\n{name}: {} violations", violations.join("\n"), violations.len()))
}
