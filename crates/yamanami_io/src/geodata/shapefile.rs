//! Shapefiles: shapes in `.shp`, words in `.dbf`, the CRS in `.prj`, the encoding in `.cpg`.
//!
//! Format: "ESRI Shapefile Technical Description", 1998.

use super::dbf;
use super::feature::{Feature, Features, Line, Shape};
use crate::IoError;
use crate::dem::prj;
use encoding_rs::{Encoding, SHIFT_JIS};
use glam::DVec3;
use std::path::{Path, PathBuf};
use yamanami_core::Crs;

const HEADER_BYTES: usize = 100;
const FILE_CODE: u32 = 9994;
/// Companions are small, but for the table of words.
const MOST_PRJ_BYTES: u64 = 1 << 16;

/// Reads the shapes; words and CRS come from other files.
pub(super) fn read(label: &Path, bytes: &[u8]) -> Result<Features, IoError> {
    if bytes.len() < HEADER_BYTES || !bytes.starts_with(&FILE_CODE.to_be_bytes()) {
        return Err(IoError::malformed(label, "header", "100 bytes that begin with 9994", "something else"));
    }
    let mut features = Vec::new();
    let mut rest = &bytes[HEADER_BYTES..];
    while let Some((head, after)) = rest.split_first_chunk::<8>() {
        let place = format!("record {}", features.len() + 1);
        let content_bytes = 2 * u64::from(u32::from_be_bytes([head[4], head[5], head[6], head[7]]));
        let content = usize::try_from(content_bytes).ok().and_then(|n| after.get(..n));
        let Some(content) = content else {
            let found = format!("{} bytes left of {content_bytes}", after.len());
            return Err(IoError::malformed(label, place, "a whole record", found));
        };
        rest = &after[content.len()..];
        let (shape, fault) = match shape_of(content) {
            Some(shape) => (shape, None),
            None => (Shape::default(), Some("a shape of no known kind".to_owned())),
        };
        features.push(Feature { place, shape, fault, ..Feature::default() });
    }
    let name = label.file_stem().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    Ok(Features { name, features, ..Features::default() })
}

/// The shape of a record; `None` when it is no point, line or area.
fn shape_of(content: &[u8]) -> Option<Shape> {
    let number = |at: usize| content.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let double = |at: usize| {
        let bytes: [u8; 8] = content.get(at..at + 8)?.try_into().ok()?;
        Some(f64::from_le_bytes(bytes))
    };
    let kind = number(0)?;
    let with_z = (11..20).contains(&kind);
    let mut shape = Shape::default();
    match kind {
        0 => {}
        1 | 11 | 21 => {
            let z = if with_z { double(20)? } else { f64::NAN };
            shape.points.push(DVec3::new(double(4)?, double(12)?, z));
        }
        8 | 18 | 28 => {
            let count = number(36)? as usize;
            let places = content.get(40..)?.get(..count.checked_mul(16)?)?;
            shape.points = places_of(places);
        }
        3 | 5 | 13 | 15 | 23 | 25 => {
            let (parts, count) = (number(36)? as usize, number(40)? as usize);
            let firsts = content.get(44..)?.get(..parts.checked_mul(4)?)?;
            let places = content.get(44 + firsts.len()..)?.get(..count.checked_mul(16)?)?;
            let firsts: Vec<usize> =
                firsts.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize).collect();
            let is_area = matches!(kind, 5 | 15 | 25);
            for (k, &first) in firsts.iter().enumerate() {
                let end = firsts.get(k + 1).copied().unwrap_or(count);
                let part = places.get(first.checked_mul(16)?..end.checked_mul(16)?)?;
                shape.lines.push(Line { points: places_of(part), is_area });
            }
        }
        _ => return None,
    }
    Some(shape)
}

fn places_of(bytes: &[u8]) -> Vec<DVec3> {
    let double = |b: &[u8]| f64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]]);
    bytes.chunks_exact(16).map(|b| DVec3::new(double(&b[..8]), double(&b[8..]), f64::NAN)).collect()
}

/// Adds what stands in the files beside a `.shp`.
pub(super) fn add_companions(path: &Path, all: &mut [Features]) -> Result<(), IoError> {
    for features in all {
        match beside(path, "prj", MOST_PRJ_BYTES)? {
            Some((prj, text)) => {
                let text = String::from_utf8_lossy(&text);
                let name = text.split('"').nth(1).unwrap_or("no well-known text").to_owned();
                let unknown = || Crs { name: format!("{name} of {}", prj.display()), ..Crs::default() };
                features.crs = Some(prj::from_wkt(&text).unwrap_or_else(unknown));
            }
            None => features.notes.push("no .prj beside it: coordinates taken as longitude and latitude".to_owned()),
        }
        let encoding = beside(path, "cpg", MOST_PRJ_BYTES)?.and_then(|(_, text)| encoding_of(&text));
        let Some((table, bytes)) = beside(path, "dbf", super::MOST_BYTES)? else {
            features.notes.push("no .dbf beside it: nothing has a name".to_owned());
            continue;
        };
        let words = dbf::read(&table, &bytes, encoding)?;
        if words.len() != features.features.len() {
            let (shapes, words) = (features.features.len(), words.len());
            features.notes.push(format!("{shapes} shapes, but {words} records in {}", table.display()));
        }
        features.features.iter_mut().zip(words).for_each(|(feature, words)| feature.words = words);
    }
    Ok(())
}

/// The encoding that a `.cpg` names: `UTF-8`, `932`, `SJIS`.
fn encoding_of(text: &[u8]) -> Option<&'static Encoding> {
    let label = String::from_utf8_lossy(text).trim().to_ascii_lowercase();
    match label.trim_start_matches("cp").trim_start_matches("ansi ") {
        "932" | "ms932" => Some(SHIFT_JIS),
        "65001" => Some(encoding_rs::UTF_8),
        _ => Encoding::for_label(label.as_bytes()),
    }
}

/// A file of the same name with another ending, in small or capital letters.
fn beside(path: &Path, ending: &str, most: u64) -> Result<Option<(PathBuf, Vec<u8>)>, IoError> {
    let names = [path.with_extension(ending), path.with_extension(ending.to_ascii_uppercase())];
    let Some(found) = names.into_iter().find(|name| name.is_file()) else { return Ok(None) };
    let length = std::fs::metadata(&found).map_err(|e| IoError::io(&found, e))?.len();
    if length > most {
        return Err(IoError::too_large(found, "bytes", length, most));
    }
    let bytes = std::fs::read(&found).map_err(|e| IoError::io(&found, e))?;
    Ok(Some((found, bytes)))
}
