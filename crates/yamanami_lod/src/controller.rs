//! The exact controller: moves the front to where greedy refinement would put it, at a cost proportional to the change.
//!
//! Based on: Duchaineau et al., "ROAMing terrain: real-time optimally adapting meshes", 1997 (two queues, deferred
//! priorities). Where we differ: which nodes can have changed sides is decided by one clock. A border node is this far
//! (in metres of eye movement, radians of turn, and relative change of the threshold) from changing sides; it sleeps
//! until the clock, which runs as fast as the fastest of the three, has used that margin up. Woken nodes alone are
//! weighed. The threshold itself moves in the same way, so the result is the same as weighing every node.

use crate::criteria::{Scale, Seen};
use crate::oracle::Ranked;
use crate::wheel::Wheel;
use crate::{Criteria, Front, Step};
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use yamanami_core::{ActiveSet, Hierarchy, NodeId};

/// What kept an update from showing more.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LimitedBy {
    /// Nothing above the tolerance is left out.
    Tolerance,
    /// The triangle budget.
    Budget,
    /// Data not in memory.
    Residency,
    /// The step limit of the frame.
    Steps,
}

/// What an update did.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameReport {
    /// Triangles now shown.
    pub triangles: usize,
    /// Nodes applied.
    pub refined: usize,
    /// Nodes undone.
    pub coarsened: usize,
    /// Nodes weighed.
    pub weighed: usize,
    /// What bound the front.
    pub limited_by: LimitedBy,
    /// No node left out has a larger error than this, in pixels (metres without a view).
    pub error_left: f32,
    /// The threshold in force: the larger of the tolerance and what the budget allows, same unit.
    pub threshold: f32,
    /// Absent nodes that were wanted.
    pub wanted: Vec<NodeId>,
}

/// How far eye, direction and threshold may move in one unit of the clock.
#[derive(Debug, Clone, Copy)]
struct Rates {
    eye_m: f64,
    turn_rad: f64,
    threshold: f64,
}

/// A node in this frame's queues, with the place of what was seen of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Weighed {
    rank: Ranked,
    seen: u32,
}

/// Units of the clock in a frame of usual movement: alarms ring up to one unit early.
const UNITS_PER_FRAME: f64 = 8.0;

/// A threshold that moves further than this in a frame, in units of the clock, starts the clock over.
const FAR_UNITS: f64 = 64.0 * UNITS_PER_FRAME;

/// Movement below this a frame is no movement.
const LEAST_RATES: Rates = Rates { eye_m: 1e-3, turn_rad: 1e-6, threshold: 1e-6 };

impl Rates {
    /// Running mean over about the last sixteen frames.
    fn follow(&mut self, now: Self, frames: u32) {
        let share = 1.0 / f64::from((frames + 1).min(16));
        let mix = |mean: &mut f64, now: f64| *mean += share * (now - *mean);
        mix(&mut self.eye_m, now.eye_m);
        mix(&mut self.turn_rad, now.turn_rad);
        mix(&mut self.threshold, now.threshold.min(1.0));
    }

    fn times(self, factor: f64) -> Self {
        Self { eye_m: self.eye_m * factor, turn_rad: self.turn_rad * factor, threshold: self.threshold * factor }
    }

    fn at_least(self, least: Self) -> Self {
        Self {
            eye_m: self.eye_m.max(least.eye_m),
            turn_rad: self.turn_rad.max(least.turn_rad),
            threshold: self.threshold.max(least.threshold),
        }
    }

    /// Whether any rate is far from the movement seen: the clock would run too fast, or alarms ring too early.
    fn unlike(self, seen: Self) -> bool {
        let seen = seen.at_least(LEAST_RATES);
        [(self.eye_m, seen.eye_m), (self.turn_rad, seen.turn_rad), (self.threshold, seen.threshold)]
            .iter()
            .any(|(rate, seen)| rate / seen > 3.0 || seen / rate > 3.0)
    }
}

