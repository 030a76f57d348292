//! No-data: filled heights for the lattice to stand on, and which triangles hold data.
//!
//! A finest triangle is shown when all three of its samples have data. A coarser one is shown when anything below it
//! is, so that every sample that can be shown is covered at every level; where it also covers a hole, its error says so.

use rayon::prelude::*;
use yamanami_core::{HeightField, Lattice};

/// Which triangles of every level hold data, and which hold nothing but data.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Holes {
    /// By level, row by row of squares: bits 0 / 1: the upper right / lower left half
    /// holds data; bits 2 / 3: it holds nothing else.
    squares: Vec<Vec<u8>>,
    columns: Vec<usize>,
}

impl Holes {
    /// Finds the holes of a grid; `None` when there are none.
    pub(crate) fn of(field: &HeightField, lattice: &Lattice) -> Option<Self> {
        if field.heights_m().iter().all(|z| !z.is_nan()) {
            return None;
        }
        let [nx, ny] = lattice.squares(0).map(|n| n as usize);
        let mut finest = vec![0u8; nx * ny];
        finest.par_chunks_mut(nx).enumerate().for_each(|(y, row)| {
            for (x, square) in row.iter_mut().enumerate() {
                let data = |dx: usize, dy: usize| !field.at(x + dx, y + dy).is_nan();
                let diagonal = data(0, 0) && data(1, 1);
                *square = (u8::from(diagonal && data(1, 0)) * 0b0101) | (u8::from(diagonal && data(0, 1)) * 0b1010);
            }
        });
        let (mut squares, mut columns) = (vec![finest], vec![nx]);
        for level in 1..=lattice.levels() {
            let [nx, ny] = lattice.squares(level).map(|n| n as usize);
            let (below, below_columns) = (&squares[level as usize - 1], columns[level as usize - 1]);
            let below_rows = below.len() / below_columns;
            let at = |x: usize, y: usize| {
                // a square past the border folds to nothing: shows nothing, hides nothing
                if x < below_columns && y < below_rows { below[y * below_columns + x] } else { 0b1100 }
            };
            let mut coarse = vec![0u8; nx * ny];
            coarse.par_chunks_mut(nx).enumerate().for_each(|(y, row)| {
                for (x, square) in row.iter_mut().enumerate() {
                    let (nw, ne, sw, se) =
                        (at(2 * x, 2 * y), at(2 * x + 1, 2 * y), at(2 * x, 2 * y + 1), at(2 * x + 1, 2 * y + 1));
                    // the upper right half holds both halves of ne and the upper right ones of nw and se
                    let (any, all) = ((nw | se) & 0b11, nw & se & 0b1100);
                    let any = (any & 1 | u8::from(ne & 0b11 != 0)) & 1 | (any & 2 | u8::from(sw & 0b11 != 0) << 1) & 2;
                    let all =
                        (all & (u8::from(ne & 0b1100 == 0b1100) << 2)) | (all & (u8::from(sw & 0b1100 == 0b1100) << 3));
                    // a clamped square's diagonal bends as it is refined: neither half covers the square's samples alone
                    let past = |k: usize, size: u32| (k + 1) << level > size as usize - 1;
                    let bends = past(x, lattice.width()) || past(y, lattice.height());
                    *square = if bends && any != 0 { 0b11 | all } else { any | all };
                }
            });
            squares.push(coarse);
            columns.push(nx);
        }
        Some(Self { squares, columns })
    }

    /// Whether no triangle at all is left.
    pub(crate) fn is_empty(&self) -> bool {
        self.squares.last().is_none_or(|base| base.iter().all(|b| b & 0b11 == 0))
    }

    /// Whether a half of a square holds data.
    #[inline]
    pub(crate) fn shown(&self, level: u32, x: u32, y: u32, half: u32) -> bool {
        self.bits(level, x, y) >> half & 1 == 1
    }

    /// Whether a half holds data only.
    #[inline]
    pub(crate) fn whole(&self, level: u32, x: u32, y: u32, half: u32) -> bool {
        self.bits(level, x, y) >> (2 + half) & 1 == 1
    }

    #[inline]
    pub(crate) fn bits(&self, level: u32, x: u32, y: u32) -> u8 {
        let level = level as usize;
        self.squares[level][y as usize * self.columns[level] + x as usize]
    }
}

/// Gives samples without data the height of some sample near by: one of the data's own heights, so that a grid of whole
/// metres stays one.
pub(crate) fn fill(heights_m: &mut [f32], width: usize, height: usize) {
    if heights_m.iter().all(|z| !z.is_nan()) {
        return;
    }
    let (coarse_width, coarse_height) = (width.div_ceil(2), height.div_ceil(2));
    let mut coarse: Vec<f32> = vec![f32::NAN; coarse_width * coarse_height];
    coarse.par_chunks_mut(coarse_width).enumerate().for_each(|(y, row)| {
        for (x, middle) in row.iter_mut().enumerate() {
            let (mut near, mut count) = ([0f32; 4], 0);
            for j in 2 * y..(2 * y + 2).min(height) {
                for i in 2 * x..(2 * x + 2).min(width) {
                    let z = heights_m[j * width + i];
                    if !z.is_nan() {
                        near[count] = z;
                        count += 1;
                    }
                }
            }
            near[..count].sort_unstable_by(f32::total_cmp);
            if count > 0 {
                *middle = near[count / 2];
            }
        }
    });
    if coarse.len() > 1 {
        fill(&mut coarse, coarse_width, coarse_height);
    }
    heights_m.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        for (x, z) in row.iter_mut().enumerate() {
            if z.is_nan() {
                *z = coarse[y / 2 * coarse_width + x / 2];
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use yamanami_core::GeoReference;

    #[test]
    fn one_missing_sample_hides_six_triangles() {
        let (w, h) = (9, 9);
        let mut z = vec![1.0; w * h];
        z[4 * w + 4] = f32::NAN;
        let field = HeightField::new(w, h, z, GeoReference::local([1.0, 1.0], h));
        let lattice = Lattice::new(w, h);
        let holes = Holes::of(&field, &lattice).unwrap();
        let hidden: u32 = holes.squares[0].iter().map(|b| 2 - (b & 3).count_ones()).sum();
        assert_eq!(hidden, 6);
        assert!(holes.shown(3, 0, 0, 0) && holes.shown(3, 0, 0, 1));
        assert!(!holes.whole(3, 0, 0, 0) && !holes.whole(3, 0, 0, 1));
    }

    #[test]
    fn filling_reaches_every_sample_and_keeps_data() {
        let (w, h) = (37, 21);
        let mut z: Vec<f32> = vec![f32::NAN; w * h];
        z[5] = 7.0;
        z[400] = 9.0;
        fill(&mut z, w, h);
        assert!(z.iter().all(|z| (7.0..=9.0).contains(z)));
        assert_eq!((z[5], z[400]), (7.0, 9.0));
    }
}
