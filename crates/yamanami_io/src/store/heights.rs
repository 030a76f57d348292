//! Heights of a page's new points to bytes and back.
//!
//! Layout: presets byte (bit 0: 64-bit arithmetic; then two bits a kind), the page's base height (signed varint), the
//! length of the plain bits (varint), the plain bits, the range coder's bytes. The plain bits begin with the
//! distributions: per kind the first and the number of the contexts used (6 bits each), and for each of these one bit; when it is set,
//! 6 bits of scale (less 32, over the context's usual one) and 2 of shape follow, else the usual ones hold.

use super::bits::{BitReader, BitWriter, put_varint, take_varint, unzigzag, zigzag};
use super::family::{ESCAPE, FAMILY, Member, SCALES, SHAPES, nearest_scale};
use super::model::{CONTEXTS, Height, KINDS, Kind, PRESETS, Planes, default_scale};
use super::rans::{Decoder, Encoder, LANES};

/// Shape of the distribution of a context that names none.
const USUAL_SHAPE: usize = 1;

/// What part of the planes is coded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Extent {
    /// Squares of the coarser page covered.
    pub(super) nx: usize,
    pub(super) ny: usize,
    /// Whether the last H and D column repeats the last even one (the grid ends between lattice columns).
    pub(super) repeats_column: bool,
    /// The same for the last V and D row.
    pub(super) repeats_row: bool,
}

impl Extent {
    /// Of a page `width` × `height` points large.
    pub(super) fn of(width: u32, height: u32) -> Self {
        Self {
            nx: (width / 2) as usize,
            ny: (height / 2) as usize,
            repeats_column: width.is_multiple_of(2),
            repeats_row: height.is_multiple_of(2),
        }
    }

    /// Columns and rows of a kind that are coded.
    fn coded(self, kind: Kind) -> [usize; 2] {
        let inner = [self.nx - usize::from(self.repeats_column), self.ny - usize::from(self.repeats_row)];
        match kind {
            Kind::H => [inner[0], self.ny + 1],
            Kind::V => [self.nx + 1, inner[1]],
            Kind::D => inner,
        }
    }
}

impl<T: Height> Planes<T> {
    /// Sets the points of a kind that repeat an even column or row.
    fn repeat(&mut self, extent: Extent, kind: Kind) {
        let Extent { nx, ny, repeats_column, repeats_row } = extent;
        match kind {
            Kind::H if repeats_column => {
                for y in 0..=ny {
                    self.h.row_mut(y)[nx - 1] = self.e.row(y)[nx];
                }
            }
            Kind::V if repeats_row => {
                let below = self.e.row(ny);
                self.v.row_mut(ny - 1).copy_from_slice(below);
            }
            Kind::D => {
                if repeats_column {
                    for y in 0..ny {
                        self.d.row_mut(y)[nx - 1] = self.v.row(y)[nx];
                    }
                }
                if repeats_row {
                    let below = self.h.row(ny);
                    self.d.row_mut(ny - 1).copy_from_slice(below);
                }
            }
            _ => {}
        }
    }
}

/// Residuals of one kind with their contexts, row by row.
struct Residuals {
    columns: usize,
    values: Vec<i32>,
    contexts: Vec<u8>,
}

/// Codes the new points of `planes`, all of whose heights are set (relative to `base`).
pub(super) fn encode<T: Height>(planes: &mut Planes<T>, extent: Extent, base: i32, wide: bool) -> Vec<u8> {
    planes.e.fill_margin();
    let mut presets = u8::from(wide);
    let mut bits = BitWriter::default();
    let mut coded = Vec::new();
    for kind in KINDS {
        let preset = best_preset(planes, extent, kind);
        presets |= (preset as u8) << (1 + 2 * kind as u32);
        let residuals = residuals(planes, extent, kind, preset);
        let members = choose_members(&residuals, &mut bits);
        coded.push((residuals, members));
    }
    let mut plain = bits;
    for (residuals, members) in &coded {
        put_plain(residuals, members, &mut plain);
    }
    let mut encoder = Encoder::new();
    for (residuals, members) in coded.iter().rev() {
        if residuals.columns == 0 {
            continue;
        }
        let rows = residuals.values.chunks(residuals.columns).zip(residuals.contexts.chunks(residuals.columns));
        for (values, contexts) in rows.rev() {
            for (x, (&value, &context)) in values.iter().zip(contexts).enumerate().rev() {
                let member = members[usize::from(context)];
                let frequencies = &FAMILY.frequencies[member.table];
                let symbol = frequencies.clip(member.split(value).0);
                encoder.put(x % LANES, frequencies.span(symbol));
            }
        }
    }
    let plain = plain.finish();
    let mut out = vec![presets];
    put_varint(&mut out, zigzag(i64::from(base)));
    put_varint(&mut out, plain.len() as u64);
    out.extend(plain);
    out.extend(encoder.finish());
    out
}

