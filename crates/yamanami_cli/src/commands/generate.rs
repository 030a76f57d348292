//! `generate`: synthetic terrain of any size, a made survey, and a made scan of a pagoda, for trying and timing.

use super::generate_tin;
use crate::failure::Failure;
use crate::progress::Bar;
use crate::{inputs, out, text, values};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use yamanami::core::TriangleMesh;
use yamanami::io::dem;
use yamanami::io::mesh_file::{MeshMeta, write_mesh};
use yamanami_testkit::{Holes, Pagoda, Relief, Shape, Spacing, SyntheticTerrain, carved};

/// Make synthetic terrain, a TIN, the scan of a pagoda, or a ball, of any size
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami generate fractal -o hills.tif --size 1025x1025 --spacing 30
  yamanami generate fractal -o big.tif --size 8193x8193 --seed 7 --round 1
  yamanami generate fractal -o island.tif --holes discs:20     with twenty round holes
  yamanami generate cone -o cone.asc --size 101x77 --spacing 0.5
  yamanami generate tin -o ground.xml --size 401x301 --spacing 5    a road and a river through hills
  yamanami generate pagoda -o pagoda.ply --faces 5000000
  yamanami generate pagoda -o holed.ply --faces 1000000 --holes occluded    with a scan's defects
  yamanami generate carved-ball -o ball.ply --splits 6                      a model with levels, for wavelets")]
pub(crate) struct GenerateArgs {
    /// The form of the ground, or a model
    #[arg(value_enum)]
    kind: Kind,
    /// The file to write: .tif (32-bit floats) or .asc; of a TIN what the tin command writes; of a pagoda or ball .ply,
    /// .obj, .stl or .glb
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Which of all such terrains or scans
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// No-data: none, discs:COUNT, border:SAMPLES, speckle:SHARE or diagonal; of a pagoda none or occluded: what a scanner
    /// cannot see is open, some triangles are doubled or stray
    #[arg(long, value_name = "HOLES", default_value = "none", value_parser = holes)]
    holes: HolePattern,
    #[command(flatten)]
    terrain: TerrainArgs,
    #[command(flatten)]
    scan: ScanArgs,
    /// Times that a ball's octahedron is split: 8 · 4^N triangles [default: 4]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=10), help_heading = "Ball")]
    splits: Option<u32>,
}

/// What only terrain has.
#[derive(Debug, Args)]
#[command(next_help_heading = "Terrain")]
struct TerrainArgs {
    /// Columns and rows of samples [default: 513x513], or points of a TIN, about [default: 201x151]
    #[arg(long, value_name = "WxH", value_parser = values::grid_size)]
    size: Option<[usize; 2]>,
    /// Metres between samples [default: 30], or points of a TIN, about [default: 10]
    #[arg(long, value_name = "M", value_parser = values::positive)]
    spacing: Option<f64>,
    /// Arc seconds between samples instead: a grid of longitude and latitude
    #[arg(long, value_name = "SECONDS", value_parser = values::positive, conflicts_with = "spacing")]
    arc_seconds: Option<f64>,
    /// About this many metres from lowest to highest [default: 1000]
    #[arg(long, value_name = "M", value_parser = values::not_negative)]
    relief: Option<f64>,
    /// Roughness of fractal ground, 0 to 1: 0.5 is mountains, 0.9 nearly noise [default: 0.5]
    #[arg(long, value_name = "SHARE", value_parser = values::share)]
    roughness: Option<f64>,
    /// Round heights to multiples of so many metres, as integer files have them
    #[arg(long, value_name = "M", value_parser = values::positive)]
    round: Option<f64>,
}

impl TerrainArgs {
    fn any(&self) -> bool {
        let numbers = [self.spacing, self.arc_seconds, self.relief, self.roughness, self.round];
        self.size.is_some() || numbers.iter().any(Option::is_some)
    }
}

/// What only the scan of a building has.
#[derive(Debug, Args)]
#[command(next_help_heading = "Pagoda")]
struct ScanArgs {
    /// How many triangles, within 1 %: 2000 to 20000000 [default: 1000000]
    #[arg(long, value_name = "N", value_parser = faces)]
    faces: Option<usize>,
    /// How far the scanner's noise moves a point, at most [default: 0.15 of a triangle's side]
    #[arg(long, value_name = "M", value_parser = values::not_negative)]
    noise: Option<f64>,
}

