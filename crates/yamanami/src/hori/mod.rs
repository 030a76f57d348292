//! hori's experiment: a deformed map of 160 km by bands of distance, on any ground.
//!
//! Based on: Hori, Okajima, Miyamura, Furuya, Saito, "LoD control for large-area deformed map" (広域を表現できるデフォルメ地図の詳細度制御).
//! Figures 9, 11, 12 and 14, table 1 and the polygon counts. [`study`] measures, `page` tells; what draws, and what other
//! modes do, enters through [`Findings::modes`] and [`Findings::pictures`].

mod modes;
mod page;
mod peaks;
mod table;

use crate::Error;
use glam::DVec2;
use modes::Mode;
use peaks::PeakRow;
use std::path::{Path, PathBuf};
use table::Tables;
use yamanami_core::{DeformedMap, FieldLevel, MapView, NestedField};
use yamanami_multires::rtin::band_mesh::Summit;

/// The paper's radius, metres.
const RIM_M: f64 = 160_000.0;
/// Width and height of the picture: the plain map is 330 px in radius, the numbers of which are known for other ground.
const PICTURE_PX: [u32; 2] = [1300, 1300];
/// The paper's triangles, in full and by its table.
const PAPER_TRIANGLES: [u64; 2] = [3_958_784, 77_128];

/// A picture beside the page.
#[derive(Debug, Clone)]
pub(crate) struct Shown {
    /// The paper's figure it stands for: `12`, `13`.
    pub(crate) figure: &'static str,
    /// File name in the page's folder.
    pub(crate) file: String,
    /// What it shows.
    pub(crate) caption: String,
}

/// What was found.
#[derive(Debug)]
pub(crate) struct Findings {
    pub(crate) title: String,
    /// Share of the disc that has data, 0 to 1.
    pub(crate) known_share: f64,
    pub(crate) view: MapView,
    pub(crate) spacing_m: f64,
    pub(crate) tables: Tables,
    /// Figure 12: the coarsest mesh under each rule for peaks.
    pub(crate) peaks: Vec<PeakRow>,
    /// Ways of reducing the map, each with its triangles and true errors.
    pub(crate) modes: Vec<Mode>,
    pub(crate) pictures: Vec<Shown>,
}

/// Runs the experiment and writes `index.html`, `hori.md`, tables (CSV) and plots into `out`; gives the page's path.
/// `field` is the ground around the eye, which stands at (0, 0); `summits` are its true summits. `progress` hears what is
/// being done.
pub fn hori(
    field: &NestedField,
    summits: &[Summit],
    title: String,
    out: &Path,
    progress: &dyn Fn(&str),
) -> Result<PathBuf, Error> {
    std::fs::create_dir_all(out).map_err(|source| Error::File { path: out.to_owned(), source })?;
    let found = study(field, summits, title, progress)?;
    progress("writing the page");
    page::write(&found, out)
}

/// All that is measured.
pub(crate) fn study(
    field: &NestedField,
    summits: &[Summit],
    title: String,
    progress: &dyn Fn(&str),
) -> Result<Findings, Error> {
    let grid = ground(field);
    let [_, top_m] = field.range_m().map(f64::from);
    let map = DeformedMap::default();
    let rim_m = RIM_M.min(grid.reach_m());
    let view = MapView::fitted(map, PICTURE_PX, rim_m, top_m, 0.0);
    check_ground(&map, grid)?;
    progress("figure 9: slopes that a size of triangle hides");
    let tables = Tables::measure(grid, &view);
    progress("figure 12: peaks");
    let peaks = peaks::measure(grid, &view, summits)?;
    progress("figure 14: errors by distance");
    let modes = modes::measure(grid, &view, &tables, summits)?;
    Ok(Findings {
        title,
        known_share: field.known_share(DVec2::ZERO, rim_m),
        view,
        spacing_m: grid.spacing_m(),
        tables,
        peaks,
        modes,
        pictures: Vec::new(),
    })
}

/// The finest grid that reaches the paper's radius, or the widest.
fn ground(field: &NestedField) -> &FieldLevel {
    field.levels().iter().rev().find(|level| level.reach_m() >= RIM_M).unwrap_or(field.widest())
}

fn check_ground(map: &DeformedMap, grid: &FieldLevel) -> Result<(), Error> {
    let place = |k: usize| grid.plane_from_grid(k % grid.width(), k / grid.width());
    let points = grid.heights_m().iter().enumerate().map(|(k, &z)| place(k).extend(f64::from(z)));
    map.check_ground(points).map_err(|fault| Error::Request(fault.to_string()))
}
