//! Writing a `.yama` file: all or nothing.
//!
//! Everything goes to a file beside the target, named `<target>.part`, which takes the target's place at the end. A build
//! that is killed leaves the old file as it was; one that fails also removes its part.

use super::meta::TerrainMeta;
use super::page::{EncodedPage, PageCodec};
use super::schema::{
    APPLICATION_ID, CHUNK_BYTES, FORMAT_VERSION, TABLES, db_page_bytes, page_crc32, row_id, write_meta,
};
use crate::IoError;
use rusqlite::{Connection, params};
use std::path::{Path, PathBuf};
use yamanami_core::{PAGE_CELLS, PageId, TerrainPage};

/// A `.yama` file in the making.
#[derive(Debug)]
pub struct TerrainWriter {
    target: PathBuf,
    part: PathBuf,
    /// `None` once closed.
    db: Option<Connection>,
    meta: TerrainMeta,
    codec: PageCodec,
    written: Vec<u64>,
    /// The chunk being filled, and its number.
    chunk: Vec<u8>,
    chunk_id: i64,
}

impl TerrainWriter {
    /// Begins a file; nothing at `path` changes before [`Self::finish`].
    pub fn create(path: impl AsRef<Path>, meta: TerrainMeta) -> Result<Self, IoError> {
        let target = path.as_ref().to_owned();
        meta.check().map_err(|given| IoError::BadRequest {
            what: format!("facts of {}", target.display()),
            expected: "a surface that can be".into(),
            given,
        })?;
        let codec =
            PageCodec::new(meta.size, meta.quantum, meta.has_holes, meta.error_steps_per_octave, meta.level0_slack_m)?;
        let mut part = target.clone().into_os_string();
        part.push(".part");
        let part = PathBuf::from(part);
        match std::fs::remove_file(&part) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => return Err(IoError::io(&part, e)),
            _ => {}
        }
        // made here, so that a missing folder or permission is told in the system's words
        std::fs::File::create_new(&part).map_err(|e| IoError::io(&part, e))?;
        let levels = codec.lattice().levels() as usize;
        let mut writer =
            Self { target, part, db: None, meta, codec, written: vec![0; levels + 1], chunk: Vec::new(), chunk_id: 0 };
        let db = Connection::open(&writer.part).map_err(|e| writer.failed(e))?;
        let db = writer.db.insert(db);
        let begun = begin(db, &writer.meta);
        begun.map_err(|e| writer.failed(e))?;
        Ok(writer)
    }

    /// Codes pages: copy it to as many threads as there are.
    pub fn codec(&self) -> &PageCodec {
        &self.codec
    }

    /// Codes and stores a page.
    pub fn write_page(&mut self, page: &TerrainPage) -> Result<(), IoError> {
        let encoded = self.codec.encode_page(page)?;
        self.insert(&encoded)
    }

    /// Stores a coded page. Order does not matter; from the coarsest level to the finest, row by row, is fastest.
    pub fn insert(&mut self, page: &EncodedPage) -> Result<(), IoError> {
        let bounds = page_bounds_m(&self.meta, &self.codec, page.id, page.z_range_m);
        let Some(db) = &self.db else { return Err(closed(&self.part)) };
        if !self.chunk.is_empty() && self.chunk.len() + page.bytes.len() > CHUNK_BYTES {
            insert_chunk(db, self.chunk_id, &self.chunk).map_err(|e| self.failed(e))?;
            self.chunk.clear();
            self.chunk_id += 1;
        }
        insert_page(db, page, [self.chunk_id, self.chunk.len() as i64], bounds).map_err(|e| self.failed(e))?;
        self.chunk.extend_from_slice(&page.bytes);
        self.written[page.id.level as usize] += 1;
        Ok(())
    }

    /// Checks that every page is there, closes the file and puts it in its place.
    pub fn finish(mut self) -> Result<(), IoError> {
        for (level, &written) in self.written.iter().enumerate() {
            let [nx, ny] = self.codec.pages(level as u32);
            let expected = u64::from(nx) * u64::from(ny);
            if written != expected {
                return Err(IoError::BadRequest {
                    what: format!("pages of level {level} of {}", self.target.display()),
                    expected: expected.to_string(),
                    given: written.to_string(),
                });
            }
        }
        let Some(db) = self.db.take() else { return Err(closed(&self.part)) };
        insert_chunk(&db, self.chunk_id, &self.chunk).map_err(|e| self.failed(e))?;
        complete(&db, &self.meta, &self.codec).map_err(|e| self.failed(e))?;
        db.close().map_err(|(_, e)| self.failed(e))?;
        let file = std::fs::File::open(&self.part).map_err(|e| IoError::io(&self.part, e))?;
        file.sync_all().map_err(|e| IoError::io(&self.part, e))?;
        std::fs::rename(&self.part, &self.target).map_err(|e| IoError::io(&self.target, e))?;
        // the folder's entry too; not every system can
        if let Some(Ok(folder)) = self.target.parent().map(std::fs::File::open) {
            let _ = folder.sync_all();
        }
        Ok(())
    }

    /// What the database says, as this crate's error.
    fn failed(&self, error: rusqlite::Error) -> IoError {
        write_error(&self.part, error)
    }
}

