//! The ground of the experiment: a TIN of the paper's size from a height field, larger ones of mirrored copies, the camera.

use crate::Error;
use glam::{DVec2, DVec3};
use std::collections::HashMap;
use yamanami_core::{HeightField, TriangleMesh, View};
use yamanami_multires::tin::{GreedyOptions, greedy};
use yamanami_multires::tin_block::{BlockGrid, cut};

/// The paper's blocks.
pub(super) const BLOCK_M: f64 = 520.0;
pub(super) const COLUMNS: usize = 6;
pub(super) const ROWS: usize = 4;
/// The paper's triangles, after the cut.
pub(super) const PAPER_TRIANGLES: usize = 41_797;
/// The paper's distance to the level 1/2; to each further level it is twice as far.
const THRESHOLD_M: f64 = 1000.0;
const PICTURE_PX: [u32; 2] = [1024, 768];

/// A TIN of the field that has about the paper's triangles once it is cut, its south-west corner at (0, 0).
pub(super) fn paper_tin(field: &HeightField) -> Result<TriangleMesh, Error> {
    let mut target = PAPER_TRIANGLES;
    let mut tin = TriangleMesh::default();
    // what the cut adds depends little on the target
    for _ in 0..3 {
        let options = GreedyOptions { max_error_m: 0.0, most_triangles: Some(target) };
        tin = greedy(field, &options)?.tin.mesh;
        let low = tin.bounds().min;
        tin.positions.iter_mut().for_each(|p| *p -= DVec3::new(low.x, low.y, 0.0));
        let after = cut(&tin, &grid(1)?)?.mesh.triangles.len();
        if after.abs_diff(PAPER_TRIANGLES) <= 1 {
            break;
        }
        target = (target + PAPER_TRIANGLES).saturating_sub(after).max(2);
    }
    Ok(tin)
}

/// The paper's blocks for `copies` by `copies` grounds.
pub(super) fn grid(copies: usize) -> Result<BlockGrid, Error> {
    Ok(BlockGrid::new(DVec2::ZERO, DVec2::splat(BLOCK_M), [COLUMNS * copies, ROWS * copies])?)
}

/// The paper's distances to the levels 1/2 and 1/4, and more of the kind as far as a larger ground reaches: the paper leaves
/// the number of levels to the area.
pub(super) fn thresholds_m(copies: usize) -> Vec<f64> {
    let diagonal_m = BLOCK_M * (COLUMNS as f64).hypot(ROWS as f64) * copies as f64;
    std::iter::successors(Some(THRESHOLD_M), |m| Some(2.0 * m)).take_while(|&m| m < diagonal_m).collect()
}

/// `copies` by `copies` of a ground side by side, every other one mirrored, so that they meet without a step.
pub(super) fn mirrored(tin: &TriangleMesh, copies: usize) -> TriangleMesh {
    let extent = DVec2::new(COLUMNS as f64 * BLOCK_M, ROWS as f64 * BLOCK_M);
    let mut positions = Vec::with_capacity(tin.positions.len() * copies * copies);
    let mut triangles = Vec::with_capacity(tin.triangles.len() * copies * copies);
    // vertices on the borders of copies, by their places: two copies share them
    let mut shared = HashMap::new();
    for (row, column) in (0..copies).flat_map(|row| (0..copies).map(move |column| (row, column))) {
        let turned = |v: f64, length: f64, nth: usize| {
            let start = nth as f64 * length;
            if nth.is_multiple_of(2) { start + v } else { start + (length - v) }
        };
        let numbers: Vec<u32> = tin
            .positions
            .iter()
            .map(|p| {
                let place = DVec3::new(turned(p.x, extent.x, column), turned(p.y, extent.y, row), p.z);
                let mut add = || {
                    positions.push(place);
                    positions.len() as u32 - 1
                };
                let is_border = p.x == 0.0 || p.y == 0.0 || p.x == extent.x || p.y == extent.y;
                if is_border { *shared.entry(place.to_array().map(f64::to_bits)).or_insert_with(add) } else { add() }
            })
            .collect();
        let is_mirrored = (row + column) % 2 == 1;
        triangles.extend(tin.triangles.iter().map(|triangle| {
            let [a, b, c] = triangle.map(|v| numbers[v as usize]);
            if is_mirrored { [a, c, b] } else { [a, b, c] }
        }));
    }
    TriangleMesh::new(positions, triangles)
}

