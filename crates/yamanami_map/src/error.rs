//! What can go wrong in making a map.

/// Why a map could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// The projection cannot be.
    #[error(transparent)]
    Projection(#[from] yamanami_core::MapFault),
}
