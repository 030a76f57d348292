//! The collapse in rounds: each takes the edges of a block up to a cost, in the order of memory; the next takes a little
//! more, until all blocks have come to a common cost, which then rises.
//!
//! Every vertex keeps the cost of its cheapest edge. A collapse marks the vertices around it stale; a stale vertex is weighed
//! anew only when a round reaches the cost it had, for costs seldom fall. So there is no queue, and work stays where it is
//! in the cache. Where the last round would go too far, its edges are taken in the order of their costs.

use super::StoppedBy;
use super::appearance_sum::{self, AppearanceSum, Scales, VALUES, appearance_sum, scaled};
use super::plane_sum::{EDGES_ABREAST, PlaneSum, best_place, best_places};
use super::surroundings::plane_sum;
use super::work::{Kept, Work, hold};
use glam::DVec3;
use std::ops::Range;

/// Share of the vertices whose edges a sweep over the whole mesh takes, and a round within a block.
const SHARE_OF_SWEEP: f64 = 0.5;
const SHARE_OF_ROUND: f64 = 0.06;

/// Vertices that go through their rounds together: what is around them stays in the cache.
const BLOCK: usize = 4096;

/// Bits of a cost that tell less than an eighth of an octave.
const KEY_SHIFT: u32 = 20;

/// Compacts when this share of the vertices is gone.
const COMPACT_AT: f64 = 0.4;

