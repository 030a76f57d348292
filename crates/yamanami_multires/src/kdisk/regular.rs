//! The update where all disks are alike: coarse vertices gather shares of the details around them, row by row.
//!
//! Inside a base triangle and along its edges the lattice goes on beyond the sides as if the surface were flat: a band of rows is copied
//! together with what lies beyond, the details that are not regular being zero, and all that remains are the same few dozen
//! products for each vertex of a row. Products and sums are taken in one order whatever the processor, and never fused, so that results are
//! the same bits everywhere.

use super::cells::{Cells, FEW, cut_off};
use super::rim::turned;
use super::sums::{ABREAST, add_sums};
use super::wheel::Tap;
use rayon::prelude::*;
use std::ops::{Range, RangeInclusive};

/// Cells that make a piece of work, if in rows enough that what is copied around them does not outweigh them.
const BAND: usize = 1024;
const LEAST_ROWS: usize = 8;

/// What the regular update must know of the mesh besides the cells.
#[derive(Debug, Clone, Copy)]
pub(super) struct Surroundings<'a> {
    pub(super) at: Cells<'a>,
    pub(super) rings: usize,
    /// For each base vertex: details with a parent within so many edges are not regular.
    pub(super) reaches: &'a [u32],
}

/// Rows of cells of a triangle, or, as a single row 0, the cells of the edge that is its side `side`.
struct Band<'a, const D: usize> {
    face: usize,
    /// Coordinates are those of the triangle turned so that this side is its first.
    side: usize,
    rows: Range<usize>,
    cells: &'a mut [[f64; D]],
}

/// A triangle turned so that one of its sides is the first, with the regular part of its details. Here coordinates are the finer lattice's:
/// `i` along that side, `j` into the triangle.
struct Sheet {
    face: usize,
    side: usize,
    along: RangeInclusive<i32>,
    across: RangeInclusive<i32>,
    /// Steps that are left to the side opposite of where the first begins.
    rest: RangeInclusive<i32>,
}

/// Working space: copied rows of the three directions of details, and the taps as offsets in them.
struct Copied<const D: usize> {
    values: Vec<[f64; D]>,
    offsets: Vec<(usize, f64)>,
}

