//! A page as bytes: its layout, and the way there and back.
//!
//! Layout: a head byte (bit 0: base level; bits 1-2: errors none / as steps / as exceptions; bits 3-4: triangles all
//! shown without being stored / none shown / stored), the lengths of heights and errors (varints), heights, errors, shown.
//! See `docs/format.md`.

use super::bits::{put_varint, take, take_varint, unzigzag, zigzag};
use super::error_steps;
use super::errors::{self, Ground, Steps};
use super::heights;
use super::model::{Extent, Height, Planes};
use super::quantum::Quantum;
use super::shown;
use crate::IoError;
use yamanami_core::{ErrorCode, Lattice, PAGE_CELLS, PageId, TerrainPage};

/// Ranges above this many quanta need 64-bit arithmetic.
const NARROW_RANGE: i64 = 1 << 20;

const ERRORS_NONE: u8 = 0;
const ERRORS_STEPS: u8 = 1;
const ERRORS_EXCEPTIONS: u8 = 2;
const SHOWN_ALL: u8 = 0;
const SHOWN_NONE: u8 = 1;
const SHOWN_STORED: u8 = 2;

/// How the pages of a file are coded: all that a page's bytes leave out. Cheap to copy to every thread.
#[derive(Debug, Clone, PartialEq)]
pub struct PageCodec {
    lattice: Lattice,
    quantum: Quantum,
    has_holes: bool,
    steps: Steps,
    level0_slack_m: f32,
}

/// A page ready to be stored.
#[derive(Debug, Clone, PartialEq)]
pub struct EncodedPage {
    pub(super) id: PageId,
    pub(super) bytes: Vec<u8>,
    pub(super) z_range_m: [f32; 2],
}

impl EncodedPage {
    /// The page's place.
    pub fn id(&self) -> PageId {
        self.id
    }

    /// The coded bytes.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

impl PageCodec {
    /// A codec for the pages of a grid of `size` (columns, rows).
    ///
    /// `error_steps_per_octave` is a power of two up to 2048: how finely error codes above level 0 are kept (they are
    /// rounded up; 2048 keeps them exactly). `level0_slack_m` is what the builder adds to a level-0 detail to get its error.
    pub fn new(
        size: [u32; 2],
        quantum: Quantum,
        has_holes: bool,
        error_steps_per_octave: u32,
        level0_slack_m: f32,
    ) -> Result<Self, IoError> {
        if size[0] < 2 || size[1] < 2 {
            return Err(bad("size of the grid", "at least 2x2 samples", format!("{}x{}", size[0], size[1])));
        }
        let steps = Steps::new(error_steps_per_octave).ok_or_else(|| {
            bad("error steps per octave", "a power of two up to 2048", error_steps_per_octave.to_string())
        })?;
        if !quantum.is_sound() {
            return Err(bad("quantum", "1 to 16777216 a metre, or a step of 1e-9 to 1e6 m", format!("{quantum:?}")));
        }
        if !(0.0..1e6).contains(&level0_slack_m) {
            return Err(bad("slack of level-0 errors", "0 to 1e6 m", format!("{level0_slack_m} m")));
        }
        let lattice = Lattice::new(size[0] as usize, size[1] as usize);
        Ok(Self { lattice, quantum, has_holes, steps, level0_slack_m })
    }

    /// The lattice of the grid.
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// Which heights the file holds.
    pub fn quantum(&self) -> Quantum {
        self.quantum
    }

    /// Points (columns, rows) of a page; `None` when there is no such page.
    pub fn page_points(&self, id: PageId) -> Option<[u32; 2]> {
        if id.level > self.lattice.levels() {
            return None;
        }
        let [nx, ny] = self.lattice.squares(id.level);
        let side = |squares: u32, tile: u32| {
            let left = squares.checked_sub(tile.checked_mul(PAGE_CELLS)?).filter(|&n| n > 0)?;
            Some(left.min(PAGE_CELLS) + 1)
        };
        Some([side(nx, id.x)?, side(ny, id.y)?])
    }

    /// Pages (columns, rows) of a level up to `levels()`.
    pub fn pages(&self, level: u32) -> [u32; 2] {
        self.lattice.squares(level.min(self.lattice.levels())).map(|n| n.div_ceil(PAGE_CELLS))
    }

