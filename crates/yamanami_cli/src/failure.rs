//! How a command ends when it does not end well.

use std::error::Error;

/// Why a command stopped.
#[derive(Debug)]
pub(crate) enum Failure {
    /// It could not be done: exit code 1.
    Failed(String),
    /// It was not asked for properly: exit code 2.
    Misuse(String),
    /// Nobody reads stdout any more: no failure.
    PipeClosed,
}

impl Failure {
    pub(crate) fn failed(line: impl Into<String>) -> Self {
        Self::Failed(line.into())
    }

    pub(crate) fn misuse(line: impl Into<String>) -> Self {
        Self::Misuse(line.into())
    }
}

impl<E: Error> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::Failed(one_line(&error))
    }
}

/// An error and its causes on one line; a cause that its effect tells already is not told twice.
fn one_line(error: &dyn Error) -> String {
    let mut line = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let text = error.to_string();
        if !line.contains(&text) {
            line = format!("{line}: {text}");
        }
        cause = error.source();
    }
    line.split_whitespace().collect::<Vec<_>>().join(" ")
}
