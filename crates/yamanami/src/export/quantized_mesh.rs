//! quantized-mesh 1.0: the pyramid and its `layer.json`.

use super::geodetic::{Geodetic, ranges};
use super::terrain_tiles::{TILES_AT_ONCE, TerrainTiles, trim};
use super::{ExportJob, ExportKind, ExportReport, ExportSubject, ZoomReport};
use crate::Error;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use yamanami_io::tiles::quantized_mesh::{Layer, MeshTile, encode, pack, tile_path, tile_rectangle_deg};
use yamanami_io::tiles::{TileFolder, TileOutput};
use yamanami_multires::tiles::{CutScratch, Tile, TilePiece};

pub(super) fn folder(subject: ExportSubject<'_>, job: &ExportJob<'_>) -> Result<ExportReport, Error> {
    let terrain = subject.terrain("quantized-mesh")?;
    let mut report = ExportReport::default();
    let geodetic = Geodetic::of(terrain, job.options, &mut report.notes)?;
    let folder = TileFolder::create(job.output, &job.identity(ExportKind::QuantizedMesh))?;
    let [first, last] = geodetic.options.zooms;
    let all: Vec<Vec<Tile>> = {
        let cutter = TerrainTiles::new(terrain, &geodetic.placement, &geodetic.options);
        (first..=last).map(|zoom| tiles_of(&cutter, &geodetic, zoom)).collect()
    };
    let (total, done) = (all.iter().map(Vec::len).sum::<usize>().max(1) as f32, AtomicU64::new(0));
    let mut layer = Layer {
        name: terrain.title().to_owned(),
        attribution: String::new(),
        bounds_deg: geodetic.bounds_deg(),
        has_normals: job.options.normals,
        available: vec![Vec::new(); last as usize + 1],
        error_m: vec![None; last as usize + 1],
    };
    for tiles in &all {
        let zoom = tiles.first().map_or(first, |t| t.zoom);
        let mut sum = ZoomReport { zoom, ..ZoomReport::default() };
        let mut there = Vec::new();
        for batch in tiles.chunks(TILES_AT_ONCE) {
            let cutter = TerrainTiles::new(terrain, &geodetic.placement, &geodetic.options);
            let made: Vec<Option<Made>> = batch
                .par_iter()
                .map_init(CutScratch::default, |scratch, &tile| {
                    let made = make(&cutter, tile, scratch, &folder, job);
                    (job.progress)(done.fetch_add(1, Ordering::Relaxed) as f32 / total);
                    made
                })
                .collect::<Result<_, Error>>()?;
            for (tile, made) in batch.iter().zip(made) {
                let Some(made) = made else { continue };
                there.push(Geodetic::wrapped(*tile));
                sum.tiles += 1;
                sum.triangles += made.triangles;
                sum.bytes += made.bytes;
                sum.error_m = sum.error_m.max(made.error_m);
                report.kept += u64::from(made.kept);
            }
            trim(terrain);
        }
        layer.available[zoom as usize] = ranges(&there);
        layer.error_m[zoom as usize] = Some(sum.error_m);
        report.zooms.push(sum);
    }
    folder.put("layer.json", layer.to_json().as_bytes())?;
    folder.finish()?;
    Ok(report)
}

/// The tiles of a zoom, row by row.
pub(super) fn tiles_of(cutter: &TerrainTiles<'_>, geodetic: &Geodetic, zoom: u32) -> Vec<Tile> {
    let mut tiles = cutter.tiles(zoom);
    // viewers ask for both roots
    if zoom == 0 && geodetic.options.fill_m.is_some() {
        tiles.extend((0..2).map(|x| Tile { zoom, x, y: 0 }));
        tiles.sort_unstable_by_key(|&tile| Geodetic::wrapped(tile));
        tiles.dedup_by_key(|tile| Geodetic::wrapped(*tile));
    }
    tiles
}

/// A tile's file, packed.
pub(super) fn bytes_of(
    cutter: &TerrainTiles<'_>,
    piece: &TilePiece,
    tile: Tile,
    with_normals: bool,
) -> Result<Vec<u8>, Error> {
    let normals = if with_normals { cutter.normals(tile, piece)? } else { Vec::new() };
    let [x, y] = Geodetic::wrapped(tile);
    Ok(pack(&encode(&MeshTile {
        rectangle_deg: tile_rectangle_deg(tile.zoom, x, y),
        places: &piece.places,
        heights_m: &piece.heights_m,
        quantum_m: piece.quantum_m,
        triangles: &piece.triangles,
        sides: &piece.sides,
        normals: &normals,
    }))?)
}

/// What became of a tile.
struct Made {
    triangles: u64,
    bytes: u64,
    error_m: f64,
    kept: bool,
}

/// Cuts a tile and writes it, unless it is there; `None` when there is nothing in it.
fn make(
    cutter: &TerrainTiles<'_>,
    tile: Tile,
    scratch: &mut CutScratch,
    output: &TileFolder,
    job: &ExportJob<'_>,
) -> Result<Option<Made>, Error> {
    let piece = cutter.cut(tile, scratch)?;
    if piece.is_empty() {
        return Ok(None);
    }
    let [x, y] = Geodetic::wrapped(tile);
    let path = tile_path(tile.zoom, x, y);
    let mut made =
        Made { triangles: piece.triangles.len() as u64, bytes: 0, error_m: piece.error_m, kept: output.has(&path) };
    if made.kept {
        made.bytes = std::fs::metadata(output.part().join(&path)).map_or(0, |meta| meta.len());
        return Ok(Some(made));
    }
    let bytes = bytes_of(cutter, &piece, tile, job.options.normals)?;
    made.bytes = bytes.len() as u64;
    output.put(&path, &bytes)?;
    Ok(Some(made))
}
