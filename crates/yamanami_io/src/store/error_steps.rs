//! Error codes of a page above level 0 to bytes and back.
//!
//! Codes are rounded up to a few steps an octave (the same for all levels, so that a parent's stays at least its child's),
//! and each is foretold from the bend of the ground and the neighbours coded before: D points first, then H, then V.

use super::bits::{BitReader, BitWriter, put_varint, take, take_varint};
use super::errors::{Ground, ROW, Steps, derive_rows};
use super::family::{ERROR_SCALES, ERROR_SHAPES, ESCAPE, FAMILY, error_table, table_begin};
use super::model::Plane;
use super::rans::{Decoder, Encoder};
use yamanami_core::ErrorCode;

/// Contexts of a kind: eight degrees of disagreement, and whether the expected value is near a whole step.
const CONTEXTS: usize = 16;
/// Scale and shape that a context has unless it names others.
const USUAL_SHAPE: usize = 1;

/// Steps of one kind's details and of its codes as far as they are known, each with a margin.
#[derive(Debug, Default)]
struct Kind {
    /// Column and row of the first point, 0 or 1.
    first: [usize; 2],
    columns: usize,
    rows: usize,
    details: Plane<i32>,
    known: Plane<i32>,
}

/// What is known of a page's codes while they are coded: D points first, then H, then V.
#[derive(Debug)]
struct Kinds {
    kinds: [Kind; 3],
    octave: i32,
}

const D: usize = 0;
const H: usize = 1;
const V: usize = 2;

impl Kinds {
    #[inline(always)]
    fn new(ground: Ground<'_>, steps: Steps) -> Self {
        let mut codes = vec![ErrorCode(0); ground.width * ground.height];
        derive_rows(ground, 0.0, &mut codes);
        let mut kinds: [Kind; 3] = Default::default();
        for (kind, first) in kinds.iter_mut().zip([[1, 1], [1, 0], [0, 1]]) {
            kind.first = first;
            kind.columns = (ground.width - first[0]).div_ceil(2);
            kind.rows = (ground.height - first[1]).div_ceil(2);
            kind.details.reset(kind.columns, kind.rows);
            kind.known.reset(kind.columns, kind.rows);
            for y in 0..kind.rows {
                let row = &codes[(2 * y + first[1]) * ground.width + first[0]..];
                for (step, &code) in kind.details.row_mut(y).iter_mut().zip(row.iter().step_by(2)) {
                    *step = steps.step(code);
                }
            }
            if kind.columns > 0 && kind.rows > 0 {
                kind.details.repeat_margin();
            }
        }
        Self { kinds, octave: steps.per_octave as i32 }
    }