/// Moves a front from frame to frame.
#[derive(Debug, Clone)]
pub struct Controller {
    front: Front,
    criteria: Option<Criteria>,
    wheel: Wheel,
    rates: Rates,
    /// Sleeping leaves are above this, sleeping open nodes are not.
    threshold: f32,
    /// This frame's weighed nodes.
    open: BinaryHeap<Weighed>,
    leaves: BinaryHeap<Reverse<Weighed>>,
    /// What was seen of them.
    seen: Vec<Seen>,
    /// Movement per frame, smoothed.
    average: Rates,
    /// How far the threshold has moved this frame, and did in the last, forth and back.
    threshold_moved: f64,
    threshold_moved_last: f64,
    /// Every border node has been weighed this frame: the threshold may move freely.
    nobody_sleeps: bool,
    frames_since_start: u32,
    weighed: usize,
    wanted: Vec<NodeId>,
    wanted_priority: f32,
    woken: Vec<NodeId>,
}

impl Controller {
    /// Starts from the base mesh.
    pub fn new(hierarchy: &impl Hierarchy) -> Self {
        Self {
            front: Front::new(hierarchy),
            criteria: None,
            wheel: Wheel::new(),
            rates: LEAST_RATES,
            threshold: f32::MAX,
            open: BinaryHeap::new(),
            leaves: BinaryHeap::new(),
            seen: Vec::new(),
            average: Rates { eye_m: 0.0, turn_rad: 0.0, threshold: 0.0 },
            threshold_moved: 0.0,
            threshold_moved_last: 0.0,
            nobody_sleeps: true,
            frames_since_start: 0,
            weighed: 0,
            wanted: Vec::new(),
            wanted_priority: 0.0,
            woken: Vec::new(),
        }
    }

    /// What is shown.
    pub fn front(&self) -> &Front {
        &self.front
    }

    /// Moves the front to what `criteria` ask for. `on_step` hears of each step just before it is taken, with the front
    /// as it is then; each prefix of the steps leads to a legal front.
    pub fn update<H: Hierarchy>(
        &mut self,
        hierarchy: &H,
        criteria: &Criteria,
        mut on_step: impl FnMut(Step, &Front),
    ) -> FrameReport {
        self.wanted.clear();
        self.wanted_priority = 0.0;
        let scale = criteria.scale();
        self.threshold_moved = 0.0;
        self.wake(hierarchy, criteria, &scale);
        let mut report = self.settle(hierarchy, criteria, &scale, &mut on_step);
        self.sleep(criteria, &scale);
        self.threshold_moved_last = self.threshold_moved;
        report.weighed = self.weighed;
        report.wanted = std::mem::take(&mut self.wanted);
        self.criteria = Some(*criteria);
        report
    }

    /// Wakes the nodes that may have changed sides since the last frame.
    fn wake<H: Hierarchy>(&mut self, hierarchy: &H, criteria: &Criteria, scale: &Scale) {
        let movement = self.criteria.as_ref().and_then(|last| movement(last, criteria));
        let Some((eye_m, turn_rad)) = movement else { return self.start_over(hierarchy, scale) };
        self.average.follow(Rates { eye_m, turn_rad, threshold: self.threshold_moved_last }, self.frames_since_start);
        self.frames_since_start += 1;
        let units = (eye_m / self.rates.eye_m).max(turn_rad / self.rates.turn_rad);
        let due = self.frames_since_start.is_power_of_two() || self.frames_since_start.is_multiple_of(64);
        if due && self.rates.times(UNITS_PER_FRAME).unlike(self.average) {
            self.start_over(hierarchy, scale);
        } else {
            self.advance(hierarchy, scale, units);
        }
    }

    /// Weighs every border node and sets the clock's rates by the movement seen of late.
    fn start_over<H: Hierarchy>(&mut self, hierarchy: &H, scale: &Scale) {
        self.rates = self.average.at_least(LEAST_RATES).times(1.0 / UNITS_PER_FRAME);
        self.wheel.clear();
        self.nobody_sleeps = true;
        self.open.clear();
        self.leaves.clear();
        self.seen.clear();
        self.wanted.clear();
        let mut seen = hierarchy.roots();
        for &root in &seen {
            self.front.state_mut(root).hot = false;
        }
        let mut border = Vec::new();
        // walk the front; a node is reached through its last parent only
        while let Some(node) = seen.pop() {
            if self.front.is_active(node) {
                if self.front.is_leaf(node) {
                    border.push(node);
                }
                for &c in hierarchy.children(node).iter() {
                    if hierarchy.parents(c).iter().max() == Some(&node) {
                        seen.push(c);
                    }
                }
            } else if self.front.is_open(node) {
                border.push(node);
            }
        }
        self.weigh_border(hierarchy, scale, border.into_iter());
    }

