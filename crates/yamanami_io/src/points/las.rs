//! LAS point clouds, plain or packed as LAZ.
//!
//! Format: ASPRS, "LAS Specification" 1.4-R15, 2019. Only places, classes and the marks of withdrawn points are read.

use super::georef::{self, Georef};
use super::laz_source::LazRecords;
use super::source::{ReadSeek, Source};
use super::{PointReadOptions, ReadPoints};
use crate::IoError;
use glam::DVec3;
use std::io::{Read, SeekFrom};
use std::path::Path;

const GROUND: u8 = 2;
/// Low noise and high noise.
const NOISE: [u8; 2] = [7, 18];
const SHORT_HEADER_BYTES: usize = 227;
const LONG_HEADER_BYTES: usize = 375;
const RECORD_HEADER_BYTES: u64 = 54;
/// Variable-length records: more are no survey's, and what is kept of them is small.
const MOST_RECORDS: u32 = 10_000;
/// Bytes of the shortest record of each point format.
const FORMAT_BYTES: [usize; 11] = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67];
/// Points read at a time.
const BATCH: usize = 4096;
/// Packed points take a byte at least, nearly always more; a file that promises so many times more is broken.
const MOST_POINTS_A_BYTE: u64 = 200;

/// What the header says.
struct Header {
    points_at: u64,
    records_at: u64,
    records: u32,
    /// Number of the point format, without the bits that mark packing.
    format: u8,
    is_packed: bool,
    point_bytes: usize,
    points: u64,
    scale: DVec3,
    offset: DVec3,
}

pub(super) fn read(source: Source<'_>, options: &PointReadOptions) -> Result<ReadPoints, IoError> {
    let (label, length) = (source.label().to_owned(), source.length());
    let mut bytes = source.into_bytes();
    let header = Header::read(&mut *bytes, &label, length)?;
    let (georef, laz) = read_records(&mut *bytes, &header, &label)?;
    bytes.seek(SeekFrom::Start(header.points_at)).map_err(|e| IoError::io(&label, e))?;

    let mut notes = Vec::new();
    let unit_m = options.unit_m.or(georef.unit_m).unwrap_or_else(|| {
        notes.push("the file does not say its unit: taken as metres".to_owned());
        1.0
    });
    // heights are in the unit of the plan unless the file says otherwise
    let height_unit_m = if options.unit_m.is_some() { unit_m } else { georef.height_unit_m.unwrap_or(unit_m) };
    let mut kept = Kept {
        points_m: Vec::new(),
        options,
        ground_only: false,
        axes: [0, 1, 2].map(|k| {
            let unit_m = if k == 2 { height_unit_m } else { unit_m };
            Axis::new(header.scale[k], header.offset[k], unit_m)
        }),
        format: header.format,
        withheld: 0,
        left_out: 0,
    };
    let read = if header.is_packed {
        let Some(laz) = laz else {
            return Err(IoError::malformed(&label, "header", "the record of a LAZ file", "none"));
        };
        let records = LazRecords::new(bytes, &laz, header.point_bytes, header.points_at, length, &label)?;
        kept.take_all(records, &header)
    } else {
        kept.take_all(PlainRecords(bytes), &header)
    };
    if read < header.points {
        notes.push(format!("the points end after {read} of {}", header.points));
    }
    kept.note(&mut notes);
    Ok(ReadPoints { points_m: kept.points_m, unit_m, crs: georef.crs, notes })
}

