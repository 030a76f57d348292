//! TINs larger than memory: built tile by tile, joined, and written page by page.
//!
//! Only what the tiles have in common stays in memory: the vertices on the lines between them, their coarse tops, the
//! table of nodes. A tile's pages wait on the disk until their numbers in the whole are known.

mod files;
mod grid;
mod spool;

pub use files::FileTiles;
pub use grid::GridTiles;

use crate::{Error, ModelStored};
use rayon::prelude::*;
use std::collections::HashSet;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use yamanami_core::{Aabb, ClusterNode, ClusterPage, Crs, Snap, Tin};
use yamanami_io::IoError;
use yamanami_io::scratch::Scratch;
use yamanami_io::store::{ClusterCodec, ClusterMeta, ClusterWriter, TinAnnex, TinMeta, put_in_order};
use yamanami_multires::cluster::{ClusterOptions, TileTop, build_tile, join_tiles};

/// A TIN in tiles.
pub trait TinTiles: Sync {
    /// How many.
    fn count(&self) -> usize;

    /// The triangles of a tile, safe: those of all tiles together are the TIN. It may have none.
    fn tile(&self, number: usize) -> Result<Tin, Error>;

    /// Whether more than one tile may have a vertex at this place.
    fn is_shared(&self, place: glam::DVec3) -> bool;

    /// What is known of the whole.
    fn facts(&self) -> TinFacts;
}

/// What is known of a TIN in tiles.
#[derive(Debug, Clone)]
pub struct TinFacts {
    /// A name for people.
    pub title: String,
    /// Files, licence.
    pub source: String,
    /// The CRS of x and y.
    pub crs: Crs,
    /// Metres in a unit of the source.
    pub unit_m: f64,
    /// The lattice of its coordinates.
    pub snap: Snap,
    /// What is kept beside the triangles.
    pub annex: TinAnnex,
}

/// Pages coded between two writes.
const PAGES_AT_ONCE: usize = 64;

/// Tiles in memory for each processor.
const TILES_A_PROCESSOR: usize = 3;

/// Share of the work that building the tiles is.
const TILES_SHARE: f32 = 0.7;

/// What is kept in memory of a tile.
struct Built {
    top: TileTop,
    nodes: Vec<ClusterNode>,
    bounds: Aabb,
    faces: u64,
    /// Vertices that no other tile has.
    own_vertices: u64,
    /// Vertices and triangles of all levels but its top's.
    all: [u64; 2],
}

/// Builds the hierarchy of a TIN in tiles and writes it as a database. `path` changes only when all is written; scratch
/// space is taken beside it. `progress` hears of the share done, 0 to 1.
pub fn build_tiles(tiles: &dyn TinTiles, path: &Path, progress: &(dyn Fn(f32) + Sync)) -> Result<ModelStored, Error> {
    let facts = tiles.facts();
    let folder = path.parent().unwrap_or(Path::new(""));
    let scratch = Scratch::create(folder, tiles.count())?;
    let shared = Mutex::new(HashSet::new());
    let done = AtomicUsize::new(0);
    let build = |number: usize| -> Result<Option<Built>, Error> {
        let built = build_one(tiles, number, facts.snap, &scratch, &shared)?;
        let share = (done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / tiles.count() as f32;
        progress(TILES_SHARE * share);
        Ok(built)
    };
    let mut built: Vec<(usize, Built)> = Vec::with_capacity(tiles.count());
    // so many tiles in memory; more than one a processor, so that none waits long for another's last tile
    let at_once = TILES_A_PROCESSOR * rayon::current_num_threads().max(1);
    let numbers: Vec<usize> = (0..tiles.count()).collect();
    for some in numbers.chunks(at_once) {
        let made: Vec<Option<Built>> = some.par_iter().map(|&number| build(number)).collect::<Result<_, _>>()?;
        built.extend(some.iter().zip(made).filter_map(|(&number, built)| Some((number, built?))));
    }
    if built.is_empty() {
        return Err(Error::Request(format!("{}: expected a TIN with triangles, found none", facts.title)));
    }
    let shared = shared.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner).len() as u64;
    join(path, &facts, &scratch, built, shared, progress)
}

