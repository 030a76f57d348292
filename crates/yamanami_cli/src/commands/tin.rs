//! `tin`: makes, converts and thins TINs.

use crate::args::ReadingArgs;
use crate::failure::Failure;
use crate::progress::{Bar, note};
use crate::{inputs, out, text, values};
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use yamanami::core::Tin;
use yamanami::io::points::{ColumnOrder, is_points_name};
use yamanami::io::tin_file::{self, TinReadOptions};
use yamanami::io::{dem, mesh_file};
use yamanami::multires::tin_block::CostReading;
use yamanami::{GroundOptions, ModelBuild, ModelStoreOptions, ReadGround, ThinBy, ThinLevel, read_ground, thin};

/// Make a TIN from points and breaklines or elevation grids, convert TINs, thin them
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami tin ground.xml -o ground.dxf                  LandXML to DXF, every face and breakline
  yamanami tin ground.yama -o ground.xml                 and back out of a database, bit for bit
  yamanami tin survey.csv --breaklines edges.geojson -o ground.xml
  yamanami tin lidar.laz --longest-edge 20 -o ground.yama
                                                         constrained Delaunay triangulations of points
  yamanami tin dem.tif --error 0.5 -o ground.xml         a TIN within 50 cm of every sample
  yamanami tin ground.xml --levels 3 -o eighth.xml       halves it three times, with each level's true error
  yamanami tin ground.xml --levels 3 --method hiraoka -o eighth.xml
                                                         the same by the paper's decimation
  yamanami tin two.xml --surface design -o design.yama   one surface of several

Formats: LandXML (.xml), DXF, 2DM, GeoPackage (written only), CityGML relief (.gml) and quantized-mesh
(.terrain, both read only), .yama; .ply, .obj, .stl, .off and .glb of terrain. Faces that overlap in plan, stand
upright or are there twice are dropped, clockwise ones turned, and each is told.")]
pub(crate) struct TinArgs {
    /// A TIN, a mesh that is terrain, or the .yama of a TIN; points (.csv, .txt, .xyz, .sim, .las, .laz), several together;
    /// with --error, elevation files that make one mosaic
    #[arg(required = true, value_name = "SOURCE")]
    sources: Vec<PathBuf>,
    /// The TIN to write
    #[arg(short, long, value_name = "FILE", help_heading = "Results")]
    output: PathBuf,
    /// Which surface of the file, by name; else the largest
    #[arg(long, value_name = "NAME", help_heading = "Reading")]
    surface: Option<String>,
    /// Metres in a unit of the file's coordinates, over what it says: 0.3048 for feet, 0.001 for millimetres
    #[arg(long, value_name = "M", value_parser = values::positive, help_heading = "Reading")]
    unit: Option<f64>,
    /// Lines that no triangle crosses: GeoJSON, text of line, x, y, z, or those of a TIN or DXF file; may be given again
    #[arg(long, value_name = "FILE", help_heading = "Reading")]
    breaklines: Vec<PathBuf>,
    /// Of points: leave out triangles with a longer edge in plan, metres
    #[arg(long, value_name = "M", value_parser = values::positive, help_heading = "Reading")]
    longest_edge: Option<f64>,
    /// Of points in text: the first coordinate is the northing, as surveyors in Japan write it
    #[arg(long, help_heading = "Reading")]
    north_first: bool,
    /// Of LAS and LAZ: take this class; may be given again. Else ground (2) where there is any
    #[arg(long, value_name = "N", help_heading = "Reading")]
    class: Vec<u8>,
    #[command(flatten)]
    reading: ReadingArgs,
    /// Of elevation files: a TIN within so many metres of every sample
    #[arg(long, value_name = "M", value_parser = values::not_negative, help_heading = "How fine")]
    error: Option<f64>,
    /// Halve the triangles so many times
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=24), help_heading = "How fine")]
    levels: Option<u8>,
    /// How triangles go
    #[arg(long, value_enum, default_value_t, requires = "levels", help_heading = "How fine")]
    method: MethodName,
    /// Of --method hiraoka: how the paper's choice of the next triangle is read
    #[arg(long, value_enum, default_value_t, requires = "levels", help_heading = "How fine")]
    reading_of_cost: CostName,
    /// Of --method collapse: borders and breaklines stray no further from level to level, metres
    #[arg(long, value_name = "M", value_parser = values::not_negative, requires = "levels", help_heading = "How fine")]
    stray: Option<f64>,
    /// Print JSON
    #[arg(long, help_heading = "Results")]
    json: bool,
}

/// Names of methods.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
enum MethodName {
    /// Edges collapse where that changes heights least; borders and breaklines stay
    #[default]
    Collapse,
    /// Hiraoka et al. 2005: fans around centroids, where slopes are least
    Hiraoka,
}

/// Names of readings of the paper's cost.
#[derive(Debug, Clone, Copy, Default, ValueEnum)]
enum CostName {
    /// Mean slope of what goes
    #[default]
    Plain,
    /// Sum of the slopes
    Sum,
    /// Mean slope, nothing twice in a pass
    Once,
    /// Deviation from a plane: the kindest
    Plane,
}

/// Endings of what can be written.
pub(super) const ENDINGS: [&str; 11] =
    ["xml", "landxml", "dxf", "2dm", "gpkg", "yama", "ply", "obj", "stl", "off", "glb"];

