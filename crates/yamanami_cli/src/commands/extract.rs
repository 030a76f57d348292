//! `extract`: the front for a tolerance, a view or a budget as a mesh file.

use super::check::Check;
use crate::args::{self, EyeArgs, FinenessArgs, LensArgs, SourceArgs};
use crate::failure::Failure;
use crate::progress::{Bar, note};
use crate::{inputs, out, text};
use clap::{Args, ValueEnum};
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;
use yamanami::io::mesh_file::{MeshMeta, write_mesh};
use yamanami::{Extracted, Frame, LimitedBy, Terrain, to_frame};

/// Extract a mesh: within a tolerance, for a view, or of so many triangles
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami extract dem.tif --tolerance 10 -o dem.glb          within 10 m of every sample
  yamanami extract dem.tif --tolerance 10 --check -o dem.ply  and measure that it is so
  yamanami extract dem.yama --budget 50000 -o dem.obj         the least error of 50,000 triangles
  yamanami extract dem.yama --eye 138.6,35.2,6000 --target 138.73,35.36,3000 -o view.stl
                                                as fine as this view asks, coarse outside it

Without --eye, --tolerance-px is for a view of the whole. Several limits hold together; the output
says which one bound.")]
pub(crate) struct ExtractArgs {
    #[command(flatten)]
    source: SourceArgs,
    /// The mesh to write: .glb, .ply, .obj, .stl or .off
    #[arg(short, long, value_name = "FILE", help_heading = "Results")]
    output: PathBuf,
    #[command(flatten)]
    fineness: FinenessArgs,
    #[command(flatten)]
    eye: EyeArgs,
    #[command(flatten)]
    lens: LensArgs,
    /// Coordinates of the file: those of the source CRS, or metres east and north of the first sample. Default: source
    /// when that is projected or absent, else local
    #[arg(long, value_enum, help_heading = "Results")]
    frame: Option<FrameName>,
    /// Measure the true error at every sample and look for cracks; a broken promise is a failure
    #[arg(long, help_heading = "Results")]
    check: bool,
    /// Print JSON
    #[arg(long, help_heading = "Results")]
    json: bool,
}

/// Names of frames.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum FrameName {
    /// The source CRS
    Source,
    /// Metres east and north of the first sample
    Local,
}

