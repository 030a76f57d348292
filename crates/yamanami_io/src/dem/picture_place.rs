//! Where a picture lies: a GeoTIFF by its geo-keys, a web map tile by its name.

use super::bytes::{ByteSource, RandomReader};
use super::geo_keys::GeoTags;
use super::tiff_tags::{self, Tiff};
use super::tile;
use super::tile_name::tile_from_path;
use crate::IoError;
use std::path::Path;
use yamanami_core::{Crs, GeoReference};

/// Where the pixels of a picture of `size` (columns, rows) lie; `given` stands over the CRS of the file. `None` when
/// neither the file nor its name says.
pub fn picture_place(path: &Path, size: [usize; 2], given: Option<&Crs>) -> Result<Option<GeoReference>, IoError> {
    let mut reader = RandomReader::new(ByteSource::file(path)?);
    let mut head = [0; 4];
    if reader.read_exact_at(0, &mut head).is_ok() && tiff_tags::looks_like(&head) {
        let mut tiff = Tiff::open(reader)?;
        let directory = tiff.directory(tiff.first)?;
        let tags = GeoTags::read(&mut tiff, &directory)?;
        if tags.is_placed() {
            return Ok(Some(tags.place(path, size, given)?.geo));
        }
    }
    // numbers that name no tile are a date or a count
    let is_tile = |[zoom, column, row]: &[u32; 3]| *zoom <= 30 && (*column).max(*row) < 1 << zoom;
    let Some([zoom, column, row]) = tile_from_path(path).filter(is_tile) else { return Ok(None) };
    Ok(Some(tile::georeference(size, [zoom, column, row], given)))
}
