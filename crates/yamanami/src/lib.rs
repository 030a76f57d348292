//! yamanami: raw survey data to multiresolution surfaces, and those to the screen, in a call each.
//!
//! ```no_run
//! use yamanami::{Terrain, Criteria, OpenOptions};
//! # fn main() -> Result<(), yamanami::Error> {
//! let mut terrain = Terrain::open(&["fuji.tif".into()], &OpenOptions::default(), &|_| ())?;
//! let criteria = Criteria { terrain_tolerance_m: 10.0, ..Criteria::default() };
//! let extracted = yamanami::extract(&mut terrain, &criteria)?;
//! println!("{} triangles within 10 m of every sample", extracted.mesh.triangles.len());
//! # Ok(()) }
//! ```
#![forbid(unsafe_code)]

mod bench;
mod camera;
mod canvas;
mod data;
mod deformed;
mod error;
mod extract;
mod field;
mod flight;
mod flight_report;
mod full_surface;
mod ground_image;
mod hide;
mod hiraoka;
mod hori;
mod large;
mod large_tin;
mod look;
mod map_ground;
mod mizuno;
mod mizuno_page;
mod mizuno_sheet;
mod model;
mod model_picture;
mod model_view;
mod page;
mod path;
mod polygon;
mod profile_plot;
mod progressive;
mod reduce;
mod reproduce;
mod scene;
mod subject;
mod terrain;
mod thin;
mod tin;
mod tin_draw;
mod validate;
mod wavelet;
mod yama;

pub use bench::{measure_rate, triangles_at_rate};
pub use camera::{overview, view_between};
pub use canvas::{Canvas, DrawWith, Upload};
pub use data::Data;
pub use deformed::{
    BaseOptions, DeformedScene, MadeMap, MapErrors, MapImage, MapJob, MapMesh, MapUpdate, draw_base, lay_lines,
    lay_places, make_map, rank_by_prominence,
};
pub use error::Error;
pub use extract::{Extracted, Frame, extract, to_frame};
pub use flight::{FlightMode, FlightOptions, FrameStats, Lod, fly};
pub use flight_report::{FlightSummary, summary, write_flight_plots};
pub use full_surface::{FullSurface, finest_mesh};
pub use ground_image::{GroundImage, read_picture};
pub use hide::{Closing, SeenSide, close, seen_side};
pub use hiraoka::hiraoka;
pub use hori::{HoriDraw, HoriFlight, HoriFound, HoriGround, HoriGroundFound, HoriJob, HoriMode, hori};
pub use large::{LargeOptions, LargeReport, LargeTarget, reduce_large};
pub use large_tin::{FileTiles, GridTiles, TinFacts, TinTiles, build_tiles};
pub use look::{LookLimits, LookSame, Original, Probe, look_same, worst_of};
pub use map_ground::{MapGround, MapGroundOptions, MapSource, MapSources, NoData};
pub use mizuno::{MizunoModel, mizuno};
pub use model::{Model, ModelBuild, ModelStoreOptions, ModelStored};
pub use model_picture::{MODEL_BACKGROUND, coloured_style, model_pixels, model_style};
pub use model_view::{model_camera, model_views, turn_back_y_up, turn_y_up};
pub use path::{CameraPath, orbit, read_path, valley_run, write_path};
pub use profile_plot::write_profile_plot;
pub use progressive::{
    ProgressiveFile, ProgressiveOptions, ProgressiveSurface, decode_progressive, encode_progressive, read_progressive,
};
pub use reduce::{DisplayNeed, POLYGONS_PER_PIXEL, Reduced, ReducedBy, display_need, reduce, reduce_within};

pub use reproduce::hashida;
pub use scene::{Scene, Update};
pub use subject::Subject;
pub use terrain::{OpenOptions, Terrain};
pub use thin::{ThinBy, ThinLevel, thin};
pub use tin::{GroundOptions, ReadGround, is_tin_file, read_ground};
pub use tin_draw::{Culling, DrawCounts, TinDrawing, seen_triangles};
pub use validate::{CrackRow, ErrorRow, Finding, RULES, Rule, Severity, ValidateOptions, ValidateReport, validate};
pub use wavelet::{
    Approximation, DateModel, Fullness, KEPT_SHARES, SemiRegularModel, WaveletModel, WaveletRow, WaveletStudy, date,
    paper_fullness, usual_thresholds_m, wavelet_study, write_wavelet_plots,
};
pub use yama::{StoreOptions, quantise};

pub use yamanami_core as core;
pub use yamanami_gpu as gpu;
pub use yamanami_io as io;
pub use yamanami_lod::{
    Band, BandRule, BandTable, Controller, Criteria, FrameReport, Front, LimitedBy, MapCriterion, PaperController,
    SlopeDeviation, Staircase, Step, ViewCriterion,
};
pub use yamanami_map as map;
pub use yamanami_measure as measure;
pub use yamanami_multires as multires;
