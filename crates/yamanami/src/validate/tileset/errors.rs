//! Declared `geometricError` against what is measured: to the finest descendants, and to the source.
//!
//! Terrain is measured vertically over its level plane, exactly on all pieces of both triangulations. What hangs over is
//! measured by the distance of the descendants' vertices and centroids, which samples it.

use super::content::{Content, Contents};
use super::volume::Volume;
use crate::Error;
use crate::validate::fit::{Fit, fit};
use crate::validate::report::{ErrorRow, ValidateReport};
use crate::validate::{MOST_SHIFT_SAMPLES, Source, sample};
use rayon::prelude::*;
use std::collections::BTreeMap;
use yamanami_measure::SurfaceIndex;
use yamanami_measure::tiles::earth::{ecef_m, geodetic};
use yamanami_measure::tin::{PlanIndex, vertical_difference};

/// Descendants that one tile is held against where only some tiles are looked at.
const LEAVES_OF_SOME: usize = 64;

/// A ratio above this breaks the promise; below it is rounding.
const KEPT: f64 = 1.001;

/// Below this, single precision explains a difference, metres.
const ROUNDING_M: f64 = 0.01;

/// Borders may be rounded by so many metres.
const NUDGE_M: f64 = 0.5;

struct Found {
    tile: usize,
    measured_m: f64,
    fit: Fit,
}

pub(super) fn measure(
    contents: &Contents<'_, '_>,
    chosen: &[usize],
    only_some: bool,
    source: Option<&Source>,
    report: &mut ValidateReport,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<(), Error> {
    let tiles = &contents.tree.tiles;
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); tiles.len()];
    for (k, tile) in tiles.iter().enumerate() {
        if let Some(parent) = tile.parent {
            children[parent].push(k);
        }
    }
    let mut rows: BTreeMap<u32, (ErrorRow, Fit)> = BTreeMap::new();
    const AT_ONCE: usize = 64;
    for (k, some) in chosen.chunks(AT_ONCE).enumerate() {
        progress((k * AT_ONCE) as f32 / chosen.len() as f32);
        let all: Result<Vec<Option<Found>>, Error> =
            some.par_iter().map(|&tile| one(contents, &children, tile, only_some, source)).collect();
        for found in all?.into_iter().flatten() {
            let tile = &tiles[found.tile];
            judge(contents, &found, report);
            let (row, fits) = rows.entry(tile.depth).or_default();
            row.level = tile.depth;
            row.tiles += 1;
            row.declared_m = row.declared_m.max(tile.error_m);
            row.measured_m = row.measured_m.max(found.measured_m);
            if tile.error_m > 0.0 {
                row.ratio = row.ratio.max(found.measured_m / tile.error_m);
                row.source_ratio = row.source_ratio.max(found.fit.max_m / tile.error_m);
            }
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
        report.add("ER05", "", format!("level {}", row.level), expected, found);
    }
    report.errors.extend(rows.into_values().map(|(row, _)| row));
    Ok(())
}

fn judge(contents: &Contents<'_, '_>, found: &Found, report: &mut ValidateReport) {
    let tile = &contents.tree.tiles[found.tile];
    let expected = || format!("at most the geometricError of {} m", tile.error_m);
    if found.measured_m > tile.error_m * KEPT + ROUNDING_M {
        report.add(
            "ER01",
            &tile.name,
            "against its finest descendants",
            expected(),
            format!("{:.3} m", found.measured_m),
        );
    }
    let fit = &found.fit;
    if fit.max_m > tile.error_m * KEPT + ROUNDING_M {
        // leaves say 0 where nothing finer is to be had, whatever the source had
        let code = if tile.error_m == 0.0 { "ER06" } else { "ER03" };
        let place = format!("against the source at {:.6}, {:.6}", fit.worst[0], fit.worst[1]);
        report.add(code, &tile.name, place, expected(), format!("{:.3} m", fit.max_m));
    }
    if let Some([lon, lat]) = fit.bare {
        let text = format!("{} bare, as at {lon:.6}, {lat:.6}", fit.uncovered);
        report.add("ER04", &tile.name, "", format!("cover of {} samples", fit.samples), text);
    }
}

