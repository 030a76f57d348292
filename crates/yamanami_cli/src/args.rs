//! Flags that several commands share.

use crate::values;
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use yamanami::core::{Crs, TriangleMesh, View};
use yamanami::gpu::Gpu;
use yamanami::io::dem;
use yamanami::io::tin_file::TinReadOptions;
use yamanami::{Criteria, DrawWith, Lod, OpenOptions, Staircase, Subject, ViewCriterion, turn_back_y_up, turn_y_up};

/// How to read sources that do not say all about themselves.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Reading")]
pub(crate) struct ReadingArgs {
    /// CRS of the input, over what its files say
    #[arg(long, value_name = "EPSG", value_parser = values::epsg)]
    crs: Option<Crs>,
    /// What a picture tile's colours mean: terrain-rgb, terrarium or gsi; else from its name or colours
    #[arg(long, value_name = "NAME", value_parser = values::tile_encoding)]
    tile_encoding: Option<dem::TileEncoding>,
    /// Place of a single picture tile; else from its path
    #[arg(long, value_name = "Z/X/Y", value_parser = values::tile)]
    tile: Option<[u32; 3]>,
    /// Zoom to take from a folder of tiles; else the deepest
    #[arg(long, value_name = "Z")]
    zoom: Option<u32>,
}

impl ReadingArgs {
    pub(crate) fn options(&self) -> OpenOptions {
        let dem = dem::OpenOptions {
            crs: self.crs.clone(),
            tile_encoding: self.tile_encoding,
            tile: self.tile,
            zoom: self.zoom,
            ..dem::OpenOptions::default()
        };
        OpenOptions { dem }
    }
}

/// What to take of a TIN file, and what it does not say.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Reading")]
pub(crate) struct TinReadingArgs {
    /// Which surface of a TIN file, by name; else the largest
    #[arg(long, value_name = "NAME")]
    surface: Option<String>,
    /// Metres in a unit of a TIN file's coordinates, over what it says: 0.3048 for feet
    #[arg(long, value_name = "M", value_parser = values::positive)]
    unit: Option<f64>,
}

impl TinReadingArgs {
    pub(crate) fn options(&self) -> TinReadOptions {
        TinReadOptions { surface: self.surface.clone(), unit_m: self.unit, ..TinReadOptions::default() }
    }
}

/// What a command works on.
#[derive(Debug, Clone, Args)]
pub(crate) struct SourceArgs {
    /// A .yama database, a mesh file, or elevation files and tile folders that make one mosaic
    #[arg(required = true, value_name = "SOURCE")]
    pub(crate) sources: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) reading: ReadingArgs,
}

/// How fine.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "How fine")]
pub(crate) struct FinenessArgs {
    /// Errors up to so many metres are good enough everywhere
    #[arg(long, value_name = "M", value_parser = values::tolerance)]
    pub(crate) tolerance: Option<f32>,
    /// Errors up to so many pixels on the screen are good enough
    #[arg(long, value_name = "P", value_parser = values::tolerance)]
    pub(crate) tolerance_px: Option<f32>,
    /// Most triangles
    #[arg(long, value_name = "N", value_parser = values::budget)]
    pub(crate) budget: Option<u32>,
}

/// Errors smaller than this cannot be seen in a picture, pixels.
pub(crate) const SEEN_PX: f32 = 0.1;

impl FinenessArgs {
    pub(crate) fn is_given(&self) -> bool {
        self.tolerance.is_some() || self.tolerance_px.is_some() || self.budget.is_some()
    }

    /// The criteria for a view, or for none. Where a view has no tolerance in pixels, `usual_px` stands for it, unless
    /// metres or triangles bound the front already: then all that can be seen is wanted.
    pub(crate) fn criteria(&self, view: Option<View>, cull: bool, usual_px: f32) -> Criteria {
        let tolerance_px = self.tolerance_px.unwrap_or(match (self.tolerance, self.budget) {
            (None, None) => usual_px,
            (_, Some(_)) => SEEN_PX,
            (Some(_), None) => 0.0,
        });
        Criteria {
            terrain_tolerance_m: self.tolerance.unwrap_or(0.0),
            view: view.map(|view| ViewCriterion { view, tolerance_px, cull }),
            budget_triangles: self.budget,
            ..Criteria::default()
        }
    }
}

/// Where the camera stands.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "View")]
pub(crate) struct EyeArgs {
    /// Eye: x and y in the source's CRS (longitude first), z in metres
    #[arg(long, value_name = "X,Y,Z", value_parser = values::place, allow_hyphen_values = true, requires = "target")]
    pub(crate) eye: Option<[f64; 3]>,
    /// Point looked at, in the same coordinates
    #[arg(long, value_name = "X,Y,Z", value_parser = values::place, allow_hyphen_values = true, requires = "eye")]
    pub(crate) target: Option<[f64; 3]>,
}

