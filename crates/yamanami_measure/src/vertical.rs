//! Vertical distance of every sample of a height field to a terrain mesh.
//!
//! Every triangle is scan-converted over the samples it covers, its border included, and the distance from sample to
//! plane is taken there. A sample on an edge or a vertex is measured against every triangle that touches it and keeps
//! the largest distance. The rows are cut into bands that are worked on in parallel; sums are added in band order, so
//! the result does not depend on the number of threads.

use crate::rows::{BAND_ROWS, Chunk, Corner, REACH_CELLS, chunks, double_area, onto_samples, span};
use rayon::prelude::*;
use yamanami_core::{HeightField, TriangleMesh};

/// How far outside a triangle, in cells, a sample still counts as touching it.
const TOUCH_CELLS: f64 = 1e-8;

/// How far a mesh is from the samples it stands for.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct VerticalReport {
    /// Largest vertical distance in metres.
    pub max_m: f64,
    /// Root of the mean squared vertical distance in metres.
    pub rms_m: f64,
    /// Mean vertical distance in metres.
    pub mean_m: f64,
    /// Column and row of the sample with the largest distance; the first in row order among equals.
    pub worst: Option<[usize; 2]>,
    /// Samples that were measured: with data, and covered.
    pub measured: usize,
    /// Samples with data that no triangle covers.
    pub uncovered: usize,
    /// Samples without data that a triangle covers.
    pub covered_no_data: usize,
    /// Plan area of all triangles over the plan area of the data: cells with four heights count whole, cells with three
    /// count half. 1 for a mesh without holes or overlaps over data without gaps; more where it spans cells without data,
    /// less where its diagonals leave out half cells beside them.
    pub area_ratio: f64,
}

/// Measures the vertical distance of every sample of `field` to `mesh`, which is in the field's local metric frame
/// ([`yamanami_core::GeoReference::local_from_grid`]).
///
/// A sample touched by no triangle, but within a thousandth of a cell of one, is measured against that one, so that a
/// mesh that went through a single-precision file is judged fairly at its border. Triangles without area in plan, and
/// those with a corner that is not finite, measure nothing.
///
/// # Panics
/// When a triangle names a vertex that the mesh does not have.
pub fn vertical_error(field: &HeightField, mesh: &TriangleMesh) -> VerticalReport {
    let (width, height) = (field.width(), field.height());
    let corners = grid_corners(field, mesh);
    let bands = height.div_ceil(BAND_ROWS);
    let chunks = chunks(&mesh.triangles, &corners, height);
    let measured: Vec<BandSums> = (0..bands)
        .into_par_iter()
        .map_init(Vec::new, |distances, band| {
            let first_row = band * BAND_ROWS;
            let rows = BAND_ROWS.min(height - first_row);
            let triangles = || Chunk::band_of(&chunks, band);
            let heights = &field.heights_m()[first_row * width..(first_row + rows) * width];
            distances.clear();
            distances.resize(rows * width, UNTOUCHED);
            let mut target = Band { first_row, rows, width, heights, distances };
            for t in triangles() {
                target.scan(t.map(|i| corners[i as usize]), TOUCH_CELLS, UNTOUCHED);
            }
            if target.has_gaps() {
                target.mark_gaps();
                for t in triangles() {
                    target.scan(t.map(|i| corners[i as usize]), REACH_CELLS, GAP);
                }
            }
            target.sums()
        })
        .collect();

    let mut report = VerticalReport::default();
    let (mut sum, mut sum_squares) = (0.0, 0.0);
    for band in measured {
        if band.worst.is_some() && (band.max > report.max_m || report.worst.is_none()) {
            (report.max_m, report.worst) = (band.max, band.worst);
        }
        sum += band.sum;
        sum_squares += band.sum_squares;
        report.measured += band.measured;
        report.uncovered += band.uncovered;
        report.covered_no_data += band.covered_no_data;
    }
    let count = report.measured.max(1) as f64;
    report.mean_m = sum / count;
    report.rms_m = (sum_squares / count).sqrt();
    let data_cells = data_cells(field);
    let mesh_cells: f64 = chunks.iter().map(|c| c.area_cells).sum();
    report.area_ratio = if data_cells > 0.0 { mesh_cells / data_cells } else { 0.0 };
    report
}

/// All vertices in grid units, those within rounding of a sample position moved onto it.
fn grid_corners(field: &HeightField, mesh: &TriangleMesh) -> Vec<Corner> {
    let onto = onto_samples(field.width().max(field.height()));
    mesh.positions
        .par_iter()
        .map(|p| {
            let [column, row] = field.geo().grid_from_local(p.x, p.y);
            [onto(column), onto(row), p.z]
        })
        .collect()
}

