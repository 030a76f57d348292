//! `export`: standard files for other programs' viewers.

use crate::args::SourceArgs;
use crate::failure::Failure;
use crate::inputs::{self, Opened};
use crate::progress::{Bar, note};
use crate::{out, text, values};
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use std::path::PathBuf;
use std::time::Instant;
use yamanami::io::dem::TileEncoding;
use yamanami::{
    ExportJob, ExportKind, ExportOptions, ExportReport, ExportSubject, Fill, GeoidChoice, GlbPacking, HeightKind,
    ZoomReport, export,
};

/// Write tiles for other viewers: 3D Tiles, quantized-mesh, terrain-rgb, glb, or a web site
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami export dem.tif --to quantized-mesh -o tiles        for CesiumJS and others: a folder with layer.json
  yamanami export dem.yama --to quantized-mesh --tolerance 2 --zooms 0..14 --normals -o tiles
  yamanami export dem.tif --to 3dtiles --heights orthometric -o tiles
                                                on the globe; heights above the sea become ellipsoidal by EGM96
  yamanami export scan.yama --to 3tz -o scan.3tz              a scan, every triangle of it, in one archive
  yamanami export scan.ply --to glb --budget 100000 -o scan.glb
                                                100,000 triangles, packed small
  yamanami export dem.tif --to terrain-rgb -o dem.pmtiles      for MapLibre and others, in one archive; else a folder
  yamanami export dem.yama scan.yama --to site -o site         the browser viewer as files for any web host

A tile tree appears whole under its name; a run that was stopped goes on where it was when it is called again.")]
pub(crate) struct ExportArgs {
    #[command(flatten)]
    pub(super) source: SourceArgs,
    /// What to write
    #[arg(long, value_enum, value_name = "KIND")]
    to: KindName,
    /// The file or folder to write
    #[arg(short, long, value_name = "OUT")]
    pub(super) output: PathBuf,
    /// No sample is further than so many metres from the finest zoom; each coarser one may be twice as far off. Default: a
    /// quarter of the samples' spacing; of a scan or TIN every triangle
    #[arg(long, value_name = "M", value_parser = values::positive, help_heading = "How fine")]
    tolerance: Option<f64>,
    /// Coarsest and finest zoom. Default: all that the data ask for
    #[arg(long, value_name = "A..B", value_parser = values::zooms, help_heading = "How fine")]
    zooms: Option<[u32; 2]>,
    /// Height above the ellipsoid of what lies where there is no data, metres, or: none
    #[arg(long, value_name = "M", default_value = "0", value_parser = fill, allow_hyphen_values = true)]
    fill_m: Fill,
    /// Give vertices normals
    #[arg(long)]
    normals: bool,
    /// Most triangles of a glb
    #[arg(long, value_name = "N", help_heading = "How fine")]
    budget: Option<u32>,
    /// From where the source's heights count. Default: as the source says, else from the ellipsoid
    #[arg(long, value_enum, value_name = "KIND", help_heading = "Heights")]
    heights: Option<HeightsName>,
    /// The geoid, as an elevation file of its heights above the ellipsoid by longitude and latitude. Default: EGM96
    #[arg(long, value_name = "FILE", conflicts_with = "geoid_offset_m", help_heading = "Heights")]
    geoid: Option<PathBuf>,
    /// The geoid as so many metres above the ellipsoid everywhere
    #[arg(long, value_name = "M", allow_hyphen_values = true, value_parser = values::number, help_heading = "Heights")]
    geoid_offset_m: Option<f64>,
    /// How glTF is packed
    #[arg(long, value_enum, value_name = "KIND", default_value = "meshopt")]
    packing: PackingName,
    /// What the colours of terrain-rgb mean: terrain-rgb, terrarium or gsi
    #[arg(long, value_name = "NAME", default_value = "terrain-rgb", value_parser = values::tile_encoding, help_heading = "terrain-rgb")]
    encoding: TileEncoding,
    /// Pixels along a side of a terrain-rgb tile: 256 or 512
    #[arg(long, value_name = "N", default_value = "256", value_parser = values::tile_px, help_heading = "terrain-rgb")]
    tile_px: u32,
    /// Folder of a built viewer for a site, in place of the one in the program
    #[cfg(feature = "serve")]
    #[arg(long, value_name = "DIR", help_heading = "site")]
    pub(super) web: Option<PathBuf>,
    /// Measure every sample against what was written; a broken promise is a failure
    #[arg(long, help_heading = "Results")]
    check: bool,
    /// Print JSON
    #[arg(long, help_heading = "Results")]
    pub(super) json: bool,
}

/// Names of what can be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum KindName {
    /// A folder of 3D Tiles 1.1
    #[value(name = "3dtiles")]
    Tiles3d,
    /// The same in one archive
    #[value(name = "3tz")]
    Tiles3tz,
    /// A folder of quantized-mesh 1.0 tiles with layer.json
    QuantizedMesh,
    /// Heights as colours of PNG tiles
    TerrainRgb,
    /// One binary glTF
    Glb,
    /// A web page with the browser viewer and its data
    Site,
}

/// Names of what heights count from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum HeightsName {
    /// The ellipsoid, as satellite receivers measure
    Ellipsoidal,
    /// The geoid: above the sea, as maps have them
    Orthometric,
}

/// Names of packings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum PackingName {
    /// Single precision, for any reader
    Plain,
    /// Small integers (KHR_mesh_quantization)
    Quantised,
    /// Those, coded (EXT_meshopt_compression)
    Meshopt,
}

