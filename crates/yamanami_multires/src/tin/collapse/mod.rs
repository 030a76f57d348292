//! Edge collapse for TINs: fewer triangles, as near in height as they can be, and always a TIN.
//!
//! Based on: Garland and Heckbert, "Surface Simplification Using Quadric Error Metrics", 1997. Where we differ, for the
//! ground seen from above: errors are vertical; no triangle ever turns over in plan, and none becomes a sliver; the
//! border and the breaklines stay lines, their vertices staying where they were surveyed or going.

mod chains;
mod net;
mod points;
mod quadric;
#[cfg(test)]
mod tests;

use chains::Chains;
use glam::{DVec2, DVec3};
use net::{Kind, NONE, Net, edge_key};
use points::{Points, Way};
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

/// An edge that may be collapsed, the cheapest first; ties by number, so that there is one result.
/// Whether its cost was measured or only estimated comes last.
type Candidate = Reverse<(u64, u32, u32, u32, bool)>;

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
    left: usize,
}

/// Twice the area in plan.
fn area2(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

/// Area in plan, twice, and the same over the longest side squared.
fn shape(a: DVec3, b: DVec3, c: DVec3) -> (f64, f64) {
    let flat = |p: DVec3, q: DVec3| DVec2::new(q.x - p.x, q.y - p.y).length_squared();
    let longest = flat(a, b).max(flat(b, c)).max(flat(c, a));
    let area = area2(a, b, c);
    (area, area / longest.max(f64::MIN_POSITIVE))
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

    /// How u and v may become one: who goes, who stays, and where; the cheapest way, if there is any.
    fn ways(&self, u: u32, v: u32) -> impl Iterator<Item = (u32, u32, DVec3)> {
        let [ku, kv] = [u, v].map(|i| self.net.kinds[i as usize]);
        let [pu, pv] = [u, v].map(|i| self.net.positions[i as usize]);
        let along = |k: Kind, other: u32| matches!(k, Kind::Chain(ends) if ends.contains(&other));
        let ways: [Option<(u32, u32, DVec3)>; 3] = match (ku, kv) {
            (Kind::Free, Kind::Free) => {
                let mut sum = self.quadrics[u as usize];
                sum.add(&self.quadrics[v as usize]);
                let length_m = DVec2::new(pv.x - pu.x, pv.y - pu.y).length();
                let best = sum.best_place(0.5 * (pu + pv), 1.5 * length_m).map(|p| (u, v, self.snapped(p)));
                [best, Some((u, v, pv)), Some((v, u, pu))]
            }
            (Kind::Free, Kind::Chain(_) | Kind::Fixed) => [Some((u, v, pv)), None, None],
            (Kind::Chain(_) | Kind::Fixed, Kind::Free) => [Some((v, u, pu)), None, None],
            (Kind::Chain(_), Kind::Chain(_)) if along(ku, v) && along(kv, u) => {
                [Some((u, v, pv)), Some((v, u, pu)), None]
            }
            (Kind::Chain(_), Kind::Fixed) if along(ku, v) => [Some((u, v, pv)), None, None],
            (Kind::Fixed, Kind::Chain(_)) if along(kv, u) => [Some((v, u, pu)), None, None],
            _ => [None; 3],
        };
        ways.into_iter().flatten()
    }

    fn snapped(&self, p: DVec3) -> DVec3 {
        match self.task.snap {
            Some(snap) => snap.place(p + self.origin) - self.origin,
            None => p,
        }
    }

    /// What joining costs: vertical squares over the area, and for lines how far they stray, squared, times their length
    /// squared. Infinite where a line would stray too far.
    fn cost(&self, gone: u32, kept: u32, place: DVec3) -> f64 {
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
        let best =
            self.ways(u, v).map(|(gone, kept, place)| self.cost(gone, kept, place)).fold(f64::INFINITY, f64::min);
        // bits of floats that are not negative are in their order
        (best < f64::INFINITY).then(|| {
            Reverse((best.to_bits(), u, v, self.stamps[u as usize].wrapping_add(self.stamps[v as usize]), false))
        })
    }

    fn work(&mut self) {
        let mut around = Vec::with_capacity(MOST_AROUND);
        let (mut gathered, mut fan) = (Vec::new(), Vec::new());
        while self.left > self.task.target {
            let Some(Reverse((bits, u, v, stamp, is_measured))) = self.heap.pop() else { return };
            let is_there = |i: u32| self.net.kinds[i as usize] != Kind::Gone;
            if !(is_there(u) && is_there(v)) || self.stamps[u as usize].wrapping_add(self.stamps[v as usize]) != stamp {
                continue;
            }
            if !self.may_join(u, v) {
                continue;
            }
            let Some(way) = self.best_way(u, v) else { continue };
            self.points.gather(&self.net, way, &mut gathered);
            if !is_measured {
                let (worst, area) = self.points.lift(&self.net, way, &gathered, &mut fan);
                let spike = (SPIKE * worst * area).to_bits();
                if spike > bits {
                    self.heap.push(Reverse((spike, u, v, stamp, true)));
                    continue;
                }
            }
            let Way { gone, kept, place } = way;
            self.join(gone, kept, place);
            self.points.put(&self.net, kept, &gathered);
            around.clear();
            around.extend(self.net.star(kept).flat_map(|[_, from, to]| [from, to]));
            around.sort_unstable();
            around.dedup();
            for &n in &around {
                if let Some(candidate) = self.candidate(kept.min(n), kept.max(n)) {
                    self.heap.push(candidate);
                }
            }
        }
    }

    /// The cheapest way to join two vertices that keeps every triangle in shape.
    fn best_way(&self, u: u32, v: u32) -> Option<Way> {
        let mut best: Option<(f64, Way)> = None;
        for (gone, kept, place) in self.ways(u, v) {
            let cost = self.cost(gone, kept, place);
            if best.is_none_or(|(least, _)| cost < least) && cost < f64::INFINITY && self.keeps_shape(gone, kept, place)
            {
                best = Some((cost, Way { gone, kept, place }));
            }
        }
        best.map(|(_, way)| way)
    }

    /// Whether the surface stays one: the neighbours of both are the tips of the triangles of both, and no line closes.
    fn may_join(&self, u: u32, v: u32) -> bool {
        let (mut count, mut tips) = (0, [NONE; 2]);
        for [_, from, to] in self.net.star(u) {
            let tip = if from == v {
                to
            } else if to == v {
                from
            } else {
                continue;
            };
            if count == 2 {
                return false;
            }
            tips[count] = tip;
            count += 1;
        }
        if count == 0 {
            return false;
        }
        let of_line = |w: u32| match self.net.kinds[w as usize] {
            Kind::Chain(ends) => ends,
            _ => [NONE; 2],
        };
        let [lu, lv] = [of_line(u), of_line(v)];
        // the other neighbour along the line must not be a tip, nor be the other's too
        let closes = |line: [u32; 2]| line.iter().any(|w| *w != NONE && tips[..count].contains(w));
        if (lu.contains(&v) || lv.contains(&u)) && (closes(lu) || closes(lv)) {
            return false;
        }
        if lu.contains(&v) && lv.contains(&u) && lu.iter().any(|w| *w != v && lv.contains(w)) {
            return false;
        }
        let mut common = 0;
        let mut sizes = [0usize; 2];
        let mut seen: [u32; 2 * MOST_AROUND] = [NONE; 2 * MOST_AROUND];
        for [_, from, to] in self.net.star(u) {
            for w in [from, to] {
                if w != v && !seen[..sizes[0]].contains(&w) {
                    if sizes[0] == seen.len() {
                        return false;
                    }
                    seen[sizes[0]] = w;
                    sizes[0] += 1;
                }
            }
        }
        let mut counted: [u32; 2] = [NONE; 2];
        for [_, from, to] in self.net.star(v) {
            sizes[1] += 1;
            for w in [from, to] {
                if w != u && seen[..sizes[0]].contains(&w) && !counted[..common.min(2)].contains(&w) {
                    if common == 2 {
                        return false;
                    }
                    counted[common] = w;
                    common += 1;
                }
            }
        }
        common == count && sizes[0] + sizes[1] <= MOST_AROUND + 4
    }

    /// Whether every triangle that stays keeps its side up and does not become a sliver.
    fn keeps_shape(&self, gone: u32, kept: u32, place: DVec3) -> bool {
        let p = |v: u32| self.net.positions[v as usize];
        let is_sound = |v: u32, other: u32| {
            self.net.star(v).filter(|t| !t.contains(&other)).all(|[_, from, to]| {
                let (area, now) = shape(place, p(from), p(to));
                area > 0.0 && now > THINNEST && (now >= LEAST_SHAPE || now >= shape(p(v), p(from), p(to)).1)
            })
        };
        is_sound(gone, kept) && (place == p(kept) || is_sound(kept, gone))
    }

    fn join(&mut self, gone: u32, kept: u32, place: DVec3) {
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
