//! How far a surface is displaced in plan from the samples that it was made of: heights that are wrong by the slope times
//! a shift say so.
//!
//! Based on: the linear step of B. D. Lucas, T. Kanade, "An iterative image registration technique", 1981.

/// Sums of the least squares of residuals on gradients.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Shift {
    xx: f64,
    xy: f64,
    yy: f64,
    xr: f64,
    yr: f64,
    x: f64,
    y: f64,
    r: f64,
    count: u64,
}

impl Shift {
    /// A sample: the source's gradient in metres per sample of x and y, and the surface's height less the source's.
    pub fn add(&mut self, [gx, gy]: [f64; 2], residual_m: f64) {
        if gx.is_finite() && gy.is_finite() && residual_m.is_finite() {
            self.xx += gx * gx;
            self.xy += gx * gy;
            self.yy += gy * gy;
            self.xr += gx * residual_m;
            self.yr += gy * residual_m;
            self.x += gx;
            self.y += gy;
            self.r += residual_m;
            self.count += 1;
        }
    }

    /// All samples of both.
    pub fn merge(&mut self, other: &Self) {
        self.xx += other.xx;
        self.xy += other.xy;
        self.yy += other.yy;
        self.xr += other.xr;
        self.yr += other.yr;
        self.x += other.x;
        self.y += other.y;
        self.r += other.r;
        self.count += other.count;
    }

    /// By how many samples the surface is moved along x and y; `None` where the ground is too even, or of one slope only, to
    /// say.
    pub fn samples(&self) -> Option<[f64; 2]> {
        // about the means, so that a surface that is too high is not taken for one that is moved
        let n = self.count as f64;
        let (mx, my, mr) = (self.x / n, self.y / n, self.r / n);
        let (xx, xy, yy) = (self.xx - n * mx * mx, self.xy - n * mx * my, self.yy - n * my * my);
        let (xr, yr) = (self.xr - n * mx * mr, self.yr - n * my * mr);
        let determinant = xx * yy - xy * xy;
        if self.count < 100 || determinant <= 1e-6 * (xx + yy).powi(2) {
            return None;
        }
        // a surface moved by d has the heights of x - d
        let x = -(yy * xr - xy * yr) / determinant;
        let y = -(xx * yr - xy * xr) / determinant;
        Some([x, y])
    }
}

#[cfg(test)]
mod tests {
    use super::Shift;

    #[test]
    fn a_moved_surface_is_found_out() {
        let height = |x: f64, y: f64| 50.0 * (x * 0.11).sin() + 40.0 * (y * 0.07 + x * 0.02).cos();
        let mut shift = Shift::default();
        for k in 0..2500 {
            let (x, y) = (f64::from(k % 50), f64::from(k / 50));
            let gradient = [
                (height(x + 1.0, y) - height(x - 1.0, y)) / 2.0,
                (height(x, y + 1.0) - height(x, y - 1.0)) / 2.0,
            ];
            shift.add(gradient, height(x - 0.5, y + 0.25) - height(x, y) + 7.0);
        }
        let [x, y] = shift.samples().unwrap();
        assert!((x - 0.5).abs() < 0.02 && (y + 0.25).abs() < 0.02, "{x} {y}");
        assert_eq!(Shift::default().samples(), None);
    }
}
