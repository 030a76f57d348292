//! `build`: elevation files, a TIN or a mesh to a surface database.

use super::remesh::RemeshArgs;
use super::{build_model, build_tiles, progressive};
use crate::args::SourceArgs;
use crate::failure::Failure;
use crate::progress::{Bar, note};
use crate::{inputs, out, text, values};
use clap::Args;
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;
use yamanami::io::{dem, points::is_points_name};
use yamanami::{StoreOptions, Terrain};

/// Make a surface database (.yama) from elevation files, a TIN or a mesh
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami build dem.tif -o dem.yama                 lossless
  yamanami build N4?E001.hgt.zip -o pyrenees.yama    several files, one mosaic
  yamanami build lidar.tif -o lidar.yama --max-error 0.05
                                                     heights within 5 cm: a much smaller file
  yamanami build ground.xml -o ground.yama           a TIN (LandXML, DXF, 2DM, CityGML, ...), bit for bit
  yamanami build 5339*.gml -o city.yama              sheets beside each other, any number, as one TIN
  yamanami build dem.tif --tin -o dem.yama           the cells of a grid as a TIN, however large
  yamanami build scan.ply -o scan.yama               a model at every level of detail
  yamanami build scan.ply --progressive -o scan.yama
                                                     a small file of which any beginning is a coarser model

The database appears whole or not at all; an old one stays until then.")]
pub(crate) struct BuildArgs {
    #[command(flatten)]
    pub(super) source: SourceArgs,
    /// The database to write
    #[arg(short, long, value_name = "S.yama", help_heading = "Results")]
    pub(super) output: PathBuf,
    /// Stored heights, or vertices, may be off by so many metres. Else heights are kept exactly, and vertices within
    /// 1/70 of a usual edge of the mesh; of a progressive model within about 1/30,000 of its diagonal
    #[arg(long, value_name = "M", value_parser = values::not_negative, help_heading = "Results")]
    pub(super) max_error: Option<f64>,
    /// Of a mesh: remesh it where it has no levels, and write wavelet details, the most telling bits first
    #[arg(long, help_heading = "Results")]
    pub(super) progressive: bool,
    /// Of meshes that are terrain, or of elevation files: a TIN, its vertices kept bit for bit and errors vertical
    #[arg(long, conflicts_with_all = ["progressive", "max_error"], help_heading = "Results")]
    pub(super) tin: bool,
    #[command(flatten)]
    pub(super) remesh: RemeshArgs,
    /// Print JSON
    #[arg(long, help_heading = "Results")]
    pub(super) json: bool,
}

pub(crate) fn run(args: &BuildArgs) -> Result<(), Failure> {
    let sources = &args.source.sources;
    inputs::check_output(&args.output, &["yama"], sources)?;
    if sources.iter().any(|s| inputs::is_yama(s)) {
        return Err(Failure::failed("a .yama is a database already: build takes elevation files, a TIN or a mesh"));
    }
    match sources.as_slice() {
        [tin] if inputs::is_tin(tin) || is_points_name(tin) || (args.tin && inputs::is_mesh(tin)) => {
            return build_model::run_tin(args, tin);
        }
        [mesh] if inputs::is_mesh(mesh) && args.progressive => return progressive::build(args, mesh),
        [mesh] if inputs::is_mesh(mesh) => return build_model::run(args, mesh),
        _ if args.progressive => return Err(Failure::misuse("--progressive is for one mesh")),
        several if several.iter().all(|s| inputs::is_tin(s) || (args.tin && inputs::is_mesh(s))) => {
            return build_tiles::of_files(args);
        }
        several if several.iter().any(|s| inputs::is_mesh(s)) => {
            return Err(Failure::misuse(
                "a mesh stands alone: give it as the only input, or several of terrain with --tin",
            ));
        }
        several if several.iter().any(|s| inputs::is_tin(s)) => {
            return Err(Failure::misuse("TINs and elevation files do not mix: build them one by one"));
        }
        _ if args.tin => return build_tiles::of_grid(args),
        _ => {}
    }
    let max_error_m = args.max_error.unwrap_or(0.0);
    let started = Instant::now();
    let field = {
        let _bar = Bar::spinner("reading");
        dem::open(sources, &args.source.reading.options().dem)?.read_all()?
    };
    let read_s = started.elapsed().as_secs_f64();
    let no_data = field.no_data_count();
    let (field, rounded) = if max_error_m > 0.0 {
        let (field, quantum) = yamanami::quantise(field, max_error_m);
        (field, Some((max_error_m, quantum)))
    } else {
        (field, None)
    };
    let name = |p: &PathBuf| p.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    let title = sources.first().map_or_else(String::new, name);
    let terrain = {
        let bar = Bar::shares("building");
        Terrain::build(field, title, &|share| bar.set_share(share))?
    };
    let options = StoreOptions {
        rounded,
        source: sources.iter().map(name).collect::<Vec<_>>().join(", "),
        ..StoreOptions::default()
    };
    {
        let bar = Bar::shares("writing");
        terrain.store_as(&args.output, &options, &|share| bar.set_share(share))?;
    }
    let build_s = started.elapsed().as_secs_f64();
    let [width, height] = terrain.size();
    let samples = (width * height) as u64;
    let (bytes, source_bytes) = (inputs::file_bytes(&args.output)?, inputs::total_bytes(sources));
    if args.json {
        return out::json(&json!({
            "output": args.output,
            "width": width,
            "height": height,
            "samples": samples,
            "no_data_samples": no_data,
            "levels": terrain.surface().numbers().lattice().levels() + 1,
            "max_error_m": max_error_m,
            "bytes": bytes,
            "bytes_per_sample": bytes as f64 / samples as f64,
            "source_bytes": source_bytes,
            "read_s": read_s,
            "build_s": build_s,
        }));
    }
    out::row("database", args.output.display())?;
    out::row("samples", format_args!("{} x {} = {}", width, height, text::count(samples)))?;
    out::row(
        "size",
        format_args!(
            "{}, {} bytes a sample; the source has {}",
            text::bytes(bytes),
            text::number(bytes as f64 / samples as f64),
            text::bytes(source_bytes)
        ),
    )?;
    let kept = if max_error_m > 0.0 { format!("within {} m", text::number(max_error_m)) } else { "exactly".to_owned() };
    out::row("heights", format_args!("kept {kept}, {} without data", text::count(no_data as u64)))?;
    out::row(
        "time",
        format_args!(
            "{} s, {} million samples a second",
            text::number(build_s),
            text::number(samples as f64 / build_s / 1e6)
        ),
    )?;
    note(&format!("next: yamanami fly {} --budget 100000", args.output.display()));
    Ok(())
}
