//! Figure 9, table 1 and figure 11: σ of the ground at hand, the tables of bands, the error that the rule expects.

use glam::DVec2;
use yamanami_core::{FieldLevel, MapView};
use yamanami_lod::{BandRule, BandTable, MiddleReading, SlopeDeviation, band_error_px};
use yamanami_measure::{SigmaRow, slope_sigma};

/// Half the side of the square in which σ is measured, metres: the paper's is 40 km wide.
const HALF_SQUARE_M: f64 = 20_000.0;
/// Longest hypotenuse of figure 9, metres.
const LONGEST_M: f64 = 18_200.0;
/// Distance between two points of figure 11, metres.
const STEP_M: f64 = 250.0;

/// What the paper's rule makes of a ground.
#[derive(Debug)]
pub(super) struct Tables {
    /// Middle of the square, metres east and north of the eye.
    pub(super) square: DVec2,
    /// σ in the square, the roughest of the map, as the paper takes a rough one.
    pub(super) rough: Vec<SigmaRow>,
    /// σ over all of the map.
    pub(super) all: Vec<SigmaRow>,
    pub(super) printed: BandTable,
    /// By the rule, on this ground, counting height alone…
    pub(super) measured: BandTable,
    /// … and with what the projection bends.
    pub(super) bent: BandTable,
    /// Figure 11: distance (m) and expected error (px) under the printed and both measured tables; of height alone, and in
    /// the last with the bend.
    pub(super) expected: [Vec<[f64; 2]>; 3],
}

impl Tables {
    pub(super) fn measure(grid: &FieldLevel, view: &MapView) -> Self {
        let (square, rough) = roughest(grid, view.rim_m);
        let shown =
            |rows: Vec<SigmaRow>| rows.into_iter().filter(|row| row.hypotenuse_m <= LONGEST_M).collect::<Vec<_>>();
        let rough = shown(rough);
        let all = shown(slope_sigma(grid, DVec2::ZERO, view.rim_m));
        let deviations: Vec<SlopeDeviation> =
            rough.iter().map(|row| SlopeDeviation { hypotenuse_m: row.hypotenuse_m, sigma: row.sigma }).collect();
        let rule = BandRule { rim_m: view.rim_m, ..BandRule::paper(view.ring_px) };
        let printed = BandTable::paper();
        let of = |reading| BandTable::measured(&view.map, &BandRule { reading, ..rule }, &deviations);
        let (measured, bent) = (of(MiddleReading::Ground), of(MiddleReading::Hypotenuse));
        let expected = [
            (&printed, MiddleReading::Ground),
            (&measured, MiddleReading::Ground),
            (&bent, MiddleReading::Hypotenuse),
        ]
        .map(|(table, reading)| expected(table, view, &deviations, reading));
        Self { square, rough, all, printed, measured, bent, expected }
    }
}

/// The square within the rim whose σ(0.8 km), or of the length next to it, is greatest.
fn roughest(grid: &FieldLevel, rim_m: f64) -> (DVec2, Vec<SigmaRow>) {
    let n = ((rim_m - HALF_SQUARE_M) / HALF_SQUARE_M).floor().max(0.0) as i32;
    let places = (-n..=n).flat_map(|i| (-n..=n).map(move |j| HALF_SQUARE_M * DVec2::new(f64::from(i), f64::from(j))));
    let inside = |p: &DVec2| p.length() + HALF_SQUARE_M <= rim_m.max(HALF_SQUARE_M);
    let rows = |p: DVec2| (p, slope_sigma(grid, p, HALF_SQUARE_M));
    let roughness = |rows: &[SigmaRow]| {
        rows.iter().min_by_key(|r| (r.hypotenuse_m - 800.0).abs() as u64).map_or(0.0, |row| row.sigma)
    };
    let all: Vec<_> = places.filter(inside).map(rows).collect();
    all.into_iter().max_by(|a, b| roughness(&a.1).total_cmp(&roughness(&b.1))).unwrap_or_default()
}

/// e by distance: of the triangles that the table draws there.
fn expected(table: &BandTable, view: &MapView, deviations: &[SlopeDeviation], reading: MiddleReading) -> Vec<[f64; 2]> {
    let steps = (view.rim_m / STEP_M) as usize;
    let error_px = |r_m: f64| {
        let drawn_m = yamanami_lod::hypotenuse_m(table.block_m, table.level_at(r_m));
        let deviation = deviations.iter().find(|d| (d.hypotenuse_m / drawn_m - 1.0).abs() < 0.01)?;
        Some(band_error_px(&view.map, view.ring_px, *deviation, r_m, reading))
    };
    (0..steps).map(|i| STEP_M * i as f64).map(|r_m| [r_m, error_px(r_m).unwrap_or(0.0)]).collect()
}
