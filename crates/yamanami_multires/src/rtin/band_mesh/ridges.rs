//! The samples of the ridges between summits: from each summit's saddle steeply upwards on all sides.

use crate::rtin::Summit;
use yamanami_core::FieldLevel;

/// The eight neighbours, round about.
const AROUND: [[i64; 2]; 8] = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1]];

/// Columns and rows of all samples on the ways of steepest ascent from the saddles, the saddles among them.
pub(super) fn ridge_samples(grid: &FieldLevel, summits: &[Summit]) -> Vec<[usize; 2]> {
    let mut ridge = Vec::new();
    let width = grid.width() as i64;
    let height = |[column, row]: [i64; 2]| {
        let inside = (0..width).contains(&column) && (0..width).contains(&row);
        inside.then(|| grid.heights_m()[(row * width + column) as usize])
    };
    let rise = |from: [i64; 2], by: [i64; 2]| {
        let to = [from[0] + by[0], from[1] + by[1]];
        let step = if by[0] != 0 && by[1] != 0 { std::f32::consts::SQRT_2 } else { 1.0 };
        Some((height(to)? - height(from)?) / step).filter(|&slope| slope > 0.0).map(|slope| (slope, to))
    };
    for saddle in summits.iter().filter_map(|s| s.saddle) {
        let saddle = saddle.map(|at| at as i64);
        if height(saddle).is_none() {
            continue;
        }
        ridge.push(saddle.map(|at| at as usize));
        // each run of higher neighbours is one side; its steepest begins a way
        let slopes = AROUND.map(|by| rise(saddle, by).map_or(0.0, |(slope, _)| slope));
        for (k, by) in AROUND.into_iter().enumerate() {
            let [before, after] = [slopes[(k + 7) % 8], slopes[(k + 1) % 8]];
            if slopes[k] == 0.0 || before >= slopes[k] || after > slopes[k] {
                continue;
            }
            let mut at = [saddle[0] + by[0], saddle[1] + by[1]];
            loop {
                ridge.push(at.map(|at| at as usize));
                let steepest = AROUND.into_iter().filter_map(|by| rise(at, by)).max_by(|a, b| a.0.total_cmp(&b.0));
                let Some((_, next)) = steepest else { break };
                at = next;
            }
        }
    }
    ridge
}
