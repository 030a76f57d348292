//! `profile`: the section of a surface along a line.

use crate::args::{SourceArgs, TinReadingArgs};
use crate::failure::Failure;
use crate::{inputs, out, places, text, values};
use clap::Args;
use glam::DVec2;
use serde_json::json;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use yamanami::FullSurface;
use yamanami::measure::tin::{PlanIndex, Section, section};

/// The section along a line, exact on the full surface: a vertex at every edge that the line crosses
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami profile dem.tif --line \"310000,4900000 320000,4908000\" -o profile.png
  yamanami profile road.xml --line-file axis.geojson -o profile.csv -o profile.png
  yamanami profile dem.yama --line \"138.6,35.3 138.73,35.36 138.8,35.4\" --json

Where the surface has a hole, the section has a gap. Columns of the table: the run (a number a stretch without
a gap), the distance along the line, and x, y, z in the source's CRS.")]
pub(crate) struct ProfileArgs {
    #[command(flatten)]
    source: SourceArgs,
    #[command(flatten)]
    tin: TinReadingArgs,
    /// The line's places in the source's CRS, in quotes
    #[arg(long, value_name = "\"X,Y X,Y ...\"", value_parser = Line::parse, allow_hyphen_values = true, required_unless_present = "line_file")]
    line: Option<Line>,
    /// The line in a file: a table with a place a row, or GeoJSON with a LineString
    #[arg(long, value_name = "FILE", conflicts_with = "line")]
    line_file: Option<PathBuf>,
    /// Write the section: .csv, or a picture .png; again for both
    #[arg(short, long, value_name = "FILE", help_heading = "Results")]
    output: Vec<PathBuf>,
    /// Title of the picture
    #[arg(long, value_name = "TEXT", help_heading = "Results")]
    title: Option<String>,
    /// Print JSON, with all vertices where no file is written
    #[arg(long, help_heading = "Results")]
    json: bool,
}

/// The places of a line.
#[derive(Debug, Clone)]
struct Line(Vec<[f64; 2]>);

impl Line {
    fn parse(text: &str) -> Result<Self, String> {
        values::line(text).map(Self)
    }
}

pub(crate) fn run(args: &ProfileArgs) -> Result<(), Failure> {
    let inputs: Vec<PathBuf> = args.source.sources.iter().chain(&args.line_file).cloned().collect();
    for output in &args.output {
        inputs::check_output(output, &["csv", "png"], &inputs)?;
    }
    let line = match (&args.line, &args.line_file) {
        (Some(line), _) => line.0.clone(),
        (None, Some(file)) => places::line(file)?,
        (None, None) => Vec::new(),
    };
    let full = inputs::full_surface(&args.source.sources, &args.source.reading, &args.tin.options())?;
    let line: Vec<DVec2> = line.into_iter().map(|p| full.local_from_source(DVec2::from(p))).collect();
    let section = section(&PlanIndex::new(&full.mesh), &line);
    if section.runs.is_empty() {
        return Err(Failure::failed(format!(
            "the line lies nowhere on {}: is it in the source's CRS?",
            args.source.sources[0].display()
        )));
    }
    for output in &args.output {
        if output.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv")) {
            out::file(output, csv(&full, &section).as_bytes())?;
        } else {
            picture(args, &line, &section, output)?;
        }
    }
    report(args, &full, &section)
}

fn picture(args: &ProfileArgs, line: &[DVec2], section: &Section, output: &Path) -> Result<(), Failure> {
    let name = args.source.sources[0].file_name().unwrap_or_default().to_string_lossy();
    let title = args.title.clone().unwrap_or_else(|| format!("Profile of {name}"));
    let mut along = 0.0;
    let ends = line.windows(2).map(|w| {
        along += w[0].distance(w[1]);
        along
    });
    let turns: Vec<f64> = ends.take(line.len().saturating_sub(2)).collect();
    Ok(yamanami::write_profile_plot(section, &title, &turns, output)?)
}

/// The vertices as a table: distances and heights to a tenth of a millimetre.
fn csv(full: &FullSurface, section: &Section) -> String {
    let digits = if full.crs.geographic { 9 } else { 4 };
    let mut csv = "run,distance_m,x,y,z_m\n".to_owned();
    for (run, points) in (1..).zip(&section.runs) {
        for p in points {
            let DVec2 { x, y } = full.source_from_local(p.point.truncate());
            // writing into memory cannot fail
            let _ = writeln!(csv, "{run},{:.4},{x:.digits$},{y:.digits$},{:.4}", p.distance_m, p.point.z);
        }
    }
    csv
}

fn report(args: &ProfileArgs, full: &FullSurface, section: &Section) -> Result<(), Failure> {
    let [climb, descent] = section.climb_and_descent_m();
    let slope_deg = section.mean_slope_rad().to_degrees();
    let Some([low, high]) = section.lowest_and_highest() else { return Ok(()) };
    let vertices: usize = section.runs.iter().map(Vec::len).sum();
    if args.json {
        let mut result = json!({
            "output": args.output,
            "length_m": section.length_m,
            "covered_m": section.covered_m(),
            "ground_m": section.ground_m(),
            "climb_m": climb,
            "descent_m": descent,
            "lowest_m": low.point.z,
            "highest_m": high.point.z,
            "mean_slope_deg": slope_deg,
            "vertices": vertices,
        });
        if args.output.is_empty() {
            let vertex = |p: &yamanami::measure::tin::SectionPoint| {
                let DVec2 { x, y } = full.source_from_local(p.point.truncate());
                json!({ "distance_m": p.distance_m, "x": x, "y": y, "z_m": p.point.z })
            };
            let runs = section.runs.iter().map(|run| run.iter().map(vertex).collect::<Vec<_>>());
            result["runs"] = json!(runs.collect::<Vec<_>>());
        }
        return out::json(&result);
    }
    for output in &args.output {
        out::row("section", output.display())?;
    }
    let gaps = match section.length_m - section.covered_m() {
        gap if gap > 1e-6 * section.length_m => format!(", {} of it off the surface", text::length_m(gap)),
        _ => String::new(),
    };
    out::row("line", format_args!("{}{gaps}", text::length_m(section.length_m)))?;
    out::row("ground", format_args!("{}, mean slope {slope_deg:.2}°", text::length_m(section.ground_m())))?;
    out::row(
        "heights",
        format_args!(
            "{:.3} m (at {:.1} m) to {:.3} m (at {:.1} m)",
            low.point.z, low.distance_m, high.point.z, high.distance_m
        ),
    )?;
    out::row("climb", format_args!("{}, descent {}", text::length_m(climb), text::length_m(descent)))?;
    let runs = if section.runs.len() == 1 { "one run".to_owned() } else { format!("{} runs", section.runs.len()) };
    out::row("vertices", format_args!("{} in {runs}", text::count(vertices)))
}
