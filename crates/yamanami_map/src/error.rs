//! What can go wrong in making a map.

/// Why a map could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// The projection cannot be.
    #[error(transparent)]
    Projection(#[from] yamanami_core::MapFault),
    /// A font file cannot be read.
    #[error("font: {0}")]
    Font(String),
    /// The picture of the ground could not be packed, or the sheet not written in a format: the format, the cause.
    #[error("writing {0}: {1}")]
    Write(&'static str, String),
}
