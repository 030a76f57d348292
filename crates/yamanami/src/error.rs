//! What a call may fail with.

use std::path::PathBuf;

/// Failures of the library: those of its parts, and what only shows when they are joined.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Reading or writing.
    #[error(transparent)]
    Io(#[from] yamanami_io::IoError),
    /// Building.
    #[error(transparent)]
    Build(#[from] yamanami_multires::MultiresError),
    /// Drawing.
    #[error(transparent)]
    Gpu(#[from] yamanami_gpu::GpuError),
    /// Making a map.
    #[error(transparent)]
    Map(#[from] yamanami_map::MapError),
    /// Measuring.
    #[cfg(feature = "files")]
    #[error(transparent)]
    Measure(#[from] yamanami_measure::MeasureError),
    /// A picture could not be written or read.
    #[error("{}: {source}", path.display())]
    Picture {
        /// The file.
        path: PathBuf,
        /// Why.
        source: image::ImageError,
    },
    /// A file could not be written or read.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// What was asked for makes no sense for this input.
    #[error("{0}")]
    Request(String),
}
