//! Final numbers: nodes from coarse to fine, and the vertices in the order in which nodes bring them.

use super::ClusterBuild;
use super::build::{BuildSummary, Record};
use super::patch::Live;
use super::weld::Vertices;
use crate::MultiresError;
use yamanami_core::{BASE_CLUSTERS, ClusterNode, ClusterPage, ClusterVertex, GroupId, VertexId};

/// Not numbered yet.
const NONE: VertexId = VertexId::MAX;

/// Numbers of vertices under way.
struct Numbers<'a> {
    vertices: &'a Vertices,
    /// For each vertex of the build its final number.
    of: Vec<VertexId>,
    next: VertexId,
}

impl Numbers<'_> {
    /// Numbers the vertices of `triangles` that have no number yet, in the order of their use, and gives them.
    fn bring(&mut self, triangles: &[[u32; 3]]) -> Vec<ClusterVertex> {
        let mut brought = Vec::new();
        for &v in triangles.as_flattened() {
            let v = v as usize;
            if self.of[v] == NONE {
                self.of[v] = self.next;
                self.next += 1;
                brought.push(ClusterVertex {
                    position_m: self.vertices.positions[v].to_array(),
                    normal: self.vertices.normals[v],
                    colour: self.vertices.colours[v],
                });
            }
        }
        brought
    }

    fn final_triangles(&self, triangles: Vec<[u32; 3]>) -> Vec<[VertexId; 3]> {
        triangles.into_iter().map(|t| t.map(|v| self.of[v as usize])).collect()
    }
}

/// Rounds up.
fn f32_above(x: f64) -> f32 {
    let y = x as f32;
    if f64::from(y) < x { y.next_up() } else { y }
}

/// Puts clusters end to end. Their makers learn who brings them.
fn lay_out(clusters: Vec<Live>, bringer: GroupId, replaced: &mut [Vec<(GroupId, u16)>]) -> (Vec<[u32; 3]>, Vec<u16>) {
    let (mut triangles, mut lens) = (Vec::new(), Vec::with_capacity(clusters.len()));
    for (place, cluster) in (0u16..).zip(clusters) {
        lens.push(cluster.triangles.len() as u16);
        triangles.extend(cluster.triangles);
        if let Some((maker, made_place)) = cluster.made_by {
            replaced[maker as usize][usize::from(made_place)] = (bringer, place);
        }
    }
    (triangles, lens)
}

/// A hierarchy under its final numbers.
#[derive(Debug)]
pub(super) struct Numbered {
    pub(super) build: ClusterBuild,
    /// Who brings each cluster of each hierarchy that goes on below this one: a node or the base mesh, and which of its
    /// clusters it is.
    pub(super) below: Vec<Vec<(GroupId, u16)>>,
    /// For each vertex of the build its number.
    pub(super) vertex_ids: Vec<VertexId>,
}

/// Numbers everything. `records` go from fine to coarse; `base` are the clusters left; `below` says how many clusters each
/// of the hierarchies has that go on below this one.
pub(super) fn number(
    records: Vec<Record>,
    base: Vec<Live>,
    vertices: &Vertices,
    summary: BuildSummary,
    below: &[usize],
) -> Result<Numbered, MultiresError> {
    if base.len() > usize::from(u16::MAX) {
        let (count, most) = (base.len() as u64, u64::from(u16::MAX));
        return Err(MultiresError::TooManyClusters { what: "clusters of the base mesh", count, most });
    }
    let count = records.len();
    let coarser = below.iter().copied().chain(records.iter().map(|r| r.coarser));
    let mut replaced: Vec<Vec<(GroupId, u16)>> = coarser.map(|n| vec![(BASE_CLUSTERS, 0); n]).collect();
    let mut numbers = Numbers { vertices, of: vec![NONE; vertices.positions.len()], next: 0 };
    let (triangles, base_clusters) = lay_out(base, BASE_CLUSTERS, &mut replaced);
    let brought = numbers.bring(&triangles);
    let triangles = numbers.final_triangles(triangles);
    let base = ClusterPage { group: BASE_CLUSTERS, vertices: brought, removed: Vec::new(), triangles };

    let (mut nodes, mut pages) = (Vec::<ClusterNode>::with_capacity(count), Vec::with_capacity(count));
    // the last record is the coarsest: by then all that made its coarser clusters' bringers is laid out
    for (index, record) in records.into_iter().enumerate().rev() {
        let group = nodes.len() as GroupId;
        let own = std::mem::take(&mut replaced[below.len() + index]);
        let level = (own.iter()).map(|&(g, _)| nodes.get(g as usize).map_or(0, |parent| parent.level + 1)).max();
        let first_vertex = numbers.next;
        let (triangles, cluster_triangles) = lay_out(record.members, group, &mut replaced);
        let vertices = numbers.bring(&triangles);
        let mut removed: Vec<VertexId> = record.made.map(|v| numbers.of[v as usize]).collect();
        removed.sort_unstable();
        nodes.push(ClusterNode {
            error_m: f32_above(record.error_m),
            bound: record.bound,
            level: level.unwrap_or(0),
            replaced: own,
            cluster_triangles,
            first_vertex,
            vertex_count: vertices.len() as u32,
        });
        let triangles = numbers.final_triangles(triangles);
        pages.push(ClusterPage { group, vertices, removed, triangles });
    }
    replaced.truncate(below.len());
    let build = ClusterBuild { nodes, base_clusters, base, pages, summary };
    Ok(Numbered { build, below: replaced, vertex_ids: numbers.of })
}
