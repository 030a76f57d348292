//! `fly`: replay a camera path, with what each frame cost.

use super::flight_path::PathArgs;
use super::flight_text::{Comparison, frames_json, print_summary, print_table, summary_json};
use crate::args::{ControlArgs, DrawArgs, FinenessArgs, LensArgs, LodName, SourceArgs};
use crate::failure::Failure;
use crate::inputs::Opened;
use crate::pictures::{self, StyleArgs};
use crate::progress::Bar;
use crate::{inputs, out, text, values};
use clap::Args;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use yamanami::{
    CameraPath, Canvas, DrawWith, FlightMode, FlightOptions, FrameStats, Subject, measure_rate, triangles_at_rate,
    write_flight_plots, write_path,
};

/// Replay a camera path: frames, statistics, plots
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami fly dem.tif --budget 5000             along the valleys, at most 5,000 triangles
  yamanami fly dem.tif --budget 5000 --lod paper -o flight
                                                 the paper's feedback, with plots and pictures
  yamanami fly dem.yama --tolerance-px 1 --path orbit --frames 600 --speed 15
  yamanami fly dem.yama --rate 60                what this machine draws 60 times a second
  yamanami fly dem.tif --budget 100000 --compare --no-draw
                                                 differences against rebuilding
  yamanami fly dem.yama --path my.json --json    a recorded path, numbers for a program
  yamanami fly scan.yama --budget 100000         around a model

