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
//!
//! Without the feature `files` it is what a browser needs: what shows terrains, models and deformed maps whose pages are
//! brought to it.
#![forbid(unsafe_code)]

#[cfg(feature = "files")]
mod bench;
mod camera;
mod canvas;
mod data;
mod deformed;
mod error;
#[cfg(feature = "files")]
mod export;
#[cfg(feature = "files")]
mod extract;
#[cfg(feature = "files")]
mod field;
#[cfg(feature = "files")]
mod flight;
#[cfg(feature = "files")]
mod flight_report;
#[cfg(feature = "files")]
mod full_surface;
#[cfg(feature = "files")]
mod ground_image;
#[cfg(feature = "files")]
mod height_tiles;
#[cfg(feature = "files")]
mod hide;
#[cfg(feature = "files")]
mod hiraoka;
#[cfg(feature = "files")]
mod hori;
#[cfg(feature = "files")]
mod large;
#[cfg(feature = "files")]
mod large_tin;
#[cfg(feature = "files")]
mod look;
mod map_ground;
#[cfg(feature = "files")]
mod mizuno;
#[cfg(feature = "files")]
mod mizuno_page;
#[cfg(feature = "files")]
mod mizuno_sheet;
mod model;
#[cfg(feature = "files")]
mod model_build;
mod model_picture;
mod model_view;
#[cfg(feature = "files")]
mod page;
#[cfg(feature = "files")]
mod path;
#[cfg(feature = "files")]
mod polygon;
#[cfg(feature = "files")]
mod profile_plot;
#[cfg(feature = "files")]
mod progressive;
#[cfg(feature = "files")]
mod reduce;
#[cfg(feature = "files")]
mod reproduce;
mod scene;
pub mod steer;
mod subject;
#[cfg(feature = "files")]
mod surface_heights;
mod terrain;
#[cfg(feature = "files")]
mod thin;
#[cfg(feature = "files")]
mod tin;
#[cfg(feature = "files")]
mod tin_draw;
#[cfg(feature = "files")]
mod validate;
#[cfg(feature = "files")]
mod wavelet;
#[cfg(feature = "files")]
mod yama;

#[cfg(feature = "files")]
pub use bench::{measure_rate, triangles_at_rate};
pub use camera::{overview, view_between};
pub use canvas::{Canvas, DrawWith, Upload};
pub use data::Data;
pub use deformed::{BaseOptions, DeformedScene, MapUpdate, draw_base};
#[cfg(feature = "files")]
pub use deformed::{
    MadeMap, MapErrors, MapImage, MapJob, MapMesh, lay_lines, lay_places, make_map, rank_by_prominence,
};
pub use error::Error;
#[cfg(feature = "files")]
pub use export::{
    ExportJob, ExportKind, ExportOptions, ExportReport, ExportSubject, Fill, GeoidChoice, GlbPacking, HeightKind,
    MeshTiles, ZoomReport, export,
};
#[cfg(feature = "files")]
pub use extract::{Extracted, Frame, extract, to_frame};
#[cfg(feature = "files")]
pub use flight::{FlightMode, FlightOptions, FrameStats, fly};
#[cfg(feature = "files")]
pub use flight_report::{FlightSummary, summary, write_flight_plots};
#[cfg(feature = "files")]
pub use full_surface::{FullSurface, finest_mesh};
#[cfg(feature = "files")]
pub use ground_image::{GroundImage, read_picture};
#[cfg(feature = "files")]
pub use height_tiles::{HeightTiles, MOST_ZOOM, halved};
#[cfg(feature = "files")]
pub use hide::{Closing, SeenSide, close, seen_side};
#[cfg(feature = "files")]
pub use hiraoka::hiraoka;
#[cfg(feature = "files")]
pub use hori::{HoriDraw, HoriFlight, HoriFound, HoriGround, HoriGroundFound, HoriJob, HoriMode, hori};
#[cfg(feature = "files")]
pub use large::{LargeOptions, LargeReport, LargeTarget, reduce_large};
#[cfg(feature = "files")]
pub use large_tin::{FileTiles, GridTiles, TinFacts, TinTiles, build_tiles};
#[cfg(feature = "files")]
pub use look::{LookLimits, LookSame, Original, Probe, look_same, worst_of};
pub use map_ground::{MapGround, MapGroundOptions, MapSource, MapSources, NoData, PageAtHand};
#[cfg(feature = "files")]
pub use mizuno::{MizunoModel, mizuno};
pub use model::Model;
#[cfg(feature = "files")]
pub use model_build::{ModelBuild, ModelStoreOptions, ModelStored};
pub use model_picture::{MODEL_BACKGROUND, coloured_style, model_pixels, model_style};
pub use model_view::{model_camera, model_views, turn_back_y_up, turn_y_up};
#[cfg(feature = "files")]
pub use path::{CameraPath, orbit, read_path, valley_run, write_path};
#[cfg(feature = "files")]
pub use profile_plot::write_profile_plot;
#[cfg(feature = "files")]
pub use progressive::{
    ProgressiveFile, ProgressiveOptions, ProgressiveSurface, decode_progressive, encode_progressive, read_progressive,
};
#[cfg(feature = "files")]
pub use reduce::{DisplayNeed, POLYGONS_PER_PIXEL, Reduced, ReducedBy, display_need, reduce, reduce_within};

#[cfg(feature = "files")]
pub use reproduce::hashida;
pub use scene::{Lod, Scene, Update, morph_of};
pub use subject::Subject;
#[cfg(feature = "files")]
pub use surface_heights::SurfaceHeights;
#[cfg(feature = "files")]
pub use terrain::OpenOptions;
pub use terrain::Terrain;
#[cfg(feature = "files")]
pub use thin::{ThinBy, ThinLevel, thin};
#[cfg(feature = "files")]
pub use tin::{GroundOptions, ReadGround, is_tin_file, read_ground};
#[cfg(feature = "files")]
pub use tin_draw::{Culling, DrawCounts, TinDrawing, seen_triangles};
#[cfg(feature = "files")]
pub use validate::{CrackRow, ErrorRow, Finding, RULES, Rule, Severity, ValidateOptions, ValidateReport, validate};
#[cfg(feature = "files")]
pub use wavelet::{
    Approximation, DateModel, Fullness, KEPT_SHARES, SemiRegularModel, WaveletModel, WaveletRow, WaveletStudy, date,
    paper_fullness, usual_thresholds_m, wavelet_study, write_wavelet_plots,
};
#[cfg(feature = "files")]
pub use yama::{StoreOptions, quantise};

pub use yamanami_core as core;
pub use yamanami_gpu as gpu;
pub use yamanami_io as io;
pub use yamanami_lod::{
    Band, BandRule, BandTable, Controller, Criteria, FrameReport, Front, LimitedBy, MapCriterion, PaperController,
    SlopeDeviation, Staircase, Step, ViewCriterion,
};
pub use yamanami_map as map;
#[cfg(feature = "files")]
pub use yamanami_measure as measure;
pub use yamanami_multires as multires;
