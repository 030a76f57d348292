//! Writing a terrain's `.yama` file.

use super::database::PartFile;
use super::meta::TerrainMeta;
use super::page::{EncodedPage, PageCodec};
use super::rows::row_id;
use super::schema::{Content, TERRAIN_TABLES, db_page_bytes, write_meta};
use crate::IoError;
use rusqlite::{Connection, params};
use std::path::Path;
use yamanami_core::{PAGE_CELLS, PageId, TerrainPage};

/// A terrain's `.yama` file in the making.
#[derive(Debug)]
pub struct TerrainWriter {
    file: PartFile,
    meta: TerrainMeta,
    codec: PageCodec,
    written: Vec<u64>,
}

impl TerrainWriter {
    /// Begins a file; nothing at `path` changes before [`Self::finish`].
    pub fn create(path: impl AsRef<Path>, meta: TerrainMeta) -> Result<Self, IoError> {
        let path = path.as_ref();
        meta.check().map_err(|given| IoError::BadRequest {
            what: format!("facts of {}", path.display()),
            expected: "a surface that can be".into(),
            given,
        })?;
        let codec =
            PageCodec::new(meta.size, meta.quantum, meta.has_holes, meta.error_steps_per_octave, meta.level0_slack_m)?;
        let file = PartFile::create(path, db_page_bytes(meta.size), &TERRAIN_TABLES)?;
        file.with(|db| write_meta(db, &meta))?;
        let levels = codec.lattice().levels() as usize;
        Ok(Self { file, meta, codec, written: vec![0; levels + 1] })
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
        let row = row_id(page.id);
        let [x, y, z] = page_bounds_m(&self.meta, &self.codec, page.id, page.z_range_m);
        self.file.insert_page(row, &page.bytes)?;
        self.file.with(|db| {
            let mut into_bounds = db.prepare_cached("INSERT INTO page_bounds VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7)")?;
            into_bounds.execute(params![row, x[0], x[1], y[0], y[1], z[0], z[1]])
        })?;
        self.written[page.id.level as usize] += 1;
        Ok(())
    }

    /// Checks that every page is there, closes the file and puts it in its place.
    pub fn finish(self) -> Result<(), IoError> {
        for (level, &written) in self.written.iter().enumerate() {
            let [nx, ny] = self.codec.pages(level as u32);
            let expected = u64::from(nx) * u64::from(ny);
            if written != expected {
                return Err(IoError::BadRequest {
                    what: format!("pages of level {level} of {}", self.file.target().display()),
                    expected: expected.to_string(),
                    given: written.to_string(),
                });
            }
        }
        let Self { file, meta, codec, .. } = self;
        file.finish(Content::Terrain, |db| write_levels(db, &meta, &codec))
    }
}

fn write_levels(db: &Connection, meta: &TerrainMeta, codec: &PageCodec) -> rusqlite::Result<()> {
    let mut insert = db.prepare("INSERT INTO level(level, pages, bound_radius_m) VALUES(?1, ?2, ?3)")?;
    for level in 0..=codec.lattice().levels() {
        let [nx, ny] = codec.pages(level);
        insert.execute(params![level, i64::from(nx) * i64::from(ny), meta.bound_radius_m.get(level as usize)])?;
    }
    Ok(())
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