fn faces(text: &str) -> Result<usize, String> {
    let (fewest, most) = (Pagoda::FEWEST_FACES, Pagoda::MOST_FACES);
    match text.replace(['_', ','], "").parse() {
        Ok(n) if (fewest..=most).contains(&n) => Ok(n),
        _ => Err(format!("expected a whole number from {fewest} to {most}")),
    }
}

/// What can be made.
#[derive(Debug, Clone, Copy, PartialEq, ValueEnum)]
enum Kind {
    /// Relief at all scales
    Fractal,
    /// A roof whose crest runs across the grid
    Ridge,
    /// A cone on level ground
    Cone,
    /// Two levels with a vertical step between them
    Cliff,
    /// A plane that falls to the south-east
    Plane,
    /// Level ground
    Flat,
    /// Level ground with one sample sticking out
    Spike,
    /// Points and breaklines of hills with a road on embankments and a river, as a TIN
    Tin,
    /// The laser scan of a five-storey pagoda: tiles, brackets, railings
    Pagoda,
    /// A ball with broad swells: an octahedron split again and again
    Ball,
    /// A ball with edges, grooves and a band, split the same way
    CarvedBall,
}

/// Patterns of no-data, before the seed is known.
#[derive(Debug, Clone, Copy, PartialEq)]
enum HolePattern {
    None,
    Discs(usize),
    Border(usize),
    Speckle(f64),
    Diagonal,
    Occluded,
}

fn holes(text: &str) -> Result<HolePattern, String> {
    let (name, amount) = text.split_once(':').map_or((text, None), |(name, amount)| (name, Some(amount)));
    let count = |usual: usize| amount.map_or(Some(usual), |a| a.parse().ok().filter(|n| *n <= 1_000_000));
    let pattern = match name {
        "none" if amount.is_none() => Some(HolePattern::None),
        "diagonal" if amount.is_none() => Some(HolePattern::Diagonal),
        "occluded" if amount.is_none() => Some(HolePattern::Occluded),
        "discs" => count(10).map(HolePattern::Discs),
        "border" => count(8).map(HolePattern::Border),
        "speckle" => amount.map_or(Some(0.02), |a| values::share(a).ok()).map(HolePattern::Speckle),
        _ => None,
    };
    pattern.ok_or_else(|| "expected none, discs:COUNT, border:SAMPLES, speckle:SHARE, diagonal or occluded".to_owned())
}

pub(crate) fn run(args: &GenerateArgs) -> Result<(), Failure> {
    match args.kind {
        Kind::Pagoda => return pagoda(args),
        Kind::Tin => return tin(args),
        Kind::Ball => return ball(args, Relief::Smooth),
        Kind::CarvedBall => return ball(args, Relief::Sharp),
        _ => (),
    }
    if args.splits.is_some() {
        return Err(Failure::misuse("--splits is for a ball"));
    }
    if args.scan.faces.is_some() || args.scan.noise.is_some() || args.holes == HolePattern::Occluded {
        return Err(Failure::misuse("--faces, --noise and --holes occluded are for a pagoda"));
    }
    inputs::check_output(&args.output, &["tif", "tiff", "asc"], &[])?;
    let order = &args.terrain;
    let [width, height] = order.size.unwrap_or([513, 513]);
    let relief_m = order.relief.unwrap_or(1000.0) as f32;
    let shape = match args.kind {
        Kind::Fractal => Shape::Fractal { relief_m, roughness: order.roughness.unwrap_or(0.5) as f32, seed: args.seed },
        Kind::Ridge => Shape::Ridge { relief_m },
        Kind::Cone => Shape::Cone { relief_m },
        Kind::Cliff => Shape::Cliff { relief_m },
        Kind::Plane => {
            let fall = -0.5 * relief_m;
            Shape::Plane { at_origin_m: relief_m, slope_m: [fall / (width - 1) as f32, fall / (height - 1) as f32] }
        }
        // TINs and models have been dealt with
        Kind::Flat | Kind::Tin | Kind::Pagoda | Kind::Ball | Kind::CarvedBall => Shape::Flat { z_m: relief_m },
        Kind::Spike => Shape::Spike { column: width / 2, row: height / 2, z_m: relief_m },
    };
    let spacing = order.arc_seconds.map_or(Spacing::Metres(order.spacing.unwrap_or(30.0)), Spacing::ArcSeconds);
    let seed = args.seed;
    let holes = match args.holes {
        HolePattern::None | HolePattern::Occluded => Holes::None,
        HolePattern::Discs(count) => Holes::Discs { count, seed },
        HolePattern::Border(samples) => Holes::Border { samples },
        HolePattern::Speckle(share) => Holes::Speckle { share, seed },
        HolePattern::Diagonal => Holes::BeyondDiagonal,
    };
    let bar = Bar::spinner("generating");
    let mut terrain = SyntheticTerrain::new(width, height, shape, spacing).with_holes(holes);
    if let Some(step_m) = order.round {
        terrain = terrain.rounded_to(step_m as f32);
    }
    let field = terrain.to_field();
    bar.set_job("writing");
    if args.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("asc")) {
        dem::write_asc(&args.output, &field)?;
    } else {
        dem::write_geotiff(&args.output, &field)?;
    }
    drop(bar);
    let range = field.range_m().map_or_else(
        || "no data at all".to_owned(),
        |[low, high]| format!("{} to {} m", text::number(f64::from(low)), text::number(f64::from(high))),
    );
    out::row("file", format_args!("{}, {}", args.output.display(), text::bytes(inputs::file_bytes(&args.output)?)))?;
    out::row(
        "samples",
        format_args!("{width} x {height}, {} without data", text::count(field.no_data_count() as u64)),
    )?;
    out::row("heights", range)
}

