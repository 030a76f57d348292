//! What lies on the lines between blocks, for every pair of levels that may meet there.
//!
//! Based on: Hiraoka, Yamada, Urahama, "A fast drawing method of TINs for three-dimensional GIS", APA, 2005, figure 2. The
//! paper splits a coarse block's triangles at the finer level's vertices. That alone leaves gaps: the coarse level has
//! vertices of its own there, at other heights. Here both sides take the points of both levels, all at the heights of the
//! finer one, whose shape the line keeps; and where four blocks meet, the height of the finest. So no mix of levels has a gap.

use super::{BlockGrid, CutTin};
use glam::DVec3;

/// The lines between blocks: what each level has on them, and what any two levels share.
#[derive(Debug)]
pub(super) struct Seams {
    columns: usize,
    rows: usize,
    levels: usize,
    /// By side and level: the level's own vertices along the side, its ends included.
    own: Vec<Vec<u32>>,
    /// By side and pair of levels.
    shared: Vec<Shared>,
    /// By level and crossing of lines: the level's vertex there.
    crossings: Vec<Option<u32>>,
}

/// What two levels share along a side.
#[derive(Debug, Default)]
struct Shared {
    /// Vertices along the side.
    points: Vec<u32>,
    /// Where the own vertices of the finer and of the coarser level stand among the points.
    place: [Vec<u32>; 2],
}

/// Where a vertex lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum On {
    /// Inside a block.
    Block,
    /// On a side.
    Side(usize),
    /// Where four blocks meet.
    Crossing(usize),
}

/// A side as seen from one of its blocks, with the level beyond.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seam<'a> {
    points: &'a [u32],
    place: &'a [u32],
}

impl<'a> Seam<'a> {
    /// The vertex that takes the place of the `k`th own one.
    pub(super) fn point(&self, k: u32) -> u32 {
        self.points[self.place[k as usize] as usize]
    }

    /// The vertices strictly between two own ones, from the first to the second.
    pub(super) fn between(&self, from: u32, to: u32) -> impl DoubleEndedIterator<Item = u32> + use<'a> {
        let [from, to] = [from, to].map(|k| self.place[k as usize] as usize);
        let inner = &self.points[from.min(to) + 1..from.max(to)];
        // forth, or back
        let (forth, back) = if from <= to { (inner, &[][..]) } else { (&[][..], inner) };
        forth.iter().copied().chain(back.iter().rev().copied())
    }
}

impl Seams {
    /// Of all levels' cut TINs, the finest first; a level's vertex numbers are counted from `bases` in `positions`, to which
    /// the points are added that one level has on another's line.
    pub(super) fn new(grid: &BlockGrid, cuts: &[CutTin], bases: &[u32], positions: &mut Vec<DVec3>) -> Self {
        let [columns, rows] = grid.count();
        let levels = cuts.len();
        let mut seams = Self {
            columns,
            rows,
            levels,
            own: Vec::new(),
            shared: Vec::new(),
            crossings: vec![None; levels * (columns - 1) * (rows - 1)],
        };
        seams.own = vec![Vec::new(); seams.sides() * levels];
        for (level, cut) in cuts.iter().enumerate() {
            seams.collect(grid, level, cut, bases[level]);
        }
        for side in 0..seams.sides() {
            let axis = seams.along(side);
            for level in 0..levels {
                let own = &mut seams.own[side * levels + level];
                own.sort_unstable_by(|&a, &b| {
                    positions[a as usize][axis].total_cmp(&positions[b as usize][axis]).then(a.cmp(&b))
                });
                own.dedup_by(|a, b| positions[*a as usize][axis] == positions[*b as usize][axis]);
            }
            for fine in 0..levels {
                for coarse in 0..levels {
                    let shared =
                        if coarse < fine { Shared::default() } else { seams.join(side, fine, coarse, positions) };
                    seams.shared.push(shared);
                }
            }
        }
        seams
    }

    fn upright(&self) -> usize {
        (self.columns - 1) * self.rows
    }

    fn sides(&self) -> usize {
        self.upright() + self.columns * (self.rows - 1)
    }

    /// The axis that a side runs along.
    fn along(&self, side: usize) -> usize {
        usize::from(side < self.upright())
    }

    /// The sides of a block, where it has a neighbour: west, east, south, north.
    pub(super) fn sides_of(&self, block: usize) -> [Option<usize>; 4] {
        let (column, row) = (block % self.columns, block / self.columns);
        let upright = |column: usize| row * (self.columns - 1) + column;
        let level = |row: usize| self.upright() + row * self.columns + column;
        [
            (column > 0).then(|| upright(column - 1)),
            (column + 1 < self.columns).then(|| upright(column)),
            (row > 0).then(|| level(row - 1)),
            (row + 1 < self.rows).then(|| level(row)),
        ]
    }

    /// The two blocks of a side.
    fn blocks_of(&self, side: usize) -> [usize; 2] {
        match side.checked_sub(self.upright()) {
            None => {
                let west = side / (self.columns - 1) * self.columns + side % (self.columns - 1);
                [west, west + 1]
            }
            Some(south) => [south, south + self.columns],
        }
    }

