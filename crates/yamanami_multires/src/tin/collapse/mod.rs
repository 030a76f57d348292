//! Edge collapse for TINs: fewer triangles, as near in height as they can be, and always a TIN.
//!
//! Based on: Garland and Heckbert, "Surface Simplification Using Quadric Error Metrics", 1997. Where we differ, for the
//! ground seen from above: errors are vertical; no triangle ever turns over in plan, and none becomes a sliver; the
//! border and the breaklines stay lines, their vertices staying where they were surveyed or going.

mod chains;
mod look;
mod net;
mod points;
mod quadric;
#[cfg(test)]
mod tests;

use chains::Chains;
use glam::{DVec2, DVec3};
use look::Look;
use net::{Kind, NONE, Net, edge_key};
use points::Points;
use quadric::Quadric;
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use yamanami_core::Snap;

/// A new triangle's area in plan, twice, is at least this share of its longest side squared (about 1.5°), or no smaller
/// than that of the triangle before.
const LEAST_SHAPE: f64 = 0.025;

/// No triangle is thinner than this, whatever it was before.
const THINNEST: f64 = 1e-7;

/// What the vertex furthest from the surface costs, by its height squared and the area around it: four times what a cone of
/// that height does. Less lets spikes through, more spoils the mean (measured on hills: 1 and 16 are worse in both).
const SPIKE: f64 = 4.0 / 6.0;

/// What a line that strays costs, by the square of how far it does and of its length: enough that surfaces go first.
const STRAY: f64 = 16.0;

/// A vertex has at most so many triangles around it.
const MOST_AROUND: usize = 32;

/// What to collapse, and how far.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Task<'a> {
    /// Places in metres.
    pub positions: &'a [DVec3],
    /// Counter-clockwise from above, without overlap.
    pub triangles: &'a [[u32; 3]],
    /// Vertices that stay, by number.
    pub is_locked: &'a [bool],
    /// Edges of breaklines.
    pub lines: &'a [[u32; 2]],
    /// Stops at this many triangles.
    pub target: usize,
    /// Lines stray no further, metres.
    pub most_stray_m: f64,
    /// Where made vertices may lie; anywhere if `None`.
    pub snap: Option<Snap>,
}

/// What is left.
#[derive(Debug, Clone, Default)]
pub(crate) struct Reduced {
    pub positions: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    /// For each vertex the one that it was, untouched, or `u32::MAX` for a made one.
    pub source: Vec<u32>,
    /// Edges of breaklines that are left.
    pub lines: Vec<[u32; 2]>,
    /// No border and no breakline strayed further, metres.
    pub stray_m: f64,
}

/// A collapse looked at before it is done: who goes, who stays, and where.
#[derive(Debug, Clone, Copy)]
struct Way {
    gone: u32,
    kept: u32,
    place: DVec3,
}

/// An edge that may be collapsed, in one number, so that the heap is light: its cost, its ends, how often they had changed,
/// and whether the cost was measured or only estimated. The cheapest comes first; ties go by number, so that there is one
/// result.
type Candidate = Reverse<u128>;

fn candidate(cost: f32, [u, v]: [u32; 2], stamp: u32, is_measured: bool) -> Candidate {
    // bits of floats that are not negative are in their order
    let (cost, last) = (u128::from(cost.to_bits()), stamp << 1 | u32::from(is_measured));
    Reverse(cost << 96 | u128::from(u) << 64 | u128::from(v) << 32 | u128::from(last))
}

/// A collapse under way. Places are relative to `origin`.
struct Run<'a> {
    task: Task<'a>,
    origin: DVec3,
    net: Net,
    quadrics: Vec<Quadric>,
    /// How often a vertex changed: candidates of before are void.
    stamps: Vec<u32>,
    moved: Vec<bool>,
    heap: BinaryHeap<Candidate>,
    chains: Chains,
    points: Points,
    look: Look,
    left: usize,
}

