//! The house rules that a machine can hold.
//!
//! Based on the idea of rust-analyzer's `xtask tidy`: a convention that is not checked is a wish.

use std::path::Path;

/// Above this a file has more than one concern.
const MOST_LINES: usize = 600;

/// Folders without text of ours.
const SKIPPED: &[&str] = &["target", ".git", "corpus", "artifacts", "demo-out", "node_modules"];

/// Endings of the text files that are checked.
const TEXT: &[&str] = &["rs", "md", "toml", "wgsl", "sh", "py", "yml", "js", "mjs", "css", "html"];

/// Words that may not stand in code. In two parts, so that this file passes its own check.
const FORBIDDEN: &[(&str, &str, &str)] = &[
    ("todo", "!(", "unfinished code"),
    ("unimplemented", "!(", "unfinished code"),
    ("dbg", "!(", "a debugging aid"),
    ("\"/", "home/", "an absolute path"),
    ("\"/", "root/", "an absolute path"),
    ("\"/", "work/", "an absolute path"),
    ("\"/", "tmp/", "an absolute path; use the tempfile crate"),
    ("\"C:", "\\", "an absolute path"),
];

/// All broken rules below `root`, one line each, by file and line.
pub(crate) fn violations(root: &Path) -> Result<Vec<String>, String> {
    let mut found = Vec::new();
    walk(root, root, &mut found)?;
    found.sort();
    Ok(found)
}

fn walk(root: &Path, folder: &Path, found: &mut Vec<String>) -> Result<(), String> {
    let failed = |cause| format!("{}: {cause}", folder.display());
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let (path, name) = (entry.path(), entry.file_name());
        let name = name.to_string_lossy();
        if entry.file_type().map_err(failed)?.is_dir() {
            if !SKIPPED.contains(&&*name) {
                walk(root, &path, found)?;
            }
        } else if TEXT.iter().any(|ending| path.extension().is_some_and(|e| e == *ending)) {
            let shown = path.strip_prefix(root).unwrap_or(&path).display().to_string();
            match std::fs::read_to_string(&path) {
                Ok(text) => check_text(&shown, &text, found),
                Err(cause) => found.push(format!("{shown}: {cause}")),
            }
        }
    }
    Ok(())
}

fn check_text(path: &str, text: &str, found: &mut Vec<String>) {
    for (number, line) in (1..).zip(text.lines()) {
        if line.ends_with([' ', '\t']) {
            found.push(format!("{path}:{number}: trailing space"));
        }
    }
    if !text.is_empty() && !text.ends_with('\n') {
        found.push(format!("{path}: no newline at the end"));
    }
    if path.ends_with(".rs") {
        check_rust(path, text, found);
    }
    let lines = text.lines().count();
    if lines > MOST_LINES && [".rs", ".js", ".mjs", ".css"].iter().any(|ending| path.ends_with(ending)) {
        found.push(format!("{path}: {lines} lines, at most {MOST_LINES}"));
    }
    if path.ends_with("/Cargo.toml") && path.starts_with("crates/") && !text.contains("[lints]\nworkspace = true") {
        found.push(format!("{path}: must take the workspace's lints"));
    }
}

fn check_rust(path: &str, text: &str, found: &mut Vec<String>) {
    if !text.starts_with("//! ") {
        found.push(format!("{path}: must open with `//! ` and what the file does"));
    }
    for (number, line) in (1..).zip(text.lines()) {
        for (start, end, what) in FORBIDDEN {
            if line.contains(&format!("{start}{end}")) {
                found.push(format!("{path}:{number}: `{start}{end}` is {what}"));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(path: &str, text: &str) -> Vec<String> {
        let mut found = Vec::new();
        check_text(path, text, &mut found);
        found
    }

    #[test]
    fn a_tidy_file_passes() {
        assert!(found("crates/a/src/lib.rs", "//! Does a thing.\n\nfn a() {}\n").is_empty());
        assert!(found("crates/a/Cargo.toml", "[lints]\nworkspace = true\n").is_empty());
    }

    #[test]
    fn each_rule_is_held() {
        let first = |path: &str, text: &str| found(path, text).first().cloned().unwrap_or_default();
        assert!(first("a.rs", "fn a() {}\n").contains("must open"));
        assert!(first("a.rs", "//! A. \n").contains("a.rs:1: trailing space"));
        assert!(first("a.md", "text").contains("no newline"));
        assert!(first("a.rs", &format!("//! A.\n{}", "\n".repeat(700))).contains("701 lines"));
        assert!(first("a.rs", &format!("//! A.\nlet x = {}!(x);\n", "dbg")).contains("a.rs:2"));
        assert!(first("a.rs", &format!("//! A.\nopen(\"/{}x\");\n", "tmp/")).contains("absolute path"));
        assert!(first("crates/a/Cargo.toml", "[package]\n").contains("lints"));
    }
}
