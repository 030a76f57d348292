//! What a surface database says of itself.

use super::quantum::Quantum;
use yamanami_core::{GeoReference, Lattice};

/// The facts of a terrain surface that are not in its pages.
#[derive(Debug, Clone, PartialEq)]
pub struct TerrainMeta {
    /// Where the grid lies.
    pub geo: GeoReference,
    /// Columns and rows of the grid.
    pub size: [u32; 2],
    /// Lowest and highest height in metres.
    pub height_range_m: [f32; 2],
    /// By level: radius in metres of spheres around a level's nodes that hold all their descendants.
    pub bound_radius_m: Vec<f64>,
    /// Whether any triangle is hidden.
    pub has_holes: bool,
    /// Largest difference between a source height and the stored one; 0 when lossless.
    pub max_error_m: f64,
    /// Which heights the file holds.
    pub quantum: Quantum,
    /// How many steps an octave error codes above level 0 are rounded up to: a power of two up to 2048 (exact).
    pub error_steps_per_octave: u32,
    /// What the builder adds to a level-0 detail to get its error.
    pub level0_slack_m: f32,
    /// A name for people.
    pub title: String,
    /// Where the heights come from: files, licence.
    pub source: String,
}

impl TerrainMeta {
    /// Steps an octave that suit most files: codes are at most 50 % too large, 20 % on average.
    pub const USUAL_ERROR_STEPS: u32 = 2;

    /// Checks that the facts can be true; says which cannot. What concerns the pages is checked by their codec.
    pub(crate) fn check(&self) -> Result<(), String> {
        let [columns, rows] = self.size;
        if columns < 2 || rows < 2 || columns > 1 << 30 || rows > 1 << 30 {
            return Err(format!("a size of {columns}x{rows} samples"));
        }
        let geo = &self.geo;
        if geo.origin.iter().chain(&geo.step).chain(&geo.step_m).any(|v| !v.is_finite())
            || geo.step.contains(&0.0)
            || geo.step_m.iter().any(|&m| m <= 0.0)
        {
            return Err(format!("a spacing of {:?} ({:?} m) at {:?}", geo.step, geo.step_m, geo.origin));
        }
        let [low, high] = self.height_range_m;
        if !(low <= high && low.is_finite() && high.is_finite()) {
            return Err(format!("heights from {low} to {high} m"));
        }
        let levels = Lattice::new(columns as usize, rows as usize).levels() as usize;
        if self.bound_radius_m.len() != levels {
            return Err(format!("{} bound radii for {levels} levels", self.bound_radius_m.len()));
        }
        if let Some(radius_m) = self.bound_radius_m.iter().find(|r| !(r.is_finite() && **r >= 0.0)) {
            return Err(format!("a bound radius of {radius_m} m"));
        }
        if !(self.max_error_m.is_finite() && self.max_error_m >= 0.0) {
            return Err(format!("a maximum error of {} m", self.max_error_m));
        }
        Ok(())
    }
}
