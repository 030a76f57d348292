//! How far a coarse mesh draws each sample of the ground from its true place in a deformed map, in pixels.
//!
//! Based on: Hori, Okajima, Miyamura, Furuya, Saito, "LoD control for large-area deformed map" (figure 14: errors of 3.5
//! pixels and more by distance). Where we differ: no typical error but the true one, of every sample: the distance between
//! its picture and the point of its triangle above it, whose picture lies straight between those of the corners, as it is
//! drawn.

use crate::rows::{BAND_ROWS, Chunk, Corner, chunks, double_area, onto_samples, span};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use yamanami_core::{FieldLevel, MapView};

/// Pixels from which the paper splits a triangle.
pub const SPLIT_PX: f64 = 1.5;
/// Pixels from which the paper's figure 14 shows an error.
pub const LARGE_PX: f64 = 3.5;
/// Distance over which errors are put together, metres.
pub const BIN_M: f64 = 5_000.0;
/// How far outside a triangle, in cells, a sample still counts as touching it.
const TOUCH_CELLS: f64 = 1e-8;

/// Errors of many samples.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct PixelErrors {
    /// Samples measured.
    pub samples: usize,
    /// Largest error, pixels.
    pub max_px: f64,
    /// Not exceeded by 99 % of the samples, pixels.
    pub p99_px: f64,
    /// Not exceeded by 99.9 % of the samples, pixels.
    pub p999_px: f64,
    /// Root of the mean square, pixels.
    pub rms_px: f64,
    /// Share over [`SPLIT_PX`], 0 to 1.
    pub over_split: f64,
    /// Share over [`LARGE_PX`], 0 to 1.
    pub over_large: f64,
}

/// Errors at a distance.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DistanceBin {
    /// From here, metres from the centre…
    pub near_m: f64,
    /// … to here.
    pub far_m: f64,
    /// Samples measured.
    pub samples: usize,
    /// Largest error, pixels.
    pub max_px: f64,
    /// Root of the mean square, pixels.
    pub rms_px: f64,
    /// Samples of [`LARGE_PX`] and more.
    pub large: usize,
}

/// What a mesh does to the picture of the ground.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct ProjectedReport {
    /// Samples beyond the ring, to the rim: where height shows.
    pub far: PixelErrors,
    /// All samples to the rim.
    pub all: PixelErrors,
    /// All samples, in bins of [`BIN_M`].
    pub bins: Vec<DistanceBin>,
    /// Distance (metres) and error (pixels) of each sample of [`LARGE_PX`] and more, row by row.
    pub large: Vec<[f64; 2]>,
    /// Column and row of the sample with the largest error; the first in row order among equals.
    pub worst: Option<[usize; 2]>,
    /// Samples to the rim that no triangle covers.
    pub uncovered: usize,
    /// Root of the mean squared vertical distance of all samples, metres.
    pub height_rms_m: f64,
    /// Mean of how much the mesh lies above the ground, metres: the bias.
    pub height_bias_m: f64,
}

/// Measures all samples with data of a grid within the rim against a mesh in the same plane. A sample that several
/// triangles touch counts with the farthest. Triangles without area in plan, and those with a corner that is not finite,
/// measure nothing, and neither do triangles that name a vertex that is not there.
pub fn projected_error(
    view: &MapView,
    grid: &FieldLevel,
    positions: &[DVec3],
    triangles: &[[u32; 3]],
) -> ProjectedReport {
    let width = grid.width();
    let onto = onto_samples(width);
    let vertices: Vec<(Corner, DVec2)> = positions
        .par_iter()
        .map(|&p| {
            let at = grid.grid_from_plane(p.truncate());
            ([onto(at.x), onto(at.y), p.z], view.map.image_from_plane(p))
        })
        .collect();
    let corners: Vec<Corner> = vertices.iter().map(|v| v.0).collect();
    let named: Vec<[u32; 3]>;
    let exists = |t: &[u32; 3]| t.iter().all(|&v| (v as usize) < positions.len());
    let triangles = if triangles.par_iter().all(exists) {
        triangles
    } else {
        named = triangles.iter().copied().filter(exists).collect();
        &named
    };
    let chunks = chunks(triangles, &corners, width);
    let bands: Vec<Found> = (0..width.div_ceil(BAND_ROWS))
        .into_par_iter()
        .map_init(Vec::new, |samples, band| {
            let mut target = Band::new(view, grid, band * BAND_ROWS, samples);
            for t in Chunk::band_of(&chunks, band) {
                target.scan(t.map(|v| vertices[v as usize]));
            }
            target.found(view)
        })
        .collect();
    report(view, bands)
}

