//! A grid that is read by windows, so that it may be larger than memory.

use crate::GeoReference;

/// A rectangle of samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    /// First column.
    pub column: usize,
    /// First row.
    pub row: usize,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

/// Where heights come from: a file, a mosaic of files, a generator.
pub trait HeightSource {
    /// What reading may fail with.
    type Error: std::error::Error + Send + Sync + 'static;

    /// Columns and rows.
    fn size(&self) -> [usize; 2];

    /// Where the grid lies.
    fn geo(&self) -> &GeoReference;

    /// Reads a window that lies inside the grid into `out` (row by row, metres, NaN for no-data).
    fn read_window(&mut self, window: Window, out: &mut [f32]) -> Result<(), Self::Error>;
}
