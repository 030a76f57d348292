//! `reproduce hori`: deformed maps by the paper's bands and by the engine, on bundled or given data and on made ground.

use super::map_args::read_overlays;
use super::reproduce::ReproduceArgs;
use crate::failure::Failure;
use crate::progress::{Bar, note};
use crate::{out, values};
use clap::Args;
use glam::DVec2;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use yamanami::core::{FieldLevel, NestedField};
use yamanami::measure::slope_sigma;
use yamanami::{
    HoriFound, HoriGround, HoriGroundFound, HoriJob, HoriMode, MapGroundOptions, MapImage, MapSources, NoData, hori,
};
use yamanami_testkit::{Shape, Spacing, SyntheticTerrain};

/// The bundled data: name and bytes.
const HEIGHTS: [(&str, &[u8]); 2] = [
    ("central_japan_srtm30.tif", include_bytes!("../../data/central_japan_srtm30.tif")),
    ("fuji_terrainrgb_z10_x906_y404.png", include_bytes!("../../data/fuji_terrainrgb_z10_x906_y404.png")),
];
const MOUNTAINS: (&str, &[u8]) = ("japan_mountains.csv", include_bytes!("../../data/japan_mountains.csv"));
const CREDITS: &str = "NASA / USGS SRTM30; Mapbox Terrain-RGB (MARTINI); JapanMountain";

/// Kofu, between Fuji and the Southern Alps.
const KOFU: [f64; 2] = [35.66, 138.57];
/// The paper's spacing, and what holds its blocks, metres.
const SPACING_M: f64 = 200.0;
const REACH_M: f64 = 816.0 * SPACING_M;
/// Pictures are this large, pixels.
const SIDE_PX: u32 = 1300;
/// Made ground: samples from the centre to a side, its σ for hypotenuses of 800 m, and its roughness, with which σ falls
/// with length as it does in real mountains, to a fifth at 18 km.
const MADE_HALF: u32 = 1024;
const MADE_SIGMA: f64 = 0.1;
const MADE_ROUGHNESS: f32 = 0.7;

/// What only `hori` takes.
#[derive(Debug, Args)]
#[command(next_help_heading = "hori")]
pub(crate) struct HoriArgs {
    /// hori: elevation files, tile folders, .yama databases, in place of the bundled SRTM30 of central Japan
    #[arg(value_name = "SOURCE")]
    pub(crate) sources: Vec<PathBuf>,
    /// Centre of the map, degrees [default: Kofu, 35.66,138.57]
    #[arg(long, value_name = "LAT,LON", value_parser = values::lat_lon, allow_hyphen_values = true)]
    at: Option<[f64; 2]>,
    /// Named places: CSV, GeoJSON or GeoPackage [default: the bundled mountains of Japan]
    #[arg(long, value_name = "FILE")]
    places: Vec<PathBuf>,
    /// Rivers, roads, railways: GeoJSON, GeoPackage, Shapefile or CSV with WKT
    #[arg(long, value_name = "FILE")]
    lines: Vec<PathBuf>,
    /// A picture with a georeference for the inner 10 km
    #[arg(long, value_name = "FILE")]
    image: Option<PathBuf>,
    /// Print the figures as JSON
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &ReproduceArgs) -> Result<(), Failure> {
    let own = &args.hori;
    let [lat, lon] = own.at.unwrap_or(KOFU);
    let bar = Bar::spinner("reading the ground");
    let (sources, credits) = if own.sources.is_empty() {
        let bundled: Result<Vec<PathBuf>, Failure> =
            HEIGHTS.iter().map(|&(name, bytes)| unpacked(&args.output, name, bytes)).collect();
        (bundled?, vec![CREDITS.to_owned()])
    } else {
        (own.sources.clone(), Vec::new())
    };
    let options = MapGroundOptions {
        radius_m: REACH_M,
        spacing_m: SPACING_M,
        finest_spacing_m: SPACING_M,
        no_data: NoData::Sea,
        ..MapGroundOptions::around([lon, lat])
    };
    let ground = MapSources::open(&sources, &args.reading.options().dem)?.read(&options)?;
    let places = if own.places.is_empty() {
        let (name, bytes) = MOUNTAINS;
        vec![unpacked(&args.output, name, bytes)?]
    } else {
        own.places.clone()
    };
    let (mut places, mut lines, skipped) = read_overlays(&places, &own.lines, &[])?;
    yamanami::lay_places(&mut places, &ground.plane);
    yamanami::lay_lines(&mut lines, &ground.plane);
    for line in skipped {
        note(&line);
    }
    let image = own.image.as_deref().map(|file| MapImage::read(file, None)).transpose()?;
    let image = image.map(|image| (image, ground.plane));
    let parts: Vec<String> = ground
        .sources
        .iter()
        .map(|source| {
            let name = source.path.file_name().unwrap_or_default().to_string_lossy();
            format!("{name} (a sample every {:.0} m, {:.1} % of the ground)", source.spacing_m, 100.0 * source.share)
        })
        .collect();
    let coarsest_m = ground.sources.iter().map(|source| source.spacing_m).fold(0.0, f64::max);
    let thin =
        if coarsest_m > SPACING_M { ", between whose samples the grid of 200 m has no detail of its own" } else { "" };
    let title = format!("latitude {lat}, longitude {lon}; {}{thin}", parts.join(", "));
    let job = HoriJob {
        ground: HoriGround { name: "real".to_owned(), title, field: ground.field },
        made: made(),
        side_px: SIDE_PX,
        centre_lon_lat: Some(DVec2::new(lon, lat)),
        places,
        lines,
        image,
        credits,
    };
    let found = hori(job, &args.output, &|step| bar.set_job(step))?;
    drop(bar);
    if own.json { out::json(&to_json(&found)) } else { out::line(found.page.display()) }
}

