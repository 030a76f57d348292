//! hori's experiment: a deformed map of 160 km by bands of distance and by the engine, on any ground.
//!
//! Based on: Hori, Okajima, Miyamura, Furuya, Saito, "LoD control for large-area deformed map" (広域を表現できるデフォルメ地図の詳細度制御).
//! Figures 9, 11, 12, 13 and 14, table 1, polygon counts and times. [`study`] measures a ground, `pictures` and `drawing`
//! draw it, `page` tells.

mod drawing;
mod engine;
mod modes;
mod page;
mod peaks;
mod pictures;
mod table;

pub use drawing::{HoriDraw, HoriFlight};
pub use modes::HoriMode;

use crate::{DeformedScene, DrawWith, Error, MapImage};
use glam::DVec2;
use std::path::{Path, PathBuf};
use table::Tables;
use yamanami_core::{DeformedMap, FieldLevel, MapLine, MapView, NamedPlace, NestedField};
use yamanami_io::crs::AzimuthalPlane;
use yamanami_multires::rtin::{BuildOptions, Summit, summits};

/// The paper's radius, metres.
const RIM_M: f64 = 160_000.0;
/// The paper's triangles, in full and by its table.
const PAPER_TRIANGLES: [u64; 2] = [3_958_784, 77_128];

/// Ground to be reduced.
#[derive(Debug)]
pub struct HoriGround {
    /// For file names.
    pub name: String,
    /// What it is.
    pub title: String,
    /// Its heights; the eye stands at (0, 0). Of nested grids one is taken: the finest that reaches the rim.
    pub field: NestedField,
}

/// The experiment.
#[derive(Debug)]
pub struct HoriJob {
    /// The ground of all figures.
    pub ground: HoriGround,
    /// Further grounds, which are only measured.
    pub made: Vec<HoriGround>,
    /// Side of the picture, pixels: at 1,300 the plain map is about 330 px in radius.
    pub side_px: u32,
    /// Longitude and latitude of the eye.
    pub centre_lon_lat: Option<DVec2>,
    /// Named places, in the plane.
    pub places: Vec<NamedPlace>,
    /// Rivers, roads, railways, in the plane.
    pub lines: Vec<MapLine>,
    /// A picture for the middle of the map, and the plane it is laid into.
    pub image: Option<(MapImage, AzimuthalPlane)>,
    /// Whose data it shows, one line each.
    pub credits: Vec<String>,
}

/// What was found on a ground.
#[derive(Debug)]
pub struct HoriGroundFound {
    /// For file names.
    pub name: String,
    /// What it is.
    pub title: String,
    /// Share of the disc that has data, 0 to 1.
    pub known_share: f64,
    /// Metres between samples.
    pub spacing_m: f64,
    /// The map.
    pub view: MapView,
    /// Ways of reducing it, each with its triangles and true errors.
    pub modes: Vec<HoriMode>,
    tables: Tables,
}

/// What was found.
#[derive(Debug)]
pub struct HoriFound {
    /// The page.
    pub page: PathBuf,
    /// The job's ground, then those only measured.
    pub grounds: Vec<HoriGroundFound>,
    /// Times of drawing.
    pub draws: Vec<HoriDraw>,
    /// Updates while α and the eye move.
    pub flights: Vec<HoriFlight>,
}

/// A picture beside the page.
#[derive(Debug, Clone)]
struct Shown {
    /// The paper's figure it stands for.
    figure: &'static str,
    /// File name in the page's folder.
    file: String,
    /// What the paper's shows, and what is seen here.
    caption: String,
}

/// Runs the experiment and writes `index.html`, `hori.md`, tables (CSV), plots and pictures into `out`. `progress` hears of
/// what is being done.
pub fn hori(mut job: HoriJob, out: &Path, progress: &dyn Fn(&str)) -> Result<HoriFound, Error> {
    std::fs::create_dir_all(out).map_err(|source| Error::File { path: out.to_owned(), source })?;
    progress("figure 9: slopes that a size of triangle hides");
    let mut main = Study::new(job.ground.field.clone(), job.side_px)?;
    progress("figure 12: peaks");
    let peaks = peaks::measure(main.grid(), &main.view, &main.summits)?;
    progress("figure 13: the paper's bands");
    let mut modes = modes::measure(main.grid(), &main.view, &modes::all_ways(&main.tables), &main.summits)?;
    progress("figure 13: the engine");
    modes.extend(engine::measure(&mut main, &modes)?);
    progress("times");
    let draws = drawing::times(&mut main, &modes)?;
    let flights = drawing::flights(&mut main)?;
    progress("pictures");
    let pictures = pictures::draw(&mut main, &mut job, &modes, out)?;
    let mut grounds = vec![main.found(job.ground.name, job.ground.title, modes)];
    for made in job.made {
        progress(&format!("measuring: {}", made.title));
        let mut study = Study::new(made.field, job.side_px)?;
        let mut modes = modes::measure(study.grid(), &study.view, &modes::two_ways(&study.tables), &study.summits)?;
        modes.extend(engine::measure(&mut study, &modes)?);
        grounds.push(study.found(made.name, made.title, modes));
    }
    progress("writing the page");
    let mut found = HoriFound { page: PathBuf::new(), grounds, draws, flights };
    found.page = page::write(&found, &peaks, &pictures, out)?;
    Ok(found)
}

/// A ground with its map, its hierarchy and its tables.
#[derive(Debug)]
struct Study {
    scene: DeformedScene,
    view: MapView,
    summits: Vec<Summit>,
    tables: Tables,
    known_share: f64,
}

impl Study {
    fn new(field: NestedField, side_px: u32) -> Result<Self, Error> {
        let grid = ground(&field).clone();
        let rim_m = RIM_M.min(grid.reach_m());
        let known_share = field.known_share(DVec2::ZERO, rim_m);
        let field = NestedField::new(vec![grid]);
        let [_, top_m] = field.range_m().map(f64::from);
        let map = DeformedMap::default();
        let view = MapView::fitted(map, [side_px; 2], rim_m, top_m, 0.0);
        let tables = Tables::measure(field.widest(), &view);
        let mut summits = summits(field.widest(), peaks::MIN_PROMINENCE_M);
        summits.retain(|s| field.widest().plane_from_grid(s.column, s.row).length() <= rim_m);
        let scene = DeformedScene::new(field, &BuildOptions::default(), DrawWith::Software)?;
        scene.check(&map).map_err(|fault| Error::Request(fault.to_string()))?;
        Ok(Self { scene, view, summits, tables, known_share })
    }

    fn grid(&self) -> &FieldLevel {
        self.scene.field().widest()
    }

    fn found(self, name: String, title: String, modes: Vec<HoriMode>) -> HoriGroundFound {
        let spacing_m = self.grid().spacing_m();
        let Self { view, tables, known_share, .. } = self;
        HoriGroundFound { name, title, known_share, spacing_m, view, modes, tables }
    }
}

/// The finest grid that reaches the paper's radius, or the widest.
fn ground(field: &NestedField) -> &FieldLevel {
    field.levels().iter().rev().find(|level| level.reach_m() >= RIM_M).unwrap_or(field.widest())
}
