//! Judges a pyramid of quantized-mesh tiles, or one tile.

mod cracks;
mod errors;
mod layer;
mod pyramid;
mod tile;

use super::report::ValidateReport;
use super::{Progress, Source, ValidateOptions, sample};
use crate::Error;
use pyramid::{Pyramid, TileId};
use rayon::prelude::*;
use serde_json::Value;
use std::path::Path;
use yamanami_io::inspect::{Container, Faults, quantized_mesh, without_gzip};

/// Judges a folder of tiles.
pub(super) fn folder(
    path: &Path,
    options: &ValidateOptions,
    source: Option<&Source>,
    progress: Progress<'_>,
) -> Result<ValidateReport, Error> {
    let mut report = ValidateReport::new("quantized-mesh pyramid");
    let container = Container::folder(path);
    let layer = match container.read("layer.json")? {
        None => {
            report.add("LJ01", "layer.json", "", "a JSON object", "no such file");
            None
        }
        Some(bytes) => {
            let mut faults = Faults::default();
            let plain = without_gzip(&bytes, "LJ01", &mut faults);
            let parsed = plain.and_then(|p| serde_json::from_slice::<Value>(&p).ok()).filter(Value::is_object);
            if parsed.is_none() {
                report.add("LJ01", "layer.json", "", "a JSON object", "something else");
            }
            parsed
        }
    };
    if let Some(layer) = &layer {
        layer::check(layer, &mut report);
    }
    let pyramid = Pyramid::open(container, layer)?;
    if pyramid.tiles.is_empty() {
        return Err(Error::Request(format!("{}: expected tiles named z/x/y.terrain, found none", path.display())));
    }
    layer::check_tree(&pyramid, &mut report);
    if let Some(layer) = &pyramid.layer {
        layer::check_available(&pyramid, layer, &mut report);
    }
    let all: Vec<TileId> = pyramid.tiles.iter().copied().collect();
    let chosen = options.tiles.map_or_else(|| all.clone(), |n| sample(&all, n, options.seed));
    report.tiles = [all.len() as u64, chosen.len() as u64];
    check_tiles(&pyramid, &chosen, &mut report, progress);
    cracks::measure(&pyramid, &chosen, options.crack_m, &mut report, &|share| progress("cracks", share));
    errors::measure(&pyramid, &chosen, options, source, &mut report, &|share| progress("errors", share))?;
    Ok(report)
}

fn check_tiles(pyramid: &Pyramid, chosen: &[TileId], report: &mut ValidateReport, progress: Progress<'_>) {
    const AT_ONCE: usize = 256;
    for (k, ids) in chosen.chunks(AT_ONCE).enumerate() {
        progress("tiles", (k * AT_ONCE) as f32 / chosen.len() as f32);
        let one = |&id: &TileId| {
            let (tile, mut faults) = pyramid.read(id);
            let mut own = Faults::default();
            if let Some(tile) = &tile {
                tile::check(pyramid, tile, &mut own);
            }
            faults.extend(own.into_vec());
            (id, tile.map_or([0; 2], |t| [t.stored as u64, t.mesh.triangles.len() as u64]), faults)
        };
        let found: Vec<_> = ids.par_iter().map(one).collect();
        for (id, [bytes, triangles], faults) in found {
            report.bytes += bytes;
            report.triangles += triangles;
            report.add_all(&pyramid.name(id), faults);
        }
    }
}

/// Judges one tile without its pyramid: what does not need to know its place.
pub(super) fn single(path: &Path, bytes: &[u8]) -> ValidateReport {
    let mut report = ValidateReport::new("quantized-mesh tile");
    let mut faults = Faults::default();
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    report.bytes = bytes.len() as u64;
    let plain = without_gzip(bytes, "QM01", &mut faults);
    if let Some(mesh) = plain.and_then(|plain| quantized_mesh(&plain, &mut faults)) {
        report.triangles = mesh.triangles.len() as u64;
        tile::check_alone(&mesh, &mut faults);
    }
    report.tiles = [1, 1];
    report.add_all(&name, faults.into_vec());
    report
}
