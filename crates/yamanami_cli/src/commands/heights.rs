//! `heights`: height, slope and aspect at points.

use crate::args::{SourceArgs, TinReadingArgs};
use crate::failure::Failure;
use crate::{inputs, out, places, text, values};
use clap::Args;
use glam::DVec2;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::PathBuf;
use yamanami::FullSurface;
use yamanami::measure::tin::{Footing, PlanIndex, footing};

/// Height, slope and aspect at points, exact on the full surface
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami heights dem.tif --at 316000,4904000 --at 316500,4904000
  yamanami heights road.xml --surface design --points stakes.csv -o staked.csv
                                                             three more columns for each row

The plane of the triangle under each point is evaluated; a grid's cells are two triangles each.
Aspect is the direction in which water runs off, clockwise from north; level ground has none.")]
pub(crate) struct HeightsArgs {
    #[command(flatten)]
    source: SourceArgs,
    #[command(flatten)]
    tin: TinReadingArgs,
    /// A point in the source's CRS; again for more
    #[arg(long, value_name = "X,Y", value_parser = values::plan_place, allow_hyphen_values = true, required_unless_present = "points")]
    at: Vec<[f64; 2]>,
    /// A table of points: columns x and y by name, else the first two
    #[arg(long, value_name = "FILE.csv", conflicts_with = "at")]
    points: Option<PathBuf>,
    /// Write the table with height_m, slope_deg and aspect_deg; else it is printed
    #[arg(short, long, value_name = "FILE.csv", help_heading = "Results", requires = "points")]
    output: Option<PathBuf>,
    /// Print JSON
    #[arg(long, help_heading = "Results")]
    json: bool,
}

/// Names of the columns added.
const COLUMNS: [&str; 3] = ["height_m", "slope_deg", "aspect_deg"];

pub(crate) fn run(args: &HeightsArgs) -> Result<(), Failure> {
    let inputs: Vec<PathBuf> = args.source.sources.iter().chain(&args.points).cloned().collect();
    if let Some(output) = &args.output {
        inputs::check_output(output, &["csv"], &inputs)?;
    }
    let table = args.points.as_deref().map(places::table).transpose()?;
    let full = inputs::full_surface(&args.source.sources, &args.source.reading, &args.tin.options())?;
    let places = table.as_ref().map_or(&args.at, |t| &t.places);
    let found = footings(&full, places);
    let outside = found.iter().filter(|f| f.is_none()).count();
    if let (Some(table), false) = (&table, args.json && args.output.is_none()) {
        let csv = csv(table, &found);
        let Some(output) = &args.output else { return out::line(csv.trim_end()) };
        out::file(output, csv.as_bytes())?;
        let heights = || found.iter().flatten().map(|f| f.height_m);
        let [low, high] = [heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max)];
        if args.json {
            return out::json(&json!({
                "output": output,
                "points": found.len(),
                "points_outside": outside,
                "lowest_m": low.is_finite().then_some(low),
                "highest_m": high.is_finite().then_some(high),
            }));
        }
        out::row("table", output.display())?;
        out::row("points", format_args!("{}, {} outside the surface", text::count(found.len()), text::count(outside)))?;
        return if outside < found.len() {
            out::row("heights", format_args!("{low:.3} to {high:.3} m"))
        } else {
            Ok(())
        };
    }
    if args.json {
        let point = |(place, f): (&[f64; 2], &Option<Footing>)| {
            let mut value = json!({ "x": place[0], "y": place[1] });
            for (name, number) in COLUMNS.iter().zip(f.as_ref().map_or([None; 3], numbers)) {
                value[*name] = json!(number);
            }
            value
        };
        return out::json(&Value::Array(places.iter().zip(&found).map(point).collect()));
    }
    for ([x, y], f) in places.iter().zip(&found) {
        let told = match f.as_ref().map(numbers) {
            None => "outside the surface".to_owned(),
            Some([height, slope, aspect]) => {
                let falls = aspect.map_or("level".to_owned(), |a| format!("falls to {a:.1}° ({})", compass(a)));
                format!("{:.3} m, slope {:.2}°, {falls}", height.unwrap_or(f64::NAN), slope.unwrap_or(f64::NAN))
            }
        };
        out::row(&format!("{x},{y}"), format_args!("  {told}"))?;
    }
    Ok(())
}

fn footings(full: &FullSurface, places: &[[f64; 2]]) -> Vec<Option<Footing>> {
    let index = PlanIndex::new(&full.mesh);
    places.iter().map(|&place| footing(&index, full.local_from_source(DVec2::from(place)))).collect()
}

/// Height, slope and aspect as the columns have them.
fn numbers(f: &Footing) -> [Option<f64>; 3] {
    [Some(f.height_m), Some(f.slope_rad.to_degrees()), f.aspect_rad.map(f64::to_degrees)]
}

/// The table with its new columns; empty where there is no surface.
fn csv(table: &places::Table, found: &[Option<Footing>]) -> String {
    let s = table.separator;
    let mut csv = table.header.as_ref().map_or(String::new(), |h| format!("{h}{s}{}\n", COLUMNS.join(&s.to_string())));
    for (row, f) in table.rows.iter().zip(found) {
        csv.push_str(row);
        for (number, digits) in f.as_ref().map_or([None; 3], numbers).into_iter().zip([4, 3, 2]) {
            csv.push(s);
            // writing into memory cannot fail
            let _ = number.map(|v| write!(csv, "{v:.digits$}"));
        }
        csv.push('\n');
    }
    csv
}

/// The name of a direction.
fn compass(degrees: f64) -> &'static str {
    const NAMES: [&str; 8] = ["north", "north-east", "east", "south-east", "south", "south-west", "west", "north-west"];
    NAMES[(degrees / 45.0).round() as usize % 8]
}
