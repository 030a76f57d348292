//! The greatest vertical distance between two TINs of one ground, exactly.
//!
//! Both surfaces are linear on each piece of their overlay, so their difference is greatest at a corner of a piece: a vertex
//! of one of them, or a place where an edge of one crosses an edge of the other in plan. The edges of one are walked over
//! the other, each from an end whose place there is known; what leaves the other, over a border or by rounding, is looked
//! up in a grid.

mod cells;
#[cfg(test)]
mod tests;
mod walk;

use cells::{EdgeCells, Finder};
use glam::{DVec2, DVec3};
use walk::{At, NONE, Net};

/// A triangulation without overlap in plan, its places relative to something near.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ground<'a> {
    pub positions: &'a [DVec3],
    pub triangles: &'a [[u32; 3]],
}

/// How two TINs differ.
#[derive(Debug, Clone, Default)]
pub(crate) struct Difference {
    /// The greatest vertical distance where both are, metres.
    pub worst_m: f64,
    /// For each vertex of the coarse one the triangle of the fine one at its place; `u32::MAX` where it is a vertex of that
    /// too, or outside.
    pub under: Vec<u32>,
}

/// Twice the area, seen from above.
fn area2(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

fn box_of(points: &[DVec3]) -> [DVec2; 2] {
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for &p in points {
        low = low.min(p.truncate());
        high = high.max(p.truncate());
    }
    [low, high]
}

/// How far the edge from p to q is above or below that from a to b where they cross, at this share of the latter.
fn off_at_crossing_m([p, q]: [DVec3; 2], [a, b]: [DVec3; 2], share: f64) -> f64 {
    let share_near = |[from, to]: [DVec3; 2], place: DVec3| {
        let along = (to - from).truncate();
        ((place - from).truncate().dot(along) / along.length_squared()).clamp(0.0, 1.0)
    };
    let place = a + share * (b - a);
    let t = share_near([p, q], place);
    let on_edge = p + t * (q - p);
    if t > 0.0 && t < 1.0 {
        return (on_edge.z - place.z).abs();
    }
    // of edges that nearly coincide the share is mere rounding, and the place may be beyond an end
    let place = a + share_near([a, b], on_edge) * (b - a);
    (on_edge.z - place.z).abs()
}

impl Ground<'_> {
    fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|v| self.positions[v as usize])
    }

    /// How far a place in a triangle, seen from above, is above or below it.
    fn off_m(&self, triangle: u32, p: DVec3) -> f64 {
        let [a, b, c] = self.corners(triangle);
        let (wa, wb, wc) = (area2(b, c, p), area2(c, a, p), area2(a, b, p));
        let sum = wa + wb + wc;
        if sum > 0.0 { ((wa * a.z + wb * b.z + wc * c.z) / sum - p.z).abs() } else { 0.0 }
    }
}

/// A comparison under way.
struct Overlay<'a> {
    fine: Net<'a>,
    coarse: Net<'a>,
    bounds: [DVec2; 2],
    coarse_finder: Finder<'a>,
    worst_m: f64,
    /// Where each vertex of the fine one is in the coarse one, if that is known.
    at: Vec<Option<At>>,
    is_done: Vec<bool>,
    /// From where each was walked to last.
    last_from: Vec<u32>,
    /// Edges of the fine one whose walk failed.
    lost: Vec<[u32; 2]>,
}

impl<'a> Overlay<'a> {
    fn new(fine: Ground<'a>, coarse: Ground<'a>) -> Self {
        let n = fine.positions.len();
        let bounds = box_of(fine.positions);
        Self {
            fine: Net::new(fine),
            coarse: Net::new(coarse),
            bounds,
            coarse_finder: Finder::new(coarse, bounds),
            worst_m: 0.0,
            at: vec![None; n],
            is_done: vec![false; n],
            last_from: vec![NONE; n],
            lost: Vec::new(),
        }
    }

    /// Walks along all edges of the fine one, from one of its vertices to the next.
    fn walk_edges(&mut self) {
        let mut stack = Vec::new();
        let mut last_known = At::Triangle(0);
        for seed in 0..self.fine.ground.positions.len() as u32 {
            if self.is_done[seed as usize] || !self.fine.has(seed) {
                continue;
            }
            if self.at[seed as usize].is_none() {
                let triangle = self.look_up(seed, last_known);
                if triangle != NONE {
                    let p = self.fine.ground.positions[seed as usize];
                    self.worst_m = self.worst_m.max(self.coarse.ground.off_m(triangle, p));
                    self.at[seed as usize] = Some(self.coarse.at(triangle, p));
                }
            }
            stack.push(seed);
            while let Some(v) = stack.pop() {
                if std::mem::replace(&mut self.is_done[v as usize], true) {
                    continue;
                }
                last_known = self.at[v as usize].unwrap_or(last_known);
                self.walk_from(v, &mut stack);
            }
        }
    }

