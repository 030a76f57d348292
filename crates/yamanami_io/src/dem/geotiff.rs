//! GeoTIFF, cloud-optimised or not: one band of heights in strips or tiles, read chunk by chunk.
//!
//! Sparse chunks (GDAL leaves out chunks that are all no-data) are no-data; uncompressed strips of any size are read by
//! rows. Overviews are listed and not used.

use super::bytes::{ByteSource, RandomReader};
use super::geo_keys::GeoTags;
use super::part::{Part, PartInfo, checked_size, clean};
use super::tiff_codec::{Compression, Predictor, heights, undo_predictor};
use super::tiff_tags::{self as tags, ByteOrder, Directory, Tiff};
use super::{OpenOptions, SampleType};
use crate::IoError;
use std::path::Path;

/// A strip or tile larger than this is not decoded.
const MAX_CHUNK_BYTES: u64 = 512 << 20;
/// Uncompressed strips above this are read by rows.
const LARGE_STRIP_BYTES: u64 = 1 << 20;
const MAX_IMAGES: usize = 64;
/// What 16-bit heights without a no-data tag use since SRTM.
const SRTM_NO_DATA: f64 = -32768.0;

pub(super) struct GeoTiff {
    info: PartInfo,
    reader: RandomReader,
    /// Columns and rows of the file's own chunks.
    tiff_chunk: [usize; 2],
    chunk_offsets: Vec<u64>,
    chunk_bytes: Vec<u64>,
    compression: Compression,
    predictor: Predictor,
    byte_order: ByteOrder,
    /// Set when rows are read directly, not whole strips.
    reads_rows: bool,
    no_data: f64,
    /// Metres = scale × stored + offset.
    scale: [f64; 2],
}

/// Sample type, from format and bits.
fn sample_type(label: &Path, format: u64, bits: u64) -> Result<SampleType, IoError> {
    Ok(match (format, bits) {
        (1 | 4, 8) => SampleType::U8,
        (1 | 4, 16) => SampleType::U16,
        (1 | 4, 32) => SampleType::U32,
        (1, 64) => SampleType::U64,
        (2, 8) => SampleType::I8,
        (2, 16) => SampleType::I16,
        (2, 32) => SampleType::I32,
        (2, 64) => SampleType::I64,
        (3, 16) => SampleType::F16,
        (3, 32) => SampleType::F32,
        (3, 64) => SampleType::F64,
        _ => {
            let what = format!("samples of format {format} with {bits} bits");
            let hint = "convert it with gdal_translate -ot Float32";
            return Err(IoError::unsupported(label, what, hint));
        }
    })
}

fn compression(label: &Path, code: u64) -> Result<Compression, IoError> {
    u16::try_from(code).ok().and_then(Compression::from_code).ok_or_else(|| {
        let name = match code {
            2..=4 => "CCITT fax",
            6 | 7 => "JPEG",
            34887 => "LERC",
            34925 => "LZMA",
            50001 => "WebP",
            50002 => "JPEG XL",
            _ => "an unknown kind",
        };
        let hint = "convert it with gdal_translate -co COMPRESS=DEFLATE";
        IoError::unsupported(label, format!("compression {code} ({name})"), hint)
    })
}