    /// The page that holds a page's even points, one level coarser; `None` on the base level.
    pub fn parent(&self, id: PageId) -> Option<PageId> {
        (id.level < self.lattice.levels()).then(|| PageId { level: id.level + 1, x: id.x / 2, y: id.y / 2 })
    }

    /// The code that an error code of a level is read back as: on level 0 itself, else one that is not below it.
    pub fn stored_code(&self, level: u32, code: ErrorCode) -> ErrorCode {
        if level == 0 { code } else { self.steps.ceil(code) }
    }

    /// Codes a page. Pure: pages can be coded on any thread, in any order.
    ///
    /// The page's even points are not stored: they must be what the coarser page has there.
    pub fn encode_page(&self, page: &TerrainPage) -> Result<EncodedPage, IoError> {
        let id = page.id;
        let name = format!("page {} / {} / {}", id.level, id.x, id.y);
        let [width, height] =
            self.page_points(id).ok_or_else(|| bad(&name, "a place on the lattice", "one outside it".into()))?;
        let points = (width * height) as usize;
        let squares = ((width - 1) * (height - 1)) as usize;
        if [page.width, page.height] != [width, height]
            || page.heights_m.len() != points
            || page.errors.len() != points
            || page.shown.len() != if self.has_holes { squares } else { 0 }
        {
            let given = format!(
                "{}x{} with {} heights, {} errors, {} squares",
                page.width,
                page.height,
                page.heights_m.len(),
                page.errors.len(),
                page.shown.len()
            );
            return Err(bad(&name, &format!("{width}x{height} points"), given));
        }
        let indices = self
            .quantum
            .indices(&page.heights_m)
            .map_err(|z| bad(&name, &format!("heights on the quantum {:?}", self.quantum), format!("{z} m")))?;
        let is_base = id.level == self.lattice.levels();
        let height_bytes =
            if is_base { encode_base(&indices) } else { encode_new_points(&indices, width as usize, height as usize) };
        let ground =
            Ground { width: width as usize, height: height as usize, heights_m: &page.heights_m, shown: &page.shown };
        let (error_kind, error_bytes) = match id.level {
            _ if is_base => (ERRORS_NONE, Vec::new()),
            0 => self.encode_level0(ground, &page.errors),
            _ => (ERRORS_STEPS, error_steps::encode(ground, self.steps, &page.errors)),
        };
        let (shown_kind, shown_bytes) = if page.shown.iter().all(|&s| s & 3 == 3) {
            (SHOWN_ALL, Vec::new())
        } else if page.shown.iter().all(|&s| s & 3 == 0) {
            (SHOWN_NONE, Vec::new())
        } else {
            (SHOWN_STORED, shown::encode(&page.shown, width as usize - 1))
        };
        let mut bytes = vec![u8::from(is_base) | error_kind << 1 | shown_kind << 3];
        put_varint(&mut bytes, height_bytes.len() as u64);
        put_varint(&mut bytes, error_bytes.len() as u64);
        bytes.extend(height_bytes);
        bytes.extend(error_bytes);
        bytes.extend(shown_bytes);
        let z_range_m = range_of(&indices).map(|i| self.quantum.height_m(i));
        Ok(EncodedPage { id, bytes, z_range_m })
    }

    /// Error codes of level 0, exactly: neighbouring pages must agree on the points they share.
    fn encode_level0(&self, ground: Ground<'_>, codes: &[ErrorCode]) -> (u8, Vec<u8>) {
        let mut exceptions = errors::encode_exceptions(ground, codes, 0.0);
        if self.level0_slack_m > 0.0 {
            let other = errors::encode_exceptions(ground, codes, self.level0_slack_m);
            exceptions = if other.len() < exceptions.len() { other } else { exceptions };
        }
        if exceptions.len() > codes.len() {
            let all = error_steps::encode(ground, Steps::EXACT, codes);
            if all.len() < exceptions.len() {
                return (ERRORS_STEPS, all);
            }
        }
        (ERRORS_EXCEPTIONS, exceptions)
    }

