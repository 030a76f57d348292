//! SRTM `.hgt`: a square of big-endian 16-bit heights whose name gives its south-western corner.
//!
//! Format: NASA/USGS, "SRTM Topography" (Quickstart and SRTM_Topo.txt), 2003.

use super::bytes::{ByteSource, RandomReader};
use super::part::{Part, PartInfo};
use super::{OpenOptions, SampleType};
use crate::{IoError, crs};
use yamanami_core::GeoReference;

const NO_DATA: i16 = -32768;
const ROWS_PER_CHUNK: usize = 64;

/// Samples per side of a file of so many bytes, if it can be SRTM: 3 arc-seconds or 1 arc-second.
pub(super) fn side_from_length(length: u64) -> Option<usize> {
    [1201, 3601].into_iter().find(|side| length == 2 * side * side).map(|side| side as usize)
}

/// Longitude and latitude of the corner that a name like `N42E001` gives.
pub(super) fn corner_from_name(name: &str) -> Option<[f64; 2]> {
    let bytes = name.as_bytes();
    let digits = |range: std::ops::Range<usize>| -> Option<f64> {
        let text = bytes.get(range)?;
        text.iter().all(u8::is_ascii_digit).then(|| text.iter().fold(0.0, |n, d| n * 10.0 + f64::from(d - b'0')))
    };
    (0..bytes.len().saturating_sub(6)).find_map(|i| {
        if i > 0 && bytes[i - 1].is_ascii_alphanumeric() {
            return None;
        }
        let lat = digits(i + 1..i + 3)?;
        let lon = digits(i + 4..i + 7)?;
        let lat = match bytes[i] {
            b'N' | b'n' => lat,
            b'S' | b's' => -lat,
            _ => return None,
        };
        let lon = match bytes[i + 3] {
            b'E' | b'e' => lon,
            b'W' | b'w' => -lon,
            _ => return None,
        };
        (lat.abs() <= 90.0 && lon.abs() <= 180.0).then_some([lon, lat])
    })
}

pub(super) struct Hgt {
    info: PartInfo,
    reader: RandomReader,
}

/// Opens an `.hgt`; `names` are tried in turn for the corner (member, then archive).
pub(super) fn open(source: &ByteSource, options: &OpenOptions) -> Result<Hgt, IoError> {
    let label = source.label();
    let Some(side) = source.length().and_then(side_from_length) else {
        let found = source.length().map_or("an unknown length".to_owned(), |n| format!("{n} bytes"));
        let expected = "2884802 bytes (1201x1201) or 25934402 bytes (3601x3601)";
        return Err(IoError::malformed(label, "length of the SRTM file", expected, found));
    };
    let mut names = label.iter().rev().map(|part| part.to_string_lossy());
    let Some([lon, lat]) = names.by_ref().take(2).find_map(|name| corner_from_name(&name)) else {
        let expected = "the corner of the square, like N42E001.hgt";
        return Err(IoError::malformed(label, "file name", expected, source.file_name()));
    };
    let step = 1.0 / (side - 1) as f64;
    let geo = GeoReference::new(
        options.crs.clone().or_else(|| crs::from_epsg(4326)).unwrap_or_default(),
        [lon, lat + 1.0],
        [step, -step],
        [side, side],
    );
    let info = PartInfo {
        label: label.to_owned(),
        format: format!("SRTM{} hgt", if side == 3601 { 1 } else { 3 }),
        size: [side, side],
        geo,
        sample_type: SampleType::I16,
        no_data: Some(f64::from(NO_DATA)),
        compression: source.compression_name().to_owned(),
        overviews: Vec::new(),
        chunk: [side, ROWS_PER_CHUNK],
        notes: Vec::new(),
    };
    Ok(Hgt { info, reader: RandomReader::new(source.clone()) })
}

impl Part for Hgt {
    fn info(&self) -> &PartInfo {
        &self.info
    }

    fn info_mut(&mut self) -> &mut PartInfo {
        &mut self.info
    }

    fn read_chunk(&mut self, chunk: [usize; 2]) -> Result<Vec<f32>, IoError> {
        let [_, row, width, rows] = self.info.chunk_range(chunk);
        let mut bytes = vec![0; 2 * width * rows];
        self.reader.read_exact_at(2 * (row * width) as u64, &mut bytes)?;
        Ok(bytes
            .chunks_exact(2)
            .map(|b| match i16::from_be_bytes([b[0], b[1]]) {
                NO_DATA => f32::NAN,
                height => f32::from(height),
            })
            .collect())
    }

    fn close(&mut self) {
        self.reader.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_give_corners() {
        assert_eq!(corner_from_name("N42E001.hgt"), Some([1.0, 42.0]));
        assert_eq!(corner_from_name("s34w072.SRTMGL1.hgt"), Some([-72.0, -34.0]));
        assert_eq!(corner_from_name("srtm_N48W125_v2"), Some([-125.0, 48.0]));
        assert_eq!(corner_from_name("N99E001.hgt"), None);
        assert_eq!(corner_from_name("N4E001.hgt"), None);
        assert_eq!(corner_from_name("xN42E001.hgt"), None);
        assert_eq!(corner_from_name(""), None);
        assert_eq!(corner_from_name("標高N42E001"), Some([1.0, 42.0]));
    }
}