pub(super) fn open(source: &ByteSource, options: &OpenOptions) -> Result<GeoTiff, IoError> {
    let label = source.label();
    let mut tiff = Tiff::open(RandomReader::unpacking(source.clone()))?;
    let directory = tiff.directory(tiff.first)?;
    let width = tiff.number_or(&directory, tags::IMAGE_WIDTH, 0)?;
    let size = checked_size(label, width, tiff.number_or(&directory, tags::IMAGE_LENGTH, 0)?)?;

    let bands = tiff.number_or(&directory, tags::SAMPLES_PER_PIXEL, 1)?;
    if bands != 1 {
        let what = format!("{bands} bands (a picture?)");
        return Err(IoError::unsupported(label, what, "pick the band of heights with gdal_translate -b"));
    }
    let photometric = tiff.number_or(&directory, tags::PHOTOMETRIC_INTERPRETATION, 1)?;
    if photometric != 1 {
        let what = format!("a picture (photometric interpretation {photometric})");
        return Err(IoError::unsupported(label, what, "heights are one band, black is zero"));
    }
    let bits = tiff.number_or(&directory, tags::BITS_PER_SAMPLE, 1)?;
    let sample_type = sample_type(label, tiff.number_or(&directory, tags::SAMPLE_FORMAT, 1)?, bits)?;
    let compression = compression(label, tiff.number_or(&directory, tags::COMPRESSION, 1)?)?;
    let (predictor, predictor_name) = match tiff.number_or(&directory, tags::PREDICTOR, 1)? {
        _ if compression == Compression::None => (Predictor::None, ""),
        1 => (Predictor::None, ""),
        2 => (Predictor::Horizontal, ", horizontal predictor"),
        3 if sample_type.is_float() => (Predictor::FloatingPoint, ", floating-point predictor"),
        other => {
            let found = format!("{other} with {sample_type} samples");
            return Err(IoError::malformed(label, "tag 317 (predictor)", "1, 2, or 3 for floats", found));
        }
    };
    let Chunks { is_tiled, size: tiff_chunk, offsets: chunk_offsets, bytes: chunk_bytes } =
        chunks(&mut tiff, &directory, size, sample_type)?;
    let unit = if is_tiled { "tile" } else { "strip" };
    let bytes_per_sample = sample_type.bytes() as u64;
    let one_chunk_bytes = (tiff_chunk[0] as u64).saturating_mul(tiff_chunk[1] as u64).saturating_mul(bytes_per_sample);
    let reads_rows = compression == Compression::None && !is_tiled && one_chunk_bytes > LARGE_STRIP_BYTES;
    let largest = chunk_bytes.iter().copied().max().unwrap_or(0).max(one_chunk_bytes);
    if !reads_rows && largest > MAX_CHUNK_BYTES {
        return Err(IoError::too_large(label, format!("bytes of one {unit}"), largest, MAX_CHUNK_BYTES));
    }
    let row_bytes = size[0] as u64 * bytes_per_sample;
    let chunk = if reads_rows { [size[0], (LARGE_STRIP_BYTES / row_bytes).max(1) as usize] } else { tiff_chunk };

    let geo_tags = GeoTags::read(&mut tiff, &directory)?;
    let placement = geo_tags.place(label, size, options.crs.as_ref())?;
    let declared = tiff.text(&directory, tags::GDAL_NO_DATA)?.trim().parse::<f64>().ok();
    let implied = (sample_type == SampleType::I16).then_some(SRTM_NO_DATA);
    let metadata = tiff.text(&directory, tags::GDAL_METADATA)?;
    let scale = [
        metadata_number(&metadata, "scale").unwrap_or(1.0),
        metadata_number(&metadata, "offset").unwrap_or(0.0),
    ]
    .map(|v| v * placement.metres_per_unit);
    let mut notes = placement.notes;
    if scale != [1.0, 0.0] {
        notes.push(format!("heights are {} x stored + {} m", scale[0], scale[1]));
    }
    let first_data = chunk_offsets.iter().zip(&chunk_bytes).filter(|(_, b)| **b > 0).map(|(o, _)| *o).min();
    let overviews = overviews(&mut tiff, directory.next);
    let is_cloud_optimised = is_tiled && !overviews.is_empty() && first_data.is_some_and(|data| tiff.first < data);
    let format = match (is_cloud_optimised, geo_tags.directory.is_empty()) {
        (true, _) => "cloud-optimised GeoTIFF",
        (false, false) => "GeoTIFF",
        (false, true) => "TIFF",
    };
    let info = PartInfo {
        label: label.to_owned(),
        format: if tiff.is_big { format!("{format} (BigTIFF)") } else { format.to_owned() },
        size,
        geo: placement.geo,
        sample_type,
        no_data: declared,
        compression: format!("{}{predictor_name}", compression.name()),
        overviews,
        chunk,
        notes,
    };
    Ok(GeoTiff {
        info,
        byte_order: tiff.order,
        reader: tiff.reader,
        tiff_chunk,
        chunk_offsets,
        chunk_bytes,
        compression,
        predictor,
        reads_rows,
        no_data: declared.or(implied).unwrap_or(f64::NAN),
        scale,
    })
}

