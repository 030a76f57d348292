//! Nodes of a cluster hierarchy to bytes and back, a block of them at a time.

#[cfg(feature = "files")]
use super::super::bits::put_varint;
use super::super::bits::{take, take_varint};
use super::super::frame::decompress;
use glam::DVec3;
use yamanami_core::{BASE_CLUSTERS, ClusterNode, Sphere, VertexId};

/// Nodes of a block.
pub(crate) const BLOCK_NODES: usize = 1024;
/// No node takes more bytes: 20 clusters away and 20 in their place.
const MOST_NODE_BYTES: usize = 512;
/// Most clusters that a node takes away or brings.
const MOST_CLUSTERS: u64 = 20;
/// Most clusters of the base mesh.
const MOST_BASE_CLUSTERS: u64 = 1 << 16;
#[cfg(feature = "files")]
const ZSTD_LEVEL: i32 = 12;

/// What the base mesh consists of.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BaseShape {
    pub(super) vertices: u32,
    /// Triangles in each cluster.
    pub(super) clusters: Vec<u16>,
}

/// Packs nodes from number `first` on: floats of all of them, then the whole numbers.
#[cfg(feature = "files")]
pub(super) fn pack(first: usize, nodes: &[ClusterNode]) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    for node in nodes {
        bytes.extend(node.error_m.to_le_bytes());
        let Sphere { centre, radius_m } = node.bound;
        bytes.extend([centre.x, centre.y, centre.z, radius_m].iter().flat_map(|v| v.to_le_bytes()));
    }
    for (number, node) in (first as u64..).zip(nodes) {
        put_varint(&mut bytes, node.level.into());
        put_varint(&mut bytes, node.vertex_count.into());
        put_varint(&mut bytes, node.replaced.len() as u64);
        for &(group, place) in &node.replaced {
            // parents have lower numbers, so 0 is free for the base mesh
            let back = if group == BASE_CLUSTERS { 0 } else { number.saturating_sub(group.into()) };
            put_varint(&mut bytes, back);
            put_varint(&mut bytes, place.into());
        }
        put_varint(&mut bytes, node.cluster_triangles.len() as u64);
        node.cluster_triangles.iter().for_each(|&n| put_varint(&mut bytes, n.into()));
    }
    zstd::bulk::compress(&bytes, ZSTD_LEVEL)
}

/// Undoes [`pack`] for `count` nodes whose vertices are numbered from `next_vertex` on; `None` when the bytes are no such
/// block.
pub(super) fn unpack(first: usize, count: usize, bytes: &[u8], next_vertex: &mut VertexId) -> Option<Vec<ClusterNode>> {
    let bytes = decompress(bytes, BLOCK_NODES * MOST_NODE_BYTES)?;
    let mut numbers = bytes.as_slice();
    let mut floats = take(&mut numbers, count.checked_mul(36)?)?;
    let mut nodes = Vec::with_capacity(count);
    for number in (first as u64..).take(count) {
        let error_m = f32::from_le_bytes(*take(&mut floats, 4)?.first_chunk()?);
        let mut real = || Some(f64::from_le_bytes(*take(&mut floats, 8)?.first_chunk()?));
        let bound = Sphere { centre: DVec3::new(real()?, real()?, real()?), radius_m: real()? };
        let level = u32::try_from(take_varint(&mut numbers)?).ok()?;
        let vertex_count = u32::try_from(take_varint(&mut numbers)?).ok()?;
        let replaced = take_varint(&mut numbers).filter(|&n| n <= MOST_CLUSTERS)?;
        let replaced = (0..replaced).map(|_| {
            let group = match take_varint(&mut numbers)? {
                0 => BASE_CLUSTERS,
                back => u32::try_from(number.checked_sub(back)?).ok()?,
            };
            Some((group, u16::try_from(take_varint(&mut numbers)?).ok()?))
        });
        let replaced = replaced.collect::<Option<_>>()?;
        let clusters = take_varint(&mut numbers).filter(|&n| n <= MOST_CLUSTERS)?;
        let cluster_triangles = take_lengths(&mut numbers, clusters)?;
        let triangles: u64 = cluster_triangles.iter().map(|&n| u64::from(n)).sum();
        if u64::from(vertex_count) > 3 * triangles {
            return None;
        }
        let first_vertex = *next_vertex;
        *next_vertex = next_vertex.checked_add(vertex_count)?;
        nodes.push(ClusterNode { error_m, bound, level, replaced, cluster_triangles, first_vertex, vertex_count });
    }
    numbers.is_empty().then_some(nodes)
}

/// Packs what the base mesh consists of.
#[cfg(feature = "files")]
pub(super) fn pack_base(base: &BaseShape) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    put_varint(&mut bytes, base.vertices.into());
    put_varint(&mut bytes, base.clusters.len() as u64);
    base.clusters.iter().for_each(|&n| put_varint(&mut bytes, n.into()));
    zstd::bulk::compress(&bytes, ZSTD_LEVEL)
}

/// Undoes [`pack_base`].
pub(super) fn unpack_base(bytes: &[u8]) -> Option<BaseShape> {
    let bytes = decompress(bytes, 16 + 3 * MOST_BASE_CLUSTERS as usize)?;
    let mut numbers = bytes.as_slice();
    let vertices = u32::try_from(take_varint(&mut numbers)?).ok()?;
    let clusters = take_varint(&mut numbers).filter(|&n| n <= MOST_BASE_CLUSTERS)?;
    let clusters = take_lengths(&mut numbers, clusters)?;
    numbers.is_empty().then_some(BaseShape { vertices, clusters })
}

fn take_lengths(numbers: &mut &[u8], count: u64) -> Option<Vec<u16>> {
    (0..count).map(|_| u16::try_from(take_varint(numbers)?).ok()).collect()
}
