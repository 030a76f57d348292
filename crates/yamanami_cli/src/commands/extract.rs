//! `extract`: the front for a tolerance, a view or a budget as a mesh file.

use super::check::Check;
use super::check_model::ModelCheck;
use super::progressive;
use crate::args::{self, EyeArgs, FinenessArgs, LensArgs, SourceArgs};
use crate::failure::Failure;
use crate::inputs::Opened;
use crate::progress::{Bar, note};
use crate::{inputs, out, text};
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use std::path::PathBuf;
use std::time::Instant;
use yamanami::core::{Tin, TriangleMesh};
use yamanami::io::mesh_file::{self, MeshMeta, write_mesh};
use yamanami::io::tin_file;
use yamanami::{Extracted, Frame, GroundImage, LimitedBy, Subject, Terrain, WaveletModel, to_frame};

/// Extract a mesh: within a tolerance, for a view, or of so many triangles
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami extract dem.tif --tolerance 10 -o dem.glb          within 10 m of every sample
  yamanami extract dem.tif --tolerance 10 --check -o dem.ply  and measure that it is so
  yamanami extract dem.yama --budget 50000 -o dem.obj         the least error of 50,000 triangles
  yamanami extract dem.yama --eye 138.6,35.2,6000 --target 138.73,35.36,3000 -o view.stl
                                                as fine as this view asks, coarse outside it
  yamanami extract ground.yama --tolerance 0.1 --texture aerial.jpg -o ground.glb
                                                with the part of the photo that it covers
  yamanami extract scan.yama --tolerance 0.001 -o scan.ply    a model, within 1 mm of the scan
  yamanami extract prog.yama --bytes 20000 -o scan.ply        what the first 20,000 bytes of a progressive model tell

Without --eye, --tolerance-px is for a view of the whole. Several limits hold together; the output
says which one bound.")]
pub(crate) struct ExtractArgs {
    #[command(flatten)]
    source: SourceArgs,
    /// The mesh to write: .glb, .ply, .obj, .stl or .off; of a TIN or terrain also .xml (LandXML), .dxf, .2dm or .gpkg
    #[arg(short, long, value_name = "FILE", help_heading = "Results")]
    output: PathBuf,
    /// Read only so many bytes from the beginning of a progressive model
    #[arg(long, value_name = "N", help_heading = "How fine")]
    bytes: Option<u64>,
    #[command(flatten)]
    fineness: FinenessArgs,
    #[command(flatten)]
    eye: EyeArgs,
    #[command(flatten)]
    lens: LensArgs,
    /// Coordinates of the file: those of the source CRS, or metres east and north of the first sample. Default: source
    /// when that is projected or absent, else local. A model always keeps its own
    #[arg(long, value_enum, help_heading = "Results")]
    frame: Option<FrameName>,
    /// Give the mesh a texture: the part of an image (PNG, JPEG) that it covers, by its world file (.wld, .pgw, .jgw) where
    /// there is one, else the image lies over the whole of the surface, north up. Of .glb, .obj and .ply
    #[arg(long, value_name = "IMAGE", help_heading = "Results")]
    texture: Option<PathBuf>,
    /// Measure the true error at every sample (of a model: of many) and look for cracks; a broken promise is a failure
    #[arg(long, help_heading = "Results")]
    check: bool,
    /// Print JSON
    #[arg(long, help_heading = "Results")]
    json: bool,
}

/// Endings of what can be written: meshes, and TINs.
const ENDINGS: [&str; 10] = ["glb", "ply", "obj", "stl", "off", "xml", "landxml", "dxf", "2dm", "gpkg"];

/// Endings of what can have a texture.
const TEXTURED: [&str; 3] = ["glb", "obj", "ply"];

/// Names of frames.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum FrameName {
    /// The source CRS
    Source,
    /// Metres east and north of the first sample
    Local,
}

pub(crate) fn run(args: &ExtractArgs) -> Result<(), Failure> {
    inputs::check_output(&args.output, &ENDINGS, &args.source.sources)?;
    if args.texture.is_some() {
        inputs::check_output(&args.output, &TEXTURED, &[])?;
    }
    if let Some(bytes) = args.bytes {
        let [path] = args.source.sources.as_slice() else {
            return Err(Failure::misuse("--bytes reads the beginning of one progressive model"));
        };
        if !inputs::is_progressive(path)? {
            return Err(Failure::failed(format!(
                "{}: expected a progressive model for --bytes (yamanami build scan.ply --progressive -o scan.yama)",
                path.display()
            )));
        }
        return from_progressive(args, WaveletModel::open(path, bytes)?);
    }
    if !args.fineness.is_given() && args.eye.eye.is_none() {
        return Err(Failure::misuse(
            "how fine? give --tolerance M, --tolerance-px P, --budget N or a view (--tolerance 0 gives every sample)",
        ));
    }
    match inputs::subject(&args.source)? {
        Opened::Terrain(mut terrain) => {
            let frame = match args.frame {
                Some(FrameName::Source) => Frame::Source,
                Some(FrameName::Local) => Frame::Local,
                // degrees, and metres that are not metres on the ground, are no axes for a solid
                None if terrain.geo().crs.geographic || terrain.geo().crs.web_mercator => Frame::Local,
                None => Frame::Source,
            };
            from(args, &mut *terrain, frame, |terrain, mesh| {
                let field = inputs::field(terrain, &args.source)?;
                let _bar = Bar::spinner("checking");
                Ok(Checked::Terrain(Check::new(&field, mesh)))
            })
        }
        Opened::Model(mut model) => from(args, &mut *model, Frame::Source, |model, mesh| {
            let stored_error_m = model.store().map_or(0.0, |store| store.meta().max_error_m);
            Ok(Checked::Model(ModelCheck::new(model, mesh, stored_error_m)?))
        }),
        Opened::Progressive(model) => from_progressive(args, *model),
    }
}

