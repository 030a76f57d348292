//! The disc of blocks and the vertices that its levels and their closure ask for. Knows no height.
//!
//! All blocks are halved alike: first into four triangles about the centre, then at the middle of a hypotenuse again and
//! again. On the lattice of samples a vertex's place alone says when it comes: with h the greatest power of two that
//! divides both coordinates, it is the centre of a square of side 2h where both are odd multiples of h, else the middle of
//! such a square's side. A middle needs the centres on both sides of it, a centre the two corners of its square that are
//! middles of the next larger squares. Keeping to that is all it takes for a mesh without cracks.

use super::BandMeshOptions;
use crate::MultiresError;
use yamanami_core::FieldLevel;

/// Most blocks from the middle to a side.
const MOST_ACROSS: f64 = 2_000.0;
/// Most samples of the square of blocks, so that vertices have 32-bit numbers.
const MOST_SAMPLES: u64 = 1 << 31;

/// Square arrangement of blocks with the eye over the centre of the middle one, numbered row by row from the north-west.
#[derive(Debug, Clone)]
pub(super) struct Blocks {
    pub(super) block_m: f64,
    /// Samples along a block: a power of two, 2 or more.
    pub(super) side: i64,
    /// Blocks across.
    pub(super) across: i64,
    /// Column and row of the grid at the north-west corner; may lie off the grid.
    pub(super) origin: [i64; 2],
    /// Level of each block, 0 where it is not drawn.
    pub(super) levels: Vec<u8>,
    /// Blocks within reach that are not on the grid.
    pub(super) missing: usize,
}

impl Blocks {
    pub(super) fn new(
        grid: &FieldLevel,
        options: &BandMeshOptions,
        level_at: impl Fn(f64) -> u32,
    ) -> Result<Self, MultiresError> {
        let (block_m, spacing_m) = (options.block_m, grid.spacing_m());
        let log2 = (block_m / spacing_m).log2();
        // also refuses NaN
        if !((log2 - log2.round()).abs() < 1e-9 && (1.0..=20.0).contains(&log2.round())) {
            return Err(MultiresError::BadBlockSize { block_m, spacing_m });
        }
        let side = 1i64 << log2.round() as u32;
        let finest = 2 * log2.round() as u32;
        let n = (options.reach_m / block_m).floor().max(0.0);
        let across = 2.0 * n.min(MOST_ACROSS + 1.0) + 1.0;
        let samples = (across * side as f64 + 1.0).powi(2);
        if n > MOST_ACROSS || samples > MOST_SAMPLES as f64 || n.is_nan() {
            return Err(MultiresError::TooManyBlocks {
                count: samples as u64,
                what: "samples in the blocks",
                most: MOST_SAMPLES,
            });
        }
        let n = n as i64;
        let eye = grid.grid_from_plane(options.eye).round().clamp(glam::DVec2::splat(-1e9), glam::DVec2::splat(1e9));
        let origin = [eye.x, eye.y].map(|at| at as i64 - side / 2 - n * side);
        let mut blocks = Self { block_m, side, across: 2 * n + 1, origin, levels: Vec::new(), missing: 0 };
        let width = grid.width() as i64;
        for (row, column) in (-n..=n).flat_map(|row| (-n..=n).map(move |column| (row, column))) {
            let r_m = block_m * (column as f64).hypot(row as f64);
            let corner = [origin[0] + (column + n) * side, origin[1] + (row + n) * side];
            let is_on_grid = corner.iter().all(|&at| at >= 0 && at + side < width);
            let is_near = r_m <= options.reach_m;
            blocks.missing += usize::from(is_near && !is_on_grid);
            let level = if is_near && is_on_grid { level_at(r_m).clamp(1, finest) as u8 } else { 0 };
            blocks.levels.push(level);
        }
        Ok(blocks)
    }

    /// Samples across all blocks.
    pub(super) fn width(&self) -> i64 {
        self.across * self.side + 1
    }

    /// Number of blocks drawn.
    pub(super) fn drawn(&self) -> usize {
        self.levels.iter().filter(|&&level| level > 0).count()
    }

    /// North-west corner of a block.
    pub(super) fn corner(&self, block: usize) -> [i64; 2] {
        [block as i64 % self.across * self.side, block as i64 / self.across * self.side]
    }

    /// The eye.
    pub(super) fn eye(&self) -> [i64; 2] {
        [(self.width() - 1) / 2; 2]
    }

    /// The drawn block around a place given in quarters of samples, which is on no border.
    pub(super) fn is_drawn_around(&self, quarters: [i64; 2]) -> bool {
        let [column, row] = quarters.map(|at| at.div_euclid(4 * self.side));
        let inside = |at: i64| (0..self.across).contains(&at);
        inside(column) && inside(row) && self.levels[(row * self.across + column) as usize] > 0
    }

