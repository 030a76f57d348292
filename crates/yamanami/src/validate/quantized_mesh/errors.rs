//! Declared against measured errors of a terrain pyramid: exactly against the finest descendants, and against the source.

use super::pyramid::{GRID, Pyramid, Tile, TileId};
use crate::Error;
use crate::validate::fit::{Fit, fit};
use crate::validate::report::{ErrorRow, ValidateReport};
use crate::validate::{MOST_SHIFT_SAMPLES, Source, ValidateOptions, sample};
use glam::DVec2;
use rayon::prelude::*;
use std::collections::BTreeMap;
use yamanami_core::TriangleMesh;
use yamanami_measure::SurfaceIndex;
use yamanami_measure::tiles::earth::SEMI_MAJOR_M;
use yamanami_measure::tin::{PlanIndex, vertical_difference};

/// Descendants that one tile is held against where only some tiles are looked at.
const LEAVES_OF_SOME: usize = 64;

/// A ratio above this breaks the promise; below it is rounding.
const KEPT: f64 = 1.001;

/// The error that a zoom has: declared for the deepest and doubling upwards, or the one by which viewers choose levels.
struct Declared {
    deepest: u32,
    of_deepest_m: Option<f64>,
    roots: f64,
}

impl Declared {
    /// What CesiumJS takes a heightmap's error for: a 65th of a tile at the equator, a quarter of it.
    fn metres(&self, z: u32) -> f64 {
        match self.of_deepest_m {
            Some(error_m) => error_m * 2f64.powi((self.deepest - z) as i32),
            None => SEMI_MAJOR_M * std::f64::consts::TAU * 0.25 / (65.0 * self.roots) / f64::from(1u32 << z),
        }
    }
}

/// What a tile is off by.
struct Found {
    id: TileId,
    measured_m: f64,
    /// Area of descendants that the tile does not cover, of the tile's.
    uncovered: f64,
    fit: Fit,
}

