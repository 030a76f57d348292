//! Lines of a text file, one at a time, however large the file.

use crate::IoError;
use std::io::{BufRead, ErrorKind, Read};
use std::path::Path;

/// Longest line that is read, bytes.
const LINE_LIMIT: u64 = 1 << 20;

/// A text file that is read line by line.
pub(super) struct Lines<'a> {
    name: &'a Path,
    reader: &'a mut dyn BufRead,
    line: Vec<u8>,
    number: u64,
}

impl<'a> Lines<'a> {
    /// Starts where the reader is.
    pub(super) fn new(name: &'a Path, reader: &'a mut dyn BufRead) -> Self {
        Self { name, reader, line: Vec::new(), number: 0 }
    }

    /// Reads a line; false at the end of the file.
    pub(super) fn next(&mut self) -> Result<bool, IoError> {
        self.line.clear();
        let read = self.reader.take(LINE_LIMIT).read_until(b'\n', &mut self.line);
        let read = read.map_err(|e| unreadable(self.name, &self.place(), e))? as u64;
        self.number += u64::from(read > 0);
        if read == LINE_LIMIT {
            return Err(IoError::malformed(self.name, self.place(), "a short line", format!("{read} bytes or more")));
        }
        Ok(read > 0)
    }

    /// The line, without blanks around it.
    pub(super) fn bytes(&self) -> &[u8] {
        self.line.trim_ascii()
    }

    /// The line's number, from 1.
    pub(super) fn number(&self) -> u64 {
        self.number
    }

    /// Where an error is.
    pub(super) fn place(&self) -> String {
        // a file without a line begins on its first
        format!("line {}", self.number.max(1))
    }

    /// The line as an error: what should be there.
    pub(super) fn bad(&self, expected: &str) -> IoError {
        let start = &self.bytes()[..self.bytes().len().min(60)];
        IoError::malformed(self.name, self.place(), expected, format!("'{}'", String::from_utf8_lossy(start)))
    }
}

/// What a file could not be read for: a broken packing is the file's fault.
pub(super) fn unreadable(name: &Path, place: &str, error: std::io::Error) -> IoError {
    match error.kind() {
        ErrorKind::InvalidData | ErrorKind::InvalidInput | ErrorKind::UnexpectedEof | ErrorKind::Other => {
            IoError::malformed(name, place, "whole packed data", error.to_string())
        }
        _ => IoError::io(name, error),
    }
}
