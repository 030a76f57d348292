//! How far a coarse mesh may draw ground from its true place: an upper bound, never an estimate.
//!
//! A triangle is drawn straight between the pictures of its corners. A point of ground under it is therefore off by what
//! its height differs from the triangle's (times the greatest ∂ρ/∂z), by what the projection bends over the triangle
//! (edge² / 8 times its greatest second derivative along a straight line of the triangle), and by the kink at the ring.
//! With tan φ = d / Z, T = tan(φ/2), c = cos φ and D the slant distance,
//!
//! ```text
//! −T_Z = (1 − c) / d      T_ZZ = sin φ / D²      T_d = c / ((1 + c)·D)
//! T_dZ = (1 / (1 + c) − c) / D²                  −T_dd = sin φ·c·(2 + c) / ((1 + c)²·D²)
//! ```
//!
//! The plane's share α·r / D_R is linear in the plane and bends nothing.

use super::{DeformedMap, half_tangent, slant};
use glam::DVec2;

/// A piece of ground: all within a circle of the plane and a range of heights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch {
    /// Centre of the circle, metres.
    pub centre: DVec2,
    /// Its radius, metres.
    pub radius_m: f64,
    /// Lowest ground and triangle in it, metres.
    pub low_m: f64,
    /// Highest ground and triangle in it, metres.
    pub high_m: f64,
}

/// cos φ where −T_dd·D² is greatest for depths above 0 (0.9585 radians), and its value there, rounded up.
const MOST_BENT_COS: f64 = 0.574_743;
const MOST_BENT: f64 = 0.488_337;

/// (d / Z) where ∂ρ/∂z of one depth is greatest: the square root of the golden ratio.
const STEEPEST: f64 = 1.272_019_649_514_069;

impl DeformedMap {
    /// How far, in radii of the plain map, the picture of any point of ground in `patch` lies from where it is drawn by
    /// triangles with corners in the patch that are off by up to `error_m` vertically, have right angles, edges of up to
    /// `edge_m` in plan and corners that differ by up to `rise_m` in height. Never falls when any of them grows.
    ///
    /// Infinite where the patch reaches above the eye at the ring.
    pub fn error_bound(&self, patch: &Patch, error_m: f64, edge_m: f64, rise_m: f64) -> f64 {
        let off_m = (patch.centre - self.centre).length();
        let r1 = off_m + patch.radius_m;
        if r1 <= self.ring_m {
            return 0.0;
        }
        let r0 = (off_m - patch.radius_m).max(self.ring_m);
        let (d0, d1) = (r0 - self.ring_m, r1 - self.ring_m);
        let (low_z, high_z) = (self.depth_m(r0, patch.high_m), self.depth_m(r1, patch.low_m));
        let lean = steepest(d0, d1, low_z);
        if lean.is_infinite() {
            return f64::INFINITY;
        }
        let sphere = (1.0 - self.alpha_at(r1)) * self.scale;
        let by_height = sphere * self.exaggeration * lean * error_m;
        if edge_m <= 0.0 {
            return by_height;
        }
        let bend = self.bend([r0, r1], [low_z, high_z], lean, edge_m, rise_m);
        by_height + bend * edge_m * edge_m / 8.0 + self.kink(off_m - patch.radius_m, patch, edge_m)
    }

