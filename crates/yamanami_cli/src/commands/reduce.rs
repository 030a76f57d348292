//! `reduce`: a model with fewer polygons.

use super::cleaning::CleanArgs;
use super::{reduce_memory, reduce_text};
use crate::args::{EyeArgs, UpArgs};
use crate::failure::Failure;
use crate::progress::Bar;
use crate::{inputs, values};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use std::time::Instant;
use yamanami::core::{TriangleMesh, View};
use yamanami::io::mesh_file::{self, MeshMeta};
use yamanami::multires::clean::CleanReport;
use yamanami::multires::collapse::{CollapseOptions, Method};
use yamanami::{
    Closing, DisplayNeed, LargeTarget, LookSame, POLYGONS_PER_PIXEL, Probe, Reduced, ReducedBy, close, display_need,
    look_same, model_camera, model_views, reduce, reduce_within, seen_side,
};

/// Reduce a model to fewer polygons: to a number, to an error, or to what a display can show
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami reduce scan.ply -o small.glb --faces 100000
  yamanami reduce scan.ply -o small.ply --ratio 10%
  yamanami reduce scan.ply -o small.ply --error 0.002              within 2 mm of the scan, both ways, for certain
  yamanami reduce scan.ply -o small.ply --display 1920x1080        50 polygons for each pixel it covers
  yamanami reduce scan.ply -o small.ply --display 800x600 --views 8 --polygons-per-pixel 2
  yamanami reduce scan.ply -o small.ply --look same                as few as look the same at 1920x1080
  yamanami reduce scan.ply -o small.ply --display 1280x720 --hide-back close
                                                the side that is not seen becomes one polygon
  yamanami reduce huge.ply -o small.ply --ratio 1% --memory 2GB    a scan larger than memory

With --display the model is drawn off-screen and the pixels it covers are counted; of several views the
one that covers most counts. Several limits hold together; the output says which one ended it.")]
pub(crate) struct ReduceArgs {
    /// The mesh: .ply, .obj, .stl, .off, .glb or .gltf
    pub(super) mesh: PathBuf,
    /// The mesh to write: .ply, .obj, .stl, .off or .glb
    #[arg(short, long, value_name = "FILE", help_heading = "Results")]
    pub(super) output: PathBuf,
    /// So many faces
    #[arg(long, value_name = "N", value_parser = values::faces, help_heading = "How far", conflicts_with_all = ["ratio", "display", "look"])]
    faces: Option<usize>,
    /// Such a share of the faces: 0.1 or 10%
    #[arg(long, value_name = "R", value_parser = values::ratio, help_heading = "How far", conflicts_with_all = ["display", "look"])]
    ratio: Option<f64>,
    /// As far as the reduced surface and the source are certain to stay within so many metres (units of the file) of each
    /// other everywhere
    #[arg(long, value_name = "M", value_parser = values::not_negative, help_heading = "How far", conflicts_with = "look")]
    error: Option<f64>,
    /// What a display of this size can show
    #[arg(long, value_name = "WxH", value_parser = values::picture_size, help_heading = "How far")]
    display: Option<[u32; 2]>,
    /// As few faces as look the same on the display, else on one of 1920x1080, by shaded pictures from several views
    #[arg(long, value_enum, value_name = "HOW", help_heading = "How far")]
    look: Option<LookName>,
    /// Views around the model that the display shows, the first from the south-east; else 1, and 4 with --look
    #[arg(long, value_name = "N", value_parser = values::views, help_heading = "How far", conflicts_with = "eye")]
    views: Option<usize>,
    /// Polygons for each pixel covered
    #[arg(long, value_name = "K", value_parser = values::positive, default_value_t = POLYGONS_PER_PIXEL, help_heading = "How far", conflicts_with = "look")]
    pub(super) polygons_per_pixel: f64,
    /// What becomes of the side that no view sees
    #[arg(long, value_enum, value_name = "HOW", help_heading = "How")]
    hide_back: Option<HideName>,
    /// Hold no more than this, as 500MB or 2GB; a .ply may be larger then. For --faces and --ratio
    #[arg(long, value_name = "SIZE", value_parser = values::memory, help_heading = "How", conflicts_with_all = ["error", "display", "look", "hide_back", "views", "eye", "clean", "weld", "drop_pieces", "orient"])]
    memory: Option<u64>,
    #[command(flatten)]
    eye: EyeArgs,
    #[command(flatten)]
    up: UpArgs,
    /// Vertical field of view, degrees
    #[arg(long, value_name = "DEG", value_parser = values::fov_rad, requires = "eye", help_heading = "View")]
    fov: Option<f64>,
    /// Which collapse
    #[arg(long, value_enum, default_value_t, value_name = "NAME", help_heading = "How")]
    pub(super) method: MethodName,
    #[command(flatten)]
    cleaning: CleanArgs,
    /// Print JSON
    #[arg(long, help_heading = "Results")]
    pub(super) json: bool,
}

