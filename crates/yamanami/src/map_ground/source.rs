//! Where a map's heights come from: mosaics of elevation files, and terrain databases, by windows.

use super::MapSource;
use super::interpolate::Samples;
use super::layer::part_at;
use crate::Error;
use glam::DVec2;
#[cfg(feature = "files")]
use rayon::prelude::*;
#[cfg(feature = "files")]
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
#[cfg(feature = "files")]
use yamanami_core::HeightSource;
use yamanami_core::{GeoReference, Lattice, PAGE_CELLS, PageId, TerrainPage, Window};
use yamanami_io::crs;
#[cfg(feature = "files")]
use yamanami_io::dem::{self, DemFile};
use yamanami_io::store::TerrainMeta;
#[cfg(feature = "files")]
use yamanami_io::store::TerrainStore;

/// Decoded pages of a database kept in memory, bytes: those of one window and their coarser ones.
#[cfg(feature = "files")]
const CACHE_BYTES: usize = 192 << 20;

/// A page of a terrain, when it is at hand.
pub type PageAtHand = Arc<dyn Fn(PageId) -> Option<Arc<TerrainPage>> + Send + Sync>;

enum Reader {
    #[cfg(feature = "files")]
    Files(DemFile),
    #[cfg(feature = "files")]
    Database(TerrainStore),
    Pages {
        title: PathBuf,
        lattice: Lattice,
        page: PageAtHand,
    },
}

/// One source of heights.
pub(super) struct Source {
    reader: Reader,
    pub(super) geo: GeoReference,
    /// Columns and rows.
    pub(super) size: [usize; 2],
    /// Rectangles that hold data.
    pub(super) parts: Vec<Window>,
}

impl Source {
    /// A terrain of which only some pages are in memory.
    pub(super) fn of_pages(meta: &TerrainMeta, page: PageAtHand) -> Self {
        let size = meta.size.map(|n| n as usize);
        let parts = vec![Window { column: 0, row: 0, width: size[0], height: size[1] }];
        let reader = Reader::Pages { title: PathBuf::from(&meta.title), lattice: Lattice::new(size[0], size[1]), page };
        Self { reader, geo: meta.geo.clone(), size, parts }
    }