    /// Greatest second derivative of the picture along straight lines of triangles.
    fn bend(&self, [r0, r1]: [f64; 2], [low_z, high_z]: [f64; 2], lean: f64, edge_m: f64, rise_m: f64) -> f64 {
        let (d0, d1) = (r0 - self.ring_m, r1 - self.ring_m);
        // the least and the greatest angle: below the eye angles grow with distance, above it they fall
        let least = Angle::of(if high_z < 0.0 { d1 } else { d0 }, high_z);
        let most = Angle::of(if low_z < 0.0 { d0 } else { d1 }, low_z);
        let holds = |cos: f64| most.cos <= cos && cos <= least.cos;
        let ends = |g: fn(&Angle) -> f64| g(&least).abs().max(g(&most).abs());
        let squared = d0 * d0 + low_z.max(0.0) * low_z.max(0.0);
        let (per_m, per_area) = (1.0 / squared.sqrt(), 1.0 / squared);
        let t_zz = per_area * if holds(0.0) { 1.0 } else { ends(|a| a.sin) };
        let t_dz = per_area * ends(|a| a.per_one_and_cos - a.cos);
        let top = if holds(MOST_BENT_COS) { MOST_BENT } else { 0.0 };
        let t_dd = per_area * ends(|a| a.sin * a.cos * (2.0 + a.cos) * a.per_one_and_cos * a.per_one_and_cos).max(top);
        let t_d = per_m * ends(|a| a.cos * a.per_one_and_cos);
        let (s, t) = (self.scale, most.half_tan);
        // w = 1 − α(r), its first and second derivative
        let alpha = self.alpha_at(r0);
        let w = 1.0 - self.alpha_at(r1);
        let (w1, w2) = (self.alpha_fall * alpha / r0, self.alpha_fall * (self.alpha_fall + 1.0) * alpha / (r0 * r0));
        let (q, q1) = ((1.0 + s * t).max(r1 / self.ring_m), s * t_d + 1.0 / self.ring_m);
        let across = w * ((1.0 + s * t) / (r0 * r0)).max(s * t_d / r0) + w1 * q / r0;
        let along = w * s * t_dd + 2.0 * w1 * q1 + w2 * q;
        // slope of depth along a line: of the triangle's plane, and of the curved Earth
        let bend_per_m = self.bend_per_m();
        let slope = self.exaggeration * (2.0 * rise_m / edge_m + bend_per_m * self.drop_distance_m(r1));
        // what the slope adds along the radius and across it: a line has its share of either
        let by_slope = 2.0 * slope * (w * t_dz + w1 * lean).max(w * lean / r0)
            + w * t_zz * slope * slope
            + w * lean * self.exaggeration * bend_per_m;
        most_bent(along, across) + s * by_slope
    }

    /// What the change of slope at the ring may add.
    fn kink(&self, nearest_m: f64, patch: &Patch, edge_m: f64) -> f64 {
        if nearest_m >= self.ring_m {
            return 0.0;
        }
        let jump = [patch.low_m, patch.high_m]
            .map(|z| (self.scale / (2.0 * self.depth_m(self.ring_m, z)) - 1.0 / self.ring_m).abs());
        // a quarter of the edge were the ring straight; the rest is for its sagitta
        (1.0 - self.alpha) * jump[0].max(jump[1]) * edge_m * (0.25 + 0.25 * edge_m / self.ring_m)
    }
}

/// Greatest length of (b·x² + a·y², 2a·x·y) for x² + y² = 1: of the second derivative along a line of the plane, where b is
/// the radius's own and a is ρ / r² − ∂ρ/∂r / r.
#[inline]
fn most_bent(b: f64, a: f64) -> f64 {
    if b >= 2.0 * a { b } else { 2.0 * a * (a / (3.0 * a - b)).sqrt() }
}

/// An angle φ from straight down, by what the derivatives need of it.
struct Angle {
    sin: f64,
    cos: f64,
    /// tan(φ/2).
    half_tan: f64,
    /// 1 / (1 + cos φ).
    per_one_and_cos: f64,
}

impl Angle {
    #[inline]
    fn of(d_m: f64, depth_m: f64) -> Self {
        let (half_tan, per_m) = (half_tangent(d_m, depth_m), 1.0 / slant(d_m, depth_m));
        let per_one_and_cos = 0.5 + 0.5 * half_tan * half_tan;
        Self { sin: d_m * per_m, cos: depth_m * per_m, half_tan, per_one_and_cos }
    }
}

/// Greatest (1 − cos φ) / d for distances in a range and depths of at least `depth_m`.
fn steepest(d0: f64, d1: f64, depth_m: f64) -> f64 {
    // above the eye it rises without bound towards the ring
    let d = if depth_m <= 0.0 { d0 } else { (STEEPEST * depth_m).clamp(d0, d1) };
    if d <= 0.0 {
        return if depth_m <= 0.0 { f64::INFINITY } else { 0.0 };
    }
    // 1 − cos φ = sin φ · tan(φ/2)
    half_tangent(d, depth_m) / slant(d, depth_m)
}
