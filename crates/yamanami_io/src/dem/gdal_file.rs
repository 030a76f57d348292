//! Everything else that GDAL reads, where it is installed (feature `gdal`): NetCDF, Erdas Imagine, LERC or JPEG 2000
//! rasters, virtual mosaics and many more. Only the first band is taken.

use super::bytes::ByteSource;
use super::part::{Part, PartInfo, checked_size, clean, guess_crs};
use super::{OpenOptions, SampleType};
use crate::{IoError, crs};
use gdal::raster::GdalDataType;
use gdal::{Dataset, errors::GdalError, spatial_ref::SpatialRef};
use std::path::{Path, PathBuf};
use yamanami_core::{Crs, GeoReference};

/// Rows of narrow blocks are read together up to this many samples.
const CHUNK_SAMPLES: usize = 1 << 16;
/// The largest block that is decoded at once.
const MAX_CHUNK_SAMPLES: usize = 1 << 27;

pub(super) struct GdalFile {
    info: PartInfo,
    path: PathBuf,
    dataset: Option<Dataset>,
    no_data: f64,
    scale: [f64; 2],
}

fn gdal_error(label: &Path, place: &str, error: GdalError) -> IoError {
    IoError::malformed(label, place, "data that GDAL can read", error.to_string())
}

/// Opens a file by GDAL; `None` when GDAL does not know it either, or it is not a file of its own.
pub(super) fn open(source: &ByteSource, options: &OpenOptions) -> Result<Option<GdalFile>, IoError> {
    let label = source.label();
    let Some(path) = source.path() else { return Ok(None) };
    let Ok(dataset) = Dataset::open(path) else { return Ok(None) };
    if dataset.raster_count() == 0 {
        return Ok(None);
    }
    let fail = |place: &'static str| move |e| gdal_error(label, place, e);
    let (width, height) = dataset.raster_size();
    let size = checked_size(label, width as u64, height as u64)?;
    let band = dataset.rasterband(1).map_err(fail("band 1"))?;
    let [x, step_x, turn_x, y, turn_y, step_y] = dataset.geo_transform().unwrap_or([0.0, 1.0, 0.0, 0.0, 0.0, -1.0]);
    if turn_x != 0.0 || turn_y != 0.0 || step_x <= 0.0 || step_y >= 0.0 {
        return Err(IoError::unsupported(label, "a grid that is not north-up", "warp it first (gdalwarp)"));
    }
    let (origin, step) = ([x + 0.5 * step_x, y + 0.5 * step_y], [step_x, step_y]);
    let mut notes = Vec::new();
    let crs = match (&options.crs, dataset.spatial_ref()) {
        (Some(crs), _) => crs.clone(),
        (None, Ok(spatial_ref)) => crs_of(label, &spatial_ref)?,
        (None, Err(_)) => guess_crs(origin, [step_x, -step_y], size, &mut notes),
    };
    let foot_m = match band.unit().to_ascii_lowercase().as_str() {
        "ft" | "foot" | "feet" => 0.3048,
        "us survey foot" | "us-ft" => 1200.0 / 3937.0,
        _ => 1.0,
    };
    let (block_width, block_height) = band.block_size();
    let block = [block_width.clamp(1, size[0]), block_height.clamp(1, size[1])];
    let rows = if block[0] == size[0] { (CHUNK_SAMPLES / size[0]).next_multiple_of(block[1]) } else { block[1] };
    let chunk = [block[0], rows.clamp(1, size[1])];
    if chunk[0].saturating_mul(chunk[1]) > MAX_CHUNK_SAMPLES {
        let given = chunk[0].saturating_mul(chunk[1]) as u64;
        return Err(IoError::too_large(label, "samples of a block", given, MAX_CHUNK_SAMPLES as u64));
    }
    let info = PartInfo {
        label: label.to_owned(),
        format: format!("{} (by GDAL)", dataset.driver().long_name()),
        size,
        geo: GeoReference::new(crs, origin, step, size),
        sample_type: match band.band_type() {
            GdalDataType::UInt8 => SampleType::U8,
            GdalDataType::UInt16 => SampleType::U16,
            GdalDataType::Int16 => SampleType::I16,
            GdalDataType::UInt32 => SampleType::U32,
            GdalDataType::Int32 => SampleType::I32,
            GdalDataType::Float64 => SampleType::F64,
            _ => SampleType::F32,
        },
        no_data: band.no_data_value(),
        compression: "by GDAL".to_owned(),
        overviews: Vec::new(),
        chunk,
        notes,
    };
    let scale = [band.scale().unwrap_or(1.0) * foot_m, band.offset().unwrap_or(0.0) * foot_m];
    let no_data = info.no_data.unwrap_or(f64::NAN);
    Ok(Some(GdalFile { info, path: path.to_owned(), dataset: None, no_data, scale }))
}

fn crs_of(label: &Path, spatial_ref: &SpatialRef) -> Result<Crs, IoError> {
    let is_epsg = spatial_ref.auth_name().is_some_and(|name| name == "EPSG");
    let epsg = if is_epsg { spatial_ref.auth_code().ok().and_then(|code| u32::try_from(code).ok()) } else { None };
    if let Some(known) = epsg.and_then(crs::from_epsg) {
        return Ok(known);
    }
    let name = spatial_ref.name().unwrap_or_default();
    let geographic = spatial_ref.is_geographic();
    if !geographic && (spatial_ref.linear_units() - 1.0).abs() > 1e-9 {
        let what = format!("'{name}' with a linear unit of {} m", spatial_ref.linear_units());
        return Err(IoError::unsupported(label, what, "warp it to a CRS in metres first"));
    }
    Ok(Crs { epsg, geographic, web_mercator: false, name })
}

impl Part for GdalFile {
    fn info(&self) -> &PartInfo {
        &self.info
    }

    fn info_mut(&mut self) -> &mut PartInfo {
        &mut self.info
    }

    fn read_chunk(&mut self, chunk: [usize; 2]) -> Result<Vec<f32>, IoError> {
        let [column, row, width, rows] = self.info.chunk_range(chunk);
        let label = &self.info.label;
        let dataset = match self.dataset.take() {
            Some(dataset) => dataset,
            None => Dataset::open(&self.path).map_err(|e| gdal_error(label, "opening it again", e))?,
        };
        let mut stored = vec![0f64; width * rows];
        let start = (column as isize, row as isize);
        let read = dataset
            .rasterband(1)
            .and_then(|band| band.read_into_slice(start, (width, rows), (width, rows), &mut stored, None));
        self.dataset = Some(dataset);
        read.map_err(|e| gdal_error(label, &format!("block at column {column}, row {row}"), e))?;
        let [scale, offset] = self.scale;
        let height = |z: &f64| if *z == self.no_data { f32::NAN } else { clean((z * scale + offset) as f32) };
        Ok(stored.iter().map(height).collect())
    }

    fn close(&mut self) {
        self.dataset = None;
    }
}
