//! `map`: a deformed map, the near as a map and the far as mountains, as a picture or a page.

use super::map_args::{
    Lang, MapFinenessArgs, MapLod, OverlayArgs, PlaceArgs, ProjectionArgs, SUMMITS, SheetArgs, map_places_and_lines,
};
use super::map_text;
use crate::args::ReadingArgs;
use crate::failure::Failure;
use crate::progress::{Bar, note};
use crate::{inputs, out};
use clap::Args;
use glam::DVec2;
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::time::Instant;
use yamanami::core::{DeformedMap, MapView, NamedPlace};
use yamanami::gpu::Wireframe;
use yamanami::map::{
    Fonts, HiddenNames, InkStyle, Language, MissingGlyphs, PackedBase, SeenFrom, SheetOptions, encode_png,
};
use yamanami::multires::rtin::BuildOptions;
use yamanami::{DeformedScene, DrawWith, MadeMap, MapGround, MapImage, MapJob, MapMesh, MapSources, make_map};

/// Endings of what `map` writes.
const MAP_ENDINGS: [&str; 3] = ["png", "svg", "pdf"];
/// Eye of somebody who stands at the centre, above the ground, metres.
const STANDING_M: f64 = 1.7;
/// Dots an inch of a page that was asked for in pixels.
const SCREEN_DPI: f64 = 96.0;

/// A map near, mountains far, in one picture
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami map japan.tif --at 35.36,138.73 -o fuji.png       160 km around Mt Fuji
  yamanami map japan.yama fuji_z10_x906_y404.png --at 35.66,138.57 --radius 110 --ring 30
      --eye 9000 --exaggeration 1.8 --places mountains.csv --title Kofu -o kofu.pdf --paper a1
                                                             several sources, names, a poster
  yamanami map japan.tif --at 35.36,138.73 --places m.csv -o fuji.png --json
                                                             with the place of every name
  yamanami map japan.tif --at 35.36,138.73 --alpha 0.3 --alpha-fall 1 --lines rivers.gpkg -o m.svg
                                                             more map beyond the ring, rivers

Within the ring it is a plain map: distances and bearings are true. Beyond it the ground tips up, as if
seen from above the ring (the projection of Hori et al.). The eye must stand above all ground near the
ring; a lower eye or more exaggeration makes the far mountains rise higher.")]
pub(crate) struct MapArgs {
    /// A .yama database, elevation files and tile folders: finer ones lie over coarser ones
    #[arg(required = true, value_name = "SOURCE")]
    sources: Vec<PathBuf>,
    #[command(flatten)]
    reading: ReadingArgs,
    /// The map to write: .png, .svg or .pdf
    #[arg(short, long, value_name = "FILE", help_heading = "Results")]
    output: PathBuf,
    #[command(flatten)]
    place: PlaceArgs,
    #[command(flatten)]
    projection: ProjectionArgs,
    #[command(flatten)]
    fineness: MapFinenessArgs,
    #[command(flatten)]
    overlay: OverlayArgs,
    #[command(flatten)]
    sheet: SheetArgs,
    /// Print JSON, with the place of every name
    #[arg(long, help_heading = "Results")]
    json: bool,
}

/// Milliseconds that the parts of a map took.
#[derive(Debug, Default)]
pub(super) struct Times {
    pub(super) read_ms: f64,
    pub(super) build_ms: f64,
    pub(super) make_ms: f64,
    pub(super) write_ms: f64,
}

/// A map written, and what it was made of.
pub(super) struct Written {
    pub(super) job: MapJob,
    pub(super) ground: MapGround,
    pub(super) full_triangles: u64,
    pub(super) places: Vec<NamedPlace>,
    pub(super) made: MadeMap,
    pub(super) times: Times,
}

pub(crate) fn run(args: &MapArgs) -> Result<(), Failure> {
    let written = write_map(args)?;
    if args.json { out::json(&map_text::to_json(&written)) } else { map_text::print(&args.output, &written) }
}

/// Makes the map and writes it.
pub(super) fn write_map(args: &MapArgs) -> Result<Written, Failure> {
    let mut inputs = args.sources.clone();
    inputs.extend(args.overlay.files());
    inputs::check_output(&args.output, &MAP_ENDINGS, &inputs)?;
    let map = args.projection.map()?;
    let fonts = fonts(&args.overlay)?;
    let mut times = Times::default();

    let started = Instant::now();
    let ground = read_ground(args)?;
    times.read_ms = ms(started);
    if ground.known_share < 0.999 {
        note(&format!(
            "the data cover {:.1} % of the {} km around; only that is drawn",
            100.0 * ground.known_share,
            args.place.radius
        ));
    }
    let (places, lines, skipped) = map_places_and_lines(&args.overlay, &ground.plane)?;
    for line in skipped {
        note(&line);
    }
    let started = Instant::now();
    let MapGround { field, plane, .. } = ground.clone();
    let mut scene = {
        let _bar = Bar::spinner("hierarchy");
        DeformedScene::new(field, &BuildOptions { summits: Some(SUMMITS) }, DrawWith::Software)?
    };
    times.build_ms = ms(started);
    let mut job = job(args, map, &scene, fonts);
    let image = args.overlay.image.as_deref().map(|file| MapImage::read(file, args.overlay.image_crs.as_ref()));
    job.image = image.transpose()?.map(|image| (image, plane));

    let started = Instant::now();
    let [lat, lon] = args.place.at;
    let bar = RefCell::new((Bar::shares("mesh"), "mesh".to_owned()));
    let made = make_map(&mut scene, &job, Some(DVec2::new(lon, lat)), &places, &lines, &|part, share| {
        let (bar, last) = &mut *bar.borrow_mut();
        if part != last {
            bar.set_job(part);
            part.clone_into(last);
        }
        bar.set_share(share);
    })?;
    drop(bar);
    times.make_ms = ms(started);
    if let Some(covered) = made.image_share
        && covered < 0.999
    {
        note(&format!("the picture covers {:.1} % of the plain map and around", 100.0 * covered));
    }
    if let Some(line) = MissingGlyphs::summary(&made.composed.missing) {
        note(&line);
    }
    let started = Instant::now();
    let (_, dpi) = args.sheet.size_px();
    let made = write(&args.output, made, &job, dpi)?;
    times.write_ms = ms(started);
    let full_triangles = map_text::full_triangles(scene.field(), &job.view);
    Ok(Written { job, ground, full_triangles, places, made, times })
}

