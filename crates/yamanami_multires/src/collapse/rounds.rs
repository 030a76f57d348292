//! The collapse in rounds: each takes all edges up to a cost, in the order of memory; the next takes a little more.
//!
//! Every vertex keeps the cost of its cheapest edge. A collapse marks the vertices around it stale; a stale vertex is weighed
//! anew only when a round reaches the cost it had, for costs seldom fall. So there is no queue, and work stays where it is
//! in the cache. Where the last round would go too far, its edges are taken in the order of their costs.

use super::StoppedBy;
use super::plane_sum::{PlaneSum, PlaneSummer, best_place};
use super::work::{Work, hold};
use glam::DVec3;

/// Share of the vertices that a round may find.
const SHARE_OF_ROUND: f64 = 0.03;

/// Compacts when this share of the vertices is gone.
const COMPACT_AT: f64 = 0.4;

/// What is known of a vertex is out of date.
const SUM_IS_STALE: u8 = 1;
const EDGE_IS_STALE: u8 = 2;
/// An edge cheaper than its key could not be taken.
const BLOCKED: u8 = 4;

/// When to stop.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stop {
    pub(super) faces: usize,
    /// Largest estimate of a step's distance, units of the work.
    pub(super) error: f64,
}

/// A mesh with what is known of its vertices.
#[derive(Debug)]
pub(super) struct Rounds<'w> {
    work: &'w mut Work,
    sources: &'w mut Vec<u32>,
    sums: Vec<PlaneSum>,
    /// Cost of the cheapest edge; infinite for none.
    key: Vec<f32>,
    /// Its other end.
    partner: Vec<u32>,
    state: Vec<u8>,
    gone: usize,
    /// The largest estimate of a step taken.
    pub(super) worst: f64,
    ring: Vec<u32>,
    tried: Vec<u32>,
}

/// What an edge costs.
#[derive(Debug, Clone, Copy)]
struct Weighed {
    cost: f32,
    place: DVec3,
}

impl<'w> Rounds<'w> {
    pub(super) fn new(work: &'w mut Work, sources: &'w mut Vec<u32>) -> Self {
        let n = work.positions.len();
        let mut rounds = Self {
            work,
            sources,
            sums: vec![PlaneSum::default(); n],
            key: vec![f32::INFINITY; n],
            partner: vec![u32::MAX; n],
            state: vec![SUM_IS_STALE; n],
            gone: 0,
            worst: 0.0,
            ring: Vec::new(),
            tried: Vec::new(),
        };
        for v in 0..n as u32 {
            rounds.weigh_vertex(v);
        }
        rounds
    }

    /// Collapses until something says stop. `progress` hears of the faces left.
    pub(super) fn run(&mut self, stop: Stop, progress: &dyn Fn(usize)) -> StoppedBy {
        loop {
            if self.work.faces() <= stop.faces {
                return StoppedBy::Target;
            }
            let Some(limit) = self.next_limit() else {
                return StoppedBy::Topology;
            };
            let wanted = (self.work.faces() - stop.faces).div_ceil(2);
            let found: Vec<u32> = (0..self.key.len() as u32).filter(|&v| self.key[v as usize] <= limit).collect();
            let before = found.len();
            if before > wanted {
                self.take_in_order(found, stop);
            } else {
                for v in found {
                    self.take(v, limit, stop);
                    if self.work.faces() <= stop.faces {
                        break;
                    }
                }
            }
            progress(self.work.faces());
            if self.gone as f64 > COMPACT_AT * self.key.len() as f64 {
                self.compact();
            }
        }
    }

