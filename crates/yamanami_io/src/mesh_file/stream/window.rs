//! A stretch of a file in memory that moves forward through it.

use super::super::ply_header::{Encoding, Number};
use std::fs::File;
use std::io::{Read, Result, Seek, SeekFrom};

/// Bytes read at a time.
const WINDOW: usize = 1 << 20;
/// Longest word of a text file that may be a number.
const WORD: usize = 256;

#[derive(Debug)]
pub(super) struct Window<'a> {
    file: &'a mut File,
    encoding: Encoding,
    buffer: Vec<u8>,
    /// What of the buffer is still ahead.
    start: usize,
    end: usize,
    /// Place in the file of the first byte ahead.
    offset: u64,
}

impl<'a> Window<'a> {
    pub(super) fn new(file: &'a mut File, offset: u64, encoding: Encoding) -> Result<Self> {
        file.seek(SeekFrom::Start(offset))?;
        Ok(Self { file, encoding, buffer: vec![0; WINDOW], start: 0, end: 0, offset })
    }

    /// Place in the file of what comes next.
    pub(super) fn offset(&self) -> u64 {
        self.offset
    }

    pub(super) fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// The bytes at hand.
    pub(super) fn ahead(&self) -> &[u8] {
        &self.buffer[self.start..self.end]
    }

    /// Sees to it that so many bytes are at hand; false when the file ends before.
    pub(super) fn want(&mut self, bytes: usize) -> Result<bool> {
        if self.end - self.start >= bytes {
            return Ok(true);
        }
        self.buffer.copy_within(self.start..self.end, 0);
        self.end -= self.start;
        self.start = 0;
        if bytes > self.buffer.len() {
            self.buffer.resize(bytes, 0);
        }
        while self.end < bytes {
            match self.file.read(&mut self.buffer[self.end..]) {
                Ok(0) => return Ok(false),
                Ok(n) => self.end += n,
                Err(e) if e.kind() == std::io::ErrorKind::Interrupted => {}
                Err(e) => return Err(e),
            }
        }
        Ok(true)
    }

    /// Goes past bytes at hand.
    pub(super) fn pass(&mut self, bytes: usize) {
        debug_assert!(bytes <= self.end - self.start);
        self.start += bytes;
        self.offset += bytes as u64;
    }

    /// The next value, or `None` at the end of the file or where there is no number.
    pub(super) fn next(&mut self, number: Number) -> Result<Option<f64>> {
        if self.encoding == Encoding::Ascii {
            return self.next_word();
        }
        let size = number.size();
        if !self.want(size)? {
            return Ok(None);
        }
        let value = decode(self.ahead(), number, self.encoding);
        self.pass(size);
        Ok(Some(value))
    }

    fn next_word(&mut self) -> Result<Option<f64>> {
        loop {
            let space = self.ahead().iter().take_while(|b| b.is_ascii_whitespace()).count();
            self.pass(space);
            if !self.ahead().is_empty() {
                break;
            }
            if !self.want(1)? {
                return Ok(None);
            }
        }
        self.want(WORD)?;
        let word = self.ahead();
        let Some(length) = word.iter().take(WORD).position(u8::is_ascii_whitespace).or_else(|| {
            // the last word of a file may end with it
            (word.len() < WORD).then_some(word.len())
        }) else {
            return Ok(None);
        };
        let value = std::str::from_utf8(&word[..length]).ok().and_then(|word| word.parse().ok());
        self.pass(length);
        Ok(value)
    }
}

/// The binary value at the start of some bytes, which are enough.
#[inline]
pub(super) fn decode(bytes: &[u8], number: Number, encoding: Encoding) -> f64 {
    let size = number.size();
    let mut little = [0u8; 8];
    little[..size].copy_from_slice(&bytes[..size]);
    if encoding == Encoding::BigEndian {
        little[..size].reverse();
    }
    let bits = u64::from_le_bytes(little);
    match number {
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
