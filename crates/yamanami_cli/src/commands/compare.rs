//! `compare`: how far two surfaces, meshes or pictures are apart.

use crate::args::ReadingArgs;
use crate::commands::check::Check;
use crate::failure::Failure;
use crate::pictures::PICTURE_ENDINGS;
use crate::progress::Bar;
use crate::{inputs, out, text};
use clap::{Args, ValueEnum};
use glam::DVec3;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use yamanami::core::{HeightField, TriangleMesh};
use yamanami::io::dem;
use yamanami::measure::tin::{PlanIndex, VerticalDifference, vertical_difference};
use yamanami::measure::{FLIP_PIXELS_PER_DEGREE, flip, mean_abs_difference, ssim, surface_distance};
use yamanami::read_picture;

/// Measure how far two terrains, meshes or pictures are apart
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami compare dem.tif dem.glb        vertical error at every sample, and whether the mesh has cracks
  yamanami compare a.ply b.ply            distance both ways: RMS and Hausdorff; of two terrains the exact
                                          vertical difference, too
  yamanami compare scan.ply scan.yama     the same, of the finest mesh in a model's database
  yamanami compare dem.tif dem.yama       differences sample by sample
  yamanami compare a.png b.png            SSIM, FLIP and mean difference")]
pub(crate) struct CompareArgs {
    /// Elevation file, .yama, mesh or picture
    a: PathBuf,
    /// What it is held against
    b: PathBuf,
    /// Coordinates of a mesh held against a terrain; else what fits better
    #[arg(long, value_enum)]
    frame: Option<MeshFrame>,
    /// Points measured on each of two meshes
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    samples: u32,
    #[command(flatten)]
    reading: ReadingArgs,
    /// Print JSON
    #[arg(long, help_heading = "Results")]
    json: bool,
}

/// Frames of mesh files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum MeshFrame {
    /// The source CRS
    Source,
    /// Metres east and north of the first sample
    Local,
}

pub(crate) fn run(args: &CompareArgs) -> Result<(), Failure> {
    let is_picture = |p: &Path| {
        p.extension().is_some_and(|e| PICTURE_ENDINGS.contains(&e.to_string_lossy().to_lowercase().as_str()))
    };
    match (inputs::is_model(&args.a)?, inputs::is_model(&args.b)?) {
        (true, true) => meshes(args),
        (false, true) => terrain_and_mesh(args, &args.a, &args.b),
        (true, false) => terrain_and_mesh(args, &args.b, &args.a),
        (false, false) if is_picture(&args.a) && is_picture(&args.b) => compare_pictures(args),
        (false, false) => terrains(args),
    }
}

fn compare_pictures(args: &CompareArgs) -> Result<(), Failure> {
    let (a, b) = (read_picture(&args.a, None)?, read_picture(&args.b, None)?);
    let bar = Bar::spinner("comparing");
    let (ssim, mean) = (ssim(&a, &b)?, mean_abs_difference(&a, &b)?);
    let flip = flip(&a, &b, FLIP_PIXELS_PER_DEGREE)?;
    drop(bar);
    if args.json {
        return out::json(&json!({
            "kind": "pictures",
            "width_px": a.width(),
            "height_px": a.height(),
            "ssim": ssim,
            "flip_mean": flip.mean,
            "flip_max": flip.max,
            "mean_abs_difference_of_255": mean,
        }));
    }
    out::row("pictures", format_args!("{} x {}", a.width(), a.height()))?;
    out::row("SSIM", format_args!("{ssim:.4} (1 is equal)"))?;
    out::row("FLIP", format_args!("mean {:.4}, worst {:.4} (0 is equal)", flip.mean, flip.max))?;
    out::row("difference", format_args!("mean {} of 255", text::number(mean)))
}

