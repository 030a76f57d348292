//! `reproduce`: a paper's figures on real data.

use crate::args::{ReadingArgs, UpArgs};
use crate::commands::reproduce_hori::HoriArgs;
use crate::commands::{coast, demo, remesh, reproduce_hori, wavelet};
use crate::failure::Failure;
use crate::progress::Bar;
use crate::{inputs, out, text, values};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use yamanami::io::mesh_file;
use yamanami::{DateModel, MizunoModel, SemiRegularModel, Terrain};
use yamanami_testkit::{Pagoda, Relief, carved};

/// Reproduce a paper's figures: CSV, plots and a page of text
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami reproduce hashida -o hashida
  yamanami reproduce hashida -o hashida --dem fuji_50m.tif --large alps.tif
  yamanami reproduce mizuno -o mizuno
  yamanami reproduce mizuno -o mizuno --faces 10000000 --scan statue.ply
  yamanami reproduce date -o date --scan statue.ply --scan bust.ply
  yamanami reproduce hiraoka -o hiraoka
  yamanami reproduce hori -o hori
  yamanami reproduce hori alps.tif japan.yama --at 36.29,137.65 -o hori

hashida: Hashida, Kanai, Kishinami: wavelets and a triangle quadtree for large terrain; figures 7(a), 7(b) and 8.
mizuno: Mizuno, Okumoto, Takata, Joe: polygon reduction for displays; tables 1 and 2, on a made pagoda.
date: Date, Kanai, Kishinami: k-disk wavelets of polygon models; figures 6, 7, 10 and times, on two made balls, terrain
and scans.
hiraoka: Hiraoka, Yamada, Urahama: TINs in blocks and levels; errors, times and losses on a made coast.
hori: Hori, Okajima, Miyamura, Furuya, Saito: deformed maps; table 1, figures 9 and 11 to 14 and times, on bundled data
of central Japan and on made ground.")]
pub(crate) struct ReproduceArgs {
    /// The paper
    #[arg(value_enum)]
    paper: Paper,
    /// Folder for the results
    #[arg(short, long, value_name = "DIR")]
    pub(super) output: PathBuf,
    #[command(flatten)]
    pub(super) hori: HoriArgs,
    /// hashida, date: a DEM of about 257 x 257 samples of 50 m; else the bundled Mount Washington
    #[arg(long, value_name = "FILE")]
    dem: Option<PathBuf>,
    /// A large DEM or .yama; else the bundled San Gabriel Mountains
    #[arg(long, value_name = "FILE")]
    large: Option<PathBuf>,
    /// mizuno: faces of the made pagoda
    #[arg(long, value_name = "N", value_parser = values::faces, default_value_t = USUAL_PAGODA_FACES)]
    faces: usize,
    /// mizuno: a real scan beside the pagoda; date: real scans, remeshed where they have no levels
    #[arg(long, value_name = "FILE")]
    scan: Vec<PathBuf>,
    /// hiraoka: the largest ground, in copies of the paper's each way; 10 is a hundred times its area
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=20), default_value_t = 10)]
    copies: u64,
    #[command(flatten)]
    up: UpArgs,
    #[command(flatten)]
    pub(super) reading: ReadingArgs,
}

/// Papers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Paper {
    /// Level of detail of large terrain by wavelets and a quadtree
    Hashida,
    /// Polygons of scanned models for displays
    Mizuno,
    /// k-disk wavelets of polygon models
    Date,
    /// TINs in blocks and levels
    Hiraoka,
    /// Deformed maps by bands of distance
    Hori,
}

/// Enough for a hundred polygons a pixel on a small display, and done in a few minutes.
const USUAL_PAGODA_FACES: usize = 3_000_000;

/// The pagoda's camera sees this much from bottom to top, radians (30°).
const PAGODA_FOV_RAD: f64 = std::f64::consts::FRAC_PI_6;

pub(crate) fn run(args: &ReproduceArgs) -> Result<(), Failure> {
    if args.paper != Paper::Hori && !args.hori.sources.is_empty() {
        return Err(Failure::misuse("only hori takes sources; see --dem, --large and --scan".to_owned()));
    }
    inputs::make_folder(&args.output)?;
    match args.paper {
        Paper::Hashida => hashida(args),
        Paper::Mizuno => mizuno(args),
        Paper::Date => date(args),
        Paper::Hiraoka => hiraoka(args),
        Paper::Hori => reproduce_hori::run(args),
    }
}

