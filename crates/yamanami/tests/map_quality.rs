//! The engine's front against the paper's bands at equal triangles, on a made ground: every sample's true error in the picture.
//!
//! The paper's map and printed table at twice its spacing; the bands keep their own heights (its lifted ones are further off).

use glam::DVec2;
use yamanami::core::{DeformedMap, FieldLevel, MapView, NestedField};
use yamanami::measure::{projected_error, slope_sigma};
use yamanami::multires::rtin::BuildOptions;
use yamanami::multires::rtin::band_mesh::{BandMeshOptions, PAPER_REACH_M, PeakRule, band_mesh};
use yamanami::{BandTable, DeformedScene, DrawWith};
use yamanami_testkit::nested_ground;

const SPACING_M: f64 = 400.0;
const HALF: u32 = 400;
/// What slopes over four samples are to hide.
const SIGMA: f64 = 0.15;

/// Rough ground around sea level.
fn ground() -> FieldLevel {
    let made = nested_ground(&[HALF], SPACING_M, 1000.0, 31);
    let grid = made.widest();
    let four = slope_sigma(grid, DVec2::ZERO, 1e9);
    let four = four.iter().find(|row| (row.hypotenuse_m / SPACING_M - 4.0).abs() < 0.01).unwrap();
    let mut sorted = grid.heights_m().to_vec();
    sorted.sort_unstable_by(f32::total_cmp);
    let (factor, middle) = ((SIGMA / four.sigma) as f32, sorted[sorted.len() / 2]);
    FieldLevel::new(SPACING_M, HALF, grid.heights_m().iter().map(|z| factor * (z - middle)).collect())
}

#[test]
fn at_equal_triangles_the_worst_is_a_third_and_large_errors_a_tenth() {
    let (grid, table) = (ground(), BandTable::paper());
    let [_, top_m] = NestedField::new(vec![grid.clone()]).range_m().map(f64::from);
    let view = MapView::fitted(DeformedMap::default(), [1300, 1300], PAPER_REACH_M, top_m, 0.0);
    let options =
        BandMeshOptions { eye: DVec2::ZERO, block_m: table.block_m, reach_m: PAPER_REACH_M, peaks: PeakRule::None };
    let bands = band_mesh(&grid, &options, |r_m| table.level_at(r_m), &[]).unwrap();
    let budget = bands.mesh.triangles.len();
    let bands = projected_error(&view, &grid, &bands.mesh.positions, &bands.mesh.triangles).all;

    let mut scene =
        DeformedScene::new(NestedField::new(vec![grid]), &BuildOptions::default(), DrawWith::Software).unwrap();
    scene.check(&view.map).unwrap();
    let report = scene.update(&view, 0.0, Some(budget as u32)).unwrap().report;
    let engine = scene.measure(&view);
    println!("{budget} triangles of the bands: {bands:?}\n{} of the engine: {engine:?}", report.triangles);
    assert!(report.triangles <= budget && engine.samples >= bands.samples);
    assert!(bands.over_large > 0.0 && engine.over_large <= 0.1 * bands.over_large);
    assert!(3.0 * engine.max_px <= bands.max_px);
}
