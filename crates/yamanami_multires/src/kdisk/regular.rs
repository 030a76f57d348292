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

/// Cells that make a piece of work.
const BAND: usize = 2048;

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

/// A triangle and those beyond its sides.
struct Sheets {
    own: Sheet,
    beyond: [Option<Sheet>; 3],
}

/// Working space: copied rows of the three directions of details, and the taps as offsets in them.
struct Copied<const D: usize> {
    values: Vec<[f64; D]>,
    offsets: Vec<(usize, f64)>,
}

impl Surroundings<'_> {
    /// Adds the shares of the regular details to the cells, or takes them away.
    pub(super) fn update<const D: usize>(&self, taps: &[Tap], cells: &mut [[f64; D]], details: &[[f64; D]], sign: f64) {
        let few = 1 + FEW / self.at.inside().clamp(1, BAND);
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
                while end < size - 1 && count < BAND {
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
        let height = band.rows.len() + 2 * halo - 1;
        let width = self.at.size - band.rows.start + 2 * halo;
        // sums are taken beyond the end of a row, and thrown away
        copied.values.resize(3 * height * width + ABREAST, [0.0; D]);
        let sheets = Sheets {
            own: self.sheet(band.face, band.side),
            beyond: [0, 1, 2].map(|k| {
                let (face, side) = self.at.base.beyond(band.face as u32, ((band.side + k) % 3) as u8)?;
                Some(self.sheet(face as usize, usize::from(side)))
            }),
        };
        let mut rows = copied.values.chunks_exact_mut(width);
        for direction in 0..3 {
            for (y, row) in (band.rows.start as i32 - halo as i32..).zip(rows.by_ref().take(height)) {
                row.fill([0.0; D]);
                self.copy_row(&sheets, [direction, y], band.rows.start > 0, details, row);
            }
        }
        copied.offsets.clear();
        copied.offsets.extend(taps.iter().map(|tap| {
            let [row, column] = [tap.y, tap.x].map(|v| (v + halo as i32) as usize);
            (((tap.direction * height + row) * width + column) * D, tap.share)
        }));
        let mut rest = &mut *band.cells;
        for row in 0..band.rows.len() {
            let own = cut_off(&mut rest, self.at.size - 1 - band.rows.start - row);
            add_sums(own.as_flattened_mut(), copied.values[row * width + 1..].as_flattened(), &copied.offsets, sign);
        }
    }

    /// The details of a direction along lattice row `y`, from x = −rings − 1 on, as far as they are regular. What lies beyond the ends of
    /// a row is only within reach of inner cells.
    fn copy_row<const D: usize>(
        &self,
        sheets: &Sheets,
        [direction, y]: [i32; 2],
        is_inner: bool,
        details: &[[f64; D]],
        row: &mut [[f64; D]],
    ) {
        row.fill([0.0; D]);
        let [size, rings] = [2 * self.at.size, self.rings].map(|v| v as i32);
        let halo = rings + 1;
        let (odd, j) = (i32::from(direction != 2), 2 * y + i32::from(direction != 0));
        // in the row, i = 2 x + odd
        let xs = |from: i32, to: i32| (from - odd + 1).div_euclid(2)..(to - odd).div_euclid(2) + 1;
        let end = row.len() as i32 - halo;
        let place = |sheet: &Sheet, i: i32, j: i32| {
            let at = turned(size as usize, sheet.side as u8, [i as usize, j as usize]);
            self.at.detail(sheet.face, at)
        };
        let mut copy = |x: i32, sheet: &Sheet, i: i32, j: i32| row[(x + halo) as usize] = details[place(sheet, i, j)];
        let Sheets { own, beyond } = sheets;
        if j < 0 {
            let Some(sheet) = &beyond[0] else { return };
            let (from, to) = sheet.inside(size, -j);
            for x in xs(size - to, size - from) {
                copy(x, sheet, size - (2 * x + odd), -j);
            }
            return;
        }
        let (from, to) = own.inside(size, j);
        let inner = xs(from, to);
        if is_inner && j > 0 && !inner.is_empty() {
            let from = place(own, 2 * inner.start + odd, j);
            let count = inner.len();
            row[(inner.start + halo) as usize..][..count].copy_from_slice(&details[from..from + count]);
        } else {
            for x in inner {
                copy(x, own, 2 * x + odd, j);
            }
        }
        if !is_inner || j == 0 || j >= size {
            return;
        }
        let mut copy = |x: i32, sheet: Option<&Sheet>, i: i32, j: i32| {
            if let Some(sheet) = sheet.filter(|sheet| sheet.holds(size, i, j)) {
                row[(x + halo) as usize] = details[place(sheet, i, j)];
            }
        };
        for x in xs(1 - 2 * rings, 0) {
            match 2 * x + odd {
                0 => copy(x, Some(own), 0, j),
                i => copy(x, beyond[2].as_ref(), i + j, -i),
            }
        }
        let right = xs(size - j, size - j + 2 * rings - 1);
        for x in right.start..right.end.min(end) {
            match 2 * x + odd + j - size {
                0 => copy(x, Some(own), size - j, j),
                over => copy(x, beyond[1].as_ref(), size - j, over),
            }
        }
    }
}

impl Sheet {
    /// The first and last place along line `j`, sides aside, between which details are regular.
    fn inside(&self, size: i32, j: i32) -> (i32, i32) {
        if !self.across.contains(&j) {
            return (1, 0);
        }
        let from = (*self.along.start()).max(1).max(size - j - self.rest.end());
        let to = (*self.along.end()).min(size - j - 1).min(size - j - self.rest.start());
        (from, to)
    }

    fn holds(&self, size: i32, i: i32, j: i32) -> bool {
        self.along.contains(&i) && self.across.contains(&j) && self.rest.contains(&(size - i - j))
    }
}
