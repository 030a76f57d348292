//! The distance of small TINs, by hand and against every pair of edges.

use super::*;
use proptest::prelude::*;

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

/// A grid of squares over the same ground whatever `n`, shaken or not, each cut along one diagonal or the other; some
/// triangles missing.
fn grid(n: usize, is_shaken: bool, missing: f64, seed: u64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut rng = yamanami_testkit::Rng::new(seed);
    let mut positions = Vec::new();
    for k in 0..(n + 1) * (n + 1) {
        let inner = |i: usize| is_shaken && i > 0 && i < n;
        let mut at = |i: usize| 24.0 / n as f64 * (i as f64 + if inner(i) { 0.5 * rng.unit() - 0.25 } else { 0.0 });
        let (x, y) = (at(k % (n + 1)), at(k / (n + 1)));
        positions.push(DVec3::new(x, y, 5.0 * rng.unit()));
    }
    let mut triangles = Vec::new();
    for k in 0..n * n {
        let a = (k / n * (n + 1) + k % n) as u32;
        let [b, c, d] = [a + 1, a + n as u32 + 2, a + n as u32 + 1];
        triangles.extend(if rng.chance(0.5) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
    }
    triangles.retain(|_| !rng.chance(missing));
    (positions, triangles)
}

/// The same by looking at every vertex and every pair of edges.
fn slowly(fine: Ground<'_>, coarse: Ground<'_>) -> f64 {
    let mut worst_m = 0.0f64;
    for (one, other) in [(fine, coarse), (coarse, fine)] {
        let used = one.triangles.as_flattened().iter().map(|&v| one.positions[v as usize]);
        for p in used {
            let is_in = |t: &u32| {
                let [a, b, c] = other.corners(*t);
                [area2(b, c, p), area2(c, a, p), area2(a, b, p)].iter().all(|w| *w >= 0.0)
            };
            let first = (0..other.triangles.len() as u32).find(is_in);
            worst_m = first.map_or(worst_m, |t| worst_m.max(other.off_m(t, p)));
        }
    }
    let edges = |g: Ground<'_>| -> Vec<[DVec3; 2]> {
        let sides = (0..g.triangles.len() as u32).map(|t| g.corners(t));
        sides.flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]).collect()
    };
    for [p, q] in edges(fine) {
        for [a, b] in edges(coarse) {
            let (sp, sq, sa, sb) = (area2(a, b, p), area2(a, b, q), area2(p, q, a), area2(p, q, b));
            if sp * sq < 0.0 && sa * sb < 0.0 {
                worst_m = worst_m.max(off_at_crossing_m([p, q], [a, b], sa / (sa - sb)));
            }
        }
    }
    worst_m
}

proptest! {
    #[test]
    fn walking_finds_what_looking_everywhere_does(
        sizes in (1usize..7, 1usize..7),
        shaken in any::<(bool, bool)>(),
        missing in prop_oneof![Just(0.0), 0.0..0.5],
        seed in any::<u64>(),
    ) {
        // unshaken grids have vertices on each other's edges, and edges along each other
        let (fine_places, fine) = grid(sizes.0, shaken.0, missing, seed);
        let (coarse_places, coarse) = grid(sizes.1, shaken.1, missing, seed ^ 77);
        let fine = Ground { positions: &fine_places, triangles: &fine };
        let coarse = Ground { positions: &coarse_places, triangles: &coarse };
        let (fast_m, slow_m) = (vertical_distance_m(fine, coarse), slowly(fine, coarse));
        prop_assert!((fast_m - slow_m).abs() < 1e-9, "{fast_m} of {slow_m}");
    }
}
