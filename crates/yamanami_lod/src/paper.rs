//! The paper's own control: a staircase of thresholds by distance, steered towards the budget by proportional feedback.
//!
//! Based on: Hashida, Kanai, Kishinami. Between the nearest distance l₀ and the farthest l_L lie L intervals with the
//! thresholds f₁ = τ* < f₂ < … in metres; a vertex is shown when its error exceeds the threshold of its distance. After
//! each frame f_l grows by C_l·ΔN, where ΔN is the count less the budget and C_l = (l − 1)·c.
//!
//! The paper leaves the unit of C_l open. A front's count falls about as 1/f, so a step of f/N per triangle is what would
//! mend the whole error at once; we take c = gain · f̄ / N_T, with f̄ the mean threshold of the upper intervals, so that
//! the loop has the same damping on every terrain.

use crate::controller::{FrameReport, LimitedBy};
use crate::{Criteria, Front, Step};
use yamanami_core::{ActiveSet, Hierarchy, NodeId, Sphere, View};

/// The staircase f(l).
#[derive(Debug, Clone, PartialEq)]
pub struct Staircase {
    /// Distances l₀ … l_L in metres: one more than thresholds.
    pub distances_m: Vec<f64>,
    /// Threshold of each interval in metres, rising.
    pub thresholds_m: Vec<f32>,
    /// Share of the count's error that one frame's feedback would mend.
    pub gain: f32,
}

impl Staircase {
    /// `intervals` equal intervals between two distances; the first threshold is τ*, the others start at multiples of
    /// it (or of a metre where τ* is smaller).
    pub fn new(terrain_tolerance_m: f32, nearest_m: f64, farthest_m: f64, intervals: usize) -> Self {
        let intervals = intervals.max(1);
        let step = (farthest_m - nearest_m) / intervals as f64;
        Self {
            distances_m: (0..=intervals).map(|i| nearest_m + step * i as f64).collect(),
            thresholds_m: (0..intervals)
                .map(|i| terrain_tolerance_m + i as f32 * terrain_tolerance_m.max(1.0))
                .collect(),
            gain: 0.5,
        }
    }

    /// Threshold at a distance in metres.
    pub fn threshold_m(&self, distance_m: f64) -> f32 {
        let interval = self.distances_m[1..].partition_point(|&d| d <= distance_m);
        self.thresholds_m[interval.min(self.thresholds_m.len() - 1)]
    }

    /// Feeds the count of a frame back: `excess` triangles above `budget` raise the thresholds.
    pub fn feed_back(&mut self, excess: i64, budget: u32) {
        let upper = &self.thresholds_m[1..];
        if upper.is_empty() {
            return;
        }
        let mean_m = upper.iter().sum::<f32>() / upper.len() as f32;
        // C_l / C_mean = (l - 1) / mean(l - 1), the paper's C_l = l - 1 in units of `mean_m` a budget
        let unit = self.gain * mean_m / budget.max(1) as f32 / (0.5 * self.thresholds_m.len() as f32);
        for l in 1..self.thresholds_m.len() {
            let moved = self.thresholds_m[l] + l as f32 * unit * excess as f32;
            self.thresholds_m[l] = moved.max(self.thresholds_m[l - 1]);
        }
    }
}

/// Moves a front by the staircase.
#[derive(Debug, Clone)]
pub struct PaperController {
    front: Front,
    staircase: Staircase,
}

impl PaperController {
    /// Starts from the base mesh.
    pub fn new(hierarchy: &impl Hierarchy, staircase: Staircase) -> Self {
        Self { front: Front::new(hierarchy), staircase }
    }

    /// What is shown.
    pub fn front(&self) -> &Front {
        &self.front
    }

    /// The thresholds as they stand.
    pub fn staircase(&self) -> &Staircase {
        &self.staircase
    }

    /// One frame: brings the front to the staircase, then feeds its count back when `criteria` have a budget. The view's
    /// pixel tolerance plays no part.
    pub fn update<H: Hierarchy>(
        &mut self,
        hierarchy: &H,
        criteria: &Criteria,
        mut on_step: impl FnMut(Step, &Front),
    ) -> FrameReport {
        let view = criteria.view.map(|v| v.view);
        let frustum = criteria.view.filter(|v| v.cull).map(|v| v.view.frustum());
        let staircase = &self.staircase;
        let threshold_m = |bound: Sphere| {
            view.map_or(staircase.thresholds_m[0], |v: View| {
                staircase.threshold_m((bound.centre - v.eye).length() - bound.radius_m)
            })
        };
        let wants = |node: NodeId| {
            let bound = hierarchy.bound(node);
            frustum.is_none_or(|f| f.sees(bound)) && hierarchy.error_m(node) > threshold_m(bound)
        };
        let (mut open, mut leaves) = (Vec::new(), Vec::new());
        let mut seen = hierarchy.roots();
        while let Some(node) = seen.pop() {
            if self.front.is_active(node) {
                if self.front.is_leaf(node) {
                    leaves.push(node);
                }
                seen.extend(
                    hierarchy.children(node).iter().filter(|&&c| hierarchy.parents(c).iter().max() == Some(&node)),
                );
            } else if self.front.is_open(node) {
                open.push(node);
            }
        }
        let (mut refined, mut coarsened, mut wanted) = (0, 0, Vec::new());
        while let Some(node) = leaves.pop() {
            if self.front.is_leaf(node) && !wants(node) {
                on_step(Step::Coarsen(node), &self.front);
                let without = |n: NodeId| n != node && self.front.is_active(n);
                let added = hierarchy.triangles_added(node, &without);
                self.front.coarsen(hierarchy, node, added, |_, parent| leaves.push(parent));
                coarsened += 1;
            }
        }
        while let Some(node) = open.pop() {
            if self.front.is_open(node) && wants(node) {
                if !hierarchy.is_resident(node) {
                    wanted.push(node);
                    continue;
                }
                on_step(Step::Refine(node), &self.front);
                let added = hierarchy.triangles_added(node, &self.front);
                self.front.refine(hierarchy, node, added, |_, child| open.push(child));
                refined += 1;
            }
        }
        let triangles = self.front.triangle_count();
        if let Some(budget) = criteria.budget_triangles {
            self.staircase.feed_back(triangles as i64 - i64::from(budget), budget);
        }
        let limited_by = if wanted.is_empty() { LimitedBy::Tolerance } else { LimitedBy::Residency };
        let highest_m = self.staircase.thresholds_m.last().copied().unwrap_or(0.0);
        FrameReport {
            triangles,
            refined,
            coarsened,
            weighed: 0,
            limited_by,
            error_left: highest_m,
            threshold: highest_m,
            wanted,
        }
    }
}
