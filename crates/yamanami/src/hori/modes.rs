//! Figures 13 and 14 in numbers: ways of reducing the map by bands of distance, with the true error of every sample.

use super::peaks::{MIN_PROMINENCE_M, SummitErrors};
use super::table::Tables;
use crate::Error;
use glam::DVec2;
use yamanami_core::{FieldLevel, MapView};
use yamanami_lod::{BandTable, PAPER_BLOCK_M};
use yamanami_measure::{ProjectedReport, projected_error};
use yamanami_multires::rtin::Summit;
use yamanami_multires::rtin::band_mesh::{BandMesh, BandMeshOptions, PAPER_REACH_M, PeakRule, band_mesh};

/// A way of reducing the map.
#[derive(Debug, Clone)]
pub struct HoriMode {
    /// What it is.
    pub name: &'static str,
    /// For file names.
    pub file: &'static str,
    /// Triangles of the paper's blocks in full.
    pub full_triangles: u64,
    /// All triangles of its mesh.
    pub triangles: u64,
    /// What it promises for every sample, pixels; the bands promise nothing.
    pub bound_px: Option<f64>,
    /// The true errors of all samples.
    pub report: ProjectedReport,
    /// How summits are drawn: by the vertices that stand for them, or, in the engine's meshes, by the ground at their
    /// places.
    pub(super) summits: SummitErrors,
}

/// A table, a rule for peaks, and names.
pub(super) type Way<'a> = (&'a BandTable, PeakRule, &'static str, &'static str);

/// The paper's way, and its table with own heights.
pub(super) fn two_ways(tables: &Tables) -> [Way<'_>; 2] {
    [
        (&tables.printed, PeakRule::Paper, "table 1, the paper's peaks", "printed_paper"),
        (&tables.printed, PeakRule::None, "table 1, own heights", "printed_none"),
    ]
}

/// All ways; the first two are those of [`two_ways`].
pub(super) fn all_ways(tables: &Tables) -> [Way<'_>; 6] {
    let ours = PeakRule::Summits { min_prominence_m: MIN_PROMINENCE_M };
    let [paper, none] = two_ways(tables);
    [
        paper,
        none,
        (&tables.printed, ours, "table 1, summits alone", "printed_summits"),
        (&tables.measured, PeakRule::Paper, "measured table, the paper's peaks", "measured_paper"),
        (&tables.measured, PeakRule::None, "measured table, own heights", "measured_none"),
        (&tables.bent, PeakRule::None, "measured table with bend, own heights", "bent_none"),
    ]
}

/// The mesh of a way.
pub(super) fn mesh_of(
    grid: &FieldLevel,
    view: &MapView,
    table: &BandTable,
    peaks: PeakRule,
    summits: &[Summit],
) -> Result<BandMesh, Error> {
    let reach_m = PAPER_REACH_M.min(view.rim_m);
    let options = BandMeshOptions { eye: DVec2::ZERO, block_m: PAPER_BLOCK_M, reach_m, peaks };
    Ok(band_mesh(grid, &options, |r_m| table.level_at(r_m), summits)?)
}

pub(super) fn measure(
    grid: &FieldLevel,
    view: &MapView,
    ways: &[Way<'_>],
    summits: &[Summit],
) -> Result<Vec<HoriMode>, Error> {
    let side = (PAPER_BLOCK_M / grid.spacing_m()).round() as u64;
    let one = |&(table, peaks, name, file): &Way<'_>| {
        let built = mesh_of(grid, view, table, peaks, summits)?;
        Ok(HoriMode {
            name,
            file,
            full_triangles: built.blocks as u64 * 2 * side * side,
            triangles: built.mesh.triangles.len() as u64,
            bound_px: None,
            report: projected_error(view, grid, &built.mesh.positions, &built.mesh.triangles),
            summits: SummitErrors::of(built.summit_errors(grid, summits).into_iter().flatten()),
        })
    };
    ways.iter().map(one).collect()
}
