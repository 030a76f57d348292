//! What a kept vertex does for the samples it stands for: nothing, the paper's rule, or true summits alone.
//!
//! Based on: Hori, Okajima, Miyamura, Furuya, Saito, figure 7: a kept vertex takes the greatest height of its cell where that
//! reaches 50 m, else the least. So every vertex rises, on slopes too, not only at summits: the mesh lies above the ground
//! in the mean. [`PeakRule::Summits`] moves only what is a summit or on the ridge between two.

use super::ridges::ridge_samples;
use crate::rtin::Summit;
use std::cmp::Ordering;
use yamanami_core::FieldLevel;

/// Height from which the paper keeps the highest of a cell, metres.
pub const PAPER_PEAK_M: f64 = 50.0;

/// No vertex.
const NONE: u32 = u32::MAX;

/// What kept vertices do for dropped samples. A vertex's cell are the samples that are nearer to it than to the other
/// corners of their triangle.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum PeakRule {
    /// Every vertex has its own height.
    #[default]
    None,
    /// The paper's: the greatest height of the cell where one reaches [`PAPER_PEAK_M`], else the least.
    Paper,
    /// A vertex takes the height of the highest summit of its cell that stands out this much, or else of the highest sample
    /// of a ridge between such summits; all others keep their own.
    Summits {
        /// Least prominence, metres.
        min_prominence_m: f64,
    },
}

/// How far a drawn summit is from the true one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SummitError {
    /// Height of the vertex that stands for it less its own, metres.
    pub height_error_m: f64,
    /// Distance of that vertex in plan, metres.
    pub shift_m: f64,
}

/// Heights of the vertices under a rule.
pub(super) fn heights(
    grid: &FieldLevel,
    samples: &[[u32; 2]],
    triangles: &[[u32; 3]],
    rule: PeakRule,
    summits: &[Summit],
) -> Vec<f64> {
    let at = |[column, row]: [u32; 2]| f64::from(grid.heights_m()[row as usize * grid.width() + column as usize]);
    let own: Vec<f64> = samples.iter().map(|&s| at(s)).collect();
    match rule {
        PeakRule::None => own,
        PeakRule::Paper => {
            let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; samples.len()];
            for (&vertex, &z) in owners(grid, samples, triangles).iter().zip(grid.heights_m()) {
                if vertex != NONE {
                    let [low, high] = &mut ranges[vertex as usize];
                    (*low, *high) = (low.min(f64::from(z)), high.max(f64::from(z)));
                }
            }
            ranges.into_iter().map(|[low, high]| if high >= PAPER_PEAK_M { high } else { low }).collect()
        }
        PeakRule::Summits { min_prominence_m } => {
            let kept: Vec<Summit> = summits.iter().copied().filter(|s| s.prominence_m >= min_prominence_m).collect();
            let owners = owners(grid, samples, triangles);
            let mut moved = own.clone();
            let tops = kept.iter().map(|s| [s.column, s.row]);
            raise(grid, &owners, ridge_samples(grid, &kept), &mut moved);
            let mut by_summits = vec![f64::NEG_INFINITY; own.len()];
            raise(grid, &owners, tops, &mut by_summits);
            moved.into_iter().zip(by_summits).map(|(z, top)| if top.is_finite() { top } else { z }).collect()
        }
    }
}

/// Raises the owners of samples to their heights.
fn raise(grid: &FieldLevel, owners: &[u32], tops: impl IntoIterator<Item = [usize; 2]>, heights: &mut [f64]) {
    let width = grid.width();
    for [column, row] in tops {
        let k = row * width + column;
        let owner = if column < width { owners.get(k) } else { None };
        if let Some(z) = owner.and_then(|&vertex| heights.get_mut(vertex as usize)) {
            *z = z.max(f64::from(grid.heights_m()[k]));
        }
    }
}

/// The vertex that each sample of the grid belongs to, or [`NONE`].
fn owners(grid: &FieldLevel, samples: &[[u32; 2]], triangles: &[[u32; 3]]) -> Vec<u32> {
    let width = grid.width();
    let mut owners = vec![NONE; width * width];
    // on an edge two triangles may differ: the nearest counts, then the first
    let mut distances = vec![i64::MAX; width * width];
    for triangle in triangles {
        let corners = triangle.map(|v| samples[v as usize].map(i64::from));
        let range = |k: usize| {
            let at = corners.map(|c| c[k]);
            at.into_iter().min().unwrap_or(0)..=at.into_iter().max().unwrap_or(-1)
        };
        for (row, column) in range(1).flat_map(|row| range(0).map(move |column| (row, column))) {
            if holds(corners, [column, row]) {
                let found = nearest(*triangle, samples, [column, row]);
                let k = row as usize * width + column as usize;
                if found.cmp(&(distances[k], owners[k])) == Ordering::Less {
                    (distances[k], owners[k]) = found;
                }
            }
        }
    }
    owners
}

/// Squared distance and number of the corner of a triangle that is nearest to a sample; the first among equals.
pub(super) fn nearest(triangle: [u32; 3], samples: &[[u32; 2]], at: [i64; 2]) -> (i64, u32) {
    let distance = |v: u32| {
        let [dx, dy] = [0, 1].map(|k| i64::from(samples[v as usize][k]) - at[k]);
        (dx * dx + dy * dy, v)
    };
    let [a, b, c] = triangle.map(distance);
    a.min(b).min(c)
}

/// Whether a sample lies in a triangle or on its border.
pub(super) fn holds([a, b, c]: [[i64; 2]; 3], at: [i64; 2]) -> bool {
    // rows run south: counter-clockwise from above is a negative turn
    let turn = |p: [i64; 2], q: [i64; 2]| (q[0] - p[0]) * (at[1] - p[1]) - (q[1] - p[1]) * (at[0] - p[0]);
    turn(a, b) <= 0 && turn(b, c) <= 0 && turn(c, a) <= 0
}