    fn advance<H: Hierarchy>(&mut self, hierarchy: &H, scale: &Scale, units: f64) {
        let mut woken = std::mem::take(&mut self.woken);
        let front = &self.front;
        self.wheel.advance(units, |node, tick| {
            let s = front.state(node);
            if s.wake == tick && !s.hot {
                woken.push(node);
            }
        });
        self.weigh_border(hierarchy, scale, woken.drain(..));
        self.woken = woken;
    }

    /// Weighs many nodes and queues those that are still on the border: faster than one by one.
    fn weigh_border<H: Hierarchy>(&mut self, hierarchy: &H, scale: &Scale, nodes: impl Iterator<Item = NodeId>) {
        let (mut open, mut leaves) = (Vec::new(), Vec::new());
        for node in nodes {
            if self.front.is_leaf(node) {
                leaves.push(Reverse(self.weigh(hierarchy, scale, node)));
            } else if self.front.is_open(node) {
                open.push(self.weigh(hierarchy, scale, node));
            }
        }
        self.open.append(&mut open.into());
        self.leaves.append(&mut leaves.into());
    }

    fn weigh<H: Hierarchy>(&mut self, hierarchy: &H, scale: &Scale, node: NodeId) -> Weighed {
        self.front.state_mut(node).hot = true;
        let seen = scale.weigh(hierarchy, node);
        self.seen.push(seen);
        Weighed { rank: Ranked { priority: seen.priority, node }, seen: self.seen.len() as u32 - 1 }
    }

    fn weigh_open<H: Hierarchy>(&mut self, hierarchy: &H, scale: &Scale, node: NodeId) {
        let weighed = self.weigh(hierarchy, scale, node);
        self.open.push(weighed);
    }

    fn weigh_leaf<H: Hierarchy>(&mut self, hierarchy: &H, scale: &Scale, node: NodeId) {
        let weighed = self.weigh(hierarchy, scale, node);
        self.leaves.push(Reverse(weighed));
    }

    /// The best open node among the woken, once no sleeping one can be better; `None` when nothing is above the limit.
    fn best_open<H: Hierarchy>(&mut self, hierarchy: &H, criteria: &Criteria, scale: &Scale) -> Option<Weighed> {
        let limit = criteria.threshold();
        loop {
            while let Some(&Weighed { rank: top, .. }) = self.open.peek() {
                let stale = !self.front.state(top.node).hot || !self.front.is_open(top.node);
                if stale {
                    self.open.pop();
                    continue;
                }
                if top.priority > limit && !hierarchy.is_resident(top.node) {
                    // stays hot: asked for again next frame
                    self.open.pop();
                    self.wanted.push(top.node);
                    self.wanted_priority = self.wanted_priority.max(top.priority);
                    continue;
                }
                break;
            }
            let best = self.open.peek().copied().filter(|w| w.rank.priority > limit);
            let reach = best.map_or(limit, |w| w.rank.priority);
            if reach >= self.threshold {
                return best;
            }
            self.move_threshold(hierarchy, scale, reach);
        }
    }

    /// The worst leaf among the woken, once no sleeping one can be worse; `None` when all are above `limit`.
    fn worst_leaf<H: Hierarchy>(
        &mut self,
        hierarchy: &H,
        criteria: &Criteria,
        scale: &Scale,
        limit: f32,
    ) -> Option<Ranked> {
        let slack = 1.0 + criteria.hysteresis;
        loop {
            while let Some(&Reverse(Weighed { rank: top, .. })) = self.leaves.peek() {
                if self.front.state(top.node).hot && self.front.is_leaf(top.node) {
                    break;
                }
                self.leaves.pop();
            }
            let worst = self
                .leaves
                .peek()
                .map(|&Reverse(Weighed { rank, .. })| Ranked { priority: rank.priority * slack, ..rank })
                .filter(|r| r.priority <= limit);
            let reach = worst.map_or(limit, |r| r.priority);
            if reach <= self.threshold {
                return worst;
            }
            self.move_threshold(hierarchy, scale, reach);
        }
    }

