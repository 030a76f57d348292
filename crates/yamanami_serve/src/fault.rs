//! What is answered when a request cannot be served: a status and one line.

use axum::http::StatusCode;
use yamanami::io::IoError;

/// A status and why.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Fault {
    pub(crate) status: StatusCode,
    pub(crate) line: String,
}

impl Fault {
    pub(crate) fn new(status: StatusCode, line: impl Into<String>) -> Self {
        Self { status, line: line.into() }
    }

    /// There is nothing by this name.
    pub(crate) fn not_found(line: impl Into<String>) -> Self {
        Self::new(StatusCode::NOT_FOUND, line)
    }

    /// A request that makes no sense.
    pub(crate) fn bad(line: impl Into<String>) -> Self {
        Self::new(StatusCode::BAD_REQUEST, line)
    }

    /// Too much to do at once.
    pub(crate) fn busy() -> Self {
        Self::new(StatusCode::SERVICE_UNAVAILABLE, "busy: try again in a few seconds")
    }

    /// A surface's file is no longer the one that was opened.
    pub(crate) fn gone(name: &str) -> Self {
        Self::new(StatusCode::GONE, format!("{name}: its file was changed or taken away; start the server again"))
    }

    /// Our own failure.
    pub(crate) fn internal() -> Self {
        Self::new(StatusCode::INTERNAL_SERVER_ERROR, "the server failed at this request; it goes on with others")
    }

    /// Reading a surface failed. Whoever asks is not told where files are.
    pub(crate) fn unreadable(name: &str, error: &yamanami::Error) -> Self {
        let why = match error {
            yamanami::Error::Io(IoError::Malformed { place, expected, found, .. }) => {
                format!("{place}: expected {expected}, found {found}")
            }
            yamanami::Error::Io(IoError::Io { source, .. }) => source.kind().to_string(),
            _ => "it cannot be shown".to_owned(),
        };
        Self::new(StatusCode::INTERNAL_SERVER_ERROR, format!("{name}: {why}"))
    }
}
