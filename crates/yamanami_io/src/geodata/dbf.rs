//! dBASE tables: the words beside a shapefile's shapes.
//!
//! Format: "ESRI Shapefile Technical Description", 1998, and the dBASE III header it builds on.

use super::words::{Word, Words, word_of};
use crate::IoError;
use encoding_rs::Encoding;
use std::path::Path;

const HEADER_BYTES: usize = 32;
const FIELD_BYTES: usize = 32;
const END_OF_FIELDS: u8 = 0x0d;

/// The usable words of each record.
pub(super) fn read(label: &Path, bytes: &[u8], encoding: Option<&'static Encoding>) -> Result<Vec<Words>, IoError> {
    let short = |at: usize| bytes.get(at..at + 2).map(|b| usize::from(u16::from_le_bytes([b[0], b[1]])));
    let (Some(begin), Some(record_bytes)) = (short(8), short(10)) else {
        return Err(IoError::malformed(label, "header", "at least 32 bytes", bytes.len().to_string()));
    };
    let mut fields: Vec<(Word, usize, usize)> = Vec::new();
    // the first byte of a record says whether it is deleted
    let mut start = 1;
    for field in bytes.get(HEADER_BYTES..begin).unwrap_or_default().chunks_exact(FIELD_BYTES) {
        if field[0] == END_OF_FIELDS {
            break;
        }
        let name = field[..11].split(|&b| b == 0).next().unwrap_or_default();
        let length = usize::from(field[16]);
        if let Some(word) = word_of(&text_of(name, encoding)) {
            fields.push((word, start, start + length));
        }
        start += length;
    }
    if start > record_bytes || begin > bytes.len() {
        let expected = format!("fields of {record_bytes} bytes in all, and records after byte {begin}");
        return Err(IoError::malformed(label, "header", expected, format!("{start} and {} bytes", bytes.len())));
    }
    let records = bytes[begin..].chunks_exact(record_bytes);
    Ok(records
        .map(|record| {
            let mut words = Words::default();
            for &(word, start, end) in &fields {
                words.add(word, text_of(&record[start..end], encoding).trim_matches(['\0', ' ']));
            }
            words
        })
        .collect())
}

fn text_of(bytes: &[u8], encoding: Option<&'static Encoding>) -> String {
    match encoding {
        Some(encoding) => encoding.decode_without_bom_handling(bytes).0.into_owned(),
        // a field cut off within a character is still UTF-8
        None => match std::str::from_utf8(bytes) {
            Err(e) if e.error_len().is_none() => String::from_utf8_lossy(&bytes[..e.valid_up_to()]).into_owned(),
            _ => super::words::decoded(bytes).into_owned(),
        },
    }
}
