//! The header and image directories of a TIFF or BigTIFF.
//!
//! Formats: Adobe, "TIFF Revision 6.0", 1992; AWare Systems, "The BigTIFF File Format Proposal", 2004.

use super::bytes::RandomReader;
use crate::IoError;

pub(super) const NEW_SUBFILE_TYPE: u16 = 254;
pub(super) const IMAGE_WIDTH: u16 = 256;
pub(super) const IMAGE_LENGTH: u16 = 257;
pub(super) const BITS_PER_SAMPLE: u16 = 258;
pub(super) const COMPRESSION: u16 = 259;
pub(super) const PHOTOMETRIC_INTERPRETATION: u16 = 262;
pub(super) const STRIP_OFFSETS: u16 = 273;
pub(super) const SAMPLES_PER_PIXEL: u16 = 277;
pub(super) const ROWS_PER_STRIP: u16 = 278;
pub(super) const STRIP_BYTE_COUNTS: u16 = 279;
pub(super) const PREDICTOR: u16 = 317;
pub(super) const TILE_WIDTH: u16 = 322;
pub(super) const TILE_LENGTH: u16 = 323;
pub(super) const TILE_OFFSETS: u16 = 324;
pub(super) const TILE_BYTE_COUNTS: u16 = 325;
pub(super) const SAMPLE_FORMAT: u16 = 339;
pub(super) const MODEL_PIXEL_SCALE: u16 = 33550;
pub(super) const MODEL_TIE_POINT: u16 = 33922;
pub(super) const MODEL_TRANSFORMATION: u16 = 34264;
pub(super) const GEO_KEY_DIRECTORY: u16 = 34735;
pub(super) const GEO_DOUBLE_PARAMS: u16 = 34736;
pub(super) const GEO_ASCII_PARAMS: u16 = 34737;
pub(super) const GDAL_METADATA: u16 = 42112;
pub(super) const GDAL_NO_DATA: u16 = 42113;

const MAX_ENTRIES: u64 = 4096;
const MAX_TEXT_BYTES: u64 = 1 << 20;

/// Order of the bytes of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ByteOrder {
    LittleEndian,
    BigEndian,
}

/// An opened TIFF, of which directories and tag values can be read.
pub(super) struct Tiff {
    pub(super) reader: RandomReader,
    pub(super) order: ByteOrder,
    pub(super) is_big: bool,
    /// Where the first directory is.
    pub(super) first: u64,
    pub(super) file_bytes: u64,
}

/// One image directory.
pub(super) struct Directory {
    entries: Vec<Entry>,
    /// Where the next one is; 0 after the last.
    pub(super) next: u64,
}

struct Entry {
    tag: u16,
    kind: u16,
    count: u64,
    /// The values where they fit, else their place.
    inline: [u8; 8],
}