    /// The block that holds a sample of the grid, and its neighbours.
    pub(super) fn blocks_near(&self, [column, row]: [i64; 2]) -> [Option<usize>; 9] {
        let [i, j] = [column - self.origin[0], row - self.origin[1]].map(|at| at.div_euclid(self.side));
        let around = [[0, 0], [0, -1], [0, 1], [-1, 0], [1, 0], [-1, -1], [1, -1], [-1, 1], [1, 1]];
        around.map(|[di, dj]| {
            let (i, j) = (i + di, j + dj);
            let inside = |at: i64| (0..self.across).contains(&at);
            (inside(i) && inside(j)).then(|| (j * self.across + i) as usize)
        })
    }

    /// The vertices of the mesh: those of the levels, and those that they need.
    pub(super) fn vertices(&self) -> Vertices {
        let width = self.width();
        let mut vertices = Vertices { width, is_used: vec![false; (width * width) as usize] };
        for block in (0..self.levels.len()).filter(|&block| self.levels[block] > 0) {
            self.use_level(block, &mut vertices);
        }
        let mut h = 1;
        while h < self.side / 2 {
            self.close(h, &mut vertices);
            h *= 2;
        }
        vertices
    }

    /// The vertices that halve a block to its level, borders included.
    fn use_level(&self, block: usize, vertices: &mut Vertices) {
        let ([x0, y0], side) = (self.corner(block), self.side);
        for [x, y] in [[0, 0], [side, 0], [0, side], [side, side], [side / 2, side / 2]] {
            vertices.add([x0 + x, y0 + y]);
        }
        for level in 1..i64::from(self.levels[block]) {
            let (h, is_middle) = (side >> (level / 2 + 1), level % 2 == 1);
            for y in (0..=side).step_by(h as usize) {
                let is_odd = y / h % 2 == 1;
                if !is_middle && !is_odd {
                    continue;
                }
                // middles are odd in one coordinate, centres in both
                let first = if is_middle && is_odd { 0 } else { h };
                for x in (first..=side).step_by(2 * h as usize) {
                    vertices.add([x0 + x, y0 + y]);
                }
            }
        }
    }

    /// What the middles, then the centres, of squares of side 2h need.
    fn close(&self, h: i64, vertices: &mut Vertices) {
        let width = self.width();
        for y in (0..width).step_by(h as usize) {
            let is_odd = y / h % 2 == 1;
            for x in (if is_odd { 0 } else { h }..width).step_by(2 * h as usize) {
                if vertices.has([x, y]) {
                    let [dx, dy] = if is_odd { [h, 0] } else { [0, h] };
                    for centre in [[x - dx, y - dy], [x + dx, y + dy]] {
                        if self.is_drawn_around(centre.map(|at| 4 * at)) {
                            vertices.add(centre);
                        }
                    }
                }
            }
        }
        for y in (h..width).step_by(2 * h as usize) {
            for x in (h..width).step_by(2 * h as usize) {
                if vertices.has([x, y]) {
                    // of the four corners two are odd multiples of 2h in just one coordinate
                    let is_even = |at: i64| at / (2 * h) % 2 == 0;
                    for corner in [[x - h, y - h], [x + h, y - h], [x - h, y + h], [x + h, y + h]] {
                        if is_even(corner[0]) != is_even(corner[1]) {
                            vertices.add(corner);
                        }
                    }
                }
            }
        }
    }
}

/// Which samples of the square of blocks are vertices.
pub(super) struct Vertices {
    width: i64,
    is_used: Vec<bool>,
}

impl Vertices {
    fn add(&mut self, [x, y]: [i64; 2]) {
        self.is_used[(y * self.width + x) as usize] = true;
    }

    /// Whether a place, on the square of blocks or not, is a vertex.
    pub(super) fn has(&self, [x, y]: [i64; 2]) -> bool {
        let inside = |at: i64| (0..self.width).contains(&at);
        inside(x) && inside(y) && self.is_used[(y * self.width + x) as usize]
    }

    /// Numbers of the vertices by place, row by row.
    pub(super) fn numbers(&self) -> Vec<u32> {
        let mut next = 0;
        let number = |&is_used: &bool| {
            next += u32::from(is_used);
            next.wrapping_sub(1)
        };
        self.is_used.iter().map(number).collect()
    }

    /// Columns and rows of the grid at the vertices, by number.
    pub(super) fn samples(&self, blocks: &Blocks) -> Vec<[u32; 2]> {
        let used = self.is_used.iter().enumerate().filter(|&(_, &is_used)| is_used);
        used.map(|(k, _)| {
            let [x, y] = [k as i64 % self.width, k as i64 / self.width];
            // drawn blocks lie on the grid
            [(x + blocks.origin[0]) as u32, (y + blocks.origin[1]) as u32]
        })
        .collect()
    }
}
