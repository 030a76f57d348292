//! Heights around a place, the finer the nearer: square grids with one centre, each of half the spacing of the last.
//!
//! Based on: Losasso, Hoppe, "Geometry clipmaps", 2004 (nested grids around the viewer). Where we differ: a coarse grid
//! has the heights of the finer one wherever both have a sample, so that one place has one height.

use glam::DVec2;

/// Nested square grids around (0, 0) of the plane, x east, y north, metres.
#[derive(Debug, Clone, PartialEq)]
pub struct NestedField {
    levels: Vec<FieldLevel>,
}

/// One grid: (2·half + 1)² samples, row by row from the north-west.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldLevel {
    spacing_m: f64,
    half: u32,
    heights_m: Vec<f32>,
    known: Vec<bool>,
}

impl FieldLevel {
    /// A grid of `(2·half + 1)²` heights in metres; NaN is no-data and counts as sea level.
    ///
    /// # Panics
    /// When the number of heights is another, `half` is odd or 0, or the spacing is not above 0.
    pub fn new(spacing_m: f64, half: u32, mut heights_m: Vec<f32>) -> Self {
        assert!(half >= 2 && half.is_multiple_of(2), "half a grid is an even number of samples, got {half}");
        assert!(spacing_m.is_finite() && spacing_m > 0.0, "spacing above 0 m, got {spacing_m}");
        assert_eq!(heights_m.len(), ((2 * half + 1) as usize).pow(2), "heights do not fill the grid");
        let known = heights_m.iter().map(|z| z.is_finite()).collect();
        for z in &mut heights_m {
            if !z.is_finite() {
                *z = 0.0;
            }
        }
        Self { spacing_m, half, heights_m, known }
    }

    /// Metres between samples.
    pub fn spacing_m(&self) -> f64 {
        self.spacing_m
    }

    /// Samples from the centre to a side.
    pub fn half(&self) -> u32 {
        self.half
    }

    /// Samples in a row.
    pub fn width(&self) -> usize {
        2 * self.half as usize + 1
    }

    /// Metres from the centre to a side.
    pub fn reach_m(&self) -> f64 {
        self.spacing_m * f64::from(self.half)
    }

    /// Heights in metres, row by row from the north-west; 0 where there is no data.
    pub fn heights_m(&self) -> &[f32] {
        &self.heights_m
    }

    /// Which samples have data.
    pub fn known(&self) -> &[bool] {
        &self.known
    }

    /// Fractional column and row of a place of the plane.
    #[inline]
    pub fn grid_from_plane(&self, p: DVec2) -> DVec2 {
        let half = f64::from(self.half);
        DVec2::new(half + p.x / self.spacing_m, half - p.y / self.spacing_m)
    }

    /// Place of a sample in the plane.
    #[inline]
    pub fn plane_from_grid(&self, column: usize, row: usize) -> DVec2 {
        let half = f64::from(self.half);
        self.spacing_m * DVec2::new(column as f64 - half, half - row as f64)
    }

    /// Whether a place lies on the grid.
    #[inline]
    pub fn holds(&self, p: DVec2) -> bool {
        p.abs().max_element() <= self.reach_m()
    }

    /// Bilinear height in metres at a place on the grid (moved onto it if outside).
    #[inline]
    pub fn height_m(&self, p: DVec2) -> f64 {
        let last = (self.width() - 1) as f64;
        let at = self.grid_from_plane(p).clamp(DVec2::ZERO, DVec2::splat(last));
        let (i, j) = ((at.x as usize).min(self.width() - 2), (at.y as usize).min(self.width() - 2));
        let (u, v) = (at.x - i as f64, at.y - j as f64);
        let first = j * self.width() + i;
        let z = |k: usize| f64::from(self.heights_m[k]);
        let north = z(first) * (1.0 - u) + z(first + 1) * u;
        let south = z(first + self.width()) * (1.0 - u) + z(first + self.width() + 1) * u;
        north * (1.0 - v) + south * v
    }

    /// Whether the sample nearest to a place has data; false off the grid.
    #[inline]
    pub fn is_known(&self, p: DVec2) -> bool {
        let at = self.grid_from_plane(p).round();
        let last = (self.width() - 1) as f64;
        at.min_element() >= 0.0 && at.max_element() <= last && self.known[at.y as usize * self.width() + at.x as usize]
    }
}

