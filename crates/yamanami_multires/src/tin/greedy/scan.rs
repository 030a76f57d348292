//! The sample that a triangle misses most.

use super::net::Place;
use yamanami_core::HeightField;

/// A sample and how far it is from the triangle above or below it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Worst {
    /// Its number, row by row.
    pub(super) sample: u32,
    /// Vertical distance, metres.
    pub(super) error_m: f64,
}

impl Worst {
    pub(super) const NONE: Self = Self { sample: 0, error_m: 0.0 };
}

/// Looks at every sample inside the triangle and on its edges; ties go to the first, row by row. A triangle with no-data at a
/// corner misses none.
pub(super) fn worst_sample(field: &HeightField, corners: [Place; 3]) -> Worst {
    let plane = Plane::of(field, corners);
    if plane.slope[0].is_nan() || plane.slope[1].is_nan() {
        return Worst::NONE;
    }
    let (top, bottom) = corners.iter().fold((i32::MAX, i32::MIN), |(top, bottom), p| (top.min(p[1]), bottom.max(p[1])));
    let mut worst = Worst::NONE;
    for row in top..=bottom {
        let Some((first, last)) = span(corners, row) else { continue };
        let start = row as usize * field.width() + first as usize;
        let heights = &field.heights_m()[start..=start + (last - first) as usize];
        let base = plane.at(first, row);
        let most = farthest(heights, base, plane.slope[0]);
        if most > worst.error_m
            && let Some(k) = (0..heights.len()).find(|&k| distance(heights, k, base, plane.slope[0]) == most)
        {
            worst = Worst { sample: (start + k) as u32, error_m: most };
        }
    }
    let [column, row] = [worst.sample as usize % field.width(), worst.sample as usize / field.width()];
    // a corner is missed by rounding alone
    if corners.contains(&[column as i32, row as i32]) { Worst::NONE } else { worst }
}

/// The plane through the corners.
struct Plane {
    origin: Place,
    height_m: f64,
    /// Metres a column and a row.
    slope: [f64; 2],
}

impl Plane {
    fn of(field: &HeightField, [a, b, c]: [Place; 3]) -> Self {
        let z = |p: Place| f64::from(field.at(p[0] as usize, p[1] as usize));
        let from_a = |p: Place| [f64::from(p[0] - a[0]), f64::from(p[1] - a[1]), z(p) - z(a)];
        let ([bx, by, bz], [cx, cy, cz]) = (from_a(b), from_a(c));
        let area = bx * cy - by * cx;
        Self { origin: a, height_m: z(a), slope: [(bz * cy - by * cz) / area, (bx * cz - bz * cx) / area] }
    }

    fn at(&self, column: i32, row: i32) -> f64 {
        let [x, y] = [column - self.origin[0], row - self.origin[1]].map(f64::from);
        self.height_m + x * self.slope[0] + y * self.slope[1]
    }
}

#[inline]
fn distance(heights: &[f32], k: usize, base: f64, slope: f64) -> f64 {
    (base + k as f64 * slope - f64::from(heights[k])).abs()
}

/// Greatest distance in a row of samples, in lanes for the compiler to put side by side.
fn farthest(heights: &[f32], base: f64, slope: f64) -> f64 {
    const LANES: usize = 4;
    let mut most = [0f64; LANES];
    let whole = heights.len() / LANES * LANES;
    for k in (0..whole).step_by(LANES) {
        for lane in 0..LANES {
            most[lane] = most[lane].max(distance(heights, k + lane, base, slope));
        }
    }
    for k in whole..heights.len() {
        most[0] = most[0].max(distance(heights, k, base, slope));
    }
    most.into_iter().fold(0.0, f64::max)
}

/// First and last column of a row that the triangle holds.
fn span(corners: [Place; 3], row: i32) -> Option<(i32, i32)> {
    let (mut first, mut last) = (i64::MIN, i64::MAX);
    for k in 0..3 {
        let ([ax, ay], [bx, by]) = (corners[k].map(i64::from), corners[(k + 1) % 3].map(i64::from));
        // inside is where (b - a) x (p - a) is not negative
        let (dx, dy, y) = (bx - ax, by - ay, i64::from(row) - ay);
        if dy > 0 {
            last = last.min(ax + (dx * y).div_euclid(dy));
        } else if dy < 0 {
            first = first.max(ax - (dx * y).div_euclid(-dy));
        }
    }
    (first <= last).then_some((first as i32, last as i32))
}
