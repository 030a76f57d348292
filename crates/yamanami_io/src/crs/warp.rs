//! Where the places of a plane grid lie in something else (degrees, another grid), for millions of places.
//!
//! Based on: R. Keys, "Cubic convolution interpolation", 1981 (cubics through four samples); the idea of an approximate
//! transformer is that of GDAL (F. Warmerdam). Where we differ: the grid is made finer until the middles of its cells are
//! as exact as asked, and a cell that will not be, at a pole or a cut, is computed place by place.

use glam::DVec2;

/// Cells along a side to begin with, and at most.
const FIRST_CELLS: usize = 16;
const MOST_CELLS: usize = 256;

/// A smooth mapping of a square around (0, 0), interpolated between exact values.
pub struct GridWarp<F> {
    exact: F,
    reach_m: f64,
    cells: usize,
    /// Exact values at the corners, one ring of cells around the square included.
    corners: Vec<DVec2>,
    /// Cells to be computed place by place.
    rough: Vec<bool>,
}

impl<F> std::fmt::Debug for GridWarp<F> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("GridWarp").field("reach_m", &self.reach_m).field("cells", &self.cells).finish_non_exhaustive()
    }
}

impl<F: Fn(DVec2) -> DVec2> GridWarp<F> {
    /// Prepares `exact`, which maps places (metres) of the square within `reach_m` of (0, 0), to be interpolated to within
    /// `tolerance` of what it gives. Where it gives what is not finite, so does the warp.
    pub fn new(reach_m: f64, tolerance: f64, exact: F) -> Self {
        let mut warp = Self { exact, reach_m, cells: FIRST_CELLS, corners: Vec::new(), rough: Vec::new() };
        loop {
            warp.fill();
            warp.rough = warp.cells_beyond(tolerance);
            if warp.cells >= MOST_CELLS || warp.rough.iter().all(|rough| !rough) {
                return warp;
            }
            warp.cells *= 2;
        }
    }

    fn cell_m(&self) -> f64 {
        2.0 * self.reach_m / self.cells as f64
    }

    fn stride(&self) -> usize {
        self.cells + 3
    }

    fn fill(&mut self) {
        let (cell_m, side) = (self.cell_m(), self.stride());
        let at = |k: usize| (k as f64 - 1.0) * cell_m - self.reach_m;
        self.corners = (0..side * side).map(|k| (self.exact)(DVec2::new(at(k % side), at(k / side)))).collect();
    }

    /// Which cells are off in their middle.
    fn cells_beyond(&self, tolerance: f64) -> Vec<bool> {
        let middle = |k: usize| (k as f64 + 0.5) * self.cell_m() - self.reach_m;
        let mut rough = Vec::with_capacity(self.cells * self.cells);
        for row in 0..self.cells {
            let line = self.line(middle(row));
            for column in 0..self.cells {
                let exact = (self.exact)(DVec2::new(middle(column), middle(row)));
                let is_near = (cubic(&line[column..], 0.5) - exact).abs().cmple(DVec2::splat(tolerance)).all();
                rough.push(exact.is_finite() && !is_near);
            }
        }
        rough
    }

    /// The corners' values along a row of places of the same y.
    fn line(&self, y_m: f64) -> Vec<DVec2> {
        let (row, v) = self.cell_of(y_m);
        let side = self.stride();
        let column = |k: usize| [0, 1, 2, 3].map(|j| self.corners[(row + j) * side + k]);
        (0..side).map(|k| cubic(&column(k), v)).collect()
    }

    fn cell_of(&self, along_m: f64) -> (usize, f64) {
        let at = ((along_m + self.reach_m) / self.cell_m()).clamp(0.0, self.cells as f64);
        let cell = (at as usize).min(self.cells - 1);
        (cell, at - cell as f64)
    }