fn tin(args: &GenerateArgs) -> Result<(), Failure> {
    let TerrainArgs { size, spacing, arc_seconds, relief, roughness, round } = args.terrain;
    let others = [arc_seconds, relief, roughness, round, args.scan.noise].iter().any(Option::is_some);
    if others || args.splits.is_some() || args.scan.faces.is_some() || args.holes != HolePattern::None {
        return Err(Failure::misuse("a TIN takes --size, --spacing and --seed; the rest is for others"));
    }
    generate_tin::run(&args.output, size, spacing, args.seed)
}

fn ball(args: &GenerateArgs, relief: Relief) -> Result<(), Failure> {
    inputs::check_output(&args.output, &["ply", "obj", "stl", "glb"], &[])?;
    if args.terrain.any() || args.scan.faces.is_some() || args.scan.noise.is_some() || args.holes != HolePattern::None {
        return Err(Failure::misuse("a ball takes --splits only"));
    }
    let mesh = carved(args.splits.unwrap_or(4), relief);
    let meta = MeshMeta { title: "an octahedron split four to one, carved".to_owned(), ..MeshMeta::default() };
    write_mesh(&args.output, &mesh, &meta)?;
    tell(args, &mesh)
}

/// The file and its size.
fn tell(args: &GenerateArgs, mesh: &TriangleMesh) -> Result<(), Failure> {
    out::row("file", format_args!("{}, {}", args.output.display(), text::bytes(inputs::file_bytes(&args.output)?)))?;
    let (triangles, vertices) = (mesh.triangles.len(), mesh.positions.len());
    out::row("triangles", format_args!("{}, {} vertices", text::count(triangles), text::count(vertices)))
}

fn pagoda(args: &GenerateArgs) -> Result<(), Failure> {
    inputs::check_output(&args.output, &["ply", "obj", "stl", "glb"], &[])?;
    if args.terrain.any() || args.splits.is_some() {
        return Err(Failure::misuse("a pagoda takes --faces, --noise, --seed and --holes; the rest is for others"));
    }
    let holes = match args.holes {
        HolePattern::None => false,
        HolePattern::Occluded => true,
        _ => return Err(Failure::misuse("--holes of a pagoda: expected none or occluded")),
    };
    let faces = args.scan.faces.unwrap_or(1_000_000);
    let bar = Bar::spinner("generating");
    let mesh = Pagoda { faces, seed: args.seed, noise_m: args.scan.noise, holes }.to_mesh();
    bar.set_job("writing");
    let meta = MeshMeta {
        title: "a made scan of a five-storey pagoda".to_owned(),
        note: format!("seed {}", args.seed),
        ..MeshMeta::default()
    };
    write_mesh(&args.output, &mesh, &meta)?;
    drop(bar);
    tell(args, &mesh)?;
    let [eye, target] = Pagoda::view().map(|p| p.to_array().map(text::number).join(","));
    out::row("view", format_args!("--eye {eye} --target {target}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_of_holes() {
        assert_eq!(holes("discs:20"), Ok(HolePattern::Discs(20)));
        assert_eq!(holes("speckle:0.1"), Ok(HolePattern::Speckle(0.1)));
        assert_eq!(holes("border"), Ok(HolePattern::Border(8)));
        for wrong in ["disc", "discs:-1", "speckle:2", "none:3"] {
            assert!(holes(wrong).is_err(), "{wrong}");
        }
    }
}
