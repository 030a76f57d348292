//! Tests of the band mesh: counts, conformity, direction, peaks.

use super::*;
use proptest::prelude::*;
use std::collections::HashSet;
use yamanami_testkit::laws::Kind;
use yamanami_testkit::{Shape, Spacing, SyntheticTerrain, check_conforming};

/// Levels of the paper's table 1 by distance.
fn paper_level(r_m: f64) -> u32 {
    let ends = [(3.2, 4), (35.0, 7), (56.0, 6), (76.0, 5), (100.0, 4), (123.0, 3), (145.0, 2)];
    ends.into_iter().find(|&(far_km, _)| r_m < 1e3 * far_km).map_or(1, |(_, level)| level)
}

fn ground(half: u32) -> FieldLevel {
    let width = 2 * half as usize + 1;
    let shape = Shape::Fractal { relief_m: 2_500.0, roughness: 0.5, seed: 5 };
    let field = SyntheticTerrain::new(width, width, shape, Spacing::Metres(200.0)).to_field();
    FieldLevel::new(200.0, half, field.into_heights_m())
}

fn options(reach_m: f64) -> BandMeshOptions {
    BandMeshOptions { eye: DVec2::ZERO, block_m: 6_400.0, reach_m, peaks: PeakRule::None }
}

fn build(grid: &FieldLevel, options: &BandMeshOptions, level_at: impl Fn(f64) -> u32) -> BandMesh {
    band_mesh(grid, options, level_at, &[]).unwrap()
}

fn conforms(grid: &FieldLevel, options: &BandMeshOptions, built: &BandMesh) {
    let coarsest = build(grid, options, |_| 1);
    check_conforming(&built.mesh, &coarsest.mesh, Kind::Terrain).unwrap();
}

#[test]
fn the_papers_table_gives_its_triangles() {
    let grid = ground(816);
    let options = options(PAPER_REACH_M);
    let built = build(&grid, &options, paper_level);
    assert_eq!((built.blocks, built.missing_blocks), (1_933, 0));
    // 77,360, and what joins the bands
    assert_eq!(built.mesh.triangles.len(), 77_360 + 740);
    conforms(&grid, &options, &built);
}

#[test]
fn a_block_of_a_level_is_halved_so_often() {
    let grid = ground(64);
    for level in 0..=12 {
        let built = build(&grid, &options(6_400.0), |_| level);
        let level = level.clamp(1, 10);
        assert_eq!((built.blocks, built.mesh.triangles.len()), (5, 5 << (level + 1)), "level {level}");
        assert!(built.levels.iter().all(|&l| u32::from(l) == level));
    }
}

#[test]
fn triangles_are_right_isosceles_of_their_level_and_point_outwards() {
    let grid = ground(400);
    let built = build(&grid, &options(70_000.0), |r_m| if r_m < 30_000.0 { 6 } else { 5 });
    let mut along = [0, 0];
    for (t, &level) in built.levels.iter().enumerate() {
        let corners = built.mesh.corners(t).map(glam::DVec3::truncate);
        let [a, b, c] = corners;
        assert!((b - a).perp_dot(c - a) > 0.0, "clockwise");
        assert!((b - a).dot(c - a).abs() < 1e-6 && ((b - a).length() - (c - a).length()).abs() < 1e-6);
        assert!((b.distance(c) - built.hypotenuse_m(level)).abs() < 1e-6);
        if level == 6 {
            let (out, hypotenuse) = (0.5 * (b + c), (c - b).normalize());
            along[usize::from(out.normalize().dot(hypotenuse).abs() > 0.7)] += 1;
        }
    }
    assert!(along[0] * 20 < along[1], "{along:?}");
}

#[test]
fn what_is_off_the_grid_is_said_and_left_out() {
    let grid = ground(64);
    let aside = BandMeshOptions { eye: DVec2::new(9_000.0, 0.0), ..options(20_000.0) };
    let built = build(&grid, &aside, |_| 4);
    assert!(built.blocks > 2 && built.missing_blocks > 2);
    conforms(&grid, &aside, &built);
    let far = BandMeshOptions { eye: DVec2::new(9e99, f64::NAN), ..aside };
    assert_eq!(build(&grid, &far, |_| 4).mesh.triangles.len(), 0);
    for (block_m, reach_m) in [(6_401.0, 1e4), (200.0, 1e4), (f64::NAN, 1e4), (6_400.0, 1e12), (6_400.0, f64::NAN)] {
        let odd = BandMeshOptions { block_m, reach_m, ..aside };
        assert!(band_mesh(&grid, &odd, |_| 4, &[]).is_err() || reach_m.is_nan(), "{odd:?}");
    }
}

