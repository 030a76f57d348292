//! What reading and writing may fail with: one clear line naming the file, the place, what was expected and what was
//! found.

use std::path::{Path, PathBuf};

/// Failures of this crate.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IoError {
    /// The operating system refused: missing file, no permission, full disk.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The content is not what its format promises.
    #[error("{}: {place}: expected {expected}, found {found}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// Where in the file: a tag, a line, a byte offset.
        place: String,
        /// What should be there.
        expected: String,
        /// What is there.
        found: String,
    },
    /// The content is well formed but beyond what is read here.
    #[error("{}: {what}; {hint}", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What is not supported.
        what: String,
        /// What to do instead.
        hint: String,
    },
    /// More data than the stated limit.
    #[error("{}: {what}: {given} is above the limit of {limit}", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// What is counted.
        what: String,
        /// How much there is.
        given: u64,
        /// How much is allowed.
        limit: u64,
    },
    /// Two inputs that should fit together do not.
    #[error("{} and {} do not fit together: {why}", first.display(), second.display())]
    Mismatch {
        /// One file.
        first: PathBuf,
        /// The other.
        second: PathBuf,
        /// What differs.
        why: String,
    },
    /// A request that makes no sense for this file: a window outside it, an empty list of files.
    #[error("{what}: expected {expected}, given {given}")]
    BadRequest {
        /// What was asked.
        what: String,
        /// What would be accepted.
        expected: String,
        /// What was given.
        given: String,
    },
}

impl IoError {
    /// Wraps what the system said about a file.
    pub fn io(path: impl AsRef<Path>, source: std::io::Error) -> Self {
        Self::Io { path: path.as_ref().to_owned(), source }
    }

    /// Content that breaks its format's promise.
    pub fn malformed(
        path: impl AsRef<Path>,
        place: impl Into<String>,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> Self {
        Self::Malformed {
            path: path.as_ref().to_owned(),
            place: one_line(place.into()),
            expected: expected.into(),
            found: one_line(found.into()),
        }
    }

    /// Content that is fine but not read here.
    pub fn unsupported(path: impl AsRef<Path>, what: impl Into<String>, hint: impl Into<String>) -> Self {
        Self::Unsupported { path: path.as_ref().to_owned(), what: one_line(what.into()), hint: hint.into() }
    }

    /// More data than a stated limit.
    pub fn too_large(path: impl AsRef<Path>, what: impl Into<String>, given: u64, limit: u64) -> Self {
        Self::TooLarge { path: path.as_ref().to_owned(), what: what.into(), given, limit }
    }
}

/// What a file contains may be long and of any characters; a message is one line.
fn one_line(text: String) -> String {
    const MAX_CHARS: usize = 160;
    if text.len() <= MAX_CHARS && !text.contains(char::is_control) {
        return text;
    }
    let mut line: String = text.chars().take(MAX_CHARS).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().count() > MAX_CHARS {
        line.push('…');
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_one_line() {
        let error = IoError::malformed("a.xml", "line 1", "a tag", format!("<a\n{}", "標".repeat(1000)));
        let message = error.to_string();
        assert!(!message.contains('\n') && message.chars().count() < 250 && message.ends_with('…'), "{message}");
    }
}