    /// Opens files, folders and databases, those of one lattice together, the finest first.
    #[cfg(feature = "files")]
    pub(super) fn open(paths: &[PathBuf], options: &dem::OpenOptions) -> Result<Vec<Self>, Error> {
        let is_database = |path: &&PathBuf| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("yama"));
        let (databases, files): (Vec<&PathBuf>, Vec<&PathBuf>) = paths.iter().partition(is_database);
        let mut sources = Vec::new();
        for path in databases {
            let store = TerrainStore::open(path)?;
            store.set_cache_bytes(CACHE_BYTES);
            let (geo, size) = (store.meta().geo.clone(), store.meta().size.map(|n| n as usize));
            let parts = vec![Window { column: 0, row: 0, width: size[0], height: size[1] }];
            sources.push(Self { reader: Reader::Database(store), geo, size, parts });
        }
        let files: Vec<PathBuf> = files.into_iter().cloned().collect();
        for dem in if files.is_empty() { Vec::new() } else { dem::open_mosaics(&files, options)? } {
            let (geo, size) = (dem.info().geo.clone(), dem.info().size);
            let parts = dem.parts().collect();
            sources.push(Self { reader: Reader::Files(dem), geo, size, parts });
        }
        for source in &sources {
            if !crs::is_known(&source.geo.crs) {
                let (name, crs) = (source.label().display(), &source.geo.crs.name);
                let crs = if crs.is_empty() { "none is stated" } else { crs };
                return Err(Error::Request(format!(
                    "{name}: a map needs a coordinate reference system that is known by formula, but {crs}; state one"
                )));
            }
        }
        // equal spacings keep the order in which they were given; a hair of difference is none
        sources.sort_by_key(|source| (source.spacing_m().log2() * 8.0).round() as i64);
        Ok(sources)
    }

    pub(super) fn label(&self) -> &Path {
        match &self.reader {
            #[cfg(feature = "files")]
            Reader::Files(dem) => dem.label(),
            #[cfg(feature = "files")]
            Reader::Database(store) => store.path(),
            Reader::Pages { title, .. } => title,
        }
    }

    /// Metres between samples on the ground, the mean of both ways.
    pub(super) fn spacing_m(&self) -> f64 {
        let [x, y] = self.geo.step_m;
        (x * y).sqrt()
    }

    /// What is told of a source of which a share of the map came.
    pub(super) fn report(&self, share: f64) -> MapSource {
        let files = match &self.reader {
            #[cfg(feature = "files")]
            Reader::Files(dem) => dem.info().files,
            _ => 1,
        };
        let (path, crs) = (self.label().to_owned(), self.geo.crs.name.clone());
        MapSource { path, files, spacing_m: self.spacing_m(), crs, share }
    }

    /// Whether a place lies in a file, with data or without.
    pub(super) fn holds(&self, lon: f64, lat: f64) -> bool {
        [-360.0, 0.0, 360.0].into_iter().any(|turn| {
            let at = grid_from_lon_lat(&self.geo, lon + turn, lat);
            part_at(&self.parts, at, &mut 0)
        })
    }

    /// The file and where it lies.
    pub(super) fn extent_in_words(&self) -> String {
        let [[west, south], [east, north]] = self.extent_deg();
        let name = self.label().display();
        format!("{name} covers latitudes {south:.4} to {north:.4}, longitudes {west:.4} to {east:.4}")
    }

    /// Whether longitudes beyond ±180° may be its other end.
    pub(super) fn goes_round(&self) -> bool {
        crs::way_round(&self.geo.crs).is_some()
    }

    /// Lowest and highest longitude and latitude, degrees.
    fn extent_deg(&self) -> [[f64; 2]; 2] {
        let mut extent = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        let [columns, rows] = self.size.map(|n| (n - 1) as f64);
        for k in 0..=8 {
            let t = f64::from(k) / 8.0;
            for (c, r) in [(t * columns, 0.0), (t * columns, rows), (0.0, t * rows), (columns, t * rows)] {
                let [x, y] = self.geo.source_from_grid(c, r);
                if let Some(lon_lat) = crs::to_lon_lat(&self.geo.crs, x, y) {
                    for axis in 0..2 {
                        extent[0][axis] = extent[0][axis].min(lon_lat[axis]);
                        extent[1][axis] = extent[1][axis].max(lon_lat[axis]);
                    }
                }
            }
        }
        extent
    }

    /// The coarsest level whose samples are no wider apart than a grid's; files have but one.
    pub(super) fn level_for(&self, spacing_m: f64) -> u32 {
        let wider = (spacing_m * 1.001 / self.spacing_m()).max(1.0);
        (wider.log2() as u32).min(self.lattice().map_or(0, Lattice::levels))
    }

    /// Columns and rows of a level.
    pub(super) fn points(&self, level: u32) -> [usize; 2] {
        self.lattice().map_or(self.size, |lattice| lattice.points(level).map(|n| n as usize))
    }

    /// The levels, of a source that has them.
    fn lattice(&self) -> Option<&Lattice> {
        match &self.reader {
            #[cfg(feature = "files")]
            Reader::Files(_) => None,
            #[cfg(feature = "files")]
            Reader::Database(store) => Some(store.lattice()),
            Reader::Pages { lattice, .. } => Some(lattice),
        }
    }

    /// Reads a window of a level.
    pub(super) fn read(&mut self, level: u32, window: Window) -> Result<Samples, Error> {
        let (width, height) = (window.width, window.height);
        let heights_m = match &mut self.reader {
            #[cfg(feature = "files")]
            Reader::Files(dem) => {
                let mut heights_m = vec![f32::NAN; width * height];
                dem.read_window(window, &mut heights_m)?;
                heights_m
            }
            #[cfg(feature = "files")]
            Reader::Database(store) => read_pages(store, level, window)?,
            Reader::Pages { lattice, page, .. } => {
                let mut heights_m = vec![f32::NAN; width * height];
                for id in pages_of(lattice, level, window) {
                    if let Some(page) = page(id) {
                        copy_page(&page, window, &mut heights_m);
                    }
                }
                heights_m
            }
        };
        Ok(Samples { heights_m, width, height, spline: None })
    }
}

