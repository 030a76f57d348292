//! Heights and errors behind a terrain surface: in memory, or by pages.

use super::holes::Holes;
use yamanami_core::{ErrorCode, Lattice, LatticeNode};

/// What a terrain surface must know of its lattice points. Topology is the surface's business.
pub trait TerrainData: Sync {
    /// Height in metres at a lattice point (clamped to the grid); the point's level is resident.
    fn height_m(&self, node: LatticeNode) -> f32;

    /// Height in metres at a sample that is a vertex of a front in memory.
    fn sample_height_m(&self, column: u32, row: u32) -> f32;

    /// Change of height, in metres a lattice step, eastwards and southwards at a lattice point.
    fn gradient(&self, node: LatticeNode) -> [f64; 2];

    /// Error of a midpoint; its level is resident there.
    fn error(&self, node: LatticeNode) -> ErrorCode;

    /// Whether half a square of a level holds data.
    fn shown(&self, level: u32, x: u32, y: u32, half: u32) -> bool;

    /// Whether any triangle is hidden.
    fn has_holes(&self) -> bool;

    /// Whether heights around a midpoint, on its level, are in memory.
    fn is_resident(&self, node: LatticeNode) -> bool;
}

/// A whole terrain in memory: the grid of heights once, and an error code for every midpoint.
#[derive(Debug, Clone)]
pub struct GridData {
    pub(crate) lattice: Lattice,
    /// Filled heights, row by row.
    pub(crate) heights_m: Vec<f32>,
    /// By level, row by row of its lattice; zero at points of a coarser level.
    pub(crate) errors: Vec<Vec<ErrorCode>>,
    pub(crate) holes: Option<Holes>,
    /// What rounding may hide, metres.
    pub(crate) rounding_m: f32,
}

impl GridData {
    /// Heights in metres of all samples, row by row; samples without data carry a filled height.
    pub fn heights_m(&self) -> &[f32] {
        &self.heights_m
    }

    /// Error codes of a level's lattice points, row by row.
    pub fn errors(&self, level: u32) -> &[ErrorCode] {
        &self.errors[level as usize]
    }

    /// What was added to every error that is not zero, metres, since arithmetic in f32 may hide that much.
    pub fn rounding_m(&self) -> f32 {
        self.rounding_m
    }

    /// The lattice.
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }
}

impl TerrainData for GridData {
    #[inline]
    fn height_m(&self, node: LatticeNode) -> f32 {
        let [column, row] = self.lattice.sample(node.level, node.x, node.y);
        self.heights_m[row as usize * self.lattice.width() as usize + column as usize]
    }

    #[inline]
    fn sample_height_m(&self, column: u32, row: u32) -> f32 {
        self.heights_m[row as usize * self.lattice.width() as usize + column as usize]
    }

    fn gradient(&self, node: LatticeNode) -> [f64; 2] {
        let z = |x: u32, y: u32| f64::from(self.height_m(LatticeNode { x, y, ..node }));
        gradient(node, [0, 0], self.lattice.points(node.level), z)
    }

    #[inline]
    fn error(&self, node: LatticeNode) -> ErrorCode {
        let columns = self.lattice.points(node.level)[0] as usize;
        self.errors[node.level as usize][node.y as usize * columns + node.x as usize]
    }

    #[inline]
    fn shown(&self, level: u32, x: u32, y: u32, half: u32) -> bool {
        self.holes.as_ref().is_none_or(|h| h.shown(level, x, y, half))
    }

    fn has_holes(&self) -> bool {
        self.holes.is_some()
    }

    #[inline]
    fn is_resident(&self, _node: LatticeNode) -> bool {
        true
    }
}

/// Central difference at a point within lattice points `first..end`, one-sided at their border.
pub(crate) fn gradient(node: LatticeNode, first: [u32; 2], end: [u32; 2], z: impl Fn(u32, u32) -> f64) -> [f64; 2] {
    let (x, y) = (node.x.clamp(first[0], end[0] - 1), node.y.clamp(first[1], end[1] - 1));
    let around = |k: u32, first: u32, end: u32| (k.saturating_sub(1).max(first), (k + 1).min(end - 1));
    let (west, east) = around(x, first[0], end[0]);
    let (north, south) = around(y, first[1], end[1]);
    [
        (z(east, y) - z(west, y)) / f64::from((east - west).max(1)),
        (z(x, south) - z(x, north)) / f64::from((south - north).max(1)),
    ]
}
