//! From the picture back to the ground, for picking and for graticules.

use super::DeformedMap;
use glam::DVec2;

/// Beyond this many ring radii nothing is looked for.
const FARTHEST_RINGS: f64 = 1e4;

/// Factor from one place looked at to the next, small enough not to step over the horizon's crest.
const STRIDE: f64 = 1.01;

impl DeformedMap {
    /// Distance from the centre, metres, of ground of height `z_m` drawn at `rho`: the nearest, where several are. `None`
    /// beyond the horizon.
    pub fn radius_m(&self, rho: f64, z_m: f64) -> Option<f64> {
        if !(rho >= 0.0 && rho.is_finite()) {
            return None;
        }
        if rho <= 1.0 {
            return Some(rho * self.ring_m);
        }
        if self.alpha == 0.0 && self.curvature.is_none() {
            let (t, z) = ((rho - 1.0) / self.scale, self.depth_m(self.ring_m, z_m));
            let d = z * 2.0 * t / (1.0 - t * t);
            return (d > 0.0 && d.is_finite()).then_some(self.ring_m + d);
        }
        self.radius_by_search(rho, z_m)
    }

    /// Brackets the first crossing outwards, then halves and, inside, takes secant steps.
    fn radius_by_search(&self, rho: f64, z_m: f64) -> Option<f64> {
        let over = |r: f64| self.rho(r, z_m) - rho;
        let (mut near, mut far) = (self.ring_m, self.ring_m * STRIDE);
        while over(far) < 0.0 {
            near = far;
            far *= STRIDE;
            if far > FARTHEST_RINGS * self.ring_m {
                return None;
            }
        }
        let (mut at_near, mut at_far) = (over(near), over(far));
        for step in 0..200 {
            if far - near <= 1e-12 * far || at_far == 0.0 {
                break;
            }
            // regula falsi closes in from one side only: every other step halves
            let secant = near - at_near * (far - near) / (at_far - at_near);
            let middle = if step % 2 == 0 && secant > near && secant < far { secant } else { 0.5 * (near + far) };
            let at_middle = over(middle);
            if at_middle < 0.0 {
                (near, at_near) = (middle, at_middle);
            } else {
                (far, at_far) = (middle, at_middle);
            }
        }
        Some(if at_far < -at_near { far } else { near })
    }

    /// Point of the plane of ground of height `z_m` drawn at a place of the picture (x right, y up, in radii of the
    /// plain map); `None` beyond the horizon.
    pub fn plane_from_image(&self, place: DVec2, z_m: f64) -> Option<DVec2> {
        let rho = place.length();
        if rho == 0.0 {
            return Some(self.centre);
        }
        Some(self.centre + place * (self.radius_m(rho, z_m)? / rho))
    }
}
