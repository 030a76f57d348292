//! FG-GML, the XML of the elevation models of the Geospatial Information Authority of Japan (DEM 1A, 5A, 5B, 5C, 10A,
//! 10B): one mesh a file, many files a zip.
//!
//! Format: GSI, "Fundamental Geospatial Data, download data file specification". Heights are listed from the
//! north-west, eastwards; the list may begin after the first cell (`startPoint`) and end before the last.

use super::bytes::ByteSource;
use super::part::{Part, PartInfo, clean};
use super::{OpenOptions, SampleType};
use crate::{IoError, crs};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::io::{BufReader, Read};
use yamanami_core::{Crs, GeoReference};

/// Heights below this mean "none" (the code is -9999).
const NO_DATA_BELOW_M: f64 = -9990.0;
const NO_DATA: f64 = -9999.0;
/// The largest mesh of the series has under a million cells.
const MAX_CELLS: u64 = 1 << 24;
/// Bytes that the text of a cell may take, and those of all the rest of a file.
const MAX_CELL_BYTES: u64 = 128;
const MAX_FRAME_BYTES: u64 = 1 << 20;

/// Whether a text begins like an FG-GML elevation mesh.
pub(super) fn looks_like(head: &[u8]) -> bool {
    let has = |needle: &[u8]| head.windows(needle.len()).any(|w| w == needle);
    has(b"FGD_GMLSchema") && has(b"<DEM")
}

pub(super) struct FgGml {
    info: PartInfo,
    source: ByteSource,
}

#[derive(Debug, Default)]
struct Mesh {
    kind: String,
    srs: String,
    lower_corner: Option<[f64; 2]>,
    upper_corner: Option<[f64; 2]>,
    low: Option<[f64; 2]>,
    high: Option<[f64; 2]>,
    start: Option<[f64; 2]>,
    heights_m: Vec<f32>,
}

pub(super) fn open(source: &ByteSource, options: &OpenOptions) -> Result<FgGml, IoError> {
    let label = source.label();
    let mesh = read(source, false, MAX_FRAME_BYTES)?;
    let missing = |element: &str| IoError::malformed(label, "before the heights", format!("<{element}>"), "none");
    let [south, west] = mesh.lower_corner.ok_or_else(|| missing("gml:lowerCorner"))?;
    let [north, east] = mesh.upper_corner.ok_or_else(|| missing("gml:upperCorner"))?;
    let low = mesh.low.ok_or_else(|| missing("gml:low"))?;
    let high = mesh.high.ok_or_else(|| missing("gml:high"))?;
    let cells = [high[0] - low[0] + 1.0, high[1] - low[1] + 1.0];
    if cells.iter().any(|n| !(2.0..=65536.0).contains(n) || n.fract() != 0.0) {
        let found = format!("{low:?} to {high:?}");
        return Err(IoError::malformed(label, "gml:GridEnvelope", "a grid of at least 2x2 cells", found));
    }
    let size = cells.map(|n| n as usize);
    if (size[0] * size[1]) as u64 > MAX_CELLS {
        return Err(IoError::too_large(label, "cells of a mesh", (size[0] * size[1]) as u64, MAX_CELLS));
    }
    let degrees = [east - west, north - south];
    if degrees.iter().any(|d| !(1e-6..=10.0).contains(d)) || west.abs() > 180.0 || south.abs() > 90.0 {
        let found = format!("{south} {west} to {north} {east}");
        return Err(IoError::malformed(label, "gml:Envelope", "latitude and longitude of two corners", found));
    }
    let crs = match &options.crs {
        Some(crs) => crs.clone(),
        None => crs_from_srs(&mesh.srs).ok_or_else(|| {
            let found = format!("'{}'", mesh.srs.escape_default());
            IoError::malformed(label, "gml:Envelope, srsName", "fguuid:jgd2011.bl or fguuid:jgd2000.bl", found)
        })?,
    };
    let step = [degrees[0] / cells[0], degrees[1] / cells[1]];
    let info = PartInfo {
        label: label.to_owned(),
        format: if mesh.kind.is_empty() { "FG-GML DEM".to_owned() } else { format!("FG-GML DEM {}", mesh.kind) },
        size,
        geo: GeoReference::new(crs, [west + 0.5 * step[0], north - 0.5 * step[1]], [step[0], -step[1]], size),
        sample_type: SampleType::Text,
        no_data: Some(NO_DATA),
        compression: source.compression_name().to_owned(),
        overviews: Vec::new(),
        chunk: size,
        notes: Vec::new(),
    };
    Ok(FgGml { info, source: source.clone() })
}

