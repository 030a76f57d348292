//! Error codes of a page's new points to bytes and back.
//!
//! On level 0 an error is the size of the point's own detail, so the codes follow from the heights and only exceptions
//! are stored. On coarser levels codes are rounded up to a few steps an octave (the same for all levels, so that a
//! parent's stays at least its child's), and each is foretold from the bend of the
//! ground and the neighbours coded before.

use super::bits::{BitReader, BitWriter, put_varint, take, take_varint};
use super::family::{ERROR_SCALES, ERROR_SHAPES, ESCAPE, FAMILY, error_table};
use super::rans::{Decoder, Encoder, LANES};
use yamanami_core::ErrorCode;

/// Codes in an octave.
const CODES_PER_OCTAVE: u32 = 2048;
/// Contexts of a kind: eight degrees of disagreement, and whether the expected value is near a whole step.
const CONTEXTS: usize = 16;
/// Scale and shape that a context has unless it names others.
const USUAL_SHAPE: usize = 1;

/// Steps that codes are rounded up to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Steps {
    per_octave: u32,
}

impl Steps {
    /// `per_octave` is a power of two up to 2048; `None` otherwise.
    pub(super) fn new(per_octave: u32) -> Option<Self> {
        (per_octave.is_power_of_two() && per_octave <= CODES_PER_OCTAVE).then_some(Self { per_octave })
    }

    fn width(self) -> u32 {
        CODES_PER_OCTAVE / self.per_octave
    }

    /// Number of the least step not below a code; 0 for no error.
    #[inline]
    fn step(self, code: ErrorCode) -> i32 {
        if code.0 == 0 { 0 } else { (u32::from(code.0) - 1).div_ceil(self.width()) as i32 + 1 }
    }

    /// The code of a step.
    #[inline]
    fn code(self, step: i32) -> ErrorCode {
        match step {
            ..=0 => ErrorCode(0),
            s => ErrorCode(((s as u32 - 1) * self.width() + 1).min(0xFFFF) as u16),
        }
    }

    fn last(self) -> i32 {
        self.step(ErrorCode(0xFFFF))
    }

    /// The code rounded up to a step.
    pub(super) fn ceil(self, code: ErrorCode) -> ErrorCode {
        self.code(self.step(code))
    }
}

/// A page as this module sees it: its points and heights, row by row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ground<'a> {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) heights_m: &'a [f32],
    /// Two bits a square; empty when all hold data.
    pub(super) shown: &'a [u8],
}

impl Ground<'_> {
    #[inline]
    fn z(&self, x: usize, y: usize) -> f32 {
        // a point past the last column or row takes its place
        self.heights_m[y.min(self.height - 1) * self.width + x.min(self.width - 1)]
    }

    /// Size of the detail at (x, y) against the two points (dx, dy) away.
    #[inline]
    fn detail_m(&self, x: usize, y: usize, dx: usize, dy: usize) -> f32 {
        let (z, a, b) = (self.z(x, y), self.z(x - dx, y - dy), self.z(x + dx, y + dy));
        (0.5 * ((z - a) + (z - b))).abs()
    }

    /// The code of a new point of level 0 that follows from the heights.
    #[inline]
    fn derived(&self, x: usize, y: usize, slack_m: f32) -> ErrorCode {
        let detail_m = self.detail_m(x, y, x & 1, y & 1);
        let hidden = !self.shown.is_empty() && self.is_hidden(x, y);
        if detail_m > 0.0 && !hidden { ErrorCode::ceil(detail_m + slack_m) } else { ErrorCode(0) }
    }

    /// Whether no square at the point shows anything.
    fn is_hidden(&self, x: usize, y: usize) -> bool {
        let (columns, rows) = (self.width - 1, self.height - 1);
        (y.saturating_sub(1)..(y + 1).min(rows))
            .all(|v| (x.saturating_sub(1)..(x + 1).min(columns)).all(|u| self.shown[v * columns + u] & 3 == 0))
    }

    fn new_points(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let (width, height) = (self.width, self.height);
        (0..height).flat_map(move |y| ((y + 1) % 2..width).step_by(1 + (y + 1) % 2).map(move |x| (x, y)))
    }
}

