//! Semi-regular meshes: a base mesh whose triangles are split four to one, again and again. The topology is implicit: every
//! number here is worked out, not stored.
//!
//! Vertices are numbered by level, so that the mesh of a level uses a prefix of them: the base mesh's first, then for each
//! level the midpoints of the edges of the level below. Of these come first those on base edges, edge by edge from its first end to
//! its second; then those inside base triangles, triangle by triangle, in three runs: on edges parallel to side 0, to side 1, to side 2;
//! each run row by row.
//!
//! In a base triangle a vertex of level `l` has *lattice coordinates* `(a, b)`, `a` steps from corner 0 towards corner 1 and `b` towards
//! corner 2, with `a + b ≤ 2^l`.
//!
//! Idea: Lounsbery, DeRose, Warren, "Multiresolution analysis for surfaces of arbitrary topological type", 1997.

mod base;
mod ring;
mod triangles;

pub use base::{BaseEdge, BaseFault, BaseMesh, Side};
use std::ops::Range;

/// Most levels: lattice coordinates then fit in 16 bits.
const MOST_LEVELS: u32 = 15;

/// Where a vertex lies, in the lattice of the level that it comes with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// It is a vertex of the base mesh.
    Base,
    /// On a base edge, `at` of `2^level` steps from its first end; `at` is odd.
    Edge {
        /// The edge.
        edge: u32,
        /// Steps.
        at: u32,
    },
    /// Inside a base triangle.
    Face {
        /// The triangle.
        face: u32,
        /// Lattice coordinates; one of them or both are odd.
        at: [u32; 2],
    },
}

/// The topology of a semi-regular mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SemiRegular {
    base: BaseMesh,
    /// Vertices of each level's mesh.
    counts: Vec<u32>,
}

impl SemiRegular {
    /// A base mesh split `levels` times.
    pub fn new(base: BaseMesh, levels: u32) -> Result<Self, BaseFault> {
        if levels > MOST_LEVELS {
            return Err(BaseFault::TooLarge);
        }
        let (edges, faces) = (base.edges().len() as u64, base.triangles().len() as u64);
        let mut counts = vec![base.vertex_count()];
        let mut count = u64::from(base.vertex_count());
        for level in 1..=levels {
            let n = 1u64 << (level - 1);
            count += edges * n + faces * (3 * n * (n - 1) / 2);
            counts.push(u32::try_from(count).map_err(|_| BaseFault::TooLarge)?);
        }
        if faces << (2 * levels) > u64::from(u32::MAX) {
            return Err(BaseFault::TooLarge);
        }
        Ok(Self { base, counts })
    }

    /// The base mesh.
    pub fn base(&self) -> &BaseMesh {
        &self.base
    }

    /// How often the base mesh is split.
    pub fn levels(&self) -> u32 {
        self.counts.len() as u32 - 1
    }

    /// The same base mesh split less often; vertices keep their numbers.
    pub fn coarser(&self, levels: u32) -> Self {
        Self { base: self.base.clone(), counts: self.counts[..=levels.min(self.levels()) as usize].to_vec() }
    }

    /// Vertices of a level's mesh: they are numbered from 0.
    pub fn vertex_count(&self, level: u32) -> u32 {
        self.counts[level as usize]
    }

    /// The vertices that come with a level.
    pub fn new_vertices(&self, level: u32) -> Range<u32> {
        let from = if level == 0 { 0 } else { self.counts[level as usize - 1] };
        from..self.counts[level as usize]
    }

    /// Triangles of a level's mesh.
    pub fn triangle_count(&self, level: u32) -> u32 {
        (self.base.triangles().len() as u32) << (2 * level)
    }

    /// The level that a vertex comes with.
    pub fn level_of(&self, vertex: u32) -> u32 {
        self.counts.partition_point(|&count| count <= vertex) as u32
    }

    /// The vertex at lattice coordinates of a level in a base triangle.
    pub fn vertex(&self, level: u32, face: u32, [a, b]: [u32; 2]) -> u32 {
        let size = 1u32 << level;
        debug_assert!(a + b <= size, "({a}, {b}) is outside at level {level}");
        let c = size - a - b;
        let corner = |k: usize| self.base.triangles()[face as usize][k];
        match (a, b, c) {
            (0, 0, _) => corner(0),
            (_, 0, 0) => corner(1),
            (0, _, 0) => corner(2),
            (a, 0, _) => self.on_side(level, face, 0, a),
            (_, b, 0) => self.on_side(level, face, 1, b),
            (0, _, c) => self.on_side(level, face, 2, c),
            (a, b, _) => self.inside(level, face, [a, b]),
        }
    }

