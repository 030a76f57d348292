//! The laws that tie a terrain's fronts to its source: the full front is the source, and an error promised is an error
//! kept, at every sample.

use yamanami_core::{HeightField, NodeId, Surface, TriangleMesh};

/// Room for rounding when an error is compared with its promise: relative, and in metres.
const ROUNDING: f64 = 1e-6;

/// The full front meets every sample that can be shown within `quantum_m` (0: exactly).
///
/// # Panics
/// With the sample, when it does not hold.
pub fn ends_law<S: Surface>(surface: &S, field: &HeightField, quantum_m: f64) {
    let mesh = surface.mesh_of(&|n: NodeId| surface.exists(n));
    let mut met = vec![false; field.width() * field.height()];
    for p in &mesh.positions {
        let [x, y] = field.geo().grid_from_local(p.x, p.y);
        let (column, row) = (x.round(), y.round());
        assert!(
            (x - column).abs() < 1e-6 && (y - row).abs() < 1e-6,
            "the full front has a vertex off the samples: {p}"
        );
        let z = f64::from(field.at(column as usize, row as usize));
        assert!((p.z - z).abs() <= quantum_m, "sample ({column}, {row}) is at {} m, the source says {z} m", p.z);
        met[row as usize * field.width() + column as usize] = true;
    }
    for row in 0..field.height() {
        for column in 0..field.width() {
            let must = corner_of_full_square(field, column, row);
            assert!(met[row * field.width() + column] || !must, "the full front misses sample ({column}, {row})");
        }
    }
}

/// For each tolerance, the front of all nodes with a larger error is within the tolerance of every sample it should
/// cover: `error_m` bounds true distance.
///
/// # Panics
/// With the sample and both errors, when it does not hold.
pub fn error_law<S: Surface>(surface: &S, field: &HeightField, tolerances_m: &[f32]) {
    for &tolerance_m in tolerances_m {
        let mesh = surface.mesh_of(&|n: NodeId| surface.exists(n) && surface.error_m(n) > tolerance_m);
        let worst = worst_vertical_error_m(&mesh, field);
        let allowed_m = f64::from(tolerance_m) * (1.0 + ROUNDING) + ROUNDING;
        assert!(
            worst.error_m <= allowed_m,
            "tolerance {tolerance_m} m: sample {:?} is {} m off, with {} triangles",
            worst.sample,
            worst.error_m,
            mesh.triangles.len()
        );
        assert!(
            worst.uncovered.is_none(),
            "tolerance {tolerance_m} m: sample {:?} has data and no triangle, with {} triangles",
            worst.uncovered,
            mesh.triangles.len()
        );
    }
}

/// How far a mesh is from a height field at the field's samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorstError {
    /// Greatest vertical distance at any covered sample.
    pub error_m: f64,
    /// Column and row where it occurs.
    pub sample: [usize; 2],
    /// The first sample that no triangle covers although all four samples of a square at it have data.
    pub uncovered: Option<[usize; 2]>,
}

/// Measures every sample with data against the mesh, triangle by triangle.
pub fn worst_vertical_error_m(mesh: &TriangleMesh, field: &HeightField) -> WorstError {
    let mut worst = WorstError { error_m: 0.0, sample: [0, 0], uncovered: None };
    let mut covered = vec![false; field.width() * field.height()];
    for t in 0..mesh.triangles.len() {
        let corners = mesh.corners(t).map(|p| {
            let [x, y] = field.geo().grid_from_local(p.x, p.y);
            [x, y, p.z]
        });
        samples_of(corners, [field.width(), field.height()], |column, row, z| {
            covered[row * field.width() + column] = true;
            let error_m = (f64::from(field.at(column, row)) - z).abs();
            if error_m > worst.error_m {
                (worst.error_m, worst.sample) = (error_m, [column, row]);
            }
        });
    }
    let uncovered = (0..covered.len()).find(|&i| {
        let (column, row) = (i % field.width(), i / field.width());
        !covered[i] && corner_of_full_square(field, column, row)
    });
    worst.uncovered = uncovered.map(|i| [i % field.width(), i / field.width()]);
    worst
}

