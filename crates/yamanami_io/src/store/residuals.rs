//! Residuals to symbols of the distributions in [`super::family`], and back: what heights and vertices share.
//!
//! The plain bits begin with the distributions: the first and the number of the contexts used (6 bits each), and for each
//! of these one bit; when it is set, 6 bits of scale (less 32, over the context's usual one) and 2 of shape follow, else
//! the usual ones hold.

use super::bits::{BitReader, BitWriter};
use super::family::{ESCAPE, FAMILY, Member, SCALES, SHAPES, nearest_scale};
use super::model::{CONTEXTS, default_scale};
use super::rans::Encoder;

/// Shape of the distribution of a context that names none.
pub(super) const USUAL_SHAPE: usize = 1;
/// Symbols and histograms reach this far; what lies beyond counts as this.
const HALF: i32 = ESCAPE;

/// Residuals with their contexts, coded but for their bytes.
pub(super) struct Coded {
    columns: usize,
    pub(super) residuals: Vec<i32>,
    pub(super) contexts: Vec<u8>,
    symbols: Vec<i8>,
    members: [Member; CONTEXTS],
}

impl Coded {
    pub(super) fn new(columns: usize, rows: usize) -> Self {
        let count = columns * rows;
        let members = [Member::new(0, USUAL_SHAPE); CONTEXTS];
        Self { columns, residuals: vec![0; count], contexts: vec![0; count], symbols: vec![0; count], members }
    }

    /// All that was gathered, as one row.
    pub(super) fn in_one_row(self) -> Self {
        let count = self.residuals.len();
        Self { columns: count, symbols: vec![0; count], ..self }
    }

    /// Chooses a distribution for every context, writes the choice, and turns residuals into symbols.
    pub(super) fn choose_members(&mut self, bits: &mut BitWriter) {
        let mut counts = [0u32; CONTEXTS];
        let mut sums = [0u64; CONTEXTS];
        for (&r, &c) in self.residuals.iter().zip(&self.contexts) {
            let c = usize::from(c).min(CONTEXTS - 1);
            counts[c] += 1;
            sums[c] += u64::from(r.unsigned_abs());
        }
        // a mean tells the scale to within a step or two, and how many bits go plain
        let scales: [u32; CONTEXTS] = std::array::from_fn(|c| {
            let usual = default_scale(c);
            let nearest = if counts[c] == 0 { usual } else { nearest_scale(sums[c] as f32 / counts[c] as f32) };
            nearest.clamp(usual.saturating_sub(32), (usual + 31).min(SCALES - 1))
        });
        let plain: [u32; CONTEXTS] = scales.map(|scale| Member::new(scale, 0).plain_bits);
        let mut histograms = vec![[0u32; 2 * HALF as usize + 1]; CONTEXTS];
        for ((&r, &c), symbol) in self.residuals.iter().zip(&self.contexts).zip(&mut self.symbols) {
            let c = usize::from(c).min(CONTEXTS - 1);
            let clamped = Member::symbol(r, plain[c]).clamp(-i64::from(HALF), i64::from(HALF));
            *symbol = clamped as i8;
            histograms[c][(clamped as i32 + HALF) as usize] += 1;
        }
        let first = counts.iter().position(|&n| n > 0).unwrap_or(0);
        let end = counts.iter().rposition(|&n| n > 0).map_or(first, |c| c + 1);
        bits.put(first as u32, 6);
        bits.put((end - first) as u32, 6);
        for c in first..end {
            let choice = choose(c, scales[c], counts[c], &histograms[c]);
            bits.put(u32::from(choice.is_some()), 1);
            if let Some((scale, shape)) = choice {
                bits.put(scale + 32 - default_scale(c), 6);
                bits.put(shape as u32, 2);
            }
            let (scale, shape) = choice.unwrap_or((default_scale(c), USUAL_SHAPE));
            self.members[c] = Member::new(scale, shape);
        }
    }

    /// Writes what the symbols leave: the rest of the escaped ones, and low bits.
    pub(super) fn put_plain(&self, bits: &mut BitWriter) {
        let family = &*FAMILY;
        let any_plain = self.members.iter().any(|m| m.plain_bits > 0);
        let least_reach = self.members.iter().map(|m| family.frequencies[m.table].reach).min().unwrap_or(0);
        let greatest = self.symbols.iter().fold(0, |greatest, s| s.unsigned_abs().max(greatest));
        if !any_plain && i32::from(greatest) <= least_reach {
            return;
        }
        for ((&residual, &context), &symbol) in self.residuals.iter().zip(&self.contexts).zip(&self.symbols) {
            let member = self.members[usize::from(context)];
            let frequencies = &family.frequencies[member.table];
            if frequencies.escapes(symbol) {
                let size = Member::symbol(residual, member.plain_bits).unsigned_abs();
                bits.put_gamma((size - frequencies.reach as u64 - 1) as u32);
            }
            if member.plain_bits > 0 {
                bits.put(member.plain(residual), member.plain_bits);
            }
        }
    }

