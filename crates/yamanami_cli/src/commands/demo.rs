//! `demo`: the main job on bundled real terrain, without options.

use super::flight_path::PathArgs;
use super::flight_text::{frames_json, frames_per_s, print_summary, summary_json};
use super::{demo_map, fly, render};
use crate::args::{DrawArgs, ReadingArgs, SEEN_PX};
use crate::failure::Failure;
use crate::progress::{Bar, note};
use crate::{inputs, out, pictures, text};
use clap::Args;
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;
use yamanami::gpu::{RenderOptions, Wireframe};
use yamanami::io::dem;
use yamanami::{Criteria, FlightMode, FlightOptions, Lod, StoreOptions, Subject, Terrain, ViewCriterion};

const SAN_GABRIEL: &[u8] = include_bytes!("../../data/bigtujunga_srtm1_30m.tif");
const MOUNT_WASHINGTON: &[u8] = include_bytes!("../../data/mt_washington_50m.tif");
const SAN_GABRIEL_NAME: &str = "bigtujunga_srtm1_30m.tif";
/// Above the mouth of Big Tujunga Canyon, looking up it to Mount Waterman: UTM zone 11N, metres.
const EYE: [f64; 3] = [381_000.0, 3_790_000.0, 3_500.0];
const TARGET: [f64; 3] = [394_000.0, 3_799_500.0, 700.0];
/// Triangles of the demo's flight.
const BUDGET: u32 = 20_000;
const FRAMES: usize = 240;
/// Metres that the eye moves each frame.
const SPEED_M: f64 = 45.0;

/// All of it on bundled real terrain: database, pictures, flight
#[derive(Debug, Args)]
#[command(after_help = "\
Reads a bundled DEM of the San Gabriel Mountains (SRTM, 1197 x 643 samples of 30 m), builds its
surface database, draws it, flies over it with at most 20,000 triangles, makes a deformed map of Kofu
and the mountains around it, and leaves all results in the folder.")]
pub(crate) struct DemoArgs {
    /// Folder for the results
    #[arg(short, long, value_name = "DIR", default_value = "demo-out")]
    output: PathBuf,
    #[command(flatten)]
    draw: DrawArgs,
}

fn bundled(name: &str, bytes: &[u8]) -> Result<Terrain, Failure> {
    let field = dem::from_bytes(name, bytes.to_vec(), &dem::OpenOptions::default())?.read_all()?;
    Ok(Terrain::build(field, name.to_owned(), &|_| ())?)
}

/// The San Gabriel Mountains, bundled.
pub(crate) fn san_gabriel() -> Result<Terrain, Failure> {
    bundled(SAN_GABRIEL_NAME, SAN_GABRIEL)
}

/// Mount Washington, bundled.
pub(crate) fn mount_washington() -> Result<Terrain, Failure> {
    bundled("mt_washington_50m.tif", MOUNT_WASHINGTON)
}

