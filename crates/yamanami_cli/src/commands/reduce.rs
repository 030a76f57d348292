//! `reduce`: a model with fewer polygons.

use super::reduce_text;
use crate::args::EyeArgs;
use crate::failure::Failure;
use crate::progress::Bar;
use crate::{inputs, values};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use std::time::Instant;
use yamanami::core::{TriangleMesh, View};
use yamanami::io::mesh_file::{self, MeshMeta};
use yamanami::multires::collapse::{CollapseOptions, Method};
use yamanami::{DisplayNeed, POLYGONS_PER_PIXEL, Reduced, display_need, model_camera, model_views, reduce};

/// Reduce a model to fewer polygons: to a number, to an error, or to what a display can show
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami reduce scan.ply -o small.glb --faces 100000
  yamanami reduce scan.ply -o small.ply --ratio 10%
  yamanami reduce scan.ply -o small.ply --error 0.002              no step further than 2 mm
  yamanami reduce scan.ply -o small.ply --display 1920x1080        50 polygons for each pixel it covers
  yamanami reduce scan.ply -o small.ply --display 800x600 --views 8 --polygons-per-pixel 2

With --display the model is drawn off-screen and the pixels it covers are counted; of several views the
one that covers most counts. Several limits hold together; the output says which one ended it.")]
pub(crate) struct ReduceArgs {
    /// The mesh: .ply, .obj, .stl, .glb
    mesh: PathBuf,
    /// The mesh to write: .ply, .obj, .stl or .glb
    #[arg(short, long, value_name = "FILE", help_heading = "Results")]
    pub(super) output: PathBuf,
    /// So many faces
    #[arg(long, value_name = "N", value_parser = values::faces, help_heading = "How far", conflicts_with_all = ["ratio", "display"])]
    faces: Option<usize>,
    /// Such a share of the faces: 0.1 or 10%
    #[arg(long, value_name = "R", value_parser = values::ratio, help_heading = "How far", conflicts_with = "display")]
    ratio: Option<f64>,
    /// No step that moves the surface further than this, metres (units of the file)
    #[arg(long, value_name = "M", value_parser = values::not_negative, help_heading = "How far")]
    error: Option<f64>,
    /// What a display of this size can show
    #[arg(long, value_name = "WxH", value_parser = values::picture_size, help_heading = "How far")]
    pub(super) display: Option<[u32; 2]>,
    /// Views around the model that the display shows, the first from the south-east
    #[arg(long, value_name = "N", value_parser = values::views, requires = "display", help_heading = "How far", conflicts_with = "eye")]
    views: Option<usize>,
    /// Polygons for each pixel covered
    #[arg(long, value_name = "K", value_parser = values::positive, default_value_t = POLYGONS_PER_PIXEL, help_heading = "How far")]
    pub(super) polygons_per_pixel: f64,
    #[command(flatten)]
    eye: EyeArgs,
    /// Vertical field of view, degrees
    #[arg(long, value_name = "DEG", value_parser = values::fov_rad, requires = "eye", help_heading = "View")]
    fov: Option<f64>,
    /// Which collapse
    #[arg(long, value_enum, default_value_t, value_name = "NAME", help_heading = "How")]
    method: MethodName,
    /// Print JSON
    #[arg(long, help_heading = "Results")]
    pub(super) json: bool,
}

/// Names of the collapses.
#[derive(Debug, Clone, Copy, Default, ValueEnum)]
enum MethodName {
    /// Quadrics worked out anew from the surface at hand, volume kept
    #[default]
    Memoryless,
    /// The ten steps of Garland and Heckbert 1997, as Mizuno et al. list them
    Garland97,
}

/// What is told about a run.
#[derive(Debug)]
pub(super) struct Told<'a> {
    pub(super) args: &'a ReduceArgs,
    /// Faces and vertices of the source.
    pub(super) source: [usize; 2],
    pub(super) views: &'a [View],
    pub(super) need: Option<DisplayNeed>,
    pub(super) target: usize,
    pub(super) reduced: &'a Reduced,
    pub(super) reduce_s: f64,
    pub(super) bytes: u64,
}

pub(crate) fn run(args: &ReduceArgs) -> Result<(), Failure> {
    inputs::check_output(&args.output, &["ply", "glb", "obj", "stl"], std::slice::from_ref(&args.mesh))?;
    if args.faces.is_none() && args.ratio.is_none() && args.error.is_none() && args.display.is_none() {
        return Err(Failure::misuse("how far? give --faces N, --ratio R, --error M or --display WxH"));
    }
    let mesh = {
        let _bar = Bar::spinner("reading");
        mesh_file::read_mesh(&args.mesh)?
    };
    let source = [mesh.triangles.len(), mesh.positions.len()];
    let views = args.display.map_or_else(Vec::new, |size| views(args, &mesh, size));
    let need = match args.display {
        Some(_) => {
            let _bar = Bar::spinner("counting");
            Some(display_need(&mesh, &views, args.polygons_per_pixel)?)
        }
        None => None,
    };
    let target = match (args.faces, args.ratio, &need) {
        (Some(faces), _, _) => faces,
        (_, Some(ratio), _) => (source[0] as f64 * ratio).round() as usize,
        (_, _, Some(need)) => need.faces,
        _ => 0,
    };
    let started = Instant::now();
    let reduced = {
        let bar = Bar::shares("reducing");
        let progress = |share| bar.set_share(share);
        let method = match args.method {
            MethodName::Memoryless => Method::Memoryless,
            MethodName::Garland97 => Method::Garland97,
        };
        let options = CollapseOptions {
            target_faces: target,
            max_error_m: args.error.unwrap_or(f64::INFINITY),
            method,
            progress: Some(&progress),
            ..CollapseOptions::default()
        };
        reduce(mesh, &options)
    };
    let reduce_s = started.elapsed().as_secs_f64();
    {
        let _bar = Bar::spinner("writing");
        mesh_file::write_mesh(&args.output, &reduced.mesh, &meta(args, &reduced))?;
    }
    let bytes = inputs::file_bytes(&args.output)?;
    reduce_text::tell(&Told { args, source, views: &views, need, target, reduced: &reduced, reduce_s, bytes })
}

/// The views that the display shows.
fn views(args: &ReduceArgs, mesh: &TriangleMesh, size_px: [u32; 2]) -> Vec<View> {
    match (args.eye.eye, args.eye.target) {
        (Some(eye), Some(target)) => vec![model_camera(eye, target, args.fov, size_px)],
        _ => model_views(&mesh.positions, args.views.unwrap_or(1), size_px),
    }
}

fn meta(args: &ReduceArgs, reduced: &Reduced) -> MeshMeta {
    let name = args.mesh.file_name().unwrap_or_default().to_string_lossy().into_owned();
    MeshMeta { note: format!("{} faces of {name}; yamanami", reduced.mesh.triangles.len()), ..MeshMeta::default() }
}
