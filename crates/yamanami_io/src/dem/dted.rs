//! DTED levels 0, 1 and 2: profiles from south to north, one after the other from west to east.
//!
//! Format: MIL-PRF-89020B, "Digital Terrain Elevation Data (DTED)", 2000.

use super::bytes::{ByteSource, RandomReader};
use super::part::{Part, PartInfo, checked_size};
use super::{OpenOptions, SampleType};
use crate::{IoError, crs};
use yamanami_core::GeoReference;

/// User header label, data set identification and accuracy description come before the profiles.
const UHL_BYTES: u64 = 80;
const DSI_BYTES: u64 = 648;
const ACC_BYTES: u64 = 2700;
/// A profile starts with a mark, a block count and its two counts, and ends with a checksum.
const PROFILE_HEAD_BYTES: usize = 8;
const PROFILE_EXTRA_BYTES: usize = 12;
const PROFILE_MARK: u8 = 0xAA;
const NO_DATA: i16 = -32767;
/// Nothing on Earth is this deep: such a code is a two's complement number written against the specification.
const LOWEST_SIGNED_MAGNITUDE_M: i16 = -16000;
const PROFILES_PER_CHUNK: usize = 32;

/// Offset of the user header label; magnetic tape labels may come before it.
pub(super) fn header_offset(head: &[u8]) -> Option<u64> {
    [0, 80, 160]
        .into_iter()
        .find(|&at| {
            let is_tape_label = at == 0 || head.starts_with(b"VOL") || head.starts_with(b"HDR");
            is_tape_label && head.get(at..at + 4) == Some(b"UHL1")
        })
        .map(|at| at as u64)
}

pub(super) struct Dted {
    info: PartInfo,
    reader: RandomReader,
    first_profile: u64,
}

pub(super) fn open(source: &ByteSource, options: &OpenOptions) -> Result<Dted, IoError> {
    let label = source.label();
    let Some(start) = header_offset(&source.head(256)?) else {
        return Err(IoError::malformed(label, "start", "a DTED user header label (UHL1)", "something else"));
    };
    let mut reader = RandomReader::new(source.clone());
    let mut uhl = [0; UHL_BYTES as usize];
    reader.read_exact_at(start, &mut uhl)?;
    let number = |name: &str, from: usize, to: usize| -> Result<u32, IoError> {
        let text = String::from_utf8_lossy(&uhl[from..to]).into_owned();
        text.trim().parse().map_err(|_| IoError::malformed(label, format!("UHL, {name}"), "a number", quoted(&text)))
    };
    let angle = |name: &str, from: usize| -> Result<f64, IoError> {
        let text = String::from_utf8_lossy(&uhl[from..from + 8]).into_owned();
        angle_deg(&text)
            .ok_or_else(|| IoError::malformed(label, format!("UHL, {name}"), "an angle like 0110000E", quoted(&text)))
    };
    let origin_deg = [angle("longitude of origin", 4)?, angle("latitude of origin", 12)?];
    let step_deg = [number("longitude interval", 20, 24)?, number("latitude interval", 24, 28)?]
        .map(|tenths_of_second| f64::from(tenths_of_second) / 36_000.0);
    if step_deg.contains(&0.0) {
        return Err(IoError::malformed(label, "UHL, data interval", "more than 0", "0"));
    }
    let profiles = number("number of longitude lines", 47, 51)?;
    let rows = number("number of latitude points", 51, 55)?;
    let size = checked_size(label, profiles.into(), rows.into())?;
    let first_profile = start + UHL_BYTES + DSI_BYTES + ACC_BYTES;
    let wanted = first_profile + (PROFILE_EXTRA_BYTES + 2 * size[1]) as u64 * size[0] as u64;
    if source.length_bound() < wanted {
        let expected = format!("{wanted} bytes for {profiles} profiles of {rows} heights");
        return Err(IoError::malformed(label, "length", expected, format!("{} bytes", source.length_bound())));
    }
    let north = origin_deg[1] + step_deg[1] * (size[1] - 1) as f64;
    let crs = options.crs.clone().or_else(|| crs::from_epsg(4326)).unwrap_or_default();
    let level = match rows {
        0..=200 => 0,
        201..=2000 => 1,
        _ => 2,
    };
    let info = PartInfo {
        label: label.to_owned(),
        format: format!("DTED level {level}"),
        size,
        geo: GeoReference::new(crs, [origin_deg[0], north], [step_deg[0], -step_deg[1]], size),
        sample_type: SampleType::I16,
        no_data: Some(f64::from(NO_DATA)),
        compression: source.compression_name().to_owned(),
        overviews: Vec::new(),
        chunk: [PROFILES_PER_CHUNK, size[1]],
        notes: Vec::new(),
    };
    Ok(Dted { info, reader, first_profile })
}

