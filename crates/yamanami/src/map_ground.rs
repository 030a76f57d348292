//! Heights around a place for a map: any elevation files and databases, laid upon each other in one plane.
//!
//! Based on: the plane is the azimuthal equidistant one ([`AzimuthalPlane`]), so that distances and bearings from the
//! centre are true; grids nest as in Losasso, Hoppe, "Geometry clipmaps", 2004 ([`NestedField`]). Where sources meet, the
//! finer fades into the coarser (feathering, as in mosaics of pictures).
//!
//! A grid's sample has the source's height at its place: bicubic between samples where the source is as coarse as the
//! grid, a spline through them where it is coarser, and thinned evenly, as in the paper on deformed maps, where it is finer. Finer grids lie nearer the
//! centre, as far as a source has detail for them; coarser grids take their samples.

mod border;
mod interpolate;
mod layer;
mod source;
mod spline;
#[cfg(all(test, feature = "files"))]
mod tests;

use crate::Error;
use border::{distance_from, ramp};
use layer::{Layer, PlaneGrid};
use rayon::prelude::*;
pub use source::PageAtHand;
use source::Source;
use std::path::PathBuf;
use yamanami_core::{FieldLevel, NestedField};
use yamanami_io::crs::AzimuthalPlane;
#[cfg(feature = "files")]
use yamanami_io::dem;
use yamanami_io::store::TerrainMeta;

/// A finer grid is laid where a source's samples are nearer than so many of the coarser grid's spacings.
const DETAIL: f64 = 0.75;
/// Samples of the finest source that are blended at the border of a void.
const VOID_SAMPLES: f64 = 4.0;
/// Samples of the coarser source over which a finer one fades out at its border.
const BORDER_SAMPLES: f64 = 3.0;
/// Of a finer source's shorter side at most this part fades at each border.
const BORDER_SHARE: f64 = 0.25;
/// Known heights always weigh something, so that they count alone where there are no others.
const LEAST_WEIGHT: f32 = 1e-3;
/// Samples of a grid.
const MOST_SAMPLES: f64 = (1u64 << 28) as f64;
const MOST_LEVELS: usize = 16;
/// Half the way round the Earth there is no plane around a place.
const MOST_REACH_M: f64 = 5e6;

/// What a sample without data means, within the rectangles of the sources.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum NoData {
    /// It is not known: a hole.
    #[default]
    Hole,
    /// It is the sea, at height 0.
    Sea,
}

/// Which ground to read.
#[derive(Debug, Clone, PartialEq)]
pub struct MapGroundOptions {
    /// Longitude and latitude of the centre, degrees.
    pub centre_lon_lat: [f64; 2],
    /// Metres from the centre to be covered.
    pub radius_m: f64,
    /// Metres between samples of the widest grid.
    pub spacing_m: f64,
    /// Grids are halved to no finer spacing than this, metres; at `spacing_m` or above there is one grid.
    pub finest_spacing_m: f64,
    /// What no-data means.
    pub no_data: NoData,
}

impl MapGroundOptions {
    /// 160 km around a place with 200 m between samples, 50 m near the centre where the data have as much.
    pub fn around(centre_lon_lat: [f64; 2]) -> Self {
        Self { centre_lon_lat, radius_m: 160e3, spacing_m: 200.0, finest_spacing_m: 50.0, no_data: NoData::Hole }
    }
}

/// A source and what came of it.
#[derive(Debug, Clone, PartialEq)]
pub struct MapSource {
    /// The file, or the first of a mosaic.
    pub path: PathBuf,
    /// Files of the mosaic.
    pub files: usize,
    /// Metres between its samples.
    pub spacing_m: f64,
    /// Name of its CRS.
    pub crs: String,
    /// Share of the disc whose heights are its, 0 to 1.
    pub share: f64,
}

/// Ground around a place.
#[derive(Debug, Clone)]
pub struct MapGround {
    /// Heights in the plane.
    pub field: NestedField,
    /// The plane.
    pub plane: AzimuthalPlane,
    /// Share of the disc that has data, 0 to 1.
    pub known_share: f64,
    /// The sources that give heights to the disc, the finest first.
    pub sources: Vec<MapSource>,
}

/// Opened sources of heights.
pub struct MapSources {
    sources: Vec<Source>,
}

impl std::fmt::Debug for MapSources {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.sources.iter().map(Source::label)).finish()
    }
}