pub(super) fn measure(
    pyramid: &Pyramid,
    chosen: &[TileId],
    options: &ValidateOptions,
    source: Option<&Source>,
    report: &mut ValidateReport,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<(), Error> {
    let deepest = pyramid.tiles.iter().map(|id| id.z).max().unwrap_or(0);
    let declared = Declared { deepest, of_deepest_m: options.declared_m, roots: f64::from(pyramid.columns(0)) };
    let mut rows: BTreeMap<u32, (ErrorRow, Fit)> = BTreeMap::new();
    const AT_ONCE: usize = 64;
    for (k, tiles) in chosen.chunks(AT_ONCE).enumerate() {
        progress((k * AT_ONCE) as f32 / chosen.len() as f32);
        let found: Result<Vec<_>, Error> = tiles
            .par_iter()
            .map(|&id| one(pyramid, id, &declared, chosen.len() < pyramid.tiles.len(), source))
            .collect();
        for found in found?.into_iter().flatten() {
            judge(pyramid, &declared, &found, report);
            let (row, fits) = rows.entry(found.id.z).or_default();
            let declared_m = declared.metres(found.id.z);
            (row.level, row.declared_m) = (found.id.z, declared_m);
            row.tiles += 1;
            row.measured_m = row.measured_m.max(found.measured_m);
            row.ratio = row.ratio.max(found.measured_m / declared_m);
            row.source_ratio = row.source_ratio.max(found.fit.max_m / declared_m);
            *fits = fits.merge(found.fit);
        }
    }
    for (row, fit) in rows.values_mut() {
        row.samples = [fit.samples, fit.uncovered];
        row.source_m = [fit.max_m, fit.rms_m()];
        row.shift = fit.shift.samples();
    }
    if let Some((row, _)) = rows.values().next_back()
        && let Some([x, y]) = row.shift.filter(|s| s[0].hypot(s[1]) > MOST_SHIFT_SAMPLES)
    {
        let found = format!("{x:.3} to the right, {y:.3} downwards");
        let expected = format!("at most {MOST_SHIFT_SAMPLES} samples from the source");
        report.add("ER05", "", format!("zoom {}", row.level), expected, found);
    }
    report.errors.extend(rows.into_values().map(|(row, _)| row));
    Ok(())
}

fn judge(pyramid: &Pyramid, declared: &Declared, found: &Found, report: &mut ValidateReport) {
    let declared_m = declared.metres(found.id.z);
    let name = pyramid.name(found.id);
    let is_given = declared.of_deepest_m.is_some();
    let what = if is_given { "declared" } else { "implied by the zoom" };
    let expected = || format!("at most {declared_m:.3} m, as {what}");
    if found.measured_m > declared_m * KEPT {
        let code = if is_given { "ER01" } else { "ER02" };
        report.add(code, &name, "against its finest descendants", expected(), format!("{:.3} m", found.measured_m));
    }
    if found.uncovered > 1e-6 {
        let text = format!("{:.4} % of the tile is not", 100.0 * found.uncovered);
        report.add("ER07", &name, "", "cover of all that its descendants cover", text);
    }
    let fit = &found.fit;
    if fit.max_m > declared_m * KEPT {
        let code = if is_given { "ER03" } else { "ER02" };
        let place = format!("against the source at {:.6}, {:.6}", fit.worst[0], fit.worst[1]);
        report.add(code, &name, place, expected(), format!("{:.3} m", fit.max_m));
    }
    if let Some([lon, lat]) = fit.bare {
        let text = format!("{} bare, as at {lon:.6}, {lat:.6}", fit.uncovered);
        report.add("ER04", &name, "", format!("cover of {} samples", fit.samples), text);
    }
}

fn one(
    pyramid: &Pyramid,
    id: TileId,
    declared: &Declared,
    only_some: bool,
    source: Option<&Source>,
) -> Result<Option<Found>, Error> {
    let held = pyramid.tile(id);
    let Some(Ok(tile)) = held.as_deref() else { return Ok(None) };
    let mut found = Found { id, measured_m: 0.0, uncovered: 0.0, fit: Fit::default() };
    if pyramid.has_children(id) {
        let mut leaves = Vec::new();
        finest(pyramid, id, &mut leaves);
        if only_some {
            leaves = sample(&leaves, LEAVES_OF_SOME, u64::from(id.z) << 40 | u64::from(id.x) << 20 | u64::from(id.y));
        }
        (found.measured_m, found.uncovered) = against(pyramid, tile, &leaves);
        if found.measured_m > declared.metres(id.z) {
            found.measured_m = found.measured_m.min(in_space(pyramid, tile, &leaves));
        }
    }
    if let Some(source) = source {
        let surface = tile.surface(|u, v| pyramid.plan(id, [u, v]));
        let index = PlanIndex::new(&surface);
        let ([west, south], [east, north]) = (pyramid.place(id, [0.0; 2]), pyramid.place(id, [GRID; 2]));
        let plan = |[lon, lat, height_m]: [f64; 3]| Some((DVec2::from(pyramid.plan_of([lon, lat])), height_m));
        found.fit = fit(source, [west, south, east, north], &index, 0.0, &plan)?;
    }
    Ok(Some(found))
}

/// Descendants without children.
fn finest(pyramid: &Pyramid, id: TileId, leaves: &mut Vec<TileId>) {
    for child in id.children().into_iter().filter(|child| pyramid.tiles.contains(child)) {
        if pyramid.has_children(child) {
            finest(pyramid, child, leaves);
        } else {
            leaves.push(child);
        }
    }
}

/// Greatest vertical distance of a tile to its descendants, and how much of theirs it does not cover.
fn against(pyramid: &Pyramid, tile: &Tile, leaves: &[TileId]) -> (f64, f64) {
    let coarse = tile.surface(|u, v| [u, v]);
    let index = PlanIndex::new(&coarse);
    let one = |leaf: &TileId| {
        let held = pyramid.tile(*leaf);
        let Some(Ok(fine)) = held.as_deref() else { return (0.0, 0.0) };
        let levels = leaf.z - tile.id.z;
        let scale = f64::from(1u32 << levels);
        let offset = [leaf.x - (tile.id.x << levels), leaf.y - (tile.id.y << levels)].map(|o| f64::from(o) * GRID);
        let surface = fine.surface(|u, v| [(u + offset[0]) / scale, (v + offset[1]) / scale]);
        let d = vertical_difference(&surface, &index);
        let uncovered = (fine.covered / (scale * scale) - d.overlap_m2 / (GRID * GRID)).max(0.0);
        (d.max_m, uncovered)
    };
    let all: Vec<(f64, f64)> = leaves.par_iter().map(one).collect();
    all.into_iter().fold((0.0, 0.0), |(max, sum), (m, u)| (max.max(m), sum + u))
}

/// The same in space, at the descendants' vertices: a cliff that moves a little differs much along the vertical, and little
/// for who looks at it.
fn in_space(pyramid: &Pyramid, tile: &Tile, leaves: &[TileId]) -> f64 {
    let coarse = TriangleMesh::new(pyramid.positions_m(tile.id, &tile.mesh), tile.mesh.triangles.clone());
    let index = SurfaceIndex::new(&coarse);
    let one = |leaf: &TileId| {
        let held = pyramid.tile(*leaf);
        let Some(Ok(fine)) = held.as_deref() else { return 0.0 };
        let positions = pyramid.positions_m(fine.id, &fine.mesh);
        positions.iter().filter_map(|&p| index.closest(p)).map(|c| c.distance_m).fold(0.0, f64::max)
    };
    leaves.par_iter().map(one).reduce(|| 0.0, f64::max)
}