    /// Where a point lies, `block` being one that it touches.
    pub(super) fn on(&self, grid: &BlockGrid, p: DVec3, block: usize) -> On {
        let (column, row) = (block % self.columns, block / self.columns);
        match [0, 1].map(|axis| grid.line_at(axis, p[axis])) {
            [None, None] => On::Block,
            [Some(x), None] => On::Side(row * (self.columns - 1) + x),
            [None, Some(y)] => On::Side(self.upright() + y * self.columns + column),
            [Some(x), Some(y)] => On::Crossing(y * (self.columns - 1) + x),
        }
    }

    /// The place of a vertex among the own ones of a level along a side.
    pub(super) fn number(&self, side: usize, level: usize, positions: &[DVec3], p: DVec3) -> Option<u32> {
        let axis = self.along(side);
        let own = &self.own[side * self.levels + level];
        let found = own.binary_search_by(|&v| positions[v as usize][axis].total_cmp(&p[axis]));
        found.ok().map(|k| k as u32)
    }

    /// A side as a block sees it when blocks are shown at these levels.
    pub(super) fn seam(&self, side: usize, block: usize, shown: &[u8]) -> Seam<'_> {
        let [a, b] = self.blocks_of(side);
        let (own, other) = (shown[block], shown[if a == block { b } else { a }]);
        let shared = self.pair(side, own.min(other), own.max(other));
        Seam { points: &shared.points, place: &shared.place[usize::from(own > other)] }
    }

    fn pair(&self, side: usize, fine: u8, coarse: u8) -> &Shared {
        &self.shared[(side * self.levels + usize::from(fine)) * self.levels + usize::from(coarse)]
    }

    /// The vertex where four blocks meet: that of the finest of them.
    pub(super) fn crossing(&self, crossing: usize, shown: &[u8]) -> Option<u32> {
        let south_west = crossing / (self.columns - 1) * self.columns + crossing % (self.columns - 1);
        let around = [0, 1, self.columns, self.columns + 1].map(|away| shown[south_west + away]);
        let finest = around.into_iter().min().map_or(0, usize::from);
        self.crossings[finest * (self.columns - 1) * (self.rows - 1) + crossing]
    }

    /// Notes the vertices of a level that lie on lines.
    fn collect(&mut self, grid: &BlockGrid, level: usize, cut: &CutTin, base: u32) {
        let mut seen = vec![false; cut.mesh.positions.len()];
        for block in 0..grid.len() {
            let corners = cut.mesh.triangles[cut.range(block)].as_flattened();
            for &v in corners {
                let p = cut.mesh.positions[v as usize];
                // one of its two blocks has it first; both have it on the same side
                if std::mem::replace(&mut seen[v as usize], true) {
                    continue;
                }
                match self.on(grid, p, block) {
                    On::Block => (),
                    On::Side(side) => self.own[side * self.levels + level].push(base + v),
                    On::Crossing(crossing) => {
                        let (x, y) = (crossing % (self.columns - 1), crossing / (self.columns - 1));
                        self.crossings[level * (self.columns - 1) * (self.rows - 1) + crossing] = Some(base + v);
                        let upright = [0, 1].map(|up| (y + up) * (self.columns - 1) + x);
                        let level_sides = [0, 1].map(|on| self.upright() + y * self.columns + x + on);
                        for side in upright.into_iter().chain(level_sides) {
                            self.own[side * self.levels + level].push(base + v);
                        }
                    }
                }
            }
        }
    }

    /// The points of two levels along a side, at the heights of the finer.
    fn join(&self, side: usize, fine: usize, coarse: usize, positions: &mut Vec<DVec3>) -> Shared {
        let axis = self.along(side);
        let [own, other] = [fine, coarse].map(|level| &self.own[side * self.levels + level]);
        let mut shared = Shared::default();
        let mut rest = other.iter().peekable();
        for (k, &v) in own.iter().enumerate() {
            let q = positions[v as usize];
            while let Some(&&w) = rest.peek().filter(|&&&w| positions[w as usize][axis] <= q[axis]) {
                rest.next();
                let mut p = positions[w as usize];
                shared.place[1].push(shared.points.len() as u32);
                if p[axis] == q[axis] {
                    // the point that comes next
                    continue;
                }
                if let Some(&u) = k.checked_sub(1).and_then(|k| own.get(k)) {
                    let before = positions[u as usize];
                    p.z = before.z + (p[axis] - before[axis]) / (q[axis] - before[axis]) * (q.z - before.z);
                }
                shared.points.push(positions.len() as u32);
                positions.push(p);
            }
            shared.place[0].push(shared.points.len() as u32);
            shared.points.push(v);
        }
        // beyond the finer level's last: only where the levels cover different ground
        for &w in rest {
            shared.place[1].push(shared.points.len() as u32);
            shared.points.push(w);
        }
        shared
    }
}
