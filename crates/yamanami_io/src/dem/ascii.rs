//! ESRI ASCII grid: a header of `key value` lines in any order, then the heights as text, row by row from the north.
//!
//! Format: ESRI, "Esri ASCII raster format", ArcGIS documentation. Rows are found by reading forwards once; their places
//! are kept, so that a file larger than memory is read by windows.

use super::bytes::{ByteSource, RandomReader};
use super::part::{Part, PartInfo, checked_size, clean, guess_crs};
use super::{OpenOptions, SampleType, prj};
use crate::IoError;
use yamanami_core::GeoReference;

/// What the format says is meant when the header does not say.
const DEFAULT_NO_DATA: f64 = -9999.0;
const CHUNK_SAMPLES: usize = 1 << 16;
const BUFFER_BYTES: usize = 1 << 16;
/// Longer than any number.
const MAX_TOKEN_BYTES: usize = 512;

/// Whether a text begins with a header word of this format.
pub(super) fn looks_like(head: &[u8]) -> bool {
    let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
    let word = text.split(u8::is_ascii_whitespace).next().unwrap_or_default();
    std::str::from_utf8(word).is_ok_and(is_key)
}

fn is_key(word: &str) -> bool {
    const KEYS: [&str; 10] = [
        "ncols",
        "nrows",
        "xllcorner",
        "yllcorner",
        "xllcenter",
        "yllcenter",
        "cellsize",
        "dx",
        "dy",
        "nodata_value",
    ];
    KEYS.iter().any(|key| word.eq_ignore_ascii_case(key))
}

#[derive(Debug, Default)]
struct Header {
    columns: Option<u64>,
    rows: Option<u64>,
    /// Value, and whether it names a corner (else a centre).
    lower_left: [Option<(f64, bool)>; 2],
    cell_size: [Option<f64>; 2],
    no_data: Option<f64>,
}

pub(super) struct AsciiGrid {
    info: PartInfo,
    tokens: Tokens,
    /// Byte at which each chunk of rows begins, as far as is known.
    chunk_starts: Vec<u64>,
    no_data: f64,
}

pub(super) fn open(source: &ByteSource, options: &OpenOptions) -> Result<AsciiGrid, IoError> {
    let label = source.label().to_owned();
    let mut tokens = Tokens::new(source.clone());
    let mut header = Header::default();
    let data_start = loop {
        let start = tokens.next_start()?;
        let Some(word) = tokens.next()? else {
            return Err(IoError::malformed(label, "after the header", "heights", "the end of the file"));
        };
        if word.parse::<f64>().is_ok() {
            break start;
        }
        let key = word.to_ascii_lowercase();
        let value = tokens.next()?.unwrap_or_default();
        header.set(&key, value).map_err(|expected| {
            let found = format!("'{}'", value.escape_default());
            IoError::malformed(&label, format!("header, {}", key.escape_default()), expected, found)
        })?;
    };
    let missing = |key: &str| IoError::malformed(&label, "header", format!("a line with {key}"), "none");
    let columns = header.columns.ok_or_else(|| missing("ncols"))?;
    let rows = header.rows.ok_or_else(|| missing("nrows"))?;
    let size = checked_size(&label, columns, rows)?;
    // One digit and one blank make the shortest height.
    if source.length_bound() < columns * rows * 2 - 1 {
        let expected = format!("at least {} bytes for {columns}x{rows} heights", columns * rows * 2 - 1);
        return Err(IoError::malformed(&label, "length", expected, format!("{} bytes", source.length_bound())));
    }
    let step = [header.cell_size[0], header.cell_size[1].or(header.cell_size[0])];
    let [Some(step_x), Some(step_y)] = step else { return Err(missing("cellsize")) };
    let (x, x_is_corner) = header.lower_left[0].ok_or_else(|| missing("xllcorner or xllcenter"))?;
    let (y, y_is_corner) = header.lower_left[1].ok_or_else(|| missing("yllcorner or yllcenter"))?;
    let west = if x_is_corner { x + 0.5 * step_x } else { x };
    let south = if y_is_corner { y + 0.5 * step_y } else { y };
    let north = south + step_y * (size[1] - 1) as f64;
    let mut notes = Vec::new();
    let crs = match (&options.crs, prj::beside(source)?) {
        (Some(crs), _) => crs.clone(),
        (None, Some(crs)) => crs,
        (None, None) => guess_crs([west, north], [step_x, step_y], size, &mut notes),
    };
    let no_data = header.no_data.unwrap_or(DEFAULT_NO_DATA);
    let info = PartInfo {
        label,
        format: "ESRI ASCII grid".to_owned(),
        size,
        geo: GeoReference::new(crs, [west, north], [step_x, -step_y], size),
        sample_type: SampleType::Text,
        no_data: Some(no_data),
        compression: source.compression_name().to_owned(),
        overviews: Vec::new(),
        chunk: [size[0], (CHUNK_SAMPLES / size[0]).clamp(1, size[1])],
        notes,
    };
    Ok(AsciiGrid { info, tokens, chunk_starts: vec![data_start], no_data })
}