/// Codes level-0 errors as exceptions to what follows from the heights; `None` when there are too many.
pub(super) fn encode_exceptions(ground: Ground<'_>, errors: &[ErrorCode], slack_m: f32) -> Option<Vec<u8>> {
    let limit = ground.width * ground.height / 16 + 16;
    let (mut list, mut count, mut since) = (Vec::new(), 0, 0u64);
    for (x, y) in ground.new_points() {
        let code = errors[y * ground.width + x];
        if ground.derived(x, y, slack_m) == code {
            since += 1;
            continue;
        }
        count += 1;
        if count > limit {
            return None;
        }
        put_varint(&mut list, since);
        put_varint(&mut list, u64::from(code.0));
        since = 0;
    }
    let mut out = slack_m.to_le_bytes().to_vec();
    put_varint(&mut out, count as u64);
    out.extend(list);
    Some(out)
}

/// Undoes [`encode_exceptions`].
pub(super) fn decode_exceptions(ground: Ground<'_>, mut bytes: &[u8]) -> Option<Vec<ErrorCode>> {
    let slack_m = f32::from_le_bytes(take(&mut bytes, 4)?.try_into().ok()?);
    if !(0.0..1e6).contains(&slack_m) {
        return None;
    }
    let (width, height) = (ground.width, ground.height);
    let mut errors = vec![ErrorCode(0); width * height];
    if ground.shown.is_empty() {
        derive_rows(ground, slack_m, &mut errors);
    } else {
        for (x, y) in ground.new_points() {
            errors[y * width + x] = ground.derived(x, y, slack_m);
        }
    }
    let mut count = take_varint(&mut bytes)?;
    if count > 0 {
        let mut points = ground.new_points();
        while count > 0 {
            let since = usize::try_from(take_varint(&mut bytes)?).ok()?;
            let code = u16::try_from(take_varint(&mut bytes)?).ok()?;
            let (x, y) = points.nth(since)?;
            errors[y * width + x] = ErrorCode(code);
            count -= 1;
        }
    }
    bytes.is_empty().then_some(errors)
}

/// [`Ground::derived`] for whole rows of a surface without holes.
fn derive_rows(ground: Ground<'_>, slack_m: f32, errors: &mut [ErrorCode]) {
    let code = |z: f32, a: f32, b: f32| {
        let detail_m = (0.5 * ((z - a) + (z - b))).abs();
        if detail_m > 0.0 { ErrorCode::ceil(detail_m + slack_m) } else { ErrorCode(0) }
    };
    let (width, height) = (ground.width, ground.height);
    let row = |y: usize| &ground.heights_m[y.min(height - 1) * width..][..width];
    for (y, out) in errors.chunks_exact_mut(width).enumerate() {
        let (z, above, below) = (row(y), row(y - y % 2), row(y + y % 2));
        if y % 2 == 1 {
            for x in (0..width).step_by(2) {
                out[x] = code(z[x], above[x], below[x]);
            }
        }
        for x in (1..width).step_by(2) {
            out[x] = code(z[x], above[x - 1], below[(x + 1).min(width - 1)]);
        }
    }
}

/// The order in which new points are coded, and where each kind begins.
const KINDS: [(usize, usize); 3] = [(1, 1), (1, 0), (0, 1)];

const WIDTH: i32 = 24;
/// What is known of a page's codes while they are coded: one plane of steps over all its points.
struct Plane<'a> {
    ground: Ground<'a>,
    steps: Steps,
    /// 0 where not yet known.
    known: Vec<i32>,
}

impl<'a> Plane<'a> {
    fn new(ground: Ground<'a>, steps: Steps) -> Self {
        Self { ground, steps, known: vec![0; ground.width * ground.height] }
    }

    #[inline]
    fn at(&self, x: usize, y: usize) -> i32 {
        if x < self.ground.width && y < self.ground.height { self.known[y * self.ground.width + x] } else { 0 }
    }

