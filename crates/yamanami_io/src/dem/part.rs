//! One grid of one file, as the mosaic sees it: chunks of heights, decoded on request.

use super::SampleType;
use crate::IoError;
use std::path::{Path, PathBuf};
use yamanami_core::{Crs, GeoReference};

/// What is known of a part after its header is read.
#[derive(Debug, Clone)]
pub(super) struct PartInfo {
    /// File, or archive and member.
    pub(super) label: PathBuf,
    pub(super) format: String,
    /// Columns and rows.
    pub(super) size: [usize; 2],
    pub(super) geo: GeoReference,
    pub(super) sample_type: SampleType,
    pub(super) no_data: Option<f64>,
    pub(super) compression: String,
    pub(super) overviews: Vec<[usize; 2]>,
    /// Columns and rows of a chunk.
    pub(super) chunk: [usize; 2],
    pub(super) notes: Vec<String>,
}

impl PartInfo {
    /// Sample range `[column, row, width, height]` of a chunk, clipped to the grid.
    pub(super) fn chunk_range(&self, chunk: [usize; 2]) -> [usize; 4] {
        let [column, row] = [chunk[0] * self.chunk[0], chunk[1] * self.chunk[1]];
        let width = self.chunk[0].min(self.size[0].saturating_sub(column));
        let height = self.chunk[1].min(self.size[1].saturating_sub(row));
        [column, row, width, height]
    }
}

/// A grid that decodes by chunks.
pub(super) trait Part: Send {
    fn info(&self) -> &PartInfo;

    fn info_mut(&mut self) -> &mut PartInfo;

    /// Heights in metres of a chunk clipped to the grid, row by row, NaN for no-data, nothing infinite.
    fn read_chunk(&mut self, chunk: [usize; 2]) -> Result<Vec<f32>, IoError>;

    /// Lets go of file handles; the next read opens them again.
    fn close(&mut self) {}
}

/// A side of a grid or the whole of it is never larger than this, whatever a header says.
const MAX_GRID_SIDE: u64 = 1 << 30;
const MAX_GRID_SAMPLES: u64 = 1 << 38;

/// The size of a grid as its header promises it, checked against what can be true.
pub(super) fn checked_size(label: &Path, width: u64, height: u64) -> Result<[usize; 2], IoError> {
    if width == 0 || height == 0 {
        return Err(IoError::malformed(label, "header", "at least 2x2 samples", format!("{width}x{height}")));
    }
    let samples = width.saturating_mul(height);
    if width > MAX_GRID_SIDE || height > MAX_GRID_SIDE || samples > MAX_GRID_SAMPLES {
        let what = format!("samples promised by the header ({width}x{height})");
        return Err(IoError::too_large(label, what, samples, MAX_GRID_SAMPLES));
    }
    Ok([width as usize, height as usize])
}

/// Heights beyond this are filler (the greatest float is a common no-data value).
const MAX_ABS_HEIGHT_M: f32 = 1e30;

/// NaN for anything that is no height.
#[inline]
pub(super) fn clean(height_m: f32) -> f32 {
    if height_m.abs() < MAX_ABS_HEIGHT_M { height_m } else { f32::NAN }
}

/// A grid without a CRS whose place and small steps can only be degrees is taken as longitude/latitude.
pub(super) fn guess_crs(origin: [f64; 2], step: [f64; 2], size: [usize; 2], notes: &mut Vec<String>) -> Crs {
    let east = origin[0] + step[0] * (size[0] - 1) as f64;
    let south = origin[1] - step[1] * (size[1] - 1) as f64;
    let inside = origin[0].abs() <= 180.5 && east.abs() <= 180.5 && origin[1].abs() <= 90.5 && south.abs() <= 90.5;
    // Local grids start at (0, 0), where there is only sea.
    let is_local = (origin[0] - step[0]).abs() <= step[0] && (south - step[1]).abs() <= step[1];
    if !inside || step[0] >= 0.05 || is_local {
        notes.push("no CRS in the file: taken as metres".to_owned());
        return Crs::default();
    }
    notes.push("no CRS in the file: taken as longitude/latitude in degrees, from its place and steps".to_owned());
    Crs { geographic: true, name: "longitude/latitude (assumed)".to_owned(), ..Crs::default() }
}