    /// What is foretold of row `y` of a kind.
    #[inline(always)]
    fn expect_row(&self, kind: usize, y: usize, out: &mut Row) {
        let [d, h, v] = &self.kinds;
        let n = self.kinds[kind].columns;
        let top = y == 0;
        let y = y as isize;
        let octave = self.octave;
        // slices cut to length so that the loops need no bounds checks; planes have margins
        let own = &self.kinds[kind].details.padded_row(y)[1..n + 1];
        let mut greatest = [0i32; ROW];
        let greatest = &mut greatest[..n + 2];
        let above = &self.kinds[kind].known.padded_row(y - 1)[..n + 2];
        let (expected, apart) = (&mut out.steps[..n], &mut out.signs[..n]);
        let distance = |p: i32, s: i32| (p - 64 * s).abs();
        match kind {
            D => {
                let (h0, h1) = (&h.details.padded_row(y)[1..n + 1], &h.details.padded_row(y + 1)[1..n + 1]);
                let v0 = &v.details.padded_row(y)[1..n + 2];
                for x in 0..n {
                    greatest[x + 1] = own[x].max(h0[x]).max(h1[x]).max(v0[x]).max(v0[x + 1]);
                }
                let greatest = with_ends(greatest);
                let up = if top { greatest } else { above };
                for x in 0..n {
                    let (great, sides) = (greatest[x + 1], up[x] + up[x + 2]);
                    let p = 3 * own[x] + 37 * great + 8 * up[x + 1] + 8 * sides + 10 * octave;
                    apart[x] = 2 * distance(p, great) + distance(p, up[x + 1]) + distance(2 * p, sides) / 2;
                    expected[x] = p;
                }
            }
            H => {
                let (d0, d1) = (&d.details.padded_row(y - 1)[1..n + 1], &d.details.padded_row(y)[1..n + 1]);
                let (k0, k1) = (&d.known.padded_row(y - 1)[1..n + 1], &d.known.padded_row(y)[1..n + 1]);
                for x in 0..n {
                    greatest[x + 1] = own[x].max(d0[x]).max(d1[x]);
                }
                let greatest = with_ends(greatest);
                let up = if top { greatest } else { above };
                for x in 0..n {
                    let (great, sides) = (greatest[x + 1], up[x] + up[x + 2]);
                    let (low, high) = (k0[x].min(k1[x]), k0[x].max(k1[x]));
                    let p = 2 * own[x] + 6 * up[x + 1] + 5 * sides + 27 * high + 19 * low - 8 * octave;
                    apart[x] = distance(p, up[x + 1]) + distance(p, great) + distance(p, low) + distance(p, high);
                    expected[x] = p;
                }
            }
            _ => {
                let (d0, k0) = (&d.details.padded_row(y)[..n + 1], &d.known.padded_row(y)[..n + 1]);
                let (h0, h1) = (&h.known.padded_row(y)[..n + 1], &h.known.padded_row(y + 1)[..n + 1]);
                for x in 0..n {
                    greatest[x + 1] = own[x].max(d0[x]).max(d0[x + 1]);
                }
                let greatest = with_ends(greatest);
                let up = if top { greatest } else { above };
                for x in 0..n {
                    let (great, sides) = (greatest[x + 1], up[x] + up[x + 2]);
                    let (low, high) = (k0[x].min(k0[x + 1]), k0[x].max(k0[x + 1]));
                    let far = h0[x] + h0[x + 1] + h1[x] + h1[x + 1];
                    let p = 2 * own[x] + 2 * great + up[x + 1] + sides + 17 * high + 14 * low + 13 * far / 2 + octave;
                    apart[x] = distance(p, great) + distance(p, low) + distance(p, high) + distance(4 * p, far) / 4;
                    expected[x] = p;
                }
            }
        }
        let shift = 7 + octave.ilog2();
        let contexts = &mut out.contexts[..n];
        for x in 0..n {
            let p = expected[x] + 32;
            let third = ((p & 63) * 3) >> 6;
            let degree = (apart[x] >> shift).min(7);
            contexts[x] = (2 * degree + i32::from(third != 1)) as u8;
            expected[x] = p >> 6;
            apart[x] = if third == 0 { -1 } else { 1 };
        }
    }

    /// To be called before the next kind is foretold.
    fn complete(&mut self, kind: usize) {
        let kind = &mut self.kinds[kind];
        if kind.columns > 0 && kind.rows > 0 {
            kind.known.repeat_margin();
        }
    }
}

/// Fills the margin of a row.
#[inline(always)]
fn with_ends(row: &mut [i32]) -> &[i32] {
    let n = row.len() - 2;
    if n > 0 {
        row[0] = row[1];
        row[n + 1] = row[n];
    }
    row
}

/// What is foretold of a row's codes: the step, which way differences count, and the context.
#[derive(Debug)]
struct Row {
    steps: [i32; ROW],
    signs: [i32; ROW],
    contexts: [u8; ROW],
}

impl Row {
    fn new() -> Self {
        Self { steps: [0; ROW], signs: [1; ROW], contexts: [0; ROW] }
    }
}

/// The scale a context has unless it names another.
fn usual_scale(context: usize) -> usize {
    2 + context / 4
}

/// Differences of one kind with their contexts.
struct Coded {
    columns: usize,
    differences: Vec<i32>,
    contexts: Vec<u8>,
}

