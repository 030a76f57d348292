//! An adaptive binary range coder.
//!
//! Based on: Martin, "Range encoding: an algorithm for removing redundancy from a digitised message", 1979; the carry-less
//! byte-wise form and the shift-register probabilities follow Pavlov's LZMA.

const PROB_BITS: u32 = 12;
const RATE: u32 = 4;

/// How likely a 0 is, learnt from the bits coded with it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Probability(u16);

impl Probability {
    /// Both bits are as likely.
    pub(super) const EVEN: Self = Self(1 << (PROB_BITS - 1));

    #[inline]
    fn learn(&mut self, bit: bool) {
        if bit {
            self.0 -= self.0 >> RATE;
        } else {
            self.0 += ((1 << PROB_BITS) - self.0) >> RATE;
        }
    }
}

/// Takes bits.
#[derive(Debug)]
pub(super) struct BinaryEncoder {
    low: u64,
    range: u32,
    cache: u8,
    pending: u64,
    out: Vec<u8>,
}

impl BinaryEncoder {
    pub(super) fn new() -> Self {
        Self { low: 0, range: u32::MAX, cache: 0, pending: 1, out: Vec::new() }
    }

    /// Codes a bit.
    pub(super) fn put(&mut self, bit: bool, p: &mut Probability) {
        let bound = (self.range >> PROB_BITS) * u32::from(p.0);
        if bit {
            self.low += u64::from(bound);
            self.range -= bound;
        } else {
            self.range = bound;
        }
        p.learn(bit);
        while self.range < 1 << 24 {
            self.range <<= 8;
            self.shift_low();
        }
    }

    /// Codes the `count` lowest bits of a number, low ones first, each as likely as not.
    pub(super) fn put_even(&mut self, value: u32, count: u32) {
        for i in 0..count {
            self.put(value >> i & 1 == 1, &mut Probability::EVEN.clone());
        }
    }

    fn shift_low(&mut self) {
        if self.low < 0xFF00_0000 || self.low > 0xFFFF_FFFF {
            let carry = (self.low >> 32) as u8;
            self.out.push(self.cache.wrapping_add(carry));
            self.out.extend((1..self.pending).map(|_| 0xFFu8.wrapping_add(carry)));
            self.pending = 0;
            self.cache = (self.low >> 24) as u8;
        }
        self.pending += 1;
        self.low = (self.low << 8) & 0xFFFF_FFFF;
    }

    /// The coded bytes.
    pub(super) fn finish(mut self) -> Vec<u8> {
        for _ in 0..5 {
            self.shift_low();
        }
        // the first byte is always zero
        self.out.split_off(1)
    }
}

/// Gives bits; past the end of the bytes it goes on with zeros and remembers.
#[derive(Debug)]
pub(super) struct BinaryDecoder<'a> {
    rest: &'a [u8],
    range: u32,
    code: u32,
    overrun: bool,
}

impl<'a> BinaryDecoder<'a> {
    /// Starts on what [`BinaryEncoder::finish`] gave; `None` when it cannot be that.
    pub(super) fn new(bytes: &'a [u8]) -> Option<Self> {
        let (head, rest) = bytes.split_first_chunk()?;
        Some(Self { rest, range: u32::MAX, code: u32::from_be_bytes(*head), overrun: false })
    }

    /// The next bit.
    #[inline]
    pub(super) fn get(&mut self, p: &mut Probability) -> bool {
        let bound = (self.range >> PROB_BITS) * u32::from(p.0);
        let bit = self.code >= bound;
        if bit {
            self.code -= bound;
            self.range -= bound;
        } else {
            self.range = bound;
        }
        p.learn(bit);
        while self.range < 1 << 24 {
            self.range <<= 8;
            let byte = if let Some((&byte, rest)) = self.rest.split_first() {
                self.rest = rest;
                byte
            } else {
                self.overrun = true;
                0
            };
            self.code = self.code << 8 | u32::from(byte);
        }
        bit
    }

    /// Undoes [`BinaryEncoder::put_even`].
    pub(super) fn get_even(&mut self, count: u32) -> u32 {
        (0..count).fold(0, |value, i| value | u32::from(self.get(&mut Probability::EVEN.clone())) << i)
    }

    /// Whether more was asked for than there is.
    pub(super) fn is_overrun(&self) -> bool {
        self.overrun
    }

    /// Whether all bytes were used and no more were asked for.
    pub(super) fn is_exhausted(&self) -> bool {
        !self.overrun && self.rest.is_empty()
    }
}
