//! 3D Tiles of scans and TINs: an implicit octree in the model's own metres, or a quadtree in a level frame on the globe where
//! the CRS is known.

use super::model_cells::Plan;
use super::placement::Placement;
use super::tileset_files::{TilePlace, TileRecord, TileTree, box_of, content_path, kept_content};
use super::{ExportJob, ExportReport};
use crate::{Error, Model, Subject};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::BTreeMap;
use yamanami_core::{Aabb, Hierarchy, NodeId};
use yamanami_io::mesh_file::MeshMeta;
use yamanami_io::tiles::glb::{GlbFacts, TileClaim, encode_glb};
use yamanami_io::tiles::subtree::{TileBounds, TileFacts};
use yamanami_io::tiles::tileset::BoundingVolume;
use yamanami_io::tiles::{TileFolder, TileOutput};

/// Triangles of a leaf, about.
const LEAF_TRIANGLES: i64 = 40_000;
/// Tiles made side by side: each has its triangles in memory.
const TILES_AT_ONCE: usize = 8;
/// Bytes of pages that stay between tiles.
const PAGE_BYTES: usize = 512 << 20;

/// Writes the tiles, subtrees and `tileset.json` of a model.
pub(super) fn write(model: &mut Model, job: &ExportJob<'_>, folder: &TileFolder) -> Result<ExportReport, Error> {
    let options = job.options;
    let mut notes = Vec::new();
    let placement = match model.tin() {
        Some(tin) => {
            let found = Placement::of(&tin.crs, &model.bounds(), options.heights, &options.geoid, &mut notes)?;
            if found.is_none() {
                notes.push("the CRS is not known: the tiles are in the TIN's own metres, not on the globe".to_owned());
            }
            found
        }
        None => None,
    };
    let plan = Plan::of(model, placement, options.tolerance_m.unwrap_or(0.0), LEAF_TRIANGLES);
    let mut report = ExportReport { notes, ..ExportReport::default() };
    let mut tiles = BTreeMap::new();
    let meta = MeshMeta::default();
    for (done, batch) in plan.tiles.chunks(TILES_AT_ONCE).enumerate() {
        let fronts: Vec<(Vec<bool>, f64)> =
            batch.par_iter().map(|&(tile, is_leaf)| plan.front(tile, is_leaf, model.surface())).collect();
        let kept: Vec<Option<TileRecord>> = batch.iter().map(|&(tile, _)| kept(&plan, tile, folder)).collect();
        let wanted: Vec<NodeId> = (0..model.surface().node_bound())
            .filter(|&n| fronts.iter().zip(&kept).any(|((front, _), kept)| kept.is_none() && front[n as usize]))
            .collect();
        model.load(&wanted, usize::MAX)?;
        let made: Result<Vec<Option<TileRecord>>, Error> = batch
            .par_iter()
            .zip(&fronts)
            .zip(&kept)
            .map(|((&(tile, _), (front, error_m)), kept)| {
                if kept.is_some() {
                    return Ok(*kept);
                }
                let (part, sag_m) = plan.part(tile, front, model)?;
                if part.triangles.is_empty() {
                    return Ok(None);
                }
                let claim = TileClaim { error_m: error_m + sag_m, height_range_m: None };
                let file = encode_glb(&part, options.packing, &meta, &claim);
                folder.put(&content_path(plan.cells.subdivision, tile), &file)?;
                Ok(GlbFacts::of(&file).map(|facts| record(&plan, &facts, file.len())))
            })
            .collect();
        for ((&(tile, _), made), kept) in batch.iter().zip(made?).zip(&kept) {
            report.kept += u64::from(kept.is_some());
            if let Some(made) = made {
                tiles.insert(tile, made);
            }
        }
        model.shrink(PAGE_BYTES, |_| false);
        (job.progress)(((done + 1) * TILES_AT_ONCE).min(plan.tiles.len()) as f32 / plan.tiles.len() as f32);
    }
    if tiles.is_empty() {
        return Err(Error::Request(format!("{}: has no triangles to write", model.title())));
    }
    let root = plan.cells.root();
    let mut tree = TileTree {
        subdivision: plan.cells.subdivision,
        tiles,
        root_volume: BoundingVolume { oriented_box: Some(box_of(&root, 0.0)), ..BoundingVolume::default() },
        transform: plan.placement.as_ref().map(Placement::transform),
        size_m: model.bounds().diagonal(),
    };
    tree.nest();
    tree.write(folder, model.title())?;
    report.zooms = tree.zooms();
    Ok(report)
}

/// What is known of a tile that an earlier run wrote.
fn kept(plan: &Plan, tile: TilePlace, folder: &TileFolder) -> Option<TileRecord> {
    let (facts, bytes) = kept_content(folder, plan.cells.subdivision, tile)?;
    Some(record(plan, &facts, bytes))
}

fn record(plan: &Plan, facts: &GlbFacts, bytes: usize) -> TileRecord {
    // a flat box is one step thick
    let step = DVec3::splat(0.5 * plan.cells.step_m);
    let bounds = Aabb { min: facts.bounds.min - step, max: facts.bounds.max + step };
    TileRecord {
        facts: TileFacts { bounds: TileBounds::Box(box_of(&bounds, 0.0)), error_m: facts.claim.error_m },
        has_content: true,
        triangles: facts.triangles,
        bytes: bytes as u64,
    }
}
