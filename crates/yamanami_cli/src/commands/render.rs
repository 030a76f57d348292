//! `render`: one picture.

use super::render_model;
use crate::args::{self, DrawArgs, EyeArgs, FinenessArgs, LensArgs, SourceArgs, UpArgs};
use crate::failure::Failure;
use crate::inputs::Opened;
use crate::pictures::{self, PICTURE_ENDINGS, StyleArgs};
use crate::progress::{Bar, note};
use crate::{inputs, out, text};
use clap::Args;
use image::RgbaImage;
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;
use yamanami::core::View;
use yamanami::gpu::RenderOptions;
use yamanami::{Canvas, Criteria, DrawWith, FrameReport, Scene, Subject};

/// Draw one picture
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami render dem.tif -o dem.png                         the whole of it
  yamanami render dem.tif -o dem.png --budget 5000 --wireframe --colour level
                                                             what 5,000 triangles make of it, and where
  yamanami render dem.yama -o fuji.png --eye 138.6,35.2,6000 --target 138.73,35.36,3000
                                                             from a place in the source's CRS
  yamanami render dem.tif -o map.png --image aerial.jpg      with an image laid over it
  yamanami render dem.tif -o slope.png --colour slope        where it is steep; aspect: where it falls to
  yamanami render dem.tif -o lake.png --water 620            with water up to 620 m
  yamanami render scan.ply -o scan.png                       a model, from the south-east")]
pub(crate) struct RenderArgs {
    #[command(flatten)]
    source: SourceArgs,
    /// The picture to write: .png or .jpg
    #[arg(short, long, value_name = "FILE", help_heading = "Results")]
    pub(super) output: PathBuf,
    #[command(flatten)]
    pub(super) eye: EyeArgs,
    #[command(flatten)]
    pub(super) up: UpArgs,
    #[command(flatten)]
    pub(super) lens: LensArgs,
    #[command(flatten)]
    fineness: FinenessArgs,
    #[command(flatten)]
    pub(super) style: StyleArgs,
    #[command(flatten)]
    pub(super) draw: DrawArgs,
    /// Print JSON
    #[arg(long, help_heading = "Results")]
    pub(super) json: bool,
}

/// Errors below this many pixels are not seen in an antialiased picture.
const USUAL_TOLERANCE_PX: f32 = 0.5;

pub(crate) fn run(args: &RenderArgs) -> Result<(), Failure> {
    inputs::check_output(&args.output, &PICTURE_ENDINGS, &args.source.sources)?;
    if let [file] = args.source.sources.as_slice()
        && inputs::is_mesh(file)
        && !args.fineness.is_given()
    {
        return render_model::run(args, file);
    }
    match inputs::subject(&args.source)? {
        Opened::Terrain(mut terrain) => draw(args, &mut *terrain),
        Opened::Model(mut model) => draw(args, &mut *model),
        Opened::Progressive(mut model) => draw(args, &mut *model),
    }
}

fn draw(args: &RenderArgs, subject: &mut impl Subject) -> Result<(), Failure> {
    let view = args::view(&args.eye, &args.lens, subject, [1600, 900]);
    warn_if_far(subject, &view);
    let criteria = args.fineness.criteria(Some(view), !args.lens.no_cull, USUAL_TOLERANCE_PX);
    let style = args.style.options(subject)?;
    let with = args.draw.with();
    let started = Instant::now();
    let drawn = {
        let _bar = Bar::spinner("drawing");
        picture(subject, &criteria, &view, &style, with)?
    };
    let ms = started.elapsed().as_secs_f64() * 1e3;
    pictures::write(&args.output, drawn.picture)?;
    let [width, height] = view.viewport_px;
    if args.json {
        return out::json(&json!({
            "output": args.output,
            "width_px": width,
            "height_px": height,
            "triangles": drawn.report.triangles,
            "error_left_px": drawn.report.error_left,
            "drawn_with": drawn.drawn_with,
            "time_ms": ms,
        }));
    }
    out::row("picture", format_args!("{}, {width} x {height}", args.output.display()))?;
    out::row("triangles", text::count(drawn.report.triangles as u64))?;
    out::row("error", format_args!("at most {} px", text::number(f64::from(drawn.report.error_left))))?;
    out::row("drawn", format_args!("with {} in {} ms", drawn.drawn_with, text::number(ms)))
}

/// A picture and what is in it.
#[derive(Debug)]
pub(crate) struct Drawn {
    pub(crate) picture: RgbaImage,
    pub(crate) report: FrameReport,
    pub(crate) drawn_with: &'static str,
}

/// Draws a terrain or a model as fine as criteria ask.
pub(crate) fn picture(
    subject: &mut impl Subject,
    criteria: &Criteria,
    view: &View,
    style: &RenderOptions,
    with: DrawWith,
) -> Result<Drawn, Failure> {
    let mut scene = Scene::new(subject, Canvas::new(subject.bounds().centre(), with)?);
    let report = loop {
        let update = scene.update(subject, criteria)?;
        if update.pages == 0 {
            break update.report;
        }
    };
    let picture = scene.draw(view, style)?;
    Ok(Drawn { picture, report, drawn_with: scene.canvas().description() })
}

/// A target far off the terrain is most likely in other coordinates than the source's.
fn warn_if_far(subject: &impl Subject, view: &View) {
    let Some(terrain) = subject.as_terrain() else { return };
    let [east_m, north_m] = terrain.extent_m();
    let reach = east_m.max(north_m);
    let off = |v: f64, most: f64| v < -reach || v > most + reach;
    if off(view.target.x, east_m) || off(-view.target.y, north_m) {
        let crs = &terrain.geo().crs;
        let [west, south, east, north] = text::bounds(terrain.geo(), terrain.size()).map(|v| text::coordinate(v, crs));
        note(&format!(
            "note: the target is far off the terrain, which lies at x {west} to {east}, y {south} to {north}"
        ));
    }
}