/// What is known of a vertex is out of date.
const SUM_IS_STALE: u8 = 1;
const EDGE_IS_STALE: u8 = 2;
/// An edge cheaper than its key could not be taken.
const BLOCKED: u8 = 4;
/// The triangles around the vertex close a ring.
const IS_CLOSED: u8 = 8;

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
    /// The appearance around each vertex, where it counts.
    looks: Vec<AppearanceSum>,
    scales: Option<Scales>,
    /// Cost of the cheapest edge; infinite for none.
    key: Vec<f32>,
    /// Its other end.
    partner: Vec<u32>,
    state: Vec<u8>,
    gone: usize,
    /// A step was left out because its estimate was too large.
    by_error: bool,
    /// Scratch: vertices by cost.
    counts: Vec<u32>,
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
    /// `scales` says how much the appearance counts.
    pub(super) fn new(work: &'w mut Work, sources: &'w mut Vec<u32>, scales: Option<Scales>) -> Self {
        let n = work.positions.len();
        let mut rounds = Self {
            work,
            sources,
            sums: vec![PlaneSum::default(); n],
            looks: vec![AppearanceSum::default(); if scales.is_some() { n } else { 0 }],
            scales,
            key: vec![f32::INFINITY; n],
            partner: vec![u32::MAX; n],
            state: vec![SUM_IS_STALE; n],
            gone: 0,
            by_error: false,
            counts: vec![0; 1 << (32 - KEY_SHIFT)],
            worst: 0.0,
            ring: Vec::new(),
            tried: Vec::new(),
        };
        for v in 0..n as u32 {
            rounds.weigh_vertex(v);
        }
        rounds
    }

    /// Triangles left.
    pub(super) fn faces(&self) -> usize {
        self.work.faces()
    }

    /// Collapses until something says stop. `progress` hears of the faces left.
    pub(super) fn run(&mut self, stop: Stop, progress: &dyn Fn(usize)) -> StoppedBy {
        loop {
            while let Some(limit) = Self::limit_of_sweep(std::slice::from_ref(self), self.faces(), stop.faces) {
                self.sweep(limit, stop);
                progress(self.faces());
            }
            // the last few over the whole mesh, in the order of their costs
            if self.faces() <= stop.faces {
                return StoppedBy::Target;
            }
            let limit = self.limit_of(0..self.key.len(), SHARE_OF_ROUND);
            let found: Vec<u32> = (0..self.key.len() as u32).filter(|&v| self.key[v as usize] <= limit).collect();
            if limit == f32::INFINITY || found.is_empty() {
                return if self.by_error { StoppedBy::Error } else { StoppedBy::Topology };
            }
            self.take_in_order(found, stop);
        }
    }

    /// The cost up to which the next sweep over some meshes should go, that have so many faces together and are to have
    /// `goal`; `None` when a sweep might go too far, or there is nothing to do.
    pub(super) fn limit_of_sweep(all: &[Self], faces: usize, goal: usize) -> Option<f32> {
        let wanted = faces.saturating_sub(goal).div_ceil(2);
        let mut counts = vec![0; 1 << (32 - KEY_SHIFT)];
        all.iter().for_each(|rounds| count(&rounds.key, &mut counts));
        let alive: u32 = counts[..INFINITE].iter().sum();
        // a collapse often makes room for another below the same cost
        let share = (0.4 * wanted as f64 / f64::from(alive.max(1))).min(SHARE_OF_SWEEP);
        let limit = limit_of(&counts, share);
        (share > SHARE_OF_ROUND && limit < f32::INFINITY).then_some(limit)
    }

    /// Takes all edges up to a cost, block by block.
    pub(super) fn sweep(&mut self, limit: f32, stop: Stop) {
        for start in (0..self.key.len()).step_by(BLOCK) {
            self.settle(start..(start + BLOCK).min(self.key.len()), limit, stop);
        }
        if self.gone as f64 > COMPACT_AT * self.key.len() as f64 {
            self.compact();
        }
    }

    /// Takes a block's edges up to a cost, in rounds.
    fn settle(&mut self, block: Range<usize>, limit: f32, stop: Stop) {
        loop {
            let round = self.limit_of(block.clone(), SHARE_OF_ROUND).min(limit);
            for v in block.clone() {
                if self.key[v] <= round {
                    if self.work.faces() <= stop.faces {
                        return;
                    }
                    self.take(v as u32, round, stop);
                }
            }
            if round == limit {
                return;
            }
        }
    }

    /// [`limit_of`] some of the vertices.
    fn limit_of(&mut self, vertices: Range<usize>, share: f64) -> f32 {
        self.counts.fill(0);
        count(&self.key[vertices], &mut self.counts);
        limit_of(&self.counts, share)
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
            // it lost its last triangle with another's edge: it must not count as an edge to go
            self.key[v as usize] = f32::INFINITY;
            return;
        }
        if self.state[v as usize] & EDGE_IS_STALE != 0 {
            // often the edge that was the cheapest still is cheap enough: then the others need not be weighed
            let partner = self.partner[v as usize];
            if partner < self.key.len() as u32
                && self.work.star(v).iter().any(|c| c.turned(&self.work.triangles)[1] == partner)
            {
                let weighed = self.weigh_edge(v, partner);
                if weighed.cost <= limit && self.collapse(v, partner, weighed, stop) {
                    return;
                }
            }
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
            self.by_error = true;
            return false;
        }
        let (from, to) = (self.work.positions[v as usize], self.work.positions[partner as usize]);
        let holds = self.work.holds[v as usize] | self.work.holds[partner as usize];
        // the one whose place is kept stays
        let (stays, goes) = if holds != 0 && weighed.place == to { (partner, v) } else { (v, partner) };
        let way = to - from;
        let share = ((weighed.place - from).dot(way) / way.length_squared()).clamp(0.0, 1.0) as f32;
        let share = if stays == v { share } else { 1.0 - share };
        let blended = if holds & hold::LOCKED == 0 { self.blend(v, partner, weighed.place) } else { None };
        if !self.work.collapse(goes, stays, weighed.place, share) {
            return false;
        }
        self.worst = self.worst.max(estimate);
        for &gone in self.work.just_gone() {
            self.key[gone as usize] = f32::INFINITY;
            self.gone += 1;
        }
        if self.work.is_gone(stays) {
            return true;
        }
        if let (Some((mut values, _)), Some(scales)) = (blended, &self.scales) {
            let wedge = self.work.wedge(stays);
            let own = self.work.appearance.weighable(wedge);
            for ((value, scale), own) in values.iter_mut().zip(scales).zip(own) {
                // what does not count was blended along the edge
                *value = if *scale > 0.0 { *value / scale } else { own };
            }
            self.work.appearance.set_weighable(wedge, &values);
        }
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
        self.refresh(v);
        let mut ring = std::mem::take(&mut self.ring);
        if self.state[v as usize] & IS_CLOSED != 0 {
            ring.clear();
            ring.extend(self.work.star(v).iter().map(|corner| corner.turned(&self.work.triangles)[1]));
        } else {
            self.work.neighbours(v, &mut ring);
        }
        ring.retain(|n| !tried.contains(n));
        let (mut best, mut partner) = (f32::INFINITY, u32::MAX);
        let is_held = |work: &Work, n: u32| work.holds[n as usize] != 0;
        let mut consider = |cost: f32, n: u32| {
            if cost < best {
                (best, partner) = (cost, n);
            }
        };
        if is_held(self.work, v) || ring.iter().any(|&n| is_held(self.work, n)) {
            for &n in &ring {
                consider(self.weigh_edge(v, n).cost, n);
            }
        } else {
            let at = self.work.positions[v as usize];
            ring.iter().for_each(|&n| self.refresh(n));
            for some in ring.chunks(EDGES_ABREAST) {
                // the last fills the lanes up
                let lane = |l: usize| some[l.min(some.len() - 1)] as usize;
                let seconds = std::array::from_fn(|l| &self.sums[lane(l)]);
                let edges = std::array::from_fn(|l| self.work.positions[lane(l)] - at);
                let found = best_places(&self.sums[v as usize], seconds, edges);
                for (&n, (place, cost)) in some.iter().zip(found) {
                    let change = self.blend(v, n, at + place).map_or(0.0, |(_, change)| change as f32);
                    consider(cost as f32 + change, n);
                }
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
        let held = self.work.holds[a as usize] | self.work.holds[b as usize] != 0;
        let kept = if held { self.work.kept_end(a, b) } else { Kept::Neither };
        let mut weighed = match kept {
            Kept::First => Weighed { cost: sum_b.at(-edge) as f32, place: from },
            Kept::Second => Weighed { cost: sum_a.at(edge) as f32, place: to },
            Kept::Both => return Weighed { cost: f32::INFINITY, place: from },
            Kept::Neither => {
                let (place, cost) = best_place(sum_a, sum_b, edge);
                Weighed { cost: cost as f32, place: from + place }
            }
        };
        if let Some((_, change)) = self.blend(a, b, weighed.place) {
            weighed.cost += change as f32;
        }
        weighed
    }

    /// The best appearance at a place for an edge whose ends look the same from all sides, and what it changes.
    fn blend(&self, a: u32, b: u32, place: DVec3) -> Option<([f32; VALUES], f64)> {
        let scales = self.scales.as_ref()?;
        if (self.work.holds[a as usize] | self.work.holds[b as usize]) & hold::CREASE != 0 {
            return None;
        }
        let end = |v: u32| {
            let values = scaled(self.work, self.work.wedge(v), scales);
            (&self.looks[v as usize], values, place - self.work.positions[v as usize])
        };
        Some(appearance_sum::blend([end(a), end(b)]))
    }

    /// Sums a vertex's planes anew if they have changed.
    #[inline]
    fn refresh(&mut self, v: u32) {
        if self.state[v as usize] & SUM_IS_STALE != 0 {
            let (sum, is_closed) = plane_sum(self.work, v);
            self.sums[v as usize] = sum;
            if let Some(scales) = &self.scales {
                self.looks[v as usize] = appearance_sum(self.work, v, scales);
            }
            let state = &mut self.state[v as usize];
            *state = *state & !(SUM_IS_STALE | IS_CLOSED) | if is_closed { IS_CLOSED } else { 0 };
        }
    }

    fn compact(&mut self) {
        let mut kept = 0;
        let (sums, looks, key, partner, state, sources) =
            (&mut self.sums, &mut self.looks, &mut self.key, &mut self.partner, &mut self.state, &mut *self.sources);
        let has_looks = !looks.is_empty();
        self.work.compact(|v| {
            let v = v as usize;
            sums[kept] = sums[v];
            key[kept] = key[v];
            if has_looks {
                looks[kept] = looks[v];
            }
            // partners have other numbers now
            (partner[kept], state[kept]) = (u32::MAX, state[v] | EDGE_IS_STALE);
            sources[kept] = sources[v];
            kept += 1;
        });
        sums.truncate(kept);
        looks.truncate(kept);
        key.truncate(kept);
        partner.truncate(kept);
        state.truncate(kept);
        sources.truncate(kept);
        self.gone = 0;
    }
}

/// Keys that are infinite, among the counts.
const INFINITE: usize = (f32::INFINITY.to_bits() >> KEY_SHIFT) as usize;

/// Counts keys by their first bits.
fn count(keys: &[f32], counts: &mut [u32]) {
    for key in keys {
        counts[(key.to_bits() >> KEY_SHIFT) as usize] += 1;
    }
}

/// The least cost, in steps of an eighth of an octave, up to which this share of the counted edges go; infinite where there
/// are none.
fn limit_of(counts: &[u32], share: f64) -> f32 {
    let all: u32 = counts[..INFINITE].iter().sum();
    let wanted = (f64::from(all) * share) as u32;
    let mut sum = 0;
    for (bin, &count) in counts[..INFINITE].iter().enumerate() {
        sum += count;
        if sum > wanted {
            return f32::from_bits(((bin as u32 + 1) << KEY_SHIFT) - 1);
        }
    }
    f32::INFINITY
}
