//! Writing a model's `.yama` file.

use super::annex::TinAnnex;
use super::codec::ClusterCodec;
use super::meta::ClusterMeta;
use super::nodes::{BLOCK_NODES, BaseShape, pack, pack_base};
use super::table::{ANNEX_ROW, BASE_ROW, group_row};
use crate::IoError;
use crate::store::database::PartFile;
use crate::store::rows::row_crc32;
use crate::store::schema::{CLUSTER_TABLES, Content, write_cluster_meta};
use rusqlite::params;
use std::path::Path;
use yamanami_core::{ClusterNode, GroupId};

/// Bytes of a database page.
const DB_PAGE_BYTES: u32 = 1024;
/// A model's `.yama` file in the making.
#[derive(Debug)]
pub struct ClusterWriter {
    file: PartFile,
    codec: ClusterCodec,
    expected: u64,
    written: u64,
    content: Content,
}

impl ClusterWriter {
    /// Begins a file; nothing at `path` changes before [`Self::finish`]. Errors and bounds of the nodes are stored larger by
    /// what vertices may move when they are rounded. `base_clusters` has the triangles in each cluster of the base mesh.
    pub fn create(
        path: impl AsRef<Path>,
        meta: ClusterMeta,
        nodes: &[ClusterNode],
        base_vertices: u32,
        base_clusters: &[u16],
    ) -> Result<Self, IoError> {
        let path = path.as_ref();
        meta.check().map_err(|given| IoError::BadRequest {
            what: format!("facts of {}", path.display()),
            expected: "a model that can be".into(),
            given,
        })?;
        let file = PartFile::create(path, DB_PAGE_BYTES, &CLUSTER_TABLES)?;
        file.with(|db| write_cluster_meta(db, &meta))?;
        let base = BaseShape { vertices: base_vertices, clusters: base_clusters.to_vec() };
        let packed = |result: std::io::Result<Vec<u8>>| result.map_err(|e| IoError::io(path, e));
        let mut blocks = vec![(BASE_ROW, packed(pack_base(&base))?)];
        let max_error_m = meta.max_error_m;
        for (block, nodes) in nodes.chunks(BLOCK_NODES).enumerate() {
            let first = block * BLOCK_NODES;
            let widened: Vec<ClusterNode> = nodes.iter().map(|node| widen(node, max_error_m)).collect();
            blocks.push((first as i64, packed(pack(first, &widened))?));
        }
        file.with(|db| {
            let mut insert = db.prepare("INSERT INTO node_block(id, crc32, data) VALUES(?1, ?2, ?3)")?;
            blocks
                .iter()
                .try_for_each(|(row, bytes)| insert.execute(params![row, row_crc32(*row, bytes), bytes]).map(|_| ()))
        })?;
        let content = if meta.tin.is_some() { Content::Tin } else { Content::Clusters };
        Ok(Self { file, codec: ClusterCodec::new(&meta), expected: nodes.len() as u64 + 1, written: 0, content })
    }

    /// Codes pages: copy it to as many threads as there are.
    pub fn codec(&self) -> ClusterCodec {
        self.codec
    }

    /// Stores a coded page: of the base mesh first, then of the nodes in order, so that a prefix is a coarser model.
    pub fn insert(&mut self, group: GroupId, bytes: &[u8]) -> Result<(), IoError> {
        self.file.insert_page(group_row(group), bytes)?;
        self.written += 1;
        Ok(())
    }

    /// Stores what a TIN's file knew beside its visible triangles.
    pub fn insert_annex(&mut self, annex: &TinAnnex) -> Result<(), IoError> {
        let bytes = annex.to_bytes().map_err(|e| IoError::io(self.file.target(), e))?;
        self.file.insert_page(ANNEX_ROW, &bytes)
    }

    /// Checks that every page is there, closes the file and puts it in its place.
    pub fn finish(self) -> Result<(), IoError> {
        if self.written != self.expected {
            return Err(IoError::BadRequest {
                what: format!("pages of {}", self.file.target().display()),
                expected: self.expected.to_string(),
                given: self.written.to_string(),
            });
        }
        self.file.finish(self.content, |_| Ok(()))
    }
}

/// A node of a surface whose vertices moved by so much.
fn widen(node: &ClusterNode, by_m: f64) -> ClusterNode {
    let exact_m = f64::from(node.error_m) + by_m;
    let error_m = exact_m as f32;
    let error_m = if f64::from(error_m) < exact_m { error_m.next_up() } else { error_m };
    let mut node = node.clone();
    node.error_m = error_m;
    node.bound.radius_m = (node.bound.radius_m + by_m).next_up();
    node
}
