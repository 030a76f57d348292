//! The header of a PLY file.
//!
//! Based on: Turk, "The PLY polygon file format", 1994.

use crate::IoError;
use std::path::Path;

/// How the values after the header are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// Type of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Number {
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes of a stored value.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// One value, or a counted list of values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Scalar(Number),
    List { count: Number, item: Number },
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Kind,
}

/// A run of equal records: vertices, faces.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

impl Element {
    /// Least bytes that one record takes; in text, a digit and a space each value.
    pub(super) fn least_bytes(&self, encoding: Encoding) -> usize {
        let stored = |number: Number| if encoding == Encoding::Ascii { 2 } else { number.size() };
        self.properties
            .iter()
            .map(|p| match p.kind {
                Kind::Scalar(number) | Kind::List { count: number, .. } => stored(number),
            })
            .sum()
    }

    /// Whether all records have the same length in binary.
    pub(super) fn is_fixed(&self) -> bool {
        self.properties.iter().all(|p| matches!(p.kind, Kind::Scalar(_)))
    }

    /// Index of the first property with one of these names.
    pub(super) fn property(&self, names: &[&str]) -> Option<usize> {
        self.properties.iter().position(|p| names.contains(&p.name.as_str()))
    }
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Pictures that comments name: `comment TextureFile skin.png`, as MeshLab writes.
    pub(super) textures: Vec<String>,
}

/// Reads the header; what follows it comes back beside it.
pub(super) fn read<'a>(name: &Path, bytes: &'a [u8]) -> Result<(Header, &'a [u8]), IoError> {
    let bad = |line: usize, expected: &str, found: &str| {
        let found: String = found.chars().take(60).collect();
        IoError::malformed(name, format!("header line {line}"), expected, format!("'{found}'"))
    };
    // the first line's end is every line's end; after the last one, binary data may look like anything
    let line_end: &[u8] = match bytes {
        [b'p', b'l', b'y', b'\r', b'\n', ..] => b"\r\n",
        [b'p', b'l', b'y', b'\r', ..] => b"\r",
        [b'p', b'l', b'y', b'\n', ..] => b"\n",
        _ => {
            let start = String::from_utf8_lossy(&bytes[..bytes.len().min(8)]).escape_debug().to_string();
            return Err(bad(1, "'ply'", &start));
        }
    };
    let mut rest = bytes;
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut textures = Vec::new();
    let mut number = 0;
    loop {
        number += 1;
        let Some(end) = find(rest, line_end) else {
            return Err(bad(number, "a line, up to 'end_header'", "end of file"));
        };
        let line = String::from_utf8_lossy(&rest[..end]);
        rest = &rest[end + line_end.len()..];
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        match words[..] {
            ["comment", "TextureFile", ..] => {
                let named = line.split_once("TextureFile").map_or("", |(_, named)| named.trim());
                textures.push(named.to_owned());
            }
            [] | ["ply" | "comment" | "obj_info", ..] => {}
            ["format", format, ..] => {
                encoding = Some(match format {
                    "ascii" => Encoding::Ascii,
                    "binary_little_endian" => Encoding::LittleEndian,
                    "binary_big_endian" => Encoding::BigEndian,
                    _ => return Err(bad(number, "'ascii', 'binary_little_endian' or 'binary_big_endian'", format)),
                });
            }
            ["element", element, count] => {
                let count = count.parse().map_err(|_| bad(number, "a number of elements", count))?;
                elements.push(Element { name: element.into(), count, properties: Vec::new() });
            }
            ["property", ref property @ ..] => {
                let kind = match *property {
                    ["list", count, item, _] => {
                        Number::named(count).zip(Number::named(item)).map(|(count, item)| Kind::List { count, item })
                    }
                    [scalar, _] => Number::named(scalar).map(Kind::Scalar),
                    _ => None,
                };
                let (Some(kind), Some(element)) = (kind, elements.last_mut()) else {
                    return Err(bad(number, "'property TYPE NAME' or 'property list TYPE TYPE NAME'", &line));
                };
                let property = property.last().copied().unwrap_or_default().to_owned();
                element.properties.push(Property { name: property, kind });
            }
            ["end_header"] => {
                let encoding = encoding.ok_or_else(|| bad(number, "a 'format' line before the end", "none"))?;
                return Ok((Header { encoding, elements, textures }, rest));
            }
            _ => return Err(bad(number, "'format', 'element', 'property', 'comment' or 'end_header'", &line)),
        }
    }
}

/// Where `pattern` first starts.
fn find(bytes: &[u8], pattern: &[u8]) -> Option<usize> {
    bytes.windows(pattern.len()).position(|w| w == pattern)
}