fn build_one(
    tiles: &dyn TinTiles,
    number: usize,
    snap: Snap,
    scratch: &Scratch,
    shared: &Mutex<HashSet<[u64; 3]>>,
) -> Result<Option<Built>, Error> {
    let tin = tiles.tile(number)?;
    if tin.mesh.triangles.is_empty() {
        return Ok(None);
    }
    let mut is_used = vec![false; tin.mesh.positions.len()];
    tin.mesh.triangles.as_flattened().iter().for_each(|&v| is_used[v as usize] = true);
    let (mut bounds, mut own_vertices, mut with_others) = (Aabb::EMPTY, 0, Vec::new());
    for (&p, _) in tin.mesh.positions.iter().zip(is_used).filter(|(_, used)| *used) {
        bounds.include(p);
        if tiles.is_shared(p) {
            with_others.push((p + glam::DVec3::ZERO).to_array().map(f64::to_bits));
        } else {
            own_vertices += 1;
        }
    }
    shared.lock().unwrap_or_else(std::sync::PoisonError::into_inner).extend(with_others);
    let faces = tin.mesh.triangles.len() as u64;
    let mut tile = build_tile(&tin, &|p| tiles.is_shared(p), Some(snap), &ClusterOptions::default())?;
    drop(tin);
    let build = &mut tile.build;
    put_in_order(&build.nodes, &build.base_clusters, &mut build.base, &mut build.pages);
    let all = [
        build.pages.iter().map(|p| p.vertices.len() as u64).sum(),
        build.pages.iter().map(|p| p.triangles.len() as u64).sum(),
    ];
    spool::append(scratch, number, &build.pages)?;
    let top = tile.take_top();
    Ok(Some(Built { top, nodes: tile.build.nodes, bounds, faces, own_vertices, all }))
}

/// Joins the tiles and writes everything.
fn join(
    path: &Path,
    facts: &TinFacts,
    scratch: &Scratch,
    built: Vec<(usize, Built)>,
    shared: u64,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<ModelStored, Error> {
    let tops: Vec<TileTop> = built.iter().map(|(_, b)| b.top.clone()).collect();
    let above = join_tiles(&tops, Some(facts.snap), &ClusterOptions::default())?;
    drop(tops);
    let (mut build, seams) = (above.build, above.seams);
    let mut nodes = std::mem::take(&mut build.nodes);
    // the seams name vertices by their numbers, so those stay as they are
    let base_vertices = build.base.vertices.len() as u32;
    let mut bounds = Aabb::EMPTY;
    let (mut faces, mut own_vertices) = (0, 0);
    let mut vertices: u64 = build.pages.iter().chain([&build.base]).map(|p| p.vertices.len() as u64).sum();
    let mut triangles: u64 = build.pages.iter().chain([&build.base]).map(|p| p.triangles.len() as u64).sum();
    let mut numbers = Vec::with_capacity(built.len());
    for ((number, tile), seam) in built.into_iter().zip(&seams) {
        numbers.push(number);
        bounds.include(tile.bounds.min);
        bounds.include(tile.bounds.max);
        (faces, own_vertices) = (faces + tile.faces, own_vertices + tile.own_vertices);
        (vertices, triangles) = (vertices + tile.all[0], triangles + tile.all[1]);
        let mut own = tile.nodes;
        seam.place_nodes(&mut own);
        nodes.extend(own);
    }
    let meta = ClusterMeta {
        title: facts.title.clone(),
        source: facts.source.clone(),
        source_faces: faces,
        source_vertices: own_vertices + shared,
        bounds,
        quantum_m: facts.snap.metres(1.0),
        max_error_m: 0.0,
        has_colours: false,
        nodes: nodes.len() as u32,
        triangles,
        vertices,
        tin: Some(TinMeta { crs: facts.crs.clone(), unit_m: facts.unit_m, snap: facts.snap }),
    };
    let mut stored = ModelStored { page_bytes: 0, triangles, vertices, nodes: nodes.len(), max_error_m: 0.0 };
    let mut writer = ClusterWriter::create(path, meta, &nodes, base_vertices, &build.base_clusters)?;
    let codec = writer.codec();
    let first_of = |page: &ClusterPage| nodes.get(page.group as usize).map_or(0, |node| node.first_vertex);
    write(&mut writer, codec, std::slice::from_ref(&build.base), &first_of, &mut stored)?;
    write(&mut writer, codec, &build.pages, &first_of, &mut stored)?;
    drop(build);
    for (done, (number, seam)) in numbers.iter().zip(&seams).enumerate() {
        let mut pages = spool::take(scratch, *number)?;
        pages.par_iter_mut().for_each(|page| seam.place_page(page));
        write(&mut writer, codec, &pages, &first_of, &mut stored)?;
        progress(TILES_SHARE + (1.0 - TILES_SHARE) * (done + 1) as f32 / numbers.len() as f32);
    }
    writer.insert_annex(&facts.annex)?;
    writer.finish()?;
    Ok(stored)
}

fn write(
    writer: &mut ClusterWriter,
    codec: ClusterCodec,
    pages: &[ClusterPage],
    first_of: &(dyn Fn(&ClusterPage) -> u32 + Sync),
    stored: &mut ModelStored,
) -> Result<(), IoError> {
    for some in pages.chunks(PAGES_AT_ONCE) {
        let coded: Vec<Vec<u8>> =
            some.par_iter().map(|page| codec.encode(page, first_of(page))).collect::<Result<_, _>>()?;
        for (page, bytes) in some.iter().zip(coded) {
            stored.page_bytes += bytes.len() as u64;
            writer.insert(page.group, &bytes)?;
        }
    }
    Ok(())
}