/// Plan area of the data in cells: whole ones, and halves where one of the four heights is missing.
fn data_cells(field: &HeightField) -> f64 {
    let halves: usize = (0..field.height() - 1)
        .into_par_iter()
        .map(|row| {
            let line = |row: usize| &field.heights_m()[row * field.width()..(row + 1) * field.width()];
            let pairs = |row| line(row).windows(2).map(|w| usize::from(!w[0].is_nan()) + usize::from(!w[1].is_nan()));
            pairs(row)
                .zip(pairs(row + 1))
                .map(|(north, south)| match north + south {
                    4 => 2,
                    3 => 1,
                    _ => 0,
                })
                .sum::<usize>()
        })
        .sum();
    halves as f64 / 2.0
}

/// Distance of a sample that no triangle has touched yet.
const UNTOUCHED: f64 = -1.0;
/// Distance of a sample that no triangle touches, in the second pass.
const GAP: f64 = -2.0;

/// What a band adds to the report.
#[derive(Default)]
struct BandSums {
    max: f64,
    worst: Option<[usize; 2]>,
    sum: f64,
    sum_squares: f64,
    measured: usize,
    uncovered: usize,
    covered_no_data: usize,
}

/// Some rows of the grid: their heights, and the largest distance found so far at each sample (0 without data).
struct Band<'a> {
    first_row: usize,
    rows: usize,
    width: usize,
    heights: &'a [f32],
    distances: &'a mut Vec<f64>,
}

impl Band<'_> {
    /// Measures the band's samples within `reach` cells of a triangle. In the second pass (`only` is [`GAP`]) only
    /// those marked as gaps, whose distances are then kept below [`GAP`] as `GAP - 1 - distance`.
    fn scan(&mut self, triangle: [Corner; 3], reach: f64, only: f64) {
        let second_pass = only == GAP;
        if let Some(samples) = samples_of_half_cell(triangle) {
            for ([column, row], corner) in samples.into_iter().zip(triangle) {
                if column < self.width && (self.first_row..self.first_row + self.rows).contains(&row) {
                    let k = (row - self.first_row) * self.width + column;
                    touch(&mut self.distances[k], self.heights[k], corner[2], second_pass);
                }
            }
            return;
        }
        let [a, b, c] = triangle;
        let area = double_area(triangle);
        let along_column = ((b[2] - a[2]) * (c[1] - a[1]) - (c[2] - a[2]) * (b[1] - a[1])) / area;
        let along_row = ((c[2] - a[2]) * (b[0] - a[0]) - (b[2] - a[2]) * (c[0] - a[0])) / area;
        let [low, high] = [a[2].min(b[2]).min(c[2]), a[2].max(b[2]).max(c[2])];
        let [north, south] = [a[1].min(b[1]).min(c[1]), a[1].max(b[1]).max(c[1])];
        let first = (north - reach).ceil().max(self.first_row as f64);
        let last = (south + reach).floor().min((self.first_row + self.rows - 1) as f64);
        if first > last {
            return;
        }
        for row in first as usize..=last as usize {
            let y = (row as f64).clamp(north, south);
            let [west, east] = span(triangle, y);
            let from = (west - reach).ceil().max(0.0);
            let to = (east + reach).floor().min((self.width - 1) as f64);
            if from > to {
                continue;
            }
            let start = (row - self.first_row) * self.width;
            let range = start + from as usize..start + to as usize + 1;
            let at_row = a[2] + along_row * (y - a[1]);
            let samples = self.distances[range.clone()].iter_mut().zip(&self.heights[range]);
            for (k, (distance, &z)) in samples.enumerate() {
                // the point of the triangle at, or nearest along the row to, the sample: never an extrapolated plane
                let x = (from + k as f64).clamp(west, east);
                let plane = (at_row + along_column * (x - a[0])).clamp(low, high);
                touch(distance, z, plane, second_pass);
            }
        }
    }

    fn has_gaps(&self) -> bool {
        self.distances.iter().zip(self.heights).any(|(&d, z)| d == UNTOUCHED && !z.is_nan())
    }

    fn mark_gaps(&mut self) {
        for (distance, z) in self.distances.iter_mut().zip(self.heights) {
            if *distance == UNTOUCHED && !z.is_nan() {
                *distance = GAP;
            }
        }
    }

    fn sums(&self) -> BandSums {
        let mut sums = BandSums::default();
        for (k, (&stored, z)) in self.distances.iter().zip(self.heights).enumerate() {
            let touched = stored != UNTOUCHED && stored != GAP;
            if z.is_nan() {
                sums.covered_no_data += usize::from(touched);
                continue;
            }
            if !touched {
                sums.uncovered += 1;
                continue;
            }
            let distance = if stored < GAP { GAP - 1.0 - stored } else { stored };
            if distance > sums.max || sums.worst.is_none() {
                sums.max = distance;
                sums.worst = Some([k % self.width, self.first_row + k / self.width]);
            }
            sums.sum += distance;
            sums.sum_squares += distance * distance;
            sums.measured += 1;
        }
        sums
    }
}

