//! A binary arithmetic coder whose stream may be cut anywhere: what is left gives every bit that it still decides, and then
//! ends.
//!
//! Based on: Rissanen, Langdon, "Arithmetic coding", 1979; the carry-less form with two 32-bit bounds follows Mahoney's lpaq. Where we
//! differ: missing bytes are neither zeros nor an error; a bit counts as read only when no continuation could change it.

/// Where bits go to or come from.
pub(super) trait Bits {
    /// Codes a bit that is 1 with probability `one` of 65536: an encoder puts `bit`, a decoder gives what it read. `None`: the
    /// stream has ended.
    fn code(&mut self, one: u32, bit: bool) -> Option<bool>;
}

/// Where a range is cut in two.
fn middle(low: u32, high: u32, one: u32) -> u32 {
    low + ((u64::from(high - low) * u64::from(one)) >> 16) as u32
}

/// Takes bits, until a number of bytes is full.
#[derive(Debug)]
pub(super) struct Encoder {
    low: u32,
    high: u32,
    out: Vec<u8>,
}

impl Encoder {
    pub(super) fn new() -> Self {
        Self { low: 0, high: u32::MAX, out: Vec::new() }
    }

    /// The bytes: as few as decide every bit.
    pub(super) fn finish(mut self) -> Vec<u8> {
        for kept in 0..=4 {
            let rest = if kept == 4 { 0 } else { u32::MAX >> (8 * kept) };
            // the least number from `low` on that ends in zeros
            let Some(value) = self.low.checked_add(rest).map(|v| v & !rest) else { continue };
            if value | rest <= self.high {
                self.out.extend_from_slice(&value.to_be_bytes()[..kept]);
                return self.out;
            }
        }
        self.out.extend(self.low.to_be_bytes());
        self.out
    }
}

impl Bits for Encoder {
    #[inline]
    fn code(&mut self, one: u32, bit: bool) -> Option<bool> {
        let middle = middle(self.low, self.high, one);
        if bit {
            self.high = middle;
        } else {
            self.low = middle + 1;
        }
        while (self.low ^ self.high) >> 24 == 0 {
            self.out.push((self.high >> 24) as u8);
            self.low <<= 8;
            self.high = self.high << 8 | 0xFF;
        }
        Some(bit)
    }
}

/// Gives bits.
#[derive(Debug)]
pub(super) struct Decoder<'a> {
    low: u32,
    high: u32,
    value: u32,
    /// The bits of `value` that no byte was there for.
    unknown: u32,
    rest: &'a [u8],
}

impl<'a> Decoder<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        let mut new = Self { low: 0, high: u32::MAX, value: 0, unknown: 0, rest: bytes };
        for _ in 0..4 {
            new.shift();
        }
        new
    }

    #[inline]
    fn shift(&mut self) {
        if let Some((&byte, rest)) = self.rest.split_first() {
            self.rest = rest;
            self.value = self.value << 8 | u32::from(byte);
        } else {
            self.value <<= 8;
            self.unknown = self.unknown << 8 | 0xFF;
        }
    }
}

impl Bits for Decoder<'_> {
    #[inline]
    fn code(&mut self, one: u32, _: bool) -> Option<bool> {
        let middle = middle(self.low, self.high, one);
        let bit = self.value <= middle;
        if bit && self.value | self.unknown > middle {
            return None;
        }
        if bit {
            self.high = middle;
        } else {
            self.low = middle + 1;
        }
        while (self.low ^ self.high) >> 24 == 0 {
            self.low <<= 8;
            self.high = self.high << 8 | 0xFF;
            self.shift();
        }
        Some(bit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_prefix_gives_a_prefix(bits in proptest::collection::vec((1u32..65535, any::<bool>()), 0..300), cut in any::<prop::sample::Index>()) {
            let mut encoder = Encoder::new();
            for &(one, bit) in &bits {
                encoder.code(one, bit);
            }
            let bytes = encoder.finish();
            let mut whole = Decoder::new(&bytes);
            for &(one, bit) in &bits {
                prop_assert_eq!(whole.code(one, false), Some(bit));
            }
            let mut part = Decoder::new(&bytes[..cut.index(bytes.len() + 1)]);
            for &(one, bit) in &bits {
                let Some(read) = part.code(one, false) else { break };
                prop_assert_eq!(read, bit);
            }
        }
    }
}
