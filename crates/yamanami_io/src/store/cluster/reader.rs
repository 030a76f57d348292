//! Reading a model's `.yama` file: nodes at once, pages on demand from any thread.

use super::annex::TinAnnex;
use super::codec::ClusterCodec;
use super::meta::ClusterMeta;
use super::table::{ANNEX_ROW, BASE_ROW, ClusterTable, group_row};
use crate::IoError;
use crate::store::database::{WholeFile, content_of};
use crate::store::raw::node_block;
use crate::store::schema::{CLUSTER_TABLES, Content, read_meta};
use std::path::Path;
use yamanami_core::{BASE_CLUSTERS, ClusterNode, ClusterPage, GroupId};

/// A row of the base mesh's page is the longest.
const MAX_ROW_BYTES: i32 = 1 << 30;

/// An open database of a model.
#[derive(Debug)]
pub struct ClusterStore {
    file: WholeFile,
    meta: ClusterMeta,
    codec: ClusterCodec,
    table: ClusterTable,
}

impl ClusterStore {
    /// Whether a file, which must be a whole `.yama`, holds a model or a TIN; else it holds a terrain.
    pub fn is_model(path: impl AsRef<Path>) -> Result<bool, IoError> {
        Ok(content_of(path.as_ref())? != Content::Terrain)
    }

    /// Opens a file, checks that it is whole and of a version that is understood, and reads its nodes.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, IoError> {
        let path = path.as_ref();
        let content = match content_of(path)? {
            Content::Tin => Content::Tin,
            _ => Content::Clusters,
        };
        let file = WholeFile::open(path, content, &CLUSTER_TABLES, MAX_ROW_BYTES)?;
        let meta = file
            .with("database", read_meta)?
            .and_then(|facts| facts.clusters())
            .and_then(|meta| meta.check().map(|()| meta))
            .and_then(|meta| match (content == Content::Tin) == meta.tin.is_some() {
                true => Ok(meta),
                false => Err("another kind than the file's head says".to_owned()),
            })
            .map_err(|found| IoError::malformed(path, "table `meta`", "a model that can be", found))?;
        let damaged = |row: i64| {
            let place = if row == BASE_ROW { "base mesh".to_owned() } else { format!("nodes from {row} on") };
            IoError::malformed(path, place, "whole nodes", "damaged ones")
        };
        let block = |row: i64| -> Result<Vec<u8>, IoError> { node_block(&file, row)?.ok_or_else(|| damaged(row)) };
        let table = ClusterTable::read(&meta, block, damaged)?;
        Ok(Self { codec: ClusterCodec::new(&meta), file, meta, table })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        self.file.path()
    }

    /// What the file says of itself.
    pub fn meta(&self) -> &ClusterMeta {
        &self.meta
    }

    /// The nodes and what they say of the pages.
    pub fn table(&self) -> &ClusterTable {
        &self.table
    }

    /// The nodes, parents first.
    pub fn nodes(&self) -> &[ClusterNode] {
        self.table.nodes()
    }

    /// Triangles in each cluster of the base mesh.
    pub fn base_clusters(&self) -> &[u16] {
        self.table.base_clusters()
    }

    /// A node's page, or the base mesh's ([`BASE_CLUSTERS`]).
    pub fn page(&self, group: GroupId) -> Result<ClusterPage, IoError> {
        let damaged = |found: &'static str| {
            let place = if group == BASE_CLUSTERS { "base mesh".to_owned() } else { format!("page of node {group}") };
            IoError::malformed(self.path(), place, "a whole page", found)
        };
        let shape = self.table.shape(group).ok_or_else(|| damaged("there is no such node"))?;
        let bytes = self.file.page_bytes(group_row(group), MAX_ROW_BYTES as usize)?.map_err(damaged)?;
        self.codec.decode(shape, &bytes).map_err(damaged)
    }

    /// What a TIN's file knew beside its visible triangles; nothing for a scan.
    pub fn annex(&self) -> Result<TinAnnex, IoError> {
        if self.meta.tin.is_none() {
            return Ok(TinAnnex::default());
        }
        let damaged = |found: &'static str| IoError::malformed(self.path(), "annex", "a whole annex", found);
        let bytes = self.file.page_bytes(ANNEX_ROW, MAX_ROW_BYTES as usize)?.map_err(damaged)?;
        TinAnnex::from_bytes(&bytes).ok_or_else(|| damaged("a damaged one"))
    }

    /// Reads everything once: every page, every checksum.
    pub fn verify(&self) -> Result<(), IoError> {
        self.file.check_structure()?;
        self.page(BASE_CLUSTERS)?;
        self.annex()?;
        (0..self.meta.nodes).try_for_each(|node| self.page(node).map(|_| ()))
    }
}
