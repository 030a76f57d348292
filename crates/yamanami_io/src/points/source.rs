//! A file of points or the same in memory, read forwards: as it is, or as lines of text.

use crate::IoError;
use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Read, Seek};
use std::path::{Path, PathBuf};

/// A line of text may have so many bytes.
const MOST_LINE_BYTES: usize = 1 << 16;
/// Text packs tenfold; what unpacks to more than so many times its size is a bomb.
const MOST_FOLD: u64 = 1000;
const BUFFER_BYTES: usize = 1 << 18;

pub(super) trait ReadSeek: Read + Seek + Send + Sync {}
impl<T: Read + Seek + Send + Sync> ReadSeek for T {}

/// Where bytes come from.
pub(crate) struct Source<'a> {
    label: PathBuf,
    bytes: Box<dyn ReadSeek + 'a>,
    length: u64,
}

impl<'a> Source<'a> {
    pub(crate) fn file(path: &Path) -> Result<Self, IoError> {
        let file = File::open(path).map_err(|e| IoError::io(path, e))?;
        let metadata = file.metadata().map_err(|e| IoError::io(path, e))?;
        if !metadata.is_file() {
            return Err(IoError::unsupported(path, "not a regular file", "give a file of points or lines"));
        }
        let bytes = Box::new(BufReader::with_capacity(BUFFER_BYTES, file));
        Ok(Self { label: path.to_owned(), bytes, length: metadata.len() })
    }

    pub(crate) fn memory(name: &Path, bytes: &'a [u8]) -> Self {
        Self { label: name.to_owned(), length: bytes.len() as u64, bytes: Box::new(Cursor::new(bytes)) }
    }

    pub(crate) fn label(&self) -> &Path {
        &self.label
    }

    pub(super) fn length(&self) -> u64 {
        self.length
    }

    pub(super) fn into_bytes(self) -> Box<dyn ReadSeek + 'a> {
        self.bytes
    }

    /// The text, unpacked if the name says that it is packed.
    pub(crate) fn into_text(self) -> Result<Text<'a>, IoError> {
        let most = self.length.saturating_mul(MOST_FOLD).saturating_add(MOST_LINE_BYTES as u64);
        let unpacked: Box<dyn Read + 'a> = if ends_with(&self.label, "gz") {
            Box::new(flate2::read::MultiGzDecoder::new(self.bytes).take(most))
        } else if ends_with(&self.label, "zst") {
            let decoder = zstd::stream::read::Decoder::new(self.bytes).map_err(|e| IoError::io(&self.label, e))?;
            Box::new(decoder.take(most))
        } else {
            self.bytes
        };
        let lines = BufReader::with_capacity(BUFFER_BYTES, unpacked);
        Ok(Text { label: self.label, lines, number: 0, line: Vec::new() })
    }
}

/// Text, line by line.
pub(crate) struct Text<'a> {
    pub(super) label: PathBuf,
    lines: BufReader<Box<dyn Read + 'a>>,
    number: usize,
    line: Vec<u8>,
}

impl Text<'_> {
    /// The next line that is not empty, without white space around it, and its number from 1.
    pub(super) fn next_line(&mut self) -> Result<Option<(usize, &[u8])>, IoError> {
        loop {
            self.line.clear();
            let mut limited = (&mut self.lines).take(MOST_LINE_BYTES as u64);
            let read = limited.read_until(b'\n', &mut self.line);
            if read.map_err(|e| IoError::io(&self.label, e))? == 0 {
                return Ok(None);
            }
            self.number += 1;
            if self.line.len() == MOST_LINE_BYTES {
                let (place, expected) = (format!("line {}", self.number), "a line of at most 64 KiB");
                return Err(IoError::malformed(&self.label, place, expected, "a longer one"));
            }
            if self.number == 1 && self.line.starts_with(b"\xef\xbb\xbf") {
                self.line.drain(..3);
            }
            if !self.line.trim_ascii().is_empty() {
                break;
            }
        }
        Ok(Some((self.number, self.line.trim_ascii())))
    }

    /// All that is left, at most so many bytes.
    pub(crate) fn into_bytes(mut self, most: u64) -> Result<Vec<u8>, IoError> {
        let mut bytes = Vec::new();
        let read = (&mut self.lines).take(most + 1).read_to_end(&mut bytes);
        read.map_err(|e| IoError::io(&self.label, e))?;
        if bytes.len() as u64 > most {
            return Err(IoError::too_large(self.label, "bytes", bytes.len() as u64, most));
        }
        Ok(bytes)
    }
}

fn ends_with(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending))
}

/// Whether a name ends so, packed or not.
pub(crate) fn has_ending(path: &Path, endings: &[&str]) -> bool {
    let unpacked = if ends_with(path, "gz") || ends_with(path, "zst") { path.with_extension("") } else { path.into() };
    endings.iter().any(|ending| ends_with(&unpacked, ending))
}
