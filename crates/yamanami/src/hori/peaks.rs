//! Figure 12 in numbers: a mesh of 6,400 m spacing under each rule for peaks.

use crate::Error;
use glam::DVec2;
use yamanami_core::{FieldLevel, MapView};
use yamanami_measure::projected_error;
use yamanami_multires::rtin::band_mesh::{BandMeshOptions, PAPER_REACH_M, PeakRule, Summit, band_mesh};

/// Blocks of twice the spacing, halved twice: squares of 6,400 m in two triangles each.
const BLOCK_M: f64 = 12_800.0;
const LEVEL: u32 = 2;

/// Least prominence of the summits that count and move, metres.
pub(crate) const MIN_PROMINENCE_M: f64 = 100.0;

/// The rules, with their names in tables.
pub(crate) const RULES: [(PeakRule, &str); 3] = [
    (PeakRule::None, "own height"),
    (PeakRule::Paper, "the paper's: highest or lowest of the cell"),
    (PeakRule::Summits { min_prominence_m: MIN_PROMINENCE_M }, "summits and ridges alone"),
];

/// What a rule does.
#[derive(Debug, Clone)]
pub(crate) struct PeakRow {
    pub(crate) rule: &'static str,
    pub(crate) triangles: usize,
    /// Vertical distance of all samples to the mesh: root of the mean square, and mean (above is positive), metres.
    pub(crate) height_rms_m: f64,
    pub(crate) height_bias_m: f64,
    pub(crate) summits: SummitErrors,
}

/// How far summits are from where they are drawn.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct SummitErrors {
    pub(crate) count: usize,
    pub(crate) height_rms_m: f64,
    /// Of the summit that is drawn lowest, as against its own height.
    pub(crate) lowest_m: f64,
    pub(crate) shift_mean_m: f64,
    pub(crate) shift_max_m: f64,
}

pub(crate) fn measure(grid: &FieldLevel, view: &MapView, summits: &[Summit]) -> Result<Vec<PeakRow>, Error> {
    let counted: Vec<Summit> = summits.iter().copied().filter(|s| s.prominence_m >= MIN_PROMINENCE_M).collect();
    let row = |(peaks, rule)| {
        let reach_m = PAPER_REACH_M.min(view.rim_m);
        let options = BandMeshOptions { eye: DVec2::ZERO, block_m: BLOCK_M, reach_m, peaks };
        let built = band_mesh(grid, &options, |_| LEVEL, &counted)?;
        let report = projected_error(view, grid, &built.mesh.positions, &built.mesh.triangles);
        Ok(PeakRow {
            rule,
            triangles: built.mesh.triangles.len(),
            height_rms_m: report.height_rms_m,
            height_bias_m: report.height_bias_m,
            summits: SummitErrors::of(built.summit_errors(grid, &counted).into_iter().flatten()),
        })
    };
    RULES.into_iter().map(row).collect()
}

impl SummitErrors {
    pub(crate) fn of(errors: impl Iterator<Item = yamanami_multires::rtin::band_mesh::SummitError>) -> Self {
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
