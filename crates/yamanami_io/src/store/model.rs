//! How a page's new points are foretold from the coarser level: four planes, their predictors and their contexts.
//!
//! Even points (both coordinates even) are known from the coarser page. New points are of three kinds: H on an
//! even row, V on an even column, D in the middle of four even points. H is foretold from E, V from E and H, D from E, H
//! and V. Kept as four planes, a whole row of predictions is one straight loop.
//!
//! Based on: Deslauriers, Dubuc, "Symmetric iterative interpolation processes", 1989 (four-point weights 9, 9, -1, -1); the
//! contexts of a residual (sizes of its neighbours and the bend of the ground) follow Wu, Memon, "Context-based,
//! adaptive, lossless image coding", 1997.

use std::cell::RefCell;

/// Kinds of new points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    H,
    V,
    D,
}

/// Coding order.
pub(super) const KINDS: [Kind; 3] = [Kind::H, Kind::V, Kind::D];

/// Weights of the sums each kind is foretold from; a prediction is their total over 256.
pub(super) const PRESETS: usize = 4;
/// H: two nearest of the row, two next; the four of the rows above and below.
const H_WEIGHTS: [[i32; 3]; PRESETS] = [[144, -16, 0], [136, -18, 5], [80, 0, 24], [128, 0, 0]];
/// V: two nearest of the column, two next; four even ones beside; the four H points around.
const V_WEIGHTS: [[i32; 4]; PRESETS] = [[144, -16, 0, 0], [114, -22, -5, 23], [40, 8, 10, 30], [128, 0, 0, 0]];
/// D: H above and below; V left and right; four even corners; next V of the row; next H of the column.
const D_WEIGHTS: [[i32; 5]; PRESETS] =
    [[128, 128, -64, 0, 0], [98, 98, -27, -6, -8], [90, 134, -46, -4, 0], [48, 48, 8, 8, 8]];

/// Contexts: half octaves of a residual's expected size.
pub(super) const CONTEXTS: usize = 56;
/// Residual sizes count at most this much in contexts.
const SIZE_CAP: u32 = 1 << 23;

/// Arithmetic of heights: wrapping, in 32 bits where a page's range allows, else in 64.
pub(super) trait Height: Copy + Default + 'static {
    /// Room for a page, kept by each thread from page to page.
    fn with_scratch<R>(work: impl FnOnce(&mut Planes<Self>) -> R) -> R;

    fn of(value: i32) -> Self;
    fn low32(self) -> i32;
    fn plus(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;
    fn times(self, weight: i32) -> Self;
    fn round256(self) -> Self;
    fn size(self) -> i32;
}

impl Height for i32 {
    fn with_scratch<R>(work: impl FnOnce(&mut Planes<Self>) -> R) -> R {
        thread_local!(static SCRATCH: RefCell<Planes<i32>> = RefCell::default());
        SCRATCH.with(|planes| work(&mut planes.borrow_mut()))
    }
    #[inline(always)]
    fn of(value: i32) -> Self {
        value
    }
    #[inline(always)]
    fn low32(self) -> i32 {
        self
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self.wrapping_add(other)
    }
    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self.wrapping_sub(other)
    }
    #[inline(always)]
    fn times(self, weight: i32) -> Self {
        self.wrapping_mul(weight)
    }
    #[inline(always)]
    fn round256(self) -> Self {
        self.wrapping_add(128) >> 8
    }
    #[inline(always)]
    fn size(self) -> i32 {
        self.unsigned_abs().min(SIZE_CAP) as i32
    }
}

impl Height for i64 {
    fn with_scratch<R>(work: impl FnOnce(&mut Planes<Self>) -> R) -> R {
        thread_local!(static SCRATCH: RefCell<Planes<i64>> = RefCell::default());
        SCRATCH.with(|planes| work(&mut planes.borrow_mut()))
    }
    #[inline(always)]
    fn of(value: i32) -> Self {
        i64::from(value)
    }
    #[inline(always)]
    fn low32(self) -> i32 {
        self as i32
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self.wrapping_add(other)
    }
    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self.wrapping_sub(other)
    }
    #[inline(always)]
    fn times(self, weight: i32) -> Self {
        self.wrapping_mul(i64::from(weight))
    }
    #[inline(always)]
    fn round256(self) -> Self {
        self.wrapping_add(128) >> 8
    }
    #[inline(always)]
    fn size(self) -> i32 {
        self.unsigned_abs().min(u64::from(SIZE_CAP)) as i32
    }
}

/// What part of a page's planes is coded.
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
    pub(super) fn coded(self, kind: Kind) -> [usize; 2] {
        let inner = [self.nx - usize::from(self.repeats_column), self.ny - usize::from(self.repeats_row)];
        match kind {
            Kind::H => [inner[0], self.ny + 1],
            Kind::V => [self.nx + 1, inner[1]],
            Kind::D => inner,
        }
    }
}

/// A grid with a margin of one cell all around.
#[derive(Debug, Clone, Default)]
pub(super) struct Plane<T> {
    width: usize,
    height: usize,
    cells: Vec<T>,
}

