//! The nodes of a cluster hierarchy as flat arrays, checked once: who replaces which cluster, parents, children, and
//! where each cluster and vertex is found.

use crate::MultiresError;
use yamanami_core::{BASE_CLUSTERS, ClusterNode, GroupId, NodeId, Sphere, TriangleKey, VertexId};

/// Most clusters that a node may bring or take away: what [`yamanami_core::NodeList`] holds.
pub(super) const MOST_CLUSTERS: usize = 20;

/// No node.
pub(super) const NOBODY: NodeId = NodeId::MAX;

/// What is kept of each node.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slim {
    pub(super) bound: Sphere,
    pub(super) error_m: f32,
    pub(super) level: u32,
    pub(super) triangles_added: i32,
}

/// A cluster in its page.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cluster {
    /// Its first triangle's place in the page.
    pub(super) start: u32,
    pub(super) len: u16,
    /// The node that takes it away, or [`NOBODY`].
    pub(super) replaced_by: NodeId,
}

/// Lists of one length each, end to end.
#[derive(Debug, Clone, Default)]
struct Lists<T> {
    /// One more than there are lists.
    start: Vec<u32>,
    items: Vec<T>,
}

impl<T> Lists<T> {
    fn of(&self, list: usize) -> &[T] {
        &self.items[self.start[list] as usize..self.start[list + 1] as usize]
    }
}

/// The checked nodes.
#[derive(Debug, Clone)]
pub(super) struct Table {
    pub(super) nodes: Vec<Slim>,
    /// The clusters of each node, and after the last node's those of the base mesh.
    clusters: Lists<Cluster>,
    /// The clusters that each node takes away: the group's place in `clusters`, and the cluster's therein.
    replaced: Lists<(u32, u16)>,
    parents: Lists<NodeId>,
    children: Lists<NodeId>,
    /// First vertex of each node, and one past the last of all.
    first_vertex: Vec<VertexId>,
    roots: Vec<NodeId>,
}

fn complaint(group: GroupId, what: &'static str, expected: u64, given: u64) -> MultiresError {
    MultiresError::BadClusters { group, what, expected, given }
}

impl Table {
    /// Checks all that the surface relies on. Nodes whose numbers do not fit together are refused by name.
    pub(super) fn new(
        nodes: &[ClusterNode],
        base_clusters: &[u16],
        base_vertices: usize,
    ) -> Result<Self, MultiresError> {
        let count = nodes.len();
        if count >= NOBODY as usize {
            return Err(complaint(BASE_CLUSTERS, "nodes", u64::from(NOBODY) - 1, count as u64));
        }
        if base_clusters.len() > usize::from(u16::MAX) + 1 {
            return Err(complaint(BASE_CLUSTERS, "clusters at most", 1 << 16, base_clusters.len() as u64));
        }
        let first_vertex = vertex_starts(nodes, base_vertices)?;
        let mut clusters = Lists { start: vec![0], items: Vec::new() };
        let groups = nodes.iter().map(|n| n.cluster_triangles.as_slice()).chain([base_clusters]);
        for (number, lens) in groups.enumerate() {
            if number < count && lens.len() > MOST_CLUSTERS {
                return Err(complaint(number as u32, "clusters at most", MOST_CLUSTERS as u64, lens.len() as u64));
            }
            let mut start = 0;
            for &len in lens {
                clusters.items.push(Cluster { start, len, replaced_by: NOBODY });
                start += u32::from(len);
            }
            clusters.start.push(clusters.items.len() as u32);
        }
        let mut table = Self {
            nodes: Vec::with_capacity(count),
            clusters,
            replaced: Lists { start: vec![0], items: Vec::new() },
            parents: Lists { start: vec![0], items: Vec::new() },
            children: Lists::default(),
            first_vertex,
            roots: Vec::new(),
        };
        for (number, node) in nodes.iter().enumerate() {
            table.add(number as NodeId, node)?;
        }
        table.list_children();
        Ok(table)
    }