/// Rounds a page's codes up to steps and codes these: length of the plain bits, plain bits, range coder's bytes. The plain
/// bits begin with the distributions: per kind and context one bit, followed by 4 bits of scale and 2 of shape when it is set.
pub(super) fn encode(ground: Ground<'_>, steps: Steps, errors: &[ErrorCode]) -> Vec<u8> {
    #[cfg(target_arch = "x86_64")]
    if super::has_avx2() {
        // SAFETY: the processor has the instructions, as just asked.
        return unsafe { encode_avx2(ground, steps, errors) };
    }
    encode_body(ground, steps, errors)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2")]
fn encode_avx2(ground: Ground<'_>, steps: Steps, errors: &[ErrorCode]) -> Vec<u8> {
    encode_body(ground, steps, errors)
}

#[inline(always)]
fn encode_body(ground: Ground<'_>, steps: Steps, errors: &[ErrorCode]) -> Vec<u8> {
    let mut kinds = Kinds::new(ground, steps);
    let mut row = Row::new();
    let mut bits = BitWriter::default();
    let mut coded = Vec::new();
    for kind in [D, H, V] {
        let Kind { first, columns, rows, .. } = kinds.kinds[kind];
        let mut out = Coded { columns, differences: Vec::new(), contexts: Vec::new() };
        for y in 0..rows {
            kinds.expect_row(kind, y, &mut row);
            let codes = errors[(2 * y + first[1]) * ground.width + first[0]..].iter().step_by(2);
            for (known, &code) in kinds.kinds[kind].known.row_mut(y).iter_mut().zip(codes) {
                *known = steps.step(code);
            }
            let known = kinds.kinds[kind].known.row(y);
            let expected = row.steps.iter().zip(&row.signs);
            out.differences.extend(known.iter().zip(expected).map(|(k, (e, sign))| (k - e) * sign));
            out.contexts.extend_from_slice(&row.contexts[..columns]);
        }
        kinds.complete(kind);
        let tables = choose_tables(&out, &mut bits);
        coded.push((out, tables));
    }
    for (kind, tables) in &coded {
        let greatest = kind.differences.iter().fold(0, |greatest, d| d.abs().max(greatest));
        let least_reach = tables.iter().map(|&t| FAMILY.frequencies[t].reach).min().unwrap_or(0);
        if greatest <= least_reach {
            continue;
        }
        for (&difference, &context) in kind.differences.iter().zip(&kind.contexts) {
            let reach = FAMILY.frequencies[tables[usize::from(context)]].reach;
            if difference.abs() > reach {
                bits.put_gamma((difference.abs() - reach - 1) as u32);
            }
        }
    }
    let mut encoder = Encoder::new();
    for (kind, tables) in coded.iter().rev().filter(|(kind, _)| kind.columns > 0) {
        let frequencies = tables.map(|t| &FAMILY.frequencies[t]);
        let rows = kind.differences.chunks_exact(kind.columns).zip(kind.contexts.chunks_exact(kind.columns));
        for (differences, contexts) in rows.rev() {
            encoder.row(differences.len(), |x| {
                frequencies[usize::from(contexts[x])].span(differences[x].clamp(-ESCAPE, ESCAPE) as i8)
            });
        }
    }
    let plain = bits.finish();
    let mut out = Vec::new();
    put_varint(&mut out, plain.len() as u64);
    out.extend(plain);
    out.extend(encoder.finish());
    out
}

fn table(context: usize, choice: Option<(usize, usize)>) -> usize {
    let (scale, shape) = choice.unwrap_or((usual_scale(context), USUAL_SHAPE));
    error_table(scale, shape, context % 2 == 1)
}

fn choose_tables(coded: &Coded, bits: &mut BitWriter) -> [usize; CONTEXTS] {
    const HALF: i32 = 64;
    let mut histograms = [[0u32; 2 * HALF as usize + 1]; CONTEXTS];
    for (&difference, &context) in coded.differences.iter().zip(&coded.contexts) {
        histograms[usize::from(context)][(difference.clamp(-HALF, HALF) + HALF) as usize] += 1;
    }
    std::array::from_fn(|c| {
        let first = histograms[c].iter().position(|&n| n > 0).unwrap_or(0);
        let last = histograms[c].iter().rposition(|&n| n > 0).unwrap_or(first);
        let cost = |choice: Option<(usize, usize)>| -> f32 {
            let table = &FAMILY.frequencies[table(c, choice)];
            let symbols = table.costs()[first..=last].iter().zip(&histograms[c][first..=last]);
            symbols.map(|(cost, &n)| n as f32 * cost).sum()
        };
        let (mut best, mut least) = (None, cost(None) - 6.0);
        for choice in (0..ERROR_SCALES).flat_map(|scale| (0..ERROR_SHAPES).map(move |shape| (scale, shape))) {
            let bits = cost(Some(choice));
            if bits < least {
                (best, least) = (Some(choice), bits);
            }
        }
        bits.put(u32::from(best.is_some()), 1);
        if let Some((scale, shape)) = best {
            bits.put(scale as u32, 4);
            bits.put(shape as u32, 2);
        }
        table(c, best)
    })
}

/// Undoes [`encode`]; `None` when the bytes are no page's.
pub(super) fn decode(ground: Ground<'_>, steps: Steps, bytes: &[u8]) -> Option<Vec<ErrorCode>> {
    #[cfg(target_arch = "x86_64")]
    if super::has_avx2() {
        // SAFETY: the processor has the instructions, as just asked.
        return unsafe { decode_avx2(ground, steps, bytes) };
    }
    decode_body(ground, steps, bytes)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2")]
fn decode_avx2(ground: Ground<'_>, steps: Steps, bytes: &[u8]) -> Option<Vec<ErrorCode>> {
    decode_body(ground, steps, bytes)
}

#[inline(always)]
fn decode_body(ground: Ground<'_>, steps: Steps, mut bytes: &[u8]) -> Option<Vec<ErrorCode>> {
    let mut kinds = Kinds::new(ground, steps);
    let length = usize::try_from(take_varint(&mut bytes)?).ok()?;
    let mut bits = BitReader::new(take(&mut bytes, length)?);
    let mut tables = [[0usize; CONTEXTS]; 3];
    for kind_tables in &mut tables {
        for (c, chosen) in kind_tables.iter_mut().enumerate() {
            let choice = (bits.get(1) == 1).then(|| (bits.get(4) as usize, bits.get(2) as usize));
            if choice.is_some_and(|(scale, shape)| scale >= ERROR_SCALES || shape >= ERROR_SHAPES) {
                return None;
            }
            *chosen = table(c, choice);
        }
    }
    let family = &*FAMILY;
    let mut decoder = Decoder::new(bytes)?;
    let mut row = Row::new();
    let mut symbols = [0i8; ROW];
    let mut errors = vec![ErrorCode(0); ground.width * ground.height];
    let last = steps.last();
    for (kind, tables) in [D, H, V].into_iter().zip(&tables) {
        let begins = std::array::from_fn(|c| table_begin(tables[c % CONTEXTS]));
        let Kind { first, columns, rows, .. } = kinds.kinds[kind];
        let symbols = &mut symbols[..columns];
        for y in 0..rows {
            kinds.expect_row(kind, y, &mut row);
            decoder.row(&row.contexts[..columns], &begins, &family.slots, symbols);
            let known = kinds.kinds[kind].known.row_mut(y);
            let (mut least, mut greatest, mut escapes) = (0, 0, false);
            for (x, (step, &symbol)) in known.iter_mut().zip(&*symbols).enumerate() {
                *step = row.steps[x] + row.signs[x] * i32::from(symbol);
                (least, greatest) = (least.min(*step), greatest.max(*step));
                escapes |= symbol.wrapping_add(ESCAPE as i8) & 0x7F == 0;
            }
            if escapes {
                (least, greatest) = (0, 0);
                for (x, (step, &symbol)) in known.iter_mut().zip(&*symbols).enumerate() {
                    if i32::from(symbol).abs() == ESCAPE {
                        let reach = family.frequencies[tables[usize::from(row.contexts[x]) % CONTEXTS]].reach;
                        let excess = i32::try_from(bits.get_gamma()).ok().filter(|e| *e < 1 << 20)?;
                        *step = row.steps[x] + row.signs[x] * i32::from(symbol.signum()) * (reach + 1 + excess);
                    }
                    (least, greatest) = (least.min(*step), greatest.max(*step));
                }
            }
            if least < 0 || greatest > last {
                return None;
            }
            let out = errors[(2 * y + first[1]) * ground.width + first[0]..].iter_mut().step_by(2);
            for (error, &step) in out.zip(&*known) {
                *error = steps.code(step);
            }
        }
        kinds.complete(kind);
    }
    (decoder.is_exhausted() && bits.is_exhausted()).then_some(errors)
}
