//! The global pyramid in longitude and latitude: two root tiles of 180 degrees, rows from the south.

use super::placement::Placement as Globe;
use super::{ExportOptions, Fill};
use crate::{Error, Terrain};
use glam::DVec3;
use std::sync::Arc;
use yamanami_core::{Aabb, GeoReference};
use yamanami_io::crs;
use yamanami_multires::tiles::{CutOptions, Placement, Tile};

/// Samples along the side of a tile of the finest zoom, at most.
const TILE_SAMPLES: f64 = 160.0;

/// Deepest zoom that is made without being asked for.
const DEEPEST_ZOOM: u32 = 22;

/// The finest zoom's error, in spacings of the samples, when none is asked for.
const USUAL_TOLERANCE: f64 = 0.25;

/// A radius that no place of the ellipsoid curves more sharply than, less what the geoid bends between vertices and straight
/// lines of a map bend in degrees.
const RADIUS_M: f64 = 5_500_000.0;

/// Degrees in a root tile.
const ROOT_DEG: f64 = 180.0;

/// Places looked at along each side of the terrain for how high the geoid is, and what it may be more between them, metres.
const LOOKS: u32 = 9;
const LIFT_MARGIN_M: f64 = 10.0;

/// Where a terrain lies in the pyramid.
#[derive(Debug)]
pub(super) struct Geodetic {
    pub(super) placement: Placement,
    pub(super) options: CutOptions,
}

impl Geodetic {
    pub(super) fn of(terrain: &Terrain, options: &ExportOptions, notes: &mut Vec<String>) -> Result<Self, Error> {
        let geo = terrain.geo();
        if !crs::is_known(&geo.crs) {
            let name = if geo.crs.name.is_empty() { "none" } else { &geo.crs.name };
            return Err(Error::Request(format!(
                "{}: expected a CRS that leads to longitude and latitude, found {name}; give --crs EPSG",
                terrain.title()
            )));
        }
        let size = terrain.size().map(|n| n as u32);
        let mut placement = place(geo, size)
            .ok_or_else(|| Error::Request(format!("{}: lies outside of what its CRS is for", terrain.title())))?;
        let spacing = placement.spacing();
        let usual_last = (1.0 / (spacing * TILE_SAMPLES)).log2().ceil().clamp(0.0, f64::from(DEEPEST_ZOOM)) as u32;
        let zooms = options.zooms.unwrap_or([0, usual_last]);
        let [dx, dy] = geo.step_m;
        let tolerance_m = options.tolerance_m.unwrap_or(USUAL_TOLERANCE * dx.max(dy));
        let [mut low, mut high] = terrain.range_m().map(f64::from);
        if let Some(globe) = globe(terrain, options, notes)? {
            let source = geo.clone();
            let lift = move |[c, r]: [f64; 2]| {
                let [x, y] = source.source_from_grid(c, r);
                globe.lon_lat_deg(DVec3::new(x, y, 0.0)).map_or(f64::NAN, |at| globe.ellipsoidal_m(at, 0.0))
            };
            let last = size.map(|n| f64::from(n - 1));
            let looks = (0..LOOKS * LOOKS).map(|k| [k % LOOKS, k / LOOKS].map(|i| f64::from(i) / f64::from(LOOKS - 1)));
            let lifts: Vec<f64> = looks.map(|[i, k]| lift([i * last[0], k * last[1]])).collect();
            // between the looks it is no further off
            low += lifts.iter().copied().fold(f64::INFINITY, f64::min) - LIFT_MARGIN_M;
            high += lifts.iter().copied().fold(f64::NEG_INFINITY, f64::max) + LIFT_MARGIN_M;
            placement = placement.lifted(lift);
        }
        let cut = CutOptions {
            zooms,
            tolerance_m,
            globe_radius_m: Some(RADIUS_M),
            height_range_m: [low, high],
            fill_m: match options.fill {
                Fill::At(fill_m) => Some(fill_m),
                Fill::Nothing => None,
            },
        };
        Ok(Self { placement, options: cut })
    }

    /// A tile's column and row: columns go round the globe.
    pub(super) fn wrapped(tile: Tile) -> [u32; 2] {
        [tile.x % (2 << tile.zoom), tile.y]
    }

