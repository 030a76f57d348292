//! The distributions that residuals are coded with: a fixed family of bell curves, so that a page spends a byte on a
//! distribution and not a table.
//!
//! Error codes use a few more tables whose bell stands a third of a step to the right of zero.
//!
//! A member is a *scale* in quarter octaves and one of four shapes of the generalised normal density
//! exp(-(|x| / a)^b), b = 3/4, 1, 3/2, 2, sampled at the integers. Large scales code the upper bits of a residual with a
//! member of the top octave and leave the lower ones plain. The tables use only operations that IEEE 754 rounds the same
//! everywhere, so that a file reads the same on every machine.

use super::rans::Span;
use std::sync::LazyLock;

/// Frequencies of a distribution add up to `1 << PROB_BITS`.
pub(super) const PROB_BITS: u32 = 12;
/// Shapes of the density.
pub(super) const SHAPES: usize = 4;
/// Scales that are coded without plain bits; above, every four add one.
const PLAIN_SCALES: u32 = 26;
/// One past the largest scale.
pub(super) const SCALES: u32 = 144;
/// Largest magnitude coded as a symbol; `ESCAPE` stands for all above.
const MAX_SYMBOL: i32 = 30;
/// Symbols are clamped to this before they are coded.
pub(super) const SPAN_REACH: i32 = 64;
/// Symbol ±ESCAPE: the rest of the magnitude follows in plain bits.
pub(super) const ESCAPE: i32 = 64;

/// Scales of error tables: half octaves of the mean size from 1/8 on.
pub(super) const ERROR_SCALES: usize = 10;
/// Shapes of error tables: the three lighter-tailed ones.
pub(super) const ERROR_SHAPES: usize = 3;

/// The table for differences of error codes; `shifted`: by a third of a step.
pub(super) fn error_table(scale: usize, shape: usize, shifted: bool) -> usize {
    PLAIN_SCALES as usize * SHAPES + (scale * ERROR_SHAPES + shape) * 2 + usize::from(shifted)
}

/// Where a table's slots begin.
#[inline]
pub(super) fn table_begin(table: usize) -> u32 {
    (table as u32) << PROB_BITS
}

/// A member of the family, ready for use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Member {
    /// Which table.
    pub(super) table: usize,
    /// How many low bits go plain.
    pub(super) plain_bits: u32,
}

impl Member {
    /// The member of a scale below [`SCALES`] and a shape below [`SHAPES`].
    pub(super) fn new(scale: u32, shape: usize) -> Self {
        let plain_bits = if scale < PLAIN_SCALES { 0 } else { (scale - PLAIN_SCALES) / 4 + 1 };
        Self { table: (scale - 4 * plain_bits) as usize * SHAPES + shape, plain_bits }
    }

    /// A residual's symbol (not yet checked against the table's reach).
    #[inline(always)]
    pub(super) fn symbol(residual: i32, plain_bits: u32) -> i64 {
        (i64::from(residual) + ((1i64 << plain_bits) >> 1)) >> plain_bits
    }

    /// A residual's plain bits.
    #[inline]
    pub(super) fn plain(self, residual: i32) -> u32 {
        let lifted = i64::from(residual) + ((1i64 << self.plain_bits) >> 1);
        (lifted & ((1 << self.plain_bits) - 1)) as u32
    }

    /// Where its slots begin.
    #[inline]
    pub(super) fn begin(self) -> u32 {
        table_begin(self.table)
    }

    /// The residual of a symbol and plain bits.
    #[inline]
    pub(super) fn join(self, symbol: i64, plain: u32) -> i32 {
        let k = self.plain_bits;
        ((symbol << k) + i64::from(plain) - ((1i64 << k) >> 1)) as i32
    }
}

/// The scale whose mean magnitude is nearest to `mean`.
pub(super) fn nearest_scale(mean: f32) -> u32 {
    (16.0 + 4.0 * mean.max(1e-6).log2()).round().clamp(0.0, (SCALES - 1) as f32) as u32
}

/// Frequencies of one table.
#[derive(Debug, Clone)]
pub(super) struct Frequencies {
    /// Largest magnitude with a symbol of its own.
    pub(super) reach: i32,
    /// Of the symbols -ESCAPE, -reach..=reach, +ESCAPE: (start, frequency).
    counts: Vec<(u32, u32)>,
    /// The same for the encoder, escapes repeated, by symbol plus [`SPAN_REACH`].
    spans: Box<[Span; 256]>,
    /// Bits a symbol costs, an escape's extra bits included, by symbol plus [`SPAN_REACH`].
    cost: Box<[f32; 2 * SPAN_REACH as usize + 1]>,
}

impl Frequencies {
    /// Whether a symbol must escape.
    #[inline]
    pub(super) fn escapes(&self, symbol: i8) -> bool {
        i32::from(symbol).abs() > self.reach
    }

    /// The span of a symbol (of its escape, when it is out of reach).
    #[inline]
    pub(super) fn span(&self, symbol: i8) -> Span {
        self.spans[usize::from(symbol.wrapping_add(SPAN_REACH as i8) as u8)]
    }

    /// Bits of the symbols from -[`SPAN_REACH`] on, an escape's extra bits included.
    #[inline]
    pub(super) fn costs(&self) -> &[f32] {
        &self.cost[..]
    }
}

/// All tables.
#[derive(Debug)]
pub(super) struct Family {
    /// Per table `1 << PROB_BITS` slots: symbol (8 bits), frequency - 1, slot - start (12 bits each), low to high.
    pub(super) slots: Vec<u32>,
    /// By table.
    pub(super) frequencies: Vec<Frequencies>,
}

