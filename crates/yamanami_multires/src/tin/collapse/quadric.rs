//! The vertical quadric: how far a point lies above or below some planes, squared and weighted by area in plan.
//!
//! Based on: Garland and Heckbert, "Surface Simplification Using Quadric Error Metrics", 1997. Where we differ: a terrain is
//! judged by heights, so distances are vertical; and the place of least error is found in two steps, the height being
//! linear in the plan position, which stays sound where all planes are alike.

use glam::DVec3;

/// Sums over planes z = a x + b y + c, each with a weight.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Quadric {
    w: f64,
    a: f64,
    b: f64,
    c: f64,
    aa: f64,
    ab: f64,
    ac: f64,
    bb: f64,
    bc: f64,
    cc: f64,
}

/// How strongly the place of least error is drawn to the middle of the edge, as a share of the planes' spread.
const STAY: f64 = 0.02;

impl Quadric {
    /// Of a triangle that is counter-clockwise from above, its weight its area in plan, m²; nothing where it has none.
    pub(super) fn of_triangle([p, q, r]: [DVec3; 3]) -> Self {
        let normal = (q - p).cross(r - p);
        if normal.z <= 0.0 {
            return Self::default();
        }
        let (a, b) = (-normal.x / normal.z, -normal.y / normal.z);
        let c = p.z - a * p.x - b * p.y;
        let w = 0.5 * normal.z;
        Self {
            w,
            a: w * a,
            b: w * b,
            c: w * c,
            aa: w * a * a,
            ab: w * a * b,
            ac: w * a * c,
            bb: w * b * b,
            bc: w * b * c,
            cc: w * c * c,
        }
    }

    pub(super) fn add(&mut self, o: &Self) {
        self.w += o.w;
        self.a += o.a;
        self.b += o.b;
        self.c += o.c;
        self.aa += o.aa;
        self.ab += o.ab;
        self.ac += o.ac;
        self.bb += o.bb;
        self.bc += o.bc;
        self.cc += o.cc;
    }

    /// Sum of the weighted squares of the vertical distances, m⁴.
    pub(super) fn cost(&self, p: DVec3) -> f64 {
        let DVec3 { x, y, z } = p;
        let square = self.w * z * z - 2.0 * z * (self.a * x + self.b * y + self.c);
        let plane =
            self.aa * x * x + 2.0 * self.ab * x * y + self.bb * y * y + 2.0 * (self.ac * x + self.bc * y) + self.cc;
        (square + plane).max(0.0)
    }

    /// The place of least error near `middle`; `None` when there are no planes or its square distance in plan is
    /// more than `reach2_m2`.
    pub(super) fn best_place(&self, middle: DVec3, reach2_m2: f64) -> Option<DVec3> {
        if self.w <= 0.0 {
            return None;
        }
        let share = 1.0 / self.w;
        let (ma, mb) = (self.a * share, self.b * share);
        let height = |x: f64, y: f64| (self.a * x + self.b * y + self.c) * share;
        // how the planes' gradients spread about their mean
        let haa = self.aa - ma * self.a;
        let hab = self.ab - ma * self.b;
        let hbb = self.bb - mb * self.b;
        let stay = STAY * (haa + hbb) + f64::MIN_POSITIVE;
        let (m00, m01, m11) = (haa + stay, hab, hbb + stay);
        let gx = haa * middle.x + hab * middle.y + self.ac - ma * self.c;
        let gy = hab * middle.x + hbb * middle.y + self.bc - mb * self.c;
        let det = m00 * m11 - m01 * m01;
        if det.is_nan() || det <= 1e-12 * m00 * m11 {
            return Some(middle.with_z(height(middle.x, middle.y)));
        }
        let scale = -1.0 / det;
        let (dx, dy) = ((m11 * gx - m01 * gy) * scale, (m00 * gy - m01 * gx) * scale);
        let off2_m2 = dx * dx + dy * dy;
        if off2_m2.is_nan() || off2_m2 > reach2_m2 {
            return None;
        }
        let (x, y) = (middle.x + dx, middle.y + dy);
        Some(DVec3::new(x, y, height(x, y)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ridge_of_a_roof_is_found() {
        // two planes that meet along x = 2: z = x and z = 4 - x, and a gable z = y
        let of = |p: [f64; 3], q: [f64; 3], r: [f64; 3]| Quadric::of_triangle([p, q, r].map(DVec3::from_array));
        let mut sum = of([0.0, 0.0, 0.0], [2.0, 0.0, 2.0], [0.0, 2.0, 0.0]);
        sum.add(&of([2.0, 0.0, 2.0], [4.0, 0.0, 0.0], [2.0, 2.0, 2.0]));
        sum.add(&of([0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [2.0, 2.0, 2.0]));
        let best = sum.best_place(DVec3::new(1.8, 1.8, 0.0), 25.0).unwrap();
        assert!(best.distance(DVec3::new(2.0, 2.0, 2.0)) < 0.05, "{best}");
        assert!(sum.cost(DVec3::new(2.0, 2.0, 2.0)) < 1e-12);
        assert!(sum.cost(best) <= sum.cost(DVec3::new(1.8, 1.8, 1.8)));
    }
}
