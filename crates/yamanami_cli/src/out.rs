//! Results on stdout; a closed pipe ends the program quietly.

use crate::failure::Failure;
use serde_json::Value;
use std::fmt::Display;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use yamanami::io::IoError;

/// Prints a line.
pub(crate) fn line(text: impl Display) -> Result<(), Failure> {
    check(writeln!(std::io::stdout().lock(), "{text}"))
}

/// Prints a name and what it is, in columns.
pub(crate) fn row(name: &str, text: impl Display) -> Result<(), Failure> {
    line(format_args!("{name:<14}{text}"))
}

/// Writes a file; it appears whole or not at all.
pub(crate) fn file(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let mut part = path.as_os_str().to_owned();
    part.push(".part");
    let part = PathBuf::from(part);
    let written = std::fs::write(&part, bytes).and_then(|()| std::fs::rename(&part, path));
    written.map_err(|e| {
        // the first error is the one to tell
        let _ = std::fs::remove_file(&part);
        IoError::io(path, e).into()
    })
}

/// Prints JSON.
pub(crate) fn json(value: &Value) -> Result<(), Failure> {
    line(format_args!("{value:#}"))
}

/// Sees to it that all is written.
pub(crate) fn flush() -> Result<(), Failure> {
    check(std::io::stdout().lock().flush())
}

fn check(result: std::io::Result<()>) -> Result<(), Failure> {
    result.map_err(|e| match e.kind() {
        ErrorKind::BrokenPipe => Failure::PipeClosed,
        _ => Failure::failed(format!("standard output: {e}")),
    })
}
