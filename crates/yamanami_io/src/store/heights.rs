//! Heights of a page's new points to bytes and back.
//!
//! Layout: presets byte (bit 0: 64-bit arithmetic; then two bits a kind), the page's base height (signed varint), the
//! length of the plain bits (varint), the plain bits, the range coder's bytes. The plain bits begin with the
//! distributions of each kind.

use super::bits::{BitReader, BitWriter, put_varint, take, take_varint, unzigzag, zigzag};
use super::family::{FAMILY, Member};
use super::model::{CONTEXTS, Extent, Height, KINDS, PRESETS, Planes};
use super::rans::{Decoder, Encoder};
use super::residuals::{Coded, USUAL_SHAPE, join_row, read_members};

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
            join_row(symbols, contexts, members, any_plain, &mut bits, values);
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
