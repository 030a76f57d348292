//! The samples of the source that tiles are held against, read by strips of rows.

use crate::Error;
use std::path::PathBuf;
use std::sync::Mutex;
use yamanami_core::{GeoReference, HeightSource, Window};
use yamanami_io::crs;
use yamanami_io::dem::{self, DemFile, OpenOptions};

/// Samples read at once.
const STRIP_SAMPLES: usize = 1 << 21;

/// A grid of heights whose samples have a longitude and latitude.
#[derive(Debug)]
pub(super) struct Source {
    dem: Mutex<DemFile>,
    geo: GeoReference,
    size: [usize; 2],
    /// What is added to its heights, metres.
    offset_m: f64,
}

/// Some rows of a source with one sample more on each side, where there is one.
#[derive(Debug)]
pub(super) struct Strip<'s> {
    source: &'s Source,
    window: Window,
    heights_m: Vec<f32>,
    /// Columns and rows that are asked for, ends excluded.
    pub(super) columns: [usize; 2],
    pub(super) rows: [usize; 2],
}

impl Strip<'_> {
    /// Height of a sample in metres; NaN where there is none.
    pub(super) fn height_m(&self, column: usize, row: usize) -> f64 {
        let inside = |v: usize, first: usize, count: usize| v.checked_sub(first).filter(|&k| k < count);
        let place =
            inside(column, self.window.column, self.window.width).zip(inside(row, self.window.row, self.window.height));
        place.map_or(f64::NAN, |(c, r)| f64::from(self.heights_m[r * self.window.width + c]) + self.source.offset_m)
    }

    /// Rise a sample to the right and a sample downwards, metres; NaN at borders.
    pub(super) fn gradient(&self, column: usize, row: usize) -> [f64; 2] {
        let at = |dc: isize, dr: isize| match (column.checked_add_signed(dc), row.checked_add_signed(dr)) {
            (Some(c), Some(r)) => self.height_m(c, r),
            _ => f64::NAN,
        };
        [(at(1, 0) - at(-1, 0)) / 2.0, (at(0, 1) - at(0, -1)) / 2.0]
    }

    /// Longitude and latitude of a sample in degrees.
    pub(super) fn lon_lat(&self, column: usize, row: usize) -> Option<[f64; 2]> {
        let [x, y] = self.source.geo.source_from_grid(column as f64, row as f64);
        crs::to_lon_lat(&self.source.geo.crs, x, y)
    }
}

impl Source {
    /// Opens elevation files as one grid.
    pub(super) fn open(paths: &[PathBuf], options: &OpenOptions, offset_m: f64) -> Result<Self, Error> {
        let dem = dem::open(paths, options)?;
        let (geo, size) = (dem.geo().clone(), dem.size());
        if !crs::is_known(&geo.crs) {
            let name = if geo.crs.name.is_empty() { "none" } else { &geo.crs.name };
            let given = paths.iter().map(|p| p.display().to_string()).collect::<Vec<_>>().join(", ");
            return Err(Error::Request(format!("{given}: expected a CRS of a known place on the globe, found {name}")));
        }
        Ok(Self { dem: Mutex::new(dem), geo, size, offset_m })
    }

    /// Visits all samples that may lie between two corners (west, south, east, north in degrees), strip by strip.
    pub(super) fn visit(
        &self,
        [west, south, east, north]: [f64; 4],
        mut each: impl FnMut(&Strip<'_>),
    ) -> Result<(), Error> {
        const POINTS: usize = 16;
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        let mut is_known = true;
        for k in 0..=POINTS {
            let t = k as f64 / POINTS as f64;
            let (lon, lat) = (west + t * (east - west), south + t * (north - south));
            for [lon, lat] in [[lon, south], [lon, north], [west, lat], [east, lat]] {
                match crs::from_lon_lat(&self.geo.crs, lon, lat) {
                    Some([x, y]) => {
                        let at = self.geo.grid_from_source(x, y);
                        for k in 0..2 {
                            (low[k], high[k]) = (low[k].min(at[k]), high[k].max(at[k]));
                        }
                    }
                    None => is_known = false,
                }
            }
        }
        let mut range = [[0, self.size[0]], [0, self.size[1]]];
        // far from a projection's zone its formulas say little: then all samples are looked at
        let whole = !is_known || (east - west > 20.0 && !self.geo.crs.geographic);
        for (k, range) in range.iter_mut().enumerate().filter(|_| !whole) {
            // a curved border may bulge by more than its points say
            let margin = if self.geo.crs.geographic { 0.0 } else { 2.0 + 0.01 * (high[k] - low[k]) };
            let end = |v: f64| (v.max(0.0) as usize).min(self.size[k]);
            *range = [end((low[k] - margin).ceil()), end((high[k] + margin).floor() + 1.0)];
        }
        let [columns, rows] = range;
        if columns[0] >= columns[1] || rows[0] >= rows[1] {
            return Ok(());
        }
        let at_once = (STRIP_SAMPLES / (columns[1] - columns[0])).max(1);
        for first in (rows[0]..rows[1]).step_by(at_once) {
            let strip = self.strip(columns, [first, (first + at_once).min(rows[1])])?;
            each(&strip);
        }
        Ok(())
    }

    fn strip(&self, columns: [usize; 2], rows: [usize; 2]) -> Result<Strip<'_>, Error> {
        let around = |[a, b]: [usize; 2], most: usize| (a.saturating_sub(1), (b + 1).min(most) - a.saturating_sub(1));
        let ((column, width), (row, height)) = (around(columns, self.size[0]), around(rows, self.size[1]));
        let window = Window { column, row, width, height };
        let mut heights_m = vec![f32::NAN; width * height];
        let mut dem = self.dem.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        dem.read_window(window, &mut heights_m)?;
        Ok(Strip { source: self, window, heights_m, columns, rows })
    }
}