/// Keeps the larger distance of a sample, for a triangle that is `plane` metres high there.
#[inline]
fn touch(distance: &mut f64, z: f32, plane: f64, second_pass: bool) {
    let here = if z.is_nan() { 0.0 } else { (plane - f64::from(z)).abs() };
    if !second_pass {
        *distance = distance.max(here);
    } else if *distance <= GAP {
        *distance = distance.min(GAP - 1.0 - here);
    }
}

/// Column and row of the corners of a triangle that is half a cell: it touches no other sample. Most triangles of a
/// dense mesh are such.
#[inline]
fn samples_of_half_cell(triangle: [Corner; 3]) -> Option<[[usize; 2]; 3]> {
    let samples = triangle.map(|c| [c[0] as usize, c[1] as usize]);
    let [a, b, c] = samples;
    let close = |k: usize| a[k].abs_diff(b[k]) <= 1 && a[k].abs_diff(c[k]) <= 1 && b[k].abs_diff(c[k]) <= 1;
    let exact = triangle.iter().zip(samples).all(|(c, s)| c[0] == s[0] as f64 && c[1] == s[1] as f64);
    (exact && close(0) && close(1)).then_some(samples)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use proptest::prelude::*;
    use yamanami_core::GeoReference;

    const STEP_M: [f64; 2] = [30.1, 29.7];

    /// A mesh over every `stride`th sample, two triangles a cell.
    fn grid_mesh(field: &HeightField, stride: usize) -> TriangleMesh {
        let [columns, rows] = [field.width(), field.height()].map(|size| (size - 1).div_ceil(stride) + 1);
        let mut mesh = TriangleMesh::default();
        for j in 0..rows {
            for i in 0..columns {
                let (column, row) = ((i * stride).min(field.width() - 1), (j * stride).min(field.height() - 1));
                let [x, y] = field.geo().local_from_grid(column as f64, row as f64);
                mesh.positions.push(DVec3::new(x, y, f64::from(field.at(column, row))));
            }
        }
        for j in 0..rows as u32 - 1 {
            for i in 0..columns as u32 - 1 {
                let a = j * columns as u32 + i;
                let (b, c, d) = (a + 1, a + columns as u32, a + columns as u32 + 1);
                mesh.triangles.extend([[a, c, b], [b, c, d]]);
            }
        }
        mesh
    }

    fn field(width: usize, height: usize, z: impl Fn(usize, usize) -> f32) -> HeightField {
        let heights = (0..width * height).map(|k| z(k % width, k / width)).collect();
        HeightField::new(width, height, heights, GeoReference::local(STEP_M, height))
    }

    fn bumpy(column: usize, row: usize) -> f32 {
        (column as f32 * 0.7).sin() * 40.0 + (row as f32 * 0.31).cos() * 25.0 + (column * row % 7) as f32
    }

    #[test]
    fn the_full_mesh_has_no_error_at_all() {
        let field = field(101, 67, bumpy);
        let report = vertical_error(&field, &grid_mesh(&field, 1));
        assert_eq!((report.max_m, report.uncovered, report.covered_no_data), (0.0, 0, 0));
        assert_eq!(report.measured, 101 * 67);
        assert!((report.area_ratio - 1.0).abs() < 1e-9);
    }

    #[test]
    fn the_worst_sample_is_found_where_it_is() {
        let spike = field(65, 65, |c, r| if (c, r) == (21, 46) { 12.5 } else { 1.0 });
        let report = vertical_error(&spike, &grid_mesh(&spike, 4));
        assert_eq!((report.max_m, report.worst), (11.5, Some([21, 46])));
        assert!((report.mean_m - 11.5 / 4225.0).abs() < 1e-12);
        assert!((report.rms_m - 11.5 / 65.0).abs() < 1e-12);
    }

    #[test]
    fn a_sample_on_an_edge_counts_with_both_sides() {
        let flat = field(3, 3, |_, _| 0.0);
        let mut mesh = grid_mesh(&flat, 2);
        // the two triangles get a diagonal each: 0 m and 8 m above the field
        mesh.positions.extend([mesh.positions[1] + 8.0 * DVec3::Z, mesh.positions[2] + 8.0 * DVec3::Z]);
        mesh.triangles[1] = [4, 5, 3];
        let report = vertical_error(&flat, &mesh);
        assert_eq!(report.max_m, 8.0);
        assert_eq!(report.worst, Some([2, 0]));
        assert!((report.mean_m - (8.0 * 3.0 + 4.0 * 2.0) / 9.0).abs() < 1e-12);
    }

    #[test]
    fn holes_and_skirts_are_counted() {
        let holed = field(9, 9, |c, r| if (3..6).contains(&c) && r == 4 { f32::NAN } else { 5.0 });
        let full = field(9, 9, |_, _| 5.0);
        let mut mesh = grid_mesh(&full, 1);
        assert_eq!(vertical_error(&holed, &mesh).covered_no_data, 3);
        mesh.triangles.retain(|t| t.iter().all(|&i| !holed.heights_m()[i as usize].is_nan()));
        let report = vertical_error(&holed, &mesh);
        assert_eq!((report.covered_no_data, report.uncovered, report.measured), (0, 0, 78));
        // 56 whole cells and two of the four half ones at the hole's corners: the diagonals run the other way
        assert!((report.area_ratio - 57.0 / 58.0).abs() < 1e-9, "{}", report.area_ratio);
        mesh.triangles.retain(|t| !t.contains(&0));
        assert_eq!(vertical_error(&holed, &mesh).uncovered, 1);
    }

    #[test]
    fn single_precision_corners_leave_no_sample_out() {
        let field = field(129, 129, bumpy);
        let mut mesh = grid_mesh(&field, 8);
        let exact = vertical_error(&field, &mesh);
        for p in &mut mesh.positions {
            *p = p.as_vec3().as_dvec3() - DVec3::new(1e-3, 2e-3, 0.0);
        }
        let moved = vertical_error(&field, &mesh);
        assert_eq!(moved.uncovered, 0);
        assert!((moved.max_m - exact.max_m).abs() < 1e-2);
    }

    #[test]
    fn triangles_without_area_or_number_measure_nothing() {
        let flat = field(4, 4, |_, _| 0.0);
        let mut mesh = grid_mesh(&flat, 1);
        let n = mesh.positions.len() as u32;
        mesh.positions.extend([DVec3::NAN, DVec3::new(f64::INFINITY, 0.0, 3.0)]);
        mesh.triangles.extend([[0, 1, n], [0, n + 1, 5], [0, 1, 2], [3, 3, 3]]);
        let report = vertical_error(&flat, &mesh);
        assert_eq!((report.max_m, report.uncovered), (0.0, 0));
        assert_eq!(vertical_error(&flat, &TriangleMesh::default()).uncovered, 16);
    }

    /// Every sample against every triangle by barycentric coordinates.
    fn slow_max_m(field: &HeightField, mesh: &TriangleMesh) -> (f64, usize) {
        let (mut max, mut uncovered) = (0f64, 0);
        for row in 0..field.height() {
            for column in 0..field.width() {
                let [x, y] = field.geo().local_from_grid(column as f64, row as f64);
                let mut touched = false;
                for k in 0..mesh.triangles.len() {
                    let [a, b, c] = mesh.corners(k);
                    let area = (b - a).truncate().perp_dot((c - a).truncate());
                    let u = (b.x - x) * (c.y - y) - (b.y - y) * (c.x - x);
                    let v = (c.x - x) * (a.y - y) - (c.y - y) * (a.x - x);
                    let [u, v] = [u / area, v / area];
                    if u >= -1e-12 && v >= -1e-12 && u + v <= 1.0 + 1e-12 {
                        touched = true;
                        let z = u * a.z + v * b.z + (1.0 - u - v) * c.z;
                        max = max.max((z - f64::from(field.at(column, row))).abs());
                    }
                }
                uncovered += usize::from(!touched);
            }
        }
        (max, uncovered)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        #[test]
        fn agrees_with_every_sample_against_every_triangle(
            width in 2usize..40,
            height in 2usize..70,
            corners in prop::collection::vec((-5.0..45.0f64, -5.0..75.0f64, -50.0..50.0f64), 3..18),
        ) {
            let field = field(width, height, bumpy);
            let mesh = TriangleMesh {
                positions: corners.iter().map(|&(c, r, z)| DVec3::new(c * STEP_M[0], -r * STEP_M[1], z)).collect(),
                triangles: (0..corners.len() as u32 / 3).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect(),
                ..TriangleMesh::default()
            };
            let (max_m, uncovered) = slow_max_m(&field, &mesh);
            let report = vertical_error(&field, &mesh);
            // the fast way reaches a thousandth of a cell further where nothing else is
            prop_assert!(report.uncovered <= uncovered && uncovered - report.uncovered <= 2);
            if report.uncovered == uncovered {
                prop_assert!((report.max_m - max_m).abs() < 1e-6, "{} {}", report.max_m, max_m);
            }
        }
    }
}
