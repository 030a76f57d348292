//! Heights of a page's new points to bytes and back.
//!
//! Layout: presets byte (bit 0: 64-bit arithmetic; then two bits a kind), the page's base height (signed varint), the
//! length of the plain bits (varint), the plain bits, the range coder's bytes. The plain bits begin with the
//! distributions: per kind the first and the number of the contexts used (6 bits each), and for each of these one bit;
//! when it is set, 6 bits of scale (less 32, over the context's usual one) and 2 of shape follow, else the usual ones hold.

use super::bits::{BitReader, BitWriter, put_varint, take, take_varint, unzigzag, zigzag};
use super::family::{ESCAPE, FAMILY, Member, SCALES, SHAPES, nearest_scale};
use super::model::{CONTEXTS, Extent, Height, KINDS, PRESETS, Planes, default_scale};
use super::rans::{Decoder, Encoder};

/// Shape of the distribution of a context that names none.
const USUAL_SHAPE: usize = 1;
/// Symbols and histograms reach this far; what lies beyond counts as this.
const HALF: i32 = ESCAPE;

/// One kind of a page, coded but for its bytes.
struct Coded {
    columns: usize,
    residuals: Vec<i32>,
    contexts: Vec<u8>,
    symbols: Vec<i8>,
    members: [Member; CONTEXTS],
}

impl Coded {
    fn new(columns: usize, rows: usize) -> Self {
        let count = columns * rows;
        let members = [Member::new(0, USUAL_SHAPE); CONTEXTS];
        Self { columns, residuals: vec![0; count], contexts: vec![0; count], symbols: vec![0; count], members }
    }

