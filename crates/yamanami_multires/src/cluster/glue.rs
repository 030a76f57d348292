//! Hierarchies of grounds larger than memory: tiles are built alone, then joined by a hierarchy above them.
//!
//! A tile's hierarchy ends in a few coarse clusters, its *top*, whose vertices at other tiles are untouched. The tops of all
//! tiles are the source of the hierarchy above, in which the lines between tiles are lines like any other and go. What was
//! a tile's base mesh is then brought by nodes above, so that all together are one multi-triangulation.
//! Idea: Cignoni, Ganovelli, Gobbetti, Marton, Ponchio, Scopigno, "Batched Multi Triangulation", 2005 (out-of-core merging);
//! here the parts are whole hierarchies, numbered anew when they are joined.

use super::build::Rounds;
use super::ground::Ground;
use super::patch::Live;
use super::split::edge_key;
use super::weld::{Vertices, unit_normal, weld};
use super::{ClusterBuild, ClusterOptions};
use crate::MultiresError;
use glam::DVec3;
use std::collections::{HashMap, HashSet};
use yamanami_core::{BASE_CLUSTERS, ClusterNode, ClusterPage, GroupId, Snap, Sphere, Tin, TriangleMesh, VertexId};

/// A tile's top has this share of its triangles, about.
const TOP_SHARE: usize = 64;

/// A tile: its own hierarchy, and what the one above must know of it.
#[derive(Debug, Clone)]
pub struct Tile {
    /// Its hierarchy; the base mesh is its top.
    pub build: ClusterBuild,
    top: TileTop,
}

impl Tile {
    /// Parts with its top: the base mesh as it is now numbered.
    pub fn take_top(&mut self) -> TileTop {
        let page =
            ClusterPage { group: BASE_CLUSTERS, vertices: Vec::new(), removed: Vec::new(), triangles: Vec::new() };
        self.top.page = std::mem::replace(&mut self.build.base, page);
        self.top.clone()
    }
}

/// The coarse end of a tile's hierarchy.
#[derive(Debug, Clone)]
pub struct TileTop {
    page: ClusterPage,
    clusters: Vec<u16>,
    /// Bound on each cluster's distance from the source, metres, and what holds all below it.
    below: Vec<(f64, Option<Sphere>)>,
    /// Edges of breaklines.
    lines: Vec<[DVec3; 2]>,
    nodes: usize,
    vertices: usize,
}

/// Where a tile's hierarchy hangs in the whole.
#[derive(Debug, Clone)]
pub struct Seam {
    first_node: GroupId,
    first_vertex: VertexId,
    /// Who brings each cluster of its top, and on which level.
    clusters: Vec<(GroupId, u16, u32)>,
    /// The number of each vertex of its top.
    vertices: Vec<VertexId>,
}

/// The hierarchy above all tiles.
#[derive(Debug)]
pub struct Glued {
    /// Its nodes come first of all.
    pub build: ClusterBuild,
    /// Where each tile hangs; their nodes follow in this order.
    pub seams: Vec<Seam>,
}

fn key(p: DVec3) -> [u64; 3] {
    (p + DVec3::ZERO).to_array().map(f64::to_bits)
}

/// Builds a tile of a TIN. `is_shared` tells the places where other tiles have vertices, too; they stay.
pub fn build_tile(
    tin: &Tin,
    is_shared: &dyn Fn(DVec3) -> bool,
    snap: Option<Snap>,
    options: &ClusterOptions<'_>,
) -> Result<Tile, MultiresError> {
    let (vertices, triangles) = weld(&tin.mesh)?;
    let ground = Ground::new(tin, snap, &vertices, &triangles);
    let enough = triangles.len() / TOP_SHARE;
    let is_fixed = vertices.positions.iter().map(|&p| is_shared(p)).collect();
    let mut rounds = Rounds::new(vertices, Some(ground), options);
    rounds.is_fixed = is_fixed;
    let leaves = rounds.leaves(triangles);
    let live = rounds.run(leaves, enough)?;
    let below = live.iter().map(|cluster| (cluster.error_m, cluster.bound)).collect();
    let mut lines = Vec::new();
    if let Some(ground) = &rounds.ground {
        for &[a, b, c] in live.iter().flat_map(|cluster| &cluster.triangles) {
            for (u, v) in [(a, b), (b, c), (c, a)] {
                if ground.has_line(u, v) {
                    lines.push([u, v].map(|w| rounds.vertices.positions[w as usize]));
                }
            }
        }
    }
    let build = rounds.finish(live)?.build;
    let top = TileTop {
        page: build.base.clone(),
        clusters: build.base_clusters.clone(),
        below,
        lines,
        nodes: build.nodes.len(),
        vertices: build.nodes.iter().map(|n| n.vertex_count as usize).sum(),
    };
    Ok(Tile { build, top })
}

