//! σ(a): how far slopes along a line of length a are from those to its middle.
//!
//! Based on: Hori, Okajima, Miyamura, Furuya, Saito, "LoD control for large-area deformed map" (equation (4), figure 9).
//! A hypotenuse of length a that is not split at its middle hides E = |tan θ12 − tan θ13| = 2d / a, with d the height of
//! the ground at the middle over the straight line; σ(a) is the root of its mean square over the terrain.

use glam::DVec2;
use rayon::prelude::*;
use std::ops::Range;
use yamanami_core::FieldLevel;

/// σ of one length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SigmaRow {
    /// a, metres: twice the spacing times a power of √2.
    pub hypotenuse_m: f64,
    /// Root of the mean square of 2d / a.
    pub sigma: f64,
    /// How many lines were looked at.
    pub lines: u64,
}

/// σ of all hypotenuses whose middle is a sample, the shortest first, over the square of this half side around a centre:
/// along rows and columns for a of 2, 4, 8, … spacings, along both diagonals for √2 of them. Lines that leave the square
/// or have a sample without data do not count, nor do lengths of which none is left.
pub fn slope_sigma(grid: &FieldLevel, centre: DVec2, half_side_m: f64) -> Vec<SigmaRow> {
    let [columns, rows] = square(grid, centre, half_side_m);
    let side = columns.len().max(rows.len());
    let mut table = Vec::new();
    for log2 in 0..usize::BITS {
        let half = 1usize << log2;
        if 2 * half >= side {
            break;
        }
        let axes = [[half as isize, 0], [0, half as isize]];
        let diagonals = [[half as isize; 2], [half as isize, -(half as isize)]];
        for (halves, length) in [(axes, 2.0), (diagonals, 8f64.sqrt())] {
            let hypotenuse_m = length * half as f64 * grid.spacing_m();
            let of_row = |row: usize| squares_of_row(grid, [&columns, &rows], row, halves);
            // row by row, so that the sum does not depend on the number of threads
            let of_rows: Vec<(f64, u64)> = rows.clone().into_par_iter().map(of_row).collect();
            let (sum, lines) = of_rows.iter().fold((0.0, 0), |all, row| (all.0 + row.0, all.1 + row.1));
            if lines > 0 {
                table.push(SigmaRow { hypotenuse_m, sigma: 2.0 / hypotenuse_m * (sum / lines as f64).sqrt(), lines });
            }
        }
    }
    table
}

/// Columns and rows of a square.
fn square(grid: &FieldLevel, centre: DVec2, half_side_m: f64) -> [Range<usize>; 2] {
    let width = grid.width();
    let [low, high] = [DVec2::new(-half_side_m, half_side_m), DVec2::new(half_side_m, -half_side_m)]
        .map(|corner| grid.grid_from_plane(centre + corner).clamp(DVec2::splat(-1.0), DVec2::splat(width as f64)));
    let range = |low: f64, high: f64| low.ceil().max(0.0) as usize..((high.floor() + 1.0).max(0.0) as usize).min(width);
    [range(low.x, high.x), range(low.y, high.y)]
}

/// Sum of d² over the lines whose middle is in a row, and their number; `halves` are half the lines, in samples.
fn squares_of_row(grid: &FieldLevel, area: [&Range<usize>; 2], row: usize, halves: [[isize; 2]; 2]) -> (f64, u64) {
    let (heights, known, width) = (grid.heights_m(), grid.known(), grid.width());
    let (mut sum, mut lines) = (0.0, 0);
    for [dx, dy] in halves {
        let (reach_x, reach_y) = (dx.unsigned_abs(), dy.unsigned_abs());
        let [columns, rows] = area;
        if row < rows.start + reach_y || row + reach_y >= rows.end {
            continue;
        }
        let step = dy * width as isize + dx;
        for column in columns.start + reach_x..columns.end.saturating_sub(reach_x) {
            let middle = row * width + column;
            let ends = [middle.wrapping_add_signed(-step), middle.wrapping_add_signed(step)];
            if known[middle] && known[ends[0]] && known[ends[1]] {
                let [a, b] = ends.map(|k| f64::from(heights[k]));
                let d = f64::from(heights[middle]) - 0.5 * (a + b);
                sum += d * d;
                lines += 1;
            }
        }
    }
    (sum, lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(half: u32, height: impl Fn(f64, f64) -> f64) -> FieldLevel {
        let width = 2 * half as usize + 1;
        let z = |k: usize| height((k % width) as f64 - f64::from(half), f64::from(half) - (k / width) as f64) as f32;
        FieldLevel::new(100.0, half, (0..width * width).map(z).collect())
    }

    #[test]
    fn a_plane_hides_nothing() {
        let table = slope_sigma(&grid(16, |x, y| 3.0 * x - 2.0 * y), DVec2::ZERO, 1e9);
        assert_eq!(table.len(), 10, "{table:?}");
        assert!(table.iter().all(|row| row.sigma == 0.0 && row.lines > 0));
        assert!((table[1].hypotenuse_m / table[0].hypotenuse_m - 2f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn a_bowl_is_as_steep_as_its_formula() {
        // z = x²/2 a sample: half a row line of h samples hides h²/2 metres, a column line nothing, a diagonal h²/2
        let table = slope_sigma(&grid(16, |x, _| 0.5 * x * x), DVec2::ZERO, 1e9);
        for (k, row) in table.iter().enumerate() {
            let h = f64::from(1 << (k / 2));
            let hidden = 0.5 * h * h;
            let share = if k % 2 == 0 { 0.5f64.sqrt() } else { 1.0 };
            let expected = 2.0 * hidden / row.hypotenuse_m * share;
            assert!((row.sigma / expected - 1.0).abs() < 1e-6, "{row:?}, expected {expected}");
        }
    }

    #[test]
    fn only_the_square_counts_and_only_data() {
        let bumpy = |x: f64, y: f64| if x.abs() <= 4.0 && y.abs() <= 4.0 { 0.0 } else { 50.0 * (x * y).sin() };
        let inside = slope_sigma(&grid(16, bumpy), DVec2::ZERO, 400.0);
        assert_eq!((inside.len(), inside[0].lines), (6, 2 * 7 * 9));
        assert!(inside.iter().all(|row| row.sigma == 0.0));
        let holes = grid(16, |x, y| if x > 0.0 { f64::NAN } else { x + y });
        assert!(slope_sigma(&holes, DVec2::ZERO, 1e9).iter().all(|row| row.sigma == 0.0));
        assert_eq!(slope_sigma(&grid(16, bumpy), DVec2::splat(1e7), 400.0), []);
        assert_eq!(slope_sigma(&grid(16, bumpy), DVec2::ZERO, -5.0), []);
    }
}