/// A progressive model, or what its first bytes tell of it.
fn from_progressive(args: &ExtractArgs, mut model: WaveletModel) -> Result<(), Failure> {
    if let Some((_, report)) = model.file() {
        note(&progressive::share(report));
    }
    from(args, &mut model, Frame::Source, |model, mesh| Ok(Checked::Model(ModelCheck::new(model, mesh, 0.0)?)))
}

/// What a check found.
enum Checked {
    Terrain(Check),
    Model(ModelCheck),
}

impl Checked {
    fn to_json(&self) -> Value {
        match self {
            Self::Terrain(check) => check.to_json(),
            Self::Model(check) => check.to_json(),
        }
    }

    fn print(&self) -> Result<(), Failure> {
        match self {
            Self::Terrain(check) => check.print(),
            Self::Model(check) => check.print(),
        }
    }

    fn verdict(&self, promised_m: Option<f64>) -> Result<(), Failure> {
        match self {
            Self::Terrain(check) => verdict(check, promised_m),
            Self::Model(check) => check.verdict(promised_m),
        }
    }
}

fn from<S: Subject>(
    args: &ExtractArgs,
    subject: &mut S,
    frame: Frame,
    check: impl FnOnce(&mut S, &TriangleMesh) -> Result<Checked, Failure>,
) -> Result<(), Failure> {
    let viewed = args.eye.eye.is_some() || args.fineness.tolerance_px.is_some();
    let view = viewed.then(|| args::view(&args.eye, &args.lens, subject, [1920, 1080]));
    let criteria = args.fineness.criteria(view, !args.lens.no_cull, 1.0);
    let started = Instant::now();
    let Extracted { mut mesh, error_left, limited_by } = {
        let _bar = Bar::spinner("extracting");
        yamanami::extract(subject, &criteria)?
    };
    let extract_ms = started.elapsed().as_secs_f64() * 1e3;
    let check = if args.check { Some(check(subject, &mesh)?) } else { None };
    let (triangles, vertices) = (mesh.triangles.len(), mesh.positions.len());
    if let Some(image) = &args.texture {
        if !subject.is_ground() {
            return Err(Failure::misuse("--texture is for terrain and TINs; a scan has the colours of its file"));
        }
        let _bar = Bar::spinner("cutting the texture");
        GroundImage::read(image, None)?.texture(subject, &mut mesh)?;
    }
    let mesh = to_frame(subject, mesh, frame);
    let unit = if viewed { "px" } else { "m" };
    {
        let _bar = Bar::spinner("writing");
        if mesh_file::is_mesh_name(&args.output) {
            write_mesh(&args.output, &mesh, &meta(subject, frame, error_left, unit))?;
        } else {
            let mut tin = Tin::of_mesh(subject.title(), mesh);
            (tin.crs, tin.unit_m) = subject.crs_and_unit(frame == Frame::Source);
            tin_file::write_tin(&args.output, &tin)?;
        }
    }
    let bytes = inputs::file_bytes(&args.output)?;
    let limit = match limited_by {
        LimitedBy::Tolerance => "tolerance",
        LimitedBy::Budget => "budget",
        LimitedBy::Residency => "residency",
        LimitedBy::Steps => "steps",
    };
    let full = subject.full_triangles();
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
        out::row("coordinates", frame_text(subject, frame))?;
        out::row(
            "triangles",
            format_args!(
                "{} of {} ({} %), {} vertices",
                text::count(triangles as u64),
                text::count(full),
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
    check.map_or(Ok(()), |check| check.verdict((!viewed).then_some(f64::from(error_left))))
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

fn meta(subject: &impl Subject, frame: Frame, error_left: f32, unit: &str) -> MeshMeta {
    let terrain = subject.as_terrain().filter(|_| frame == Frame::Source);
    MeshMeta {
        title: subject.title().to_owned(),
        crs: terrain.map_or_else(String::new, |t| text::crs(&t.geo().crs)),
        note: format!("{}; error at most {error_left} {unit}; yamanami", frame_text(subject, frame)),
    }
}

fn frame_text(subject: &impl Subject, frame: Frame) -> String {
    let Some(geo) = subject.as_terrain().map(Terrain::geo) else { return "the model's own".to_owned() };
    match frame {
        Frame::Source => format!("source CRS, {}", text::crs(&geo.crs)),
        Frame::Local => format!(
            "metres east and north of {}, {}",
            text::coordinate(geo.origin[0], &geo.crs),
            text::coordinate(geo.origin[1], &geo.crs)
        ),
    }
}