pub(crate) fn run(args: &ExtractArgs) -> Result<(), Failure> {
    inputs::check_output(&args.output, &["glb", "ply", "obj", "stl", "off"], &args.source.sources)?;
    if !args.fineness.is_given() && args.eye.eye.is_none() {
        return Err(Failure::misuse(
            "how fine? give --tolerance M, --tolerance-px P, --budget N or a view (--tolerance 0 gives every sample)",
        ));
    }
    let terrain = inputs::terrain(&args.source)?;
    let frame = match args.frame {
        Some(FrameName::Source) => Frame::Source,
        Some(FrameName::Local) => Frame::Local,
        // degrees, and metres that are not metres on the ground, are no axes for a solid
        None if terrain.geo().crs.geographic || terrain.geo().crs.web_mercator => Frame::Local,
        None => Frame::Source,
    };
    let viewed = args.eye.eye.is_some() || args.fineness.tolerance_px.is_some();
    let view = viewed.then(|| args::view(&args.eye, &args.lens, &terrain, [1920, 1080]));
    let criteria = args.fineness.criteria(view, !args.lens.no_cull, 1.0);
    let started = Instant::now();
    let Extracted { mesh, error_left, limited_by } = {
        let _bar = Bar::spinner("extracting");
        yamanami::extract(&terrain, &criteria)?
    };
    let extract_ms = started.elapsed().as_secs_f64() * 1e3;
    let check = match args.check {
        true => {
            let field = inputs::field(&terrain, &args.source)?;
            let _bar = Bar::spinner("checking");
            Some(Check::new(&field, &mesh))
        }
        false => None,
    };
    let (triangles, vertices) = (mesh.triangles.len(), mesh.positions.len());
    let mesh = to_frame(&terrain, mesh, frame);
    let unit = if viewed { "px" } else { "m" };
    {
        let _bar = Bar::spinner("writing");
        write_mesh(&args.output, &mesh, &meta(&terrain, frame, error_left, unit))?;
    }
    let bytes = inputs::file_bytes(&args.output)?;
    let limit = match limited_by {
        LimitedBy::Tolerance => "tolerance",
        LimitedBy::Budget => "budget",
        LimitedBy::Residency => "residency",
        LimitedBy::Steps => "steps",
    };
    let full = 2 * (terrain.size()[0] - 1) * (terrain.size()[1] - 1);
    if args.json {
        let mut result = json!({
            "output": args.output,
            "triangles": triangles,
            "vertices": vertices,
            "full_triangles": full,
            "limited_by": limit,
            "frame": if frame == Frame::Source { "source" } else { "local" },
            "bytes": bytes,
            "extract_ms": extract_ms,
        });
        result[format!("error_left_{unit}")] = json!(error_left);
        if let Some(check) = &check {
            result["check"] = check.to_json();
        }
        out::json(&result)?;
    } else {
        out::row("mesh file", format_args!("{}, {}", args.output.display(), text::bytes(bytes)))?;
        out::row("coordinates", frame_text(&terrain, frame))?;
        out::row(
            "triangles",
            format_args!(
                "{} of {} ({} %), {} vertices",
                text::count(triangles as u64),
                text::count(full as u64),
                text::number(100.0 * triangles as f64 / full as f64),
                text::count(vertices as u64)
            ),
        )?;
        let binding = match limited_by {
            LimitedBy::Tolerance => "the tolerance",
            LimitedBy::Budget => "the budget",
            LimitedBy::Residency => "what is in memory",
            LimitedBy::Steps => "the number of steps",
        };
        out::row("error", format_args!("at most {} {unit}; bound by {binding}", text::number(f64::from(error_left))))?;
        out::row("time", format_args!("{} ms to extract", text::number(extract_ms)))?;
        if let Some(check) = &check {
            check.print()?;
        }
    }
    check.map_or(Ok(()), |check| verdict(&check, (!viewed).then_some(f64::from(error_left))))
}

/// A check that finds a broken promise is a failure.
fn verdict(check: &Check, promised_m: Option<f64>) -> Result<(), Failure> {
    let max_m = check.vertical.max_m;
    if let Some(promised_m) = promised_m.filter(|&promised_m| max_m > promised_m) {
        return Err(Failure::failed(format!(
            "check: the true error is {max_m} m, at most {promised_m} m was promised"
        )));
    }
    if !check.conformity.is_conforming() {
        return Err(Failure::failed(format!("check: the mesh is not conforming: {}", check.conformity)));
    }
    if check.vertical.uncovered > 0 {
        note(&format!(
            "note: {} samples with data lie in no triangle (their neighbours have no data)",
            check.vertical.uncovered
        ));
    }
    Ok(())
}

fn meta(terrain: &Terrain, frame: Frame, error_left: f32, unit: &str) -> MeshMeta {
    MeshMeta {
        title: terrain.title().to_owned(),
        crs: if frame == Frame::Source { text::crs(&terrain.geo().crs) } else { String::new() },
        note: format!("{}; error at most {error_left} {unit}; yamanami", frame_text(terrain, frame)),
    }
}

fn frame_text(terrain: &Terrain, frame: Frame) -> String {
    let geo = terrain.geo();
    match frame {
        Frame::Source => format!("source CRS, {}", text::crs(&geo.crs)),
        Frame::Local => format!(
            "metres east and north of {}, {}",
            text::coordinate(geo.origin[0], &geo.crs),
            text::coordinate(geo.origin[1], &geo.crs)
        ),
    }
}
