//! Progressive models: `build --progressive`, and what `info` says of them.

use super::build::BuildArgs;
use super::{remesh, wavelet};
use crate::failure::Failure;
use crate::progress::{Bar, note};
use crate::{inputs, out, text};
use serde_json::{Value, json};
use std::path::Path;
use std::time::Instant;
use yamanami::io::mesh_file;
use yamanami::io::progressive::{self, ProgressiveReport};
use yamanami::{ProgressiveFile, ProgressiveOptions, SemiRegularModel, Subject, WaveletModel, encode_progressive};

/// Tries for an error asked for: each is half as coarse as the one before.
const MOST_TRIES: u32 = 6;
/// Faces up to which the remeshed scan is a level finer than the scan: its accuracy is the most that the file can have.
const MOST_FINER_FACES: usize = 4_000_000;
/// The whole file's error is about so many of its units along the normal.
const ERROR_UNITS: f64 = 3.0;

pub(super) fn build(args: &BuildArgs, file: &Path) -> Result<(), Failure> {
    let started = Instant::now();
    let mut mesh = {
        let _bar = Bar::spinner("reading");
        mesh_file::read_mesh(file)?
    };
    let (faces, vertices) = (mesh.triangles.len(), mesh.positions.len());
    if !mesh.colours.is_empty() || !mesh.materials.is_empty() {
        note(
            "note: a progressive model keeps the shape only, not colours and textures; without --progressive colours are kept",
        );
    }
    remesh::mend(&mut mesh);
    let title = file.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    let how = args.remesh.finer(u32::from(4 * mesh.triangles.len() <= MOST_FINER_FACES));
    let (model, report) = wavelet::semi_regular(&mesh, file, title, Some(&how))?;
    drop(mesh);
    let encoding = Instant::now();
    let coded = {
        let _bar = Bar::spinner("encoding");
        encode(args, &model)?
    };
    let encode_s = encoding.elapsed().as_secs_f64();
    progressive::write(&args.output, &coded.bytes)?;
    let (bytes, build_s) = (coded.bytes.len(), started.elapsed().as_secs_f64());
    let finest = model.mesh.triangle_count(model.mesh.levels());
    let bits = |n: usize| 8.0 * bytes as f64 / n.max(1) as f64;
    if args.json {
        return out::json(&json!({
            "output": args.output,
            "faces": faces,
            "vertices": vertices,
            "base_faces": model.mesh.base().triangles().len(),
            "levels": model.mesh.levels(),
            "finest_faces": finest,
            "remesh_rms_m": report.map(|r| r.rms_m()),
            "remesh_greatest_m": report.map(|r| r.greatest_m),
            "max_error_m": coded.max_error_m,
            "bytes": bytes,
            "bits_per_vertex": bits(vertices),
            "encode_s": encode_s,
            "build_s": build_s,
        }));
    }
    out::row("model", args.output.display())?;
    out::row("faces", format_args!("{}, {} vertices", text::count(faces), text::count(vertices)))?;
    let base = text::count(model.mesh.base().triangles().len());
    let regular = format!("{base} x 4^{} = {} faces", model.mesh.levels(), text::count(finest));
    match report {
        Some(r) => {
            let [rms, greatest] = [r.rms_m(), r.greatest_m].map(text::number);
            out::row("remeshed", format_args!("{regular}, rms {rms} m from the source, greatest {greatest} m"))?;
        }
        None => out::row("levels", format_args!("{regular}, found in the file"))?,
    }
    let size = text::bytes(bytes as u64);
    out::row("size", format_args!("{size}, {} bits for each vertex of the source", text::number(bits(vertices))))?;
    out::row("vertices", format_args!("the whole file keeps them within {} m", text::number(coded.max_error_m)))?;
    out::row("time", format_args!("{} s, of that {} s to encode", text::number(build_s), text::number(encode_s)))?;
    note(&format!("next: yamanami extract {} --bytes {} -o coarser.ply", args.output.display(), bytes / 8));
    Ok(())
}

/// Encodes a model, within the error asked for.
fn encode(args: &BuildArgs, model: &SemiRegularModel) -> Result<ProgressiveFile, Failure> {
    let title = model.title.clone();
    let mut options = ProgressiveOptions { title: title.clone(), source: title, ..ProgressiveOptions::default() };
    let Some(asked_m) = args.max_error else {
        return Ok(encode_progressive(&model.mesh, &model.positions, &options)?);
    };
    let diagonal_m = model.to_mesh().bounds().diagonal();
    options.precision = (asked_m / diagonal_m / ERROR_UNITS).clamp(1e-8, 0.1);
    for _ in 0..MOST_TRIES {
        let coded = encode_progressive(&model.mesh, &model.positions, &options)?;
        if coded.max_error_m <= asked_m {
            return Ok(coded);
        }
        options.precision *= 0.5;
    }
    Err(Failure::failed(format!(
        "{}: a progressive model of this size cannot be kept within {asked_m:e} m",
        args.output.display()
    )))
}

/// How much of a file was read, in words.
pub(super) fn share(report: &ProgressiveReport) -> String {
    let ProgressiveReport { bytes, bytes_of, planes, planes_of, levels, levels_of } = *report;
    if bytes >= bytes_of {
        return format!("all {} bytes decoded", text::count(bytes));
    }
    format!(
        "{} of {} bytes decoded: {planes} of {planes_of} bit planes, and {levels} of {levels_of} levels of the next",
        text::count(bytes),
        text::count(bytes_of)
    )
}

/// Opens a progressive model, says what it is (unless `quiet`) and gives the same as JSON.
pub(super) fn tell(path: &Path, quiet: bool) -> Result<Value, Failure> {
    let model = WaveletModel::open(path, u64::MAX)?;
    let bounds = model.bounds();
    let Some((meta, report)) = model.file() else { return Ok(Value::Null) };
    let (min, max, full) = (bounds.min, bounds.max, model.full_triangles());
    if !quiet {
        out::row("file", format_args!("{}, {}", path.display(), text::bytes(inputs::file_bytes(path)?)))?;
        out::row("format", "yamanami progressive model: any beginning of it is a coarser model")?;
        if !meta.source.is_empty() {
            out::row("made from", &meta.source)?;
        }
        out::row("faces", format_args!("{} on {} levels", text::count(full), report.levels_of))?;
        let axis = |name: &str, a: f64, b: f64| format!("{name} {a:.3} to {b:.3}");
        let axes = [axis("x", min.x, max.x), axis("y", min.y, max.y), axis("z", min.z, max.z)];
        out::row("bounds", axes.join(", "))?;
        out::row("kept", format_args!("within {} m when whole", text::number(meta.max_error_m.into())))?;
        out::row("read", share(report))?;
    }
    Ok(json!({
        "kind": "progressive",
        "paths": [path],
        "format": "yamanami progressive model",
        "title": meta.title,
        "source": meta.source,
        "faces": full,
        "levels": report.levels_of,
        "min": min.to_array(),
        "max": max.to_array(),
        "max_error_m": meta.max_error_m,
        "bytes": report.bytes,
        "bytes_of": report.bytes_of,
        "planes": report.planes,
        "planes_of": report.planes_of,
    }))
}