/// Builds the hierarchy above the tiles' tops.
pub fn join_tiles(tops: &[TileTop], snap: Option<Snap>, options: &ClusterOptions<'_>) -> Result<Glued, MultiresError> {
    let (vertices, ids) = join_vertices(tops);
    let mut live = Vec::new();
    for (tile, (top, ids)) in (0u32..).zip(tops.iter().zip(&ids)) {
        let mut rest = top.page.triangles.as_slice();
        for ((place, &length), &(error_m, bound)) in (0u16..).zip(&top.clusters).zip(&top.below) {
            let (own, more) = rest.split_at(usize::from(length));
            rest = more;
            let triangles: Vec<[u32; 3]> = own.iter().map(|t| t.map(|v| ids[v as usize])).collect();
            let first = vertices.positions[triangles[0][0] as usize];
            let sum: DVec3 = triangles.as_flattened().iter().map(|&v| vertices.positions[v as usize] - first).sum();
            let centre = first + sum / (3 * triangles.len()) as f64;
            live.push(Live { triangles, centre, error_m, made_by: Some((tile, place)), bound });
        }
    }
    let at: HashMap<[u64; 3], u32> = vertices.positions.iter().zip(0..).map(|(&p, v)| (key(p), v)).collect();
    let lines: HashSet<u64> = (tops.iter().flat_map(|top| &top.lines))
        .map(|line| line.map(|p| at[&key(p)]))
        .map(|[a, b]| edge_key(a, b))
        .collect();
    drop(at);
    let triangles = live.iter().flat_map(|cluster| cluster.triangles.iter().copied()).collect();
    let ground = Ground::above(&TriangleMesh::new(vertices.positions.clone(), triangles), lines, snap);
    let mut rounds = Rounds::new(vertices, Some(ground), options);
    rounds.below = tops.iter().map(|top| top.clusters.len()).collect();
    let live = rounds.run(live, 0)?;
    let numbered = rounds.finish(live)?;
    let build = numbered.build;
    let mut next_node = build.nodes.len() as u64;
    let mut next_vertex =
        build.base.vertices.len() as u64 + build.nodes.iter().map(|n| u64::from(n.vertex_count)).sum::<u64>();
    let mut seams = Vec::with_capacity(tops.len());
    for ((top, ids), bringers) in tops.iter().zip(ids).zip(numbered.below) {
        let level = |group: GroupId| build.nodes.get(group as usize).map_or(0, |node| node.level + 1);
        seams.push(Seam {
            first_node: next_node as GroupId,
            first_vertex: next_vertex as VertexId,
            clusters: bringers.into_iter().map(|(group, place)| (group, place, level(group))).collect(),
            vertices: ids.into_iter().map(|v| numbered.vertex_ids[v as usize]).collect(),
        });
        next_node += top.nodes as u64;
        next_vertex += top.vertices as u64;
    }
    for (what, count) in [("vertices", next_vertex), ("nodes", next_node)] {
        if count >= u64::from(u32::MAX) {
            return Err(MultiresError::TooManyClusters { what, count, most: u64::from(u32::MAX) });
        }
    }
    Ok(Glued { build, seams })
}

/// The vertices of all tops, those at one place joined: their normals are the mean of what the tiles make of them.
fn join_vertices(tops: &[TileTop]) -> (Vertices, Vec<Vec<u32>>) {
    let mut vertices = Vertices::default();
    let mut at: HashMap<[u64; 3], u32> = HashMap::new();
    let mut normals: Vec<DVec3> = Vec::new();
    let ids = tops.iter().map(|top| {
        let id = |vertex: &yamanami_core::ClusterVertex| {
            let position = DVec3::from_array(vertex.position_m);
            let id = *at.entry(key(position)).or_insert_with(|| {
                vertices.positions.push(position);
                vertices.colours.push(vertex.colour);
                normals.push(DVec3::ZERO);
                vertices.positions.len() as u32 - 1
            });
            normals[id as usize] += DVec3::from_array(vertex.normal.map(f64::from));
            id
        };
        top.page.vertices.iter().map(id).collect()
    });
    let ids = ids.collect();
    vertices.normals = normals.into_iter().map(unit_normal).collect();
    (vertices, ids)
}

impl Seam {
    /// Gives a tile's nodes their numbers in the whole. They follow those of the tiles before.
    pub fn place_nodes(&self, nodes: &mut [ClusterNode]) {
        let top_vertices = self.vertices.len() as u32;
        for place in 0..nodes.len() {
            let mut level = 0;
            for at in 0..nodes[place].replaced.len() {
                let (group, cluster) = nodes[place].replaced[at];
                let (bringer, bringer_cluster, below) = if group == BASE_CLUSTERS {
                    self.clusters[usize::from(cluster)]
                } else {
                    (self.first_node + group, cluster, nodes[group as usize].level + 1)
                };
                nodes[place].replaced[at] = (bringer, bringer_cluster);
                level = level.max(below);
            }
            let node = &mut nodes[place];
            node.level = level;
            node.first_vertex = node.first_vertex - top_vertices + self.first_vertex;
        }
    }

    /// Gives a page of a tile's node its numbers in the whole.
    pub fn place_page(&self, page: &mut ClusterPage) {
        let top_vertices = self.vertices.len() as u32;
        let place = |id: &mut VertexId| {
            *id = match self.vertices.get(*id as usize) {
                Some(&above) => above,
                None => *id - top_vertices + self.first_vertex,
            };
        };
        page.group += self.first_node;
        page.triangles.as_flattened_mut().iter_mut().for_each(place);
        page.removed.iter_mut().for_each(place);
        page.removed.sort_unstable();
    }
}
