//! The nodes of a model, and what they say of its pages.

use super::codec::PageShape;
use super::meta::ClusterMeta;
use super::nodes::{BLOCK_NODES, BaseShape, unpack, unpack_base};
use yamanami_core::{BASE_CLUSTERS, ClusterNode, GroupId};

/// Row of the base mesh, among the blocks of nodes as among the pages.
pub(crate) const BASE_ROW: i64 = -1;
/// Row of a TIN's annex.
pub(crate) const ANNEX_ROW: i64 = -2;

/// Row number of a group's page: the base mesh before all nodes.
pub fn group_row(group: GroupId) -> i64 {
    if group == BASE_CLUSTERS { BASE_ROW } else { group.into() }
}

/// All nodes of a model and what its base mesh consists of.
#[derive(Debug, Clone)]
pub struct ClusterTable {
    nodes: Vec<ClusterNode>,
    base: BaseShape,
}

impl ClusterTable {
    /// Reads it from the blocks of a file: row -1 is the base mesh, the others hold nodes from their row's number on.
    /// `damaged` makes the error for a row that is no such block.
    pub fn read<E>(
        meta: &ClusterMeta,
        mut block: impl FnMut(i64) -> Result<Vec<u8>, E>,
        damaged: impl Fn(i64) -> E,
    ) -> Result<Self, E> {
        let base = unpack_base(&block(BASE_ROW)?).ok_or_else(|| damaged(BASE_ROW))?;
        let mut nodes = Vec::new();
        let mut next_vertex = base.vertices;
        let count = meta.nodes as usize;
        for first in (0..count).step_by(BLOCK_NODES) {
            let bytes = block(first as i64)?;
            let some = unpack(first, BLOCK_NODES.min(count - first), &bytes, &mut next_vertex);
            nodes.extend(some.ok_or_else(|| damaged(first as i64))?);
        }
        Ok(Self { nodes, base })
    }

    /// The rows of the blocks of a model of so many nodes, in the order in which they are read.
    pub fn rows(nodes: u32) -> impl Iterator<Item = i64> {
        std::iter::once(BASE_ROW).chain((0..i64::from(nodes)).step_by(BLOCK_NODES))
    }

    /// The nodes, parents first.
    pub fn nodes(&self) -> &[ClusterNode] {
        &self.nodes
    }

    /// Triangles in each cluster of the base mesh.
    pub fn base_clusters(&self) -> &[u16] {
        &self.base.clusters
    }

    /// What the nodes say of a page; `None` when there is no such node.
    pub fn shape(&self, group: GroupId) -> Option<PageShape> {
        let sum = |lengths: &[u16]| lengths.iter().map(|&n| u64::from(n)).sum();
        if group == BASE_CLUSTERS {
            let triangles = sum(&self.base.clusters);
            let vertices = self.base.vertices;
            return Some(PageShape { group, first_vertex: 0, vertices, triangles, replaced_triangles: 0 });
        }
        let node = self.nodes.get(group as usize)?;
        let replaced = node.replaced.iter().map(|&(group, place)| {
            let lengths = match group {
                BASE_CLUSTERS => &self.base.clusters,
                group => &self.nodes.get(group as usize)?.cluster_triangles,
            };
            lengths.get(usize::from(place)).map(|&n| u64::from(n))
        });
        Some(PageShape {
            group,
            first_vertex: node.first_vertex,
            vertices: node.vertex_count,
            triangles: sum(&node.cluster_triangles),
            replaced_triangles: replaced.sum::<Option<u64>>()?,
        })
    }
}