A path file holds {\"fov_deg\": 57, \"frames\": [{\"eye\": [x, y, z], \"target\": [x, y, z]}, ...]},
x and y in the source's CRS, z in metres.

Without --tolerance, --tolerance-px or --budget errors up to 1 pixel are good enough.")]
pub(crate) struct FlyArgs {
    #[command(flatten)]
    source: SourceArgs,
    #[command(flatten)]
    fineness: FinenessArgs,
    /// Budget from the triangles a second that this machine draws, for so many frames a second
    #[arg(long, value_name = "FPS", value_parser = values::positive, help_heading = "How fine")]
    rate: Option<f64>,
    #[command(flatten)]
    control: ControlArgs,
    #[command(flatten)]
    path: PathArgs,
    /// Save the path flown, for --path
    #[arg(long, value_name = "FILE.json", help_heading = "Path")]
    save_path: Option<PathBuf>,
    #[command(flatten)]
    lens: LensArgs,
    #[command(flatten)]
    style: StyleArgs,
    #[command(flatten)]
    draw: DrawArgs,
    /// Do not draw: only the front, the mesh and its upload
    #[arg(long, help_heading = "Drawing")]
    no_draw: bool,
    /// Details appear at once instead of fading in
    #[arg(long, help_heading = "Drawing")]
    no_morph: bool,
    /// Start with nothing but the coarsest pages of a database in memory, instead of with those of the first view
    #[arg(long, help_heading = "Control")]
    cold: bool,
    /// Build and upload the whole mesh anew each frame
    #[arg(long, help_heading = "Control")]
    rebuild: bool,
    /// Fly twice more without drawing, by differences and by rebuilding, and compare
    #[arg(long, help_heading = "Control")]
    compare: bool,
    /// Folder for plots, flight.json and pictures
    #[arg(short, long, value_name = "DIR", help_heading = "Results")]
    output: Option<PathBuf>,
    /// So many frames are kept as PNG in the folder
    #[arg(long, value_name = "N", default_value_t = 5, requires = "output", help_heading = "Results")]
    pictures: usize,
    /// Print a row for every so many frames
    #[arg(long, value_name = "N", value_parser = values::frames, help_heading = "Results")]
    every: Option<usize>,
    /// Print JSON
    #[arg(long, help_heading = "Results")]
    json: bool,
}

pub(crate) fn run(args: &FlyArgs) -> Result<(), Failure> {
    if let Some(file) = &args.save_path {
        inputs::check_output(file, &["json"], &args.source.sources)?;
    }
    match inputs::subject(&args.source)? {
        Opened::Terrain(mut terrain) => over(args, &mut *terrain),
        Opened::Model(mut model) => over(args, &mut *model),
        Opened::Progressive(mut model) => over(args, &mut *model),
    }
}

fn over(args: &FlyArgs, subject: &mut impl Subject) -> Result<(), Failure> {
    if let Some(folder) = &args.output {
        inputs::make_folder(folder)?;
    }
    let viewport_px = args.lens.size.unwrap_or([1280, 720]);
    let mut path = args.path.views(subject, viewport_px)?;
    if let Some(fov_y_rad) = args.lens.fov {
        path.views.iter_mut().for_each(|view| view.fov_y_rad = fov_y_rad);
    }
    if let Some(file) = &args.save_path {
        write_path(subject, &path, file)?;
    }
    let with = args.draw.with();
    let mut fineness = args.fineness.clone();
    let mut rate = None;
    if let Some(frames_per_s) = args.rate {
        let _bar = Bar::spinner("measuring");
        let triangles_per_s = measure_rate(subject, with, viewport_px)?;
        let budget = triangles_at_rate(triangles_per_s, frames_per_s);
        fineness.budget = Some(fineness.budget.unwrap_or(u32::MAX).min(budget));
        rate = Some(triangles_per_s);
    }
    let first = path.views[0];
    let options = FlightOptions {
        criteria: args.control.limit(fineness.criteria(Some(first), !args.lens.no_cull, 1.0)),
        lod: args.control.lod(subject, fineness.tolerance),
        mode: if args.rebuild { FlightMode::Rebuild } else { FlightMode::Differences },
        draw: !args.no_draw,
        style: args.style.options(subject)?,
        morph: !args.no_morph,
    };
    let paper = args.control.lod == LodName::Paper;
    if !args.cold {
        warm_up(subject, &options)?;
    }
    let keep = args.output.as_deref().map(|folder| (folder, args.pictures));
    let flown = fly(subject, &path, &options, with, keep)?;
    let comparison = if args.compare { Some(compare(subject, &path, &options, with)?) } else { None };
    let mut result = json!({
        "path": args.path.name(subject),
        "lod": if paper { "paper" } else { "exact" },
        "mode": if args.rebuild { "rebuild" } else { "differences" },
        "budget_triangles": fineness.budget,
        "tolerance_m": options.criteria.terrain_tolerance_m,
        "tolerance_px": options.criteria.view.map(|v| v.tolerance_px),
        "viewport_px": viewport_px,
        "drawn_with": options.draw.then_some(flown.drawn_with),
        "triangles_per_s": rate,
        "summary": summary_json(&flown.frames, paper),
    });
    if let Some(terrain) = subject.as_terrain() {
        result["terrain"] = json!(terrain.title());
        result["width"] = json!(terrain.size()[0]);
        result["height"] = json!(terrain.size()[1]);
    } else {
        result["model"] = json!(subject.title());
        result["faces"] = json!(subject.full_triangles());
    }
    if let Some(comparison) = &comparison {
        result["comparison"] = comparison.to_json();
    }
    result["frames"] = frames_json(&flown.frames, paper);
    let written = match &args.output {
        Some(folder) => write_results(&flown, fineness.budget, subject.title(), folder, &result)?,
        None => Vec::new(),
    };
    if args.json {
        return out::json(&result);
    }
    print_table(&flown.frames, args.every, paper)?;
    out::line("")?;
    if let Some(rate) = rate {
        out::row("rate", format_args!("{} million triangles a second drawn here", text::number(rate / 1e6)))?;
    }
    print_summary(&flown.frames, fineness.budget, paper)?;
    if options.draw {
        out::row("drawn", format_args!("with {}, {} x {}", flown.drawn_with, viewport_px[0], viewport_px[1]))?;
    }
    if let Some(comparison) = &comparison {
        comparison.print()?;
    }
    if let Some(folder) = &args.output {
        out::row("written", format_args!("{}: {}", folder.display(), written.join(", ")))?;
    }
    Ok(())
}

/// Reads the pages that the first view of a flight needs.
pub(crate) fn warm_up(subject: &mut impl Subject, options: &FlightOptions) -> Result<(), Failure> {
    if subject.is_paged() {
        let _bar = Bar::spinner("reading");
        yamanami::extract(subject, &options.criteria)?;
    }
    Ok(())
}

/// A flight's frames and pictures.
#[derive(Debug)]
pub(crate) struct Flown {
    pub(crate) frames: Vec<FrameStats>,
    pub(crate) drawn_with: &'static str,
    pictures: Vec<String>,
}

/// Flies, and keeps some pictures in a folder.
pub(crate) fn fly(
    subject: &mut impl Subject,
    path: &CameraPath,
    options: &FlightOptions,
    with: DrawWith,
    keep: Option<(&Path, usize)>,
) -> Result<Flown, Failure> {
    let count = path.views.len();
    // spread evenly, the first and the last among them
    let kept = |i: usize| {
        keep.filter(|&(_, n)| n > 0).filter(|&(_, n)| {
            n >= count || (n == 1 && i == count / 2) || (0..n).any(|k| n > 1 && k * (count - 1) / (n - 1) == i)
        })
    };
    let canvas = Canvas::new(subject.bounds().centre(), with)?;
    let drawn_with = canvas.description();
    let bar = Bar::steps("flying", count);
    let (mut pictures, mut failure) = (Vec::new(), None);
    let frames = yamanami::fly(subject, canvas, path, options, |i, _, picture| {
        bar.set_step(i + 1);
        if let (Some((folder, _)), Some(picture), None) = (kept(i), picture, &failure) {
            let name = format!("frame-{i:05}.png");
            failure = pictures::write(&folder.join(&name), picture.clone()).err();
            pictures.push(name);
        }
        Ok(())
    })?;
    failure.map_or(Ok(Flown { frames, drawn_with, pictures }), Err)
}

/// The same flight by differences and by rebuilding, neither drawn.
pub(crate) fn compare(
    subject: &mut impl Subject,
    path: &CameraPath,
    options: &FlightOptions,
    with: DrawWith,
) -> Result<Comparison, Failure> {
    let mut run = |mode| {
        let options = FlightOptions { mode, draw: false, ..options.clone() };
        fly(subject, path, &options, with, None).map(|flown| flown.frames)
    };
    Ok(Comparison { differences: run(FlightMode::Differences)?, rebuild: run(FlightMode::Rebuild)? })
}

/// Writes plots and `flight.json` into a folder; gives the names of all results in it.
pub(crate) fn write_results(
    flown: &Flown,
    budget: Option<u32>,
    title: &str,
    folder: &Path,
    result: &Value,
) -> Result<Vec<String>, Failure> {
    let plots = {
        let _bar = Bar::spinner("plotting");
        write_flight_plots(&flown.frames, budget, title, folder)?
    };
    inputs::write_text(&folder.join("flight.json"), &format!("{result:#}\n"))?;
    let name = |p: &PathBuf| p.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    let mut names = vec!["flight.json".to_owned()];
    names.extend(plots.iter().map(name));
    names.extend(flown.pictures.iter().cloned());
    Ok(names)
}