impl Header {
    /// Takes one header line; says what was expected instead.
    fn set(&mut self, key: &str, value: &str) -> Result<(), &'static str> {
        let number = value.parse::<f64>().ok();
        let finite = number.filter(|n| n.is_finite());
        match key {
            "ncols" => self.columns = Some(value.parse().map_err(|_| "a whole number")?),
            "nrows" => self.rows = Some(value.parse().map_err(|_| "a whole number")?),
            "xllcorner" => self.lower_left[0] = Some((finite.ok_or("a number")?, true)),
            "yllcorner" => self.lower_left[1] = Some((finite.ok_or("a number")?, true)),
            "xllcenter" => self.lower_left[0] = Some((finite.ok_or("a number")?, false)),
            "yllcenter" => self.lower_left[1] = Some((finite.ok_or("a number")?, false)),
            "cellsize" | "dx" | "dy" => {
                let step = finite.filter(|step| *step > 0.0).ok_or("a number above 0")?;
                match key {
                    "dy" => self.cell_size[1] = Some(step),
                    _ => self.cell_size[0] = Some(step),
                }
            }
            "nodata_value" => self.no_data = Some(number.ok_or("a number")?),
            _ => return Err("a header word of an ESRI ASCII grid, or heights"),
        }
        Ok(())
    }
}

impl AsciiGrid {
    /// Reads the rows of the next chunk after those whose start is known, or passes over them.
    fn read_rows(&mut self, chunk_row: usize, keep: bool) -> Result<Vec<f32>, IoError> {
        let [_, first_row, width, rows] = self.info.chunk_range([0, chunk_row]);
        self.tokens.seek(self.chunk_starts[chunk_row]);
        let mut heights_m = Vec::new();
        for i in 0..width * rows {
            let (row, column) = (first_row + i / width, i % width);
            let Some(word) = self.tokens.next()? else {
                let [columns, rows] = self.info.size;
                let expected = format!("{columns}x{rows} heights");
                let place = format!("row {}, column {}", row + 1, column + 1);
                return Err(IoError::malformed(&self.info.label, place, expected, "the end of the file"));
            };
            if keep {
                let height = parse_height(word, self.no_data).ok_or_else(|| {
                    let place = format!("row {}, column {}", row + 1, column + 1);
                    IoError::malformed(&self.info.label, place, "a height", format!("'{}'", word.escape_default()))
                })?;
                heights_m.push(height);
            }
        }
        if chunk_row + 1 == self.chunk_starts.len() {
            if first_row + rows < self.info.size[1] {
                self.chunk_starts.push(self.tokens.next_start()?);
            } else if let Some(word) = self.tokens.next()? {
                let place = format!("after row {}", self.info.size[1]);
                let found = format!("'{}'", word.escape_default());
                return Err(IoError::malformed(&self.info.label, place, "the end of the file", found));
            }
        }
        Ok(heights_m)
    }
}