/// Calls `visit` with the samples under a triangle given in (column, row, z), and the triangle's height there.
fn samples_of(corners: [[f64; 3]; 3], size: [usize; 2], mut visit: impl FnMut(usize, usize, f64)) {
    const EDGE: f64 = 1e-7; // samples; a sample on an edge belongs to both sides
    let [a, b, c] = corners;
    let det = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    if det == 0.0 {
        return;
    }
    let dx = ((b[2] - a[2]) * (c[1] - a[1]) - (c[2] - a[2]) * (b[1] - a[1])) / det;
    let dy = ((b[0] - a[0]) * (c[2] - a[2]) - (c[0] - a[0]) * (b[2] - a[2])) / det;
    let range = |low: f64, high: f64, size: usize| {
        let first = (low - EDGE).ceil().max(0.0) as usize;
        let last = (high + EDGE).floor().min((size - 1) as f64);
        first..(last + 1.0).max(0.0) as usize
    };
    let (top, bottom) = (a[1].min(b[1]).min(c[1]), a[1].max(b[1]).max(c[1]));
    for row in range(top, bottom, size[1]) {
        let y = row as f64;
        let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
        for (p, q) in [(a, b), (b, c), (c, a)] {
            if y < p[1].min(q[1]) - EDGE || y > p[1].max(q[1]) + EDGE {
                continue;
            }
            if (q[1] - p[1]).abs() <= EDGE {
                (left, right) = (left.min(p[0].min(q[0])), right.max(p[0].max(q[0])));
            } else {
                let x = p[0] + (q[0] - p[0]) * ((y - p[1]) / (q[1] - p[1])).clamp(0.0, 1.0);
                (left, right) = (left.min(x), right.max(x));
            }
        }
        if left <= right {
            for column in range(left, right, size[0]) {
                visit(column, row, a[2] + dx * (column as f64 - a[0]) + dy * (y - a[1]));
            }
        }
    }
}

/// Whether a sample and three neighbours that make a square with it all have data: then a triangle must show it.
fn corner_of_full_square(field: &HeightField, column: usize, row: usize) -> bool {
    let has = |c: usize, r: usize| c < field.width() && r < field.height() && !field.at(c, r).is_nan();
    let sides = |k: usize| [k.checked_sub(1), Some(k + 1)].into_iter().flatten();
    has(column, row) && sides(column).any(|c| sides(row).any(|r| has(c, row) && has(column, r) && has(c, r)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Holes, Shape, Spacing, SyntheticTerrain};
    use glam::DVec3;

    /// Two triangles over a 5×5 grid at 10 m.
    fn two_triangles(field: &HeightField) -> TriangleMesh {
        let at = |c: usize, r: usize| {
            let [x, y] = field.geo().local_from_grid(c as f64, r as f64);
            DVec3::new(x, y, f64::from(field.at(c, r)))
        };
        TriangleMesh {
            positions: vec![at(0, 0), at(4, 0), at(0, 4), at(4, 4)],
            triangles: vec![[0, 2, 3], [0, 3, 1]],
            ..TriangleMesh::default()
        }
    }

    #[test]
    fn a_plane_has_no_error_and_a_spike_has_its_height() {
        let plane = Shape::Plane { at_origin_m: 1.0, slope_m: [2.0, -0.5] };
        let field = SyntheticTerrain::new(5, 5, plane, Spacing::Metres(10.0)).to_field();
        let worst = worst_vertical_error_m(&two_triangles(&field), &field);
        assert!(worst.error_m < 1e-9 && worst.uncovered.is_none(), "{worst:?}");
        let spike = Shape::Spike { column: 2, row: 2, z_m: 7.0 };
        let field = SyntheticTerrain::new(5, 5, spike, Spacing::Metres(10.0)).to_field();
        let worst = worst_vertical_error_m(&two_triangles(&field), &field);
        assert_eq!((worst.error_m, worst.sample), (7.0, [2, 2]));
    }

    #[test]
    fn a_sample_without_a_triangle_is_found_unless_it_stands_alone() {
        let field = SyntheticTerrain::new(5, 5, Shape::Flat { z_m: 3.0 }, Spacing::Metres(10.0)).to_field();
        let mut mesh = two_triangles(&field);
        mesh.triangles.pop();
        assert_eq!(worst_vertical_error_m(&mesh, &field).uncovered, Some([1, 0]));
        let alone = SyntheticTerrain::new(5, 5, Shape::Flat { z_m: 3.0 }, Spacing::Metres(10.0))
            .with_holes(Holes::AllBut { column: 2, row: 2 })
            .to_field();
        assert_eq!(worst_vertical_error_m(&TriangleMesh::default(), &alone).uncovered, None);
    }
}
