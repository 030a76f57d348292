//! The engine beside the paper's bands: at their count of triangles, at pixel tolerances, and at their mean error.
//!
//! Every triangle of the engine's mesh counts, those beyond the rim too. Errors are judged by the same measure as the
//! bands', which knows nothing of the engine's bounds.

use super::modes::HoriMode;
use super::peaks::SummitErrors;
use super::{PAPER_TRIANGLES, Study};
use crate::Error;
use yamanami_measure::{LARGE_PX, SPLIT_PX, projected_error};
use yamanami_multires::rtin::band_mesh::SummitError;

/// Tries for the count of equal error: it is met within a part in fifty.
const TRIES: u32 = 7;
/// The count of equal error is looked for between these shares of the bands' count.
const SHARES: [f64; 2] = [0.05, 1.5];

/// File names of the ways that the page compares.
pub(super) const EQUAL_COUNT: &str = "engine_equal";
pub(super) const EQUAL_RMS: &str = "engine_rms";

/// The engine's ways, beside the bands' (the first the paper's own, the second with own heights).
pub(super) fn measure(study: &mut Study, bands: &[HoriMode]) -> Result<Vec<HoriMode>, Error> {
    let [paper, none, ..] = bands else { return Ok(Vec::new()) };
    let mut modes = Vec::new();
    let [full, reduced] = PAPER_TRIANGLES;
    if paper.full_triangles == full {
        modes.push(one(study, paper, ("engine, the paper's 77,128", "engine_paper"), 0.0, Some(reduced as u32))?);
    }
    let count = paper.triangles as u32;
    modes.push(one(study, paper, ("engine, as many as the bands", EQUAL_COUNT), 0.0, Some(count))?);
    modes.push(one(study, paper, ("engine, 1.5 px", "engine_1_5px"), SPLIT_PX as f32, None)?);
    modes.push(one(study, paper, ("engine, 3.5 px", "engine_3_5px"), LARGE_PX as f32, None)?);
    // fewer triangles, greater error: the fewest that do no worse than the bands with own heights
    let mut shares = SHARES;
    let mut best = None;
    for _ in 0..TRIES {
        let share = (shares[0] * shares[1]).sqrt();
        let budget = (share * paper.triangles as f64) as u32;
        let tried = one(study, paper, ("engine, as exact as the bands", EQUAL_RMS), 0.0, Some(budget))?;
        let is_enough = tried.report.far.rms_px <= none.report.far.rms_px;
        shares[usize::from(is_enough)] = share;
        if is_enough {
            best = Some(tried);
        }
    }
    modes.extend(best);
    Ok(modes)
}

/// Shows the engine's front and measures it.
fn one(
    study: &mut Study,
    paper: &HoriMode,
    (name, file): (&'static str, &'static str),
    tolerance_px: f32,
    budget: Option<u32>,
) -> Result<HoriMode, Error> {
    let bound_px = study.scene.update(&study.view, tolerance_px, budget)?.report.error_left;
    let mesh = study.scene.mesh();
    let (scene, grid) = (&study.scene, study.grid());
    let as_drawn = |summit: &yamanami_multires::rtin::Summit| {
        let place = grid.plane_from_grid(summit.column, summit.row);
        let drawn_m = scene.surface().front_at(scene.front(), place).height_m;
        SummitError { height_error_m: drawn_m - f64::from(summit.height_m), shift_m: 0.0 }
    };
    Ok(HoriMode {
        name,
        file,
        full_triangles: paper.full_triangles,
        triangles: mesh.triangles.len() as u64,
        bound_px: Some(f64::from(bound_px)),
        report: projected_error(&study.view, grid, &mesh.positions, &mesh.triangles),
        summits: SummitErrors::of(study.summits.iter().map(as_drawn)),
    })
}

impl HoriMode {
    /// Whether no sample is drawn further from its place than promised; none where nothing is promised. Pictures are
    /// measured to a ten thousandth of a pixel.
    pub fn keeps_bound(&self) -> Option<bool> {
        self.bound_px.map(|bound_px| self.report.all.max_px <= bound_px + 1e-4)
    }
}