    /// The step expected at a point of a kind, in 1/64, and how far its signs disagree (same unit).
    fn expect(&self, x: usize, y: usize) -> (i32, i32) {
        let detail = |x: usize, y: usize, dx: usize, dy: usize| self.ground.detail_m(x, y, dx, dy);
        let step = |error_m: f32| self.steps.step(ErrorCode::ceil(error_m));
        // a neighbour past the border, or not known, counts as its opposite
        let pair = |a: i32, b: i32| if a == 0 { [b, b] } else if b == 0 { [a, a] } else { [a, b] };
        let (w, h) = (self.ground.width, self.ground.height);
        let own_m = detail(x, y, x & 1, y & 1);
        let mut greatest_m = own_m;
        let mut consider = |x: usize, y: usize, dx: usize, dy: usize| {
            if x >= dx && y >= dy && x < w && y < h {
                greatest_m = greatest_m.max(detail(x, y, dx, dy));
            }
        };
        let (near, far) = match (x & 1, y & 1) {
            (1, 1) => {
                consider(x, y - 1, 1, 0);
                consider(x, y + 1, 1, 0);
                consider(x - 1, y, 0, 1);
                consider(x + 1, y, 0, 1);
                (None, None)
            }
            (1, 0) => {
                consider(x, y.wrapping_sub(1), 1, 1);
                consider(x, y + 1, 1, 1);
                (Some(pair(self.at(x, y.wrapping_sub(1)), self.at(x, y + 1))), None)
            }
            _ => {
                consider(x.wrapping_sub(1), y, 1, 1);
                consider(x + 1, y, 1, 1);
                let left = pair(self.at(x.wrapping_sub(1), y - 1), self.at(x.wrapping_sub(1), y + 1));
                let right = pair(self.at(x + 1, y - 1), self.at(x + 1, y + 1));
                let [left, right] = pair(left[0] + left[1], right[0] + right[1]);
                (Some(pair(self.at(x.wrapping_sub(1), y), self.at(x + 1, y))), Some(left + right))
            }
        };
        let (own, greatest) = (step(own_m), step(greatest_m));
        let (up, up_sides) = if y >= 2 {
            let up = self.at(x, y - 2);
            let [a, b] = pair(self.at(x.wrapping_sub(2), y - 2), self.at(x + 2, y - 2));
            (up, if a == 0 { 2 * up } else { a + b })
        } else {
            (greatest, 2 * greatest)
        };
        let octave = self.steps.per_octave as i32;
        let apart = |p: i32, s: i32| (p - 64 * s).abs();
        match (near, far) {
            (Some(near), Some(far)) => {
                let [low, high] = [near[0].min(near[1]), near[0].max(near[1])];
                let p = 2 * own + 2 * greatest + up + up_sides + 17 * high + 14 * low + (26 * far) / 4 + octave;
                (p, (apart(p, greatest) + apart(p, low) + apart(p, high) + apart(p, far / 4)) / 4)
            }
            (Some(near), None) => {
                let [low, high] = [near[0].min(near[1]), near[0].max(near[1])];
                let p = 2 * own + 6 * up + 5 * up_sides + 27 * high + 19 * low - 8 * octave;
                (p, (apart(p, up) + apart(p, greatest) + apart(p, low) + apart(p, high)) / 4)
            }
            _ => {
                let p = 3 * own + 37 * greatest + 8 * up + 8 * up_sides + 10 * octave;
                (p, (2 * apart(p, greatest) + apart(p, up) + apart(p, up_sides / 2)) / 4)
            }
        }
    }

    /// For a row of a kind: the whole step expected, and the context with the sign of the differences.
    fn expect_row(&self, first: usize, y: usize, out: &mut Vec<Expected>) {
        out.clear();
        let octave = self.steps.per_octave as i32;
        out.extend((first..self.ground.width).step_by(2).map(|x| {
            let (p, apart) = self.expect(x, y);
            let whole = (p + 32) >> 6;
            let third = ((p + 32) & 63) * 3 >> 6;
            let degree = (apart / (octave * WIDTH).max(1)).min(7);
            Expected {
                step: whole,
                flipped: third == 0,
                context: (degree * 2 + i32::from(third != 1)) as u8,
            }
        }));
    }

    fn rows(&self, first: usize) -> impl Iterator<Item = usize> + use<> {
        (first..self.ground.height).step_by(2)
    }

    fn columns(&self, first: usize) -> usize {
        (self.ground.width - first).div_ceil(2)
    }
}

/// What is foretold of a point's code.
#[derive(Debug, Clone, Copy)]
struct Expected {
    step: i32,
    flipped: bool,
    context: u8,
}

impl Expected {
    #[inline]
    fn difference(self, step: i32) -> i32 {
        if self.flipped { self.step - step } else { step - self.step }
    }

    #[inline]
    fn step(self, difference: i32) -> i32 {
        if self.flipped { self.step - difference } else { self.step + difference }
    }
}

/// The scale a context has unless it names another.
fn usual_scale(context: usize) -> usize {
    2 + context / 4
}