pub(crate) fn run(args: &DemoArgs) -> Result<(), Failure> {
    inputs::make_folder(&args.output)?;
    let at = |name: &str| args.output.join(name);
    let started = Instant::now();

    let database = at("bigtujunga.yama");
    let built = san_gabriel()?;
    let options = StoreOptions {
        source: format!("{SAN_GABRIEL_NAME} (NASA / USGS SRTM, public domain)"),
        ..StoreOptions::default()
    };
    {
        let bar = Bar::shares("database");
        built.store_as(&database, &options, &|share| bar.set_share(share))?;
    }
    drop(built);
    // from here on all comes from the database
    let mut terrain = inputs::open(std::slice::from_ref(&database), &ReadingArgs::default())?;
    let [width, height] = terrain.size();
    let full = 2 * (width - 1) * (height - 1);

    let with = args.draw.with();
    let bar = Bar::spinner("pictures");
    let view = yamanami::view_between(&terrain, EYE, TARGET, 38f64.to_radians(), [1600, 900]);
    let criteria =
        Criteria { view: Some(ViewCriterion { view, tolerance_px: 0.5, cull: true }), ..Criteria::default() };
    let mut style = terrain.usual_style();
    style.light.strength = 2.0;
    style.light.sun_altitude_rad = 0.65;
    let relief = render::picture(&mut terrain, &criteria, &view, &style, with)?;
    pictures::write(&at("relief.png"), relief.picture)?;
    let few = Criteria { budget_triangles: Some(BUDGET), ..criteria };
    let wired = RenderOptions { wireframe: Some(Wireframe::default()), ..style.clone() };
    let wireframe = render::picture(&mut terrain, &few, &view, &wired, with)?;
    pictures::write(&at("wireframe.png"), wireframe.picture)?;
    drop(bar);

    let path = PathArgs { path: Some("valley".to_owned()), frames: Some(FRAMES), speed: Some(SPEED_M) };
    let path = path.views(&terrain, [1280, 720])?;
    let criteria = Criteria {
        view: path.views.first().map(|&view| ViewCriterion { view, tolerance_px: SEEN_PX, cull: true }),
        budget_triangles: Some(BUDGET),
        ..Criteria::default()
    };
    let options =
        FlightOptions { criteria, lod: Lod::Exact, mode: FlightMode::Differences, draw: true, style, morph: true };
    fly::warm_up(&mut terrain, &options)?;
    let flown = fly::fly(&mut terrain, &path, &options, with, Some((&args.output, 3)))?;
    let comparison = fly::compare(&mut terrain, &path, &options, with)?;
    let result = json!({
        "terrain": terrain.title(),
        "width": width,
        "height": height,
        "path": "valley",
        "lod": "exact",
        "mode": "differences",
        "budget_triangles": BUDGET,
        "viewport_px": [1280, 720],
        "drawn_with": flown.drawn_with,
        "summary": summary_json(&flown.frames, false),
        "comparison": comparison.to_json(),
        "frames": frames_json(&flown.frames, false),
    });
    let written = fly::write_results(&flown, Some(BUDGET), "San Gabriel Mountains", &args.output, &result)?;

    let bytes = inputs::file_bytes(&database)?;
    out::line("San Gabriel Mountains, California: SRTM 1\", 30 m")?;
    out::row("samples", format_args!("{width} x {height}; {} triangles at full resolution", text::count(full as u64)))?;
    out::row(
        "database",
        format_args!(
            "{}, every level, lossless; the source file has {}",
            text::bytes(bytes),
            text::bytes(SAN_GABRIEL.len() as u64)
        ),
    )?;
    out::row(
        "relief.png",
        format_args!(
            "{} triangles ({} % of all), error at most {} px",
            text::count(relief.report.triangles as u64),
            text::number(100.0 * relief.report.triangles as f64 / full as f64),
            text::number(f64::from(relief.report.error_left))
        ),
    )?;
    out::line("")?;
    let fps = text::number(frames_per_s(&flown.frames));
    out::line(format_args!(
        "Flight of {FRAMES} frames, 1280 x 720, drawn with {} at {fps} frames a second",
        flown.drawn_with
    ))?;
    print_summary(&flown.frames, Some(BUDGET), false)?;
    comparison.print()?;
    out::line("")?;
    demo_map::run(&args.output)?;
    out::line("")?;
    out::row(
        "written",
        format_args!(
            "{}: bigtujunga.yama, relief.png, wireframe.png, map.png, {}",
            args.output.display(),
            written.join(", ")
        ),
    )?;
    note(&format!("all of it took {} s", text::number(started.elapsed().as_secs_f64())));
    let (folder, name) = (args.output.display(), database.display());
    out::line("")?;
    out::line("Next, with your own DEM in place of the database:")?;
    out::line(format_args!("  yamanami extract {name} --tolerance 10 --check -o {folder}/mesh.glb"))?;
    out::line(format_args!("  yamanami render {name} --budget 20000 --wireframe -o {folder}/mine.png"))?;
    out::line(format_args!("  yamanami fly {name} --budget 100000 --path orbit -o {folder}/orbit"))?;
    out::line(format_args!("  yamanami map {folder}/map-data/*.tif --at 35.36,138.73 -o {folder}/fuji.png"))
}
