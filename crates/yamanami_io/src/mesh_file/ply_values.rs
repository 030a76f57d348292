//! The values of a PLY file after its header: numbers of any type in text or either byte order, one after the other.

use super::ply_header::{Element, Encoding, Kind, Number};
use crate::IoError;
use std::path::Path;

/// The values that are left to read.
pub(super) struct Values<'a> {
    pub(super) name: &'a Path,
    pub(super) rest: &'a [u8],
    pub(super) encoding: Encoding,
}

impl<'a> Values<'a> {
    /// Refuses a count that the rest of the file cannot hold.
    pub(super) fn check_room(&self, element: &Element) -> Result<(), IoError> {
        let least = element.least_bytes(self.encoding) as u64;
        // text may lack the last separator
        let needed = element.count.saturating_mul(least).saturating_sub(u64::from(self.encoding == Encoding::Ascii));
        if needed > self.rest.len() as u64 {
            let expected = format!("at least {needed} bytes for {} records", element.count);
            return Err(self.bad(&format!("element '{}'", element.name), &expected, &format!("{}", self.rest.len())));
        }
        Ok(())
    }

    pub(super) fn bad(&self, place: &str, expected: &str, found: &str) -> IoError {
        IoError::malformed(self.name, place, expected, found)
    }

    /// The next value, or `None` at the end of the file or where there is no number.
    fn next(&mut self, number: Number) -> Option<f64> {
        if self.encoding == Encoding::Ascii {
            let start = self.rest.iter().position(|b| !b.is_ascii_whitespace())?;
            let rest = &self.rest[start..];
            let end = rest.iter().position(|b| b.is_ascii_whitespace()).unwrap_or(rest.len());
            self.rest = &rest[end..];
            return std::str::from_utf8(&rest[..end]).ok()?.parse().ok();
        }
        let (raw, rest) = self.rest.split_at_checked(number.size())?;
        self.rest = rest;
        Some(number.value(raw, self.encoding))
    }

    /// The next value of a record's property.
    pub(super) fn scalar(
        &mut self,
        number: Number,
        element: &Element,
        record: u64,
        property: usize,
    ) -> Result<f64, IoError> {
        self.next(number).ok_or_else(|| {
            let property = &element.properties[property].name;
            self.bad(&format!("{} {record}, '{property}'", element.name), "a number", "none")
        })
    }

    /// The next list; its items replace those in `items`.
    pub(super) fn list(
        &mut self,
        [count, item]: [Number; 2],
        element: &Element,
        record: u64,
        property: usize,
        items: &mut Vec<f64>,
    ) -> Result<(), IoError> {
        items.clear();
        let length = self.scalar(count, element, record, property)?;
        if !(length >= 0.0 && length.fract() == 0.0 && length <= self.rest.len() as f64) {
            let place = format!("{} {record}, '{}'", element.name, element.properties[property].name);
            let expected = format!("a list that fits in the {} bytes left", self.rest.len());
            return Err(self.bad(&place, &expected, &format!("{length} items")));
        }
        for _ in 0..length as usize {
            items.push(self.scalar(item, element, record, property)?);
        }
        Ok(())
    }

    /// Passes over an element that nobody asked for.
    pub(super) fn skip(&mut self, element: &Element) -> Result<(), IoError> {
        if element.is_fixed() && self.encoding != Encoding::Ascii {
            // the room was checked
            self.rest = &self.rest[element.count as usize * element.least_bytes(self.encoding)..];
            return Ok(());
        }
        if element.properties.is_empty() {
            return Ok(());
        }
        let mut items = Vec::new();
        for number in 0..element.count {
            for (k, property) in element.properties.iter().enumerate() {
                match property.kind {
                    Kind::Scalar(kind) => {
                        self.scalar(kind, element, number, k)?;
                    }
                    Kind::List { count, item } => self.list([count, item], element, number, k, &mut items)?,
                }
            }
        }
        Ok(())
    }
}

impl Number {
    /// The value of as many bytes as the type has.
    #[inline]
    pub(super) fn value(self, raw: &[u8], encoding: Encoding) -> f64 {
        let mut little = [0u8; 8];
        little[..raw.len()].copy_from_slice(raw);
        if encoding == Encoding::BigEndian {
            little[..raw.len()].reverse();
        }
        let bits = u64::from_le_bytes(little);
        match self {
            Number::I8 => f64::from(bits as i8),
            Number::U8 => f64::from(bits as u8),
            Number::I16 => f64::from(bits as i16),
            Number::U16 => f64::from(bits as u16),
            Number::I32 => f64::from(bits as i32),
            Number::U32 => f64::from(bits as u32),
            Number::F32 => f64::from(f32::from_bits(bits as u32)),
            Number::F64 => f64::from_bits(bits),
        }
    }
}