/// Twice the area in plan.
fn area2(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

/// Collapses edges until the target is reached or none is left that may go.
pub(crate) fn reduce(task: Task<'_>) -> Reduced {
    let mut run = Run::new(task);
    run.start();
    run.work();
    run.finish()
}

impl<'a> Run<'a> {
    fn new(task: Task<'a>) -> Self {
        let origin = task.triangles.first().map_or(DVec3::ZERO, |t| task.positions[t[0] as usize]);
        let positions: Vec<DVec3> = task.positions.iter().map(|&p| p - origin).collect();
        let n = positions.len();
        let net = Net::new(positions, task.triangles.to_vec(), task.is_locked, task.lines);
        let left = task.triangles.len();
        let points = Points::new(&net);
        Self {
            task,
            origin,
            net,
            quadrics: vec![Quadric::default(); n],
            stamps: vec![0; n],
            moved: vec![false; n],
            heap: BinaryHeap::with_capacity(2 * left),
            chains: Chains::default(),
            points,
            look: Look::new(n),
            left,
        }
    }

    fn start(&mut self) {
        for t in &self.net.triangles {
            let quadric = Quadric::of_triangle(t.map(|v| self.net.positions[v as usize]));
            for &v in t {
                self.quadrics[v as usize].add(&quadric);
            }
        }
        let mut first = Vec::with_capacity(self.left * 2);
        for t in 0..self.net.triangles.len() {
            let [a, b, c] = self.net.triangles[t];
            for [u, v] in [[a, b], [b, c], [c, a]] {
                // each edge from one side; a border edge has only one
                if u < v || self.is_border(u, v) {
                    first.extend(self.candidate(u.min(v), u.max(v)));
                }
            }
        }
        self.heap = BinaryHeap::from(first);
    }

    /// Whether the triangle that has u → v is alone at this edge. Only asked where the other side would have been too.
    fn is_border(&self, u: u32, v: u32) -> bool {
        let joins =
            |w: u32, other: u32| matches!(self.net.kinds[w as usize], Kind::Chain(ends) if ends.contains(&other));
        (joins(u, v) || joins(v, u)) && !self.net.star(v).any(|[_, next, _]| next == u)
    }

    /// How u and v may become one, and what that costs, the cheapest first; none twice.
    fn ways(&self, u: u32, v: u32) -> impl Iterator<Item = Way> {
        let [ku, kv] = [u, v].map(|i| self.net.kinds[i as usize]);
        let [pu, pv] = [u, v].map(|i| self.net.positions[i as usize]);
        let along = |k: Kind, other: u32| matches!(k, Kind::Chain(ends) if ends.contains(&other));
        let [u_goes, v_goes] = [Way { gone: u, kept: v, place: pv }, Way { gone: v, kept: u, place: pu }];
        let ways: [Option<Way>; 3] = match (ku, kv) {
            (Kind::Free, Kind::Free) => {
                let best = self.best_place(u, v).0.map(|p| Way { place: self.snapped(p), ..u_goes });
                [best, Some(u_goes), Some(v_goes)]
            }
            (Kind::Free, Kind::Chain(_) | Kind::Fixed) => [Some(u_goes), None, None],
            (Kind::Chain(_) | Kind::Fixed, Kind::Free) => [Some(v_goes), None, None],
            (Kind::Chain(_), Kind::Chain(_)) if along(ku, v) && along(kv, u) => [Some(u_goes), Some(v_goes), None],
            (Kind::Chain(_), Kind::Fixed) if along(ku, v) => [Some(u_goes), None, None],
            (Kind::Fixed, Kind::Chain(_)) if along(kv, u) => [Some(v_goes), None, None],
            _ => [None; 3],
        };
        let mut ways = ways.map(|way| way.map_or((f64::INFINITY, u_goes), |way| (self.cost(&way), way)));
        ways.sort_by(|a, b| a.0.total_cmp(&b.0));
        ways.into_iter().take_while(|way| way.0 < f64::INFINITY).map(|way| way.1)
    }

    /// The place of least error for both of two free vertices, and their quadric.
    fn best_place(&self, u: u32, v: u32) -> (Option<DVec3>, Quadric) {
        let [pu, pv] = [u, v].map(|i| self.net.positions[i as usize]);
        let mut sum = self.quadrics[u as usize];
        sum.add(&self.quadrics[v as usize]);
        let length2 = DVec2::new(pv.x - pu.x, pv.y - pu.y).length_squared();
        (sum.best_place(0.5 * (pu + pv), 2.25 * length2), sum)
    }

    /// What joining u and v costs about, before anything else is looked at.
    fn estimate(&self, u: u32, v: u32) -> f64 {
        let [ku, kv] = [u, v].map(|i| self.net.kinds[i as usize]);
        let [pu, pv] = [u, v].map(|i| self.net.positions[i as usize]);
        let both_at = |p: DVec3| self.quadrics[u as usize].cost(p) + self.quadrics[v as usize].cost(p);
        match (ku, kv) {
            (Kind::Free, Kind::Free) => match self.best_place(u, v) {
                (Some(place), sum) => sum.cost(place),
                (None, sum) => sum.cost(pu).min(sum.cost(pv)),
            },
            (Kind::Free, _) => both_at(pv),
            (_, Kind::Free) => both_at(pu),
            _ => self.ways(u, v).map(|way| self.cost(&way)).fold(f64::INFINITY, f64::min),
        }
    }

    fn snapped(&self, p: DVec3) -> DVec3 {
        match self.task.snap {
            Some(snap) => snap.place(p + self.origin) - self.origin,
            None => p,
        }
    }

    /// What joining costs: vertical squares over the area, and for lines how far they stray, squared, times their length
    /// squared. Infinite where a line would stray too far.
    fn cost(&self, &Way { gone, kept, place }: &Way) -> f64 {
        let mut cost = self.quadrics[gone as usize].cost(place) + self.quadrics[kept as usize].cost(place);
        if let Some((other, stray_m)) = self.stray(gone, kept) {
            if stray_m > self.task.most_stray_m {
                return f64::INFINITY;
            }
            let length2 = self.net.positions[other as usize].distance_squared(self.net.positions[kept as usize]);
            cost += STRAY * stray_m * stray_m * length2;
        }
        cost
    }

    /// Where a vertex of a line goes along it: its other neighbour, and how far the line strays.
    fn stray(&self, gone: u32, kept: u32) -> Option<(u32, f64)> {
        let Kind::Chain(ends) = self.net.kinds[gone as usize] else { return None };
        let other = if ends[0] == kept { ends[1] } else { ends[0] };
        Some((other, self.chains.stray_m(&self.net.positions, kept, gone, other)))
    }

    fn candidate(&self, u: u32, v: u32) -> Option<Candidate> {
        let cost = self.estimate(u, v) as f32;
        (cost < f32::INFINITY).then(|| candidate(cost, [u, v], self.stamp(u, v), false))
    }

    /// How often two vertices have changed.
    fn stamp(&self, u: u32, v: u32) -> u32 {
        (self.stamps[u as usize].wrapping_add(self.stamps[v as usize])) & (u32::MAX >> 1)
    }

    fn work(&mut self) {
        while self.left > self.task.target {
            let Some(Reverse(entry)) = self.heap.pop() else { return };
            let (u, v, last) = ((entry >> 64) as u32, (entry >> 32) as u32, entry as u32);
            let is_there = |i: u32| self.net.kinds[i as usize] != Kind::Gone;
            if !(is_there(u) && is_there(v)) || self.stamp(u, v) != last >> 1 {
                continue;
            }
            if !self.look.may_join(&self.net, u, v) {
                continue;
            }
            let Some(way) = self.ways(u, v).find(|way| self.look.keeps_shape(&self.net, u, way)) else { continue };
            let (worst, area) = self.look.lift(&self.net, &self.points, u, &way);
            if last & 1 == 0 {
                let spike = (SPIKE * worst * area) as f32;
                if spike > f32::from_bits((entry >> 96) as u32) {
                    self.heap.push(candidate(spike, [u, v], last >> 1, true));
                    continue;
                }
            }
            self.join(&way);
            self.look.put(&mut self.points);
            let mut look = std::mem::take(&mut self.look);
            look.for_each_around(|n| {
                if let Some(candidate) = self.candidate(way.kept.min(n), way.kept.max(n)) {
                    self.heap.push(candidate);
                }
            });
            self.look = look;
        }
    }

    fn join(&mut self, &Way { gone, kept, place }: &Way) {
        if let Some((other, _)) = self.stray(gone, kept) {
            self.chains.join(&self.net.positions, kept, gone, other);
            for (v, from, to) in [(kept, gone, other), (other, gone, kept)] {
                if let Kind::Chain(ends) = &mut self.net.kinds[v as usize] {
                    ends.iter_mut().filter(|e| **e == from).for_each(|e| *e = to);
                }
            }
        }
        self.left -= self.net.join(gone, kept);
        let quadric = self.quadrics[gone as usize];
        self.quadrics[kept as usize].add(&quadric);
        if self.net.positions[kept as usize] != place {
            self.net.positions[kept as usize] = place;
            self.moved[kept as usize] = true;
        }
        self.stamps[kept as usize] = self.stamps[kept as usize].wrapping_add(1);
    }

    fn finish(self) -> Reduced {
        let mut number = vec![NONE; self.net.positions.len()];
        let mut out = Reduced { stray_m: self.chains.worst_m, ..Reduced::default() };
        out.triangles.reserve_exact(self.left);
        for (t, _) in self.net.triangles.iter().zip(&self.net.is_alive).filter(|(_, alive)| **alive) {
            out.triangles.push(t.map(|v| {
                let number = &mut number[v as usize];
                if *number == NONE {
                    *number = out.positions.len() as u32;
                    let (position, source) = if self.moved[v as usize] {
                        // the sum is exact where places are multiples of one small step
                        let place = self.net.positions[v as usize] + self.origin;
                        (self.task.snap.map_or(place, |snap| snap.place(place)), NONE)
                    } else {
                        (self.task.positions[v as usize], v)
                    };
                    out.positions.push(position);
                    out.source.push(source);
                }
                *number
            }));
        }
        out.lines = self.lines_left(&number);
        out
    }

    /// The breaklines' edges: along each line from one vertex that is left to the next.
    fn lines_left(&self, number: &[u32]) -> Vec<[u32; 2]> {
        if self.task.lines.is_empty() {
            return Vec::new();
        }
        let mut left = Vec::new();
        let mut beside: std::collections::HashMap<u32, Vec<u32>> = std::collections::HashMap::new();
        for &[a, b] in self.task.lines {
            beside.entry(a).or_default().push(b);
            beside.entry(b).or_default().push(a);
        }
        let is_left = |v: u32| number[v as usize] != NONE;
        for (&v, nexts) in beside.iter().filter(|(v, _)| is_left(**v)) {
            for &next in nexts {
                let (mut before, mut at) = (v, next);
                // those gone had two neighbours on lines, so there is one way on
                while !is_left(at) {
                    let Some(&on) = beside[&at].iter().find(|&&w| w != before) else { break };
                    (before, at) = (at, on);
                    if at == v {
                        break;
                    }
                }
                if is_left(at) && at != v {
                    left.push(edge_key(number[v as usize], number[at as usize]));
                }
            }
        }
        left.sort_unstable();
        left.dedup();
        left.into_iter().map(|edge| [(edge >> 32) as u32, edge as u32]).collect()
    }
}
