//! `build` of a mesh or a TIN: a model at every level of detail.

use super::build::BuildArgs;
use crate::failure::Failure;
use crate::progress::{Bar, note};
use crate::{inputs, out, text};
use serde_json::json;
use std::path::Path;
use std::time::Instant;
use yamanami::io::mesh_file;
use yamanami::io::tin_file::TinReadOptions;
use yamanami::{GroundOptions, ModelBuild, ModelStoreOptions, read_ground};

pub(crate) fn run(args: &BuildArgs, file: &Path) -> Result<(), Failure> {
    let started = Instant::now();
    let mesh = {
        let _bar = Bar::spinner("reading");
        mesh_file::read_mesh(file)?
    };
    let title = title(file);
    store(args, file, started, [mesh.triangles.len(), mesh.positions.len()], |progress| {
        Ok(ModelBuild::of_mesh(&mesh, title, progress)?)
    })
}

/// `build` of a TIN file, or of a mesh file that is terrain.
pub(crate) fn run_tin(args: &BuildArgs, file: &Path) -> Result<(), Failure> {
    check_exact(args)?;
    let started = Instant::now();
    let read = {
        let _bar = Bar::spinner("reading");
        let epsg = args.source.reading.options().dem.crs.and_then(|crs| crs.epsg);
        let tin = TinReadOptions { epsg, ..TinReadOptions::default() };
        read_ground(&[file.to_owned()], &GroundOptions { tin, ..GroundOptions::default() })?
    };
    read.notes.iter().for_each(|line| note(&format!("note: {line}")));
    let tin = read.tin;
    let title = if tin.name.is_empty() { title(file) } else { tin.name.clone() };
    store(args, file, started, [tin.mesh.triangles.len(), tin.mesh.positions.len()], |progress| {
        Ok(ModelBuild::of_tin(&tin, title, progress)?)
    })
}

/// A TIN is not rounded.
pub(super) fn check_exact(args: &BuildArgs) -> Result<(), Failure> {
    if args.progressive || args.max_error.is_some() {
        return Err(Failure::misuse(
            "a TIN's vertices are kept bit for bit: --progressive and --max-error are for others",
        ));
    }
    Ok(())
}

pub(super) fn title(file: &Path) -> String {
    file.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned())
}

fn store(
    args: &BuildArgs,
    file: &Path,
    started: Instant,
    counts: [usize; 2],
    build: impl FnOnce(&(dyn Fn(f32) + Sync)) -> Result<ModelBuild, Failure>,
) -> Result<(), Failure> {
    let read_s = started.elapsed().as_secs_f64();
    let [faces, vertices] = counts.map(|n| n as u64);
    let building = Instant::now();
    let build = {
        let bar = Bar::shares("building");
        build(&|share| bar.set_share(share))?
    };
    let hierarchy_s = building.elapsed().as_secs_f64();
    let options = ModelStoreOptions { max_error_m: args.max_error, source: title(file) };
    let stored = {
        let bar = Bar::shares("writing");
        build.store_as(&args.output, &options, &|share| bar.set_share(share))?
    };
    let build_s = started.elapsed().as_secs_f64();
    let (bytes, source_bytes) = (inputs::file_bytes(&args.output)?, inputs::file_bytes(file)?);
    let bytes_per_face = bytes as f64 / faces as f64;
    if args.json {
        return out::json(&json!({
            "output": args.output,
            "faces": faces,
            "vertices": vertices,
            "nodes": stored.nodes,
            "triangles_of_all_levels": stored.triangles,
            "vertices_of_all_levels": stored.vertices,
            "max_error_m": stored.max_error_m,
            "bytes": bytes,
            "page_bytes": stored.page_bytes,
            "bytes_per_face": bytes_per_face,
            "source_bytes": source_bytes,
            "read_s": read_s,
            "hierarchy_s": hierarchy_s,
            "build_s": build_s,
        }));
    }
    out::row("database", args.output.display())?;
    out::row("faces", format_args!("{}, {} vertices", text::count(faces), text::count(vertices)))?;
    out::row(
        "levels",
        format_args!(
            "{} triangles of all levels in {} nodes",
            text::count(stored.triangles),
            text::count(stored.nodes)
        ),
    )?;
    size_row(bytes, bytes_per_face, source_bytes)?;
    let kept = if stored.max_error_m > 0.0 {
        format!("kept within {} m", text::number(stored.max_error_m))
    } else {
        "kept bit for bit".to_owned()
    };
    out::row("vertices", kept)?;
    time_row(args, faces, build_s)
}

/// What a database takes, beside its source.
pub(super) fn size_row(bytes: u64, bytes_per_face: f64, source_bytes: u64) -> Result<(), Failure> {
    let [bytes, source] = [bytes, source_bytes].map(text::bytes);
    out::row("size", format_args!("{bytes}, {} bytes a face; the source has {source}", text::number(bytes_per_face)))
}

/// How long it took, and what may be done next.
pub(super) fn time_row(args: &BuildArgs, faces: u64, build_s: f64) -> Result<(), Failure> {
    let rate = text::number(faces as f64 / build_s / 1e6);
    out::row("time", format_args!("{} s, {rate} million faces a second", text::number(build_s)))?;
    note(&format!("next: yamanami fly {} --budget 100000", args.output.display()));
    Ok(())
}
