//! What measuring may fail with.

use std::path::PathBuf;

/// Failures of this crate.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeasureError {
    /// Two pictures to be compared differ in size.
    #[error("pictures differ in size: expected {}x{}, given {}x{}", expected[0], expected[1], given[0], given[1])]
    SizesDiffer {
        /// Width and height of the first picture.
        expected: [u32; 2],
        /// Width and height of the second picture.
        given: [u32; 2],
    },
    /// A picture is smaller than the window of the measure.
    #[error("picture too small: expected at least {least}x{least} pixels, given {}x{}", given[0], given[1])]
    TooSmall {
        /// Least width and height.
        least: u32,
        /// Width and height of the picture.
        given: [u32; 2],
    },
    /// A chart could not be drawn.
    #[error("{}: chart '{title}': {why}", path.display())]
    Chart {
        /// The file to be written.
        path: PathBuf,
        /// The chart's title.
        title: String,
        /// What went wrong.
        why: String,
    },
}