    /// West, south, east, north of the data, degrees.
    pub(super) fn bounds_deg(&self) -> [f64; 4] {
        let [[west, east], [south, north]] = self.placement.bounds();
        [
            west * ROOT_DEG - 180.0,
            south * ROOT_DEG - 90.0,
            east * ROOT_DEG - 180.0,
            north * ROOT_DEG - 90.0,
        ]
    }
}

/// How heights become those above the ellipsoid, where they are not yet.
fn globe(terrain: &Terrain, options: &ExportOptions, notes: &mut Vec<String>) -> Result<Option<Globe>, Error> {
    let geo = terrain.geo();
    let [columns, rows] = terrain.size().map(|n| (n - 1) as f64);
    let mut bounds = Aabb::EMPTY;
    for [c, r] in [[0.0, 0.0], [columns, rows]] {
        let [x, y] = geo.source_from_grid(c, r);
        bounds.include(DVec3::new(x, y, 0.0));
    }
    let globe = Globe::of(&geo.crs, &bounds, options.heights, &options.geoid, notes)?;
    Ok(globe.filter(Globe::has_geoid))
}

/// Tile space of a longitude and latitude in degrees.
fn to_tiles([lon, lat]: [f64; 2]) -> [f64; 2] {
    [(lon + 180.0) / ROOT_DEG, (lat + 90.0) / ROOT_DEG]
}

fn place(geo: &GeoReference, size: [u32; 2]) -> Option<Placement> {
    let [columns, rows] = size;
    let corner = |c: u32, r: u32| {
        let [x, y] = geo.source_from_grid(f64::from(c), f64::from(r));
        crs::to_lon_lat(&geo.crs, x, y)
    };
    // west of the antimeridian by whole turns, so that no place has a column below 0
    let west = [
        corner(0, 0)?,
        corner(0, rows - 1)?,
        corner(columns - 1, 0)?,
        corner(columns - 1, rows - 1)?,
    ]
    .into_iter()
    .map(|p| p[0])
    .fold(f64::INFINITY, f64::min);
    let turns = 360.0 * ((west + 180.0) / 360.0).floor();
    if geo.crs.geographic || geo.crs.web_mercator {
        let x = (0..columns).map(|c| corner(c, 0).map(|p| to_tiles([p[0] - turns, 0.0])[0])).collect::<Option<_>>()?;
        let y = (0..rows).map(|r| corner(0, r).map(|p| to_tiles([0.0, p[1]])[1])).collect::<Option<_>>()?;
        return Some(Placement::axes(x, y));
    }
    let (forward, back) = (Arc::new(geo.clone()), Arc::new(geo.clone()));
    Some(Placement::warped(
        size,
        move |[c, r]| {
            let [x, y] = forward.source_from_grid(c, r);
            crs::to_lon_lat(&forward.crs, x, y).map_or([f64::NAN; 2], |[lon, lat]| to_tiles([lon - turns, lat]))
        },
        move |[x, y]| {
            let (lon, lat) = (x * ROOT_DEG - 180.0 + turns, y * ROOT_DEG - 90.0);
            crs::from_lon_lat(&back.crs, lon, lat).map_or([f64::NAN; 2], |[x, y]| back.grid_from_source(x, y))
        },
    ))
}

/// Rectangles (first and last column, first and last row) of tiles that come row by row.
pub(super) fn ranges(tiles: &[[u32; 2]]) -> Vec<[u32; 4]> {
    let mut out: Vec<[u32; 4]> = Vec::new();
    for &[x, y] in tiles {
        match out.last_mut() {
            Some([_, last, _, row]) if *row == y && *last + 1 == x => *last = x,
            _ => out.push([x, x, y, y]),
        }
    }
    let mut merged: Vec<[u32; 4]> = Vec::new();
    for run in out {
        let above = merged.iter_mut().rev().find(|m| m[0] == run[0] && m[1] == run[1] && m[3] + 1 == run[2]);
        match above {
            Some(m) => m[3] = run[3],
            None => merged.push(run),
        }
    }
    merged
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_tiles_become_rectangles() {
        let block: Vec<[u32; 2]> = (4..7).flat_map(|y| (2..5).map(move |x| [x, y])).collect();
        assert_eq!(ranges(&block), [[2, 4, 4, 6]]);
        assert_eq!(ranges(&[[0, 0], [1, 0], [3, 0], [0, 1], [1, 1]]), [[0, 1, 0, 1], [3, 3, 0, 0]]);
    }
}
