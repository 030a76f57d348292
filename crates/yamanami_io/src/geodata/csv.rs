//! Tables of places, and of anything as well-known text.
//!
//! Format: IETF RFC 4180, "Common Format and MIME Type for CSV Files", 2005 (Y. Shafranovich); semicolons and tabs too.

use super::feature::{Feature, Features, Shape};
use super::words::{Word, Words, decoded, number, word_of};
use super::{degrees, wkt};
use crate::IoError;
use glam::DVec3;
use std::path::Path;

/// The records of a table: the line that each begins at, and its fields.
struct Records<'a> {
    rest: &'a str,
    line: usize,
    delimiter: char,
}

impl Iterator for Records<'_> {
    type Item = (usize, Vec<String>);

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let first_line = self.line;
        let (mut fields, mut field, mut in_quotes) = (Vec::new(), String::new(), false);
        let mut chars = self.rest.char_indices().peekable();
        let mut end = self.rest.len();
        while let Some((at, c)) = chars.next() {
            if c == '\n' {
                self.line += 1;
            }
            match c {
                '"' if in_quotes && chars.peek().is_some_and(|&(_, next)| next == '"') => {
                    field.push('"');
                    chars.next();
                }
                '"' if in_quotes || field.trim().is_empty() => in_quotes = !in_quotes,
                '\n' if !in_quotes => {
                    end = at + 1;
                    break;
                }
                c if c == self.delimiter && !in_quotes => fields.push(std::mem::take(&mut field)),
                '\r' if !in_quotes => {}
                c => field.push(c),
            }
        }
        self.rest = &self.rest[end..];
        fields.push(field);
        Some((first_line, fields))
    }
}

/// Reads a table; what is not told by its header is no table of places.
pub(super) fn read(label: &Path, bytes: &[u8]) -> Result<Features, IoError> {
    let text = decoded(bytes);
    let header_line = text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#')).unwrap_or_default();
    let delimiter = ['\t', ';', ','].into_iter().max_by_key(|&d| header_line.matches(d).count()).unwrap_or(',');
    let mut records = Records { rest: &text, line: 1, delimiter };
    let is_content = |fields: &[String]| {
        fields.iter().any(|field| !field.trim().is_empty()) && !fields[0].trim_start().starts_with('#')
    };
    let header = records.by_ref().find(|(_, fields)| is_content(fields));
    let (line, header) = header.unwrap_or((1, Vec::new()));
    let columns: Vec<Option<Word>> = header.iter().map(|field| word_of(field)).collect();
    let has = |word: Word| columns.contains(&Some(word));
    let by_degrees = has(Word::Latitude) && has(Word::Longitude);
    let by_xy = has(Word::X) && has(Word::Y);
    if !(by_degrees || by_xy || has(Word::Geometry)) {
        let expected = "a header with name, lat, lon (名称, 緯度, 経度) or WKT";
        let found = format!("'{}'", header.join(&delimiter.to_string()));
        return Err(IoError::malformed(label, format!("line {line}"), expected, found));
    }
    let mut features = Vec::new();
    for (line, fields) in records.filter(|(_, fields)| is_content(fields)) {
        let mut words = Words::default();
        for (word, field) in columns.iter().zip(&fields) {
            if let Some(word) = word {
                words.add(*word, field);
            }
        }
        let (shape, fault) = match shape_of(&words, by_degrees) {
            Ok(shape) => (shape, None),
            Err(fault) => (Shape::default(), Some(fault)),
        };
        features.push(Feature { place: format!("line {line}"), words, shape, fault });
    }
    let name = label.file_stem().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    Ok(Features { name, features, ..Features::default() })
}

fn shape_of(words: &Words, by_degrees: bool) -> Result<Shape, String> {
    if let Some(text) = words.get(Word::Geometry) {
        let start: String = text.chars().take(40).collect();
        return wkt::parse(text).ok_or_else(|| format!("'{start}', which is no well-known text"));
    }
    let of = |word: Word, what: &str, parse: fn(&str) -> Option<f64>| {
        let text = words.get(word).ok_or_else(|| format!("no {what}"))?;
        parse(text).ok_or_else(|| format!("a {what} of '{}'", text.chars().take(40).collect::<String>()))
    };
    let place = if by_degrees {
        let lon = of(Word::Longitude, "longitude", degrees::parse)?;
        DVec3::new(lon, of(Word::Latitude, "latitude", degrees::parse)?, f64::NAN)
    } else {
        DVec3::new(of(Word::X, "x", number)?, of(Word::Y, "y", number)?, f64::NAN)
    };
    Ok(Shape { points: vec![place], lines: Vec::new() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotes_hold_anything() {
        let text = "a,\"b, \"\"c\"\"\nd\",e\r\n\r\nf;,g";
        let records: Vec<_> = Records { rest: text, line: 1, delimiter: ',' }.collect();
        assert_eq!(records[0], (1, vec!["a".to_owned(), "b, \"c\"\nd".to_owned(), "e".to_owned()]));
        assert_eq!((records[1].0, records[2].0), (3, 4));
        assert_eq!(records[2].1, ["f;", "g"]);
    }
}