    /// Reads a page from its bytes and its coarser page; says what is wrong when it cannot be that.
    ///
    /// Safe on any bytes: never panics, and allocates no more than a page takes.
    pub fn decode_page(
        &self,
        id: PageId,
        bytes: &[u8],
        parent: Option<&TerrainPage>,
    ) -> Result<TerrainPage, &'static str> {
        let [width, height] = self.page_points(id).ok_or("no such page")?;
        let mut rest = bytes;
        let (&head, tail) = rest.split_first().ok_or("no bytes")?;
        rest = tail;
        let lengths = (take_varint(&mut rest), take_varint(&mut rest));
        let (Some(height_length), Some(error_length)) = lengths else { return Err("the lengths break off") };
        let mut part = |length: u64| usize::try_from(length).ok().and_then(|n| take(&mut rest, n));
        let height_bytes = part(height_length).ok_or("the heights break off")?;
        let error_bytes = part(error_length).ok_or("the errors break off")?;
        let is_base = id.level == self.lattice.levels();
        if head >> 5 != 0 || (head & 1 == 1) != is_base {
            return Err("the head byte is not of this level");
        }
        let (columns, rows) = (width as usize, height as usize);
        let heights_m = match parent {
            Some(parent) if !is_base => {
                let even = self.even_indices(id, [width, height], parent).ok_or("the coarser page does not fit")?;
                decode_new_points(&even, columns, rows, height_bytes, self.quantum)
            }
            None if is_base => decode_base(columns * rows, height_bytes, self.quantum),
            _ => return Err("the coarser page is missing"),
        };
        let heights_m = heights_m.ok_or("the heights are damaged")?;
        let squares = (columns - 1) * (rows - 1);
        let shown = match head >> 3 & 3 {
            SHOWN_ALL if self.has_holes => vec![3; squares],
            SHOWN_ALL => Vec::new(),
            SHOWN_NONE if self.has_holes => vec![0; squares],
            SHOWN_STORED if self.has_holes => {
                shown::decode(rest, columns - 1, squares).ok_or("the holes are damaged")?
            }
            _ => return Err("there are holes in a surface without any"),
        };
        let ground = Ground { width: columns, height: rows, heights_m: &heights_m, shown: &shown };
        let errors = match head >> 1 & 3 {
            ERRORS_NONE if is_base => Some(vec![ErrorCode(0); columns * rows]),
            ERRORS_STEPS if !is_base => {
                let steps = if id.level == 0 { Steps::EXACT } else { self.steps };
                error_steps::decode(ground, steps, error_bytes)
            }
            ERRORS_EXCEPTIONS if id.level == 0 && !is_base => errors::decode_exceptions(ground, error_bytes),
            _ => None,
        };
        let errors = errors.ok_or("the errors are damaged")?;
        Ok(TerrainPage { id, width, height, heights_m, errors, shown })
    }

    /// Integers of the even points: one more column and row than squares of the coarser page covered.
    fn even_indices(&self, id: PageId, points: [u32; 2], parent: &TerrainPage) -> Option<Vec<i32>> {
        if self.parent(id) != Some(parent.id) || self.page_points(parent.id) != Some([parent.width, parent.height]) {
            return None;
        }
        let [x0, y0] = [id.x % 2, id.y % 2].map(|odd| odd * PAGE_CELLS / 2);
        let [columns, rows] = points.map(|n| n / 2 + 1);
        let row = |y: u32| ((y0 + y) * parent.width + x0) as usize;
        let mut heights_m = Vec::with_capacity((columns * rows) as usize);
        for y in 0..rows {
            heights_m.extend_from_slice(parent.heights_m.get(row(y)..row(y) + columns as usize)?);
        }
        self.quantum.indices(&heights_m).ok()
    }
}

fn bad(what: &str, expected: &str, given: String) -> IoError {
    IoError::BadRequest { what: what.into(), expected: expected.into(), given }
}

/// The base level: differences from point to point.
fn encode_base(indices: &[i32]) -> Vec<u8> {
    let mut out = Vec::new();
    let mut last = 0i64;
    for &index in indices {
        put_varint(&mut out, zigzag(i64::from(index) - last));
        last = i64::from(index);
    }
    out
}

fn decode_base(count: usize, mut bytes: &[u8], quantum: Quantum) -> Option<Vec<f32>> {
    let mut last = 0i64;
    let mut indices = Vec::with_capacity(count);
    for _ in 0..count {
        last = last.checked_add(unzigzag(take_varint(&mut bytes)?))?;
        indices.push(i32::try_from(last).ok()?);
    }
    let mut heights_m = Vec::with_capacity(count);
    quantum.extend_heights(&indices, &mut heights_m)?;
    bytes.is_empty().then_some(heights_m)
}

