//! Plain bits and variable-length integers: what the entropy coder leaves aside.
//!
//! Bits fill bytes from the lowest up. Integers in headers are LEB128: seven bits a byte, low ones first, the top bit
//! set while more follow; signed ones are zigzagged first (0, -1, 1, -2, ...).

/// Collects bits.
#[derive(Debug, Default)]
pub(super) struct BitWriter {
    bytes: Vec<u8>,
    held: u64,
    count: u32,
}

impl BitWriter {
    /// Appends the `count` (at most 32) lowest bits of `value`; bits above them must be zero.
    #[inline]
    pub(super) fn put(&mut self, value: u32, count: u32) {
        debug_assert!(count <= 32 && u64::from(value) >> count == 0);
        self.held |= u64::from(value) << self.count;
        self.count += count;
        while self.count >= 8 {
            self.bytes.push(self.held as u8);
            self.held >>= 8;
            self.count -= 8;
        }
    }

    /// Appends a number in Elias' gamma code of `value + 1`.
    pub(super) fn put_gamma(&mut self, value: u32) {
        let v = u64::from(value) + 1;
        let extra = v.ilog2();
        self.put(0, extra);
        self.put(1, 1);
        self.put((v & ((1 << extra) - 1)) as u32, extra);
    }

    pub(super) fn finish(mut self) -> Vec<u8> {
        if self.count > 0 {
            self.bytes.push(self.held as u8);
        }
        self.bytes
    }
}

/// Reads bits; past the end it reads zeros and remembers.
#[derive(Debug)]
pub(super) struct BitReader<'a> {
    bytes: &'a [u8],
    next: usize,
    held: u64,
    count: u32,
    overrun: bool,
}

impl<'a> BitReader<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, next: 0, held: 0, count: 0, overrun: false }
    }

    /// Holds at least 32 bits, or all there are.
    #[inline]
    fn refill(&mut self) {
        if let Some(bytes) = self.bytes.get(self.next..).and_then(|rest| rest.first_chunk()) {
            self.held |= u64::from(u32::from_le_bytes(*bytes)) << self.count;
            self.next += 4;
            self.count += 32;
            return;
        }
        while self.count < 32 {
            let Some(&byte) = self.bytes.get(self.next) else { return };
            self.held |= u64::from(byte) << self.count;
            self.next += 1;
            self.count += 8;
        }
    }

    /// The next `count` (at most 32) bits.
    #[inline]
    pub(super) fn get(&mut self, count: u32) -> u32 {
        if self.count < count {
            self.refill();
            if self.count < count {
                self.overrun = true;
                self.count = count;
            }
        }
        let value = (self.held & ((1u64 << count) - 1)) as u32;
        self.held >>= count;
        self.count -= count;
        value
    }

    /// Undoes [`BitWriter::put_gamma`].
    pub(super) fn get_gamma(&mut self) -> u32 {
        let mut extra = 0;
        while self.get(1) == 0 {
            extra += 1;
            if extra > 32 {
                self.overrun = true;
                return 0;
            }
        }
        let v = (1u64 << extra) | u64::from(self.get(extra));
        u32::try_from(v - 1).unwrap_or_else(|_| {
            self.overrun = true;
            0
        })
    }

    /// Whether all bytes were used and no more were asked for.
    pub(super) fn is_exhausted(&self) -> bool {
        !self.overrun && self.next == self.bytes.len() && self.count < 8
    }
}

/// Appends an unsigned LEB128 integer.
pub(crate) fn put_varint(out: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

/// Takes an unsigned LEB128 integer off the front.
pub(crate) fn take_varint(bytes: &mut &[u8]) -> Option<u64> {
    let mut value = 0u64;
    for shift in (0..64).step_by(7) {
        let (&byte, rest) = bytes.split_first()?;
        *bytes = rest;
        value |= u64::from(byte & 0x7F) << shift;
        if byte < 0x80 {
            return Some(value);
        }
    }
    None
}

/// Maps a signed integer to an unsigned one, small to small.
pub(super) fn zigzag(value: i64) -> u64 {
    ((value << 1) ^ (value >> 63)) as u64
}

/// Undoes [`zigzag`].
pub(super) fn unzigzag(value: u64) -> i64 {
    (value >> 1) as i64 ^ -((value & 1) as i64)
}

/// Takes `count` bytes off the front.
pub(crate) fn take<'a>(bytes: &mut &'a [u8], count: usize) -> Option<&'a [u8]> {
    let (head, rest) = bytes.split_at_checked(count)?;
    *bytes = rest;
    Some(head)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn bits_come_back(values in proptest::collection::vec((any::<u32>(), 0u32..=32), 0..60)) {
            let mut writer = BitWriter::default();
            for &(v, n) in &values {
                writer.put((u64::from(v) & ((1u64 << n) - 1)) as u32, n);
                writer.put_gamma(v >> (n / 2));
            }
            let bytes = writer.finish();
            let mut reader = BitReader::new(&bytes);
            for &(v, n) in &values {
                prop_assert_eq!(u64::from(reader.get(n)), u64::from(v) & ((1u64 << n) - 1));
                prop_assert_eq!(reader.get_gamma(), v >> (n / 2));
            }
            prop_assert!(reader.is_exhausted());
        }

        #[test]
        fn integers_come_back(values in proptest::collection::vec(any::<i64>(), 0..40)) {
            let mut bytes = Vec::new();
            for &v in &values {
                put_varint(&mut bytes, zigzag(v));
            }
            let mut rest = bytes.as_slice();
            for &v in &values {
                prop_assert_eq!(take_varint(&mut rest).map(unzigzag), Some(v));
            }
            prop_assert!(rest.is_empty());
        }
    }
}
