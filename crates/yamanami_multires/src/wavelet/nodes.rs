//! Node numbers: every level's lattice points in a row, coarse levels first.
//!
//! A prefix of the numbers is a coarser model, and a parent's number is below its children's. Points that belong to a
//! coarser level keep a number that is no node, so that number and place convert with one division.

use yamanami_core::{Lattice, LatticeNode, NodeId};

/// Converts between node numbers and lattice places.
#[derive(Debug, Clone)]
pub struct NodeNumbers {
    lattice: Lattice,
    /// First number of each level, by level (0 = finest), and columns of its lattice.
    first: Vec<NodeId>,
    columns: Vec<u32>,
    bound: NodeId,
}

impl NodeNumbers {
    /// Numbers the midpoints of all levels below the base; `None` when they do not fit in 32 bits.
    pub fn new(lattice: Lattice) -> Option<Self> {
        let levels = lattice.levels() as usize;
        let (mut first, mut columns) = (vec![0; levels], vec![0; levels]);
        let mut next = 0u64;
        for level in (0..levels).rev() {
            let [nx, ny] = lattice.points(level as u32);
            first[level] = u32::try_from(next).ok()?;
            columns[level] = nx;
            next += u64::from(nx) * u64::from(ny);
        }
        // the triangle keys hold two triangles a square and four template slots in 64 bits: ample
        Some(Self { lattice, first, columns, bound: u32::try_from(next).ok()? })
    }

    /// The lattice.
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// One past the greatest number.
    pub fn bound(&self) -> NodeId {
        self.bound
    }

    /// Number of a lattice point on its level.
    #[inline]
    pub fn number(&self, node: LatticeNode) -> NodeId {
        let level = node.level as usize;
        self.first[level] + node.y * self.columns[level] + node.x
    }

    /// Level of a number: 0 is the finest.
    #[inline]
    pub fn level(&self, number: NodeId) -> u32 {
        // finest first: most numbers are of the two finest levels
        let mut level = 0;
        while number < self.first[level] {
            level += 1;
        }
        level as u32
    }

    /// Place of a number.
    #[inline]
    pub fn place(&self, number: NodeId) -> LatticeNode {
        let level = self.level(number);
        let index = number - self.first[level as usize];
        let columns = self.columns[level as usize];
        LatticeNode { level, x: index % columns, y: index / columns }
    }

    /// Whether a lattice point is a midpoint that exists on its level.
    #[inline]
    pub fn exists(&self, node: LatticeNode) -> bool {
        let [nx, ny] = self.lattice.points(node.level);
        (node.x | node.y) & 1 == 1 && node.x < nx && node.y < ny
    }
}