fn parse_height(word: &str, no_data: f64) -> Option<f32> {
    let Ok(value) = word.parse::<f64>() else {
        // Old C libraries print 1.#QNAN, -nan(ind) and the like.
        let lower = word.to_ascii_lowercase();
        return (lower.contains("nan") || lower.contains("#in")).then_some(f32::NAN);
    };
    if value == no_data || value as f32 == no_data as f32 { Some(f32::NAN) } else { Some(clean(value as f32)) }
}

impl Part for AsciiGrid {
    fn info(&self) -> &PartInfo {
        &self.info
    }

    fn info_mut(&mut self) -> &mut PartInfo {
        &mut self.info
    }

    fn read_chunk(&mut self, chunk: [usize; 2]) -> Result<Vec<f32>, IoError> {
        while self.chunk_starts.len() <= chunk[1] {
            self.read_rows(self.chunk_starts.len() - 1, false)?;
        }
        self.read_rows(chunk[1], true)
    }

    fn close(&mut self) {
        self.tokens.reader.close();
    }
}

/// Words separated by blanks, with their places.
struct Tokens {
    reader: RandomReader,
    buffer: Vec<u8>,
    /// Byte of the file at which the buffer begins.
    buffer_start: u64,
    at: usize,
}

impl Tokens {
    fn new(source: ByteSource) -> Self {
        Self { reader: RandomReader::new(source), buffer: Vec::new(), buffer_start: 0, at: 0 }
    }

    fn seek(&mut self, offset: u64) {
        let inside = offset.checked_sub(self.buffer_start).filter(|at| *at <= self.buffer.len() as u64);
        match inside {
            Some(at) => self.at = at as usize,
            None => {
                self.buffer.clear();
                self.buffer_start = offset;
                self.at = 0;
            }
        }
    }

    /// Drops what lies behind and reads on; false at the end of the file.
    fn refill(&mut self) -> Result<bool, IoError> {
        self.buffer.drain(..self.at);
        self.buffer_start += self.at as u64;
        self.at = 0;
        let kept = self.buffer.len();
        self.buffer.resize(kept + BUFFER_BYTES, 0);
        let read = self.reader.read_at(self.buffer_start + kept as u64, &mut self.buffer[kept..]);
        self.buffer.truncate(kept + read.as_ref().unwrap_or(&0));
        Ok(read? > 0)
    }

    /// Where the next word begins.
    fn next_start(&mut self) -> Result<u64, IoError> {
        if self.buffer_start + self.at as u64 == 0 && self.buffer.is_empty() && self.refill()? {
            self.at = if self.buffer.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        }
        loop {
            match self.buffer[self.at..].iter().position(|b| !b.is_ascii_whitespace()) {
                Some(blanks) => {
                    self.at += blanks;
                    break;
                }
                None => {
                    self.at = self.buffer.len();
                    if !self.refill()? {
                        break;
                    }
                }
            }
        }
        Ok(self.buffer_start + self.at as u64)
    }

    fn next(&mut self) -> Result<Option<&str>, IoError> {
        let start = self.next_start()?;
        let mut length = 0;
        loop {
            let rest = &self.buffer[self.at + length..];
            match rest.iter().position(u8::is_ascii_whitespace) {
                Some(more) => {
                    length += more;
                    break;
                }
                None => {
                    length += rest.len();
                    if length > MAX_TOKEN_BYTES {
                        let (label, place) = (self.reader.source().label(), format!("byte {start}"));
                        return Err(IoError::malformed(label, place, "a number", "a very long word"));
                    }
                    if !self.refill()? {
                        break;
                    }
                }
            }
        }
        let word = &self.buffer[self.at..self.at + length];
        self.at += length;
        Ok((!word.is_empty()).then(|| std::str::from_utf8(word).unwrap_or("\u{FFFD}")))
    }
}
