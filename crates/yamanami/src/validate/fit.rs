//! How well a surface fits the samples of the source, whatever the frame that it lies in.

use super::Source;
use crate::Error;
use glam::DVec2;
use rayon::prelude::*;
use yamanami_measure::tiles::Shift;
use yamanami_measure::tin::{PlanIndex, footing};

/// Sums over samples.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Fit {
    /// Samples with a height, and those of them without a triangle.
    pub(super) samples: u64,
    pub(super) uncovered: u64,
    pub(super) max_m: f64,
    /// Longitude and latitude of the greatest distance.
    pub(super) worst: [f64; 2],
    /// One of those uncovered.
    pub(super) bare: Option<[f64; 2]>,
    pub(super) squares: f64,
    pub(super) shift: Shift,
}

impl Fit {
    pub(super) fn add(&mut self, lon_lat: [f64; 2], gradient: [f64; 2], residual_m: Option<f64>) {
        self.samples += 1;
        let Some(residual_m) = residual_m else {
            self.uncovered += 1;
            self.bare = self.bare.or(Some(lon_lat));
            return;
        };
        self.squares += residual_m * residual_m;
        if residual_m.abs() > self.max_m {
            (self.max_m, self.worst) = (residual_m.abs(), lon_lat);
        }
        self.shift.add(gradient, residual_m);
    }

    pub(super) fn merge(mut self, other: Self) -> Self {
        self.samples += other.samples;
        self.uncovered += other.uncovered;
        self.squares += other.squares;
        self.bare = self.bare.or(other.bare);
        if other.max_m > self.max_m {
            (self.max_m, self.worst) = (other.max_m, other.worst);
        }
        self.shift.merge(&other.shift);
        self
    }

    pub(super) fn rms_m(&self) -> f64 {
        (self.squares / (self.samples - self.uncovered).max(1) as f64).sqrt()
    }
}

/// Holds a surface against all samples of the source in a rectangle (west, south, east, north in degrees). `plan` gives the
/// place of a longitude, latitude and height in the surface's frame, and what is its height there; `None` where the sample
/// is none of this tile's. A sample is covered where a triangle lies no further than `nudge` towards the middle: borders
/// that are rounded leave no hole.
pub(super) fn fit(
    source: &Source,
    bounds: [f64; 4],
    index: &PlanIndex<'_>,
    nudge: f64,
    plan: &(dyn Fn([f64; 3]) -> Option<(DVec2, f64)> + Sync),
) -> Result<Fit, Error> {
    let mut all = Fit::default();
    let middle = index.mesh().bounds().centre().truncate();
    source.visit(bounds, |strip| {
        let rows: Vec<Fit> = (strip.rows[0]..strip.rows[1])
            .into_par_iter()
            .map(|row| {
                let mut sums = Fit::default();
                for column in strip.columns[0]..strip.columns[1] {
                    let height_m = strip.height_m(column, row);
                    let Some(lon_lat) = strip.lon_lat(column, row).filter(|_| height_m.is_finite()) else { continue };
                    let [lon, lat] = lon_lat;
                    let inside = bounds[0] <= lon && lon <= bounds[2] && bounds[1] <= lat && lat <= bounds[3];
                    let Some((place, expected_m)) = plan([lon, lat, height_m]).filter(|_| inside) else { continue };
                    let residual_m = footing(index, place)
                        .or_else(|| footing(index, place + (middle - place).normalize_or_zero() * nudge))
                        .map(|at| at.height_m - expected_m);
                    sums.add(lon_lat, strip.gradient(column, row), residual_m);
                }
                sums
            })
            .collect();
        all = rows.into_iter().fold(all, Fit::merge);
    })?;
    Ok(all)
}