    /// Moves the threshold towards `to`, at most one unit of the clock, waking whom it may pass.
    fn move_threshold<H: Hierarchy>(&mut self, hierarchy: &H, scale: &Scale, to: f32) {
        let from = self.threshold;
        if self.nobody_sleeps {
            self.threshold = to;
            return;
        }
        if f64::from(to / from).ln().abs() > FAR_UNITS * self.rates.threshold {
            // to wake nearly everybody step by step would cost more than to weigh them all
            self.start_over(hierarchy, scale);
            self.threshold = to;
            return;
        }
        let step = self.rates.threshold.exp() as f32;
        let next = if to > from { to.min(from * step) } else { to.max(from / step) };
        // a step too small for f32, or towards infinity, goes all the way
        let next = if next == from || !next.is_finite() { to } else { next };
        self.threshold = next;
        let moved = f64::from(next / from).ln().abs().min(100.0);
        self.threshold_moved += moved;
        self.advance(hierarchy, scale, moved / self.rates.threshold);
    }

    fn settle<H: Hierarchy>(
        &mut self,
        hierarchy: &H,
        criteria: &Criteria,
        scale: &Scale,
        on_step: &mut impl FnMut(Step, &Front),
    ) -> FrameReport {
        let budget = criteria.budget_triangles.map_or(i64::MAX, i64::from);
        let max_steps = criteria.max_steps.unwrap_or(usize::MAX);
        let (mut refined, mut coarsened) = (0, 0);
        let limited_by;
        let mut error_left = criteria.threshold();
        loop {
            let triangles = self.front.triangle_count() as i64;
            if triangles > budget {
                let Some(worst) = self.worst_leaf(hierarchy, criteria, scale, f32::INFINITY) else {
                    limited_by = LimitedBy::Budget;
                    break;
                };
                self.coarsen(hierarchy, scale, worst.node, on_step);
                coarsened += 1;
                continue;
            }
            let may_step = refined + coarsened < max_steps;
            // what is good enough goes first: it makes room
            if may_step && let Some(worst) = self.worst_leaf(hierarchy, criteria, scale, criteria.threshold()) {
                self.coarsen(hierarchy, scale, worst.node, on_step);
                coarsened += 1;
                continue;
            }
            let Some(best) = self.best_open(hierarchy, criteria, scale) else {
                limited_by = if self.wanted.is_empty() { LimitedBy::Tolerance } else { LimitedBy::Residency };
                break;
            };
            error_left = best.rank.priority;
            if !may_step {
                limited_by = LimitedBy::Steps;
                break;
            }
            let added = hierarchy.triangles_added(best.rank.node, &self.front);
            if triangles + i64::from(added) <= budget {
                self.open.pop();
                self.refine(hierarchy, scale, best, added, on_step);
                refined += 1;
                continue;
            }
            match self.worst_leaf(hierarchy, criteria, scale, best.rank.priority) {
                Some(worst) if worst < best.rank => {
                    self.coarsen(hierarchy, scale, worst.node, on_step);
                    coarsened += 1;
                }
                _ => {
                    limited_by = LimitedBy::Budget;
                    break;
                }
            }
        }
        if limited_by == LimitedBy::Tolerance || limited_by == LimitedBy::Residency {
            error_left = criteria.threshold();
        }
        // what is absent is left out too; its error is not known, but not above this
        let error_left = error_left.max(self.wanted_priority);
        FrameReport {
            triangles: self.front.triangle_count(),
            refined,
            coarsened,
            weighed: 0,
            limited_by,
            error_left,
            threshold: self.threshold,
            wanted: Vec::new(),
        }
    }

    fn refine<H: Hierarchy>(
        &mut self,
        hierarchy: &H,
        scale: &Scale,
        best: Weighed,
        added: i32,
        on_step: &mut impl FnMut(Step, &Front),
    ) {
        on_step(Step::Refine(best.rank.node), &self.front);
        let mut opened = std::mem::take(&mut self.woken);
        self.front.refine(hierarchy, best.rank.node, added, |_, node| opened.push(node));
        for node in opened.drain(..) {
            self.weigh_open(hierarchy, scale, node);
        }
        self.woken = opened;
        self.leaves.push(Reverse(best));
    }

    fn coarsen<H: Hierarchy>(
        &mut self,
        hierarchy: &H,
        scale: &Scale,
        node: NodeId,
        on_step: &mut impl FnMut(Step, &Front),
    ) {
        self.leaves.pop();
        on_step(Step::Coarsen(node), &self.front);
        let without = |n: NodeId| n != node && self.front.is_active(n);
        let added = hierarchy.triangles_added(node, &without);
        let mut closed = std::mem::take(&mut self.woken);
        self.front.coarsen(hierarchy, node, added, |_, parent| closed.push(parent));
        for parent in closed.drain(..) {
            self.weigh_leaf(hierarchy, scale, parent);
        }
        self.woken = closed;
        self.weigh_open(hierarchy, scale, node);
    }