/// Rounds a page's codes up to steps and codes these: length of the plain bits, plain bits, range coder's bytes. The plain
/// bits begin with the distributions: per kind and context one bit, followed by 4 bits of scale and 2 of shape when it is set.
pub(super) fn encode(ground: Ground<'_>, steps: Steps, errors: &[ErrorCode]) -> Vec<u8> {
    let mut plane = Plane::new(ground, steps);
    let mut expected_row = Vec::new();
    let mut bits = BitWriter::default();
    let mut coded = Vec::new();
    for (fx, fy) in KINDS {
        let mut differences: Vec<(Expected, i32)> = Vec::new();
        for y in plane.rows(fy) {
            plane.expect_row(fx, y, &mut expected_row);
            for (x, &expected) in (fx..ground.width).step_by(2).zip(&expected_row) {
                let i = y * ground.width + x;
                let step = steps.step(errors[i]);
                differences.push((expected, expected.difference(step)));
                plane.known[i] = step;
            }
        }
        let tables = choose_tables(&differences, &mut bits);
        coded.push((differences, tables, plane.columns(fx)));
    }
    for (differences, tables, _) in &coded {
        for (expected, difference) in differences {
            let reach = FAMILY.frequencies[tables[usize::from(expected.context)]].reach;
            if difference.abs() > reach {
                bits.put_gamma((difference.abs() - reach - 1) as u32);
            }
        }
    }
    let mut encoder = Encoder::new();
    for (differences, tables, columns) in coded.iter().rev() {
        if *columns == 0 {
            continue;
        }
        for row in differences.chunks(*columns).rev() {
            for (x, (expected, difference)) in row.iter().enumerate().rev() {
                let frequencies = &FAMILY.frequencies[tables[usize::from(expected.context)]];
                encoder.put(x % LANES, frequencies.span(frequencies.clip(i64::from(*difference))));
            }
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

fn choose_tables(differences: &[(Expected, i32)], bits: &mut BitWriter) -> [usize; CONTEXTS] {
    const HALF: i32 = 64;
    let mut histograms = [[0u32; 2 * HALF as usize + 1]; CONTEXTS];
    for (expected, difference) in differences {
        histograms[usize::from(expected.context)][(difference.clamp(&-HALF, &HALF) + HALF) as usize] += 1;
    }
    std::array::from_fn(|c| {
        let cost = |choice: Option<(usize, usize)>| -> f32 {
            let table = &FAMILY.frequencies[table(c, choice)];
            let symbols = (-HALF..).zip(&histograms[c]).filter(|(_, n)| **n > 0);
            symbols.map(|(s, &n)| n as f32 * table.cost(s)).sum()
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
pub(super) fn decode(ground: Ground<'_>, steps: Steps, mut bytes: &[u8]) -> Option<Vec<ErrorCode>> {
    let mut plane = Plane::new(ground, steps);
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
    let mut decoder = Decoder::new(bytes)?;
    let mut expected_row = Vec::new();
    let (mut row_tables, mut symbols) = (Vec::new(), Vec::new());
    let mut errors = vec![ErrorCode(0); ground.width * ground.height];
    for ((fx, fy), tables) in KINDS.into_iter().zip(&tables) {
        symbols.resize(plane.columns(fx), 0);
        for y in plane.rows(fy) {
            plane.expect_row(fx, y, &mut expected_row);
            row_tables.clear();
            row_tables.extend(expected_row.iter().map(|e| tables[usize::from(e.context)] as u16));
            decoder.row(&row_tables, &FAMILY.slots, &mut symbols);
            for (k, (&expected, &symbol)) in expected_row.iter().zip(&symbols).enumerate() {
                let mut difference = i32::from(symbol);
                if difference.abs() == ESCAPE {
                    let reach = FAMILY.frequencies[usize::from(row_tables[k])].reach;
                    let excess = i32::try_from(bits.get_gamma()).ok().filter(|e| *e < 1 << 20)?;
                    difference = difference.signum() * (reach + 1 + excess);
                }
                let step = expected.step(difference);
                if !(0..=steps.last()).contains(&step) {
                    return None;
                }
                let i = y * ground.width + fx + 2 * k;
                plane.known[i] = step;
                errors[i] = steps.code(step);
            }
        }
    }
    (decoder.is_exhausted() && bits.is_exhausted()).then_some(errors)
}