    /// The triangle of the coarse one that has a vertex of the fine one, found without a neighbour's help.
    fn look_up(&self, v: u32, near: At) -> u32 {
        let p = self.fine.ground.positions[v as usize];
        if let At::Triangle(t) = near {
            let [a, b, c] = self.coarse.ground.corners(t);
            let end = self.coarse.walk(near, (a + b + c) / 3.0, p, |_, _| {});
            if end != NONE {
                return end;
            }
        }
        self.coarse_finder.triangle_at(p)
    }

    fn walk_from(&mut self, v: u32, stack: &mut Vec<u32>) {
        for pair in self.fine.around(v) {
            for n in pair {
                if self.is_done[n as usize] || std::mem::replace(&mut self.last_from[n as usize], v) == v {
                    continue;
                }
                if self.are_in_one(v, n) {
                    continue;
                }
                let end = self.at[v as usize]
                    .map_or(NONE, |at| walk_edge(self.fine.ground, &self.coarse, at, [v, n], &mut self.worst_m));
                if end == NONE {
                    self.lost.push([v, n]);
                } else if self.at[n as usize].is_none() {
                    let q = self.fine.ground.positions[n as usize];
                    self.worst_m = self.worst_m.max(self.coarse.ground.off_m(end, q));
                    self.at[n as usize] = Some(self.coarse.at(end, q));
                    stack.push(n);
                }
            }
        }
    }

    /// Whether two vertices of the fine one are known to lie in one triangle of the coarse one, so that nothing is crossed.
    fn are_in_one(&self, v: u32, n: u32) -> bool {
        match (self.at[v as usize], self.at[n as usize]) {
            (Some(At::Triangle(t)), Some(At::Triangle(other))) => t == other,
            (Some(At::Triangle(t)), Some(At::Vertex(corner))) | (Some(At::Vertex(corner)), Some(At::Triangle(t))) => {
                self.coarse.ground.triangles[t as usize].contains(&corner)
            }
            _ => false,
        }
    }

    /// Edges whose walk failed, against all edges that may cross them.
    fn cross_lost(&mut self) {
        if self.lost.is_empty() {
            return;
        }
        let cells = EdgeCells::new(self.coarse.ground, self.bounds);
        for &edge in &self.lost {
            let ends = edge.map(|v| self.fine.ground.positions[v as usize]);
            self.worst_m = self.worst_m.max(cells.worst_crossing_m(ends));
        }
    }

    /// The vertices of the coarse one in the fine one, each by a walk from a vertex of the fine one near it.
    fn coarse_vertices(&mut self) -> Vec<u32> {
        let (fine, coarse) = (&self.fine, &self.coarse);
        let n = coarse.ground.positions.len();
        let (mut near, mut is_shared) = (vec![NONE; n], vec![false; n]);
        for (v, at) in (0u32..).zip(&self.at) {
            match *at {
                Some(At::Vertex(same)) => is_shared[same as usize] = true,
                Some(At::Triangle(t)) => coarse.ground.triangles[t as usize].iter().for_each(|&c| near[c as usize] = v),
                None => {}
            }
        }
        let fine_finder = Finder::new(fine.ground, self.bounds);
        let mut under = vec![NONE; n];
        for (v, &p) in coarse.ground.positions.iter().enumerate() {
            if is_shared[v] || !coarse.has(v as u32) {
                continue;
            }
            if near[v] != NONE {
                let from = fine.ground.positions[near[v] as usize];
                under[v] = fine.walk(At::Vertex(near[v]), from, p, |_, _| {});
            }
            if under[v] == NONE {
                under[v] = fine_finder.triangle_at(p);
            }
            if under[v] != NONE {
                self.worst_m = self.worst_m.max(fine.ground.off_m(under[v], p));
            }
        }
        under
    }
}

/// Walks along an edge of the fine ground over the coarse one, to the triangle where it ends, and looks at each crossing.
fn walk_edge(fine: Ground<'_>, coarse: &Net<'_>, at: At, edge: [u32; 2], worst_m: &mut f64) -> u32 {
    let [p, q] = edge.map(|v| fine.positions[v as usize]);
    coarse.walk(at, p, q, |[a, b], share| {
        *worst_m = worst_m.max(off_at_crossing_m([p, q], [a, b], share));
    })
}

/// How two TINs differ where both are.
pub(crate) fn vertical_difference(fine: Ground<'_>, coarse: Ground<'_>) -> Difference {
    if fine.triangles.is_empty() || coarse.triangles.is_empty() {
        return Difference { worst_m: 0.0, under: vec![NONE; coarse.positions.len()] };
    }
    let mut overlay = Overlay::new(fine, coarse);
    overlay.walk_edges();
    overlay.cross_lost();
    let under = overlay.coarse_vertices();
    Difference { worst_m: overlay.worst_m, under }
}

/// The greatest vertical distance, metres, between two TINs where both are.
pub(crate) fn vertical_distance_m(fine: Ground<'_>, coarse: Ground<'_>) -> f64 {
    vertical_difference(fine, coarse).worst_m
}