/// The paper's eye, 100 m high and looking level, 45°: in the middle of the south-west block, towards the north-east corner of
/// the paper's ground. (Where its figure 4 puts the eye is not said in words.)
pub(super) fn paper_view() -> View {
    let eye = DVec3::new(0.5 * BLOCK_M, 0.5 * BLOCK_M, 100.0);
    let target = DVec3::new(COLUMNS as f64 * BLOCK_M, ROWS as f64 * BLOCK_M, 100.0);
    View { eye, target, fov_y_rad: std::f64::consts::FRAC_PI_4, viewport_px: PICTURE_PX }
}

/// The paper's eye with a view 45° wide that has neither top nor bottom: what its rule does in plan.
pub(super) fn view_in_plan() -> View {
    // so high that its planes above and below are upright
    let fov_y_rad = 2.0 * 1000f64.atan();
    View { fov_y_rad, viewport_px: [4_142, 10_000_000], ..paper_view() }
}

/// An eye over the middle of a block that looks east and 20° down: the block that it is in has no corner in view.
pub(super) fn own_block_view() -> View {
    let eye = DVec3::new(2.5 * BLOCK_M, 2.5 * BLOCK_M, 100.0);
    let fall = 20f64.to_radians();
    View { eye, target: eye + DVec3::new(fall.cos(), 0.0, -fall.sin()), ..paper_view() }
}

/// Straight down on the paper's ground, from so far that nothing leans.
pub(super) fn plan_view(longest_px: u32) -> View {
    let extent = DVec2::new(COLUMNS as f64 * BLOCK_M, ROWS as f64 * BLOCK_M);
    let middle = extent * 0.5;
    let height_px = (f64::from(longest_px) * extent.y / extent.x).round() as u32;
    let away_m = 60_000.0;
    View {
        eye: middle.extend(away_m),
        target: middle.extend(0.0),
        fov_y_rad: 2.0 * (0.5 * extent.y * 1.01 / away_m).atan(),
        viewport_px: [longest_px, height_px],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use yamanami_testkit::check_conforming;
    use yamanami_testkit::laws::Kind;

    #[test]
    fn thresholds_are_the_papers_and_grow_with_the_ground() {
        assert_eq!(thresholds_m(1), [1000.0, 2000.0]);
        assert_eq!(thresholds_m(10).len(), 6);
    }

    #[test]
    fn mirrored_copies_are_one_ground() {
        let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let positions = vec![
            at(0.0, 0.0, 1.0),
            at(3120.0, 0.0, 2.0),
            at(3120.0, 2080.0, 3.0),
            at(0.0, 2080.0, 4.0),
            at(900.0, 777.7, 9.0),
        ];
        let tin = TriangleMesh::new(positions, vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]);
        let all = mirrored(&tin, 3);
        assert_eq!(all.triangles.len(), 36);
        assert_eq!(all.positions.len(), 9 + 16);
        let base = TriangleMesh::new(
            vec![at(0.0, 0.0, 0.0), at(9360.0, 0.0, 0.0), at(9360.0, 6240.0, 0.0), at(0.0, 6240.0, 0.0)],
            vec![[0, 1, 2], [0, 2, 3]],
        );
        assert_eq!(check_conforming(&all, &all, Kind::Terrain), Ok(()));
        assert_eq!(all.bounds().max.truncate(), base.bounds().max.truncate());
    }
}
