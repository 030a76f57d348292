//! The cubic spline through samples that are far apart: its slopes bend smoothly everywhere, so that light on it shows the
//! ground and not the grid.
//!
//! Based on: M. Unser, A. Aldroubi, M. Eden, "B-spline signal processing", 1993 (coefficients by a recursive filter forth and
//! back). Where we differ: cells between four equal samples are level, so that lakes and the sea are; nothing goes under
//! the sea where no sample does.

use super::interpolate::bilinear_of_known;

/// The pole of the cubic spline's filter, √3 − 2, and its gain.
const POLE: f32 = -0.267_949_2;
const GAIN: f32 = 6.0;

/// Coefficients of the spline through a grid of samples, mirrored at its sides. Samples without data count as the last
/// known one of their row.
pub(super) fn coefficients(heights_m: &[f32], width: usize, height: usize) -> Vec<f32> {
    let mut c = heights_m.to_vec();
    for row in c.chunks_exact_mut(width) {
        fill(row);
        filter(row, 1);
    }
    for column in 0..width {
        filter(&mut c[column..], width);
    }
    debug_assert_eq!(c.len(), width * height);
    c
}

/// Gives samples without data the height of the nearest known one before, or else behind.
fn fill(row: &mut [f32]) {
    let mut last = row.iter().copied().find(|z| !z.is_nan()).unwrap_or(0.0);
    for z in row {
        if z.is_nan() {
            *z = last;
        }
        last = *z;
    }
}

/// Filters every `stride`-th number, in place.
fn filter(c: &mut [f32], stride: usize) {
    let count = c.len().div_ceil(stride);
    if count < 2 {
        return;
    }
    let (mut power, mut first) = (POLE, c[0]);
    // further samples weigh nothing in f32
    for k in 1..24 {
        let at = k % (2 * count - 2);
        first += power * c[at.min(2 * count - 2 - at) * stride];
        power *= POLE;
    }
    c[0] = GAIN * first;
    for k in 1..count {
        c[k * stride] = GAIN * c[k * stride] + POLE * c[(k - 1) * stride];
    }
    let (last, before) = ((count - 1) * stride, (count - 2) * stride);
    c[last] = POLE / (POLE * POLE - 1.0) * (c[last] + POLE * c[before]);
    for k in (0..count - 1).rev() {
        c[k * stride] = POLE * (c[(k + 1) * stride] - c[k * stride]);
    }
}

/// Height in the cell of column and row `[i, j]`, at shares `[u, v]` of it; `around` are the sixteen samples around. Beside
/// no-data bilinear.
pub(super) fn height(
    c: &[f32],
    [width, height]: [usize; 2],
    [i, j]: [usize; 2],
    [u, v]: [f32; 2],
    around: &[[f32; 4]; 4],
) -> f32 {
    let middle = [around[1][1], around[1][2], around[2][1], around[2][2]];
    if around.iter().flatten().sum::<f32>().is_nan() {
        return bilinear_of_known(middle, u, v);
    }
    if middle.iter().all(|&z| z == middle[0]) {
        return middle[0];
    }
    let (along, across) = (weights(u), weights(v));
    let mut z = 0.0;
    for (k, across) in across.into_iter().enumerate() {
        let row = mirrored(j + k, height) * width;
        let sum: f32 = (0..4).map(|l| along[l] * c[row + mirrored(i + l, width)]).sum();
        z += across * sum;
    }
    z.max(middle.into_iter().fold(0.0, f32::min))
}

/// One less than `k`, mirrored into `0..count`.
fn mirrored(k: usize, count: usize) -> usize {
    let at = if k == 0 { 1 } else { k - 1 };
    let last = count - 1;
    (if at > last { 2 * last - at } else { at }).min(last)
}

/// What the four coefficients around a share of a cell weigh.
fn weights(t: f32) -> [f32; 4] {
    let (s, t2, t3) = (1.0 - t, t * t, t * t * t);
    [
        s * s * s / 6.0,
        (4.0 - 6.0 * t2 + 3.0 * t3) / 6.0,
        (1.0 + 3.0 * (t + t2 - t3)) / 6.0,
        t3 / 6.0,
    ]
}

#[cfg(test)]
mod tests {
    use super::super::interpolate::Samples;

    fn smooth(width: usize, height: usize, z: impl Fn(usize, usize) -> f32) -> Samples {
        let heights_m = (0..width * height).map(|k| z(k % width, k / width)).collect();
        let mut samples = Samples { heights_m, width, height, spline: None };
        samples.smooth();
        samples
    }

    #[test]
    fn samples_are_met_and_planes_are_plane() {
        let rough = smooth(9, 7, |x, y| ((x * 37 + y * 101) % 17) as f32 * 50.0);
        for (x, y) in (0..9).flat_map(|x| (0..7).map(move |y| (x, y))) {
            let z = rough.at(x as f64, y as f64);
            assert!((z - rough.heights_m[y * 9 + x]).abs() < 0.01, "{x} {y}: {z}");
        }
        let plane = smooth(60, 60, |x, y| 3.0 * x as f32 + 2.0 * y as f32 + 50.0);
        assert!((plane.at(30.3, 29.6) - (90.9 + 59.2 + 50.0)).abs() < 1e-2);
    }

    #[test]
    fn slopes_have_no_kink_at_samples() {
        let hill =
            smooth(40, 40, |x, y| 900.0 * (-((x as f32 - 20.3).powi(2) + (y as f32 - 19.1).powi(2)) / 12.0).exp());
        let bend = |at: f64| (hill.at(at + 0.05, 19.0) - 2.0 * hill.at(at, 19.0) + hill.at(at - 0.05, 19.0)) / 0.0025;
        for x in [17.0, 18.0, 22.0, 23.0] {
            assert!((bend(x - 0.06) - bend(x + 0.06)).abs() < 25.0, "{} {}", bend(x - 0.06), bend(x + 0.06));
        }
    }

    #[test]
    fn the_sea_is_level_and_not_undercut() {
        let coast = smooth(12, 12, |x, _| if x < 6 { 0.0 } else { 400.0 });
        assert!((0..=50).all(|k| coast.at(f64::from(k) * 0.1, 5.3) == 0.0));
        assert!((50..=60).all(|k| coast.at(f64::from(k) * 0.1, 5.3) >= 0.0));
    }
}
