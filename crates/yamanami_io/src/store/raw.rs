//! The rows of a `.yama` as they are, for who copies them: numbers, lengths, checksums, bytes.

use super::database::{WholeFile, content_of};
use super::facts::Facts;
use super::reader::read_bound_radii;
use super::rows::row_crc32;
use super::schema::{CLUSTER_TABLES, Content, TERRAIN_TABLES, read_meta};
use crate::IoError;
use rusqlite::{OptionalExtension, Row, params};
use std::path::Path;

/// No row is longer.
const MAX_ROW_BYTES: i32 = 1 << 30;

/// A row of bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct RawRow {
    pub(crate) row: i64,
    pub(crate) length: u32,
    pub(crate) crc32: u32,
}

/// An open `.yama` of any kind.
#[derive(Debug)]
pub(crate) struct RawStore {
    file: WholeFile,
    content: Content,
}

impl RawStore {
    /// Opens a file and checks that it is whole and of a version that is understood.
    pub(crate) fn open(path: &Path) -> Result<Self, IoError> {
        let content = content_of(path)?;
        let tables: &[_] = if content == Content::Terrain { &TERRAIN_TABLES } else { &CLUSTER_TABLES };
        Ok(Self { file: WholeFile::open(path, content, tables, MAX_ROW_BYTES)?, content })
    }

    pub(crate) fn path(&self) -> &Path {
        self.file.path()
    }

    pub(crate) fn content(&self) -> Content {
        self.content
    }

    /// The table `meta`.
    pub(crate) fn facts(&self) -> Result<Facts, IoError> {
        self.file
            .with("table `meta`", read_meta)?
            .map_err(|found| IoError::malformed(self.path(), "table `meta`", "facts of a surface", found))
    }

    /// A terrain's bound radii by level, metres.
    pub(crate) fn bound_radius_m(&self) -> Result<Vec<f64>, IoError> {
        self.file.with("table `level`", read_bound_radii)
    }

    /// All pages, ascending.
    pub(crate) fn pages(&self) -> Result<Vec<RawRow>, IoError> {
        self.rows("table `page`", "SELECT id, length, crc32 FROM page ORDER BY id")
    }

    /// All blocks of nodes, ascending.
    pub(crate) fn node_blocks(&self) -> Result<Vec<RawRow>, IoError> {
        self.rows("table `node_block`", "SELECT id, length(data), crc32 FROM node_block ORDER BY id")
    }

    fn rows(&self, place: &str, sql: &str) -> Result<Vec<RawRow>, IoError> {
        let read = |row: &Row<'_>| Ok(RawRow { row: row.get(0)?, length: row.get(1)?, crc32: row.get(2)? });
        self.file.with(place, |db| db.prepare(sql)?.query_map([], read)?.collect())
    }

    /// A page's bytes, checked.
    pub(crate) fn page(&self, row: i64) -> Result<Vec<u8>, IoError> {
        let bytes = self.file.page_bytes(row, MAX_ROW_BYTES as usize)?;
        bytes.map_err(|found| IoError::malformed(self.path(), format!("page row {row}"), "a whole page", found))
    }

    /// The bytes of a block of nodes, checked.
    pub(crate) fn node_block(&self, row: i64) -> Result<Vec<u8>, IoError> {
        node_block(&self.file, row)?.ok_or_else(|| {
            IoError::malformed(self.path(), format!("nodes from {row} on"), "whole nodes", "damaged ones")
        })
    }
}

/// The bytes of a block of nodes; `None` when it is not there or damaged.
pub(super) fn node_block(file: &WholeFile, row: i64) -> Result<Option<Vec<u8>>, IoError> {
    let sql = "SELECT crc32, data FROM node_block WHERE id = ?1";
    let found: Option<(i64, Vec<u8>)> = file.with("table `node_block`", |db| {
        db.prepare_cached(sql)?.query_row(params![row], |row| Ok((row.get(0)?, row.get(1)?))).optional()
    })?;
    Ok(found.filter(|(crc32, bytes)| i64::from(row_crc32(row, bytes)) == *crc32).map(|(_, bytes)| bytes))
}