/// The preset with the smallest residuals on every fourth row.
fn best_preset<T: Height>(planes: &Planes<T>, extent: Extent, kind: Kind) -> usize {
    let [columns, rows] = extent.coded(kind);
    let mut prediction = vec![T::default(); columns];
    let mut sums = [0u64; PRESETS];
    for y in (rows.min(2) / 2..rows).step_by(4) {
        let row = planes.plane(kind).row(y);
        for (preset, sum) in sums.iter_mut().enumerate() {
            planes.predict_row(kind, preset, y, &mut prediction);
            let row_sum: u32 = prediction.iter().zip(row).map(|(&p, &z)| z.minus(p).size() as u32).sum();
            *sum += u64::from(row_sum);
        }
    }
    (0..PRESETS).min_by_key(|&p| sums[p]).unwrap_or(0)
}

fn residuals<T: Height>(planes: &mut Planes<T>, extent: Extent, kind: Kind, preset: usize) -> Residuals {
    let [columns, rows] = extent.coded(kind);
    let mut out = Residuals { columns, values: vec![0; columns * rows], contexts: vec![0; columns * rows] };
    let mut prediction = vec![T::default(); columns];
    for y in 0..rows {
        let values = &mut out.values[y * columns..][..columns];
        planes.context_row(kind, y, &mut out.contexts[y * columns..][..columns]);
        planes.predict_row(kind, preset, y, &mut prediction);
        for ((value, &p), &z) in values.iter_mut().zip(&prediction).zip(planes.plane(kind).row(y)) {
            *value = z.minus(p).low32();
        }
        set_sizes(planes, kind, y, values);
    }
    planes.complete(kind);
    out
}

#[inline(always)]
fn set_sizes<T: Height>(planes: &mut Planes<T>, kind: Kind, y: usize, residuals: &[i32]) {
    for (size, r) in planes.sizes[kind as usize].row_mut(y).iter_mut().zip(residuals) {
        *size = r.size();
    }
}

/// Chooses a distribution for every context and writes the choice.
fn choose_members(residuals: &Residuals, bits: &mut BitWriter) -> [Member; CONTEXTS] {
    let mut counts = [0u32; CONTEXTS];
    let mut sums = [0u64; CONTEXTS];
    for (&r, &c) in residuals.values.iter().zip(&residuals.contexts) {
        counts[usize::from(c)] += 1;
        sums[usize::from(c)] += u64::from(r.unsigned_abs());
    }
    let scales: [u32; CONTEXTS] = std::array::from_fn(|c| {
        let usual = default_scale(c);
        let nearest = if counts[c] == 0 { usual } else { nearest_scale(sums[c] as f32 / counts[c] as f32) };
        nearest.clamp(usual.saturating_sub(32), (usual + 31).min(SCALES - 1))
    });
    // histograms of what each context's scale leaves as symbols
    const HALF: i64 = 64;
    let mut histograms = vec![[0u32; 2 * HALF as usize + 1]; CONTEXTS];
    for (&r, &c) in residuals.values.iter().zip(&residuals.contexts) {
        let symbol = Member::new(scales[usize::from(c)], 0).split(r).0;
        histograms[usize::from(c)][(symbol.clamp(-HALF, HALF) + HALF) as usize] += 1;
    }
    let first = counts.iter().position(|&n| n > 0).unwrap_or(0);
    let end = counts.iter().rposition(|&n| n > 0).map_or(first, |c| c + 1);
    bits.put(first as u32, 6);
    bits.put((end - first) as u32, 6);
    let mut members = [Member::new(0, USUAL_SHAPE); CONTEXTS];
    for c in first..end {
        let usual = default_scale(c);
        let cost = |scale: u32, shape: usize| -> f32 {
            let member = Member::new(scale, shape);
            let table = &FAMILY.frequencies[member.table];
            let symbols = (-HALF as i32..).zip(&histograms[c]).filter(|(_, n)| **n > 0);
            let symbols: f32 = symbols.map(|(s, &n)| n as f32 * table.cost(s)).sum();
            symbols + (member.plain_bits * counts[c]) as f32
        };
        let plain_bits = Member::new(scales[c], 0).plain_bits;
        let (low, high) = (usual.saturating_sub(32), (usual + 31).min(SCALES - 1));
        let candidates = (scales[c].saturating_sub(4).max(low)..=(scales[c] + 4).min(high))
            .filter(|&s| Member::new(s, 0).plain_bits == plain_bits)
            .flat_map(|scale| (0..SHAPES).map(move |shape| (scale, shape)));
        let (mut best, mut least) = (None, f32::INFINITY);
        if Member::new(usual, 0).plain_bits == plain_bits {
            least = cost(usual, USUAL_SHAPE) - 8.0;
        }
        for (scale, shape) in candidates {
            let bits = cost(scale, shape);
            if bits < least {
                (best, least) = (Some((scale, shape)), bits);
            }
        }
        bits.put(u32::from(best.is_some()), 1);
        if let Some((scale, shape)) = best {
            bits.put(scale + 32 - usual, 6);
            bits.put(shape as u32, 2);
        }
        let (scale, shape) = best.unwrap_or((usual, USUAL_SHAPE));
        members[c] = Member::new(scale, shape);
    }
    members
}