fn crs_from_srs(srs: &str) -> Option<Crs> {
    match srs.trim().to_ascii_lowercase().as_str() {
        "fguuid:jgd2000.bl" => crs::from_epsg(4612),
        // The revision of 2024 changed heights, not latitude and longitude.
        "fguuid:jgd2011.bl" | "fguuid:jgd2024.bl" => crs::from_epsg(6668),
        _ => None,
    }
}

impl Part for FgGml {
    fn info(&self) -> &PartInfo {
        &self.info
    }

    fn info_mut(&mut self) -> &mut PartInfo {
        &mut self.info
    }

    fn read_chunk(&mut self, _chunk: [usize; 2]) -> Result<Vec<f32>, IoError> {
        let [width, height] = self.info.size;
        let cells = width * height;
        let label = &self.info.label;
        let mesh = read(&self.source, true, MAX_FRAME_BYTES + MAX_CELL_BYTES * cells as u64)?;
        let start = mesh.start.unwrap_or_default();
        if start.iter().any(|n| n.fract() != 0.0)
            || !(0.0..width as f64).contains(&start[0])
            || !(0.0..height as f64).contains(&start[1])
        {
            let expected = format!("a cell of the {width}x{height} grid");
            return Err(IoError::malformed(label, "gml:startPoint", expected, format!("{} {}", start[0], start[1])));
        }
        let first = start[1] as usize * width + start[0] as usize;
        if first + mesh.heights_m.len() > cells {
            let expected = format!("at most {} heights", cells - first);
            return Err(IoError::malformed(label, "gml:tupleList", expected, mesh.heights_m.len().to_string()));
        }
        let mut heights_m = vec![f32::NAN; cells];
        heights_m[first..first + mesh.heights_m.len()].copy_from_slice(&mesh.heights_m);
        Ok(heights_m)
    }
}

/// Reads the frame of a mesh up to its heights, or all of it.
fn read(source: &ByteSource, with_heights: bool, limit_bytes: u64) -> Result<Mesh, IoError> {
    let label = source.label();
    let bytes = source.reader()?.take(limit_bytes);
    let is_utf8 = encoding_is_utf8(&source.head(200)?);
    let mut reader = Reader::from_reader(BufReader::with_capacity(1 << 16, Ascii { bytes, passes_all: is_utf8 }));
    let mut mesh = Mesh::default();
    let mut buffer = Vec::new();
    let mut text = String::new();
    let mut saw_heights = false;
    loop {
        let place = reader.buffer_position();
        let event = reader.read_event_into(&mut buffer).map_err(|e| {
            IoError::malformed(label, format!("byte {}", reader.error_position()), "well-formed XML", e.to_string())
        })?;
        match event {
            Event::Start(element) => {
                text.clear();
                match element.local_name().as_ref() {
                    "Envelope" => mesh.srs = attribute(&element, "srsName").unwrap_or_default(),
                    "sequenceRule" => {
                        let order = attribute(&element, "order").unwrap_or_default();
                        if !matches!(order.trim(), "+x-y" | "") {
                            let what = format!("order '{}' of the heights", order.escape_default());
                            return Err(IoError::unsupported(label, what, "only '+x-y' is known"));
                        }
                    }
                    "tupleList" if !with_heights => return Ok(mesh),
                    "tupleList" => saw_heights = true,
                    _ => {}
                }
            }
            Event::Text(part) => text.push_str(&part),
            Event::End(element) => {
                let pair = || {
                    let found = format!("'{}'", text.chars().take(40).collect::<String>().escape_default());
                    let place = format!("byte {place}");
                    numbers(&text).ok_or_else(|| IoError::malformed(label, place, "two numbers", found))
                };
                match element.local_name().as_ref() {
                    "type" => mesh.kind = text.trim().trim_matches('?').chars().take(40).collect(),
                    "lowerCorner" => mesh.lower_corner = Some(pair()?),
                    "upperCorner" => mesh.upper_corner = Some(pair()?),
                    "low" => mesh.low = Some(pair()?),
                    "high" => mesh.high = Some(pair()?),
                    "startPoint" => mesh.start = Some(pair()?),
                    "tupleList" => mesh.heights_m = heights(label, &text)?,
                    _ => {}
                }
                text.clear();
            }
            Event::Eof => break,
            _ => {}
        }
        buffer.clear();
    }
    if !saw_heights || mesh.start.is_none() {
        let expected = if saw_heights { "<gml:startPoint> after the heights" } else { "<gml:tupleList>" };
        let place = format!("byte {}", reader.buffer_position());
        return Err(IoError::malformed(label, place, expected, "the end of the file"));
    }
    Ok(mesh)
}