fn one(
    contents: &Contents<'_, '_>,
    children: &[Vec<usize>],
    number: usize,
    only_some: bool,
    source: Option<&Source>,
) -> Result<Option<Found>, Error> {
    let tile = &contents.tree.tiles[number];
    let content = contents.mesh(number);
    if tile.is_added || content.mesh.triangles.is_empty() {
        return Ok(None);
    }
    let mut found = Found { tile: number, measured_m: 0.0, fit: Fit::default() };
    let mut leaves = Vec::new();
    finest(contents, children, number, &mut leaves);
    if only_some {
        leaves = sample(&leaves, LEAVES_OF_SOME, number as u64);
    }
    let level = contents.level(&content);
    let surface = level.map(|level| level.surface(&content.mesh));
    let index = surface.as_ref().map(PlanIndex::new);
    found.measured_m = match (&level, &index) {
        (Some(level), Some(index)) => {
            let one = |&leaf: &usize| {
                let fine = level.surface(&contents.mesh(leaf).mesh);
                vertical_difference(&fine, index).max_m
            };
            leaves.par_iter().map(one).reduce(|| 0.0, f64::max)
        }
        _ if leaves.is_empty() => 0.0,
        _ => f64::INFINITY,
    };
    // a cliff that moves a little differs much along the vertical, and little for who looks at it
    if found.measured_m > tile.error_m {
        let index = SurfaceIndex::new(&content.mesh);
        let in_space = leaves.par_iter().map(|&leaf| distance(&contents.mesh(leaf), &index)).reduce(|| 0.0, f64::max);
        found.measured_m = found.measured_m.min(in_space);
    }
    if let (Some(source), Some(level), Some(index), true) = (source, &level, &index, contents.is_on_globe) {
        let (bounds, is_own) = rectangle(tile.volume, &content);
        let plan = |place: [f64; 3]| Some(level.plan(ecef_m(place)));
        found.fit = fit(source, bounds, index, NUDGE_M, &plan)?;
        if !is_own {
            // what lies in a rectangle around a tile of another shape need not be the tile's
            found.fit.samples -= found.fit.uncovered;
            (found.fit.uncovered, found.fit.bare) = (0, None);
        }
    }
    Ok(Some(found))
}

/// West, south, east, north in degrees of a tile, and whether all within is the tile's: then a little less, since the
/// straight edges of triangles do not follow a parallel.
fn rectangle(volume: Option<Volume>, content: &Content) -> ([f64; 4], bool) {
    if let Some(Volume::Region([west, south, east, north, ..])) = volume {
        let [w, s, e, n] = [west, south, east, north].map(f64::to_degrees);
        let bulge = (east - west).powi(2) / 8.0 * south.abs().max(north.abs()).tan().min(100.0);
        let margin = (2.0 * bulge.to_degrees()).max(1e-7);
        if w < e {
            return ([w + margin, s + margin, e - margin, n - margin], true);
        }
    }
    let mut bounds = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
    for &p in &content.mesh.positions {
        let [lon, lat, _] = geodetic(p);
        bounds = [bounds[0].min(lon), bounds[1].min(lat), bounds[2].max(lon), bounds[3].max(lat)];
    }
    (bounds, false)
}

/// Tiles with content below one, with none below them.
fn finest(contents: &Contents<'_, '_>, children: &[Vec<usize>], number: usize, leaves: &mut Vec<usize>) {
    let mut stack = children[number].clone();
    while let Some(k) = stack.pop() {
        if children[k].is_empty() {
            if !contents.tree.tiles[k].contents.is_empty() {
                leaves.push(k);
            }
        } else {
            stack.extend(&children[k]);
        }
    }
    leaves.sort_unstable();
}

/// Greatest distance of a mesh's vertices and centroids to a surface.
fn distance(fine: &Content, index: &SurfaceIndex) -> f64 {
    let mesh = &fine.mesh;
    let centroids = (0..mesh.triangles.len()).map(|t| {
        let [a, b, c] = mesh.corners(t);
        (a + b + c) / 3.0
    });
    let points = mesh.positions.iter().copied().chain(centroids);
    points.filter_map(|p| index.closest(p)).map(|c| c.distance_m).fold(0.0, f64::max)
}