    pub(super) fn put_symbols(&self, encoder: &mut Encoder) {
        let family = &*FAMILY;
        let tables = self.members.map(|m| &family.frequencies[m.table]);
        if self.columns == 0 {
            return;
        }
        let rows = self.symbols.chunks_exact(self.columns).zip(self.contexts.chunks_exact(self.columns));
        for (symbols, contexts) in rows.rev() {
            encoder.row(symbols.len(), |x| tables[usize::from(contexts[x])].span(symbols[x]));
        }
    }
}

/// The cheapest distribution for a context's histogram; `None` for the usual one.
fn choose(context: usize, scale: u32, count: u32, histogram: &[u32]) -> Option<(u32, usize)> {
    let family = &*FAMILY;
    let plain_bits = Member::new(scale, 0).plain_bits;
    let first = histogram.iter().position(|&n| n > 0).unwrap_or(0);
    let last = histogram.iter().rposition(|&n| n > 0).unwrap_or(first);
    let cost = |scale: u32, shape: usize| -> f32 {
        let table = &family.frequencies[Member::new(scale, shape).table];
        let symbols = table.costs()[first..=last].iter().zip(&histogram[first..=last]);
        symbols.map(|(cost, &n)| n as f32 * cost).sum::<f32>() + (plain_bits * count) as f32
    };
    let usual = default_scale(context);
    let same = |s: u32| Member::new(s, 0).plain_bits == plain_bits;
    // what naming a distribution costs
    let mut least = if same(usual) { cost(usual, USUAL_SHAPE) - 8.0 } else { f32::INFINITY };
    let mut best = None;
    let (low, high) = (usual.saturating_sub(32), (usual + 31).min(SCALES - 1));
    // tails shift the best scale of a shape away from the mean's; costs have one valley
    for shape in 0..SHAPES {
        let mut at = scale;
        let mut lowest = cost(at, shape);
        for step in [-1i64, 1] {
            while let Some(next) =
                u32::try_from(i64::from(at) + step).ok().filter(|&s| (low..=high).contains(&s) && same(s))
            {
                let bits = cost(next, shape);
                if bits >= lowest {
                    break;
                }
                (at, lowest) = (next, bits);
            }
        }
        if lowest < least {
            (best, least) = (Some((at, shape)), lowest);
        }
    }
    best
}

/// Undoes [`Coded::choose_members`].
pub(super) fn read_members(bits: &mut BitReader<'_>, members: &mut [Member; CONTEXTS]) -> Option<()> {
    let first = bits.get(6) as usize;
    let count = bits.get(6) as usize;
    let used = members.get_mut(first..first + count)?;
    for (c, member) in (first..).zip(used) {
        *member = if bits.get(1) == 1 {
            let scale = (default_scale(c) + bits.get(6)).checked_sub(32).filter(|&s| s < SCALES)?;
            Member::new(scale, bits.get(2) as usize)
        } else {
            Member::new(default_scale(c), USUAL_SHAPE)
        };
    }
    Some(())
}

/// The residuals of a row's symbols, whose plain bits come next in `bits`.
#[inline(always)]
pub(super) fn join_row(
    symbols: &[i8],
    contexts: &[u8],
    members: &[Member; CONTEXTS],
    any_plain: bool,
    bits: &mut BitReader<'_>,
    values: &mut [i32],
) {
    // ±64 are the only symbols whose low seven bits are 64 or so: the escapes
    let escapes = symbols.iter().fold(false, |any, s| any | (s.wrapping_add(ESCAPE as i8) & 0x7F == 0));
    if escapes || any_plain {
        for ((value, &symbol), &c) in values.iter_mut().zip(symbols).zip(contexts) {
            let member = members[usize::from(c).min(CONTEXTS - 1)];
            let mut whole = i64::from(symbol);
            if i32::from(symbol).abs() == ESCAPE {
                let reach = i64::from(FAMILY.frequencies[member.table].reach);
                whole = i64::from(symbol.signum()) * (reach + 1 + i64::from(bits.get_gamma()));
            }
            *value = member.join(whole, bits.get(member.plain_bits));
        }
    } else {
        for (value, &symbol) in values.iter_mut().zip(symbols) {
            *value = i32::from(symbol);
        }
    }
}