/// Least and greatest.
fn range_of(indices: &[i32]) -> [i32; 2] {
    indices.iter().fold([i32::MAX, i32::MIN], |[low, high], &i| [low.min(i), high.max(i)])
}

fn encode_new_points(indices: &[i32], width: usize, height: usize) -> Vec<u8> {
    let [low, high] = range_of(indices);
    let extent = Extent::of(width as u32, height as u32);
    if i64::from(high) - i64::from(low) < NARROW_RANGE {
        i32::with_scratch(|planes| {
            split(planes, indices, width, extent, low);
            heights::encode(planes, extent, low, false)
        })
    } else {
        i64::with_scratch(|planes| {
            split(planes, indices, width, extent, 0);
            heights::encode(planes, extent, 0, true)
        })
    }
}

/// Splits a page into its planes, relative to `base`; where the grid ends between lattice columns or rows, the next even one
/// takes the last one's place.
fn split<T: Height>(planes: &mut Planes<T>, indices: &[i32], width: usize, extent: Extent, base: i32) {
    planes.reset(extent);
    let last = indices.len() / width - 1;
    let at = |v: i32| T::of(v).minus(T::of(base));
    for y in 0..=2 * extent.ny {
        let row = &indices[y.min(last) * width..][..width];
        let (even, odd) = if y % 2 == 0 { (&mut planes.e, &mut planes.h) } else { (&mut planes.v, &mut planes.d) };
        let (even, odd) = (even.row_mut(y / 2), odd.row_mut(y / 2));
        for ((e, o), pair) in even.iter_mut().zip(odd).zip(row.as_chunks::<2>().0) {
            (*e, *o) = (at(pair[0]), at(pair[1]));
        }
        even[extent.nx] = at(row[width - 1]);
    }
}

/// The heights of a page from its even points' integers and its bytes.
fn decode_new_points(
    even: &[i32],
    width: usize,
    height: usize,
    mut bytes: &[u8],
    quantum: Quantum,
) -> Option<Vec<f32>> {
    let (presets, base) = heights::decode_head(&mut bytes)?;
    if presets & 1 == 0 {
        decode_with::<i32>(even, width, height, presets, base, bytes, quantum)
    } else {
        decode_with::<i64>(even, width, height, presets, base, bytes, quantum)
    }
}

fn decode_with<T: Height>(
    even: &[i32],
    width: usize,
    height: usize,
    presets: u8,
    base: i32,
    bytes: &[u8],
    quantum: Quantum,
) -> Option<Vec<f32>> {
    let extent = Extent::of(width as u32, height as u32);
    T::with_scratch(|planes| {
        planes.reset(extent);
        for (y, row) in even.chunks_exact(extent.nx + 1).enumerate() {
            for (e, &index) in planes.e.row_mut(y).iter_mut().zip(row) {
                *e = T::of(index).minus(T::of(base));
            }
        }
        heights::decode(planes, extent, presets, bytes)?;
        let mut heights_m = Vec::with_capacity(width * height);
        let mut indices = [0i32; PAGE_CELLS as usize + 2];
        for y in 0..height {
            let (even, odd) = if y % 2 == 0 { (&planes.e, &planes.h) } else { (&planes.v, &planes.d) };
            let (even, odd) = (even.row(y / 2), odd.row(y / 2));
            for ((pair, &e), &o) in indices.as_chunks_mut::<2>().0.iter_mut().zip(even).zip(odd) {
                *pair = [e, o].map(|v| v.low32().wrapping_add(base));
            }
            if width % 2 == 1 {
                indices[width - 1] = even[width / 2].low32().wrapping_add(base);
            }
            quantum.extend_heights(&indices[..width], &mut heights_m)?;
        }
        Some(heights_m)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_base_level_comes_back() {
        let heights_m = [5.0, -3.25, 3.0e38, -0.0, 0.0];
        let indices = Quantum::Bits.indices(&heights_m).unwrap();
        let bytes = encode_base(&indices);
        assert_eq!(decode_base(5, &bytes, Quantum::Bits).as_deref(), Some(&heights_m[..]));
        assert_eq!(decode_base(4, &bytes, Quantum::Bits), None);
    }
}