impl<T: Copy + Default> Plane<T> {
    pub(super) fn reset(&mut self, width: usize, height: usize) {
        (self.width, self.height) = (width, height);
        self.cells.clear();
        self.cells.resize((width + 2) * (height + 2), T::default());
    }

    /// Row `y` from -1 to `height`, its margin cells included: column `x` is at `x + 1`.
    #[inline]
    pub(super) fn padded_row(&self, y: isize) -> &[T] {
        let stride = self.width + 2;
        &self.cells[(y + 1) as usize * stride..][..stride]
    }

    /// Row `y` without margin.
    #[inline]
    pub(super) fn row(&self, y: usize) -> &[T] {
        &self.cells[(y + 1) * (self.width + 2) + 1..][..self.width]
    }

    /// Row `y` without margin.
    #[inline]
    pub(super) fn row_mut(&mut self, y: usize) -> &mut [T] {
        &mut self.cells[(y + 1) * (self.width + 2) + 1..][..self.width]
    }

    /// Fills the margin from the border cell and the one inside it.
    fn fill_margin_by(&mut self, beyond: impl Fn(T, T) -> T) {
        let (w, stride) = (self.width, self.width + 2);
        for y in 1..=self.height {
            let row = &mut self.cells[y * stride..][..stride];
            row[0] = beyond(row[1], row[2.min(w)]);
            row[w + 1] = beyond(row[w], row[(w - 1).max(1)]);
        }
        let last = self.height;
        for x in 0..stride {
            let at = |y: usize| self.cells[y * stride + x];
            let top = beyond(at(1), at(2.min(last)));
            let bottom = beyond(at(last), at((last - 1).max(1)));
            self.cells[x] = top;
            self.cells[(last + 1) * stride + x] = bottom;
        }
    }
}

impl<T: Copy + Default> Plane<T> {
    /// Continues values past the border unchanged.
    pub(super) fn repeat_margin(&mut self) {
        self.fill_margin_by(|a, _| a);
    }
}

impl<T: Height> Plane<T> {
    /// Continues heights past the border as a point reflection.
    pub(super) fn fill_margin(&mut self) {
        self.fill_margin_by(|a, b| a.plus(a).minus(b));
    }
}

/// The planes of a page, and the sizes of the residuals of the new ones.
#[derive(Debug, Default)]
pub(super) struct Planes<T> {
    pub(super) e: Plane<T>,
    pub(super) h: Plane<T>,
    pub(super) v: Plane<T>,
    pub(super) d: Plane<T>,
    /// Sizes of residuals of H, V, D.
    pub(super) sizes: [Plane<i32>; 3],
}

impl<T: Height> Planes<T> {
    /// Makes room for a page, all sizes zero; even points are to be set next.
    pub(super) fn reset(&mut self, Extent { nx, ny, .. }: Extent) {
        self.e.reset(nx + 1, ny + 1);
        self.h.reset(nx, ny + 1);
        self.v.reset(nx + 1, ny);
        self.d.reset(nx, ny);
        self.sizes[0].reset(nx, ny + 1);
        self.sizes[1].reset(nx + 1, ny);
        self.sizes[2].reset(nx, ny);
    }