/// Strips or tiles of an image.
struct Chunks {
    is_tiled: bool,
    /// Columns and rows of each.
    size: [usize; 2],
    offsets: Vec<u64>,
    bytes: Vec<u64>,
}

/// The table of strips or tiles, checked against the size of the image and of the file.
fn chunks(
    tiff: &mut Tiff,
    directory: &Directory,
    size: [usize; 2],
    sample_type: SampleType,
) -> Result<Chunks, IoError> {
    let label = tiff.reader.source().label().to_owned();
    let offsets = tiff.numbers(directory, tags::TILE_OFFSETS)?;
    let is_tiled = !offsets.is_empty();
    let (offsets, mut bytes) = if is_tiled {
        (offsets, tiff.numbers(directory, tags::TILE_BYTE_COUNTS)?)
    } else {
        (tiff.numbers(directory, tags::STRIP_OFFSETS)?, tiff.numbers(directory, tags::STRIP_BYTE_COUNTS)?)
    };
    let [width, height] = if is_tiled {
        [
            tiff.number_or(directory, tags::TILE_WIDTH, 0)?,
            tiff.number_or(directory, tags::TILE_LENGTH, 0)?,
        ]
    } else {
        let rows = tiff.number_or(directory, tags::ROWS_PER_STRIP, size[1] as u64)?;
        [size[0] as u64, rows.min(size[1] as u64)]
    };
    let unit = if is_tiled { "tile" } else { "strip" };
    if width == 0 || height == 0 || width > 1 << 31 || height > 1 << 31 {
        let found = format!("{width}x{height}");
        return Err(IoError::malformed(label, format!("{unit} size"), "1 to 2^31 columns and rows", found));
    }
    let chunk = [width as usize, height as usize];
    let count = size[0].div_ceil(chunk[0]) * size[1].div_ceil(chunk[1]);
    if bytes.is_empty() && count == 1 {
        // Old writers leave the count of a single uncompressed strip out.
        bytes.push((size[0] * size[1] * sample_type.bytes()) as u64);
    }
    if offsets.len() != count || bytes.len() != count {
        let found = format!("{} offsets and {} byte counts", offsets.len(), bytes.len());
        return Err(IoError::malformed(label, format!("{unit} table"), format!("{count} {unit}s"), found));
    }
    for (i, (offset, bytes)) in offsets.iter().zip(&bytes).enumerate() {
        if *bytes > 0 && offset.saturating_add(*bytes) > tiff.file_bytes {
            let expected = format!("{bytes} bytes at byte {offset}");
            let found = format!("a file of {} bytes", tiff.file_bytes);
            return Err(IoError::malformed(label, format!("{unit} {i} of {count}"), expected, found));
        }
    }
    Ok(Chunks { is_tiled, size: chunk, offsets, bytes })
}

/// A number of GDAL's metadata XML that belongs to the first band, by role.
fn metadata_number(metadata: &str, role: &str) -> Option<f64> {
    let wanted = format!("role=\"{role}\"");
    metadata.split("<Item").skip(1).find_map(|item| {
        let (attributes, rest) = item.split_once('>')?;
        let is_first_band = !attributes.contains("sample=") || attributes.contains("sample=\"0\"");
        (attributes.contains(&wanted) && is_first_band).then(|| rest.split('<').next()?.trim().parse().ok())?
    })
}

/// Sizes of the reduced images that follow the first; broken directories end the list.
fn overviews(tiff: &mut Tiff, mut next: u64) -> Vec<[usize; 2]> {
    const REDUCED: u64 = 1;
    const MASK: u64 = 4;
    let mut sizes = Vec::new();
    for _ in 1..MAX_IMAGES {
        let mut read = || -> Result<_, IoError> {
            let directory = tiff.directory(next)?;
            let kind = tiff.number_or(&directory, tags::NEW_SUBFILE_TYPE, 0)?;
            let width = tiff.number_or(&directory, tags::IMAGE_WIDTH, 0)?;
            Ok((directory.next, kind, [width, tiff.number_or(&directory, tags::IMAGE_LENGTH, 0)?]))
        };
        let Some((following, kind, size)) = (next != 0).then(|| read().ok()).flatten() else { break };
        if kind & REDUCED != 0 && kind & MASK == 0 {
            sizes.push(size.map(|n| n as usize));
        }
        next = following;
    }
    sizes
}

