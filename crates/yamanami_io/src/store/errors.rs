//! Error codes: rounding up to steps, and what follows from the heights on level 0.
//!
//! On level 0 an error is the size of the point's own detail, so the codes follow from the heights and only exceptions
//! are stored, exactly. `error_steps` stores those of the other levels.

use super::bits::{put_varint, take, take_varint};
use yamanami_core::ErrorCode;

/// Codes in an octave.
const CODES_PER_OCTAVE: u32 = 2048;

/// Steps that codes are rounded up to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Steps {
    pub(super) per_octave: u32,
}

impl Steps {
    /// Every code is a step.
    pub(super) const EXACT: Self = Self { per_octave: CODES_PER_OCTAVE };

    /// `per_octave` is a power of two up to 2048; `None` otherwise.
    pub(super) fn new(per_octave: u32) -> Option<Self> {
        (per_octave.is_power_of_two() && per_octave <= CODES_PER_OCTAVE).then_some(Self { per_octave })
    }

    fn width_bits(self) -> u32 {
        (CODES_PER_OCTAVE / self.per_octave).ilog2()
    }

    /// Number of the least step not below a code; 0 for no error.
    #[inline]
    pub(super) fn step(self, code: ErrorCode) -> i32 {
        let bits = self.width_bits();
        let step = ((u32::from(code.0).wrapping_sub(1).wrapping_add((1 << bits) - 1)) >> bits) as i32 + 1;
        if code.0 == 0 { 0 } else { step }
    }

    /// The code of a step.
    #[inline]
    pub(super) fn code(self, step: i32) -> ErrorCode {
        match step {
            ..=0 => ErrorCode(0),
            s => ErrorCode((((s as u32 - 1) << self.width_bits()) + 1).min(0xFFFF) as u16),
        }
    }

    pub(super) fn last(self) -> i32 {
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
    /// The codes of all new points of level 0 that follow from the heights, row by row.
    fn derived(&self, slack_m: f32) -> Vec<ErrorCode> {
        let mut errors = vec![ErrorCode(0); self.width * self.height];
        derive_rows(*self, slack_m, &mut errors);
        if !self.shown.is_empty() {
            for (x, y) in self.new_points().filter(|&(x, y)| self.is_hidden(x, y)) {
                errors[y * self.width + x] = ErrorCode(0);
            }
        }
        errors
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

/// Codes level-0 errors as exceptions to what follows from the heights.
pub(super) fn encode_exceptions(ground: Ground<'_>, errors: &[ErrorCode], slack_m: f32) -> Vec<u8> {
    let derived = ground.derived(slack_m);
    let (mut list, mut count, mut since) = (Vec::new(), 0u64, 0u64);
    if derived != errors {
        for i in ground.new_points().map(|(x, y)| y * ground.width + x) {
            if derived[i] == errors[i] {
                since += 1;
                continue;
            }
            count += 1;
            put_varint(&mut list, since);
            put_varint(&mut list, u64::from(errors[i].0));
            since = 0;
        }
    }
    let mut out = slack_m.to_le_bytes().to_vec();
    put_varint(&mut out, count);
    out.extend(list);
    out
}

/// Undoes [`encode_exceptions`].
pub(super) fn decode_exceptions(ground: Ground<'_>, mut bytes: &[u8]) -> Option<Vec<ErrorCode>> {
    let slack_m = f32::from_le_bytes(take(&mut bytes, 4)?.try_into().ok()?);
    if !(0.0..1e6).contains(&slack_m) {
        return None;
    }
    let mut errors = ground.derived(slack_m);
    let mut count = take_varint(&mut bytes)?;
    if count > 0 {
        let mut points = ground.new_points();
        while count > 0 {
            let since = usize::try_from(take_varint(&mut bytes)?).ok()?;
            let code = u16::try_from(take_varint(&mut bytes)?).ok()?;
            let (x, y) = points.nth(since)?;
            errors[y * ground.width + x] = ErrorCode(code);
            count -= 1;
        }
    }
    bytes.is_empty().then_some(errors)
}

/// [`Ground::derived`] without holes.
pub(super) fn derive_rows(ground: Ground<'_>, slack_m: f32, errors: &mut [ErrorCode]) {
    #[cfg(target_arch = "x86_64")]
    if super::has_avx2() {
        // SAFETY: the processor has the instructions, as just asked.
        return unsafe { derive_rows_avx2(ground, slack_m, errors) };
    }
    derive_rows_body(ground, slack_m, errors);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2")]
fn derive_rows_avx2(ground: Ground<'_>, slack_m: f32, errors: &mut [ErrorCode]) {
    derive_rows_body(ground, slack_m, errors);
}

#[inline(always)]
fn derive_rows_body(ground: Ground<'_>, slack_m: f32, errors: &mut [ErrorCode]) {
    let code = |z: f32, a: f32, b: f32| {
        let detail_m = (0.5 * ((z - a) + (z - b))).abs();
        let code = ErrorCode::ceil(detail_m + slack_m);
        if detail_m > 0.0 { code } else { ErrorCode(0) }
    };
    let (width, height) = (ground.width, ground.height);
    let row = |y: usize| &ground.heights_m[y.min(height - 1) * width..][..width];
    // whole rows are worked out as if all points were of one kind, then every other code is taken: no gathering
    let mut codes = [ErrorCode(0); ROW];
    for (y, out) in errors.chunks_exact_mut(width).enumerate() {
        let (z, above, below) = (row(y), row(y - y % 2), row(y + y % 2));
        let inner = width.saturating_sub(2);
        let codes = &mut codes[..inner];
        for (x, c) in codes.iter_mut().enumerate() {
            *c = code(z[x + 1], above[x], below[x + 2]);
        }
        for (x, c) in (1..).step_by(2).zip(codes.iter().step_by(2)) {
            out[x] = *c;
        }
        if width % 2 == 0 {
            let last = width - 1;
            out[last] = code(z[last], above[last - 1], below[last]);
        }
        if y % 2 == 1 {
            for (x, o) in out.iter_mut().enumerate() {
                let vertical = code(z[x], above[x], below[x]);
                *o = if x % 2 == 0 { vertical } else { *o };
            }
        }
    }
}

/// Room for a row of points.
pub(super) const ROW: usize = 260;
