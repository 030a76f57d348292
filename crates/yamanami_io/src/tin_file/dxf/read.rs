//! Reading a DXF: its header's unit, and its entities one by one, so that only what comes out of them is kept.
//!
//! Based on: Autodesk, "DXF reference", 2018.

use super::drawing::Drawing;
use super::groups::Groups;
use super::units;
use crate::IoError;
use crate::tin_file::{ReadTin, TinReadOptions, check};
use encoding_rs::{Encoding, WINDOWS_1252};
use std::io::BufRead;
use std::path::Path;

/// What the header says.
#[derive(Debug)]
pub(super) struct Header {
    /// `$INSUNITS`.
    unit: i64,
    /// How text that is not UTF-8 is encoded.
    encoding: &'static Encoding,
    /// The name of the surface, in a comment.
    pub(super) name: String,
}

impl Header {
    /// Text in the drawing's encoding, with its escapes.
    pub(super) fn text(&self, bytes: &[u8]) -> String {
        let text = match std::str::from_utf8(bytes) {
            Ok(text) => text.to_owned(),
            Err(_) => self.encoding.decode_without_bom_handling(bytes).0.into_owned(),
        };
        if text.contains("\\U+") { unescape(&text) } else { text }
    }
}

/// Characters beyond ASCII as releases before 2007 have them.
fn unescape(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once("\\U+") {
        plain.push_str(before);
        let code = after.get(..4).and_then(|digits| u32::from_str_radix(digits, 16).ok());
        match code.and_then(char::from_u32) {
            Some(c) => {
                plain.push(c);
                rest = &after[4..];
            }
            None => {
                plain.push_str("\\U+");
                rest = after;
            }
        }
    }
    plain + rest
}

/// The encoding of a `$DWGCODEPAGE`, e.g. `ANSI_932`.
fn encoding_of(code_page: &[u8]) -> &'static Encoding {
    let number = code_page.rsplit(|&b| b == b'_').next().unwrap_or_default();
    let label = match number {
        b"932" => b"shift_jis".to_vec(),
        b"936" => b"gbk".to_vec(),
        b"949" => b"euc-kr".to_vec(),
        b"950" => b"big5".to_vec(),
        _ => [b"windows-", number].concat(),
    };
    Encoding::for_label(&label).unwrap_or(WINDOWS_1252)
}

/// Reads a text DXF.
pub(in crate::tin_file) fn read(
    name: &Path,
    mut content: impl BufRead,
    options: &TinReadOptions,
) -> Result<ReadTin, IoError> {
    let mut groups = Groups::new(name, &mut content)?;
    let mut header = Header { unit: 0, encoding: WINDOWS_1252, name: String::new() };
    let mut section = Vec::new();
    let mut variable = Vec::new();
    let mut drawing: Option<Drawing> = None;
    let mut ended = false;
    while let Some(code) = groups.next()? {
        match (code, section.as_slice()) {
            (0, _) if groups.value() == b"EOF" => {
                ended = true;
                break;
            }
            (0, _) if matches!(groups.value(), b"SECTION" | b"ENDSEC") => {
                section.clear();
                if let Some(drawing) = &mut drawing {
                    drawing.end_entity()?;
                    drawing.end_polyline()?;
                }
            }
            (2, b"") => section.extend_from_slice(groups.value()),
            (9, b"HEADER") => {
                variable.clear();
                variable.extend_from_slice(groups.value());
            }
            (70, b"HEADER") if variable == b"$INSUNITS" => header.unit = groups.integer()?,
            (3, b"HEADER") if variable == b"$DWGCODEPAGE" => header.encoding = encoding_of(groups.value()),
            (999, _) => {
                if let Some(title) = groups.value().strip_prefix(super::TITLE.as_bytes()) {
                    header.name = header.text(title.trim_ascii());
                }
            }
            (_, b"ENTITIES") => {
                let drawing = drawing.get_or_insert_with(|| Drawing::new(name, unit_m(&header, options), options));
                if code == 0 {
                    drawing.end_entity()?;
                    drawing.begin_entity(&groups)?;
                } else {
                    drawing.group(code, &groups, &header)?;
                }
            }
            _ => {}
        }
    }
    let mut drawing = drawing.unwrap_or_else(|| Drawing::new(name, unit_m(&header, options), options));
    if ended {
        drawing.end_entity()?;
        drawing.end_polyline()?;
    } else {
        drawing
            .notes
            .say(format!("the file ends at line {} without EOF: what was open there is left out", groups.line()));
    }
    let degrees = check::crs(options).geographic;
    if !degrees && options.unit_m.is_none() && units::metres(header.unit).is_none() {
        let why = if header.unit == 0 { "no unit is stated".into() } else { format!("$INSUNITS is {}", header.unit) };
        drawing.notes.say(format!("{why}: metres assumed"));
    }
    drawing.finish(header, options)
}

/// Metres in a unit; degrees are left as they are.
fn unit_m(header: &Header, options: &TinReadOptions) -> f64 {
    if check::crs(options).geographic {
        return 1.0;
    }
    options.unit_m.or_else(|| units::metres(header.unit)).unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_decoded_and_unescaped() {
        let header = |page: &[u8]| Header { unit: 0, encoding: encoding_of(page), name: String::new() };
        assert_eq!(header(b"ANSI_932").text(b"\x91\xaa\x97\xca\x83\x5c"), "測量ソ");
        assert_eq!(header(b"ANSI_1252").text(b"\xe9"), "é");
        assert_eq!(header(b"").text("測量".as_bytes()), "測量");
        assert_eq!(header(b"").text(b"\\U+6E2C\\U+zz\\U+"), "測\\U+zz\\U+");
    }
}