    /// Maps `out.len()` places of a row: the first at (`x_m`, `y_m`), the others `step_m` east of one another. All lie
    /// within the square.
    pub fn row(&self, y_m: f64, x_m: f64, step_m: f64, out: &mut [DVec2]) {
        let line = self.line(y_m);
        let (row, _) = self.cell_of(y_m);
        let mut first = 0;
        while first < out.len() {
            let (cell, _) = self.cell_of(x_m + step_m * first as f64);
            let east_m = (cell + 1) as f64 * self.cell_m() - self.reach_m;
            let ends = if cell + 1 == self.cells { out.len() } else { ((east_m - x_m) / step_m).ceil() as usize };
            let ends = ends.clamp(first + 1, out.len());
            let places = out[first..ends].iter_mut().zip(first..);
            if self.rough[row * self.cells + cell] {
                places.for_each(|(to, k)| *to = (self.exact)(DVec2::new(x_m + step_m * k as f64, y_m)));
            } else {
                let [a, b, c, d] = coefficients(&line[cell..]);
                let west_m = cell as f64 * self.cell_m() - self.reach_m;
                let (start, step) = ((x_m - west_m) / self.cell_m(), step_m / self.cell_m());
                places.for_each(|(to, k)| {
                    let u = start + step * k as f64;
                    *to = a + u * (b + u * (c + u * d));
                });
            }
            first = ends;
        }
    }
}

/// The cubic through four values at −1, 0, 1, 2, by powers.
fn coefficients(p: &[DVec2]) -> [DVec2; 4] {
    let [p0, p1, p2, p3] = [p[0], p[1], p[2], p[3]];
    [
        p1,
        p2 - p0 / 3.0 - p1 / 2.0 - p3 / 6.0,
        (p0 + p2) / 2.0 - p1,
        (p3 - p0) / 6.0 + (p1 - p2) / 2.0,
    ]
}

fn cubic(p: &[DVec2], u: f64) -> DVec2 {
    let [a, b, c, d] = coefficients(p);
    a + u * (b + u * (c + u * d))
}

#[cfg(test)]
mod tests {
    use super::super::AzimuthalPlane;
    use super::*;

    /// Largest distance on the ground between warped and exact places, metres.
    fn worst_m(lon: f64, lat: f64, reach_m: f64) -> f64 {
        let plane = AzimuthalPlane::new(lon, lat).unwrap();
        let warp = GridWarp::new(reach_m, 1e-9, |p| DVec2::from(plane.to_lon_lat(p)));
        let mut row = vec![DVec2::ZERO; 83];
        let step_m = 2.0 * reach_m / 82.0;
        let mut worst = 0f64;
        for k in 0..83 {
            let y_m = k as f64 * step_m - reach_m;
            warp.row(y_m, -reach_m, step_m, &mut row);
            for (i, lon_lat) in row.iter().enumerate() {
                let p = DVec2::new(i as f64 * step_m - reach_m, y_m);
                worst = worst.max((plane.to_plane(lon_lat.x, lon_lat.y) - p).length());
            }
        }
        worst
    }

    #[test]
    fn a_millimetre_is_kept() {
        for (lon, lat) in [(138.7274, 35.3606), (0.0, 0.0), (-71.3, 64.3), (179.9, -45.0)] {
            let worst = worst_m(lon, lat, 160e3);
            assert!(worst < 1e-3, "{lon}, {lat}: {worst} m");
        }
    }

    #[test]
    fn a_pole_in_the_square_is_no_trouble() {
        for lat in [90.0, -89.9] {
            assert!(worst_m(20.0, lat, 30e3) < 1e-3, "{lat}");
        }
    }

    #[test]
    fn what_has_no_place_stays_without() {
        let west = |p: DVec2| if p.x < 0.0 { p } else { DVec2::NAN };
        let warp = GridWarp::new(100.0, 1e-6, west);
        let mut row = [DVec2::ZERO; 201];
        warp.row(3.0, -100.0, 1.0, &mut row);
        assert!(row[0].is_finite() && (row[0] - DVec2::new(-100.0, 3.0)).length() < 1e-6 && row[200].is_nan());
    }
}
