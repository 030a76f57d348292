//! Four interleaved range coders over static distributions.
//!
//! Based on: Duda, "Asymmetric numeral systems", 2013; Giesen, "Interleaved entropy coders", 2014 (the 16-bit word
//! variant). A state lies in [2^16, 2^32); the encoder works backwards, the decoder forwards.

use super::family::PROB_BITS;

/// Symbols of a row go to the coders in turn: column modulo this.
pub(super) const LANES: usize = 4;
const LOW: u32 = 1 << 16;
const SLOT_MASK: u32 = (1 << PROB_BITS) - 1;

/// A symbol's span of slots, ready for the encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Span {
    /// 2^44 / frequency, rounded up: exact division of states by one multiplication.
    reciprocal: u64,
    start: u16,
    frequency: u16,
}

impl Span {
    pub(super) fn new(start: u32, frequency: u32) -> Self {
        let reciprocal = (1u64 << 44).div_ceil(u64::from(frequency));
        Self { reciprocal, start: start as u16, frequency: frequency as u16 }
    }
}

/// Takes symbols last to first.
#[derive(Debug)]
pub(super) struct Encoder {
    states: [u32; LANES],
    /// Words in the reverse of reading order.
    words: Vec<u16>,
}

impl Encoder {
    pub(super) fn new() -> Self {
        Self { states: [LOW; LANES], words: Vec::with_capacity(1 << 14) }
    }

    /// Adds a row in front of those already there; `span_of` tells the span of a column.
    #[inline(always)]
    pub(super) fn row(&mut self, columns: usize, span_of: impl Fn(usize) -> Span) {
        let mut states = self.states;
        for x in (0..columns).rev() {
            let span = span_of(x);
            let state = &mut states[x % LANES];
            let frequency = u32::from(span.frequency);
            if *state >> (32 - PROB_BITS) >= frequency {
                self.words.push(*state as u16);
                *state >>= 16;
            }
            let quotient = ((u128::from(*state) * u128::from(span.reciprocal)) >> 44) as u32;
            *state += u32::from(span.start) + quotient * ((1 << PROB_BITS) - frequency);
        }
        self.states = states;
    }

    /// The four states and the words, little-endian.
    pub(super) fn finish(self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(4 * LANES + 2 * self.words.len());
        bytes.extend(self.states.iter().flat_map(|s| s.to_le_bytes()));
        bytes.extend(self.words.iter().rev().flat_map(|w| w.to_le_bytes()));
        bytes
    }
}

/// Gives symbols first to last.
#[derive(Debug)]
pub(super) struct Decoder<'a> {
    states: [u32; LANES],
    words: &'a [[u8; 2]],
    next: usize,
}

impl<'a> Decoder<'a> {
    /// Starts on what [`Encoder::finish`] gave; `None` when it cannot be that.
    pub(super) fn new(bytes: &'a [u8]) -> Option<Self> {
        let (head, rest) = bytes.split_at_checked(4 * LANES)?;
        let (words, odd) = rest.as_chunks();
        let mut states = [0; LANES];
        for (state, bytes) in states.iter_mut().zip(head.as_chunks().0) {
            *state = u32::from_le_bytes(*bytes);
        }
        odd.is_empty().then_some(Self { states, words, next: 0 })
    }

    /// Decodes a row: each column's context names a table by where its slots begin in `slots`.
    #[inline(always)]
    pub(super) fn row(&mut self, contexts: &[u8], begins: &[u32; 64], slots: &[u32], symbols: &mut [i8]) {
        let mut states = self.states;
        let (words, mut next) = (self.words, self.next);
        let mut step = |state: &mut u32, context: u8, symbol: &mut i8| {
            let index = (begins[usize::from(context & 63)] | (*state & SLOT_MASK)) as usize;
            let slot = slots.get(index).copied().unwrap_or(0);
            *symbol = slot as u8 as i8;
            let x = ((slot >> 8 & SLOT_MASK) + 1).wrapping_mul(*state >> PROB_BITS).wrapping_add(slot >> 20);
            let word = words.get(next).copied().unwrap_or([0; 2]);
            let more = x < LOW;
            *state = if more { x << 16 | u32::from(u16::from_le_bytes(word)) } else { x };
            next += usize::from(more);
        };
        let (symbol_chunks, symbol_rest) = symbols.as_chunks_mut::<LANES>();
        let (context_chunks, context_rest) = contexts.as_chunks::<LANES>();
        let [mut a, mut b, mut c, mut d] = states;
        for (s, t) in symbol_chunks.iter_mut().zip(context_chunks) {
            step(&mut a, t[0], &mut s[0]);
            step(&mut b, t[1], &mut s[1]);
            step(&mut c, t[2], &mut s[2]);
            step(&mut d, t[3], &mut s[3]);
        }
        states = [a, b, c, d];
        for (lane, (s, t)) in symbol_rest.iter_mut().zip(context_rest).enumerate() {
            step(&mut states[lane], *t, s);
        }
        self.states = states;
        self.next = next;
    }

    /// Whether everything was read and the states are back where the encoder began.
    pub(super) fn is_exhausted(&self) -> bool {
        self.next == self.words.len() && self.states == [LOW; LANES]
    }
}