fn quoted(text: &str) -> String {
    format!("'{}'", text.escape_default())
}

/// Degrees from `DDDMMSSH` (the hemisphere last).
fn angle_deg(text: &str) -> Option<f64> {
    let text = text.trim();
    let (digits, hemisphere) = text.split_at_checked(text.len().checked_sub(1)?)?;
    if digits.len() < 5 || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    let (degrees, rest) = digits.split_at(digits.len() - 4);
    let value = |t: &str| t.parse::<f64>().ok();
    let angle = value(degrees)? + value(&rest[..2])? / 60.0 + value(&rest[2..])? / 3600.0;
    match hemisphere {
        "N" | "E" => Some(angle),
        "S" | "W" => Some(-angle),
        _ => None,
    }
}

/// Height of a sign-and-magnitude code, NaN for the null code.
fn height_m(code: u16) -> f32 {
    let signed = code as i16;
    if signed >= 0 {
        return f32::from(signed);
    }
    let by_magnitude = -((code & 0x7FFF) as i16);
    if by_magnitude == NO_DATA {
        f32::NAN
    } else if by_magnitude >= LOWEST_SIGNED_MAGNITUDE_M {
        f32::from(by_magnitude)
    } else if signed <= NO_DATA {
        f32::NAN
    } else {
        f32::from(signed)
    }
}

impl Part for Dted {
    fn info(&self) -> &PartInfo {
        &self.info
    }

    fn info_mut(&mut self) -> &mut PartInfo {
        &mut self.info
    }

    fn read_chunk(&mut self, chunk: [usize; 2]) -> Result<Vec<f32>, IoError> {
        let [column, _, width, rows] = self.info.chunk_range(chunk);
        let profile_bytes = PROFILE_EXTRA_BYTES + 2 * rows;
        let offset = self.first_profile + (column * profile_bytes) as u64;
        let mut bytes = vec![0; width * profile_bytes];
        self.reader.read_exact_at(offset, &mut bytes)?;
        let mut heights_m = vec![f32::NAN; width * rows];
        for (i, profile) in bytes.chunks_exact(profile_bytes).enumerate() {
            if profile[0] != PROFILE_MARK {
                let place = format!("profile {}, byte {}", column + i, offset + (i * profile_bytes) as u64);
                let found = format!("{:#04x}", profile[0]);
                return Err(IoError::malformed(&self.info.label, place, "the profile mark 0xaa", found));
            }
            let codes = profile[PROFILE_HEAD_BYTES..].chunks_exact(2).take(rows);
            for (from_south, code) in codes.enumerate() {
                heights_m[(rows - 1 - from_south) * width + i] = height_m(u16::from_be_bytes([code[0], code[1]]));
            }
        }
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
    fn angles_and_heights() {
        assert_eq!(angle_deg("0110000E"), Some(11.0));
        assert_eq!(angle_deg("1223015W"), Some(-(122.0 + 30.0 / 60.0 + 15.0 / 3600.0)));
        assert_eq!(angle_deg(" 490000S"), Some(-49.0));
        assert_eq!(angle_deg("0110000X"), None);
        assert_eq!(angle_deg("標高"), None);
        assert_eq!(angle_deg(""), None);
        assert_eq!(height_m(0x0010), 16.0);
        assert_eq!(height_m(0x8010), -16.0);
        assert!(height_m(0xFFFF).is_nan());
        assert_eq!(height_m(0xFFF0), -16.0, "two's complement");
        assert!(height_m(0x8001) == -1.0);
    }
}