impl NestedField {
    /// Nests grids, the coarsest first. Each has half the spacing of the last and reaches no further; coarse samples
    /// take the height of the finer sample at their place.
    ///
    /// # Panics
    /// When there is no grid, or one does not fit in the last.
    pub fn new(mut levels: Vec<FieldLevel>) -> Self {
        assert!(!levels.is_empty(), "a nested field has at least one grid");
        for i in (1..levels.len()).rev() {
            let (coarser, finer) = levels.split_at_mut(i);
            let (coarse, fine) = (&mut coarser[i - 1], &finer[0]);
            assert!((2.0 * fine.spacing_m / coarse.spacing_m - 1.0).abs() < 1e-12, "each grid halves the spacing");
            assert!(fine.half / 2 <= coarse.half, "a finer grid reaches no further than the coarser");
            let reach = (fine.half / 2) as usize;
            let first = coarse.half as usize - reach;
            for row in 0..=2 * reach {
                for column in 0..=2 * reach {
                    let from = 2 * row * fine.width() + 2 * column;
                    let to = (first + row) * coarse.width() + first + column;
                    (coarse.heights_m[to], coarse.known[to]) = (fine.heights_m[from], fine.known[from]);
                }
            }
        }
        Self { levels }
    }

    /// The grids, the coarsest (and widest) first.
    pub fn levels(&self) -> &[FieldLevel] {
        &self.levels
    }

    /// The widest grid.
    pub fn widest(&self) -> &FieldLevel {
        &self.levels[0]
    }

    /// The finest grid that holds a place; the widest where none does.
    #[inline]
    pub fn level_at(&self, p: DVec2) -> &FieldLevel {
        self.levels.iter().rev().find(|level| level.holds(p)).unwrap_or(&self.levels[0])
    }

    /// Bilinear height in metres in the finest grid that holds a place; at the border of the widest beyond it.
    #[inline]
    pub fn height_m(&self, p: DVec2) -> f64 {
        self.level_at(p).height_m(p)
    }

    /// Whether there are data at a place.
    pub fn is_known(&self, p: DVec2) -> bool {
        self.level_at(p).is_known(p)
    }

    /// Lowest and highest height, metres.
    pub fn range_m(&self) -> [f32; 2] {
        let mut range = [f32::INFINITY, f32::NEG_INFINITY];
        for level in &self.levels {
            for &z in &level.heights_m {
                range = [range[0].min(z), range[1].max(z)];
            }
        }
        range
    }

    /// Share of the disc of this radius around a place that has data, 0 to 1.
    pub fn known_share(&self, centre: DVec2, radius_m: f64) -> f64 {
        let grid = self.widest();
        let (mut known, mut all) = (0u64, 0u64);
        for row in 0..grid.width() {
            for column in 0..grid.width() {
                if (grid.plane_from_grid(column, row) - centre).length() <= radius_m {
                    all += 1;
                    known += u64::from(grid.known[row * grid.width() + column]);
                }
            }
        }
        if all == 0 { 0.0 } else { known as f64 / all as f64 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn level(spacing_m: f64, half: u32, height: impl Fn(DVec2) -> f64) -> FieldLevel {
        let empty = FieldLevel::new(spacing_m, half, vec![0.0; ((2 * half + 1) as usize).pow(2)]);
        let width = empty.width();
        let heights = (0..width * width).map(|k| height(empty.plane_from_grid(k % width, k / width)) as f32).collect();
        FieldLevel::new(spacing_m, half, heights)
    }

    #[test]
    fn one_place_has_one_height() {
        let plane = |p: DVec2| 100.0 + 0.5 * p.x - 0.25 * p.y;
        let bumpy = |p: DVec2| plane(p) + if p.length() < 45.0 { 7.0 } else { 0.0 };
        let field = NestedField::new(vec![level(20.0, 8, plane), level(10.0, 8, bumpy)]);
        for p in [DVec2::ZERO, DVec2::new(20.0, -20.0), DVec2::new(160.0, 160.0), DVec2::new(3.0, 71.0)] {
            assert!((field.height_m(p) - bumpy(p)).abs() < 1e-4, "{p}");
        }
        assert_eq!(field.widest().height_m(DVec2::new(20.0, 20.0)), bumpy(DVec2::new(20.0, 20.0)));
        assert_eq!(field.known_share(DVec2::ZERO, 150.0), 1.0);
    }

    #[test]
    fn no_data_is_sea_level_and_known_as_such() {
        let west = |p: DVec2| if p.x < 0.0 { 5.0 } else { f64::NAN };
        let field = NestedField::new(vec![level(10.0, 4, west)]);
        assert!(field.is_known(DVec2::new(-20.0, 0.0)) && !field.is_known(DVec2::new(20.0, 0.0)));
        assert!(!field.is_known(DVec2::new(-70.0, 0.0)), "off the grid");
        assert_eq!(field.range_m(), [0.0, 5.0]);
        let share = field.known_share(DVec2::ZERO, 40.0);
        assert!(share > 0.35 && share < 0.5, "{share}");
    }
}
