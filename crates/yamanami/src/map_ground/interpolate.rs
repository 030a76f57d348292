//! Heights between samples: smooth, but never wavy.
//!
//! Based on: E. Catmull, R. Rom, "A class of local interpolating splines", 1974; F. N. Fritsch, R. E. Carlson, "Monotone
//! piecewise cubic interpolation", 1980 (how steep a tangent may be). Where we differ: tangents at summits and in hollows
//! are kept, so that summits stay round; beside level ground they vanish, so that a lake or the sea stays level up to its
//! shore.

use super::spline;

/// A window of samples.
pub(super) struct Samples {
    pub(super) heights_m: Vec<f32>,
    pub(super) width: usize,
    pub(super) height: usize,
    /// Coefficients of the spline through the samples, where they are far apart.
    pub(super) spline: Option<Vec<f32>>,
}

impl Samples {
    /// Lays a spline through the samples: where they are much further apart than what is asked of them, slopes must not
    /// show the grid either.
    pub(super) fn smooth(&mut self) {
        self.spline = Some(spline::coefficients(&self.heights_m, self.width, self.height));
    }

    /// Height at a fractional column and row; NaN off the window and where most of the surroundings have no data.
    /// Bicubic where all sixteen samples around are known, else bilinear of the known ones of the four.
    #[inline]
    pub(super) fn at(&self, column: f64, row: f64) -> f32 {
        let (last_column, last_row) = ((self.width - 1) as f64, (self.height - 1) as f64);
        if !(column >= 0.0 && column <= last_column && row >= 0.0 && row <= last_row) {
            return f32::NAN;
        }
        let (i, j) = ((column as usize).min(self.width - 2), (row as usize).min(self.height - 2));
        let (u, v) = ((column - i as f64) as f32, (row - j as f64) as f32);
        let around = if i >= 1 && j >= 1 && i + 2 < self.width && j + 2 < self.height {
            let first = (j - 1) * self.width + i - 1;
            std::array::from_fn(|k| {
                let row = &self.heights_m[first + k * self.width..][..4];
                [row[0], row[1], row[2], row[3]]
            })
        } else {
            let row = |k: usize| (j + k).saturating_sub(1).min(self.height - 1) * self.width;
            let column = |k: usize| (i + k).saturating_sub(1).min(self.width - 1);
            std::array::from_fn(|y| std::array::from_fn(|x| self.heights_m[row(y) + column(x)]))
        };
        match &self.spline {
            Some(spline) => spline::height(spline, [self.width, self.height], [i, j], [u, v], &around),
            None => bicubic(&around, u, v),
        }
    }
}

#[inline]
fn bicubic(p: &[[f32; 4]; 4], u: f32, v: f32) -> f32 {
    let middle = [p[1][1], p[1][2], p[2][1], p[2][2]];
    if p.iter().flatten().sum::<f32>().is_nan() {
        return bilinear_of_known(middle, u, v);
    }
    let along: [f32; 4] = std::array::from_fn(|k| cubic([p[0][k], p[1][k], p[2][k], p[3][k]], v));
    // not under the sea where no sample is
    let lowest = middle.into_iter().fold(0.0, f32::min);
    cubic(along, u).max(lowest)
}

/// The cubic between the second and the third of four samples.
#[inline]
fn cubic(p: [f32; 4], t: f32) -> f32 {
    let (before, rise, after) = (p[1] - p[0], p[2] - p[1], p[3] - p[2]);
    let tangent = |a: f32, b: f32| {
        let most = 3.0 * a.abs().min(b.abs());
        (0.5 * (a + b)).min(most).max(-most)
    };
    let (m1, m2) = (tangent(before, rise), tangent(rise, after));
    p[1] + t * (m1 + t * (3.0 * rise - 2.0 * m1 - m2 + t * (m1 + m2 - 2.0 * rise)))
}

/// Bilinear of the samples that are known, if they weigh at least half.
#[cold]
pub(super) fn bilinear_of_known(z: [f32; 4], u: f32, v: f32) -> f32 {
    let weights = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
    let known = || z.into_iter().zip(weights).filter(|(z, _)| !z.is_nan());
    let weight: f32 = known().map(|(_, w)| w).sum();
    if weight < 0.5 { f32::NAN } else { known().map(|(z, w)| z * w).sum::<f32>() / weight }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn samples(width: usize, height: usize, z: impl Fn(usize, usize) -> f32) -> Samples {
        let heights_m = (0..width * height).map(|k| z(k % width, k / width)).collect();
        Samples { heights_m, width, height, spline: None }
    }

    #[test]
    fn slopes_are_straight_and_summits_round() {
        let plane = samples(6, 6, |x, y| 3.0 * x as f32 - 2.0 * y as f32 + 50.0);
        assert!((plane.at(2.3, 2.6) - (3.0 * 2.3 - 2.0 * 2.6 + 50.0)).abs() < 1e-4);
        let ridge = samples(6, 6, |x, _| [0.0, 60.0, 100.0, 100.0, 60.0, 0.0][x]);
        assert_eq!(ridge.at(2.5, 2.5), 100.0, "what is level between equal samples stays so");
        let peak = samples(6, 6, |x, _| [0.0, 60.0, 100.0, 90.0, 40.0, 0.0][x]);
        assert!(peak.at(2.3, 2.5) > 100.0 && peak.at(2.3, 2.5) < 106.0);
        assert!(peak.at(-0.1, 2.0).is_nan() && peak.at(f64::NAN, 2.0).is_nan() && peak.at(2.0, 5.01).is_nan());
        assert_eq!(peak.at(5.0, 5.0), 0.0);
    }

    #[test]
    fn the_sea_is_level_up_to_its_shore() {
        let shore = samples(8, 8, |x, _| if x < 4 { 0.0 } else { 250.0 });
        for k in 0..=30 {
            assert_eq!(shore.at(f64::from(k) * 0.1, 3.3), 0.0);
        }
        assert!((30..=40).all(|k| (0.0..=250.0).contains(&shore.at(f64::from(k) * 0.1, 3.3))));
    }

    #[test]
    fn beside_no_data_only_what_is_known_counts() {
        let west = samples(6, 6, |x, _| if x < 3 { 10.0 } else { f32::NAN });
        assert_eq!(west.at(2.4, 2.2), 10.0);
        assert!(west.at(2.6, 2.2).is_nan());
    }

    proptest! {
        #[test]
        fn samples_are_met_and_the_sea_is_not_undercut(z in proptest::collection::vec(0f32..4000.0, 36),
                                                        x in 0.0..5.0, y in 0.0..5.0) {
            let grid = Samples { heights_m: z, width: 6, height: 6, spline: None };
            prop_assert!((0.0..=8000.0).contains(&grid.at(x, y)));
            let (i, j) = (x as usize, y as usize);
            prop_assert!((grid.at(i as f64, j as f64) - grid.heights_m[j * 6 + i]).abs() < 1e-2);
        }
    }
}
