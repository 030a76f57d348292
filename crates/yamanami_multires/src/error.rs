//! What building may fail with.

/// Reasons a surface cannot be built.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MultiresError {
    /// No triangle of the grid has data at all three corners.
    #[error("nothing to build: of {width}x{height} samples, {no_data} have no data and no triangle is left")]
    NothingToShow {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// Samples without data.
        no_data: usize,
    },
    /// The node numbers of a surface must fit in 32 bits.
    #[error("the grid is too large: {width}x{height} samples, at most about 3.2 billion can be numbered")]
    TooLarge {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// Heights beyond what an error code can tell apart.
    #[error("height {height_m} m at column {column}, row {row} is out of range: heights must lie within ±500 km")]
    HeightOutOfRange {
        /// The height found.
        height_m: f32,
        /// Its column.
        column: usize,
        /// Its row.
        row: usize,
    },
}