    /// The cost up to which the next round goes: the least step of an eighth of an octave that finds the share of vertices.
    fn next_limit(&self) -> Option<f32> {
        const SHIFT: u32 = 20;
        let mut counts = vec![0u32; 1 << (31 - SHIFT)];
        for &key in &self.key {
            counts[(key.to_bits() >> SHIFT) as usize] += 1;
        }
        let infinite = (f32::INFINITY.to_bits() >> SHIFT) as usize;
        let alive: u32 = counts[..infinite].iter().sum();
        let wanted = (f64::from(alive) * SHARE_OF_ROUND) as u32;
        let mut sum = 0;
        for (bin, &count) in counts[..infinite].iter().enumerate() {
            sum += count;
            if sum > wanted {
                return Some(f32::from_bits(((bin as u32 + 1) << SHIFT) - 1));
            }
        }
        None
    }

    /// Takes the edges of these vertices, the cheapest first.
    fn take_in_order(&mut self, mut found: Vec<u32>, stop: Stop) {
        found.sort_unstable_by(|&a, &b| self.key[a as usize].total_cmp(&self.key[b as usize]).then(a.cmp(&b)));
        for v in found {
            if self.work.faces() <= stop.faces {
                return;
            }
            let limit = self.key[v as usize];
            self.take(v, limit, stop);
        }
    }

    /// Takes the vertex's cheapest edge that may go, if it costs no more than `limit`.
    fn take(&mut self, v: u32, limit: f32, stop: Stop) {
        if self.work.is_gone(v) {
            return;
        }
        if self.state[v as usize] & (SUM_IS_STALE | EDGE_IS_STALE) != 0 {
            self.weigh_vertex(v);
        }
        let mut tried = std::mem::take(&mut self.tried);
        tried.clear();
        while self.key[v as usize] <= limit {
            let partner = self.partner[v as usize];
            let weighed = self.weigh_edge(v, partner);
            if self.collapse(v, partner, weighed, stop) {
                break;
            }
            tried.push(partner);
            self.weigh_others(v, &tried);
        }
        self.tried = tried;
    }

    /// Collapses an edge unless that does harm.
    fn collapse(&mut self, v: u32, partner: u32, weighed: Weighed, stop: Stop) -> bool {
        let estimate = self.estimate(v, partner, weighed.cost);
        if estimate > stop.error {
            return false;
        }
        let (from, to) = (self.work.positions[v as usize], self.work.positions[partner as usize]);
        let holds = self.work.holds[v as usize] | self.work.holds[partner as usize];
        // the one whose place is kept stays
        let (stays, goes) = if holds != 0 && weighed.place == to { (partner, v) } else { (v, partner) };
        let way = to - from;
        let share = ((weighed.place - from).dot(way) / way.length_squared()).clamp(0.0, 1.0) as f32;
        let share = if stays == v { share } else { 1.0 - share };
        if !self.work.collapse(goes, stays, weighed.place, share) {
            return false;
        }
        self.worst = self.worst.max(estimate);
        self.gone += 1;
        self.key[goes as usize] = f32::INFINITY;
        let mut ring = std::mem::take(&mut self.ring);
        self.work.neighbours(stays, &mut ring);
        for &r in &ring {
            let state = &mut self.state[r as usize];
            *state |= SUM_IS_STALE | EDGE_IS_STALE;
            if *state & BLOCKED != 0 {
                self.key[r as usize] = self.key[r as usize].min(weighed.cost);
            }
        }
        self.ring = ring;
        self.state[stays as usize] = SUM_IS_STALE | EDGE_IS_STALE;
        // weighed when a round reaches it
        self.key[stays as usize] = weighed.cost;
        true
    }

    /// Root of the mean squared distance over the triangles around an edge.
    fn estimate(&self, a: u32, b: u32, cost: f32) -> f64 {
        let area = self.sums[a as usize].total_area() + self.sums[b as usize].total_area();
        if area > 0.0 { (f64::from(cost) / area).sqrt() } else { 0.0 }
    }

    fn weigh_vertex(&mut self, v: u32) {
        self.state[v as usize] &= !BLOCKED;
        self.weigh_others(v, &[]);
    }

