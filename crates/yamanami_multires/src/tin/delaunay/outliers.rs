//! Points that cannot belong to the survey: zeros among map coordinates, -9999 for no height.
//!
//! Judged by the box of the middle 98 % of the points, after the interquartile fences of Tukey, "Exploratory Data Analysis",
//! 1977, but with fences so far out that no real survey reaches them.

use glam::DVec3;

/// Coordinates beyond are nowhere on Earth, metres.
const LIMIT_M: f64 = 1e9;
/// With fewer points, which are the odd ones is anybody's guess.
const LEAST_POINTS: usize = 200;
/// The box is that of so many points at least, evenly picked.
const MOST_PICKED: usize = 100_000;
/// Fence in plan: so many times the longer side of the box.
const PLAN_FENCE: f64 = 20.0;
/// Fence in height: so many times the box's height, which counts as `LEAST_RELIEF_M` at least.
const HEIGHT_FENCE: f64 = 5.0;
const LEAST_RELIEF_M: f64 = 400.0;

/// Whether a point is somewhere.
pub(super) fn is_placed(p: DVec3) -> bool {
    p.abs().max_element() <= LIMIT_M && p.is_finite()
}

/// The fences of a survey.
pub(super) struct Fences {
    low: DVec3,
    high: DVec3,
}

impl Fences {
    /// Those of all points that are somewhere.
    pub(super) fn of(points: &[DVec3]) -> Self {
        let everywhere = Self { low: DVec3::NEG_INFINITY, high: DVec3::INFINITY };
        let step = points.len().div_ceil(MOST_PICKED).max(1);
        let picked: Vec<DVec3> = points.iter().copied().step_by(step).filter(|&p| is_placed(p)).collect();
        if picked.len() < LEAST_POINTS {
            return everywhere;
        }
        let range = |axis: usize| {
            let mut values: Vec<f64> = picked.iter().map(|p| p[axis]).collect();
            values.sort_unstable_by(f64::total_cmp);
            let tail = values.len() / 100;
            [values[tail], values[values.len() - 1 - tail]]
        };
        let [x, y, z] = [range(0), range(1), range(2)];
        let plan = PLAN_FENCE * (x[1] - x[0]).max(y[1] - y[0]);
        let height = HEIGHT_FENCE * (z[1] - z[0]).max(LEAST_RELIEF_M);
        if plan == 0.0 {
            return everywhere;
        }
        let reach = DVec3::new(plan, plan, height);
        Self { low: DVec3::new(x[0], y[0], z[0]) - reach, high: DVec3::new(x[1], y[1], z[1]) + reach }
    }

    pub(super) fn hold(&self, p: DVec3) -> bool {
        p.cmpge(self.low).all() && p.cmple(self.high).all()
    }
}