#[test]
fn every_sample_finds_its_triangle() {
    let grid = ground(96);
    let built = build(&grid, &options(13_000.0), |r_m| if r_m < 6_000.0 { 2 } else { 5 });
    let mut found = HashSet::new();
    let mut covered = 0;
    for (column, row) in (0..grid.width()).flat_map(|c| (0..grid.width()).map(move |r| (c, r))) {
        if let Some(t) = built.triangle_over(column, row) {
            let corners = built.mesh.triangles[t].map(|v| built.samples[v as usize].map(i64::from));
            assert!(peaks::holds(corners, [column as i64, row as i64]));
            found.insert(t);
            covered += 1;
        }
    }
    assert_eq!(found.len(), built.mesh.triangles.len());
    // 13 blocks in a diamond of 5 across: 32² samples each, and borders
    assert!(covered > 13 * 1_024 && covered < 13 * 1_089, "{covered}");
}

#[test]
fn the_papers_rule_takes_the_highest_or_the_lowest() {
    let width = 129;
    let z = |k: usize| if k % width < 66 { 10.0 + (k % 7) as f32 } else { 100.0 + (k % 11) as f32 };
    let grid = FieldLevel::new(200.0, 64, (0..width * width).map(z).collect());
    let paper = BandMeshOptions { peaks: PeakRule::Paper, ..options(9_100.0) };
    let built = build(&grid, &paper, |_| 1);
    for (p, &[column, _]) in built.mesh.positions.iter().zip(&built.samples) {
        let expected = if column <= 48 { 10.0 } else { 110.0 };
        assert_eq!(p.z, expected, "column {column}");
    }
}

#[test]
fn summits_alone_move_and_carry_their_ridge() {
    // two cones joined by a ridge along a row that holds no vertex
    let width = 129usize;
    let height = |column: usize, row: usize| {
        let cone = |c: f64| 1_000.0 - 100.0 * (column as f64 - c).hypot(row as f64 - 55.0);
        let ridge = 900.0 - 60.0 * (row as f64 - 55.0).abs() - 5.0 * (12.0 - (column as f64 - 61.0).abs()).max(0.0);
        let between = (49..=73).contains(&column);
        cone(49.0).max(cone(73.0)).max(if between { ridge } else { 0.0 }).max(0.0) as f32
    };
    let grid = FieldLevel::new(200.0, 64, (0..width * width).map(|k| height(k % width, k / width)).collect());
    let summit = |column: usize| Summit {
        column,
        row: 55,
        height_m: height(column, 55),
        prominence_m: 160.0,
        saddle: Some([61, 55]),
    };
    let summits = [summit(49), summit(73)];
    let make =
        |peaks: PeakRule| band_mesh(&grid, &BandMeshOptions { peaks, ..options(9_100.0) }, |_| 5, &summits).unwrap();
    let (none, ours, paper) =
        (make(PeakRule::None), make(PeakRule::Summits { min_prominence_m: 100.0 }), make(PeakRule::Paper));
    for error in ours.summit_errors(&grid, &summits) {
        let error = error.unwrap();
        assert!(error.height_error_m == 0.0 && error.shift_m > 0.0 && error.shift_m < 1_200.0, "{error:?}");
    }
    assert!(none.summit_errors(&grid, &summits).iter().all(|e| e.unwrap().height_error_m < -50.0));
    let moved = |other: &BandMesh| {
        other.mesh.positions.iter().zip(&none.mesh.positions).filter(|(p, q)| (p.z - q.z).abs() > 0.0).count()
    };
    assert!(moved(&ours) >= 4 && moved(&ours) * 4 < moved(&paper), "{} {}", moved(&ours), moved(&paper));
    let strict = make(PeakRule::Summits { min_prominence_m: 200.0 });
    assert_eq!(moved(&strict), 0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn any_levels_side_by_side_conform(seed in 0u64..1 << 40, reach_m in 6_400.0..24_000.0f64) {
        let grid = ground(160);
        let options = options(reach_m);
        let level = |r_m: f64| 1 + ((r_m as u64 / 3 + 1).wrapping_mul(seed | 1) >> 7) as u32 % 10;
        let built = build(&grid, &options, level);
        conforms(&grid, &options, &built);
        let least: usize = built.layout.levels.iter().filter(|&&l| l > 0).map(|&l| 2usize << l).sum();
        prop_assert!(built.mesh.triangles.len() >= least);
    }
}
