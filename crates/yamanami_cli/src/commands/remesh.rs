//! `remesh`: a scan to a semi-regular mesh.

use super::wavelet;
use crate::failure::Failure;
use crate::progress::{Bar, note};
use crate::{inputs, out, text, values};
use clap::Args;
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;
use yamanami::core::TriangleMesh;
use yamanami::io::mesh_file::{self, MeshMeta};
use yamanami::multires::clean::{CleanOptions, CleanReport, clean};
use yamanami::multires::remesh::{RemeshOptions, SurfaceKind};

/// Remesh a scan to a base mesh split four to one, again and again, for wavelets
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  yamanami remesh scan.ply -o regular.ply
  yamanami remesh scan.ply -o regular.ply --base-faces 200 --levels 5
  yamanami wavelet regular.ply                        finds the levels in the file again

Works on any surface that faces one way: of any genus, with holes and borders, in several parts.
Equal places are joined, doubled faces dropped and faces turned first.")]
pub(crate) struct RemeshCommand {
    /// The mesh: .ply, .obj, .stl, .off, .glb or .gltf
    mesh: PathBuf,
    /// The mesh to write: .ply, .obj, .stl, .off or .glb
    #[arg(short, long, value_name = "FILE", help_heading = "Results")]
    output: PathBuf,
    #[command(flatten)]
    how: RemeshArgs,
    /// Print JSON
    #[arg(long, help_heading = "Results")]
    json: bool,
}

/// How to remesh.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Remeshing")]
pub(crate) struct RemeshArgs {
    /// Triangles of the base mesh, about; else by size and shape
    #[arg(long, value_name = "N", value_parser = values::faces)]
    base_faces: Option<usize>,
    /// Times that they are split; else until there are about as many as in the source
    #[arg(long, value_name = "J", value_parser = clap::value_parser!(u32).range(1..=12))]
    levels: Option<u32>,
    /// Levels more than the source's faces ask for
    #[arg(skip)]
    finer: u32,
}

impl RemeshArgs {
    /// The same, `finer` levels more where their number is left open.
    pub(crate) fn finer(&self, finer: u32) -> Self {
        Self { finer, ..self.clone() }
    }

    pub(crate) fn options<'a>(&self, progress: &'a (dyn Fn(f32) + Sync)) -> RemeshOptions<'a> {
        let Self { base_faces, levels, finer } = *self;
        RemeshOptions { base_faces, levels, finer, progress: Some(progress) }
    }
}

/// Makes one surface of what only looks like one.
pub(crate) fn mend(mesh: &mut TriangleMesh) -> CleanReport {
    clean(mesh, &CleanOptions { weld_across_seams: true, orient: true, ..CleanOptions::safe() })
}

pub(crate) fn run(args: &RemeshCommand) -> Result<(), Failure> {
    inputs::check_output(&args.output, &["ply", "obj", "stl", "off", "glb"], std::slice::from_ref(&args.mesh))?;
    let mut mesh = {
        let _bar = Bar::spinner("reading");
        mesh_file::read_mesh(&args.mesh)?
    };
    let mended = mend(&mut mesh);
    let title = args.mesh.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let started = Instant::now();
    let (model, report) = wavelet::semi_regular(&mesh, &args.mesh, title.clone(), Some(&args.how))?;
    let remesh_s = started.elapsed().as_secs_f64();
    let result = model.to_mesh();
    {
        let _bar = Bar::spinner("writing");
        let note = format!("{title}, semi-regular: {} levels; yamanami", model.mesh.levels());
        mesh_file::write_mesh(&args.output, &result, &MeshMeta { note, ..MeshMeta::default() })?;
    }
    let bytes = inputs::file_bytes(&args.output)?;
    let (base_faces, levels) = (model.mesh.base().triangles().len(), model.mesh.levels());
    let Some(report) = report else {
        note(&format!("note: {title} is semi-regular already; written as it is, vertices by level"));
        return out::row("mesh file", format_args!("{}, {}", args.output.display(), text::bytes(bytes)));
    };
    let share = |m: f64| m / report.diagonal_m;
    if args.json {
        let kind = |k: SurfaceKind| json!({ "parts": k.components, "borders": k.borders, "handles": k.genus });
        return out::json(&json!({
            "output": args.output,
            "source_faces": report.source_faces,
            "base_faces": base_faces,
            "levels": levels,
            "faces": result.triangles.len(),
            "vertices": result.positions.len(),
            "diagonal_m": report.diagonal_m,
            "rms_m": report.rms_m(),
            "rms_share_of_diagonal": share(report.rms_m()),
            "greatest_m": report.greatest_m,
            "normal_share": report.normal_share,
            "folded_faces": report.folded_faces,
            "source": kind(report.source_kind),
            "result": kind(report.result_kind),
            "remesh_s": remesh_s,
            "bytes": bytes,
        }));
    }
    out::row("mesh file", format_args!("{}, {}", args.output.display(), text::bytes(bytes)))?;
    if !mended.changes().is_empty() {
        super::cleaning::tell(&mended)?;
    }
    out::row(
        "faces",
        format_args!(
            "{} x 4^{levels} = {}, {} vertices; the source has {} faces",
            text::count(base_faces),
            text::count(result.triangles.len()),
            text::count(result.positions.len()),
            text::count(report.source_faces)
        ),
    )?;
    out::row(
        "distance",
        format_args!(
            "rms {} m ({:.1e} of the diagonal), greatest {} m; by samples, both ways",
            text::number(report.rms_m()),
            share(report.rms_m()),
            text::number(report.greatest_m)
        ),
    )?;
    out::row("surface", surface(report.source_kind, report.result_kind))?;
    out::row("details", format_args!("{:.0} % along the normal alone", 100.0 * report.normal_share))?;
    if report.folded_faces > 0 {
        out::row("folded", format_args!("{} faces face away from the source", text::count(report.folded_faces)))?;
    }
    out::row("time", format_args!("{} s", text::number(remesh_s)))
}

fn surface(source: SurfaceKind, result: SurfaceKind) -> String {
    let name = |k: SurfaceKind| format!("{} parts, {} borders, {} handles", k.components, k.borders, k.genus);
    if source == result {
        format!("{}, as the source", name(result))
    } else {
        format!("{}; the source has {}", name(result), name(source))
    }
}