impl Drop for TerrainWriter {
    fn drop(&mut self) {
        // after `finish` the part has become the target and there is nothing to remove
        drop(self.db.take());
        let _ = std::fs::remove_file(&self.part);
    }
}

fn closed(part: &Path) -> IoError {
    IoError::io(part, std::io::Error::other("already closed"))
}

fn write_error(part: &Path, error: rusqlite::Error) -> IoError {
    use rusqlite::ErrorCode;
    let kind = match error.sqlite_error_code() {
        Some(ErrorCode::DiskFull) => std::io::ErrorKind::StorageFull,
        Some(ErrorCode::PermissionDenied | ErrorCode::ReadOnly) => std::io::ErrorKind::PermissionDenied,
        _ => std::io::ErrorKind::Other,
    };
    let message = match kind {
        std::io::ErrorKind::StorageFull => "the disk is full".to_owned(),
        _ => format!("could not be written ({error})"),
    };
    IoError::io(part, std::io::Error::new(kind, message))
}

fn begin(db: &Connection, meta: &TerrainMeta) -> rusqlite::Result<()> {
    // a part that breaks off is thrown away: it needs no journal
    db.execute_batch(&format!(
        "PRAGMA page_size = {}; PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF;
         PRAGMA locking_mode = EXCLUSIVE; PRAGMA cache_size = -4096; PRAGMA application_id = {APPLICATION_ID}; BEGIN",
        db_page_bytes(meta.size)
    ))?;
    for (_, statement) in TABLES {
        db.execute_batch(statement)?;
    }
    write_meta(db, meta)
}

fn insert_chunk(db: &Connection, id: i64, bytes: &[u8]) -> rusqlite::Result<()> {
    db.prepare_cached("INSERT INTO chunk(id, data) VALUES(?1, ?2)")?.execute(params![id, bytes]).map(|_| ())
}

fn insert_page(
    db: &Connection,
    page: &EncodedPage,
    [chunk, start]: [i64; 2],
    bounds: [[f64; 2]; 3],
) -> rusqlite::Result<()> {
    let row = row_id(page.id);
    let mut into_page =
        db.prepare_cached("INSERT INTO page(id, chunk, start, length, crc32) VALUES(?1, ?2, ?3, ?4, ?5)")?;
    into_page.execute(params![row, chunk, start, page.bytes.len() as i64, page_crc32(page.id, &page.bytes)])?;
    let mut into_bounds = db.prepare_cached("INSERT INTO page_bounds VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7)")?;
    let [x, y, z] = bounds;
    into_bounds.execute(params![row, x[0], x[1], y[0], y[1], z[0], z[1]])?;
    Ok(())
}

fn complete(db: &Connection, meta: &TerrainMeta, codec: &PageCodec) -> rusqlite::Result<()> {
    let mut insert = db.prepare("INSERT INTO level(level, pages, bound_radius_m) VALUES(?1, ?2, ?3)")?;
    for level in 0..=codec.lattice().levels() {
        let [nx, ny] = codec.pages(level);
        insert.execute(params![level, i64::from(nx) * i64::from(ny), meta.bound_radius_m.get(level as usize)])?;
    }
    drop(insert);
    db.flush_prepared_statement_cache();
    db.execute_batch(&format!("PRAGMA user_version = {FORMAT_VERSION}; COMMIT"))
}

/// Box of a page's points in the local metric frame: least and greatest x, y, z.
pub(super) fn page_bounds_m(meta: &TerrainMeta, codec: &PageCodec, id: PageId, z_range_m: [f32; 2]) -> [[f64; 2]; 3] {
    let [columns, rows] = codec.page_points(id).unwrap_or([1, 1]);
    let [x0, y0] = [id.x, id.y].map(|tile| tile * PAGE_CELLS);
    let first = codec.lattice().sample(id.level, x0, y0);
    let last = codec.lattice().sample(id.level, x0 + columns - 1, y0 + rows - 1);
    let [west, north] = meta.geo.local_from_grid(first[0].into(), first[1].into());
    let [east, south] = meta.geo.local_from_grid(last[0].into(), last[1].into());
    [[west, east], [south, north], z_range_m.map(f64::from)]
}