/// A bundled file beside the page, so that its other maps can be made of it.
fn unpacked(folder: &Path, name: &str, bytes: &[u8]) -> Result<PathBuf, Failure> {
    let path = folder.join(name);
    out::file(&path, bytes)?;
    Ok(path)
}

/// Rough ground, and the same with its lower half at sea level.
fn made() -> Vec<HoriGround> {
    let width = 2 * MADE_HALF as usize + 1;
    let shape = Shape::Fractal { relief_m: 1_000.0, roughness: MADE_ROUGHNESS, seed: 7 };
    let mut heights_m =
        SyntheticTerrain::new(width, width, shape, Spacing::Metres(SPACING_M)).to_field().into_heights_m();
    let grid = FieldLevel::new(SPACING_M, MADE_HALF, heights_m.clone());
    let sigma = slope_sigma(&grid, DVec2::ZERO, grid.reach_m()).into_iter().find(|row| row.hypotenuse_m >= 799.0);
    let factor = sigma.map_or(1.0, |row| MADE_SIGMA / row.sigma) as f32;
    let lowest = heights_m.iter().copied().fold(f32::INFINITY, f32::min);
    heights_m.iter_mut().for_each(|z| *z = factor * (*z - lowest));
    let mut sorted = heights_m.clone();
    let middle = sorted.len() / 2;
    let median = *sorted.select_nth_unstable_by(middle, f32::total_cmp).1;
    let sea = heights_m.iter().map(|z| (z - median).max(0.0)).collect();
    let ground = |name: &str, title: &str, heights_m: Vec<f32>| HoriGround {
        name: name.to_owned(),
        title: title.to_owned(),
        field: NestedField::new(vec![FieldLevel::new(SPACING_M, MADE_HALF, heights_m)]),
    };
    vec![
        ground("rough", "rough ground, made, 2,049² samples of 200 m, σ(0.8 km) = 0.1", heights_m),
        ground("half_sea", "the same, its lower half at sea level", sea),
    ]
}

fn to_json(found: &HoriFound) -> Value {
    let mode = |mode: &HoriMode| {
        let far = &mode.report.far;
        json!({
            "name": mode.name,
            "triangles": mode.triangles,
            "full_triangles": mode.full_triangles,
            "bound_px": mode.bound_px,
            "keeps_bound": mode.keeps_bound(),
            "max_px": mode.report.all.max_px,
            "p999_px": far.p999_px,
            "p99_px": far.p99_px,
            "rms_px": far.rms_px,
            "share_over_1_5_px": far.over_split,
            "share_over_3_5_px": far.over_large,
            "height_bias_m": mode.report.height_bias_m,
        })
    };
    let ground = |ground: &HoriGroundFound| {
        json!({
            "name": ground.name,
            "title": ground.title,
            "known_share": ground.known_share,
            "ring_px": ground.view.ring_px,
            "modes": ground.modes.iter().map(mode).collect::<Vec<_>>(),
        })
    };
    let draw =
        |draw: &yamanami::HoriDraw| json!({ "name": draw.name, "triangles": draw.triangles, "draw_ms": draw.draw_ms });
    let flight = |flight: &yamanami::HoriFlight| {
        json!({
            "name": flight.name,
            "frames": flight.frames,
            "triangles_fewest_most": flight.triangles,
            "update_ms_mean_worst": flight.update_ms,
            "refined_mean": flight.refined,
            "coarsened_mean": flight.coarsened,
            "bytes_mean_most": flight.bytes,
            "bound_px": flight.bound_px,
        })
    };
    json!({
        "page": found.page,
        "grounds": found.grounds.iter().map(ground).collect::<Vec<_>>(),
        "draws": found.draws.iter().map(draw).collect::<Vec<_>>(),
        "flights": found.flights.iter().map(flight).collect::<Vec<_>>(),
    })
}