/// The family; made at first use.
pub(super) static FAMILY: LazyLock<Family> = LazyLock::new(|| {
    let mut tables = Vec::new();
    for scale in 0..PLAIN_SCALES {
        tables.extend((0..SHAPES).map(|shape| frequencies(scale, shape, 0.0)));
    }
    for scale in 0..ERROR_SCALES as u32 {
        for shape in 1..=ERROR_SHAPES {
            tables.extend([0.0, 1.0 / 3.0].map(|shift| frequencies(4 + 2 * scale, shape, shift)));
        }
    }
    let frequencies = tables;
    let mut slots = Vec::with_capacity(frequencies.len() << PROB_BITS);
    for table in &frequencies {
        for (i, &(_, frequency)) in table.counts.iter().enumerate() {
            let symbol = match i as i32 - table.reach - 1 {
                s if s > table.reach => ESCAPE,
                s if s < -table.reach => -ESCAPE,
                s => s,
            };
            slots.extend((0..frequency).map(|k| u32::from(symbol as i8 as u8) | (frequency - 1) << 8 | k << 20));
        }
    }
    Family { slots, frequencies }
});

fn frequencies(scale: u32, shape: usize, shift: f64) -> Frequencies {
    // 2^((scale - 16) / 4) by exact steps
    let quarter = 2f64.sqrt().sqrt();
    let mut mean = 0.0625;
    for _ in 0..scale {
        mean *= quarter;
    }
    // a, from the mean magnitude: the ratio of two gamma functions
    let width = mean * [0.593_510, 1.0, 1.516_400, 1.772_454][shape];
    let density = |x: f64| {
        let t = x / width;
        negative_exp(match shape {
            0 => t.sqrt() * t.sqrt().sqrt(),
            1 => t,
            2 => t * t.sqrt(),
            _ => t * t,
        })
    };
    let weight = |symbol: i32| density((f64::from(symbol) - shift).abs());
    const FAR: i32 = 1024;
    let total: f64 = (-FAR..=FAR).map(weight).sum();
    let slots = f64::from(1u32 << PROB_BITS);
    let reach = (2..=MAX_SYMBOL).take_while(|&i| weight(i) / total * slots >= 0.5).last().unwrap_or(1);
    let symbols = (2 * reach + 3) as u32;
    let spare = f64::from((1 << PROB_BITS) - symbols);
    let mut counts: Vec<u32> = (-reach - 1..=reach + 1)
        .map(|s| match s {
            s if s > reach => (s..=FAR).map(weight).sum(),
            s if s < -reach => (-FAR..=s).map(weight).sum(),
            s => weight(s),
        })
        .map(|w: f64| 1 + (w / total * spare) as u32)
        .collect();
    counts[reach as usize + 1] += (1 << PROB_BITS) - counts.iter().sum::<u32>();
    let mut start = 0;
    let counts: Vec<(u32, u32)> = counts
        .iter()
        .map(|&n| {
            start += n;
            (start - n, n)
        })
        .collect();
    let cost = Box::new(std::array::from_fn(|i| {
        let symbol = i as i32 - SPAN_REACH;
        let (_, n) = counts[(symbol.clamp(-reach - 1, reach + 1) + reach + 1) as usize];
        let excess = symbol.abs() - reach;
        let escape = if excess > 0 { 2.0 * (excess as f32).log2() + 1.0 } else { 0.0 };
        PROB_BITS as f32 - (n as f32).log2() + escape
    }));
    let span = |symbol: i32| {
        let (start, n) = counts[(symbol.clamp(-reach - 1, reach + 1) + reach + 1) as usize];
        Span::new(start, n)
    };
    // indexed by the symbol as a byte, so padded to all bytes
    let spans = Box::new(std::array::from_fn(|i| span(i as i32 - SPAN_REACH)));
    Frequencies { reach, counts, spans, cost }
}

/// exp(-t) for t ≥ 0 by Taylor's series and squaring.
fn negative_exp(t: f64) -> f64 {
    if t > 80.0 {
        return 0.0;
    }
    let y = t / 1024.0;
    let mut e = 1.0 - y * (1.0 - y / 2.0 * (1.0 - y / 3.0 * (1.0 - y / 4.0 * (1.0 - y / 5.0))));
    for _ in 0..10 {
        e *= e;
    }
    e
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_table_fills_its_slots() {
        assert_eq!(FAMILY.slots.len(), FAMILY.frequencies.len() << PROB_BITS);
        for table in &FAMILY.frequencies {
            assert!(table.reach <= MAX_SYMBOL && table.reach >= 1);
            assert_eq!(table.counts.last().map(|&(s, n)| s + n), Some(1 << PROB_BITS));
        }
    }

    #[test]
    fn the_tables_are_the_documented_ones() {
        // docs/format.md gives this checksum so that another reader can check its tables
        let bytes: Vec<u8> = FAMILY.slots.iter().flat_map(|s| s.to_le_bytes()).collect();
        assert_eq!(crc32fast::hash(&bytes), TABLES_CRC32);
    }

    const TABLES_CRC32: u32 = 3_083_099_529;

    #[test]
    fn members_split_and_join_any_residual() {
        for scale in 0..SCALES {
            let member = Member::new(scale, 1);
            for r in [0, 1, -1, 2, 77, -78, 65_535, -65_536, i32::MAX, i32::MIN, 123_456_789] {
                let symbol = Member::symbol(r, member.plain_bits);
                assert_eq!(member.join(symbol, member.plain(r)), r, "scale {scale}");
            }
        }
    }
}