fn meshes(args: &CompareArgs) -> Result<(), Failure> {
    let (a, b) = (inputs::mesh(&args.a)?, inputs::mesh(&args.b)?);
    for (path, mesh) in [(&args.a, &a), (&args.b, &b)] {
        if mesh.triangles.is_empty() {
            return Err(Failure::failed(format!("{}: has no triangles", path.display())));
        }
    }
    let (distance, vertical) = {
        let _bar = Bar::spinner("comparing");
        (surface_distance(&a, &b, args.samples as usize, 1), vertical(&a, &b))
    };
    let ways = [("a_to_b", &distance.a_to_b), ("b_to_a", &distance.b_to_a)];
    if args.json {
        let mut result = json!({
            "kind": "meshes",
            "faces_a": a.triangles.len(),
            "faces_b": b.triangles.len(),
            "rms_m": distance.rms_m,
            "hausdorff_m": distance.hausdorff_m,
        });
        for (name, way) in ways {
            let worst = [way.worst.x, way.worst.y, way.worst.z];
            result[name] = json!({ "rms_m": way.rms_m, "mean_m": way.mean_m, "max_m": way.max_m, "worst": worst });
        }
        if let Some(v) = vertical {
            result["max_vertical_m"] = json!(v.max_m);
            result["rms_vertical_m"] = json!(v.rms_m);
            result["mean_vertical_m"] = json!(v.mean_m);
            result["mean_signed_vertical_m"] = json!(v.mean_signed_m);
            result["worst_vertical"] = json!(v.worst.map(|p| [p.x, p.y]));
            result["overlap_m2"] = json!(v.overlap_m2);
        }
        return out::json(&result);
    }
    out::row(
        "faces",
        format_args!("{} and {}", text::count(a.triangles.len() as u64), text::count(b.triangles.len() as u64)),
    )?;
    out::row("rms", format_args!("{} m", text::number(distance.rms_m)))?;
    out::row("hausdorff", format_args!("{} m", text::number(distance.hausdorff_m)))?;
    for ((_, way), title) in ways.into_iter().zip(["first to second", "second to first"]) {
        let [x, y, z] = [way.worst.x, way.worst.y, way.worst.z];
        out::line(format_args!(
            "{title}: rms {} m, mean {} m, at most {} m (at {x:.2}, {y:.2}, {z:.2})",
            text::number(way.rms_m),
            text::number(way.mean_m),
            text::number(way.max_m)
        ))?;
    }
    let Some(v) = vertical else { return Ok(()) };
    let place = v.worst.filter(|_| v.max_m > 0.0).map_or(String::new(), |p| format!(" (at {:.2}, {:.2})", p.x, p.y));
    let [rms, mean, signed] = [v.rms_m, v.mean_m, v.mean_signed_m].map(text::number);
    out::row("vertical", format_args!("at most {} m{place}", text::number(v.max_m)))?;
    out::row("", format_args!("rms {rms} m, mean {mean} m, the second higher by {signed} m on the mean"))?;
    out::row("", format_args!("exact, over all of the {} m² that both cover", text::number(v.overlap_m2)))
}

/// The vertical difference of two terrain surfaces that overlap; models have none.
fn vertical(a: &TriangleMesh, b: &TriangleMesh) -> Option<VerticalDifference> {
    let index = PlanIndex::new(b);
    let both = PlanIndex::new(a).is_terrain() && index.is_terrain();
    both.then(|| vertical_difference(a, &index)).filter(|v| v.overlap_m2 > 0.0)
}

/// The heights of an elevation file or of a database.
fn heights(path: &Path, args: &CompareArgs) -> Result<HeightField, Failure> {
    let paths = [path.to_owned()];
    if inputs::is_yama(path) {
        return Ok(inputs::open(&paths, &args.reading)?.field()?);
    }
    let _bar = Bar::spinner("reading");
    Ok(dem::open(&paths, &args.reading.options().dem)?.read_all()?)
}

