//! Heights of a terrain as square tiles of Web Mercator, as web maps have them.
//!
//! A pixel is asked for at its centre; half a pixel's displacement is the classic fault of tilers. The finest zoom shows the
//! surface itself; a pixel of a coarser zoom is the mean of the four below it, so that it has the height of its ground and
//! not that of one sample in it. Idea of the means: L. Williams, "Pyramidal parametrics", 1983.

use crate::{Error, SurfaceHeights};
use glam::DVec2;
use std::ops::RangeInclusive;
use yamanami_io::{IoError, crs, crs::GridWarp};

/// Places along each side of the grid by which its bounds are found.
const BORDER_PLACES: u32 = 64;
/// No zoom is finer.
pub const MOST_ZOOM: u32 = 24;
/// Places of pixels are interpolated to within so many samples.
const PLACE_TOLERANCE: f64 = 1e-3;
/// In tiles made one by one a pixel is the mean of at most so many places along each side.
const MOST_SPREAD: u32 = 4;
/// A zoom is fine enough when its pixels are this many sample spacings wide.
const PIXEL_SAMPLES: f64 = 1.2;

/// A terrain as tiles.
#[derive(Debug)]
pub struct HeightTiles<'a> {
    heights: &'a SurfaceHeights<'a>,
    side_px: u32,
    full_zoom: u32,
    /// West, south, east, north in degrees; east may be beyond 180.
    bounds_deg: [f64; 4],
}

impl<'a> HeightTiles<'a> {
    /// Tiles of `side_px` pixels a side. An error where the CRS is not known by formula.
    pub fn new(heights: &'a SurfaceHeights<'a>, side_px: u32) -> Result<Self, Error> {
        let bounds_deg = bounds_deg(heights).ok_or_else(|| {
            let name = &heights.geo().crs.name;
            let given = if name.is_empty() { "none".to_owned() } else { name.clone() };
            IoError::BadRequest {
                what: "CRS of the terrain".into(),
                expected: "one whose longitudes and latitudes are known; name it with --crs EPSG".into(),
                given,
            }
        })?;
        let [west, south, east, north] = bounds_deg;
        let mut tiles = Self { heights, side_px, full_zoom: 0, bounds_deg };
        let middle = [0.5 * (west + east), 0.5 * (south + north)];
        while tiles.full_zoom < MOST_ZOOM && tiles.samples_per_pixel(tiles.full_zoom, middle) > PIXEL_SAMPLES {
            tiles.full_zoom += 1;
        }
        Ok(tiles)
    }

    /// The zoom whose pixels are about as wide as the samples' spacing.
    pub fn full_zoom(&self) -> u32 {
        self.full_zoom
    }

    /// Pixels along a tile's side.
    pub fn side_px(&self) -> u32 {
        self.side_px
    }

    /// West, south, east and north in degrees; east is beyond 180 where the terrain lies on the date line.
    pub fn bounds_deg(&self) -> [f64; 4] {
        self.bounds_deg
    }

    /// Columns and rows of the tiles of a zoom that the terrain may reach; columns at and beyond 2^zoom are those from 0 on.
    pub fn tiles(&self, zoom: u32) -> [RangeInclusive<u32>; 2] {
        let [west, south, east, north] = self.bounds_deg;
        let count = f64::from(1u32 << zoom);
        let column = |lon: f64| ((lon / 360.0 + 0.5) * count).floor().clamp(0.0, 2.0 * count - 1.0) as u32;
        let row = |lat: f64| (share_south(lat) * count).floor().clamp(0.0, count - 1.0) as u32;
        [column(west)..=column(east).min(column(west) + (1 << zoom) - 1), row(north)..=row(south)]
    }

    /// Heights of a tile's pixels in metres, row by row from the north-west, NaN where there is no ground; `None` where there
    /// is none at all. Of the full zoom and finer ones the surface at the pixels' centres; of coarser ones the mean of places
    /// within each pixel, on a level of the surface that suits them.
    pub fn heights_m(&self, zoom: u32, x: u32, y: u32) -> Result<Option<Vec<f32>>, Error> {
        if zoom > MOST_ZOOM || x >= 1 << zoom || y >= 1 << zoom || !self.reaches(zoom, x, y) {
            return Ok(None);
        }
        let coarser = self.full_zoom.saturating_sub(zoom);
        let spread = (1 << coarser.min(MOST_SPREAD.ilog2())).min(MOST_SPREAD);
        // a level whose points are as near each other as the places asked for
        let level = (coarser - spread.ilog2()).min(self.heights.lattice().levels());
        let side = self.side_px * spread;
        let places = self.places(zoom, x, y, side);
        let mut found = self.heights.at(level, &places)?;
        let mut side = side as usize;
        while side > self.side_px as usize {
            found = halved(&found, side);
            side /= 2;
        }
        Ok(found.iter().any(|z| !z.is_nan()).then_some(found))
    }

