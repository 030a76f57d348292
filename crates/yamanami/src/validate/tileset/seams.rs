//! Cracks between the tiles of a tileset: open borders of neighbours against each other, at every mix of levels.

use super::content::Contents;
use crate::validate::report::{CrackRow, ValidateReport};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::BTreeMap;
use yamanami_measure::tiles::SeamGap;
use yamanami_measure::tiles::earth::geodetic;

/// Of the smaller tile, how far apart borders may be to be held for one.
const REACH: f64 = 0.02;

/// Two tiles that touch, the coarser first.
struct Pair {
    coarse: usize,
    fine: usize,
}

pub(super) fn measure(
    contents: &Contents<'_, '_>,
    chosen: &[usize],
    most_m: f64,
    report: &mut ValidateReport,
    progress: &(dyn Fn(f32) + Sync),
) {
    let pairs = pairs(contents, chosen);
    let mut rows: BTreeMap<(u32, u32), CrackRow> = BTreeMap::new();
    const AT_ONCE: usize = 256;
    for (k, some) in pairs.chunks(AT_ONCE).enumerate() {
        progress((k * AT_ONCE) as f32 / pairs.len() as f32);
        let found: Vec<SeamGap> = some.par_iter().map(|pair| gap(contents, pair)).collect();
        for (pair, gap) in some.iter().zip(found).filter(|(_, gap)| gap.points > 0) {
            take(contents, pair, &gap, most_m, &mut rows, report);
        }
    }
    report.cracks.extend(rows.into_values());
}

fn place(contents: &Contents<'_, '_>, p: DVec3) -> [f64; 2] {
    if contents.is_on_globe {
        let [lon, lat, _] = geodetic(p);
        [lon, lat]
    } else {
        [p.x, p.y]
    }
}

fn take(
    contents: &Contents<'_, '_>,
    pair: &Pair,
    gap: &SeamGap,
    most_m: f64,
    rows: &mut BTreeMap<(u32, u32), CrackRow>,
    report: &mut ValidateReport,
) {
    let (coarse, fine) = (&contents.tree.tiles[pair.coarse], &contents.tree.tiles[pair.fine]);
    let key = (coarse.depth, fine.depth);
    let row = rows.entry(key).or_insert(CrackRow { coarse: key.0, fine: key.1, ..CrackRow::default() });
    row.pairs += 1;
    let at = place(contents, gap.at);
    if gap.max_m > row.max_m || row.pairs == 1 {
        (row.max_m, row.worst) = (gap.max_m, at);
    }
    if gap.max_m > most_m {
        row.over += 1;
        let code = if key.0 == key.1 { "CR01" } else { "CR02" };
        let expected = format!("at most {most_m:.3} m to {}", coarse.name);
        let found = format!("{:.3} m", gap.max_m);
        report.add(code, &fine.name, format!("border at {:.6}, {:.6}", at[0], at[1]), expected, found);
    }
}

fn gap(contents: &Contents<'_, '_>, pair: &Pair) -> SeamGap {
    let tiles = &contents.tree.tiles;
    let size = |k: usize| contents.mesh(k).size_m;
    let errors = tiles[pair.coarse].error_m.max(tiles[pair.fine].error_m);
    let smaller = size(pair.coarse).min(size(pair.fine));
    // where a tile's error is large, so may be its cracks; but not so large that all is near all
    let reach_m = (2.0 * errors).max(REACH * smaller).min(0.25 * smaller);
    let (a, b) = (contents.edges(pair.coarse), contents.edges(pair.fine));
    let (there, back) = (a.gap_to(&b, reach_m), b.gap_to(&a, reach_m));
    let mut worst = if there.max_m > back.max_m { there } else { back };
    worst.points = there.points + back.points;
    worst
}

/// Tiles with content whose volumes touch, of which neither lies below the other.
fn pairs(contents: &Contents<'_, '_>, chosen: &[usize]) -> Vec<Pair> {
    let tiles = &contents.tree.tiles;
    let spheres: Vec<(DVec3, f64)> = tiles.iter().map(|t| t.volume.map_or((DVec3::NAN, 0.0), |v| v.sphere())).collect();
    // along x, widest first to know how far to look back
    let mut order: Vec<usize> =
        (0..tiles.len()).filter(|&k| !tiles[k].contents.is_empty() && spheres[k].0.is_finite()).collect();
    order.sort_by(|&a, &b| (spheres[a].0.x - spheres[a].1).total_cmp(&(spheres[b].0.x - spheres[b].1)));
    let mut is_chosen = vec![false; tiles.len()];
    chosen.iter().for_each(|&k| is_chosen[k] = true);
    let mut open: Vec<usize> = Vec::new();
    let mut found = Vec::new();
    for &k in &order {
        let (centre, radius) = spheres[k];
        open.retain(|&other| spheres[other].0.x + spheres[other].1 >= centre.x - radius);
        for &other in &open {
            let near = spheres[other].0.distance(centre) <= (radius + spheres[other].1) * 1.001;
            if !near
                || !(is_chosen[k] || is_chosen[other])
                || is_above(contents, k, other)
                || is_above(contents, other, k)
            {
                continue;
            }
            let (coarse, fine) =
                if (tiles[k].depth, k) < (tiles[other].depth, other) { (k, other) } else { (other, k) };
            if is_chosen[fine] && !tiles[fine].is_added {
                found.push(Pair { coarse, fine });
            }
        }
        open.push(k);
    }
    found.sort_by_key(|p| (p.fine, p.coarse));
    found
}

/// Whether one tile lies above another.
fn is_above(contents: &Contents<'_, '_>, above: usize, tile: usize) -> bool {
    let tiles = &contents.tree.tiles;
    let mut at = Some(tile);
    while let Some(k) = at.filter(|&k| tiles[k].depth >= tiles[above].depth) {
        if k == above {
            return true;
        }
        at = tiles[k].parent;
    }
    false
}