    /// The vertex `at` steps along a base edge at a level; 0 and 2^level are its ends.
    pub fn edge_vertex(&self, level: u32, edge: u32, at: u32) -> u32 {
        let ends = self.base.edges()[edge as usize].ends;
        match at {
            0 => ends[0],
            _ if at == 1 << level => ends[1],
            _ => {
                let shift = at.trailing_zeros();
                let of = level - shift;
                self.counts[of as usize - 1] + (edge << (of - 1)) + (at >> (shift + 1))
            }
        }
    }

    fn on_side(&self, level: u32, face: u32, side: usize, at: u32) -> u32 {
        let Side { edge, is_reversed } = self.base.sides()[face as usize][side];
        self.edge_vertex(level, edge, if is_reversed { (1 << level) - at } else { at })
    }

    /// The number of an inner vertex: of the level at which its coordinates first are whole.
    fn inside(&self, level: u32, face: u32, [a, b]: [u32; 2]) -> u32 {
        let shift = (a | b).trailing_zeros();
        let (of, a, b) = (level - shift, a >> shift, b >> shift);
        let n = 1u32 << (of - 1);
        let row_begin = |row: u32| row * (2 * (n - 1) - row + 1) / 2;
        let (x, y) = (a >> 1, b >> 1);
        let (run, row, column) = match (a & 1, b & 1) {
            (1, 0) => (0, y - 1, x),
            (1, 1) => (1, y, x),
            _ => (2, y, x - 1),
        };
        self.first_inside(of, face) + run * (n * (n - 1) / 2) + row_begin(row) + column
    }

    /// The first of the vertices that come with a level inside a base triangle: three runs of `n (n − 1) / 2` with `n` half of `2^level`, each
    /// in rows of `n − 1`, `n − 2`, … 1.
    pub fn first_inside(&self, level: u32, face: u32) -> u32 {
        let n = 1u32 << (level - 1);
        self.counts[level as usize - 1] + self.base.edges().len() as u32 * n + face * (3 * (n * (n - 1) / 2))
    }

    /// Where a vertex lies in the lattice of its own level, [`Self::level_of`].
    pub fn place(&self, vertex: u32) -> Place {
        let level = self.level_of(vertex);
        if level == 0 {
            return Place::Base;
        }
        let n = 1u32 << (level - 1);
        let nth = vertex - self.counts[level as usize - 1];
        let on_edges = self.base.edges().len() as u32 * n;
        if nth < on_edges {
            return Place::Edge { edge: nth / n, at: 2 * (nth % n) + 1 };
        }
        let run_length = n * (n - 1) / 2;
        let nth = nth - on_edges;
        let (face, nth) = (nth / (3 * run_length), nth % (3 * run_length));
        let (run, nth) = (nth / run_length, nth % run_length);
        let (row, column) = row_and_column(nth, n - 1);
        let at = match run {
            0 => [2 * column + 1, 2 * (row + 1)],
            1 => [2 * column + 1, 2 * row + 1],
            _ => [2 * (column + 1), 2 * row + 1],
        };
        Place::Face { face, at }
    }

    /// The ends of the edge that a vertex is the midpoint of; none for a vertex of the base mesh.
    pub fn parents(&self, vertex: u32) -> Option<[u32; 2]> {
        let level = self.level_of(vertex);
        match self.place(vertex) {
            Place::Base => None,
            Place::Edge { edge, at } => Some([at - 1, at + 1].map(|at| self.edge_vertex(level, edge, at))),
            Place::Face { face, at: [a, b] } => Some(
                match (a & 1, b & 1) {
                    (1, 0) => [[a - 1, b], [a + 1, b]],
                    (1, 1) => [[a + 1, b - 1], [a - 1, b + 1]],
                    _ => [[a, b + 1], [a, b - 1]],
                }
                .map(|at| self.vertex(level, face, at)),
            ),
        }
    }
}

/// Row and column in rows of `length`, `length − 1`, … 1.
fn row_and_column(nth: u32, length: u32) -> (u32, u32) {
    // counted from the end, the rows are triangular numbers
    let after = length * (length + 1) / 2 - 1 - nth;
    let mut up = ((8.0 * f64::from(after) + 1.0).sqrt() as u32 - 1) / 2;
    while up * (up + 1) / 2 > after {
        up -= 1;
    }
    while (up + 1) * (up + 2) / 2 <= after {
        up += 1;
    }
    let row = length - 1 - up;
    (row, nth - row * (2 * length - row + 1) / 2)
}

#[cfg(test)]
mod tests;