fn attribute(element: &BytesStart<'_>, name: &str) -> Option<String> {
    let attribute = element.attributes().with_checks(false).flatten().find(|a| a.key.local_name().as_ref() == name)?;
    Some(attribute.value.into_owned())
}

fn numbers(text: &str) -> Option<[f64; 2]> {
    let mut words = text.split_whitespace().map(|w| w.parse::<f64>().ok().filter(|n| n.is_finite()));
    match (words.next()??, words.next()??, words.next()) {
        (a, b, None) => Some([a, b]),
        _ => None,
    }
}

/// Heights of lines like `地表面,248.49`; the words before the comma are not looked at.
fn heights(label: &std::path::Path, list: &str) -> Result<Vec<f32>, IoError> {
    let lines = list.lines().map(str::trim).filter(|line| !line.is_empty());
    lines
        .enumerate()
        .map(|(i, line)| {
            let number = line.rsplit(',').next().unwrap_or_default().trim_ascii();
            match number.parse::<f64>() {
                Ok(z) if z < NO_DATA_BELOW_M => Ok(f32::NAN),
                Ok(z) => Ok(clean(z as f32)),
                Err(_) => {
                    let place = format!("gml:tupleList, line {}", i + 1);
                    let found = format!("'{}'", line.chars().take(40).collect::<String>());
                    Err(IoError::malformed(label, place, "type,height", found))
                }
            }
        })
        .collect()
}

fn encoding_is_utf8(head: &[u8]) -> bool {
    let head = String::from_utf8_lossy(head).to_ascii_lowercase();
    let declaration = head.split("?>").next().unwrap_or_default();
    !declaration.contains("encoding") || declaration.contains("utf-8")
}

/// Passes ASCII. Old files are in Shift_JIS, whose Japanese words do not matter here and whose second bytes are never
/// marks of XML: such bytes become question marks.
struct Ascii<R> {
    bytes: R,
    passes_all: bool,
}

impl<R: Read> Read for Ascii<R> {
    fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
        let count = self.bytes.read(out)?;
        if !self.passes_all {
            out[..count].iter_mut().filter(|b| !b.is_ascii()).for_each(|b| *b = b'?');
        }
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_encodings_are_passed_over() {
        assert!(encoding_is_utf8(b"<?xml version=\"1.0\" encoding=\"UTF-8\"?><a/>"));
        assert!(encoding_is_utf8(b"<?xml version=\"1.0\"?><a/>"));
        assert!(!encoding_is_utf8(b"<?xml version=\"1.0\" encoding=\"Shift_JIS\"?><a/>"));
        let mut text = String::new();
        Ascii { bytes: &b"\x92n\x95\x5c\x96\xca,1.5"[..], passes_all: false }.read_to_string(&mut text).unwrap();
        assert_eq!(text, "?n?\\??,1.5");
    }
}
