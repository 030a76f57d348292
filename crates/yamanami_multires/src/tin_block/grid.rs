//! Rectangular blocks over the plan, and the lines between them.
//!
//! Based on: Hiraoka, Yamada, Urahama, "A fast drawing method of TINs for three-dimensional GIS", APA, 2005, section 3.1.

use crate::MultiresError;
use glam::{DVec2, DVec3};

/// Most blocks of a grid.
pub const MOST_BLOCKS: u64 = 1 << 20;

/// Rectangular blocks of one size. Those at the rim of the grid hold all that lies beyond them too.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockGrid {
    /// Columns and rows.
    count: [usize; 2],
    /// West to east, and south to north: the borders of the columns and of the rows, outer ones included.
    lines_m: [Vec<f64>; 2],
}

impl BlockGrid {
    /// `count` columns and rows of blocks of `size_m` metres, from the south-west corner `origin_m` on.
    pub fn new(origin_m: DVec2, size_m: DVec2, count: [usize; 2]) -> Result<Self, MultiresError> {
        let blocks = count[0] as u64 * count[1] as u64;
        if blocks == 0 || blocks > MOST_BLOCKS {
            return Err(MultiresError::TooManyBlocks { what: "blocks", count: blocks, most: MOST_BLOCKS });
        }
        let lines =
            |axis: usize| -> Vec<f64> { (0..=count[axis]).map(|i| origin_m[axis] + i as f64 * size_m[axis]).collect() };
        let lines_m = [lines(0), lines(1)];
        // a size that is not positive, not a number, or lost in the coordinates
        if let Some(line) = lines_m
            .iter()
            .flat_map(|l| l.windows(2))
            .find(|pair| pair[0].total_cmp(&pair[1]).is_ge() || !(pair[1] - pair[0]).is_finite())
        {
            return Err(MultiresError::BadBlocks { borders_m: [line[0], line[1]] });
        }
        Ok(Self { count, lines_m })
    }

    /// The blocks of `size_m` metres that cover a box in plan, from its south-west corner on.
    pub fn covering(bounds: &yamanami_core::Aabb, size_m: f64) -> Result<Self, MultiresError> {
        let extent = (bounds.max - bounds.min).truncate();
        let count =
            [extent.x, extent.y].map(|extent| (extent / size_m).ceil().clamp(1.0, MOST_BLOCKS as f64 + 1.0) as usize);
        Self::new(bounds.min.truncate(), DVec2::splat(size_m), count)
    }

    /// Columns and rows.
    pub fn count(&self) -> [usize; 2] {
        self.count
    }

    /// Columns times rows. A block's number is `row · columns + column`, rows from the south.
    pub fn len(&self) -> usize {
        self.count[0] * self.count[1]
    }

    /// Whether there is no block: never.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The borders of the columns (axis 0: x) or rows (axis 1: y), outer ones included, metres.
    pub fn lines_m(&self, axis: usize) -> &[f64] {
        &self.lines_m[axis]
    }

    /// The south-west and north-east corners of a block, metres.
    pub fn corners_m(&self, block: usize) -> [DVec2; 2] {
        let at = [block % self.count[0], block / self.count[0]];
        [0, 1].map(|end| DVec2::new(self.lines_m[0][at[0] + end], self.lines_m[1][at[1] + end]))
    }

    /// The block that holds a point; on a border, the one to the east or north.
    pub fn block_at(&self, p: DVec3) -> usize {
        let [column, row] = [0, 1].map(|axis| self.inner(axis).partition_point(|&line| line <= p[axis]));
        row * self.count[0] + column
    }

    /// The lines that cut: all but the outer borders.
    pub(super) fn inner(&self, axis: usize) -> &[f64] {
        &self.lines_m[axis][1..self.count[axis]]
    }

    /// Which cutting line a coordinate lies on exactly.
    pub(super) fn line_at(&self, axis: usize, v: f64) -> Option<usize> {
        let inner = self.inner(axis);
        let i = inner.partition_point(|&line| line < v);
        (inner.get(i) == Some(&v)).then_some(i)
    }

    /// Least side of a block, metres.
    pub(super) fn least_side_m(&self) -> f64 {
        let sides = self.lines_m.iter().flat_map(|lines| lines.windows(2)).map(|pair| pair[1] - pair[0]);
        sides.fold(f64::INFINITY, f64::min)
    }
}