impl GeoTiff {
    /// Adds the heights of rows of stored samples, of which the first `width` of each are wanted.
    fn convert(&self, stored: &[u8], row_bytes: usize, width: usize, out: &mut Vec<f32>) {
        let sample_type = self.info.sample_type;
        let no_data = self.no_data;
        // A no-data value of a float file may have been rounded on its way through text.
        let no_data_f32 = if sample_type == SampleType::F32 { f64::from(no_data as f32) } else { no_data };
        let [scale, offset] = self.scale;
        let height = |z: f64| {
            if z == no_data || z == no_data_f32 { f32::NAN } else { clean((z * scale + offset) as f32) }
        };
        for row in stored.chunks_exact(row_bytes) {
            heights(&row[..width * sample_type.bytes()], sample_type, height, out);
        }
    }

    /// Rows of an uncompressed image, through its strips.
    fn read_rows(&mut self, first_row: usize, rows: usize) -> Result<Vec<f32>, IoError> {
        let width = self.info.size[0];
        let sample_bytes = self.info.sample_type.bytes();
        let row_bytes = width * sample_bytes;
        let mut heights_m = Vec::with_capacity(width * rows);
        let mut bytes = vec![0; row_bytes];
        for row in first_row..first_row + rows {
            let strip = row / self.tiff_chunk[1];
            let inside = ((row % self.tiff_chunk[1]) * row_bytes) as u64;
            if self.chunk_bytes[strip] == 0 {
                heights_m.resize(heights_m.len() + width, f32::NAN);
                continue;
            }
            if inside + row_bytes as u64 > self.chunk_bytes[strip] {
                let expected = format!("{} bytes", inside + row_bytes as u64);
                let found = self.chunk_bytes[strip].to_string();
                return Err(IoError::malformed(&self.info.label, format!("strip {strip}"), expected, found));
            }
            self.reader.read_exact_at(self.chunk_offsets[strip] + inside, &mut bytes)?;
            undo_predictor(&mut bytes, row_bytes, sample_bytes, Predictor::None, self.byte_order);
            self.convert(&bytes, row_bytes, width, &mut heights_m);
        }
        Ok(heights_m)
    }
}

impl Part for GeoTiff {
    fn info(&self) -> &PartInfo {
        &self.info
    }

    fn info_mut(&mut self) -> &mut PartInfo {
        &mut self.info
    }

    fn read_chunk(&mut self, chunk: [usize; 2]) -> Result<Vec<f32>, IoError> {
        let [_, row, width, rows] = self.info.chunk_range(chunk);
        if self.reads_rows {
            return self.read_rows(row, rows);
        }
        let index = chunk[1] * self.info.size[0].div_ceil(self.tiff_chunk[0]) + chunk[0];
        if self.chunk_bytes[index] == 0 {
            return Ok(vec![f32::NAN; width * rows]);
        }
        let mut packed = vec![0; self.chunk_bytes[index] as usize];
        self.reader.read_exact_at(self.chunk_offsets[index], &mut packed)?;
        let sample_bytes = self.info.sample_type.bytes();
        let row_bytes = self.tiff_chunk[0] * sample_bytes;
        // A last strip may end with the image, a tile is always whole; rows that are not wanted are left packed.
        let wanted = row_bytes * rows;
        let mut stored = self.compression.unpack(packed, wanted).map_err(|found| {
            let place = format!("chunk {index} at byte {}", self.chunk_offsets[index]);
            IoError::malformed(&self.info.label, place, format!("{wanted} unpacked bytes"), found)
        })?;
        undo_predictor(&mut stored, row_bytes, sample_bytes, self.predictor, self.byte_order);
        let mut heights_m = Vec::with_capacity(width * rows);
        self.convert(&stored, row_bytes, width, &mut heights_m);
        Ok(heights_m)
    }

    fn close(&mut self) {
        self.reader.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scale_and_offset_are_found_in_metadata() {
        let text = r#"<GDALMetadata><Item name="SCALE" sample="1" role="scale">9</Item><Item name="SCALE" sample="0" role="scale"> 0.5 </Item></GDALMetadata>"#;
        assert_eq!(metadata_number(text, "scale"), Some(0.5));
        assert_eq!(metadata_number(text, "offset"), None);
    }
}
