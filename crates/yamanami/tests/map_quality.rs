//! The engine's front against the paper's bands at equal triangles, on a made ground: every sample's true error in the picture.
//!
//! Half the paper's radius at twice its spacing; the bands keep their own heights (the paper's lifted ones are further off).

use glam::DVec2;
use yamanami::core::{DeformedMap, FieldLevel, MapView, NestedField};
use yamanami::measure::{PixelErrors, projected_error, slope_sigma};
use yamanami::multires::rtin::band_mesh::{BandMeshOptions, PeakRule, band_mesh};
use yamanami::multires::rtin::{BuildOptions, Rtin};
use yamanami::{BandRule, BandTable, Criteria, MapCriterion, SlopeDeviation};
use yamanami_core::Surface;
use yamanami_testkit::nested_ground;

const SPACING_M: f64 = 400.0;
const HALF: u32 = 200;
/// What slopes over four samples are to hide.
const SIGMA: f64 = 0.1;

/// Rough ground; all below its middle height is sea if asked for.
fn ground(half_is_sea: bool) -> FieldLevel {
    let made = nested_ground(&[HALF], SPACING_M, 1000.0, 31);
    let grid = made.widest();
    let four = slope_sigma(grid, DVec2::ZERO, 1e9);
    let four = four.iter().find(|row| (row.hypotenuse_m / SPACING_M - 4.0).abs() < 0.01).unwrap();
    let mut sorted = grid.heights_m().to_vec();
    sorted.sort_unstable_by(f32::total_cmp);
    let (factor, middle) = ((SIGMA / four.sigma) as f32, sorted[sorted.len() / 2]);
    let sea = if half_is_sea { 0.0 } else { f32::NEG_INFINITY };
    FieldLevel::new(SPACING_M, HALF, grid.heights_m().iter().map(|z| (factor * (z - middle)).max(sea)).collect())
}

struct Compared {
    view: MapView,
    grid: FieldLevel,
    rtin: Rtin,
    triangles: u32,
    bands: PixelErrors,
}

impl Compared {
    fn new(half_is_sea: bool) -> Self {
        let grid = ground(half_is_sea);
        let top_m = f64::from(grid.heights_m().iter().copied().fold(0.0, f32::max));
        let view = MapView::fitted(DeformedMap::default(), [1300, 1300], grid.reach_m() - 3_200.0, top_m, 0.0);
        let sigma = slope_sigma(&grid, DVec2::ZERO, 1e9);
        let sigma: Vec<_> =
            sigma.iter().map(|s| SlopeDeviation { hypotenuse_m: s.hypotenuse_m, sigma: s.sigma }).collect();
        let table =
            BandTable::measured(&view.map, &BandRule { rim_m: view.rim_m, ..BandRule::paper(view.ring_px) }, &sigma);
        let options =
            BandMeshOptions { eye: DVec2::ZERO, block_m: table.block_m, reach_m: view.rim_m, peaks: PeakRule::None };
        let bands = band_mesh(&grid, &options, |r_m| table.level_at(r_m), &[]).unwrap();
        let errors = projected_error(&view, &grid, &bands.mesh.positions, &bands.mesh.triangles).all;
        let rtin = Rtin::build(NestedField::new(vec![grid.clone()]), &BuildOptions::default()).unwrap();
        println!("bands: {table:?}, {} triangles, {errors:?}", bands.mesh.triangles.len());
        Self { view, grid, rtin, triangles: bands.mesh.triangles.len() as u32, bands: errors }
    }

    /// True errors of the engine's front of so many triangles at most.
    fn engine(&self, budget: u32) -> PixelErrors {
        let criteria = Criteria {
            map: Some(MapCriterion { view: self.view, tolerance_px: 0.0 }),
            budget_triangles: Some(budget),
            ..Criteria::default()
        };
        let front = yamanami_lod::extract(&self.rtin, &criteria);
        assert!(front.triangle_count() <= budget as usize);
        let mesh = self.rtin.mesh_of(&front);
        let errors = projected_error(&self.view, &self.grid, &mesh.positions, &mesh.triangles).all;
        println!("engine: {} triangles, {errors:?}", front.triangle_count());
        errors
    }
}

#[test]
fn at_equal_triangles_the_worst_is_a_third_and_large_errors_a_tenth() {
    let compared = Compared::new(false);
    let engine = compared.engine(compared.triangles);
    assert!(compared.bands.over_large > 0.0, "the bands have large errors");
    assert!(engine.over_large <= 0.1 * compared.bands.over_large, "{engine:?}, {:?}", compared.bands);
    assert!(3.0 * engine.max_px <= compared.bands.max_px, "{engine:?}, {:?}", compared.bands);
}

#[test]
fn with_half_the_area_sea_few_triangles_do() {
    let compared = Compared::new(true);
    let engine = compared.engine((0.45 * f64::from(compared.triangles)) as u32);
    assert!(engine.rms_px <= compared.bands.rms_px, "{engine:?}, {:?}", compared.bands);
}
