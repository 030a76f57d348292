//! A terrain to and from its database.

use crate::{Data, Error, Terrain};
use rayon::prelude::*;
use std::path::Path;
use yamanami_core::{ErrorCode, HeightField, Lattice, LatticeNode, PAGE_CELLS, PageId, TerrainPage};
use yamanami_io::IoError;
use yamanami_io::store::{EncodedPage, Quantum, QuantumFinder, TerrainMeta, TerrainStore, TerrainWriter};
use yamanami_multires::MultiresError;
use yamanami_multires::wavelet::{GridData, NodeNumbers, PagedData, TerrainData, TerrainSurface};

/// How to store a terrain.
#[derive(Debug, Clone)]
pub struct StoreOptions {
    /// How far the terrain's heights are from the source's, metres, and the quantum they were rounded to by
    /// [`quantise`]; `None`: they are the source's, and kept exactly.
    pub rounded: Option<(f64, Quantum)>,
    /// Stored error codes are rounded up to one of so many steps an octave (a power of two up to 2048, which is exact):
    /// more steps, fewer triangles at a tolerance, a larger file.
    pub error_steps_per_octave: u32,
    /// Where the heights come from: files, licence.
    pub source: String,
}

impl Default for StoreOptions {
    fn default() -> Self {
        Self { rounded: None, error_steps_per_octave: TerrainMeta::USUAL_ERROR_STEPS, source: String::new() }
    }
}

/// Pages coded between two writes.
const PAGES_AT_ONCE: usize = 64;

/// Rounds heights, at most this far (metres), to what a database can hold in fewer bytes. Build and store the result, with
/// the quantum in [`StoreOptions::rounded`]: then errors are those of the stored heights.
pub fn quantise(field: HeightField, max_error_m: f64) -> (HeightField, Quantum) {
    let (width, height, geo) = (field.width(), field.height(), field.geo().clone());
    let mut heights_m = field.into_heights_m();
    let mut finder = QuantumFinder::default();
    finder.add(&heights_m);
    let quantum = finder.within(max_error_m);
    quantum.quantise(&mut heights_m);
    (HeightField::new(width, height, heights_m, geo), quantum)
}

impl Terrain {
    /// Writes the terrain, which is in memory, as a database. `path` changes only when all is written. `progress` hears of
    /// the share done, 0 to 1.
    pub fn store_as(&self, path: &Path, options: &StoreOptions, progress: &dyn Fn(f32)) -> Result<(), Error> {
        let Data::Grid(grid) = self.surface().data() else {
            return Err(Error::Request("this terrain is a database already: copy the file".to_owned()));
        };
        let (max_error_m, quantum) = options.rounded.unwrap_or_else(|| {
            let mut finder = QuantumFinder::default();
            finder.add(grid.heights_m());
            (0.0, finder.lossless())
        });
        let [width, height] = self.size().map(|n| n as u32);
        let meta = TerrainMeta {
            geo: self.geo().clone(),
            size: [width, height],
            height_range_m: self.range_m(),
            bound_radius_m: self.surface().bound_radius_m().to_vec(),
            has_holes: grid.has_holes(),
            max_error_m,
            quantum,
            error_steps_per_octave: options.error_steps_per_octave,
            level0_slack_m: grid.rounding_m(),
            title: self.title().to_owned(),
            source: options.source.clone(),
        };
        let mut writer = TerrainWriter::create(path, meta)?;
        let lattice = grid.lattice();
        let ids: Vec<PageId> = (0..=lattice.levels()).rev().flat_map(|level| page_ids(lattice, level)).collect();
        for (done, batch) in ids.chunks(PAGES_AT_ONCE).enumerate() {
            let codec = writer.codec();
            let coded: Result<Vec<EncodedPage>, IoError> =
                batch.par_iter().map(|&id| codec.encode_page(&page_of(grid, id))).collect();
            for page in coded? {
                writer.insert(&page)?;
            }
            progress(((done + 1) * PAGES_AT_ONCE).min(ids.len()) as f32 / ids.len() as f32);
        }
        writer.finish()?;
        Ok(())
    }
}

fn page_ids(lattice: &Lattice, level: u32) -> impl Iterator<Item = PageId> {
    let [nx, ny] = lattice.squares(level).map(|n| n.div_ceil(PAGE_CELLS));
    (0..ny).flat_map(move |y| (0..nx).map(move |x| PageId { level, x, y }))
}

/// A page cut from the grid.
fn page_of(grid: &GridData, id: PageId) -> TerrainPage {
    let lattice = grid.lattice();
    let [nx, ny] = lattice.squares(id.level);
    let (x0, y0) = (id.x * PAGE_CELLS, id.y * PAGE_CELLS);
    let (squares_x, squares_y) = ((nx - x0).min(PAGE_CELLS), (ny - y0).min(PAGE_CELLS));
    let places = || {
        (y0..=y0 + squares_y)
            .flat_map(move |y| (x0..=x0 + squares_x).map(move |x| LatticeNode { level: id.level, x, y }))
    };
    let is_base = id.level == lattice.levels();
    let errors = places().map(|n| if is_base || (n.x | n.y) & 1 == 0 { ErrorCode(0) } else { grid.error(n) }).collect();
    let shown = if grid.has_holes() {
        let bits = |x, y| u8::from(grid.shown(id.level, x, y, 0)) | u8::from(grid.shown(id.level, x, y, 1)) << 1;
        (y0..y0 + squares_y).flat_map(|y| (x0..x0 + squares_x).map(move |x| (x, y))).map(|(x, y)| bits(x, y)).collect()
    } else {
        Vec::new()
    };
    TerrainPage {
        id,
        width: squares_x + 1,
        height: squares_y + 1,
        heights_m: places().map(|n| grid.height_m(n)).collect(),
        errors,
        shown,
    }
}

/// Opens a database: its coarsest pages are read, the others as they are wanted.
pub(crate) fn open(path: &Path, title: String) -> Result<Terrain, Error> {
    let store = TerrainStore::open(path)?;
    // pages live on in the surface: the store need only keep the way down to the next ones
    store.set_cache_bytes(32 << 20);
    let meta = store.meta().clone();
    let lattice = store.lattice().clone();
    let [width, height] = meta.size.map(|n| n as usize);
    let numbers = NodeNumbers::new(lattice.clone()).ok_or(MultiresError::TooLarge { width, height })?;
    let data = PagedData::new(lattice.clone(), meta.has_holes);
    for level in lattice.levels().saturating_sub(1)..=lattice.levels() {
        for id in page_ids(&lattice, level) {
            data.insert(store.page(id)?);
        }
    }
    let surface = TerrainSurface::new(numbers, data, meta.geo.clone(), meta.bound_radius_m.clone());
    let title = if meta.title.is_empty() { title } else { meta.title.clone() };
    Ok(Terrain::from_store(surface, store, [width, height], meta.height_range_m, title))
}
