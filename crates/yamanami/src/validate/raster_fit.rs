//! Raster tiles against the source: each sample against the picture, bilinear between pixels.

use super::fit::Fit;
use super::report::{ErrorRow, ValidateReport};
use super::{MOST_SHIFT_SAMPLES, Source};
use crate::Error;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use yamanami_io::crs;

const HALF_WORLD_M: f64 = PI * 6_378_137.0;

/// Size and heights of a tile.
type Grid = ([usize; 2], Vec<f32>);

/// Fills the rows with what the source says. Samples within half a pixel of a tile's border lie between two tiles and are
/// left out.
pub(super) fn measure(
    chosen: &[[u32; 3]],
    rows: &mut BTreeMap<u32, ErrorRow>,
    source: &Source,
    report: &mut ValidateReport,
    grid: &(dyn Fn([u32; 3]) -> Option<Grid> + Sync),
    progress: &(dyn Fn(f32) + Sync),
) -> Result<(), Error> {
    let Some(mercator) = crs::from_epsg(3857) else { return Ok(()) };
    let mut fits: BTreeMap<u32, Fit> = BTreeMap::new();
    for (k, &[z, x, y]) in chosen.iter().enumerate() {
        progress(k as f32 / chosen.len() as f32);
        let Some((size, heights_m)) = grid([z, x, y]) else { continue };
        let side_m = 2.0 * HALF_WORLD_M / f64::from(1u32 << z);
        let (west_m, north_m) = (f64::from(x) * side_m - HALF_WORLD_M, HALF_WORLD_M - f64::from(y) * side_m);
        let corner = |x: f64, y: f64| crs::to_lon_lat(&mercator, x, y).unwrap_or([f64::NAN; 2]);
        let ([west, north], [east, south]) = (corner(west_m, north_m), corner(west_m + side_m, north_m - side_m));
        let sums = fits.entry(z).or_default();
        let at = |place: [f64; 2]| -> Option<f64> {
            let column = place[0] * size[0] as f64 - 0.5;
            let row = place[1] * size[1] as f64 - 0.5;
            if !(column >= 0.0 && row >= 0.0 && column <= size[0] as f64 - 1.0 && row <= size[1] as f64 - 1.0) {
                return None;
            }
            let (c, r) = ((column as usize).min(size[0] - 2), (row as usize).min(size[1] - 2));
            let (s, t) = (column - c as f64, row - r as f64);
            let value = |dc: usize, dr: usize| f64::from(heights_m[(r + dr) * size[0] + c + dc]);
            let (top, low) = (value(0, 0) * (1.0 - s) + value(1, 0) * s, value(0, 1) * (1.0 - s) + value(1, 1) * s);
            Some(top * (1.0 - t) + low * t)
        };
        source.visit([west, south, east, north], |strip| {
            for row in strip.rows[0]..strip.rows[1] {
                for column in strip.columns[0]..strip.columns[1] {
                    let height_m = strip.height_m(column, row);
                    let Some([lon, lat]) = strip.lon_lat(column, row).filter(|_| height_m.is_finite()) else {
                        continue;
                    };
                    let Some([px, py]) = crs::from_lon_lat(&mercator, lon, lat) else { continue };
                    let Some(found_m) = at([(px - west_m) / side_m, (north_m - py) / side_m]) else { continue };
                    let residual = found_m.is_finite().then_some(found_m - height_m);
                    sums.add([lon, lat], strip.gradient(column, row), residual);
                }
            }
        })?;
    }
    for (z, fit) in &fits {
        let row = rows.entry(*z).or_insert(ErrorRow { level: *z, ..ErrorRow::default() });
        row.samples = [fit.samples, fit.uncovered];
        row.source_m = [fit.max_m, fit.rms_m()];
        row.shift = fit.shift.samples();
    }
    if let Some((z, fit)) = fits.iter().next_back() {
        if let Some([x, y]) = fit.shift.samples().filter(|s| s[0].hypot(s[1]) > MOST_SHIFT_SAMPLES) {
            let found = format!("{x:.3} to the right, {y:.3} downwards");
            let expected = format!("at most {MOST_SHIFT_SAMPLES} samples from the source");
            report.add("ER05", "", format!("zoom {z}"), expected, found);
        }
        if let Some([lon, lat]) = fit.bare {
            let found = format!("{} bare, as at {lon:.6}, {lat:.6}", fit.uncovered);
            report.add("ER04", "", format!("zoom {z}"), format!("heights for {} samples", fit.samples), found);
        }
    }
    Ok(())
}