impl MapSources {
    /// Opens elevation files, folders and terrain databases, of any resolutions and systems. A finer source stands over a
    /// coarser one; of equal ones the first does.
    #[cfg(feature = "files")]
    pub fn open(paths: &[PathBuf], options: &dem::OpenOptions) -> Result<Self, Error> {
        if paths.is_empty() {
            return Err(Error::Request("a map needs elevation files: none given".to_owned()));
        }
        Ok(Self { sources: Source::open(paths, options)? })
    }

    /// A terrain whose pages are at hand, or not yet: heights of absent pages are taken as unknown.
    pub fn of_pages(meta: &TerrainMeta, page: PageAtHand) -> Self {
        Self { sources: vec![Source::of_pages(meta, page)] }
    }

    /// Reads the ground around a place, and no more of the sources than it takes.
    pub fn read(&mut self, options: &MapGroundOptions) -> Result<MapGround, Error> {
        let plane = self.check(options)?;
        let half = 2 * (options.radius_m / options.spacing_m / 2.0).ceil().max(1.0) as u32;
        let widest = PlaneGrid { spacing_m: options.spacing_m, half };
        let (mut levels, mut shares) = (Vec::new(), vec![0.0; self.sources.len()]);
        let mut grid = widest;
        loop {
            let is_widest = levels.is_empty();
            let radius = is_widest.then_some(options.radius_m / grid.spacing_m);
            let (heights_m, finest_m) = self.lay(&plane, grid, options.no_data, radius, &mut shares)?;
            // a finer grid that shows nothing new is not kept
            if !is_widest && finest_m > DETAIL * 2.0 * grid.spacing_m {
                break;
            }
            levels.push(FieldLevel::new(grid.spacing_m, grid.half, heights_m));
            let has_more = finest_m <= DETAIL * grid.spacing_m;
            grid.spacing_m /= 2.0;
            if !has_more || grid.spacing_m < options.finest_spacing_m * 0.999 || levels.len() == MOST_LEVELS {
                break;
            }
        }
        let field = NestedField::new(levels);
        let known_share = field.known_share(glam::DVec2::ZERO, options.radius_m);
        if known_share == 0.0 {
            return Err(Error::Request(format!("no heights within {:.1} km of the centre", options.radius_m / 1e3)));
        }
        let used = self.sources.iter().zip(shares).filter(|(_, share)| *share > 0.0);
        let sources = used.map(|(source, share)| source.report(share)).collect();
        Ok(MapGround { field, plane, known_share, sources })
    }

    /// What is asked, checked; the plane around the centre.
    fn check(&self, options: &MapGroundOptions) -> Result<AzimuthalPlane, Error> {
        let refuse = |what: String| Err(Error::Request(what));
        let MapGroundOptions { radius_m, spacing_m, finest_spacing_m, .. } = *options;
        if !(radius_m > 0.0 && radius_m <= MOST_REACH_M) {
            return refuse(format!("radius of the map: expected above 0 to 5000 km, got {} km", radius_m / 1e3));
        }
        if !(spacing_m > 0.0 && finest_spacing_m > 0.0) || spacing_m > radius_m {
            return refuse(format!("spacing of the map's grid: expected 0 to the radius, got {spacing_m} m"));
        }
        if (2.0 * radius_m / spacing_m + 5.0).powi(2) > MOST_SAMPLES {
            let (radius_km, most) = (radius_m / 1e3, MOST_SAMPLES.sqrt());
            return refuse(format!(
                "{radius_km} km around at {spacing_m} m are too many samples: at most {most} in a row; take a wider spacing"
            ));
        }
        let [lon, lat] = options.centre_lon_lat;
        let Some(plane) = AzimuthalPlane::new(lon, lat) else {
            return refuse(format!("centre of the map: expected degrees of latitude and longitude, got {lat}, {lon}"));
        };
        if self.sources.iter().any(|source| source.holds(lon, lat)) {
            return Ok(plane);
        }
        let extents: Vec<String> = self.sources.iter().take(3).map(Source::extent_in_words).collect();
        let more =
            if self.sources.len() > 3 { format!("; and {} more", self.sources.len() - 3) } else { String::new() };
        refuse(format!(
            "the centre, latitude {lat}, longitude {lon}, lies outside of the data: {}{more}",
            extents.join("; ")
        ))
    }