    /// Finds the vertex's cheapest edge but those `tried`.
    fn weigh_others(&mut self, v: u32, tried: &[u32]) {
        let mut ring = std::mem::take(&mut self.ring);
        self.work.neighbours(v, &mut ring);
        let (mut best, mut partner) = (f32::INFINITY, u32::MAX);
        for &n in ring.iter().filter(|n| !tried.contains(n)) {
            let cost = self.weigh_edge(v, n).cost;
            if cost < best {
                (best, partner) = (cost, n);
            }
        }
        self.ring = ring;
        (self.key[v as usize], self.partner[v as usize]) = (best, partner);
        self.state[v as usize] &= !EDGE_IS_STALE;
        if !tried.is_empty() {
            self.state[v as usize] |= BLOCKED;
        }
    }

    fn weigh_edge(&mut self, a: u32, b: u32) -> Weighed {
        self.refresh(a);
        self.refresh(b);
        let (sum_a, sum_b) = (&self.sums[a as usize], &self.sums[b as usize]);
        let (from, to) = (self.work.positions[a as usize], self.work.positions[b as usize]);
        let edge = to - from;
        let [hold_a, hold_b] = [a, b].map(|v| self.work.holds[v as usize]);
        if hold_a | hold_b == 0 {
            let (place, cost) = best_place(sum_a, sum_b, edge);
            return Weighed { cost: cost as f32, place: from + place };
        }
        match self.work.kept_end(a, b) {
            Kept::First => Weighed { cost: sum_b.at(-edge) as f32, place: from },
            Kept::Second => Weighed { cost: sum_a.at(edge) as f32, place: to },
            Kept::Neither => {
                let (place, cost) = best_place(sum_a, sum_b, edge);
                Weighed { cost: cost as f32, place: from + place }
            }
            Kept::Both => Weighed { cost: f32::INFINITY, place: from },
        }
    }

    /// Sums a vertex's planes anew if they have changed.
    #[inline]
    fn refresh(&mut self, v: u32) {
        if self.state[v as usize] & SUM_IS_STALE != 0 {
            self.state[v as usize] &= !SUM_IS_STALE;
            self.sums[v as usize] = plane_sum(self.work, v);
        }
    }

    fn compact(&mut self) {
        let mut kept = 0;
        let (sums, key, partner, state, sources) =
            (&mut self.sums, &mut self.key, &mut self.partner, &mut self.state, &mut *self.sources);
        self.work.compact(|v| {
            let v = v as usize;
            sums[kept] = sums[v];
            key[kept] = key[v];
            // partners have other numbers now
            state[kept] = state[v] | EDGE_IS_STALE;
            sources[kept] = sources[v];
            kept += 1;
        });
        sums.truncate(kept);
        key.truncate(kept);
        partner.truncate(kept);
        state.truncate(kept);
        sources.truncate(kept);
        self.gone = 0;
    }
}

/// Which ends of an edge must stay where they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kept {
    Neither,
    First,
    Second,
    Both,
}

/// The planes around a vertex, with the lines of its borders and creases.
fn plane_sum(work: &Work, v: u32) -> PlaneSum {
    let mut sum = PlaneSummer::default();
    let at = work.positions[v as usize];
    let star = work.star(v);
    let mut turned = 0u64;
    for corner in star {
        let [_, b, c] = corner.turned(&work.triangles);
        sum.add_triangle(work.positions[b as usize] - at, work.positions[c as usize] - at);
        // around a closed star every neighbour is once next and once last
        turned = turned.wrapping_add(u64::from(b).wrapping_mul(0x9E37_79B9_7F4A_7C15));
        turned = turned.wrapping_sub(u64::from(c).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    }
    if turned != 0 || work.holds[v as usize] & hold::CREASE != 0 {
        work.for_lines(v, |n| sum.add_line(work.positions[n as usize] - at, LINE_WEIGHT));
    }
    sum.finish()
}

/// How much a border's line weighs beside a surface.
const LINE_WEIGHT: f64 = 1.0;
