//! How far samples are from a triangle: every sample under it against its plane.
//!
//! A triangle of the mesh has a row of samples for each step from its shortest row to its longest, so its samples are
//! swept row by row without any test.

use super::diamonds::{Place, is_centre};
use super::ground::Ground;
use yamanami_core::FieldLevel;

/// Samples that are weighed at once.
const LANES: usize = 8;

/// A triangle as rows: `n + 1` rows upwards and downwards (or one way) of an anchor, the longest (left and right of it, or
/// one way, by n steps) at the anchor; and the plane through its corners.
#[derive(Debug, Clone, Copy)]
struct Rows {
    /// In steps of the grid from its centre.
    anchor: [i32; 2],
    n: i32,
    left: bool,
    right: bool,
    up: bool,
    down: bool,
    /// Height at the anchor, metres; rise per step eastwards and northwards.
    z: f64,
    east: f64,
    north: f64,
}

/// Greatest vertical distance in metres between a triangle (ends of its longest edge, middle of it, right-angled corner)
/// and the samples of spacing `2^k` units under it that lie within `reach` steps from the centre.
pub(super) fn distance_m(ground: &Ground, ends: [Place; 2], middle: Place, apex: Place, k: u32, reach: i32) -> f64 {
    let rows = rows(ground, ends, middle, apex, k);
    let [below, above] = [rows.down, rows.up].map(|goes| if goes { rows.n } else { 0 });
    let mut worst = 0.0;
    for y in (rows.anchor[1] - below).max(-reach)..=(rows.anchor[1] + above).min(reach) {
        let reach_x = rows.n - (y - rows.anchor[1]).abs();
        let first = if rows.left { rows.anchor[0] - reach_x } else { rows.anchor[0] };
        let last = if rows.right { rows.anchor[0] + reach_x } else { rows.anchor[0] };
        let (first, last) = (first.max(-reach), last.min(reach));
        if first > last {
            continue;
        }
        let z = rows.z + rows.east * f64::from(first - rows.anchor[0]) + rows.north * f64::from(y - rows.anchor[1]);
        worst = row_distance(row_of(ground.grid(k), y, [first, last]), z, rows.east).max(worst);
    }
    worst
}

/// Heights of a row's samples, both ends included.
#[inline]
fn row_of(grid: &FieldLevel, y: i32, [first, last]: [i32; 2]) -> &[f32] {
    let half = grid.half() as i32;
    let start = (half - y) as usize * grid.width();
    &grid.heights_m()[start + (half + first) as usize..=start + (half + last) as usize]
}

fn rows(ground: &Ground, ends: [Place; 2], middle: Place, apex: Place, k: u32) -> Rows {
    let z = |p: Place| f64::from(ground.height_m(p));
    let [za, zb, zc] = [z(ends[0]), z(ends[1]), z(apex)];
    let steps = |d: i32| f64::from(d >> k);
    let own = (middle[0] | middle[1]).trailing_zeros();
    if is_centre(middle, own) {
        // legs along the axes: the anchor is the right-angled corner
        let n = (2 << own) >> k;
        let (mut east, mut north) = (0.0, 0.0);
        for (end, z_end) in [(ends[0], za), (ends[1], zb)] {
            if end[1] == apex[1] {
                east = (z_end - zc) / steps(end[0] - apex[0]);
            } else {
                north = (z_end - zc) / steps(end[1] - apex[1]);
            }
        }
        let [right, up] = [middle[0] > apex[0], middle[1] > apex[1]];
        let anchor = apex.map(|v| v >> k);
        return Rows { anchor, n, left: !right, right, up, down: !up, z: zc, east, north };
    }
    // longest edge along an axis: the anchor is its middle
    let (n, anchor, zm) = ((1 << own) >> k, middle.map(|v| v >> k), 0.5 * (za + zb));
    let along = |axis: usize| (zb - za) / steps(ends[1][axis] - ends[0][axis]);
    let aside = |axis: usize| (zc - zm) / steps(apex[axis] - middle[axis]);
    if ends[0][1] == ends[1][1] {
        let up = apex[1] > middle[1];
        Rows { anchor, n, left: true, right: true, up, down: !up, z: zm, east: along(0), north: aside(1) }
    } else {
        let right = apex[0] > middle[0];
        Rows { anchor, n, left: !right, right, up: true, down: true, z: zm, east: aside(0), north: along(1) }
    }
}

/// Greatest distance of a row from a line that starts at height `z` and rises by `rise` a sample.
#[inline]
fn row_distance(row: &[f32], z: f64, rise: f64) -> f64 {
    let mut worst = [0f64; LANES];
    let mut chunks = row.chunks_exact(LANES);
    let mut first = 0.0;
    for chunk in &mut chunks {
        for lane in 0..LANES {
            let off = (f64::from(chunk[lane]) - (z + rise * (first + lane as f64))).abs();
            // without the NaN rules of f64::max, so that it is one instruction
            worst[lane] = if off > worst[lane] { off } else { worst[lane] };
        }
        first += LANES as f64;
    }
    let mut most = worst.into_iter().fold(0.0, f64::max);
    for (i, &height_m) in chunks.remainder().iter().enumerate() {
        let off = (f64::from(height_m) - (z + rise * (first + i as f64))).abs();
        most = if off > most { off } else { most };
    }
    most
}