/// A sample while triangles are laid over it.
#[derive(Debug, Clone, Copy)]
struct Sample {
    /// Its picture, radii of the plain map; NaN where it does not count.
    picture: DVec2,
    /// Squared distance of what is drawn from it; below 0 while no triangle covers it.
    off: f64,
    /// How much higher it is drawn, metres.
    above_m: f32,
}

/// Some rows of the grid.
struct Band<'a> {
    grid: &'a FieldLevel,
    first_row: usize,
    rows: usize,
    samples: &'a mut Vec<Sample>,
}

impl<'a> Band<'a> {
    fn new(view: &MapView, grid: &'a FieldLevel, first_row: usize, samples: &'a mut Vec<Sample>) -> Self {
        let width = grid.width();
        let rows = BAND_ROWS.min(width - first_row);
        samples.clear();
        let rim = view.rim_m * view.rim_m;
        for k in first_row * width..(first_row + rows) * width {
            let p = grid.plane_from_grid(k % width, k / width);
            let counts = grid.known()[k] && (p - view.map.centre).length_squared() <= rim;
            let z = f64::from(grid.heights_m()[k]);
            let picture = if counts { view.map.image_from_plane(p.extend(z)) } else { DVec2::NAN };
            samples.push(Sample { picture, off: -1.0, above_m: 0.0 });
        }
        Self { grid, first_row, rows, samples }
    }

    /// Lays a triangle, given in the grid and in the picture, over the samples it covers.
    fn scan(&mut self, vertices: [(Corner, DVec2); 3]) {
        let [a, b, c] = vertices.map(|v| v.0);
        // picture and height in one: both are linear over the triangle
        let [at_a, at_b, at_c] = vertices.map(|(corner, picture)| picture.extend(corner[2]));
        let area = double_area([a, b, c]);
        let along_column = ((at_b - at_a) * (c[1] - a[1]) - (at_c - at_a) * (b[1] - a[1])) / area;
        let along_row = ((at_c - at_a) * (b[0] - a[0]) - (at_b - at_a) * (c[0] - a[0])) / area;
        let width = self.grid.width();
        let [north, south] = [a[1].min(b[1]).min(c[1]), a[1].max(b[1]).max(c[1])];
        let first = (north - TOUCH_CELLS).ceil().max(self.first_row as f64);
        let last = (south + TOUCH_CELLS).floor().min((self.first_row + self.rows) as f64 - 1.0);
        if first > last {
            return;
        }
        for row in first as usize..=last as usize {
            let [west, east] = span([a, b, c], (row as f64).clamp(north, south));
            let from = (west - TOUCH_CELLS).ceil().max(0.0);
            let to = (east + TOUCH_CELLS).floor().min((width - 1) as f64);
            if from > to {
                continue;
            }
            let start = (row - self.first_row) * width;
            let mut drawn = at_a + along_row * (row as f64 - a[1]) + along_column * (from - a[0]);
            let heights = &self.grid.heights_m()[row * width..];
            for column in from as usize..=to as usize {
                let sample = &mut self.samples[start + column];
                let off = (drawn.truncate() - sample.picture).length_squared();
                // never true where the sample does not count
                if off > sample.off {
                    sample.off = off;
                    sample.above_m = (drawn.z - f64::from(heights[column])) as f32;
                }
                drawn += along_column;
            }
        }
    }

