//! A height field as the TIN of all its cells, read by windows.

use super::{TinFacts, TinTiles};
use crate::Error;
use glam::DVec3;
use std::sync::{Mutex, PoisonError};
use yamanami_core::{GeoReference, HeightSource, Snap, SnapFinder, Tin, TriangleMesh, Window};
use yamanami_io::store::TinAnnex;

/// Cells along the side of a tile.
const TILE_CELLS: usize = 512;

/// The cells of a grid, two triangles each, in tiles.
pub struct GridTiles<S> {
    source: Mutex<S>,
    size: [usize; 2],
    geo: GeoReference,
    tiles: [usize; 2],
    /// Coordinates of the columns and rows that two tiles have, ascending: few, and asked for every vertex.
    columns: Vec<u64>,
    rows: Vec<u64>,
    title: String,
    snap: Snap,
}

impl<S> std::fmt::Debug for GridTiles<S> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("GridTiles").field("size", &self.size).field("tiles", &self.tiles).finish_non_exhaustive()
    }
}

impl<S: HeightSource> GridTiles<S>
where
    Error: From<S::Error>,
{
    /// The tiles of a grid. A projected grid's TIN lies in its CRS, one in degrees in metres from its first sample.
    pub fn new(mut source: S, title: String) -> Result<Self, Error> {
        let (size, geo) = (source.size(), source.geo().clone());
        let tiles = size.map(|n| (n - 1).div_ceil(TILE_CELLS));
        let mut snap = SnapFinder::new(1.0);
        let mut row = vec![0.0; size[0]];
        // rows tell of heights what the lattice must be; columns and rows of the grid are looked at one by one
        for place in [0, size[1] / 3, size[1] / 2, size[1] - 1] {
            source.read_window(Window { column: 0, row: place, width: size[0], height: 1 }, &mut row)?;
            for (column, &z) in row.iter().enumerate().filter(|(_, z)| !z.is_nan()) {
                snap.include(place_of(&geo, column, place, z));
            }
        }
        for place in 0..size[1] {
            snap.include(place_of(&geo, 0, place, 0.0));
        }
        let bits = |column: usize, row: usize| place_of(&geo, column, row, 0.0).to_array().map(f64::to_bits);
        let inner = |axis: usize| (1..tiles[axis]).map(|k| k * TILE_CELLS);
        let mut columns: Vec<u64> = inner(0).map(|column| bits(column, 0)[0]).collect();
        let mut rows: Vec<u64> = inner(1).map(|row| bits(0, row)[1]).collect();
        columns.sort_unstable();
        rows.sort_unstable();
        Ok(Self { source: Mutex::new(source), size, geo, tiles, columns, rows, title, snap: snap.finish() })
    }
}

fn is_projected(geo: &GeoReference) -> bool {
    !geo.crs.geographic && !geo.crs.web_mercator
}

fn place_of(geo: &GeoReference, column: usize, row: usize, z: f32) -> DVec3 {
    let (column, row) = (column as f64, row as f64);
    let [x, y] = if is_projected(geo) { geo.source_from_grid(column, row) } else { geo.local_from_grid(column, row) };
    DVec3::new(x, y, f64::from(z)) + DVec3::ZERO
}

impl<S: HeightSource + Send> TinTiles for GridTiles<S>
where
    Error: From<S::Error>,
{
    fn count(&self) -> usize {
        self.tiles[0] * self.tiles[1]
    }

    fn tile(&self, number: usize) -> Result<Tin, Error> {
        let first = [number % self.tiles[0] * TILE_CELLS, number / self.tiles[0] * TILE_CELLS];
        let [width, height] = [0, 1].map(|axis| TILE_CELLS.min(self.size[axis] - 1 - first[axis]) + 1);
        let mut heights = vec![0.0; width * height];
        let window = Window { column: first[0], row: first[1], width, height };
        self.source.lock().unwrap_or_else(PoisonError::into_inner).read_window(window, &mut heights)?;
        let at = |i: usize, j: usize| heights[j * width + i];
        let place = |(k, &z): (usize, &f32)| {
            place_of(&self.geo, first[0] + k % width, first[1] + k / width, if z.is_nan() { 0.0 } else { z })
        };
        let positions: Vec<DVec3> = heights.iter().enumerate().map(place).collect();
        let mut triangles = Vec::with_capacity(2 * width * height);
        for j in 0..height - 1 {
            for i in 0..width - 1 {
                // rows go south: a b over d c
                let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
                let [a, b, c, d] = corners.map(|(i, j)| (j * width + i) as u32);
                // along the diagonal of the lesser step
                let along_ac = (at(i, j) - at(i + 1, j + 1)).abs() <= (at(i + 1, j) - at(i, j + 1)).abs();
                let halves = if along_ac { [[a, c, b], [a, d, c]] } else { [[a, d, b], [b, d, c]] };
                triangles.extend(halves.iter().filter(|t| t.iter().all(|&v| !heights[v as usize].is_nan())));
            }
        }
        let mesh = TriangleMesh::new(positions, triangles);
        Ok(Tin { crs: self.facts().crs, ..Tin::of_mesh(self.title.clone(), mesh) })
    }

    fn is_shared(&self, place: DVec3) -> bool {
        let [x, y] = [place.x, place.y].map(f64::to_bits);
        self.columns.binary_search(&x).is_ok() || self.rows.binary_search(&y).is_ok()
    }

    fn facts(&self) -> TinFacts {
        let crs = if is_projected(&self.geo) { self.geo.crs.clone() } else { yamanami_core::Crs::default() };
        TinFacts {
            title: self.title.clone(),
            source: self.title.clone(),
            crs,
            unit_m: 1.0,
            snap: self.snap,
            annex: TinAnnex::default(),
        }
    }
}