pub(crate) fn run(args: &TinArgs) -> Result<(), Failure> {
    inputs::check_output(&args.output, &ENDINGS, &args.sources)?;
    let ReadGround { tin, notes } = open(args)?;
    notes.iter().for_each(|line| note(&format!("note: {line}")));
    let source_triangles = tin.mesh.triangles.len();
    let levels = match args.levels {
        None => Vec::new(),
        Some(levels) => {
            let by = match args.method {
                MethodName::Collapse => ThinBy::Collapse { most_stray_m: args.stray.unwrap_or(f64::INFINITY) },
                MethodName::Hiraoka => ThinBy::Hiraoka(match args.reading_of_cost {
                    CostName::Plain => CostReading::Plain,
                    CostName::Sum => CostReading::Sum,
                    CostName::Once => CostReading::OncePerPass,
                    CostName::Plane => CostReading::PlaneDeviation,
                }),
            };
            let _bar = Bar::spinner("thinning");
            thin(&tin, levels.into(), by)?
        }
    };
    let written = levels.last().map_or(&tin, |level| &level.tin);
    write(&args.output, written, &args.sources)?;
    report(args, source_triangles, written, &levels, &notes)
}

fn open(args: &TinArgs) -> Result<ReadGround, Failure> {
    let is_tin = |path: &PathBuf| inputs::is_tin(path) || inputs::is_mesh(path) || inputs::is_yama(path);
    let is_survey = args.sources.iter().all(is_points_name) || args.sources.iter().any(is_tin);
    if args.error.is_none() && !is_survey {
        // what is no elevation file either is told first
        dem::open(&args.sources, &args.reading.options().dem)?;
        return Err(Failure::misuse("how fine? elevation files become a TIN within --error M metres"));
    }
    let _bar = Bar::spinner("reading");
    let dem = args.reading.options().dem;
    let epsg = dem.crs.as_ref().and_then(|crs| crs.epsg);
    let options = GroundOptions {
        tin: TinReadOptions { surface: args.surface.clone(), unit_m: args.unit, epsg },
        breaklines: args.breaklines.clone(),
        longest_edge_m: args.longest_edge,
        order: if args.north_first { ColumnOrder::NorthEast } else { ColumnOrder::EastNorth },
        classes: (!args.class.is_empty()).then(|| args.class.clone()),
        max_error_m: args.error,
        dem,
    };
    Ok(read_ground(&args.sources, &options)?)
}

/// Writes a TIN in the format of the name.
pub(super) fn write(path: &Path, tin: &Tin, sources: &[PathBuf]) -> Result<(), Failure> {
    if inputs::is_yama(path) {
        let name = |p: &PathBuf| p.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        let source = sources.iter().map(name).collect::<Vec<_>>().join(", ");
        let title = if tin.name.is_empty() { source.clone() } else { tin.name.clone() };
        let build = {
            let bar = Bar::shares("building");
            ModelBuild::of_tin(tin, title, &|share| bar.set_share(share))?
        };
        let bar = Bar::shares("writing");
        build.store_as(path, &ModelStoreOptions { source, ..ModelStoreOptions::default() }, &|s| bar.set_share(s))?;
        return Ok(());
    }
    let _bar = Bar::spinner("writing");
    if mesh_file::is_mesh_name(path) {
        let meta = mesh_file::MeshMeta {
            title: tin.name.clone(),
            crs: text::crs(&tin.crs),
            note: "metres; yamanami".to_owned(),
        };
        return Ok(mesh_file::write_mesh(path, &tin.mesh, &meta)?);
    }
    Ok(tin_file::write_tin(path, tin)?)
}

fn report(
    args: &TinArgs,
    source_triangles: usize,
    tin: &Tin,
    levels: &[ThinLevel],
    notes: &[String],
) -> Result<(), Failure> {
    let bytes = inputs::file_bytes(&args.output)?;
    if args.json {
        let level = |level: &ThinLevel| {
            json!({
                "triangles": level.tin.mesh.triangles.len(),
                "rms_vertical_m": level.vertical.rms_m,
                "max_vertical_m": level.vertical.max_m,
                "max_stray_m": level.stray_m,
            })
        };
        return out::json(&json!({
            "output": args.output,
            "bytes": bytes,
            "source_triangles": source_triangles,
            "triangles": tin.mesh.triangles.len(),
            "vertices": tin.mesh.positions.len(),
            "hidden_faces": tin.hidden.len(),
            "breaklines": tin.breaklines.len(),
            "unit_m": tin.unit_m,
            "crs_epsg": tin.crs.epsg,
            "levels": levels.iter().map(level).collect::<Vec<Value>>(),
            "notes": notes,
        }));
    }
    out::row("TIN", format_args!("{}, {}", args.output.display(), text::bytes(bytes)))?;
    let count = |n: usize| text::count(n as u64);
    out::row("triangles", format_args!("{} of {}", count(tin.mesh.triangles.len()), count(source_triangles)))?;
    out::row("vertices", count(tin.mesh.positions.len()))?;
    out::row("breaklines", format_args!("{}; {} hidden faces", count(tin.breaklines.len()), count(tin.hidden.len())))?;
    out::row("CRS", format_args!("{}, {} m a unit", text::crs(&tin.crs), tin.unit_m))?;
    for level in levels {
        let stray = level.stray_m.map_or_else(String::new, |m| format!("; lines stray {} m", text::number(m)));
        out::row(
            "level",
            format_args!(
                "{} triangles: vertically {} m RMS, {} m at most{stray}",
                count(level.tin.mesh.triangles.len()),
                text::number(level.vertical.rms_m),
                text::number(level.vertical.max_m)
            ),
        )?;
    }
    Ok(())
}