fn terrain_and_mesh(args: &CompareArgs, terrain: &Path, mesh: &Path) -> Result<(), Failure> {
    let field = heights(terrain, args)?;
    let mut mesh = inputs::mesh(mesh)?;
    let frame = args.frame.unwrap_or_else(|| likely_frame(&field, &mesh));
    if frame == MeshFrame::Source {
        for p in &mut mesh.positions {
            let [x, y] = field.geo().local_from_source(p.x, p.y);
            *p = DVec3::new(x, y, p.z);
        }
    }
    let check = {
        let _bar = Bar::spinner("comparing");
        Check::new(&field, &mesh)
    };
    if check.vertical.measured == 0 {
        return Err(Failure::failed(format!(
            "no sample of {} lies under the mesh: are both in the same place? (--frame source|local)",
            terrain.display()
        )));
    }
    let frame = if frame == MeshFrame::Source { "source" } else { "local" };
    if args.json {
        let mut result = check.to_json();
        result["kind"] = json!("terrain and mesh");
        result["frame"] = json!(frame);
        result["faces"] = json!(mesh.triangles.len());
        return out::json(&result);
    }
    out::row("faces", format_args!("{}, in the {frame} frame", text::count(mesh.triangles.len() as u64)))?;
    check.print()
}

/// The frame in which more of the mesh's box lies over the terrain.
fn likely_frame(field: &HeightField, mesh: &TriangleMesh) -> MeshFrame {
    let bounds = mesh.bounds();
    let last = [(field.width() - 1) as f64, (field.height() - 1) as f64];
    let shared = |grid: &dyn Fn(f64, f64) -> [f64; 2]| {
        let (a, b) = (grid(bounds.min.x, bounds.min.y), grid(bounds.max.x, bounds.max.y));
        (0..2).map(|k| (a[k].max(b[k]).min(last[k]) - a[k].min(b[k]).max(0.0)).max(0.0) / last[k]).product::<f64>()
    };
    let geo = field.geo();
    let source = shared(&|x, y| geo.grid_from_source(x, y));
    let local = shared(&|x, y| geo.grid_from_local(x, y));
    if local > source { MeshFrame::Local } else { MeshFrame::Source }
}

fn terrains(args: &CompareArgs) -> Result<(), Failure> {
    let (a, b) = (heights(&args.a, args)?, heights(&args.b, args)?);
    let sizes = [&a, &b].map(|f| [f.width(), f.height()]);
    if sizes[0] != sizes[1] {
        let [[aw, ah], [bw, bh]] = sizes;
        return Err(Failure::failed(format!(
            "{} and {} differ in size: {aw} x {ah} and {bw} x {bh} samples; grids are compared sample by sample",
            args.a.display(),
            args.b.display()
        )));
    }
    let (mut measured, mut max, mut sum, mut squares, mut data_differs) = (0u64, 0f64, 0f64, 0f64, 0u64);
    for (&p, &q) in a.heights_m().iter().zip(b.heights_m()) {
        match (p.is_nan(), q.is_nan()) {
            (false, false) => {
                let d = (f64::from(p) - f64::from(q)).abs();
                (measured, max, sum, squares) = (measured + 1, max.max(d), sum + d, squares + d * d);
            }
            (true, true) => (),
            _ => data_differs += 1,
        }
    }
    let mean = |total: f64| if measured > 0 { total / measured as f64 } else { 0.0 };
    let result: Value = json!({
        "kind": "terrains",
        "samples_measured": measured,
        "max_vertical_m": max,
        "mean_vertical_m": mean(sum),
        "rms_vertical_m": mean(squares).sqrt(),
        "samples_with_data_in_one_only": data_differs,
    });
    if args.json {
        return out::json(&result);
    }
    out::row("difference", format_args!("at most {} m", text::number(max)))?;
    out::row("", format_args!("rms {} m, mean {} m", text::number(mean(squares).sqrt()), text::number(mean(sum))))?;
    out::row(
        "",
        format_args!("{} samples measured, {} with data in one only", text::count(measured), text::count(data_differs)),
    )
}