/// Fractional column and row of a longitude and latitude; NaN where the CRS has no place for it.
pub(super) fn grid_from_lon_lat(geo: &GeoReference, lon: f64, lat: f64) -> DVec2 {
    match crs::from_lon_lat(&geo.crs, lon, lat) {
        Some([x, y]) => geo.grid_from_source(x, y).into(),
        None => DVec2::NAN,
    }
}

/// The pages that hold a window of a level.
fn pages_of(lattice: &Lattice, level: u32, window: Window) -> Vec<PageId> {
    let pages = lattice.squares(level).map(|n| n.div_ceil(PAGE_CELLS));
    let tiles = |first: usize, count: usize, pages: u32| {
        let tile = |point: usize| (point as u32 / PAGE_CELLS).min(pages - 1);
        tile(first)..=tile(first + count - 1)
    };
    let columns = tiles(window.column, window.width, pages[0]);
    tiles(window.row, window.height, pages[1])
        .flat_map(|y| columns.clone().map(move |x| PageId { level, x, y }))
        .collect()
}

/// Heights of a window of a level, several pages at once; NaN where no triangle is shown.
#[cfg(feature = "files")]
fn read_pages(store: &TerrainStore, level: u32, window: Window) -> Result<Vec<f32>, Error> {
    let ids = pages_of(store.lattice(), level, window);
    // coarser pages first, each once: finer ones are told as differences from them
    let mut coarser: Vec<BTreeSet<PageId>> = Vec::new();
    let mut last: BTreeSet<PageId> = ids.iter().copied().collect();
    while !last.is_empty() {
        let parents: BTreeSet<PageId> = last.iter().filter_map(|&id| store.codec().parent(id)).collect();
        last = parents.clone();
        coarser.push(parents);
    }
    for parents in coarser.into_iter().rev() {
        parents.into_par_iter().try_for_each(|id| store.page(id).map(drop))?;
    }
    let pages: Vec<Arc<TerrainPage>> = ids.into_par_iter().map(|id| store.page(id)).collect::<Result<_, _>>()?;
    let mut out = vec![f32::NAN; window.width * window.height];
    for page in &pages {
        copy_page(page, window, &mut out);
    }
    Ok(out)
}

fn copy_page(page: &TerrainPage, window: Window, out: &mut [f32]) {
    let (width, height) = (page.width as usize, page.height as usize);
    let [left, top] = [page.id.x, page.id.y].map(|n| (n * PAGE_CELLS) as usize);
    let first = window.column.max(left);
    let end = (window.column + window.width).min(left + width);
    for y in window.row.max(top)..(window.row + window.height).min(top + height) {
        let from = &page.heights_m[(y - top) * width + first - left..][..end - first];
        let to = &mut out[(y - window.row) * window.width + first - window.column..][..end - first];
        if page.shown.is_empty() {
            to.copy_from_slice(from);
            continue;
        }
        for (x, (to, &z)) in (first - left..).zip(to.iter_mut().zip(from)) {
            if touches(page, x, y - top) {
                *to = z;
            }
        }
    }
}

/// Whether a point of a page is a corner of a shown triangle (a square's halves are north-east and south-west).
fn touches(page: &TerrainPage, x: usize, y: usize) -> bool {
    let (columns, rows) = (page.width as usize - 1, page.height as usize - 1);
    let halves = |x: Option<usize>, y: Option<usize>| match (x, y) {
        (Some(x), Some(y)) if x < columns && y < rows => page.shown[y * columns + x],
        _ => 0,
    };
    let (west, north) = (x.checked_sub(1), y.checked_sub(1));
    halves(Some(x), Some(y)) | halves(west, north) != 0
        || halves(west, Some(y)) & 1 != 0
        || halves(Some(x), north) & 2 != 0
}
