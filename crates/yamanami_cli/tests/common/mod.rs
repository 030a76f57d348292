//! Runs the program as a user would.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The bundled DEM: 257 x 257 samples of 50 m.
pub(crate) fn dem() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data/mt_washington_50m.tif")
}

/// Runs the program; arguments are split at blanks, `@` stands for the bundled DEM, `%` for the folder.
pub(crate) fn run(folder: &Path, arguments: &str) -> Output {
    let argument = |a: &str| match a {
        "@" => dem().into_os_string(),
        a => a.replace('%', &folder.display().to_string()).into(),
    };
    Command::new(env!("CARGO_BIN_EXE_yamanami"))
        .args(arguments.split_whitespace().map(argument))
        .current_dir(folder)
        // some graphics drivers complain on stderr where it is missing
        .env("XDG_RUNTIME_DIR", folder)
        .output()
        .expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Stdout of a run that must succeed without a word on stderr but notes.
pub(crate) fn stdout(folder: &Path, arguments: &str) -> String {
    let output = run(folder, arguments);
    let stderr = text(&output.stderr);
    assert!(output.status.success(), "{arguments}: {stderr}");
    assert!(!stderr.contains("error"), "{arguments}: {stderr}");
    text(&output.stdout)
}

/// The same with `--json`, parsed.
pub(crate) fn json(folder: &Path, arguments: &str) -> Value {
    let stdout = stdout(folder, &format!("{arguments} --json"));
    serde_json::from_str(&stdout).unwrap_or_else(|e| panic!("{arguments}: {e}: {stdout}"))
}

/// The one line on stderr of a run that must end with this exit code.
pub(crate) fn error(folder: &Path, arguments: &str, code: i32) -> String {
    let output = run(folder, arguments);
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments}: {stderr}");
    assert_eq!(stderr.trim_end().lines().count(), 1, "{arguments}: one line, not: {stderr}");
    assert!(stderr.starts_with("error: "), "{arguments}: {stderr}");
    assert!(output.stdout.is_empty(), "{arguments}: nothing on stdout");
    stderr.trim_end().to_owned()
}
