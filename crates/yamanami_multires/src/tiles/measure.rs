//! How far the samples in a triangle of a tile are from it, one by one: where a bound says more than was promised.

use super::piece::{GRID, Tile};
use super::plan::Plan;
use super::sheet::{Plane, Sheet};
use super::walk::Ground;
use crate::wavelet::TerrainData;
use yamanami_core::LatticeNode;

/// Of a triangle's sides and corners, samples this much outside belong to it too, in shares of its size.
const SLACK: f64 = 1e-9;

/// Greatest error of a tile's samples. Triangles of the finest zoom whose bound is above the tolerance are measured; where the
/// lattice is coarser than the samples, all that heights can differ counts.
pub(super) fn error_m<D: TerrainData>(
    ground: &Ground<'_, D>,
    plan: &Plan,
    tile: Tile,
    sheet: &Sheet,
    absent: &mut Vec<LatticeNode>,
) -> f64 {
    if plan.is_crude(tile.zoom) {
        return plan.relief_m;
    }
    let mut greatest = 0f64;
    for (triangle, bound_m) in sheet.bounds_m().enumerate() {
        if bound_m <= greatest {
            continue;
        }
        let is_loose = tile.zoom == plan.last && bound_m > plan.tolerance_m;
        let error_m =
            if is_loose { bound_m.min(measured_m(ground, plan, tile, sheet, triangle, absent)) } else { bound_m };
        greatest = greatest.max(error_m);
    }
    greatest
}

fn measured_m<D: TerrainData>(
    ground: &Ground<'_, D>,
    plan: &Plan,
    tile: Tile,
    sheet: &Sheet,
    triangle: usize,
    absent: &mut Vec<LatticeNode>,
) -> f64 {
    let corners = sheet.triangles[triangle];
    let places = corners.map(|v| sheet.places[v as usize]);
    let plane = Plane::through([0, 1, 2].map(|k| {
        let [u, v] = places[k].map(f64::from);
        [u, v, sheet.heights_m[corners[k] as usize]]
    }));
    let grid = places.map(|place| ground.placement.grid(tile.place(place)));
    let size = [ground.lattice.width(), ground.lattice.height()];
    let reach = [0, 1].map(|axis| {
        let [low, high] =
            grid.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], p| [a.min(p[axis]), b.max(p[axis])]);
        // a cast takes what is below 0 for 0
        let last = f64::from(size[axis] - 1);
        [(low.floor() - 1.0).min(last) as u32, (high.ceil() + 1.0).min(last) as u32]
    });
    let side = reach.iter().map(|[from, to]| to - from).max().unwrap_or(1).max(1);
    let level = (u32::BITS - (side - 1).leading_zeros()) as usize;
    let sagitta_m = plan.sagitta_m.get(level.min(plan.sagitta_m.len() - 1)).copied().unwrap_or(0.0);
    let scale = f64::from(1u32 << tile.zoom);
    let turn = |a: [f64; 2], b: [f64; 2], p: [f64; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    let [a, b, c] = places.map(|place| place.map(f64::from));
    let least = -SLACK * turn(a, b, c).abs();
    let mut greatest = 0f64;
    for row in reach[1][0]..=reach[1][1] {
        for column in reach[0][0]..=reach[0][1] {
            let [x, y] = ground.placement.place([column, row]);
            let p = [(x, tile.x), (y, tile.y)].map(|(at, index)| (at * scale - f64::from(index)) * f64::from(GRID));
            if turn(a, b, p) < least || turn(b, c, p) < least || turn(c, a, p) < least {
                continue;
            }
            let node = LatticeNode { level: 0, x: column, y: row };
            if !ground.data.is_resident(node) {
                absent.push(node);
                continue;
            }
            let height_m = f64::from(ground.data.sample_height_m(column, row))
                + ground.placement.lift_m([f64::from(column), f64::from(row)]);
            greatest = greatest.max((plane.at(p) - height_m).abs());
        }
    }
    greatest + sagitta_m
}