/// Which way a model stands.
#[derive(Debug, Clone, Copy, Default, Args)]
#[command(next_help_heading = "View")]
pub(crate) struct UpArgs {
    /// The model's axis that points up in pictures
    #[arg(long, value_enum, default_value_t, value_name = "AXIS")]
    up: UpAxis,
}

/// Axes that may point up.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
enum UpAxis {
    /// As surveys have it
    #[default]
    Z,
    /// As many modelling programs have it
    Y,
}

impl UpArgs {
    /// Turns a model upright.
    pub(crate) fn turn(self, mesh: &mut TriangleMesh) {
        if self.up == UpAxis::Y {
            turn_y_up(mesh);
        }
    }

    /// Turns it back into its file's axes.
    pub(crate) fn turn_back(self, mesh: &mut TriangleMesh) {
        if self.up == UpAxis::Y {
            turn_back_y_up(mesh);
        }
    }

    /// A place in the file's axes, turned upright.
    pub(crate) fn place(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        if self.up == UpAxis::Y { [x, -z, y] } else { [x, y, z] }
    }
}

/// What the camera sees.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "View")]
pub(crate) struct LensArgs {
    /// Vertical field of view, degrees
    #[arg(long, value_name = "DEG", value_parser = values::fov_rad)]
    pub(crate) fov: Option<f64>,
    /// Picture size in pixels
    #[arg(long, value_name = "WxH", value_parser = values::picture_size)]
    pub(crate) size: Option<[u32; 2]>,
    /// Keep what lies outside the view as fine as what lies inside
    #[arg(long)]
    pub(crate) no_cull: bool,
}

/// The view asked for: from eye to target, or of the whole.
pub(crate) fn view(eye: &EyeArgs, lens: &LensArgs, subject: &impl Subject, usual_size: [u32; 2]) -> View {
    let size = lens.size.unwrap_or(usual_size);
    let mut view = yamanami::overview(subject, size);
    if let (Some(eye), Some(target)) = (eye.eye, eye.target) {
        view = yamanami::view_between(subject, eye, target, view.fov_y_rad, size);
    }
    view.fov_y_rad = lens.fov.unwrap_or(view.fov_y_rad);
    view
}

/// Who draws.
#[derive(Debug, Clone, Copy, Default, ValueEnum)]
pub(crate) enum Draw {
    /// The graphics card where there is one, else the processor
    #[default]
    Auto,
    /// The graphics adapter, whatever it is
    Gpu,
    /// The processor
    Software,
}

/// Who draws.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Drawing")]
pub(crate) struct DrawArgs {
    /// Who draws
    #[arg(long, value_enum, default_value_t, value_name = "WHO")]
    draw: Draw,
}

impl DrawArgs {
    /// Who draws, decided once: looking for a graphics card takes a while.
    pub(crate) fn with(&self) -> DrawWith {
        match self.draw {
            Draw::Auto if Gpu::headless().is_ok_and(|gpu| !gpu.is_processor()) => DrawWith::Gpu,
            Draw::Gpu => DrawWith::Gpu,
            Draw::Auto | Draw::Software => DrawWith::Software,
        }
    }
}

/// Which control moves the front of a flight.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum LodName {
    /// Largest error first; the budget holds in the same frame
    #[default]
    Exact,
    /// The staircase of thresholds by distance, with proportional feedback, of Hashida, Kanai and Kishinami
    Paper,
}

/// How the front moves.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Control")]
pub(crate) struct ControlArgs {
    /// Which control moves the front
    #[arg(long, value_enum, default_value_t, value_name = "NAME")]
    pub(crate) lod: LodName,
    /// Intervals of the paper's staircase
    #[arg(long, value_name = "L", default_value_t = 5, value_parser = values::intervals)]
    intervals: usize,
    /// How much worse, relatively, a detail must get than it had to be to be shown before it goes: 0.1 avoids flicker
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = values::share)]
    hysteresis: f64,
    /// Most steps of refinement a frame
    #[arg(long, value_name = "N")]
    step_limit: Option<usize>,
}

impl ControlArgs {
    /// The control itself; the staircase reaches over most of the diagonal.
    pub(crate) fn lod(&self, subject: &impl Subject, tolerance_m: Option<f32>) -> Lod {
        match self.lod {
            LodName::Exact => Lod::Exact,
            LodName::Paper => {
                let size_m = subject.bounds().max - subject.bounds().min;
                let tolerance_m = tolerance_m.unwrap_or(size_m.z as f32 / 400.0);
                Lod::Paper(Staircase::new(tolerance_m, 0.0, 0.8 * size_m.truncate().length(), self.intervals))
            }
        }
    }

    /// Criteria with this control's limits.
    pub(crate) fn limit(&self, criteria: Criteria) -> Criteria {
        Criteria { hysteresis: self.hysteresis as f32, max_steps: self.step_limit, ..criteria }
    }
}