    /// Chooses a distribution for every context, writes the choice, and turns residuals into symbols.
    fn choose_members(&mut self, bits: &mut BitWriter) {
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
    fn put_plain(&self, bits: &mut BitWriter) {
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

    fn put_symbols(&self, encoder: &mut Encoder) {
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

/// Codes the new points of `planes`, all of whose heights are set (relative to `base`).
pub(super) fn encode<T: Height>(planes: &mut Planes<T>, extent: Extent, base: i32, wide: bool) -> Vec<u8> {
    let mut presets = u8::from(wide);
    let mut coded = residuals(planes, extent, &mut presets);
    let mut bits = BitWriter::default();
    let mut encoder = Encoder::new();
    for kind in &mut coded {
        kind.choose_members(&mut bits);
    }
    for kind in &coded {
        kind.put_plain(&mut bits);
    }
    for kind in coded.iter().rev() {
        kind.put_symbols(&mut encoder);
    }
    let plain = bits.finish();
    let mut out = vec![presets];
    put_varint(&mut out, zigzag(i64::from(base)));
    put_varint(&mut out, plain.len() as u64);
    out.extend(plain);
    out.extend(encoder.finish());
    out
}

/// Residuals and contexts of all kinds; adds the presets they were foretold with.
fn residuals<T: Height>(planes: &mut Planes<T>, extent: Extent, presets: &mut u8) -> [Coded; 3] {
    #[cfg(target_arch = "x86_64")]
    if super::has_avx2() {
        // SAFETY: the processor has the instructions, as just asked.
        return unsafe { residuals_avx2(planes, extent, presets) };
    }
    residuals_body(planes, extent, presets)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2")]
fn residuals_avx2<T: Height>(planes: &mut Planes<T>, extent: Extent, presets: &mut u8) -> [Coded; 3] {
    residuals_body(planes, extent, presets)
}

#[inline(always)]
fn residuals_body<T: Height>(planes: &mut Planes<T>, extent: Extent, presets: &mut u8) -> [Coded; 3] {
    planes.e.fill_margin();
    let mut out = KINDS.map(|kind| {
        let [columns, rows] = extent.coded(kind);
        Coded::new(columns, rows)
    });
    let mut prediction = [T::default(); ROW];
    for (kind, coded) in KINDS.into_iter().zip(&mut out) {
        let [columns, rows] = extent.coded(kind);
        let prediction = &mut prediction[..columns];
        // the preset with the smallest residuals on every eighth row
        let mut sums = [0u64; PRESETS];
        for y in (rows.min(4) / 2..rows).step_by(8) {
            for (preset, sum) in sums.iter_mut().enumerate() {
                planes.predict_row(kind, preset, y, prediction);
                let mut row_sum = 0;
                for (&p, &z) in prediction.iter().zip(planes.plane(kind).row(y)) {
                    row_sum += z.minus(p).size() as u32;
                }
                *sum += u64::from(row_sum);
            }
        }
        let preset = (0..PRESETS).min_by_key(|&p| sums[p]).unwrap_or(0);
        *presets |= (preset as u8) << (1 + 2 * kind as u32);
        for y in 0..rows {
            let values = &mut coded.residuals[y * columns..][..columns];
            planes.context_row(kind, y, &mut coded.contexts[y * columns..][..columns]);
            planes.predict_row(kind, preset, y, prediction);
            for ((value, &p), &z) in values.iter_mut().zip(&*prediction).zip(planes.plane(kind).row(y)) {
                *value = z.minus(p).low32();
            }
            planes.set_sizes(kind, y, values);
        }
        planes.complete(kind);
    }
    out
}

/// Reads the base height and the arithmetic: what the even points must be made relative to before [`decode`].
pub(super) fn decode_head(bytes: &mut &[u8]) -> Option<(u8, i32)> {
    let (&presets, rest) = bytes.split_first()?;
    *bytes = rest;
    let base = i32::try_from(unzigzag(take_varint(bytes)?)).ok()?;
    (presets >> 7 == 0).then_some((presets, base))
}

/// Sets the new points of `planes`, whose even ones are set; `None` when the bytes are no page's.
pub(super) fn decode<T: Height>(planes: &mut Planes<T>, extent: Extent, presets: u8, bytes: &[u8]) -> Option<()> {
    #[cfg(target_arch = "x86_64")]
    if super::has_avx2() {
        // SAFETY: the processor has the instructions, as just asked.
        return unsafe { decode_avx2(planes, extent, presets, bytes) };
    }
    decode_body(planes, extent, presets, bytes)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2")]
fn decode_avx2<T: Height>(planes: &mut Planes<T>, extent: Extent, presets: u8, bytes: &[u8]) -> Option<()> {
    decode_body(planes, extent, presets, bytes)
}

#[inline(always)]
fn decode_body<T: Height>(planes: &mut Planes<T>, extent: Extent, presets: u8, mut bytes: &[u8]) -> Option<()> {
    let length = usize::try_from(take_varint(&mut bytes)?).ok()?;
    let plain = take(&mut bytes, length)?;
    let mut bits = BitReader::new(plain);
    let mut members = [[Member::new(0, USUAL_SHAPE); CONTEXTS]; 3];
    for kind_members in &mut members {
        read_members(&mut bits, kind_members)?;
    }
    let family = &*FAMILY;
    let mut decoder = Decoder::new(bytes)?;
    planes.e.fill_margin();
    for (kind, members) in KINDS.into_iter().zip(&members) {
        let begins: [u32; 64] = std::array::from_fn(|c| members[c.min(CONTEXTS - 1)].begin());
        let any_plain = members.iter().any(|m| m.plain_bits > 0);
        let preset = usize::from(presets >> (1 + 2 * kind as u32) & 3);
        let [columns, rows] = extent.coded(kind);
        // a row has at most 129 new points of a kind
        let (mut prediction, mut contexts) = ([T::default(); ROW], [0u8; ROW]);
        let (mut symbols, mut values) = ([0i8; ROW], [0i32; ROW]);
        let prediction = prediction.get_mut(..columns)?;
        let (contexts, symbols) = (contexts.get_mut(..columns)?, symbols.get_mut(..columns)?);
        let values = values.get_mut(..columns)?;
        for y in 0..rows {
            planes.context_row(kind, y, contexts);
            decoder.row(contexts, &begins, &family.slots, symbols);
            // ±64 are the only symbols whose low seven bits are 64 or so: the escapes
            let escapes = symbols.iter().fold(false, |any, s| any | (s.wrapping_add(ESCAPE as i8) & 0x7F == 0));
            if escapes || any_plain {
                for ((value, &symbol), &c) in values.iter_mut().zip(&*symbols).zip(&*contexts) {
                    let member = members[usize::from(c).min(CONTEXTS - 1)];
                    let mut whole = i64::from(symbol);
                    if i32::from(symbol).abs() == ESCAPE {
                        let reach = i64::from(family.frequencies[member.table].reach);
                        whole = i64::from(symbol.signum()) * (reach + 1 + i64::from(bits.get_gamma()));
                    }
                    *value = member.join(whole, bits.get(member.plain_bits));
                }
            } else {
                for (value, &symbol) in values.iter_mut().zip(&*symbols) {
                    *value = i32::from(symbol);
                }
            }
            planes.predict_row(kind, preset, y, prediction);
            let plane = planes.plane_mut(kind);
            for ((z, &p), &r) in plane.row_mut(y).iter_mut().zip(&*prediction).zip(&*values) {
                *z = T::of(p.plus(T::of(r)).low32());
            }
            planes.set_sizes(kind, y, values);
        }
        planes.repeat(extent, kind);
        planes.complete(kind);
    }
    (decoder.is_exhausted() && bits.is_exhausted()).then_some(())
}

/// Room for a row of one kind.
const ROW: usize = 132;

fn read_members(bits: &mut BitReader<'_>, members: &mut [Member; CONTEXTS]) -> Option<()> {
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