    fn add(&mut self, number: NodeId, node: &ClusterNode) -> Result<(), MultiresError> {
        if node.replaced.is_empty() || node.replaced.len() > MOST_CLUSTERS {
            let given = node.replaced.len() as u64;
            return Err(complaint(number, "clusters taken away, at most", MOST_CLUSTERS as u64, given));
        }
        let is_sound = node.error_m >= 0.0 && node.bound.centre.is_finite() && node.bound.radius_m >= 0.0;
        if !is_sound || !node.bound.radius_m.is_finite() {
            return Err(complaint(number, "errors or bounds that are not numbers", 0, 1));
        }
        let (mut removed, first_parent) = (0, self.parents.items.len());
        for &(group, place) in &node.replaced {
            let list = match group {
                BASE_CLUSTERS => self.clusters.start.len() - 2,
                group if group < number => group as usize,
                group => return Err(complaint(number, "parents below", u64::from(number), u64::from(group))),
            };
            let start = self.clusters.start[list];
            let brought = self.clusters.start[list + 1] - start;
            if u32::from(place) >= brought {
                return Err(complaint(number, "clusters of its parent below", u64::from(brought), u64::from(place)));
            }
            let cluster = &mut self.clusters.items[start as usize + usize::from(place)];
            if cluster.replaced_by != NOBODY {
                let given = u64::from(cluster.replaced_by);
                return Err(complaint(number, "a cluster that no other node takes away", u64::from(NOBODY), given));
            }
            cluster.replaced_by = number;
            removed += i32::from(cluster.len);
            self.replaced.items.push((list as u32, place));
            if group != BASE_CLUSTERS {
                self.parents.items.push(group);
            }
        }
        let own = &mut self.parents.items[first_parent..];
        own.sort_unstable();
        let mut kept = first_parent;
        for i in first_parent..self.parents.items.len() {
            if i == first_parent || self.parents.items[i] != self.parents.items[kept - 1] {
                self.parents.items[kept] = self.parents.items[i];
                kept += 1;
            }
        }
        self.parents.items.truncate(kept);
        if kept == first_parent {
            self.roots.push(number);
        }
        self.parents.start.push(kept as u32);
        self.replaced.start.push(self.replaced.items.len() as u32);
        let triangles_added = node.triangle_count() as i32 - removed;
        self.nodes.push(Slim { bound: node.bound, error_m: node.error_m, level: node.level, triangles_added });
        Ok(())
    }

    fn list_children(&mut self) {
        let count = self.nodes.len();
        let mut start = vec![0u32; count + 1];
        for &parent in &self.parents.items {
            start[parent as usize + 1] += 1;
        }
        for i in 0..count {
            start[i + 1] += start[i];
        }
        let mut next = start.clone();
        let mut items = vec![0; self.parents.items.len()];
        for node in 0..count {
            for &parent in self.parents.of(node) {
                items[next[parent as usize] as usize] = node as NodeId;
                next[parent as usize] += 1;
            }
        }
        self.children = Lists { start, items };
    }

    pub(super) fn parents(&self, node: NodeId) -> &[NodeId] {
        self.parents.of(node as usize)
    }

    /// At most as many as the clusters that the node brings, for each is taken away once.
    pub(super) fn children(&self, node: NodeId) -> &[NodeId] {
        self.children.of(node as usize)
    }

    pub(super) fn roots(&self) -> &[NodeId] {
        &self.roots
    }

    /// Lists of clusters: one a node, and the base mesh's.
    pub(super) fn lists(&self) -> usize {
        self.nodes.len() + 1
    }

    /// The clusters of a node, or of the base mesh where `list` is one past the last node.
    pub(super) fn clusters(&self, list: usize) -> &[Cluster] {
        self.clusters.of(list)
    }

    /// The clusters that a node takes away: list, place in it, and the cluster.
    pub(super) fn replaced(&self, node: NodeId) -> impl Iterator<Item = (usize, u16, Cluster)> {
        self.replaced.of(node as usize).iter().map(|&(list, place)| {
            let list = list as usize;
            (list, place, self.clusters.of(list)[usize::from(place)])
        })
    }

    /// The key of a cluster's first triangle; those of the others follow.
    pub(super) fn first_key(&self, list: usize, place: u16) -> TriangleKey {
        let group = if list == self.nodes.len() { BASE_CLUSTERS } else { list as GroupId };
        u64::from(group) << 32 | u64::from(place) << 16
    }

    /// The vertices that a node brings; those of the base mesh where `list` is one past the last node.
    pub(super) fn vertices(&self, list: usize) -> std::ops::Range<VertexId> {
        if list == self.nodes.len() {
            0..self.first_vertex[0]
        } else {
            self.first_vertex[list]..self.first_vertex[list + 1]
        }
    }

    /// Which list brings a vertex that some list brings. Quick where it is `hint`.
    pub(super) fn list_of(&self, vertex: VertexId, hint: usize) -> usize {
        if self.vertices(hint).contains(&vertex) {
            return hint;
        }
        if vertex < self.first_vertex[0] {
            return self.nodes.len();
        }
        self.first_vertex.partition_point(|&first| first <= vertex) - 1
    }
}

/// First vertex of each node, and one past the last; they must follow each other, after the base mesh's.
fn vertex_starts(nodes: &[ClusterNode], base_vertices: usize) -> Result<Vec<VertexId>, MultiresError> {
    let mut starts = Vec::with_capacity(nodes.len() + 1);
    let mut next = base_vertices as u64;
    for (number, node) in nodes.iter().enumerate() {
        if u64::from(node.first_vertex) != next {
            return Err(complaint(number as u32, "first vertex", next, u64::from(node.first_vertex)));
        }
        starts.push(node.first_vertex);
        next += u64::from(node.vertex_count);
    }
    let end = VertexId::try_from(next).map_err(|_| complaint(BASE_CLUSTERS, "vertices at most", 1 << 32, next))?;
    starts.push(end);
    Ok(starts)
}
