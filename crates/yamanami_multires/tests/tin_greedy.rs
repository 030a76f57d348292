//! Greedy insertion: the error holds at every sample, by a slow twin; holes keep the grid's outline; triangles are Delaunay's.

use proptest::prelude::*;
use yamanami_core::{GeoReference, HeightField, TriangleMesh};
use yamanami_multires::MultiresError;
use yamanami_multires::tin::{GreedyOptions, greedy};
use yamanami_testkit::SyntheticTerrain;

fn field(width: usize, height: usize, heights_m: Vec<f32>) -> HeightField {
    HeightField::new(width, height, heights_m, GeoReference::local([2.0, 3.0], height))
}

/// Corners of a triangle in columns, rows and metres.
fn on_grid(field: &HeightField, mesh: &TriangleMesh, t: usize) -> [[f64; 3]; 3] {
    mesh.corners(t).map(|p| {
        let [column, row] = field.geo().grid_from_local(p.x, p.y);
        [column.round(), row.round(), p.z]
    })
}

fn area([ax, ay, _]: [f64; 3], [bx, by, _]: [f64; 3], [cx, cy, _]: [f64; 3]) -> f64 {
    (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
}

/// Greatest error over all covered samples, by looking at every sample for every triangle; checks the triangles too.
fn slow_error_m(field: &HeightField, mesh: &TriangleMesh) -> f64 {
    let mut most: f64 = 0.0;
    let mut twice_area = 0.0;
    for t in 0..mesh.triangles.len() {
        let [a, b, c] = on_grid(field, mesh, t);
        let whole = area(a, b, c);
        assert!(whole < 0.0, "counter-clockwise from above: rows go south");
        twice_area -= whole;
        for row in 0..field.height() {
            for column in 0..field.width() {
                let p = [column as f64, row as f64, 0.0];
                let parts = [area(b, c, p), area(c, a, p), area(a, b, p)];
                if parts.iter().all(|&part| part <= 0.0) {
                    let z = (parts[0] * a[2] + parts[1] * b[2] + parts[2] * c[2]) / whole;
                    let error = (z - f64::from(field.at(column, row))).abs();
                    assert!(!error.is_nan(), "a triangle over no-data");
                    most = most.max(error);
                }
            }
        }
    }
    assert_eq!(twice_area, shown_area(field), "covers the cells with data, once");
    most
}

/// Twice the area of what has data: cells, and halves of cells.
fn shown_area(field: &HeightField) -> f64 {
    let mut twice = 0.0;
    for row in 0..field.height() - 1 {
        for column in 0..field.width() - 1 {
            let with_data = [[0, 0], [1, 0], [0, 1], [1, 1]];
            match with_data.iter().filter(|[dx, dy]| !field.at(column + dx, row + dy).is_nan()).count() {
                4 => twice += 2.0,
                3 => twice += 1.0,
                _ => {}
            }
        }
    }
    twice
}

fn options(max_error_m: f64) -> GreedyOptions {
    GreedyOptions { max_error_m, most_triangles: None }
}

#[test]
fn a_plane_takes_two_triangles() {
    let plane = field(9, 5, (0..45).map(|i| (i % 9) as f32 * 0.5 + (i / 9) as f32).collect());
    let made = greedy(&plane, &options(0.0)).unwrap();
    assert_eq!((made.tin.mesh.triangles.len(), made.error_m), (2, 0.0));
    assert_eq!(slow_error_m(&plane, &made.tin.mesh), 0.0);
}

#[test]
fn errors_hold_and_fewer_metres_take_more_triangles() {
    let terrain = SyntheticTerrain::mountains(65, 49, 3).to_field();
    let mut last = usize::MAX;
    for max_error_m in [0.0, 1.0, 5.0, 20.0, 100.0] {
        let made = greedy(&terrain, &options(max_error_m)).unwrap();
        assert!(made.error_m <= max_error_m);
        assert!((slow_error_m(&terrain, &made.tin.mesh) - made.error_m).abs() < 1e-9);
        assert!(made.tin.mesh.triangles.len() < last || max_error_m == 0.0);
        last = made.tin.mesh.triangles.len();
    }
}

#[test]
fn triangles_run_out() {
    let terrain = SyntheticTerrain::mountains(65, 65, 3).to_field();
    for most in [2, 3, 100, 1001] {
        let made = greedy(&terrain, &GreedyOptions { max_error_m: 0.0, most_triangles: Some(most) }).unwrap();
        assert!(made.tin.mesh.triangles.len() <= most && made.tin.mesh.triangles.len() + 3 > most);
        assert!((slow_error_m(&terrain, &made.tin.mesh) - made.error_m).abs() < 1e-9);
    }
}

#[test]
fn no_data_alone_is_an_error() {
    let nothing = field(3, 3, vec![f32::NAN; 9]);
    assert!(matches!(greedy(&nothing, &options(1.0)), Err(MultiresError::NothingToShow { no_data: 9, .. })));
}

fn any_field() -> impl Strategy<Value = HeightField> {
    let height = prop_oneof![4 => (0..60i16).prop_map(f32::from), 1 => Just(f32::NAN)];
    let smooth = (0..60i16).prop_map(f32::from);
    let sized = |height: BoxedStrategy<f32>| {
        (2usize..14, 2usize..14)
            .prop_flat_map(move |(w, h)| prop::collection::vec(height.clone(), w * h).prop_map(move |z| field(w, h, z)))
    };
    prop_oneof![sized(height.boxed()), sized(smooth.boxed())]
}

proptest! {
    #[test]
    fn any_field_is_within_its_error(field in any_field(), max_error_m in 0.0..40.0) {
        let Ok(made) = greedy(&field, &options(max_error_m)) else {
            prop_assert_eq!(shown_area(&field), 0.0);
            return Ok(());
        };
        prop_assert!(made.error_m <= max_error_m);
        prop_assert!((slow_error_m(&field, &made.tin.mesh) - made.error_m).abs() < 1e-9);
    }

    #[test]
    fn holes_in_a_disc_keep_their_outline(x in 0.0..30.0, y in 0.0..30.0, r in 1.0..14.0, max_error_m in 1.0..50.0) {
        let terrain = SyntheticTerrain::mountains(33, 33, 5).to_field();
        let heights = (0..33 * 33).map(|i| {
            let (dx, dy) = ((i % 33) as f64 - x, (i / 33) as f64 - y);
            if dx * dx + dy * dy < r * r { f32::NAN } else { terrain.heights_m()[i] }
        });
        let holed = HeightField::new(33, 33, heights.collect(), terrain.geo().clone());
        let made = greedy(&holed, &options(max_error_m)).unwrap();
        prop_assert!((slow_error_m(&holed, &made.tin.mesh) - made.error_m).abs() < 1e-9 && made.error_m <= max_error_m);
    }
}
