//! The dyadic lattice over a grid of any size.
//!
//! Level `j` has one lattice point every `2^j` samples (j = 0 is the full grid), up to base squares of side
//! `2^levels`. A grid whose size is not `k·2^levels + 1` is *clamped*: the lattice runs on past the last column and row
//! just far enough to cover them, and points beyond take the last column's or row's place. Squares that fold to
//! nothing that way do not exist. So no sample is lost, none invented, and the border is met at every level.

/// A point of the lattice: `x`, `y` count steps of `2^level` samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct LatticeNode {
    /// log₂ of the spacing in samples.
    pub level: u32,
    /// Column on the level's lattice.
    pub x: u32,
    /// Row on the level's lattice.
    pub y: u32,
}

/// Sizes of every level of the lattice over a `width` × `height` grid.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Lattice {
    width: u32,
    height: u32,
    levels: u32,
}

impl Lattice {
    /// Lays the lattice over a grid of at least 2×2 samples; the base squares are as wide as the shorter side.
    pub fn new(width: usize, height: usize) -> Self {
        let shorter = (width.min(height) - 1).max(1);
        let levels = shorter.next_power_of_two().trailing_zeros();
        Self { width: width as u32, height: height as u32, levels }
    }

    /// Columns of the grid.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows of the grid.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Levels of 4-to-1 refinement: base squares have sides of `2^levels` samples.
    pub fn levels(&self) -> u32 {
        self.levels
    }

    /// Squares (columns, rows) of side `2^level` samples that are not folded to nothing.
    #[inline]
    pub fn squares(&self, level: u32) -> [u32; 2] {
        [(self.width - 1).div_ceil(1 << level), (self.height - 1).div_ceil(1 << level)]
    }

    /// Points (columns, rows) of a level: one more than its squares.
    #[inline]
    pub fn points(&self, level: u32) -> [u32; 2] {
        let [x, y] = self.squares(level);
        [x + 1, y + 1]
    }

    /// The grid sample (column, row) at a lattice point, clamped to the grid.
    #[inline]
    pub fn sample(&self, level: u32, x: u32, y: u32) -> [u32; 2] {
        // 64 bits: the lattice may run past the grid by almost a base square
        let clamp = |k: u32, size: u32| (u64::from(k) << level).min(u64::from(size - 1)) as u32;
        [clamp(x, self.width), clamp(y, self.height)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_paper_s_grid_is_two_base_triangles_and_eight_levels() {
        let lattice = Lattice::new(257, 257);
        assert_eq!(lattice.levels(), 8);
        assert_eq!(lattice.squares(8), [1, 1]);
        assert_eq!(lattice.points(0), [257, 257]);
    }

    #[test]
    fn an_odd_size_is_covered_and_clamped() {
        let lattice = Lattice::new(1202, 701);
        assert_eq!(lattice.levels(), 10);
        assert_eq!(lattice.squares(10), [2, 1]);
        assert_eq!(lattice.sample(10, 2, 1), [1201, 700]);
        assert_eq!(lattice.sample(9, 2, 1), [1024, 512]);
    }
}