    /// Sets the points of a kind that repeat an even column or row.
    pub(super) fn repeat(&mut self, extent: Extent, kind: Kind) {
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

    /// Notes the sizes of a row's residuals.
    #[inline(always)]
    pub(super) fn set_sizes(&mut self, kind: Kind, y: usize, residuals: &[i32]) {
        for (size, r) in self.sizes[kind as usize].row_mut(y).iter_mut().zip(residuals) {
            *size = r.size();
        }
    }

    pub(super) fn plane(&self, kind: Kind) -> &Plane<T> {
        match kind {
            Kind::H => &self.h,
            Kind::V => &self.v,
            Kind::D => &self.d,
        }
    }

    pub(super) fn plane_mut(&mut self, kind: Kind) -> &mut Plane<T> {
        match kind {
            Kind::H => &mut self.h,
            Kind::V => &mut self.v,
            Kind::D => &mut self.d,
        }
    }

    /// To be called when a kind is complete, before the next is foretold.
    pub(super) fn complete(&mut self, kind: Kind) {
        self.plane_mut(kind).fill_margin();
        self.sizes[kind as usize].repeat_margin();
    }

    /// Foretells row `y` of a kind into `out`, whose length tells how many columns.
    #[inline(always)]
    pub(super) fn predict_row(&self, kind: Kind, preset: usize, y: usize, out: &mut [T]) {
        let n = out.len();
        let y = y as isize;
        match kind {
            Kind::H => {
                let [a, b, c] = H_WEIGHTS[preset];
                let (e, above, below) =
                    (cut(&self.e, y, n + 3), cut(&self.e, y - 1, n + 3), cut(&self.e, y + 1, n + 3));
                for x in 0..n {
                    let near = e[x + 1].plus(e[x + 2]).times(a);
                    let next = e[x].plus(e[x + 3]).times(b);
                    let beside = above[x + 1].plus(above[x + 2]).plus(below[x + 1].plus(below[x + 2])).times(c);
                    out[x] = near.plus(next).plus(beside).round256();
                }
            }
            Kind::V => {
                let [a, b, c, d] = V_WEIGHTS[preset];
                let [e0, e1, e2, e3] = [y - 1, y, y + 1, y + 2].map(|y| cut(&self.e, y, n + 2));
                let [h1, h2] = [y, y + 1].map(|y| cut(&self.h, y, n + 1));
                for x in 0..n {
                    let near = e1[x + 1].plus(e2[x + 1]).times(a);
                    let next = e0[x + 1].plus(e3[x + 1]).times(b);
                    let beside = e1[x].plus(e1[x + 2]).plus(e2[x].plus(e2[x + 2])).times(c);
                    let around = h1[x].plus(h1[x + 1]).plus(h2[x].plus(h2[x + 1])).times(d);
                    out[x] = near.plus(next).plus(beside.plus(around)).round256();
                }
            }
            Kind::D => {
                let [a, b, c, d, f] = D_WEIGHTS[preset];
                let [e1, e2] = [y, y + 1].map(|y| cut(&self.e, y, n + 2));
                let [h0, h1, h2, h3] = [y - 1, y, y + 1, y + 2].map(|y| cut(&self.h, y, n + 1));
                let v = cut(&self.v, y, n + 3);
                for x in 0..n {
                    let column = h1[x + 1].plus(h2[x + 1]).times(a);
                    let row = v[x + 1].plus(v[x + 2]).times(b);
                    let corners = e1[x + 1].plus(e1[x + 2]).plus(e2[x + 1].plus(e2[x + 2])).times(c);
                    let next = v[x].plus(v[x + 3]).times(d).plus(h0[x + 1].plus(h3[x + 1]).times(f));
                    out[x] = column.plus(row).plus(corners.plus(next)).round256();
                }
            }
        }
    }

    /// Tells the context of each point of row `y` of a kind, from what is known before that row.
    #[inline(always)]
    pub(super) fn context_row(&self, kind: Kind, y: usize, out: &mut [u8]) {
        let n = out.len();
        let y = y as isize;
        let bend = |a: T, b: T, c: T| a.plus(c).minus(b.plus(b)).size();
        match kind {
            Kind::H => {
                let e = cut(&self.e, y, n + 3);
                let up = cut(&self.sizes[0], y - 1, n + 2);
                for x in 0..n {
                    let bends = bend(e[x], e[x + 1], e[x + 2]) + bend(e[x + 1], e[x + 2], e[x + 3]);
                    out[x] = context(27 + 11 * up[x + 1] + 9 * (up[x] + up[x + 2]) + 2 * bends);
                }
            }
            Kind::V => {
                let [e0, e1, e2, e3] = [y - 1, y, y + 1, y + 2].map(|y| cut(&self.e, y, n + 2));
                let [h1, h2] = [y, y + 1].map(|y| cut(&self.sizes[0], y, n + 1));
                let up = cut(&self.sizes[1], y - 1, n + 2);
                for x in 0..n {
                    let bends = bend(e0[x + 1], e1[x + 1], e2[x + 1]) + bend(e1[x + 1], e2[x + 1], e3[x + 1]);
                    let around = h1[x] + h1[x + 1] + h2[x] + h2[x + 1];
                    out[x] = context(8 + 12 * up[x + 1] + 7 * (up[x] + up[x + 2]) + 2 * bends + 6 * around);
                }
            }
            Kind::D => {
                let [e1, e2] = [y, y + 1].map(|y| cut(&self.e, y, n + 2));
                let [h1, h2] = [y, y + 1].map(|y| cut(&self.sizes[0], y, n + 2));
                let v = cut(&self.sizes[1], y, n + 3);
                let up = cut(&self.sizes[2], y - 1, n + 2);
                for x in 0..n {
                    let twist = e1[x + 1].plus(e2[x + 2]).minus(e1[x + 2].plus(e2[x + 1])).size();
                    let near = h1[x + 1] + h2[x + 1] + v[x + 1] + v[x + 2];
                    let far = h1[x] + h1[x + 2] + h2[x] + h2[x + 2];
                    out[x] = context(7 + 5 * up[x + 1] + 4 * (up[x] + up[x + 2]) + 2 * twist + 4 * near + 3 * far);
                }
            }
        }
    }
}

/// Row `y` with its margin, cut to length so that loops over it need no bounds checks.
#[inline(always)]
fn cut<T: Copy + Default>(plane: &Plane<T>, y: isize, length: usize) -> &[T] {
    &plane.padded_row(y)[..length]
}

/// Half octaves of 1/64 of a residual, from 2^2.5 on.
#[inline(always)]
fn context(score: i32) -> u8 {
    let half_octaves = ((score as f32).to_bits() >> 22) as i32 - 2 * 127;
    (half_octaves - 5).clamp(0, CONTEXTS as i32 - 1) as u8
}

/// The scale that a context suggests.
pub(super) fn default_scale(context: usize) -> u32 {
    2 * context as u32 + 3
}
