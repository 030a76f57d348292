//! Elevation grids: GeoTIFF, SRTM, DTED, ESRI ASCII, GSI FG-GML and web map tiles, one file or a mosaic of many.
//!
//! [`open`] reads headers only; heights come by windows through [`yamanami_core::HeightSource`], so that a file may be larger than
//! memory. Samples are points: a format that names cells gives their centres. Heights are `f32` metres, NaN is no-data.

mod ascii;
mod bytes;
mod cache;
mod detect;
mod dted;
mod fg_gml;
#[cfg(feature = "gdal")]
mod gdal_file;
mod geo_keys;
mod geotiff;
mod hgt;
mod mosaic;
mod part;
mod picture_place;
pub(crate) mod prj;
mod sample_type;
mod tiff_codec;
mod tiff_tags;
mod tile;
mod tile_name;
mod write;

pub use mosaic::DemFile;
pub use picture_place::picture_place;
pub use sample_type::SampleType;
pub use tile::TileEncoding;
pub(crate) use tile_name::tile_from_path;
pub use write::{write_asc, write_geotiff};

use crate::{IoError, crs};
use bytes::ByteSource;
use part::Part;
use std::path::{Path, PathBuf};
use yamanami_core::{Crs, GeoReference};

/// What the caller knows better than the files.
#[derive(Debug, Clone)]
pub struct OpenOptions {
    /// Stands over the CRS of every file: for files without one, or to mix datums knowingly.
    pub crs: Option<Crs>,
    /// Colours of picture tiles; else from the name, else from the colours themselves.
    pub tile_encoding: Option<TileEncoding>,
    /// Zoom, column and row of a single picture tile; else from its path.
    pub tile: Option<[u32; 3]>,
    /// Zoom to take from a `z/x/y` folder; else the deepest.
    pub zoom: Option<u32>,
    /// Bytes of decoded chunks kept in memory.
    pub cache_bytes: usize,
    /// Most samples that [`DemFile::read_all`] may bring into memory.
    pub max_samples: u64,
}

impl Default for OpenOptions {
    fn default() -> Self {
        Self { crs: None, tile_encoding: None, tile: None, zoom: None, cache_bytes: 64 << 20, max_samples: 1 << 28 }
    }
}

/// What is known of an elevation grid before its heights are read.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct DemInfo {
    /// Readable name of the format, e.g. `cloud-optimised GeoTIFF`; several joined by ` + `.
    pub format: String,
    /// Grids the mosaic is made of.
    pub files: usize,
    /// Columns and rows.
    pub size: [usize; 2],
    /// How heights are stored.
    pub sample_type: SampleType,
    /// Where the grid lies.
    pub geo: GeoReference,
    /// The stored value that means no-data, as stated in the (first) file.
    pub no_data: Option<f64>,
    /// Compression of the (first) file.
    pub compression: String,
    /// Sizes of the reduced images stored beside the first; they are not used.
    pub overviews: Vec<[usize; 2]>,
    /// Columns and rows that are decoded together.
    pub chunk: [usize; 2],
    /// What had to be assumed, one line each.
    pub notes: Vec<String>,
}

/// Opens files and folders as one grid. Later files fill where earlier ones have no data.
pub fn open(paths: &[PathBuf], options: &OpenOptions) -> Result<DemFile, IoError> {
    DemFile::new(open_parts(paths, options)?, options)
}

/// Opens files and folders as few mosaics: grids that lie upon each other together, others apart, in the order in which
/// they are first met. So sources of several resolutions and systems can be read side by side. Grids on both sides of the
/// antimeridian are neighbours: longitudes of a mosaic may go beyond 180°.
pub fn open_mosaics(paths: &[PathBuf], options: &OpenOptions) -> Result<Vec<DemFile>, IoError> {
    let mut mosaics: Vec<Vec<Box<dyn Part>>> = Vec::new();
    for mut part in open_parts(paths, options)? {
        let mut fits = |mosaic: &&mut Vec<Box<dyn Part>>| {
            let first = mosaic[0].info();
            let mut info = part.info().clone();
            if let Some(round) = crs::way_round(&info.geo.crs) {
                info.geo.origin[0] += round * ((first.geo.origin[0] - info.geo.origin[0]) / round).round();
            }
            let fits = mosaic::offset(first, &info).is_ok();
            if fits {
                *part.info_mut() = info;
            }
            fits
        };
        match mosaics.iter_mut().find(&mut fits) {
            Some(mosaic) => mosaic.push(part),
            None => mosaics.push(vec![part]),
        }
    }
    mosaics.into_iter().map(|parts| DemFile::new(parts, options)).collect()
}

fn open_parts(paths: &[PathBuf], options: &OpenOptions) -> Result<Vec<Box<dyn Part>>, IoError> {
    let mut parts = Vec::new();
    for path in paths {
        if path.is_dir() {
            detect::open_folder(path, options, &mut parts)?;
        } else {
            detect::open_file(&ByteSource::file(path)?, options, &mut parts)?;
        }
    }
    Ok(parts)
}

/// Opens the content of one file; `name` stands for its path.
pub fn from_bytes(name: impl AsRef<Path>, bytes: Vec<u8>, options: &OpenOptions) -> Result<DemFile, IoError> {
    let mut parts = Vec::new();
    detect::open_file(&ByteSource::memory(name.as_ref(), bytes.into()), options, &mut parts)?;
    DemFile::new(parts, options)
}
