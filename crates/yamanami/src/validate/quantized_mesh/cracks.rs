//! Cracks of a terrain pyramid: every side against that of the neighbour at its own zoom and at every coarser one.

use super::pyramid::{GRID, Pyramid, Tile, TileId};
use crate::validate::report::{CrackRow, ValidateReport};
use rayon::prelude::*;
use std::collections::BTreeMap;
use yamanami_measure::tiles::Gap;

/// Share of a side that rounding may leave.
const UNCOVERED: f64 = 1e-6;

/// A side held against that of a tile at the same zoom or a coarser one.
struct Pair {
    fine: TileId,
    coarse: TileId,
    side: usize,
    gap: Gap,
    /// What their quantisation explains, metres.
    half_steps_m: f64,
    place: [f64; 2],
}

/// Measures the sides of the tiles chosen, and reports those that gape by more than `most_m` and their quantisation.
pub(super) fn measure(
    pyramid: &Pyramid,
    chosen: &[TileId],
    most_m: f64,
    report: &mut ValidateReport,
    progress: &(dyn Fn(f32) + Sync),
) {
    let mut rows: BTreeMap<(u32, u32), CrackRow> = BTreeMap::new();
    const AT_ONCE: usize = 256;
    for (k, tiles) in chosen.chunks(AT_ONCE).enumerate() {
        progress((k * AT_ONCE) as f32 / chosen.len() as f32);
        let found: Vec<Vec<Pair>> = tiles.par_iter().map(|&id| pairs(pyramid, id)).collect();
        for pair in found.into_iter().flatten() {
            take(pyramid, &pair, most_m, &mut rows, report);
        }
    }
    report.cracks.extend(rows.into_values());
}

fn take(
    pyramid: &Pyramid,
    pair: &Pair,
    most_m: f64,
    rows: &mut BTreeMap<(u32, u32), CrackRow>,
    report: &mut ValidateReport,
) {
    let Pair { fine, coarse, side, gap, half_steps_m, place } = pair;
    let row =
        rows.entry((coarse.z, fine.z)).or_insert(CrackRow { coarse: coarse.z, fine: fine.z, ..CrackRow::default() });
    row.pairs += 1;
    row.uncovered = row.uncovered.max(gap.uncovered);
    if gap.max_m > row.max_m || row.pairs == 1 {
        (row.max_m, row.worst) = (gap.max_m, *place);
    }
    let name = ["west", "south", "east", "north"][*side];
    let other = pyramid.name(*coarse);
    if gap.max_m > most_m + half_steps_m {
        row.over += 1;
        let code = if fine.z == coarse.z { "CR01" } else { "CR02" };
        let at = format!("{name} side at {:.6}, {:.6}", place[0], place[1]);
        let expected = format!("at most {:.3} m to {other}", most_m + half_steps_m);
        report.add(code, &pyramid.name(*fine), at, expected, format!("{:.3} m", gap.max_m));
    }
    if gap.uncovered > UNCOVERED {
        let expected = format!("both tiles along the whole side, with {other}");
        let found = format!("only one on {:.4} % of it", 100.0 * gap.uncovered);
        report.add("CR03", &pyramid.name(*fine), format!("{name} side"), expected, found);
    }
}

fn pairs(pyramid: &Pyramid, id: TileId) -> Vec<Pair> {
    let mut found = Vec::new();
    let Some(fine) = pyramid.tile(id) else { return found };
    let Ok(fine) = fine.as_ref() else { return found };
    for side in 0..4 {
        for levels in 0..=id.z {
            // tiles of one zoom meet twice: once is enough
            if levels == 0 && side >= 2 {
                continue;
            }
            let Some(neighbour) = neighbour(pyramid, id, side) else { break };
            let coarse = neighbour.ancestor(levels);
            if coarse == id.ancestor(levels) {
                // the line is inside of both from here on
                break;
            }
            if let Some(Ok(tile)) = pyramid.tile(coarse).as_deref() {
                found.push(hold(pyramid, fine, tile, side, levels));
            }
        }
    }
    found
}

/// The neighbour beyond a side; round the globe from west to east.
fn neighbour(pyramid: &Pyramid, id: TileId, side: usize) -> Option<TileId> {
    let columns = pyramid.columns(id.z);
    Some(match side {
        0 => TileId { x: (id.x + columns - 1) % columns, ..id },
        1 => TileId { y: id.y.checked_sub(1)?, ..id },
        2 => TileId { x: (id.x + 1) % columns, ..id },
        _ => TileId { y: Some(id.y + 1).filter(|&y| y < 1 << id.z)?, ..id },
    })
}

fn hold(pyramid: &Pyramid, fine: &Tile, coarse: &Tile, side: usize, levels: u32) -> Pair {
    let across = side % 2;
    let along = if across == 0 { fine.id.y } else { fine.id.x };
    // in steps of the finer tile's lattice, which all are whole numbers of them: no rounding
    let scale = f64::from(1u32 << levels);
    let first = f64::from(along - (along >> levels << levels)) * GRID;
    let other = coarse.sides[(side + 2) % 4].moved(scale, -first);
    let gap = fine.sides[side].gap(&other, [0.0, GRID]);
    let beside = if side < 2 { 0.0 } else { GRID };
    let place = pyramid.place(fine.id, if across == 0 { [beside, gap.at] } else { [gap.at, beside] });
    Pair { fine: fine.id, coarse: coarse.id, side, gap, half_steps_m: fine.half_step_m() + coarse.half_step_m(), place }
}
