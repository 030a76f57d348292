//! Figures 13 and 14 in numbers: ways of reducing the map, with the true error of every sample.

use super::peaks::{MIN_PROMINENCE_M, SummitErrors};
use super::table::Tables;
use crate::Error;
use glam::DVec2;
use yamanami_core::{FieldLevel, MapView, TriangleMesh};
use yamanami_lod::{BandTable, PAPER_BLOCK_M};
use yamanami_measure::{ProjectedReport, projected_error};
use yamanami_multires::rtin::band_mesh::{BandMeshOptions, PAPER_REACH_M, PeakRule, Summit, band_mesh};

/// A way of reducing the map.
#[derive(Debug)]
pub(crate) struct Mode {
    pub(crate) name: &'static str,
    /// For file names.
    pub(crate) file: &'static str,
    /// Triangles of the same ground in full.
    pub(crate) full: u64,
    pub(crate) mesh: TriangleMesh,
    pub(crate) report: ProjectedReport,
    /// By the kept vertices that stand for summits, where the way has such.
    pub(crate) summits: Option<SummitErrors>,
}

pub(crate) fn measure(
    grid: &FieldLevel,
    view: &MapView,
    tables: &Tables,
    summits: &[Summit],
) -> Result<Vec<Mode>, Error> {
    let ours = PeakRule::Summits { min_prominence_m: MIN_PROMINENCE_M };
    let (printed, measured, bent) = (&tables.printed, &tables.measured, &tables.bent);
    let ways: [(&BandTable, PeakRule, &str, &str); 6] = [
        (printed, PeakRule::Paper, "table 1, the paper's peaks", "printed_paper"),
        (printed, PeakRule::None, "table 1, own heights", "printed_none"),
        (printed, ours, "table 1, summits alone", "printed_summits"),
        (measured, PeakRule::Paper, "measured table, the paper's peaks", "measured_paper"),
        (measured, PeakRule::None, "measured table, own heights", "measured_none"),
        (bent, PeakRule::None, "measured table with bend, own heights", "bent_none"),
    ];
    let counted: Vec<Summit> = summits.iter().copied().filter(|s| s.prominence_m >= MIN_PROMINENCE_M).collect();
    let one = |(table, peaks, name, file): (&BandTable, _, _, _)| {
        let reach_m = PAPER_REACH_M.min(view.rim_m);
        let options = BandMeshOptions { eye: DVec2::ZERO, block_m: PAPER_BLOCK_M, reach_m, peaks };
        let built = band_mesh(grid, &options, |r_m| table.level_at(r_m), &counted)?;
        let side = (PAPER_BLOCK_M / grid.spacing_m()).round() as u64;
        let report = projected_error(view, grid, &built.mesh.positions, &built.mesh.triangles);
        let summits = SummitErrors::of(built.summit_errors(grid, &counted).into_iter().flatten());
        Ok(Mode {
            name,
            file,
            full: built.blocks as u64 * 2 * side * side,
            mesh: built.mesh,
            report,
            summits: Some(summits),
        })
    };
    ways.into_iter().map(one).collect()
}