/// Names of the collapses.
#[derive(Debug, Clone, Copy, Default, ValueEnum)]
pub(super) enum MethodName {
    /// Quadrics worked out anew from the surface at hand, volume kept
    #[default]
    Memoryless,
    /// The ten steps of Garland and Heckbert 1997, as Mizuno et al. list them
    Garland97,
}

/// Ways to look.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum LookName {
    /// No visible difference
    Same,
}

/// What becomes of the unseen side.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum HideName {
    /// One polygon closes the cut, as Mizuno et al. do
    Close,
    /// It is left away
    Drop,
}

/// A display for --look where none is given.
const USUAL_DISPLAY_PX: [u32; 2] = [1920, 1080];
/// Views for --look where none are given.
const USUAL_LOOK_VIEWS: usize = 4;

/// What is told about a run.
#[derive(Debug)]
pub(super) struct Told<'a> {
    pub(super) args: &'a ReduceArgs,
    /// Faces and vertices of the source.
    pub(super) source: [usize; 2],
    pub(super) cleaned: Option<CleanReport>,
    pub(super) display: Option<[u32; 2]>,
    pub(super) views: &'a [View],
    pub(super) need: Option<DisplayNeed>,
    pub(super) target: usize,
    pub(super) hidden_faces: Option<usize>,
    pub(super) closing: Option<Closing>,
    pub(super) look: Option<&'a LookSame>,
    pub(super) reduced: &'a Reduced,
    pub(super) reduce_s: f64,
    pub(super) bytes: u64,
}

