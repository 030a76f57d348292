//! The pairs of lines a text DXF consists of: a group code, and its value.
//!
//! Based on: Autodesk, "DXF reference", 2018.

use crate::IoError;
use crate::tin_file::lines::{Lines, unreadable};
use std::io::BufRead;
use std::path::Path;

/// A file that is read pair by pair.
pub(super) struct Groups<'a> {
    name: &'a Path,
    lines: Lines<'a>,
}

impl<'a> Groups<'a> {
    /// Starts at the beginning of a file; what is no text DXF is refused.
    pub(super) fn new(name: &'a Path, reader: &'a mut dyn BufRead) -> Result<Self, IoError> {
        let start = reader.fill_buf().map_err(|e| unreadable(name, "start", e))?;
        if start.starts_with(b"AutoCAD Binary DXF") {
            return Err(IoError::unsupported(name, "binary DXF", "save it as text DXF"));
        }
        if start.starts_with(b"AC10") {
            return Err(IoError::unsupported(name, "DWG", "save it as text DXF"));
        }
        if start.starts_with(b"\xef\xbb\xbf") {
            reader.consume(3);
        }
        Ok(Self { name, lines: Lines::new(name, reader) })
    }

    /// The next group's code; its value is then at hand. `None` at the end of the file.
    pub(super) fn next(&mut self) -> Result<Option<i32>, IoError> {
        if !self.lines.next()? {
            return Ok(None);
        }
        let Some(code) = self.parsed() else {
            // empty lines at the end of a file are no group
            while self.value().is_empty() {
                if !self.lines.next()? {
                    return Ok(None);
                }
            }
            return Err(self.lines.bad("a group code"));
        };
        if !self.lines.next()? {
            let place = self.lines.place();
            return Err(IoError::malformed(self.name, place, "the value of a group", "the end of the file"));
        }
        Ok(Some(code))
    }

    /// The value, without blanks around it.
    pub(super) fn value(&self) -> &[u8] {
        self.lines.bytes()
    }

    /// The value as a number. It may not be finite.
    pub(super) fn number(&self) -> Result<f64, IoError> {
        self.parsed().ok_or_else(|| self.lines.bad("a number"))
    }

    /// The value as an integer.
    pub(super) fn integer(&self) -> Result<i64, IoError> {
        self.parsed().ok_or_else(|| self.lines.bad("an integer"))
    }

    /// Number of the line last read.
    pub(super) fn line(&self) -> u64 {
        self.lines.number()
    }

    fn parsed<T: std::str::FromStr>(&self) -> Option<T> {
        std::str::from_utf8(self.value()).ok()?.parse().ok()
    }
}
