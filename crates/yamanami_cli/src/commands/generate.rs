//! `generate`: synthetic terrain of any size, for trying and timing.

use crate::failure::Failure;
use crate::progress::Bar;
use crate::{inputs, out, text, values};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use yamanami::io::dem;
use yamanami_testkit::{Holes, Shape, Spacing, SyntheticTerrain};

/// Make synthetic terrain of any size
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami generate fractal -o hills.tif --size 1025x1025 --spacing 30
  yamanami generate fractal -o big.tif --size 8193x8193 --seed 7 --round 1
  yamanami generate fractal -o island.tif --holes discs:20     with twenty round holes
  yamanami generate cone -o cone.asc --size 101x77 --spacing 0.5")]
pub(crate) struct GenerateArgs {
    /// The form of the ground
    #[arg(value_enum)]
    kind: Kind,
    /// The file to write: .tif (32-bit floats) or .asc
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Columns and rows
    #[arg(long, value_name = "WxH", default_value = "513x513", value_parser = values::grid_size)]
    size: [usize; 2],
    /// Metres between samples
    #[arg(long, value_name = "M", default_value_t = 30.0, value_parser = values::positive)]
    spacing: f64,
    /// Arc seconds between samples instead: a grid of longitude and latitude
    #[arg(long, value_name = "SECONDS", value_parser = values::positive, conflicts_with = "spacing")]
    arc_seconds: Option<f64>,
    /// About this many metres from lowest to highest
    #[arg(long, value_name = "M", default_value_t = 1000.0, value_parser = values::not_negative)]
    relief: f64,
    /// Roughness of fractal ground, 0 to 1: 0.5 is mountains, 0.9 nearly noise
    #[arg(long, value_name = "SHARE", default_value_t = 0.5, value_parser = values::share)]
    roughness: f64,
    /// Which of all such terrains
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Round heights to multiples of so many metres, as integer files have them
    #[arg(long, value_name = "M", value_parser = values::positive)]
    round: Option<f64>,
    /// No-data: none, discs:COUNT, border:SAMPLES, speckle:SHARE or diagonal
    #[arg(long, value_name = "HOLES", default_value = "none", value_parser = holes)]
    holes: HolePattern,
}

/// Forms of ground.
#[derive(Debug, Clone, Copy, ValueEnum)]
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
}

/// Patterns of no-data, before the seed is known.
#[derive(Debug, Clone, Copy, PartialEq)]
enum HolePattern {
    None,
    Discs(usize),
    Border(usize),
    Speckle(f64),
    Diagonal,
}

fn holes(text: &str) -> Result<HolePattern, String> {
    let (name, amount) = text.split_once(':').map_or((text, None), |(name, amount)| (name, Some(amount)));
    let count = |usual: usize| amount.map_or(Some(usual), |a| a.parse().ok().filter(|n| *n <= 1_000_000));
    let pattern = match name {
        "none" if amount.is_none() => Some(HolePattern::None),
        "diagonal" if amount.is_none() => Some(HolePattern::Diagonal),
        "discs" => count(10).map(HolePattern::Discs),
        "border" => count(8).map(HolePattern::Border),
        "speckle" => amount.map_or(Some(0.02), |a| values::share(a).ok()).map(HolePattern::Speckle),
        _ => None,
    };
    pattern.ok_or_else(|| "expected none, discs:COUNT, border:SAMPLES, speckle:SHARE or diagonal".to_owned())
}

pub(crate) fn run(args: &GenerateArgs) -> Result<(), Failure> {
    inputs::check_output(&args.output, &["tif", "tiff", "asc"], &[])?;
    let [width, height] = args.size;
    let relief_m = args.relief as f32;
    let shape = match args.kind {
        Kind::Fractal => Shape::Fractal { relief_m, roughness: args.roughness as f32, seed: args.seed },
        Kind::Ridge => Shape::Ridge { relief_m },
        Kind::Cone => Shape::Cone { relief_m },
        Kind::Cliff => Shape::Cliff { relief_m },
        Kind::Plane => {
            let fall = -0.5 * relief_m;
            Shape::Plane { at_origin_m: relief_m, slope_m: [fall / (width - 1) as f32, fall / (height - 1) as f32] }
        }
        Kind::Flat => Shape::Flat { z_m: relief_m },
        Kind::Spike => Shape::Spike { column: width / 2, row: height / 2, z_m: relief_m },
    };
    let spacing = args.arc_seconds.map_or(Spacing::Metres(args.spacing), Spacing::ArcSeconds);
    let seed = args.seed;
    let holes = match args.holes {
        HolePattern::None => Holes::None,
        HolePattern::Discs(count) => Holes::Discs { count, seed },
        HolePattern::Border(samples) => Holes::Border { samples },
        HolePattern::Speckle(share) => Holes::Speckle { share, seed },
        HolePattern::Diagonal => Holes::BeyondDiagonal,
    };
    let bar = Bar::spinner("generating");
    let mut terrain = SyntheticTerrain::new(width, height, shape, spacing).with_holes(holes);
    if let Some(step_m) = args.round {
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
