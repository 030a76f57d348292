//! `build` of many TINs, or of the cells of a grid: tile by tile, however large.

use super::build::BuildArgs;
use super::build_model::{check_exact, size_row, time_row, title};
use crate::failure::Failure;
use crate::progress::{Bar, note};
use crate::{inputs, out, text};
use serde_json::json;
use std::path::Path;
use std::time::Instant;
use yamanami::io::dem;
use yamanami::io::store::ClusterStore;
use yamanami::io::tin_file::TinReadOptions;
use yamanami::{FileTiles, GridTiles, GroundOptions, ModelStored, TinTiles, build_tiles};

/// Several TIN files that lie beside each other.
pub(crate) fn of_files(args: &BuildArgs) -> Result<(), Failure> {
    check_exact(args)?;
    let started = Instant::now();
    let folder = args.output.parent().unwrap_or(Path::new(""));
    let tiles = {
        let bar = Bar::shares("reading");
        let epsg = args.source.reading.options().dem.crs.and_then(|crs| crs.epsg);
        let tin = TinReadOptions { epsg, ..TinReadOptions::default() };
        let options = GroundOptions { tin, ..GroundOptions::default() };
        FileTiles::read(&args.source.sources, &options, folder, &|share| bar.set_share(share))?
    };
    tiles.notes.iter().for_each(|line| note(&format!("note: {line}")));
    build(args, &tiles, started)
}

/// The cells of elevation files that make one mosaic.
pub(crate) fn of_grid(args: &BuildArgs) -> Result<(), Failure> {
    check_exact(args)?;
    let started = Instant::now();
    let source = dem::open(&args.source.sources, &args.source.reading.options().dem)?;
    let title = args.source.sources.first().map_or_else(String::new, |file| title(file));
    build(args, &GridTiles::new(source, title)?, started)
}

fn build(args: &BuildArgs, tiles: &dyn TinTiles, started: Instant) -> Result<(), Failure> {
    let read_s = started.elapsed().as_secs_f64();
    let stored = {
        let bar = Bar::shares("building");
        build_tiles(tiles, &args.output, &|share| bar.set_share(share))?
    };
    report(args, tiles.count(), &stored, read_s, started.elapsed().as_secs_f64())
}

fn report(args: &BuildArgs, tiles: usize, stored: &ModelStored, read_s: f64, build_s: f64) -> Result<(), Failure> {
    let store = ClusterStore::open(&args.output)?;
    let meta = store.meta();
    let (bytes, source_bytes) = (inputs::file_bytes(&args.output)?, inputs::total_bytes(&args.source.sources));
    let bytes_per_face = bytes as f64 / meta.source_faces.max(1) as f64;
    if args.json {
        return out::json(&json!({
            "output": args.output,
            "faces": meta.source_faces,
            "vertices": meta.source_vertices,
            "tiles": tiles,
            "nodes": stored.nodes,
            "triangles_of_all_levels": stored.triangles,
            "vertices_of_all_levels": stored.vertices,
            "bytes": bytes,
            "page_bytes": stored.page_bytes,
            "bytes_per_face": bytes_per_face,
            "source_bytes": source_bytes,
            "read_s": read_s,
            "build_s": build_s,
        }));
    }
    out::row("database", args.output.display())?;
    out::row(
        "faces",
        format_args!(
            "{}, {} vertices, kept bit for bit",
            text::count(meta.source_faces),
            text::count(meta.source_vertices)
        ),
    )?;
    out::row(
        "levels",
        format_args!(
            "{} triangles of all levels in {} nodes, built in {} tiles",
            text::count(stored.triangles),
            text::count(stored.nodes),
            text::count(tiles)
        ),
    )?;
    size_row(bytes, bytes_per_face, source_bytes)?;
    time_row(args, meta.source_faces, build_s)
}
