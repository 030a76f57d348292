//! Figure 12 in numbers: a mesh of 6,400 m spacing under each rule for peaks.

use crate::Error;
use glam::DVec2;
use yamanami_core::{FieldLevel, MapView};
use yamanami_measure::projected_error;
use yamanami_multires::rtin::Summit;
use yamanami_multires::rtin::band_mesh::{BandMesh, BandMeshOptions, PAPER_REACH_M, PeakRule, SummitError, band_mesh};

/// Blocks of twice the spacing, halved twice: squares of 6,400 m in two triangles each.
const BLOCK_M: f64 = 12_800.0;
const LEVEL: u32 = 2;

/// Least prominence of the summits that count and move, metres.
pub(super) const MIN_PROMINENCE_M: f64 = 100.0;

/// The rules, with their names in tables.
pub(super) const RULES: [(PeakRule, &str); 3] = [
    (PeakRule::None, "own height"),
    (PeakRule::Paper, "the paper's: highest or lowest of the cell"),
    (PeakRule::Summits { min_prominence_m: MIN_PROMINENCE_M }, "summits and ridges alone"),
];

/// What a rule does.
#[derive(Debug, Clone)]
pub(super) struct PeakRow {
    pub(super) rule: &'static str,
    pub(super) triangles: usize,
    /// Vertical distance of all samples to the mesh: root of the mean square, and mean (above is positive), metres.
    pub(super) height_rms_m: f64,
    pub(super) height_bias_m: f64,
    pub(super) summits: SummitErrors,
}

/// How far summits are from where they are drawn.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct SummitErrors {
    pub(super) count: usize,
    pub(super) height_rms_m: f64,
    /// Of the summit that is drawn lowest, as against its own height.
    pub(super) lowest_m: f64,
    pub(super) shift_mean_m: f64,
    pub(super) shift_max_m: f64,
}

/// The mesh of 6,400 m under a rule.
pub(super) fn mesh_of_rule(
    grid: &FieldLevel,
    view: &MapView,
    peaks: PeakRule,
    summits: &[Summit],
) -> Result<BandMesh, Error> {
    let reach_m = PAPER_REACH_M.min(view.rim_m);
    let options = BandMeshOptions { eye: DVec2::ZERO, block_m: BLOCK_M, reach_m, peaks };
    Ok(band_mesh(grid, &options, |_| LEVEL, summits)?)
}

pub(super) fn measure(grid: &FieldLevel, view: &MapView, summits: &[Summit]) -> Result<Vec<PeakRow>, Error> {
    let row = |(peaks, rule)| {
        let built = mesh_of_rule(grid, view, peaks, summits)?;
        let report = projected_error(view, grid, &built.mesh.positions, &built.mesh.triangles);
        Ok(PeakRow {
            rule,
            triangles: built.mesh.triangles.len(),
            height_rms_m: report.height_rms_m,
            height_bias_m: report.height_bias_m,
            summits: SummitErrors::of(built.summit_errors(grid, summits).into_iter().flatten()),
        })
    };
    RULES.into_iter().map(row).collect()
}

impl SummitErrors {
    pub(super) fn of(errors: impl Iterator<Item = SummitError>) -> Self {
        let mut all = Self::default();
        for error in errors {
            all.count += 1;
            all.height_rms_m += error.height_error_m.powi(2);
            all.lowest_m = all.lowest_m.min(error.height_error_m);
            all.shift_mean_m += error.shift_m;
            all.shift_max_m = all.shift_max_m.max(error.shift_m);
        }
        let count = all.count.max(1) as f64;
        all.height_rms_m = (all.height_rms_m / count).sqrt();
        all.shift_mean_m /= count;
        all
    }
}
