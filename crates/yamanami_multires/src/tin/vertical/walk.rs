//! Walking over a TIN along straight lines in plan, from triangle to triangle.
//!
//! Based on: Devillers, Pion, Teillaud, "Walking in a triangulation", 2002. A corner that lies on the line counts as being to
//! the left of it, so that the line leaves each triangle through one side.

use super::{Ground, area2};
use glam::DVec3;

/// No vertex, no triangle, no side.
pub(super) const NONE: u32 = u32::MAX;

/// A TIN with its neighbourhood at hand. Side 3 t + k runs from corner k of triangle t to the next.
pub(super) struct Net<'a> {
    pub(super) ground: Ground<'a>,
    /// The first side that leaves each vertex, and for each side the next one.
    head: Vec<u32>,
    next: Vec<u32>,
}

/// Where a walk starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum At {
    Vertex(u32),
    Triangle(u32),
}

/// The next side of the same triangle.
fn after(side: u32) -> u32 {
    if side % 3 == 2 { side - 2 } else { side + 1 }
}

fn before(side: u32) -> u32 {
    if side.is_multiple_of(3) { side + 2 } else { side - 1 }
}

/// Whether a place is in a triangle or on its border. All sides are asked: by rounding a line may leave through a side that
/// it runs along, and then that one alone tells nothing.
fn is_in([a, b, c]: [DVec3; 3], p: DVec3) -> bool {
    area2(a, b, p) >= 0.0 && area2(b, c, p) >= 0.0 && area2(c, a, p) >= 0.0
}

impl<'a> Net<'a> {
    pub(super) fn new(ground: Ground<'a>) -> Self {
        let sides = 3 * ground.triangles.len();
        let mut net = Self { ground, head: vec![NONE; ground.positions.len()], next: vec![NONE; sides] };
        for (side, &v) in ground.triangles.as_flattened().iter().enumerate() {
            net.next[side] = std::mem::replace(&mut net.head[v as usize], side as u32);
        }
        net
    }

    /// The same side of the triangle beyond it, or [`NONE`].
    fn twin(&self, side: u32) -> u32 {
        let v = self.vertex(side);
        self.sides_from(self.vertex(after(side))).find(|&other| self.vertex(after(other)) == v).unwrap_or(NONE)
    }

    /// The vertex that a side leaves.
    fn vertex(&self, side: u32) -> u32 {
        self.ground.triangles.as_flattened()[side as usize]
    }

    fn place(&self, side: u32) -> DVec3 {
        self.ground.positions[self.vertex(side) as usize]
    }

    /// Whether a vertex is of any triangle.
    pub(super) fn has(&self, v: u32) -> bool {
        self.head[v as usize] != NONE
    }

    fn sides_from(&self, v: u32) -> impl Iterator<Item = u32> {
        let mut side = self.head[v as usize];
        std::iter::from_fn(move || {
            let this = side;
            (this != NONE).then(|| {
                side = self.next[this as usize];
                this
            })
        })
    }

    /// Pairs of vertices around a vertex: those of each triangle.
    pub(super) fn around(&self, v: u32) -> impl Iterator<Item = [u32; 2]> {
        self.sides_from(v).map(|side| [after(side), before(side)].map(|side| self.vertex(side)))
    }

    /// What is at a place in a triangle: one of its corners, if the place is that.
    pub(super) fn at(&self, triangle: u32, p: DVec3) -> At {
        let corners = self.ground.triangles[triangle as usize];
        let is_there = |&&v: &&u32| self.ground.positions[v as usize].truncate() == p.truncate();
        corners.iter().find(is_there).map_or(At::Triangle(triangle), |&v| At::Vertex(v))
    }

    /// The side through which a line leaves the triangles around a vertex, with how far its ends are to the left; or, if it
    /// ends in one of them, that.
    fn leave_vertex(&self, v: u32, q: DVec3) -> Result<(u32, [f64; 2]), u32> {
        let p = self.ground.positions[v as usize];
        let mut ends_in = NONE;
        for side in self.sides_from(v) {
            let out = after(side);
            let (from, to) = (self.place(out), self.place(before(side)));
            let left = [area2(p, q, from), area2(p, q, to)];
            let is_ahead = left[0] < 0.0 && left[1] >= 0.0;
            // along the border there may be nothing to the right
            if is_ahead || left[0] == 0.0 && (from - p).truncate().dot((q - p).truncate()) > 0.0 {
                if area2(from, to, q) >= 0.0 {
                    ends_in = side / 3;
                }
                if is_ahead {
                    return if ends_in == NONE { Ok((out, left)) } else { Err(ends_in) };
                }
            }
        }
        Err(ends_in)
    }

    /// The same for a triangle in which the line from p to q begins.
    fn leave_triangle(&self, triangle: u32, p: DVec3, q: DVec3) -> Result<(u32, [f64; 2]), u32> {
        let sides = [3 * triangle, 3 * triangle + 1, 3 * triangle + 2];
        let corners = sides.map(|side| self.place(side));
        let left = corners.map(|c| area2(p, q, c));
        for k in 0..3 {
            let n = (k + 1) % 3;
            if left[k] < 0.0 && left[n] >= 0.0 {
                return if is_in(corners, q) { Err(triangle) } else { Ok((sides[k], [left[k], left[n]])) };
            }
        }
        // along a side: either it ends there, or at a corner the way goes on
        if is_in(corners, q) {
            return Err(triangle);
        }
        let ahead = |k: usize| (corners[k] - p).truncate().dot((q - p).truncate());
        match (0..3).filter(|&k| left[k] == 0.0).max_by(|&i, &j| ahead(i).total_cmp(&ahead(j))) {
            Some(k) => self.leave_vertex(self.vertex(sides[k]), q),
            None => Err(NONE),
        }
    }

    /// Walks from p to q and gives the triangle that has q, or [`NONE`] where the walk leaves the TIN. `cross` hears of each
    /// side crossed: its ends, and what share of it lies before the crossing.
    pub(super) fn walk(&self, at: At, p: DVec3, q: DVec3, mut cross: impl FnMut([DVec3; 2], f64)) -> u32 {
        let first = match at {
            At::Vertex(v) => self.leave_vertex(v, q),
            At::Triangle(triangle) => self.leave_triangle(triangle, p, q),
        };
        let (mut side, [mut right, mut left]) = match first {
            Ok(way) => way,
            Err(end) => return end,
        };
        for _ in 0..=self.ground.triangles.len() {
            let ends = [self.place(side), self.place(after(side))];
            cross(ends, right / (right - left));
            let entered = self.twin(side);
            if entered == NONE {
                return NONE;
            }
            let tip = self.place(before(entered));
            let tip_left = area2(p, q, tip);
            if is_in([ends[0], tip, ends[1]], q) {
                return entered / 3;
            }
            if tip_left >= 0.0 {
                (side, left) = (after(entered), tip_left);
            } else {
                (side, right) = (before(entered), tip_left);
            }
        }
        NONE
    }
}
