//! The triangles of a block that touch a line, and how they are drawn beside any level.
//!
//! Based on: Hiraoka, Yamada, Urahama, "A fast drawing method of TINs for three-dimensional GIS", APA, 2005, figure 2: a triangle
//! with an edge on the line becomes a fan over the points that lie there. One in a corner of its block has two such edges,
//! and neighbours of two levels.

use super::seams::{On, Seam, Seams};
use super::{BlockGrid, TinBlocks};
use glam::DVec3;

/// A triangle that touches a side of its block.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rim {
    corners: [Corner; 3],
    /// The side that each edge lies on, edge `k` beginning at corner `k`, with its ends' numbers along the side.
    edges: [Option<(u8, u32, u32)>; 3],
}

/// A corner of a rim triangle; sides by their place in [`Seams::sides_of`].
#[derive(Debug, Clone, Copy)]
enum Corner {
    Own(u32),
    Side(u8, u32),
    Crossing(u32, usize),
}

impl Rim {
    /// What the triangle of a block and level has on the lines; `None` where it touches none.
    pub(super) fn of(
        triangle: [u32; 3],
        places: [DVec3; 3],
        block: usize,
        level: usize,
        grid: &BlockGrid,
        seams: &Seams,
        positions: &[DVec3],
    ) -> Option<Self> {
        let on = places.map(|p| seams.on(grid, p, block));
        if on == [On::Block; 3] {
            return None;
        }
        let sides = seams.sides_of(block);
        let place_of = |side: usize| sides.iter().position(|&s| s == Some(side));
        let number = |side: usize, p: DVec3| seams.number(side, level, positions, p);
        let corner = |k: usize| match on[k] {
            On::Block => Corner::Own(triangle[k]),
            On::Side(side) => match (place_of(side), number(side, places[k])) {
                (Some(place), Some(at)) => Corner::Side(place as u8, at),
                _ => Corner::Own(triangle[k]),
            },
            On::Crossing(crossing) => Corner::Crossing(triangle[k], crossing),
        };
        // both ends on one line, and that line a side of the block
        let edge = |k: usize| {
            let [p, q] = [places[k], places[(k + 1) % 3]];
            sides.iter().enumerate().find_map(|(place, &side)| {
                let (side, axis) = (side?, place / 2);
                let line_m = grid.corners_m(block)[place % 2][axis];
                (p[axis] == line_m && q[axis] == line_m).then_some(())?;
                Some((place as u8, number(side, p)?, number(side, q)?))
            })
        };
        Some(Self { corners: [0, 1, 2].map(corner), edges: [0, 1, 2].map(edge) })
    }
}

/// A block beside the levels that its neighbours are shown at.
#[derive(Debug, Clone, Copy)]
pub struct Joined<'a> {
    blocks: &'a TinBlocks,
    block: usize,
    shown: &'a [u8],
    seams: [Option<Seam<'a>>; 4],
}

impl<'a> Joined<'a> {
    pub(super) fn new(blocks: &'a TinBlocks, block: usize, shown: &'a [u8]) -> Self {
        let sides = blocks.seams.sides_of(block);
        let seams = sides.map(|side| side.map(|side| blocks.seams.seam(side, block, shown)));
        Self { blocks, block, shown, seams }
    }

    /// The level that the block is shown at.
    pub fn level(&self) -> usize {
        usize::from(self.shown[self.block])
    }

    /// Draws the whole block: adds its triangles.
    pub fn all(&self, out: &mut Vec<[u32; 3]>) {
        let (rims, inner) = self.rims();
        out.extend_from_slice(&self.blocks.triangles(self.block, self.level())[..inner]);
        rims.iter().for_each(|rim| self.fan(rim, out));
    }

    /// Draws the `t`th of [`TinBlocks::triangles`].
    pub fn one(&self, t: usize, out: &mut Vec<[u32; 3]>) {
        let (rims, inner) = self.rims();
        match t.checked_sub(inner) {
            None => out.push(self.blocks.triangles(self.block, self.level())[t]),
            Some(nth) => self.fan(&rims[nth], out),
        }
    }

    /// The block's rim triangles, and how many others come before them.
    fn rims(&self) -> (&'a [Rim], usize) {
        let level = &self.blocks.levels[self.level()];
        let [from, to] = [self.block, self.block + 1].map(|block| level.rim_starts[block] as usize);
        let count = level.starts[self.block + 1] - level.starts[self.block];
        (&level.rims[from..to], count as usize - (to - from))
    }

    fn vertex(&self, corner: Corner) -> u32 {
        match corner {
            Corner::Own(vertex) => vertex,
            Corner::Side(place, k) => self.seams[usize::from(place)].map_or(0, |seam| seam.point(k)),
            Corner::Crossing(own, crossing) => self.blocks.seams.crossing(crossing, self.shown).unwrap_or(own),
        }
    }

    /// A rim triangle over the points on its edges.
    fn fan(&self, rim: &Rim, out: &mut Vec<[u32; 3]>) {
        let corners = rim.corners.map(|corner| self.vertex(corner));
        // at most two edges lie on lines: let them be the first two
        let is_on = |k: usize| rim.edges[k % 3].is_some();
        let first = (0..3).find(|&k| is_on(k) && is_on(k + 1)).or((0..3).find(|&k| is_on(k))).unwrap_or(0);
        let [a, b, c] = [0, 1, 2].map(|k| corners[(first + k) % 3]);
        let mut from = a;
        for p in self.between(rim.edges[first]) {
            out.push([c, from, p]);
            from = p;
        }
        // what is left is (from, b, c), with the second edge
        let mut at = b;
        for p in self.between(rim.edges[(first + 1) % 3]) {
            out.push([from, at, p]);
            at = p;
        }
        out.push([from, at, c]);
    }

    fn between(&self, edge: Option<(u8, u32, u32)>) -> impl Iterator<Item = u32> + use<'a> {
        let seam = edge.and_then(|(place, from, to)| Some((self.seams[usize::from(place)]?, from, to)));
        seam.into_iter().flat_map(|(seam, from, to)| seam.between(from, to))
    }
}
