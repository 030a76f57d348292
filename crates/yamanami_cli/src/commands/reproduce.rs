//! `reproduce`: a paper's figures on real data.

use crate::args::ReadingArgs;
use crate::commands::demo;
use crate::failure::Failure;
use crate::progress::Bar;
use crate::{inputs, out};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use yamanami::Terrain;

/// Reproduce a paper's figures: CSV, plots and a page of text
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami reproduce hashida -o hashida
  yamanami reproduce hashida -o hashida --dem fuji_50m.tif --large alps.tif

hashida: Hashida, Kanai, Kishinami: wavelets and a triangle quadtree for large terrain; figures 7(a), 7(b) and 8.")]
pub(crate) struct ReproduceArgs {
    /// The paper
    #[arg(value_enum)]
    paper: Paper,
    /// Folder for the results
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// A DEM of about 257 x 257 samples of 50 m; else the bundled Mount Washington
    #[arg(long, value_name = "FILE")]
    dem: Option<PathBuf>,
    /// A large DEM or .yama; else the bundled San Gabriel Mountains
    #[arg(long, value_name = "FILE")]
    large: Option<PathBuf>,
    #[command(flatten)]
    reading: ReadingArgs,
}

/// Papers.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Paper {
    /// Level of detail of large terrain by wavelets and a quadtree
    Hashida,
}

pub(crate) fn run(args: &ReproduceArgs) -> Result<(), Failure> {
    let Paper::Hashida = args.paper;
    inputs::make_folder(&args.output)?;
    let open = |file: &Option<PathBuf>, bundled: fn() -> Result<Terrain, Failure>| match file {
        Some(file) => inputs::open(std::slice::from_ref(file), &args.reading),
        None => bundled(),
    };
    let small = open(&args.dem, demo::mount_washington)?;
    let large = open(&args.large, demo::san_gabriel)?;
    let bar = Bar::spinner("reproducing");
    let page = yamanami::hashida(small, Some(large), &args.output, &|job| bar.set_job(job))?;
    drop(bar);
    out::line(page.display())
}