pub(crate) fn run(args: &ReduceArgs) -> Result<(), Failure> {
    inputs::check_output(&args.output, &["ply", "glb", "obj", "stl", "off"], std::slice::from_ref(&args.mesh))?;
    let display = args.display.or(args.look.map(|_| USUAL_DISPLAY_PX));
    if args.faces.is_none() && args.ratio.is_none() && args.error.is_none() && display.is_none() {
        return Err(Failure::misuse("how far? give --faces N, --ratio R, --error M, --display WxH or --look same"));
    }
    if display.is_none() && (args.hide_back.is_some() || args.views.is_some() || args.eye.eye.is_some()) {
        return Err(Failure::misuse("seen on what? views need a --display WxH"));
    }
    if let Some(memory_bytes) = args.memory {
        // one of both was asked for
        let ratio = LargeTarget::Ratio(args.ratio.unwrap_or(1.0));
        let target = args.faces.map_or(ratio, |faces| LargeTarget::Faces(faces as u64));
        return reduce_memory::run(args, target, memory_bytes);
    }
    let mut mesh = {
        let _bar = Bar::spinner("reading");
        mesh_file::read_mesh(&args.mesh)?
    };
    args.up.turn(&mut mesh);
    let source = [mesh.triangles.len(), mesh.positions.len()];
    let cleaned = args.cleaning.apply(&mut mesh);
    let views = display.map_or_else(Vec::new, |size| views(args, &mesh, size));
    let need = match display {
        Some(_) => {
            let _bar = Bar::spinner("counting");
            Some(display_need(&mesh, &views, args.polygons_per_pixel)?)
        }
        None => None,
    };
    let target = match (args.faces, args.ratio, args.look, &need) {
        (Some(faces), ..) => faces,
        (_, Some(ratio), ..) => (source[0] as f64 * ratio).round() as usize,
        (_, _, None, Some(need)) => need.faces,
        _ => 0,
    };
    let started = Instant::now();
    let mut hidden_faces = None;
    if args.hide_back.is_some() {
        let _bar = Bar::spinner("hiding");
        let seen = seen_side(&mesh, &views)?;
        (mesh, hidden_faces) = (seen.mesh, Some(seen.hidden_faces));
    }
    let (mut reduced, look) = match args.look {
        Some(LookName::Same) => {
            let look = look(args, mesh, &views)?;
            (look.reduced.clone(), Some(look))
        }
        None => (to_target(args, mesh, target), None),
    };
    let mut closing = None;
    if args.hide_back == Some(HideName::Close) {
        let bar = Bar::spinner("closing");
        let (mut mesh, mut how) = close(&reduced.mesh, &views)?;
        if target > 0 && mesh.triangles.len() > target && reduced.by == ReducedBy::Faces {
            // the polygon counts too: the rest makes room for it
            let room = target.saturating_sub(how.faces).max(1);
            bar.set_job("making room");
            reduced = Reduced { by: ReducedBy::Faces, ..to_target(args, reduced.mesh, room) };
            (mesh, how) = close(&reduced.mesh, &views)?;
        }
        (reduced.mesh, closing) = (mesh, Some(how));
    }
    let reduce_s = started.elapsed().as_secs_f64();
    args.up.turn_back(&mut reduced.mesh);
    {
        let _bar = Bar::spinner("writing");
        mesh_file::write_mesh(&args.output, &reduced.mesh, &meta(args, &reduced))?;
    }
    let bytes = inputs::file_bytes(&args.output)?;
    reduce_text::tell(&Told {
        args,
        source,
        cleaned,
        display,
        views: &views,
        need,
        target,
        hidden_faces,
        closing,
        look: look.as_ref(),
        reduced: &reduced,
        reduce_s,
        bytes,
    })
}

/// Reduces to a number of faces, or until the error given.
fn to_target(args: &ReduceArgs, mesh: TriangleMesh, target_faces: usize) -> Reduced {
    let bar = Bar::shares("reducing");
    let progress = |share| bar.set_share(share);
    let options = CollapseOptions {
        target_faces,
        method: args.method.method(),
        progress: Some(&progress),
        ..CollapseOptions::default()
    };
    match args.error {
        Some(limit_m) => reduce_within(mesh, limit_m, &options),
        None => reduce(mesh, &options),
    }
}

/// Searches for the smallest mesh that looks the same.
fn look(args: &ReduceArgs, mesh: TriangleMesh, views: &[View]) -> Result<LookSame, Failure> {
    let bar = Bar::spinner("looking");
    let progress = |probe: &Probe| {
        let looks = if probe.same { "look the same" } else { "do not" };
        bar.set_job(&format!("looking: {} faces {looks}", probe.faces));
    };
    Ok(look_same(mesh, views, args.method.method(), &progress)?)
}

/// The views that the display shows.
fn views(args: &ReduceArgs, mesh: &TriangleMesh, size_px: [u32; 2]) -> Vec<View> {
    let usual = if args.look.is_some() { USUAL_LOOK_VIEWS } else { 1 };
    match (args.eye.eye, args.eye.target) {
        (Some(eye), Some(target)) => {
            vec![model_camera(args.up.place(eye), args.up.place(target), args.fov, size_px)]
        }
        _ => model_views(&mesh.positions, args.views.unwrap_or(usual), size_px),
    }
}

impl MethodName {
    pub(super) fn method(self) -> Method {
        match self {
            Self::Memoryless => Method::Memoryless,
            Self::Garland97 => Method::Garland97,
        }
    }
}

fn meta(args: &ReduceArgs, reduced: &Reduced) -> MeshMeta {
    let name = args.mesh.file_name().unwrap_or_default().to_string_lossy().into_owned();
    MeshMeta { note: format!("{} faces of {name}; yamanami", reduced.mesh.triangles.len()), ..MeshMeta::default() }
}