    /// Whether a tile may have ground.
    pub fn reaches(&self, zoom: u32, x: u32, y: u32) -> bool {
        let [columns, rows] = self.tiles(zoom);
        rows.contains(&y) && (columns.contains(&x) || columns.contains(&(x + (1 << zoom))))
    }

    /// Columns and rows of the grid at the centres of side × side parts of a tile.
    fn places(&self, zoom: u32, x: u32, y: u32, side: u32) -> Vec<DVec2> {
        let count = f64::from(1u32 << zoom);
        let half = f64::from(side) / 2.0;
        // in parts from the tile's middle, y to the south
        let exact = |p: DVec2| {
            let across = (f64::from(x) + 0.5 + p.x / (2.0 * half)) / count;
            let down = (f64::from(y) + 0.5 + p.y / (2.0 * half)) / count;
            self.heights.grid_from_lon_lat(360.0 * (across - 0.5), latitude(down)).unwrap_or(DVec2::NAN)
        };
        let warp = GridWarp::new(half, PLACE_TOLERANCE, exact);
        let mut places = vec![DVec2::ZERO; (side * side) as usize];
        for (row, places) in places.chunks_exact_mut(side as usize).enumerate() {
            warp.row(row as f64 + 0.5 - half, 0.5 - half, 1.0, places);
        }
        places
    }

    fn samples_per_pixel(&self, zoom: u32, [lon, lat]: [f64; 2]) -> f64 {
        let pixel = 1.0 / (f64::from(1u32 << zoom) * f64::from(self.side_px));
        let at = |dx: f64, dy: f64| {
            self.heights
                .grid_from_lon_lat(lon + 360.0 * dx * 1e-3 * pixel, latitude(share_south(lat) + dy * 1e-3 * pixel))
        };
        let (Some(here), Some(east), Some(south)) = (at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)) else { return 0.0 };
        // the area of a pixel in samples
        (1e6 * (east - here).perp_dot(south - here).abs()).sqrt()
    }
}

/// The mean of each four heights that are there, for half as many a side.
pub fn halved(heights_m: &[f32], side: usize) -> Vec<f32> {
    let half = side / 2;
    let mut out = Vec::with_capacity(half * half);
    for y in 0..half {
        for x in 0..half {
            let (mut sum, mut count) = (0.0, 0u32);
            for at in [2 * y * side + 2 * x, (2 * y + 1) * side + 2 * x] {
                for z in &heights_m[at..at + 2] {
                    if !z.is_nan() {
                        (sum, count) = (sum + f64::from(*z), count + 1);
                    }
                }
            }
            // half a pixel of ground is ground
            out.push(if count >= 2 { (sum / f64::from(count)) as f32 } else { f32::NAN });
        }
    }
    out
}

/// Latitude in degrees at a share of the way from the north to the south border of Web Mercator's square.
fn latitude(share: f64) -> f64 {
    (std::f64::consts::PI * (1.0 - 2.0 * share)).sinh().atan().to_degrees()
}

/// The inverse of [`latitude`].
fn share_south(lat: f64) -> f64 {
    0.5 - lat.to_radians().tan().asinh() / std::f64::consts::TAU
}

/// Bounds of the grid, by places along its border.
fn bounds_deg(heights: &SurfaceHeights<'_>) -> Option<[f64; 4]> {
    let geo = heights.geo();
    let last = [heights.lattice().width() - 1, heights.lattice().height() - 1].map(f64::from);
    let mut bounds = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
    for i in 0..=BORDER_PLACES {
        let share = f64::from(i) / f64::from(BORDER_PLACES);
        let [across, down] = last.map(|n| n * share);
        for (column, row) in [(across, 0.0), (across, last[1]), (0.0, down), (last[0], down)] {
            let [x, y] = geo.source_from_grid(column, row);
            let [lon, lat] = crs::to_lon_lat(&geo.crs, x, y)?;
            let [west, south, east, north] = bounds;
            bounds = [west.min(lon), south.min(lat), east.max(lon), north.max(lat)];
        }
    }
    // a grid is told from where it begins
    let turns = ((bounds[0] + 180.0) / 360.0).floor() * 360.0;
    Some([bounds[0] - turns, bounds[1], bounds[2] - turns, bounds[3]])
}