    /// Sets the alarms of all woken nodes.
    fn sleep(&mut self, criteria: &Criteria, scale: &Scale) {
        if self.threshold >= f32::MAX {
            self.threshold = criteria.threshold();
        }
        self.nobody_sleeps = false;
        let slack = f64::from(1.0 + criteria.hysteresis);
        let wanted = std::mem::take(&mut self.wanted);
        let mut open = std::mem::take(&mut self.open);
        let mut leaves = std::mem::take(&mut self.leaves);
        for &node in &wanted {
            self.set_alarm(node, 0.0);
        }
        for weighed in open.drain() {
            if self.front.state(weighed.rank.node).hot && self.front.is_open(weighed.rank.node) {
                let margin = self.margin(scale, &self.seen[weighed.seen as usize], 1.0, false);
                self.set_alarm(weighed.rank.node, margin);
            }
        }
        for Reverse(weighed) in leaves.drain() {
            if self.front.state(weighed.rank.node).hot && self.front.is_leaf(weighed.rank.node) {
                let margin = self.margin(scale, &self.seen[weighed.seen as usize], slack, true);
                self.set_alarm(weighed.rank.node, margin);
            }
        }
        self.weighed = self.seen.len();
        self.seen.clear();
        (self.open, self.leaves, self.wanted) = (open, leaves, wanted);
    }

    fn set_alarm(&mut self, node: NodeId, after: f64) {
        let tick = self.wheel.set(node, after);
        let s = self.front.state_mut(node);
        s.hot = false;
        s.wake = tick;
    }

    /// Units of the clock until a node may change sides of the threshold.
    fn margin(&self, scale: &Scale, seen: &Seen, slack: f64, leaf: bool) -> f64 {
        let (threshold, rates) = (f64::from(self.threshold), &self.rates);
        let priority = f64::from(seen.priority) * slack;
        let on_side = if leaf { priority > threshold } else { priority <= threshold };
        if !on_side {
            return 0.0;
        }
        // at most this long, so that the threshold's change stays where its linear bound holds
        let longest = 1.0 / rates.threshold;
        let Some(eye) = &scale.view else {
            let ratio = if priority > 0.0 { (priority / threshold).ln().abs() } else { 1.0 };
            return 0.999 * (ratio / rates.threshold).min(longest);
        };
        let mut margin = longest;
        if seen.side_m.is_finite() {
            let off_m = seen.side_m.abs();
            margin = margin.min(off_m / (rates.eye_m + rates.turn_rad * (seen.centre_m + off_m)));
        }
        if seen.side_m >= 0.0 && seen.error_m > 0.0 {
            // shown while nearer than `reach_m`; the threshold moves that by up to e^v - 1 < 1.72 v of itself
            let reach_m = f64::from(seen.error_m) * slack * eye.pixels_per_radian / threshold;
            let off_m = (reach_m - seen.surface_m).abs();
            margin = margin.min(off_m / (rates.eye_m + 1.72 * reach_m * rates.threshold));
        }
        0.999 * margin
    }
}

/// How far the eye moved (metres) and turned (radians) between two frames; `None` when more than that changed.
fn movement(last: &Criteria, now: &Criteria) -> Option<(f64, f64)> {
    if last.terrain_tolerance_m != now.terrain_tolerance_m && now.view.is_some() || last.hysteresis != now.hysteresis {
        return None;
    }
    if last.map.is_some() || now.map.is_some() {
        // nothing bounds what a change of projection does to a node: all are weighed again
        return (last.map == now.map).then_some((0.0, 0.0));
    }
    match (&last.view, &now.view) {
        (None, None) => Some((0.0, 0.0)),
        (Some(a), Some(b))
            if a.cull == b.cull && a.view.fov_y_rad == b.view.fov_y_rad && a.view.viewport_px == b.view.viewport_px =>
        {
            // a view along z has another up vector: start over there
            if a.view.up() != b.view.up() {
                return None;
            }
            let turn = 2.0 * (0.5 * (a.view.forward() - b.view.forward()).length()).min(1.0).asin();
            // turning about the vertical turns the sides more the steeper the view
            let level = a.view.forward().truncate().length().min(b.view.forward().truncate().length()).max(1e-3);
            Some(((a.view.eye - b.view.eye).length(), turn / level))
        }
        _ => None,
    }
}