fn ms(since: Instant) -> f64 {
    1e3 * since.elapsed().as_secs_f64()
}

pub(super) fn fonts(overlay: &OverlayArgs) -> Result<Fonts, Failure> {
    let Some(file) = &overlay.font else { return Ok(Fonts::default()) };
    let bytes = std::fs::read(file).map_err(|e| Failure::failed(format!("{}: {e}", file.display())))?;
    Fonts::with(bytes).map_err(|e| Failure::failed(format!("{}: {e}", file.display())))
}

fn read_ground(args: &MapArgs) -> Result<MapGround, Failure> {
    let _bar = Bar::spinner("ground");
    Ok(MapSources::open(&args.sources, &args.reading.options().dem)?.read(&args.place.ground())?)
}

/// What is to be made, the picture laid out around the sheet's furniture.
fn job(args: &MapArgs, map: DeformedMap, scene: &DeformedScene, fonts: Fonts) -> MapJob {
    let (size_px, dpi) = args.sheet.size_px();
    let is_bare = args.sheet.bare;
    let mut sheet = SheetOptions {
        point_px: SheetOptions::point_px_for(size_px, dpi),
        language: match args.overlay.lang {
            Lang::Ja => Language::Ja,
            Lang::En => Language::En,
        },
        names: args.overlay.names(),
        hidden: if args.overlay.hidden { HiddenNames::Grey } else { HiddenNames::Drop },
        name_rings: args.overlay.name_rings,
        has_title: args.sheet.title.is_some(),
        has_credits: args.sheet.credit.is_some(),
        ..SheetOptions::default()
    };
    if is_bare {
        sheet = SheetOptions { point_px: sheet.point_px, ..args.sheet.bare() };
    }
    if args.sheet.transparent {
        sheet.paper = None;
    }
    let [_, top_m] = scene.field().range_m();
    let rim_m = 1000.0 * args.place.radius;
    let view = MapView {
        up_azimuth_rad: args.place.up.to_radians(),
        ..MapView::fitted(map, size_px, rim_m, f64::from(top_m), sheet.margin_px())
    };
    let haze_m = if args.sheet.haze > 0.0 { 1000.0 * args.sheet.haze } else { f64::INFINITY };
    let relief = args.place.relief(haze_m);
    MapJob {
        view,
        mesh: match args.fineness.lod {
            MapLod::Exact => MapMesh::Exact { tolerance_px: args.fineness.tolerance_px, budget: args.fineness.budget },
            MapLod::Paper => MapMesh::Paper,
            MapLod::Full => MapMesh::Full,
        },
        relief: if args.sheet.stretch { relief.stretched_to(top_m) } else { relief },
        ink: Some(InkStyle { width_px: (0.55 * sheet.point_px).max(1.0), ..InkStyle::default() }),
        wireframe: args
            .sheet
            .wireframe
            .then(|| Wireframe { width_px: (0.4 * sheet.point_px) as f32, ..Wireframe::default() }),
        antialias: true,
        is_checked: args.fineness.check,
        seen_from: if args.overlay.from_ground {
            SeenFrom::Ground { eye_above_m: STANDING_M }
        } else {
            SeenFrom::Picture
        },
        sheet,
        title: args.sheet.title.clone().unwrap_or_default(),
        credits: args.sheet.credit.iter().cloned().collect(),
        image: None,
        fonts,
    }
}

/// Writes the map in the format of its ending. The picture of the ground is spent by it.
fn write(file: &Path, mut made: MadeMap, job: &MapJob, dpi: Option<f64>) -> Result<MadeMap, Failure> {
    let _bar = Bar::spinner("writing");
    let base = std::mem::take(&mut made.base);
    let ending = file.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let scene = &made.composed.scene;
    let bytes = if ending == "png" {
        encode_png(&scene.paint(base, &job.fonts)?, dpi)?
    } else {
        let dots_per_inch = dpi.unwrap_or(SCREEN_DPI);
        let packed = PackedBase::pack(&base, job.sheet.paper)?;
        drop(base);
        match ending.as_str() {
            "svg" => scene.to_svg(Some(&packed), dots_per_inch, &job.fonts).into_bytes(),
            _ => scene.to_pdf(Some(&packed), dots_per_inch, &job.fonts)?,
        }
    };
    out::file(file, &bytes)?;
    Ok(made)
}