impl Surroundings<'_> {
    /// Adds the shares of the regular details to the cells, or takes them away.
    pub(super) fn update<const D: usize>(&self, taps: &[Tap], cells: &mut [[f64; D]], details: &[[f64; D]], sign: f64) {
        // a cell takes a few dozen products
        let few = 1 + FEW / 16 / self.at.inside().clamp(1, BAND);
        self.bands(cells).par_iter_mut().with_min_len(few).for_each_init(
            || Copied { values: Vec::new(), offsets: Vec::new() },
            |copied, band| self.gather(taps, band, copied, details, sign),
        );
    }

    fn bands<'a, const D: usize>(&self, cells: &'a mut [[f64; D]]) -> Vec<Band<'a, D>> {
        let size = self.at.size;
        let (on_edges, inside) = self.at.sections();
        let (edges, faces) = cells[on_edges..].split_at_mut(inside - on_edges);
        let mut bands = Vec::new();
        for (edge, cells) in self.at.base.edges().iter().zip(edges.chunks_exact_mut(size - 1)) {
            bands.push(Band { face: edge.left.0 as usize, side: usize::from(edge.left.1), rows: 0..1, cells });
        }
        for (face, mut rest) in faces.chunks_exact_mut(self.at.inside()).enumerate() {
            let mut begin = 1;
            while begin < size - 1 {
                let (mut end, mut count) = (begin, 0);
                while end < size - 1 && (count < BAND || end - begin < LEAST_ROWS) {
                    count += size - 1 - end;
                    end += 1;
                }
                bands.push(Band { face, side: 0, rows: begin..end, cells: cut_off(&mut rest, count) });
                begin = end;
            }
        }
        bands
    }

    fn sheet(&self, face: usize, side: usize) -> Sheet {
        let size = 2 * self.at.size as i32;
        let near = 2 * self.rings as i32 + 2;
        let range = |corner: usize| {
            let is_border = self.at.base.beyond(face as u32, (corner as u8 + 1) % 3).is_none();
            let reach = self.reaches[self.at.base.triangles()[face][corner] as usize] as i32;
            (if is_border { near } else { 0 })..=size - 2 * reach - 2
        };
        Sheet { face, side, along: range((side + 1) % 3), across: range((side + 2) % 3), rest: range(side) }
    }

    fn gather<const D: usize>(
        &self,
        taps: &[Tap],
        band: &mut Band<'_, D>,
        copied: &mut Copied<D>,
        details: &[[f64; D]],
        sign: f64,
    ) {
        let halo = self.rings + 1;
        let window = Window {
            halo: halo as i32,
            first: band.rows.start as i32 - halo as i32,
            height: band.rows.len() + 2 * halo - 1,
            width: self.at.size - band.rows.start + 2 * halo,
        };
        // sums are taken beyond the end of a row, and thrown away
        let count = 3 * window.height * window.width + ABREAST;
        copied.values.resize(count, [0.0; D]);
        copied.values.as_flattened_mut().fill(0.0);
        for direction in 0..3 {
            self.copy(band, direction, window, details, &mut copied.values[direction * window.height * window.width..]);
        }
        copied.offsets.clear();
        copied.offsets.extend(taps.iter().map(|tap| {
            let [row, column] = [tap.y, tap.x].map(|v| (v + halo as i32) as usize);
            (((tap.direction * window.height + row) * window.width + column) * D, tap.share)
        }));
        let mut rest = &mut *band.cells;
        for row in 0..band.rows.len() {
            let own = cut_off(&mut rest, self.at.size - 1 - band.rows.start - row);
            let from = copied.values[row * window.width + 1..].as_flattened();
            add_sums(own.as_flattened_mut(), from, &copied.offsets, sign);
        }
    }

    /// Copies the regular details of a direction: those of the band's triangle row by row, and line by line those on its sides and beyond.
    fn copy<const D: usize>(
        &self,
        band: &Band<'_, D>,
        direction: usize,
        window: Window,
        details: &[[f64; D]],
        values: &mut [[f64; D]],
    ) {
        let Window { halo, first, height, width } = window;
        let (size, rings) = (2 * self.at.size as i32, self.rings as i32);
        let [odd_i, odd_j] = [i32::from(direction != 2), i32::from(direction != 0)];
        let last = first + height as i32 - 1;
        // where a place of the triangle's fine lattice is in the window
        let index = |i: i32, j: i32| {
            let [x, y] = [(i - odd_i) >> 1, (j - odd_j) >> 1];
            ((y - first) * width as i32 + x + halo) as isize
        };
        let own = self.sheet(band.face, band.side);
        for y in first.max(0)..=last.min(self.at.size as i32 - 1) {
            let j = 2 * y + odd_j;
            if j > 0 {
                let line = Line { j, parity: odd_i, from: 0, to: size };
                own.copy(self.at, line, details, values, |i| index(i, j), 1);
            }
        }
        let beyond = |side: usize| {
            let (face, side) = self.at.base.beyond(band.face as u32, ((band.side + side) % 3) as u8)?;
            Some(self.sheet(face as usize, usize::from(side)))
        };
        // each triangle beyond is the own one turned by 180° about the middle of the side
        if first <= 0
            && let Some(sheet) = beyond(0)
        {
            for j in (first.max(-halo)..=0).map(|y| 2 * y + odd_j).filter(|j| *j <= 0) {
                let line = Line { j: -j, parity: odd_i, from: 0, to: size };
                sheet.copy(self.at, line, details, values, |i| index(size - i, j), -1);
            }
        }
        if band.rows.start == 0 {
            // what lies beyond the ends of an edge is not within reach of its cells, or not regular
            return;
        }
        let parity = odd_i ^ odd_j;
        if let Some(sheet) = beyond(1) {
            for over in (parity..2 * rings).step_by(2) {
                let fits = 2 * (width as i32 - halo - 1) + odd_i - over;
                let (from, to) = (size - 2 * last - odd_j, (size - 2 * first - odd_j).min(fits));
                let line = Line { j: over, parity: odd_j, from, to };
                sheet.copy(self.at, line, details, values, |i| index(i + over, size - i), 1 - width as isize);
            }
        }
        if let Some(sheet) = beyond(2) {
            for over in (odd_i..2 * rings).step_by(2) {
                let line = Line { j: over, parity, from: 2 * first + odd_j - over, to: 2 * last + odd_j - over };
                sheet.copy(self.at, line, details, values, |i| index(-over, i + over), width as isize);
            }
        }
    }
}

/// Copied rows: from lattice row `first` on `height` of them, each `width` wide and beginning `halo` before the triangle.
#[derive(Debug, Clone, Copy)]
struct Window {
    halo: i32,
    first: i32,
    height: usize,
    width: usize,
}

/// Every other place of a line of a sheet, those with `i` of a parity, from one to another.
struct Line {
    j: i32,
    parity: i32,
    from: i32,
    to: i32,
}

impl Sheet {
    /// Copies the regular details of a line to where `place` says that the first one goes, and on in equal steps.
    #[inline(always)]
    fn copy<const D: usize>(
        &self,
        at: Cells<'_>,
        line: Line,
        details: &[[f64; D]],
        to: &mut [[f64; D]],
        place: impl Fn(i32) -> isize,
        step: isize,
    ) {
        let Line { j, parity, .. } = line;
        if !self.across.contains(&j) {
            return;
        }
        let size = 2 * at.size as i32;
        let from = line.from.max(1).max(*self.along.start()).max(size - j - self.rest.end());
        let last = line.to.min(size - j - 1).min(*self.along.end()).min(size - j - self.rest.start());
        let from = from + ((from ^ parity) & 1);
        if from > last {
            return;
        }
        let count = ((last - from) / 2 + 1) as usize;
        let detail = |i: i32| at.detail(self.face, turned(size as usize, self.side as u8, [i as usize, j as usize]));
        let (mut source, mut target) = (detail(from), place(from));
        if self.side == 0 && j > 0 && step == 1 {
            to[target as usize..][..count].copy_from_slice(&details[source..source + count]);
            return;
        }
        let mut stride = if count > 1 { detail(from + 2) as isize - source as isize } else { 0 };
        // rows get shorter one by one
        let turn = if self.side == 0 || j == 0 { 0 } else { -1 };
        for _ in 0..count {
            to[target as usize] = details[source];
            source = source.wrapping_add_signed(stride);
            target += step;
            stride += turn;
        }
    }
}
