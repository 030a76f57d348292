//! Judges 3D Tiles: a folder with tileset.json, or a 3tz archive.

mod content;
mod errors;
mod implicit;
mod seams;
mod tree;
mod volume;

use super::report::ValidateReport;
use super::{Progress, Source, ValidateOptions, sample};
use crate::Error;
use content::Contents;
use rayon::prelude::*;
use std::path::Path;
use tree::Tree;
use yamanami_io::inspect::{Container, Faults, three_tz};

/// Endings of files that should belong to a tile.
const CONTENT_ENDINGS: [&str; 6] = ["glb", "b3dm", "i3dm", "pnts", "cmpt", "subtree"];

/// Judges a 3tz archive and the tileset in it.
pub(super) fn archive(
    path: &Path,
    options: &ValidateOptions,
    source: Option<&Source>,
    progress: Progress<'_>,
) -> Result<ValidateReport, Error> {
    let mut faults = Faults::default();
    three_tz(path, &mut faults)?;
    let mut report = if faults.has("TZ01") || faults.has("TZ06") {
        ValidateReport::new("3tz archive")
    } else {
        judge(&Container::zip(path)?, "tileset.json", options, source, progress)?
    };
    report.kind = report.kind.replace("3D Tiles", "3tz archive of 3D Tiles");
    report.add_all(&path.file_name().unwrap_or_default().to_string_lossy(), faults.into_vec());
    Ok(report)
}

/// Judges a tileset.
pub(super) fn judge(
    container: &Container,
    name: &str,
    options: &ValidateOptions,
    source: Option<&Source>,
    progress: Progress<'_>,
) -> Result<ValidateReport, Error> {
    let mut report = ValidateReport::new("3D Tiles");
    progress("documents", 0.0);
    let tree = Tree::read(container, name, &mut report);
    for file in container.list()? {
        let ending = file.rsplit('.').next().unwrap_or_default();
        if CONTENT_ENDINGS.contains(&ending) && !tree.named.contains(&file) {
            report.add("IM11", &file, "", "a file that some tile names", "one that none does");
        }
    }
    let all: Vec<usize> = (0..tree.tiles.len()).filter(|&k| !tree.tiles[k].contents.is_empty()).collect();
    let chosen = options.tiles.map_or_else(|| all.clone(), |n| sample(&all, n, options.seed));
    report.tiles = [all.len() as u64, chosen.len() as u64];
    let contents = Contents::new(&tree);
    check_contents(&contents, &chosen, &mut report, progress);
    seams::measure(&contents, &chosen, options.crack_m, &mut report, &|share| progress("cracks", share));
    let only_some = chosen.len() < all.len();
    errors::measure(&contents, &chosen, only_some, source, &mut report, &|share| progress("errors", share))?;
    Ok(report)
}

fn check_contents(contents: &Contents<'_, '_>, chosen: &[usize], report: &mut ValidateReport, progress: Progress<'_>) {
    const AT_ONCE: usize = 128;
    for (k, some) in chosen.chunks(AT_ONCE).enumerate() {
        progress("tiles", (k * AT_ONCE) as f32 / chosen.len() as f32);
        let one = |&tile: &usize| {
            let (content, files) = contents.read(tile);
            let mut faults = Faults::default();
            contents.check_volumes(tile, &content, &mut faults);
            (tile, [content.stored as u64, content.mesh.triangles.len() as u64], files, faults.into_vec())
        };
        let found: Vec<_> = some.par_iter().map(one).collect();
        for (tile, [bytes, triangles], files, faults) in found {
            report.bytes += bytes;
            report.triangles += triangles;
            for (name, faults) in files {
                report.add_all(&name, faults);
            }
            report.add_all(&contents.tree.tiles[tile].name, faults);
        }
    }
}