/// Whether bytes begin like a TIFF or BigTIFF.
pub(super) fn looks_like(head: &[u8]) -> bool {
    [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"].iter().any(|magic| head.starts_with(*magic))
}

impl ByteOrder {
    fn number(self, bytes: &[u8]) -> u64 {
        let push = |n: u64, b: &u8| n << 8 | u64::from(*b);
        match self {
            Self::LittleEndian => bytes.iter().rev().fold(0, push),
            Self::BigEndian => bytes.iter().fold(0, push),
        }
    }
}

impl Tiff {
    pub(super) fn open(mut reader: RandomReader) -> Result<Self, IoError> {
        let file_bytes = reader.length()?;
        let mut head = [0; 8];
        reader.read_exact_at(0, &mut head)?;
        let order = if head[0] == b'I' { ByteOrder::LittleEndian } else { ByteOrder::BigEndian };
        let is_big = order.number(&head[2..4]) == 43;
        let first = if is_big {
            let offset_bytes = order.number(&head[4..6]);
            if offset_bytes != 8 {
                let label = reader.source().label();
                return Err(IoError::malformed(
                    label,
                    "BigTIFF header",
                    "offsets of 8 bytes",
                    offset_bytes.to_string(),
                ));
            }
            let mut offset = [0; 8];
            reader.read_exact_at(8, &mut offset)?;
            order.number(&offset)
        } else {
            order.number(&head[4..8])
        };
        Ok(Self { reader, order, is_big, first, file_bytes })
    }

    pub(super) fn directory(&mut self, offset: u64) -> Result<Directory, IoError> {
        let (count_bytes, entry_bytes, word) = if self.is_big { (8, 20, 8) } else { (2, 12, 4) };
        let mut count = vec![0; count_bytes];
        self.reader.read_exact_at(offset, &mut count)?;
        let count = self.order.number(&count);
        if count > MAX_ENTRIES {
            let place = format!("image directory at byte {offset}");
            let expected = format!("at most {MAX_ENTRIES} entries");
            return Err(IoError::malformed(self.reader.source().label(), place, expected, count.to_string()));
        }
        let mut bytes = vec![0; count as usize * entry_bytes + word];
        self.reader.read_exact_at(offset + count_bytes as u64, &mut bytes)?;
        let (table, next) = bytes.split_at(bytes.len() - word);
        let entries = table.chunks_exact(entry_bytes).map(|entry| {
            let mut inline = [0; 8];
            inline[..word].copy_from_slice(&entry[entry_bytes - word..]);
            Entry {
                tag: self.order.number(&entry[..2]) as u16,
                kind: self.order.number(&entry[2..4]) as u16,
                count: self.order.number(&entry[4..4 + word]),
                inline,
            }
        });
        Ok(Directory { entries: entries.collect(), next: self.order.number(next) })
    }

    /// The stored bytes of a tag and the size of one value; `None` when the tag is absent.
    fn values(&mut self, directory: &Directory, tag: u16) -> Result<Option<(u16, Vec<u8>)>, IoError> {
        let Some(entry) = directory.entries.iter().find(|entry| entry.tag == tag) else { return Ok(None) };
        let length = entry.count.saturating_mul(bytes_of(entry.kind) as u64);
        let word = if self.is_big { 8 } else { 4 };
        if length <= word {
            return Ok(Some((entry.kind, entry.inline[..length as usize].to_vec())));
        }
        let offset = self.order.number(&entry.inline[..word as usize]);
        if offset.saturating_add(length) > self.file_bytes {
            let expected = format!("{length} bytes at byte {offset}");
            let found = format!("a file of {} bytes", self.file_bytes);
            return Err(IoError::malformed(self.reader.source().label(), format!("tag {tag}"), expected, found));
        }
        let mut bytes = vec![0; length as usize];
        self.reader.read_exact_at(offset, &mut bytes)?;
        Ok(Some((entry.kind, bytes)))
    }

    /// The whole numbers of a tag; empty when it is absent.
    pub(super) fn numbers(&mut self, directory: &Directory, tag: u16) -> Result<Vec<u64>, IoError> {
        let Some((kind, bytes)) = self.values(directory, tag)? else { return Ok(Vec::new()) };
        match kind {
            1 | 3 | 4 | 13 | 16 | 18 => {
                Ok(bytes.chunks_exact(bytes_of(kind)).map(|value| self.order.number(value)).collect())
            }
            _ => Err(self.wrong_kind(tag, "whole numbers", kind)),
        }
    }

    /// The first whole number of a tag, or what holds when it is absent.
    pub(super) fn number_or(&mut self, directory: &Directory, tag: u16, default: u64) -> Result<u64, IoError> {
        Ok(self.numbers(directory, tag)?.first().copied().unwrap_or(default))
    }

    /// The floating-point numbers of a tag; empty when it is absent.
    pub(super) fn doubles(&mut self, directory: &Directory, tag: u16) -> Result<Vec<f64>, IoError> {
        let Some((kind, bytes)) = self.values(directory, tag)? else { return Ok(Vec::new()) };
        match kind {
            12 => Ok(bytes.chunks_exact(8).map(|value| f64::from_bits(self.order.number(value))).collect()),
            11 => {
                let float = |value: &[u8]| f64::from(f32::from_bits(self.order.number(value) as u32));
                Ok(bytes.chunks_exact(4).map(float).collect())
            }
            _ => Err(self.wrong_kind(tag, "floating-point numbers", kind)),
        }
    }

    /// The text of a tag without its closing zero; empty when it is absent.
    pub(super) fn text(&mut self, directory: &Directory, tag: u16) -> Result<String, IoError> {
        let Some((kind, bytes)) = self.values(directory, tag)? else { return Ok(String::new()) };
        match kind {
            1 | 2 | 7 if bytes.len() as u64 <= MAX_TEXT_BYTES => {
                Ok(String::from_utf8_lossy(&bytes).trim_end_matches('\0').to_owned())
            }
            _ => Err(self.wrong_kind(tag, "text", kind)),
        }
    }

    fn wrong_kind(&self, tag: u16, expected: &str, kind: u16) -> IoError {
        IoError::malformed(
            self.reader.source().label(),
            format!("tag {tag}"),
            expected,
            format!("values of type {kind}"),
        )
    }
}

/// Bytes of a value of a TIFF type.
fn bytes_of(kind: u16) -> usize {
    match kind {
        3 | 8 => 2,
        4 | 9 | 11 | 13 => 4,
        5 | 10 | 12 | 16 | 17 | 18 => 8,
        _ => 1,
    }
}