fn mizuno(args: &ReproduceArgs) -> Result<(), Failure> {
    let bar = Bar::spinner("making a pagoda");
    let (fewest, most) = (Pagoda::FEWEST_FACES, Pagoda::MOST_FACES);
    if !(fewest..=most).contains(&args.faces) {
        return Err(Failure::misuse(format!("--faces {}: a pagoda has {fewest} to {most} faces", args.faces)));
    }
    let regions = Pagoda::regions().map(|region| (region.name.to_owned(), region.centre_m, region.radius_m));
    let mut models = vec![MizunoModel {
        name: "pagoda".to_owned(),
        title: "A made pagoda".to_owned(),
        mesh: Pagoda::new(args.faces).to_mesh(),
        camera: Some(Pagoda::view()),
        fov_y_rad: Some(PAGODA_FOV_RAD),
        regions: regions.into(),
    }];
    for (nth, scan) in args.scan.iter().enumerate() {
        let mut mesh = mesh_file::read_mesh(scan)?;
        args.up.turn(&mut mesh);
        let name = scan.file_name().unwrap_or_default().to_string_lossy().into_owned();
        models.push(MizunoModel {
            name: scan_name(nth),
            title: format!("A real scan, {name}"),
            mesh,
            camera: None,
            fov_y_rad: None,
            regions: Vec::new(),
        });
    }
    let page = yamanami::mizuno(models, &args.output, &|job| bar.set_job(job))?;
    drop(bar);
    out::line(page.display())
}

/// `scan`, `scan2`, `scan3`: for file names.
fn scan_name(nth: usize) -> String {
    if nth == 0 { "scan".to_owned() } else { format!("scan{}", nth + 1) }
}

/// Splits of the octahedron that give the paper's 2,048 triangles.
const PAPER_SPLITS: u32 = 4;

fn date(args: &ReproduceArgs) -> Result<(), Failure> {
    let bar = Bar::spinner("making models");
    let made = "A made ball of the paper's size, an octahedron split four times, within ±10 m.";
    let mut models = Vec::new();
    for (name, title, relief) in [
        ("smooth", "Model 1, smooth", Relief::Smooth),
        ("sharp", "Model 2, sharp relief", Relief::Sharp),
    ] {
        let model = SemiRegularModel::recognised(&carved(PAPER_SPLITS, relief), title.to_owned())?;
        models.extend(model.map(|model| DateModel {
            name: name.to_owned(),
            origin: made.to_owned(),
            model,
            is_terrain: false,
        }));
    }
    for (nth, scan) in args.scan.iter().enumerate() {
        let mut mesh = mesh_file::read_mesh(scan)?;
        args.up.turn(&mut mesh);
        let title = scan.file_name().unwrap_or_default().to_string_lossy().into_owned();
        remesh::mend(&mut mesh);
        bar.set_job(&format!("remeshing {title}"));
        let (model, report) = wavelet::semi_regular(&mesh, scan, title, Some(&remesh::RemeshArgs::default()))?;
        let how = report.map_or_else(
            || "which has levels".to_owned(),
            |r| format!("remeshed; two-sided RMS to the scan {:.1e} of the diagonal", r.rms_m() / r.diagonal_m),
        );
        let origin = format!("A scan of {} triangles, {how}.", text::count(mesh.triangles.len()));
        models.push(DateModel { name: scan_name(nth), origin, model, is_terrain: false });
    }
    let terrain = match &args.dem {
        Some(file) => inputs::open(std::slice::from_ref(file), &args.reading)?,
        None => demo::mount_washington()?,
    };
    models.push(DateModel {
        name: "terrain".to_owned(),
        origin: "Terrain: the same wavelets on the heights of a grid.".to_owned(),
        model: SemiRegularModel::of_heights(&terrain.field()?, format!("Terrain, {}", terrain.title()))?,
        is_terrain: true,
    });
    let page = yamanami::date(models, &args.output, &|job| bar.set_job(job))?;
    drop(bar);
    out::line(page.display())
}

fn hashida(args: &ReproduceArgs) -> Result<(), Failure> {
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

fn hiraoka(args: &ReproduceArgs) -> Result<(), Failure> {
    let bar = Bar::spinner("making a coast");
    let most = args.copies as usize;
    let mut copies: Vec<usize> = [1, 2, 5].into_iter().filter(|&n| n < most).collect();
    copies.push(most);
    let title =
        "A made coastal plain with hills, 3,120 × 2,080 m, sampled every 5 m and triangulated by greedy insertion";
    let page = yamanami::hiraoka(&coast::coast(), title.to_owned(), &copies, &args.output, &|job| bar.set_job(job))?;
    drop(bar);
    out::line(page.display())
}