impl Header {
    fn read(bytes: &mut dyn ReadSeek, label: &Path, length: u64) -> Result<Self, IoError> {
        let mut h = [0; LONG_HEADER_BYTES];
        let there = length.min(LONG_HEADER_BYTES as u64) as usize;
        bytes.read_exact(&mut h[..there]).map_err(|e| IoError::io(label, e))?;
        if there < SHORT_HEADER_BYTES || !h.starts_with(b"LASF") {
            return Err(IoError::malformed(label, "byte 0", "a LAS header", "something else"));
        }
        let (u16_at, u32_at) = (|at: usize| u16::from_le_bytes([h[at], h[at + 1]]), |at: usize| u32_of(&h, at));
        let u64_at = |at: usize| u64::from(u32_of(&h, at)) | u64::from(u32_of(&h, at + 4)) << 32;
        let f64s_at = |at: usize| DVec3::from([0, 8, 16].map(|step| f64::from_bits(u64_at(at + step))));
        let header_bytes = u16_at(94);
        let is_long = h[25] >= 4 && usize::from(header_bytes) >= LONG_HEADER_BYTES && there == LONG_HEADER_BYTES;
        let header = Self {
            points_at: u64::from(u32_at(96)),
            records_at: u64::from(header_bytes),
            records: u32_at(100),
            format: h[104] & 0x3f,
            is_packed: h[104] & 0x80 != 0,
            point_bytes: usize::from(u16_at(105)),
            points: if is_long { u64_at(247) } else { u64::from(u32_at(107)) },
            scale: f64s_at(131),
            offset: f64s_at(155),
        };
        let bad = |place: &str, expected: &str, found: String| Err(IoError::malformed(label, place, expected, found));
        match FORMAT_BYTES.get(usize::from(header.format)) {
            None => return bad("byte 104", "a point format from 0 to 10", header.format.to_string()),
            Some(&least) if header.point_bytes < least => {
                return bad("byte 105", "the length of a point of its format", header.point_bytes.to_string());
            }
            Some(_) => {}
        }
        if header.points_at > length || header.records_at > header.points_at {
            return bad(
                "byte 96",
                "where points start, in the file and behind the header",
                header.points_at.to_string(),
            );
        }
        if !header.scale.is_finite() || !header.offset.is_finite() || header.scale.cmple(DVec3::ZERO).any() {
            return bad("byte 131", "scales above 0 and finite offsets", "others".into());
        }
        let most = if header.is_packed {
            length.saturating_mul(MOST_POINTS_A_BYTE)
        } else {
            // the points of a plain file that was cut off are read all the same
            u64::MAX
        };
        if header.points > most {
            return Err(IoError::too_large(label, "points of so small a file", header.points, most));
        }
        Ok(header)
    }
}

fn u32_of(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
}

/// Reads the variable-length records between header and points: where the file lies, and how it is packed.
fn read_records(bytes: &mut dyn ReadSeek, header: &Header, label: &Path) -> Result<(Georef, Option<Vec<u8>>), IoError> {
    let io = |e| IoError::io(label, e);
    let (mut keys, mut text, mut wkt, mut laz) = (Vec::new(), Vec::new(), None, None);
    let mut at = header.records_at;
    for _ in 0..header.records.min(MOST_RECORDS) {
        if at + RECORD_HEADER_BYTES > header.points_at {
            break;
        }
        bytes.seek(SeekFrom::Start(at)).map_err(io)?;
        let mut h = [0; RECORD_HEADER_BYTES as usize];
        bytes.read_exact(&mut h).map_err(io)?;
        let length = u64::from(u16::from_le_bytes([h[20], h[21]]));
        at += RECORD_HEADER_BYTES + length;
        if at > header.points_at {
            break;
        }
        let user = h[2..18].split(|&b| b == 0).next().unwrap_or_default();
        let number = u16::from_le_bytes([h[18], h[19]]);
        let slot = match (user, number) {
            (b"LASF_Projection", 34735) => &mut keys,
            (b"LASF_Projection", 34737) => &mut text,
            (b"LASF_Projection", 2112) => wkt.get_or_insert_default(),
            (b"laszip encoded", 22204) => laz.get_or_insert_default(),
            _ => continue,
        };
        slot.resize(length as usize, 0);
        bytes.read_exact(slot).map_err(io)?;
    }
    let directory: Vec<u16> = keys.chunks_exact(2).map(|b| u16::from_le_bytes([b[0], b[1]])).collect();
    let mut georef = georef::of_keys(&directory, &text);
    // keys come first, as elder files have both; what they leave open, the text says
    if (georef.crs.epsg.is_none() || georef.unit_m.is_none())
        && let Some(said) = wkt.and_then(|wkt: Vec<u8>| georef::of_wkt(&String::from_utf8_lossy(&wkt)))
    {
        let crs = if georef.crs.epsg.is_none() { said.crs } else { georef.crs };
        georef = Georef {
            crs,
            unit_m: georef.unit_m.or(said.unit_m),
            height_unit_m: georef.height_unit_m.or(said.height_unit_m),
        };
    }
    Ok((georef, laz))
}

