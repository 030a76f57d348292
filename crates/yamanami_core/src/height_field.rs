//! A regular grid of heights in memory.

use crate::GeoReference;

/// Heights in metres on a regular grid, row by row from the north-west; NaN marks no-data.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightField {
    width: usize,
    height: usize,
    heights_m: Vec<f32>,
    geo: GeoReference,
}

impl HeightField {
    /// Takes `width` × `height` heights. Infinite heights become no-data.
    ///
    /// # Panics
    /// When the number of heights is not `width * height`, or either side is under 2: callers check files at the door.
    pub fn new(width: usize, height: usize, mut heights_m: Vec<f32>, geo: GeoReference) -> Self {
        assert!(width >= 2 && height >= 2, "a height field has at least 2x2 samples, got {width}x{height}");
        assert_eq!(heights_m.len(), width * height, "heights do not fill the grid");
        for z in &mut heights_m {
            if z.is_infinite() {
                *z = f32::NAN;
            }
        }
        Self { width, height, heights_m, geo }
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// All heights in metres, row by row; NaN is no-data.
    pub fn heights_m(&self) -> &[f32] {
        &self.heights_m
    }

    /// Gives the heights back.
    pub fn into_heights_m(self) -> Vec<f32> {
        self.heights_m
    }

    /// Height of a sample in metres, NaN for no-data.
    #[inline]
    pub fn at(&self, column: usize, row: usize) -> f32 {
        self.heights_m[row * self.width + column]
    }

    /// Where the grid lies.
    pub fn geo(&self) -> &GeoReference {
        &self.geo
    }

    /// Lowest and highest height in metres, `None` when all is no-data.
    pub fn range_m(&self) -> Option<[f32; 2]> {
        let mut range = [f32::INFINITY, f32::NEG_INFINITY];
        for &z in &self.heights_m {
            if !z.is_nan() {
                range = [range[0].min(z), range[1].max(z)];
            }
        }
        (range[0] <= range[1]).then_some(range)
    }

    /// Number of samples without data.
    pub fn no_data_count(&self) -> usize {
        self.heights_m.iter().filter(|z| z.is_nan()).count()
    }

    /// Bilinear height at a fractional column and row; `None` outside the grid or next to no-data.
    pub fn sample_bilinear(&self, column: f64, row: f64) -> Option<f64> {
        let (last_column, last_row) = ((self.width - 1) as f64, (self.height - 1) as f64);
        if !(0.0..=last_column).contains(&column) || !(0.0..=last_row).contains(&row) {
            return None;
        }
        let (i, j) = ((column as usize).min(self.width - 2), (row as usize).min(self.height - 2));
        let (u, v) = (column - i as f64, row - j as f64);
        let z = |di: usize, dj: usize| f64::from(self.at(i + di, j + dj));
        let north = z(0, 0) * (1.0 - u) + z(1, 0) * u;
        let south = z(0, 1) * (1.0 - u) + z(1, 1) * u;
        let z = north * (1.0 - v) + south * v;
        (!z.is_nan()).then_some(z)
    }
}
