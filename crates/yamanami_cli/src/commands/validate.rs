//! `validate`: what is wrong with a tileset, ours or another's.

use super::validate_text;
use crate::args::ReadingArgs;
use crate::failure::Failure;
use crate::out;
use crate::progress::Bar;
use crate::values;
use clap::Args;
use std::path::PathBuf;
use yamanami::{Severity, ValidateOptions, validate};

/// Judge tiles: rules of their format, cracks between neighbours, declared against measured error
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami validate tiles                                  a folder: quantized-mesh, 3D Tiles or height pictures
  yamanami validate tiles --declared 10 --source dem.tif   do the deepest tiles keep to 10 m of every sample?
  yamanami validate city.3tz --tiles 500                   a random part of a large archive
  yamanami validate 12/3640/1613.terrain                   a single tile

Cracks are measured between tiles of one level and of all mixes of levels. Errors are measured against
each tile's finest descendants and, where it is given, against the source. Every finding has a code;
docs/validate.md lists them. Exit code 1 where there are errors.")]
pub(crate) struct ValidateArgs {
    /// A folder of tiles, tileset.json, .3tz, .pmtiles, .terrain or .glb
    path: PathBuf,
    /// Look at so many tiles only, chosen at random
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    tiles: Option<u64>,
    /// Which ones
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Cracks up to so many metres are tolerated, beside what quantisation explains
    #[arg(long, value_name = "M", default_value_t = 0.1, value_parser = values::positive)]
    crack: f64,
    /// Error that the deepest tiles of a terrain are said to have, metres; each coarser zoom may have twice the next. Without
    /// it, quantized-mesh is held to the error by which viewers choose zooms
    #[arg(long, value_name = "M", value_parser = values::positive)]
    declared: Option<f64>,
    /// Elevation file that the tiles were made of; again for more, which make one mosaic
    #[arg(long, value_name = "DEM")]
    source: Vec<PathBuf>,
    /// Metres to add to the source's heights to come to those of the tiles, such as the geoid's height
    #[arg(long, value_name = "M", default_value_t = 0.0, allow_hyphen_values = true, value_parser = values::number)]
    source_offset: f64,
    #[command(flatten)]
    reading: ReadingArgs,
    /// Print JSON
    #[arg(long, help_heading = "Results")]
    json: bool,
}

pub(crate) fn run(args: &ValidateArgs) -> Result<(), Failure> {
    let mut options = ValidateOptions::default();
    options.tiles = args.tiles.map(|n| usize::try_from(n).unwrap_or(usize::MAX));
    options.seed = args.seed;
    options.crack_m = args.crack;
    options.declared_m = args.declared;
    options.source = args.source.clone();
    options.dem = args.reading.options().dem;
    options.source_offset_m = args.source_offset;
    let report = {
        let bar = Bar::shares("validating");
        validate(&args.path, &options, &|job, share| {
            bar.set_job(job);
            bar.set_share(share);
        })?
    };
    if args.json {
        out::json(&validate_text::json(&report))?;
    } else {
        validate_text::print(&report)?;
    }
    match report.count(Severity::Error) {
        0 => Ok(()),
        errors => Err(Failure::failed(format!("{}: {errors} errors", args.path.display()))),
    }
}