/// Points' records, one after the other.
pub(super) trait Records {
    /// Fills whole records of `length` bytes and says how many, fewer only at the end of what can be read.
    fn fill(&mut self, out: &mut [u8], length: usize) -> usize;
}

struct PlainRecords<'a>(Box<dyn ReadSeek + 'a>);

impl Records for PlainRecords<'_> {
    fn fill(&mut self, out: &mut [u8], length: usize) -> usize {
        let mut filled = 0;
        while filled < out.len() {
            match self.0.read(&mut out[filled..]) {
                Ok(0) => break,
                Ok(read) => filled += read,
                Err(e) if e.kind() == std::io::ErrorKind::Interrupted => {}
                Err(_) => break,
            }
        }
        filled / length
    }
}

/// How the whole numbers of one coordinate become metres.
#[derive(Debug, Clone, Copy)]
struct Axis {
    scale: f64,
    offset: f64,
    /// Parts of a unit and the offset in them, where both are whole: then coordinates are decimals, digit for digit.
    parts: Option<[f64; 2]>,
    unit_m: f64,
}

impl Axis {
    fn new(scale: f64, offset: f64, unit_m: f64) -> Self {
        let per_unit = (1.0 / scale).round();
        let steps = (offset * per_unit).round();
        let is_whole = 1.0 / per_unit == scale && steps / per_unit == offset && steps.abs() < EXACT;
        Self { scale, offset, parts: is_whole.then_some([per_unit, steps]), unit_m }
    }

    fn metres(&self, number: i32) -> f64 {
        let number = f64::from(number);
        match self.parts {
            Some([per_unit, steps]) => (number + steps) / per_unit * self.unit_m,
            None => (number * self.scale + self.offset) * self.unit_m,
        }
    }
}

/// Sums of whole numbers below this and a coordinate's are exact.
const EXACT: f64 = (1u64 << 52) as f64;

/// The points that are kept.
struct Kept<'a> {
    points_m: Vec<DVec3>,
    options: &'a PointReadOptions,
    /// Ground was met: the rest no longer counts.
    ground_only: bool,
    axes: [Axis; 3],
    format: u8,
    withheld: usize,
    left_out: usize,
}

impl Kept<'_> {
    /// Takes the points and says how many there were.
    fn take_all(&mut self, mut records: impl Records, header: &Header) -> u64 {
        let mut batch = vec![0; BATCH * header.point_bytes];
        let mut read = 0;
        while read < header.points {
            let wanted = (header.points - read).min(BATCH as u64) as usize;
            let filled = records.fill(&mut batch[..wanted * header.point_bytes], header.point_bytes);
            batch.chunks_exact(header.point_bytes).take(filled).for_each(|record| self.take(record));
            read += filled as u64;
            if filled < wanted {
                break;
            }
        }
        read
    }

    fn take(&mut self, record: &[u8]) {
        let (class, is_withheld) = if self.format < 6 {
            (record[15] & 0x1f, record[15] & 0x80 != 0)
        } else {
            (record[16], record[15] & 0x04 != 0)
        };
        if is_withheld {
            self.withheld += 1;
            return;
        }
        let is_wanted = match &self.options.classes {
            Some(classes) => classes.contains(&class),
            None => {
                if class == GROUND && !self.ground_only {
                    self.ground_only = true;
                    self.left_out += self.points_m.len();
                    self.points_m.clear();
                }
                if self.ground_only { class == GROUND } else { !NOISE.contains(&class) }
            }
        };
        if !is_wanted {
            self.left_out += 1;
            return;
        }
        let p = DVec3::from([0, 1, 2].map(|k| self.axes[k].metres(u32_of(record, 4 * k) as i32)));
        if p.is_finite() {
            self.points_m.push(p);
        }
    }

    fn note(&self, notes: &mut Vec<String>) {
        let kept = self.points_m.len();
        match &self.options.classes {
            Some(classes) => notes.push(format!("classes {classes:?}: {kept} points, {} left out", self.left_out)),
            None if self.ground_only => notes.push(format!("ground: {kept} points, {} others left out", self.left_out)),
            None => notes.push(format!("no ground is classed: all {kept} points, {} of noise left out", self.left_out)),
        }
        if self.withheld > 0 {
            notes.push(format!("{} withdrawn points left out", self.withheld));
        }
    }
}