    fn found(&self, view: &MapView) -> Found {
        let mut found = Found::default();
        let width = self.grid.width();
        for (k, sample) in self.samples.iter().enumerate().filter(|(_, s)| !s.picture.is_nan()) {
            if sample.off < 0.0 {
                found.uncovered += 1;
                continue;
            }
            let [column, row] = [k % width, self.first_row + k / width];
            let r_m = (self.grid.plane_from_grid(column, row) - view.map.centre).length();
            let error_px = view.ring_px * sample.off.sqrt();
            if found.worst.is_none_or(|(most, _)| error_px > most) {
                found.worst = Some((error_px, [column, row]));
            }
            found.height_sum_m += f64::from(sample.above_m);
            found.height_squares += f64::from(sample.above_m).powi(2);
            let bin = (r_m / BIN_M) as usize;
            if found.bins.len() <= bin {
                found.bins.resize(bin + 1, DistanceBin::default());
            }
            let bin = &mut found.bins[bin];
            bin.samples += 1;
            bin.max_px = bin.max_px.max(error_px);
            // the sum of squares, until the report
            bin.rms_px += error_px * error_px;
            if error_px >= LARGE_PX {
                bin.large += 1;
                found.large.push([r_m, error_px]);
            }
            let errors = if r_m > view.map.ring_m { &mut found.far } else { &mut found.near };
            errors.push(error_px as f32);
        }
        found
    }
}

/// What a band adds to the report.
#[derive(Default)]
struct Found {
    far: Vec<f32>,
    near: Vec<f32>,
    bins: Vec<DistanceBin>,
    large: Vec<[f64; 2]>,
    worst: Option<(f64, [usize; 2])>,
    uncovered: usize,
    height_sum_m: f64,
    height_squares: f64,
}

/// Puts the bands together, in their order.
fn report(view: &MapView, bands: Vec<Found>) -> ProjectedReport {
    let count = (view.rim_m / BIN_M).ceil().clamp(0.0, 1e6) as usize;
    let mut report = ProjectedReport {
        bins: (0..count)
            .map(|i| DistanceBin {
                near_m: BIN_M * i as f64,
                far_m: (BIN_M * (i + 1) as f64).min(view.rim_m),
                ..DistanceBin::default()
            })
            .collect(),
        ..ProjectedReport::default()
    };
    let (mut far, mut near) = (Vec::new(), Vec::new());
    let (mut most_px, mut sum_m, mut squares) = (-1.0, 0.0, 0.0);
    for band in bands {
        far.extend_from_slice(&band.far);
        near.extend_from_slice(&band.near);
        report.large.extend_from_slice(&band.large);
        report.uncovered += band.uncovered;
        if let Some((error_px, at)) = band.worst.filter(|&(error_px, _)| error_px > most_px) {
            (most_px, report.worst) = (error_px, Some(at));
        }
        sum_m += band.height_sum_m;
        squares += band.height_squares;
        for (nth, bin) in band.bins.iter().enumerate() {
            // samples on the rim itself fall into the last
            let Some(all) = report.bins.get_mut(nth.min(count.saturating_sub(1))) else { continue };
            all.samples += bin.samples;
            all.max_px = all.max_px.max(bin.max_px);
            all.rms_px += bin.rms_px;
            all.large += bin.large;
        }
    }
    for bin in &mut report.bins {
        bin.rms_px = (bin.rms_px / bin.samples.max(1) as f64).sqrt();
    }
    let samples = (far.len() + near.len()).max(1) as f64;
    report.height_bias_m = sum_m / samples;
    report.height_rms_m = (squares / samples).sqrt();
    report.far = PixelErrors::of(&mut far);
    far.append(&mut near);
    report.all = PixelErrors::of(&mut far);
    report
}

impl PixelErrors {
    fn of(errors_px: &mut [f32]) -> Self {
        if errors_px.is_empty() {
            return Self::default();
        }
        let count = errors_px.len() as f64;
        let squares: f64 = errors_px.iter().map(|&e| f64::from(e) * f64::from(e)).sum();
        let over = |limit_px: f64| errors_px.iter().filter(|&&e| f64::from(e) > limit_px).count() as f64 / count;
        let (over_split, over_large) = (over(SPLIT_PX), over(LARGE_PX));
        let max_px = errors_px.iter().fold(0.0, |most: f32, &e| most.max(e));
        let mut quantile = |share: f64| {
            let nth = ((share * count).ceil() as usize).clamp(1, errors_px.len()) - 1;
            f64::from(*errors_px.select_nth_unstable_by(nth, f32::total_cmp).1)
        };
        Self {
            samples: count as usize,
            p99_px: quantile(0.99),
            p999_px: quantile(0.999),
            max_px: f64::from(max_px),
            rms_px: (squares / count).sqrt(),
            over_split,
            over_large,
        }
    }
}

#[cfg(test)]
mod tests;
