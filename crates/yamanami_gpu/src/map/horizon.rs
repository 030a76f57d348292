//! How high the ground before each point stands, as the eye of its azimuth sees it.

use crate::GpuError;
use std::f64::consts::TAU;

/// For azimuths all round and distances from the map's centre, the greatest [`half_tangent`] of all ground up to there.
/// Ground whose own half tangent is less is hidden.
///
/// [`half_tangent`]: yamanami_core::DeformedMap::half_tangent
#[derive(Debug, Clone, PartialEq)]
pub struct HorizonTable {
    azimuth_count: u32,
    distance_count: u32,
    step_m: f64,
    half_tangents: Vec<f32>,
}

impl HorizonTable {
    /// A table of `azimuth_count` rows: row `i` is azimuth `i · 2π / azimuth_count` clockwise from north, entry `j` of a
    /// row is for distance `j · step_m`.
    pub fn new(azimuth_count: u32, step_m: f64, half_tangents: Vec<f32>) -> Result<Self, GpuError> {
        let row = half_tangents.len().checked_div(azimuth_count as usize).unwrap_or(0);
        let distance_count = u32::try_from(row).unwrap_or(0);
        let is_whole = distance_count > 0 && row * azimuth_count as usize == half_tangents.len();
        if !(is_whole && step_m.is_finite() && step_m > 0.0) {
            return Err(GpuError::HorizonTable { azimuth_count, step_m, entries: half_tangents.len() });
        }
        Ok(Self { azimuth_count, distance_count, step_m, half_tangents })
    }

    /// Rows: azimuths all round.
    pub fn azimuth_count(&self) -> u32 {
        self.azimuth_count
    }

    /// Entries of a row: distances from the centre on.
    pub fn distance_count(&self) -> u32 {
        self.distance_count
    }

    /// Metres between the entries of a row.
    pub fn step_m(&self) -> f64 {
        self.step_m
    }

    /// The entries, row by row.
    pub fn half_tangents(&self) -> &[f32] {
        &self.half_tangents
    }

    /// The table between its entries: at an azimuth (radians clockwise from north) and a distance from the centre. Beyond
    /// the last distance it goes on as there.
    pub fn half_tangent(&self, azimuth_rad: f64, distance_m: f64) -> f32 {
        let turns = azimuth_rad / TAU;
        let row = (turns - turns.floor()) * f64::from(self.azimuth_count);
        let column = (distance_m / self.step_m).clamp(0.0, f64::from(self.distance_count - 1));
        let (rows, columns) = (self.azimuth_count as usize, self.distance_count as usize);
        let (first, left) = ((row as usize).min(rows - 1), (column as usize).min(columns.saturating_sub(2)));
        let across = (column - left as f64) as f32;
        let entry = |row: usize| {
            let entries = &self.half_tangents[row * columns..][..columns];
            let (a, b) = (entries[left], entries[(left + 1).min(columns - 1)]);
            a + (b - a) * across
        };
        let (upper, lower) = (entry(first), entry(if first + 1 < rows { first + 1 } else { 0 }));
        upper + (lower - upper) * (row - first as f64) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_goes_all_round_and_outward() {
        let table =
            HorizonTable::new(4, 100.0, vec![0.0, 0.1, 0.3, 0.0, 0.2, 0.2, 0.0, 0.0, 0.4, 0.0, 0.5, 0.6]).unwrap();
        let at = |turn: f64, distance_m| table.half_tangent(turn * TAU, distance_m);
        assert_eq!([at(0.0, 100.0), at(0.25, 150.0), at(0.5, 200.0), at(0.75, 900.0)], [0.1, 0.2, 0.4, 0.6]);
        assert!((at(0.125, 100.0) - 0.15).abs() < 1e-6, "between two azimuths");
        assert!((at(0.875, 100.0) - 0.3).abs() < 1e-6, "between the last and the first");
        assert_eq!(at(-0.25, 200.0), at(1.75, 200.0));
        assert!(at(f64::NAN, f64::NAN).is_nan());
    }

    #[test]
    fn tables_with_ragged_rows_are_refused() {
        for (azimuths, step_m, entries) in [(0, 1.0, 3), (2, 1.0, 3), (3, 0.0, 3), (3, f64::NAN, 3), (3, 1.0, 0)] {
            assert!(HorizonTable::new(azimuths, step_m, vec![0.0; entries]).is_err());
        }
        let error = HorizonTable::new(2, 1.0, vec![0.0; 3]).unwrap_err().to_string();
        assert_eq!(
            error,
            "horizon table: expected rows of equal length and a step above 0 m, got 3 entries for 2 azimuths by 1 m"
        );
    }
}
