//! Reading a terrain's `.yama` file: pages on demand, from any thread, through a cache of bounded size.

use super::cache::PageCache;
use super::database::{WholeFile, lock};
use super::meta::TerrainMeta;
use super::page::PageCodec;
use super::rows::{page_id, row_id};
use super::schema::{Content, TERRAIN_TABLES, read_meta};
use crate::IoError;
use rusqlite::{Connection, OptionalExtension, params};
use std::path::Path;
use std::sync::{Arc, Mutex};
use yamanami_core::{Aabb, Lattice, PAGE_CELLS, PageId, TerrainPage};

/// Decoded pages are kept up to this many bytes unless told otherwise.
const USUAL_CACHE_BYTES: usize = 32 << 20;
/// No page takes more: even heights of random bits take less than a tenth.
const MAX_PAGE_BYTES: usize = 4 << 20;
/// No row of the file is longer.
const MAX_ROW_BYTES: i32 = 8 << 20;

/// An open terrain database.
#[derive(Debug)]
pub struct TerrainStore {
    file: WholeFile,
    cache: Mutex<PageCache>,
    meta: TerrainMeta,
    codec: PageCodec,
}

impl TerrainStore {
    /// Opens a file and checks that it is whole and of a version that is understood.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, IoError> {
        let path = path.as_ref();
        let file = WholeFile::open(path, Content::Terrain, &TERRAIN_TABLES, MAX_ROW_BYTES)?;
        let (mut meta, radii) = file
            .with("database", read_facts)?
            .map_err(|found| IoError::malformed(path, "facts", "a terrain surface", found))?;
        meta.bound_radius_m = radii;
        let check = |found: String| IoError::malformed(path, "table `meta`", "a surface that can be", found);
        meta.check().map_err(check)?;
        let codec =
            PageCodec::new(meta.size, meta.quantum, meta.has_holes, meta.error_steps_per_octave, meta.level0_slack_m)
                .map_err(|e| check(e.to_string()))?;
        let cache = Mutex::new(PageCache::new(USUAL_CACHE_BYTES));
        Ok(Self { file, cache, meta, codec })
    }

    /// Keeps decoded pages up to this many bytes (at least one page of every level stays).
    pub fn set_cache_bytes(&self, bytes: usize) {
        lock(&self.cache).set_limit(bytes);
    }

    /// Bytes of decoded pages kept now.
    pub fn cached_bytes(&self) -> usize {
        lock(&self.cache).bytes()
    }

    /// The file.
    pub fn path(&self) -> &Path {
        self.file.path()
    }

    /// What the file says of itself.
    pub fn meta(&self) -> &TerrainMeta {
        &self.meta
    }

    /// The lattice of the grid.
    pub fn lattice(&self) -> &Lattice {
        self.codec.lattice()
    }

    /// How pages are coded.
    pub fn codec(&self) -> &PageCodec {
        &self.codec
    }

    /// Pages (columns, rows) of a level from 0 to `lattice().levels()`.
    pub fn pages_at(&self, level: u32) -> [u32; 2] {
        self.codec.pages(level)
    }

    /// Box of a page's points in the local metric frame (its descendants may reach a little beyond in z).
    pub fn page_bounds(&self, id: PageId) -> Result<Aabb, IoError> {
        self.check_place(id)?;
        let sql = "SELECT x_min_m, y_min_m, z_min_m, x_max_m, y_max_m, z_max_m FROM page_bounds WHERE id = ?1";
        let row = self.file.with("table `page_bounds`", |db| {
            db.prepare_cached(sql)?
                .query_row([row_id(id)], |row| {
                    let at = |i: usize| row.get::<_, f64>(i);
                    Ok([at(0)?, at(1)?, at(2)?, at(3)?, at(4)?, at(5)?])
                })
                .optional()
        })?;
        let b = row.ok_or_else(|| self.damaged(id, "there are no bounds"))?;
        Ok(Aabb { min: [b[0], b[1], b[2]].into(), max: [b[3], b[4], b[5]].into() })
    }

    /// Pages of a level whose boxes meet a rectangle of the local metric frame, in row order.
    pub fn pages_in(&self, level: u32, min_m: [f64; 2], max_m: [f64; 2]) -> Result<Vec<PageId>, IoError> {
        let sql = "SELECT id FROM page_bounds WHERE x_max_m >= ?1 AND x_min_m <= ?2 AND y_max_m >= ?3 AND y_min_m <= ?4
                   AND id BETWEEN ?5 AND ?6 ORDER BY id";
        let level = level.min(self.lattice().levels());
        let first = row_id(PageId { level, x: 0, y: 0 });
        let last = first + (1 << 48) - 1;
        let ids = self.file.with("table `page_bounds`", |db| {
            let mut select = db.prepare_cached(sql)?;
            let rows =
                select.query_map(params![min_m[0], max_m[0], min_m[1], max_m[1], first, last], |row| row.get(0))?;
            rows.collect::<rusqlite::Result<Vec<i64>>>()
        })?;
        Ok(ids.into_iter().filter_map(page_id).filter(|&id| self.codec.page_points(id).is_some()).collect())
    }

    /// A page, from the cache or the file. Its coarser ones are read on the way and kept as well.
    pub fn page(&self, id: PageId) -> Result<Arc<TerrainPage>, IoError> {
        self.check_place(id)?;
        // from the finest that is at hand to the one asked for
        let mut missing = Vec::new();
        let mut at_hand = None;
        let mut next = Some(id);
        while let Some(id) = next {
            at_hand = lock(&self.cache).get(id);
            if at_hand.is_some() {
                break;
            }
            missing.push(id);
            next = self.codec.parent(id);
        }
        while let Some(id) = missing.pop() {
            let page = self.read_page(id, at_hand.as_deref())?;
            let page = Arc::new(page);
            lock(&self.cache).insert(page.clone());
            at_hand = Some(page);
        }
        at_hand.ok_or_else(|| self.damaged(id, "it is not there"))
    }

    /// Heights in metres of a block of a level's lattice points, row by row, `width` × `height` from (x0, y0) on.
    pub fn read_height_block(
        &self,
        level: u32,
        x0: u32,
        y0: u32,
        width: u32,
        height: u32,
    ) -> Result<Vec<f32>, IoError> {
        let [nx, ny] = self.lattice().points(level.min(self.lattice().levels()));
        let inside = |first: u32, count: u32, points: u32| u64::from(first) + u64::from(count) <= u64::from(points);
        if level > self.lattice().levels() || !inside(x0, width, nx) || !inside(y0, height, ny) {
            return Err(IoError::BadRequest {
                what: format!("block of heights of level {level}"),
                expected: format!("points within {nx}x{ny} of levels 0 to {}", self.lattice().levels()),
                given: format!("{width}x{height} from {x0}, {y0}"),
            });
        }
        let mut out = vec![0.0; width as usize * height as usize];
        if out.is_empty() {
            return Ok(out);
        }
        // the last point of a level belongs to the last page
        let [pages_x, pages_y] = self.pages_at(level);
        let tile = |point: u32, pages: u32| (point / PAGE_CELLS).min(pages - 1);
        for py in tile(y0, pages_y)..=tile(y0 + height - 1, pages_y) {
            for px in tile(x0, pages_x)..=tile(x0 + width - 1, pages_x) {
                let page = self.page(PageId { level, x: px, y: py })?;
                let [left, top] = [px * PAGE_CELLS, py * PAGE_CELLS];
                let columns = x0.max(left)..(x0 + width).min(left + page.width);
                for y in y0.max(top)..(y0 + height).min(top + page.height) {
                    let from = ((y - top) * page.width + columns.start - left) as usize;
                    let to = (y - y0) as usize * width as usize + (columns.start - x0) as usize;
                    let count = columns.len();
                    out[to..to + count].copy_from_slice(&page.heights_m[from..from + count]);
                }
            }
        }
        Ok(out)
    }

    /// Reads everything once: every page, every checksum, every border shared by two pages.
    pub fn verify(&self) -> Result<(), IoError> {
        self.file.check_structure()?;
        for level in (0..=self.lattice().levels()).rev() {
            let [nx, ny] = self.pages_at(level);
            for y in 0..ny {
                for x in 0..nx {
                    let id = PageId { level, x, y };
                    let page = self.page(id)?;
                    self.page_bounds(id)?;
                    if x > 0 {
                        self.verify_border(&*self.page(PageId { x: x - 1, ..id })?, &page, [1, 0])?;
                    }
                    if y > 0 {
                        self.verify_border(&*self.page(PageId { y: y - 1, ..id })?, &page, [0, 1])?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Whether two neighbours have the same points where they meet.
    fn verify_border(&self, before: &TerrainPage, page: &TerrainPage, [dx, dy]: [u32; 2]) -> Result<(), IoError> {
        let count = if dx == 1 { page.height } else { page.width };
        for i in 0..count {
            let (a, b) = if dx == 1 {
                (i * before.width + before.width - 1, i * page.width)
            } else {
                ((before.height - 1) * before.width + i, i)
            };
            let (a, b) = (a as usize, b as usize);
            if before.heights_m[a] != page.heights_m[b] || before.errors[a] != page.errors[b] {
                return Err(
                    self.damaged(page.id, &format!("its border differs from that of page {dx}, {dy} before it"))
                );
            }
        }
        Ok(())
    }

    fn read_page(&self, id: PageId, parent: Option<&TerrainPage>) -> Result<TerrainPage, IoError> {
        let bytes = self.file.page_bytes(row_id(id), MAX_PAGE_BYTES)?.map_err(|found| self.damaged(id, found))?;
        self.codec.decode_page(id, &bytes, parent).map_err(|found| self.damaged(id, found))
    }

    fn check_place(&self, id: PageId) -> Result<(), IoError> {
        if self.codec.page_points(id).is_some() {
            return Ok(());
        }
        let [nx, ny] = self.pages_at(id.level);
        Err(IoError::BadRequest {
            what: format!("page {}, {} of level {}", id.x, id.y, id.level),
            expected: format!("one of {nx}x{ny} on levels 0 to {}", self.lattice().levels()),
            given: "none such".into(),
        })
    }

    fn damaged(&self, id: PageId, found: &str) -> IoError {
        let place = format!("page {}, {} of level {}", id.x, id.y, id.level);
        IoError::malformed(self.file.path(), place, "a whole page", found)
    }
}

type FactsAndRadii = (TerrainMeta, Vec<f64>);

fn read_facts(db: &Connection) -> rusqlite::Result<Result<FactsAndRadii, String>> {
    let meta = match read_meta(db)?.and_then(|facts| facts.terrain()) {
        Ok(meta) => meta,
        Err(found) => return Ok(Err(found)),
    };
    Ok(Ok((meta, read_bound_radii(db)?)))
}

/// By level, metres.
pub(super) fn read_bound_radii(db: &Connection) -> rusqlite::Result<Vec<f64>> {
    let mut select =
        db.prepare("SELECT bound_radius_m FROM level WHERE bound_radius_m IS NOT NULL ORDER BY level LIMIT 64")?;
    select.query_map([], |row| row.get(0))?.collect()
}
