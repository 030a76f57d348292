//! `volume`: cut and fill between two surfaces, and water at a level on one.

use crate::args::{ReadingArgs, TinReadingArgs};
use crate::failure::Failure;
use crate::progress::{Bar, note};
use crate::{inputs, out, text, values};
use clap::Args;
use glam::DVec2;
use serde_json::json;
use std::path::{Path, PathBuf};
use yamanami::io::tin_file::TinReadOptions;
use yamanami::measure::tin::{PlanIndex, VolumeBetween, Water, volume_between, water_below, water_from};

/// Volumes, exact on the full surfaces: cut and fill between two, or water at a level on one
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami volume before.xml after.xml              cut and fill from the first to the second
  yamanami volume road.xml road.xml --surface ground --surface-b design
                                                    between two surfaces of one file
  yamanami volume dem.tif --level 620               water over all that lies below 620 m
  yamanami volume dem.tif --level 620 --seed 316000,4904000
                                                    only what is joined with this place below the level

Both triangulations are laid over each other and the difference is integrated piece by piece: no grid, no
samples. Areas are in plan.")]
pub(crate) struct VolumeArgs {
    /// The first surface: TIN, mesh, .yama or elevation file
    a: PathBuf,
    /// The second surface
    #[arg(required_unless_present = "level", conflicts_with = "level")]
    b: Option<PathBuf>,
    /// Height of the water
    #[arg(long, value_name = "M", value_parser = values::number, allow_hyphen_values = true)]
    level: Option<f64>,
    /// Where the water wells up, in the source's CRS; else it stands wherever it is low enough
    #[arg(long, value_name = "X,Y", value_parser = values::plan_place, allow_hyphen_values = true, requires = "level")]
    seed: Option<[f64; 2]>,
    #[command(flatten)]
    reading: ReadingArgs,
    #[command(flatten)]
    tin: TinReadingArgs,
    /// Which surface of the second file
    #[arg(long, value_name = "NAME", help_heading = "Reading", requires = "b")]
    surface_b: Option<String>,
    /// Metres in a unit of the second file's coordinates; else as for the first
    #[arg(long, value_name = "M", value_parser = values::positive, help_heading = "Reading", requires = "b")]
    unit_b: Option<f64>,
    /// Print JSON
    #[arg(long, help_heading = "Results")]
    json: bool,
}

pub(crate) fn run(args: &VolumeArgs) -> Result<(), Failure> {
    match (&args.b, args.level) {
        (Some(b), _) => between(args, b),
        (None, Some(level_m)) => water(args, level_m),
        (None, None) => Err(Failure::misuse("volume needs a second surface or --level")),
    }
}

fn between(args: &VolumeArgs, b: &Path) -> Result<(), Failure> {
    let tin = args.tin.options();
    let tin_b = TinReadOptions {
        surface: args.surface_b.clone(),
        unit_m: args.unit_b.or(tin.unit_m),
        ..TinReadOptions::default()
    };
    let open = |path: &Path, tin| inputs::full_surface(&[path.to_owned()], &args.reading, tin);
    let (first, second) = (open(&args.a, &tin)?, open(b, &tin_b)?);
    let second = second.in_frame_of(&first)?;
    let volume = {
        let _bar = Bar::spinner("measuring");
        let index = PlanIndex::new(&second);
        warn_if_no_terrain(&args.a, &PlanIndex::new(&first.mesh));
        warn_if_no_terrain(b, &index);
        volume_between(&first.mesh, &index)
    };
    if volume.overlap_m2 == 0.0 {
        return Err(Failure::failed(format!(
            "{} and {} do not overlap in plan: are both in the same CRS?",
            args.a.display(),
            b.display()
        )));
    }
    report_between(args, &volume)
}

fn report_between(args: &VolumeArgs, v: &VolumeBetween) -> Result<(), Failure> {
    if args.json {
        return out::json(&json!({
            "kind": "volume between surfaces",
            "cut_m3": v.cut_m3,
            "fill_m3": v.fill_m3,
            "net_m3": v.net_m3(),
            "cut_area_m2": v.cut_m2,
            "fill_area_m2": v.fill_m2,
            "overlap_m2": v.overlap_m2,
            "first_only_m2": v.first_only_m2,
            "second_only_m2": v.second_only_m2,
        }));
    }
    out::row("cut", format_args!("{} m³ on {} m²", decimals(v.cut_m3), decimals(v.cut_m2)))?;
    out::row("fill", format_args!("{} m³ on {} m²", decimals(v.fill_m3), decimals(v.fill_m2)))?;
    out::row("net", format_args!("{} m³ (fill less cut)", decimals(v.net_m3())))?;
    let [first, second] = [decimals(v.first_only_m2), decimals(v.second_only_m2)];
    out::row("overlap", format_args!("{} m²; {first} m² only first, {second} m² only second", decimals(v.overlap_m2)))
}

fn water(args: &VolumeArgs, level_m: f64) -> Result<(), Failure> {
    let full = inputs::full_surface(std::slice::from_ref(&args.a), &args.reading, &args.tin.options())?;
    let water = {
        let _bar = Bar::spinner("measuring");
        match args.seed {
            None => water_below(&full.mesh, level_m),
            Some(seed) => water_from(&PlanIndex::new(&full.mesh), level_m, full.local_from_source(DVec2::from(seed)))
                .ok_or_else(|| {
                let [x, y] = seed;
                Failure::failed(format!("--seed {x},{y} lies outside {}", args.a.display()))
            })?,
        }
    };
    report_water(args, level_m, &water)
}

fn report_water(args: &VolumeArgs, level_m: f64, w: &Water) -> Result<(), Failure> {
    if args.json {
        let mut result = json!({
            "kind": "water at a level",
            "level_m": level_m,
            "area_m2": w.area_m2,
            "volume_m3": w.volume_m3,
            "mean_depth_m": w.mean_depth_m(),
            "greatest_depth_m": w.greatest_depth_m,
        });
        if args.seed.is_some() {
            result["reaches_border"] = json!(w.reaches_border);
        }
        return out::json(&result);
    }
    out::row("flooded", format_args!("{} m²", decimals(w.area_m2)))?;
    out::row("water", format_args!("{} m³", decimals(w.volume_m3)))?;
    out::row("depth", format_args!("mean {:.3} m, at most {:.3} m", w.mean_depth_m(), w.greatest_depth_m))?;
    if args.seed.is_some() && w.area_m2 == 0.0 {
        note("note: the surface is above the level at --seed");
    }
    if w.reaches_border {
        note("note: the water reaches the border of the surface: what lies beyond is not known");
    }
    Ok(())
}

fn warn_if_no_terrain(path: &Path, index: &PlanIndex<'_>) {
    if !index.is_terrain() {
        note(&format!("note: {} covers places twice, seen from above; they count as often", path.display()));
    }
}

/// `12,345.678`: all that a survey can mean.
fn decimals(v: f64) -> String {
    let text = format!("{:.3}", v.abs());
    let (whole, part) = text.split_once('.').unwrap_or((&text, ""));
    let sign = if v < 0.0 { "-" } else { "" };
    format!("{sign}{}.{part}", text::count(whole.parse::<u64>().unwrap_or(u64::MAX)))
}