impl KindName {
    /// The library's kind; a site is put together here, since the library has no viewer.
    fn kind(self) -> Option<ExportKind> {
        Some(match self {
            Self::Tiles3d => ExportKind::Tiles3d,
            Self::Tiles3tz => ExportKind::Tiles3tz,
            Self::QuantizedMesh => ExportKind::QuantizedMesh,
            Self::TerrainRgb => ExportKind::TerrainRgb,
            Self::Glb => ExportKind::Glb,
            Self::Site => return None,
        })
    }
}

fn fill(text: &str) -> Result<Fill, String> {
    if text == "none" {
        return Ok(Fill::Nothing);
    }
    match values::number(text) {
        Ok(m) if m.abs() <= 100_000.0 => Ok(Fill::At(m)),
        _ => Err("expected metres from -100000 to 100000, or none".to_owned()),
    }
}

pub(crate) fn run(args: &ExportArgs) -> Result<(), Failure> {
    let Some(kind) = args.to.kind() else {
        #[cfg(feature = "serve")]
        return super::site::run(args);
        #[cfg(not(feature = "serve"))]
        return Err(Failure::failed(
            "this program was built without the browser viewer: build it with the feature serve",
        ));
    };
    let options = ExportOptions {
        tolerance_m: args.tolerance,
        zooms: args.zooms,
        fill: args.fill_m,
        normals: args.normals,
        heights: args.heights.map(|kind| match kind {
            HeightsName::Ellipsoidal => HeightKind::Ellipsoidal,
            HeightsName::Orthometric => HeightKind::Orthometric,
        }),
        geoid: match (&args.geoid, args.geoid_offset_m) {
            (Some(path), _) => GeoidChoice::File(path.clone()),
            (None, Some(height_m)) => GeoidChoice::Constant(height_m),
            (None, None) => GeoidChoice::Egm96,
        },
        packing: match args.packing {
            PackingName::Plain => GlbPacking::Plain,
            PackingName::Quantised => GlbPacking::Quantised,
            PackingName::Meshopt => GlbPacking::Meshopt,
        },
        budget_triangles: args.budget,
        tile_encoding: args.encoding,
        tile_px: args.tile_px,
        check: args.check,
    };
    match args.to {
        KindName::Glb => inputs::check_output(&args.output, &["glb"], &args.source.sources)?,
        KindName::Tiles3tz => inputs::check_output(&args.output, &["3tz"], &args.source.sources)?,
        _ => {}
    }
    let mut opened = inputs::subject(&args.source)?;
    let subject = match &mut opened {
        Opened::Terrain(terrain) => ExportSubject::Terrain(terrain),
        Opened::Model(model) => ExportSubject::Model(model),
        Opened::Progressive(_) => {
            return Err(Failure::failed(format!(
                "{}: expected a terrain, a scan or a TIN, found a progressive model; extract it first",
                args.source.sources[0].display()
            )));
        }
    };
    let started = Instant::now();
    let report = {
        let bar = Bar::shares("exporting");
        let progress = |share| bar.set_share(share);
        let job =
            ExportJob { sources: &args.source.sources, output: &args.output, options: &options, progress: &progress };
        export(kind, subject, &job)?
    };
    let seconds = started.elapsed().as_secs_f64();
    report.notes.iter().for_each(|line| note(&format!("note: {line}")));
    if args.json {
        out::json(&to_json(args, &report, seconds))?
    } else {
        print(args, &report, seconds)?
    }
    verdict(&report)
}

/// A check that finds a broken promise is a failure.
fn verdict(report: &ExportReport) -> Result<(), Failure> {
    let broken = report.zooms.iter().find(|z| z.measured_m.is_some_and(|m| m > z.error_m));
    broken.map_or(Ok(()), |z| {
        let measured_m = z.measured_m.unwrap_or_default();
        Err(Failure::failed(format!(
            "check: zoom {} is {measured_m} m off, at most {} m was promised",
            z.zoom, z.error_m
        )))
    })
}

fn total(report: &ExportReport, of: impl Fn(&ZoomReport) -> u64) -> u64 {
    report.zooms.iter().map(of).sum()
}

fn to_json(args: &ExportArgs, report: &ExportReport, seconds: f64) -> Value {
    let zooms: Vec<Value> = report
        .zooms
        .iter()
        .map(|z| {
            json!({
                "zoom": z.zoom, "tiles": z.tiles, "triangles": z.triangles, "bytes": z.bytes,
                "error_m": z.error_m, "measured_m": z.measured_m,
            })
        })
        .collect();
    json!({
        "output": args.output,
        "tiles": total(report, |z| z.tiles),
        "bytes": total(report, |z| z.bytes),
        "kept_tiles": report.kept,
        "seconds": seconds,
        "zooms": zooms,
    })
}

fn print(args: &ExportArgs, report: &ExportReport, seconds: f64) -> Result<(), Failure> {
    let (tiles, bytes) = (total(report, |z| z.tiles), total(report, |z| z.bytes));
    out::row(
        "written",
        format_args!("{}, {} tiles, {}", args.output.display(), text::count(tiles), text::bytes(bytes)),
    )?;
    for z in &report.zooms {
        let measured = z.measured_m.map_or_else(String::new, |m| format!(", measured {} m", text::number(m)));
        let triangles = match z.triangles {
            0 => String::new(),
            n => format!("{} triangles, ", text::count(n)),
        };
        out::row(
            &format!("zoom {}", z.zoom),
            format_args!(
                "{} tiles, {triangles}{}, within {} m{measured}",
                text::count(z.tiles),
                text::bytes(z.bytes),
                text::number(z.error_m),
            ),
        )?;
    }
    if report.kept > 0 {
        out::row("kept", format_args!("{} tiles of a run that was stopped", text::count(report.kept)))?;
    }
    out::row("time", format_args!("{} s", text::number(seconds)))
}