    /// Heights of a grid of all sources (NaN where there are none), and the finest spacing of those that meet it, metres.
    /// With a radius, in samples, each source's share of the disc is added up.
    fn lay(
        &mut self,
        plane: &AzimuthalPlane,
        grid: PlaneGrid,
        no_data: NoData,
        radius: Option<f64>,
        shares: &mut [f64],
    ) -> Result<(Vec<f32>, f64), Error> {
        let count = grid.width() * grid.width();
        let mut mixed = Mixed { heights_m: vec![0.0; count], left: vec![1.0; count] };
        let mut inside = vec![false; count];
        let mut finest_m = f64::INFINITY;
        for index in 0..self.sources.len() {
            if mixed.left.par_iter().all(|&left| left == 0.0) {
                break;
            }
            let coarser_m = self.sources.get(index + 1).map(Source::spacing_m);
            let source = &mut self.sources[index];
            let Some(layer) = layer::read(source, plane, grid)? else { continue };
            if layer.heights_m.par_iter().any(|z| !z.is_nan()) {
                finest_m = finest_m.min(source.spacing_m());
            }
            let weights = coarser_m.map(|coarser_m| weights(source, &layer, grid, coarser_m));
            let disc = radius.map(|r| (r * r, f64::from(grid.half)));
            shares[index] += mixed.add(&layer.heights_m, weights.as_deref(), disc, grid.width());
            inside.par_iter_mut().zip(layer.inside).for_each(|(all, this)| *all |= this);
        }
        let sea = no_data == NoData::Sea;
        let heights = mixed.heights_m.par_iter().zip(&mixed.left).zip(&inside).map(|((&z, &left), &inside)| match () {
            () if left < 1.0 => z / (1.0 - left),
            () if sea && inside => 0.0,
            () => f32::NAN,
        });
        Ok((heights.collect(), finest_m))
    }
}

/// Heights of several sources, weighed.
struct Mixed {
    heights_m: Vec<f32>,
    /// Weight that is left to coarser sources.
    left: Vec<f32>,
}

impl Mixed {
    /// Adds a source's heights; its share of the disc (squared radius and centre, in samples).
    fn add(&mut self, heights_m: &[f32], weights: Option<&[f32]>, disc: Option<(f64, f64)>, width: usize) -> f64 {
        let rows = self.heights_m.par_chunks_mut(width).zip(self.left.par_chunks_mut(width)).enumerate();
        let sums = rows.map(|(row, (mixed, left))| {
            let mut sum = [0.0; 2];
            for column in 0..width {
                let k = row * width + column;
                let z = heights_m[k];
                let weight = if z.is_nan() { 0.0 } else { left[column] * weights.map_or(1.0, |w| w[k]) };
                if weight > 0.0 {
                    mixed[column] += weight * z;
                    left[column] -= weight;
                }
                if let Some((squared, centre)) = disc
                    && (column as f64 - centre).powi(2) + (row as f64 - centre).powi(2) <= squared
                {
                    sum = [sum[0] + f64::from(weight), sum[1] + 1.0];
                }
            }
            sum
        });
        // in order, so that the sum is the same on any number of threads
        let sums: Vec<[f64; 2]> = sums.collect();
        let [weight, all] = sums.iter().fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
        if all > 0.0 { weight / all } else { 0.0 }
    }
}

/// How much a source's heights count against coarser ones: less at its border and beside its voids.
fn weights(source: &Source, layer: &Layer, grid: PlaneGrid, coarser_m: f64) -> Vec<f32> {
    let shorter_m = (0..2).map(|k| source.geo.step_m[k] * source.size[k] as f64).fold(f64::INFINITY, f64::min);
    let own_m = source.spacing_m();
    let border_m = (BORDER_SAMPLES * coarser_m).max(VOID_SAMPLES * own_m).min(BORDER_SHARE * shorter_m);
    let to_samples = |m: f64| (m / grid.spacing_m).max(1e-3) as f32;
    let (border, void) = (to_samples(border_m), to_samples(VOID_SAMPLES * own_m));
    let outside: Vec<bool> = layer.inside.par_iter().map(|inside| !inside).collect();
    let unknown: Vec<bool> = layer.heights_m.par_iter().map(|z| z.is_nan()).collect();
    let (to_border, to_void) =
        rayon::join(|| distance_from(&outside, grid.width()), || distance_from(&unknown, grid.width()));
    // the nearest sample outside lies up to one beyond the border
    let weigh =
        |(to_border, to_void): (f32, f32)| ramp(to_border - 1.0, border).min(ramp(to_void, void)).max(LEAST_WEIGHT);
    to_border.into_par_iter().zip(to_void).map(weigh).collect()
}