/// Writes what the symbols leave: low bits, and the rest of the escaped ones.
fn put_plain(residuals: &Residuals, members: &[Member; CONTEXTS], bits: &mut BitWriter) {
    for (&value, &context) in residuals.values.iter().zip(&residuals.contexts) {
        let member = members[usize::from(context)];
        let frequencies = &FAMILY.frequencies[member.table];
        let (symbol, plain) = member.split(value);
        if symbol.unsigned_abs() > frequencies.reach as u64 {
            bits.put_gamma((symbol.unsigned_abs() - frequencies.reach as u64 - 1) as u32);
        }
        if member.plain_bits > 0 {
            bits.put(plain, member.plain_bits);
        }
    }
}

/// Reads the base height and the arithmetic: what the even points must be made relative to before [`decode`].
pub(super) fn decode_head(bytes: &mut &[u8]) -> Option<(u8, i32)> {
    let (&presets, rest) = bytes.split_first()?;
    *bytes = rest;
    let base = i32::try_from(unzigzag(take_varint(bytes)?)).ok()?;
    (presets >> 7 == 0).then_some((presets, base))
}

/// Sets the new points of `planes`, whose even ones are set; `None` when the bytes are no page's.
pub(super) fn decode<T: Height>(planes: &mut Planes<T>, extent: Extent, presets: u8, mut bytes: &[u8]) -> Option<()> {
    let length = usize::try_from(take_varint(&mut bytes)?).ok()?;
    let plain = super::bits::take(&mut bytes, length)?;
    let mut bits = BitReader::new(plain);
    let mut members = [[Member::new(0, USUAL_SHAPE); CONTEXTS]; 3];
    for kind_members in &mut members {
        read_members(&mut bits, kind_members)?;
    }
    let family = &*FAMILY;
    let mut decoder = Decoder::new(bytes)?;
    planes.e.fill_margin();
    for (kind, members) in KINDS.into_iter().zip(&members) {
        let tables: [u16; CONTEXTS] = members.map(|m| m.table as u16);
        let any_plain = members.iter().any(|m| m.plain_bits > 0);
        let preset = usize::from(presets >> (1 + 2 * kind as u32) & 3);
        let [columns, rows] = extent.coded(kind);
        let mut prediction = vec![T::default(); columns];
        let mut contexts = vec![0u8; columns];
        let mut row_tables = vec![0u16; columns];
        let mut symbols = vec![0i8; columns];
        let mut values = vec![0i32; columns];
        for y in 0..rows {
            planes.context_row(kind, y, &mut contexts);
            for (table, &c) in row_tables.iter_mut().zip(&contexts) {
                *table = tables[usize::from(c) % CONTEXTS];
            }
            decoder.row(&row_tables, &family.slots, &mut symbols);
            let escapes = symbols.iter().fold(false, |any, &s| any | (i32::from(s).abs() == ESCAPE));
            if escapes || any_plain {
                for ((value, &symbol), &c) in values.iter_mut().zip(&symbols).zip(&contexts) {
                    let member = members[usize::from(c) % CONTEXTS];
                    let mut whole = i64::from(symbol);
                    if i32::from(symbol).abs() == ESCAPE {
                        let reach = i64::from(family.frequencies[member.table].reach);
                        whole = i64::from(symbol.signum()) * (reach + 1 + i64::from(bits.get_gamma()));
                    }
                    *value = member.join(whole, bits.get(member.plain_bits));
                }
            } else {
                for (value, &symbol) in values.iter_mut().zip(&symbols) {
                    *value = i32::from(symbol);
                }
            }
            planes.predict_row(kind, preset, y, &mut prediction);
            let plane = planes.plane_mut(kind);
            for ((z, &p), &r) in plane.row_mut(y).iter_mut().zip(&prediction).zip(&values) {
                *z = T::of(p.plus(T::of(r)).low32());
            }
            set_sizes(planes, kind, y, &values);
        }
        planes.repeat(extent, kind);
        planes.complete(kind);
    }
    (decoder.is_exhausted() && bits.is_exhausted()).then_some(())
}

fn read_members(bits: &mut BitReader<'_>, members: &mut [Member; CONTEXTS]) -> Option<()> {
    for (c, member) in members.iter_mut().enumerate() {
        *member = Member::new(default_scale(c), USUAL_SHAPE);
    }
    let first = bits.get(6) as usize;
    let count = bits.get(6) as usize;
    let used = members.get_mut(first..first + count)?;
    for (c, member) in (first..).zip(used) {
        if bits.get(1) == 1 {
            let scale = (default_scale(c) + bits.get(6)).checked_sub(32).filter(|&s| s < SCALES)?;
            *member = Member::new(scale, bits.get(2) as usize);
        }
    }
    Some(())
}
