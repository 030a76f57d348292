//! What starting the server, and answering a request, may fail with.

use std::path::PathBuf;

/// Failures of this crate.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ServeError {
    /// A surface cannot be opened or read.
    #[error(transparent)]
    Surface(#[from] yamanami::Error),
    /// A file of the viewer or the site cannot be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The address cannot be listened at.
    #[error("{address}: {source}")]
    Listen {
        /// The address.
        address: std::net::SocketAddr,
        /// Why.
        source: std::io::Error,
    },
    /// The system refuses what a server needs.
    #[error("the server: {0}")]
    System(#[from] std::io::Error),
    /// The browser viewer is needed and not there.
    #[error("{}", crate::viewer::MISSING)]
    NoViewer,
}

impl From<yamanami::io::IoError> for ServeError {
    fn from(error: yamanami::io::IoError) -> Self {
        Self::Surface(error.into())
    }
}
