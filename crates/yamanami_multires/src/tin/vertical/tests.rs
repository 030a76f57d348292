//! The distance of small TINs, by hand and against every pair of edges.

use super::*;

#[test]
fn two_diagonals_of_a_square_differ_in_its_middle() {
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let positions = [at(0.0, 0.0, 0.0), at(2.0, 0.0, 3.0), at(2.0, 2.0, 0.0), at(0.0, 2.0, 3.0)];
    let one = Ground { positions: &positions, triangles: &[[0, 1, 2], [0, 2, 3]] };
    let other = Ground { positions: &positions, triangles: &[[0, 1, 3], [1, 2, 3]] };
    assert_eq!(vertical_distance_m(one, other), 3.0);
    assert_eq!(vertical_distance_m(one, one), 0.0);
}

#[test]
fn a_peak_left_out_is_its_height() {
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let positions = [at(0.0, 0.0, 0.0), at(4.0, 0.0, 0.0), at(0.0, 4.0, 0.0), at(1.0, 1.0, 7.0)];
    let fine = Ground { positions: &positions, triangles: &[[0, 1, 3], [1, 2, 3], [2, 0, 3]] };
    let coarse = Ground { positions: &positions[..3], triangles: &[[0, 1, 2]] };
    assert_eq!(vertical_distance_m(fine, coarse), 7.0);
    assert_eq!(vertical_distance_m(coarse, fine), 7.0);
}
