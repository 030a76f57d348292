//! The surface that shows any front of a cluster hierarchy, with the pages that are in memory.
//!
//! A cluster is shown when the node that brought it is applied and the one that takes it away is not. A vertex is there
//! from the node on that brought it until the node that takes it away: nothing of it depends on what else is applied.

use super::table::{NOBODY, Table};
use crate::MultiresError;
use glam::DVec3;
use yamanami_core::{
    ActiveSet, ClusterNode, ClusterPage, ClusterVertex, Hierarchy, NodeId, NodeList, Sink, Sphere, Surface,
    SurfaceVertex, TriangleMesh, VertexId,
};

/// A triangle mesh as a multiresolution surface of clusters. Nodes are all in memory, pages as the owner wishes: a node
/// without its page is not resident. The page of an applied node must stay, and so those of its ancestors.
#[derive(Debug, Clone)]
pub struct ClusterSurface {
    table: Table,
    base: ClusterPage,
    pages: Vec<Option<ClusterPage>>,
    resident_bytes: usize,
}

fn bytes_of(page: &ClusterPage) -> usize {
    size_of_val(page.vertices.as_slice())
        + size_of_val(page.removed.as_slice())
        + size_of_val(page.triangles.as_slice())
}

impl ClusterSurface {
    /// A surface without pages but the base mesh's. `base_clusters` has the triangles in each cluster of the base mesh.
    pub fn new(nodes: &[ClusterNode], base_clusters: &[u16], base: ClusterPage) -> Result<Self, MultiresError> {
        let table = Table::new(nodes, base_clusters, base.vertices.len())?;
        check_page(&table, &base, table.nodes.len())?;
        Ok(Self { pages: vec![None; nodes.len()], resident_bytes: bytes_of(&base), table, base })
    }

    /// Takes a node's page in. A page that does not fit its node is refused.
    pub fn insert(&mut self, page: ClusterPage) -> Result<(), MultiresError> {
        let node = page.group as usize;
        if node >= self.pages.len() {
            let (expected, given) = (self.pages.len() as u64, u64::from(page.group));
            return Err(MultiresError::BadClusters { group: page.group, what: "nodes below", expected, given });
        }
        check_page(&self.table, &page, node)?;
        self.resident_bytes += bytes_of(&page);
        if let Some(old) = self.pages[node].replace(page) {
            self.resident_bytes -= bytes_of(&old);
        }
        Ok(())
    }

    /// Gives a node's page away; it must not be applied.
    pub fn remove(&mut self, node: NodeId) -> Option<ClusterPage> {
        let page = self.pages.get_mut(node as usize)?.take()?;
        self.resident_bytes -= bytes_of(&page);
        Some(page)
    }

    /// Bytes of the pages in memory, the base mesh's among them.
    pub fn resident_bytes(&self) -> usize {
        self.resident_bytes
    }

    /// A node's page, or the base mesh's where `list` is one past the last node.
    fn page(&self, list: usize) -> Option<&ClusterPage> {
        if list == self.pages.len() { Some(&self.base) } else { self.pages[list].as_ref() }
    }

    fn vertex(&self, list: usize, vertex: &ClusterVertex) -> SurfaceVertex {
        let (error_m, bound_radius_m, level) = match self.table.nodes.get(list) {
            Some(node) => (node.error_m, node.bound.radius_m as f32, node.level),
            None => (f32::INFINITY, f32::INFINITY, 0),
        };
        SurfaceVertex {
            position: DVec3::from_array(vertex.position_m),
            normal: vertex.normal,
            detail_m: 0.0,
            error_m,
            bound_radius_m,
            level,
            colour: vertex.colour,
        }
    }

    fn add_vertices(&self, list: usize, page: &ClusterPage, sink: &mut dyn Sink) {
        for (id, vertex) in self.table.vertices(list).zip(&page.vertices) {
            sink.add_vertex(id, self.vertex(list, vertex));
        }
    }

    fn add_cluster(&self, list: usize, place: u16, sink: &mut dyn Sink) {
        let cluster = self.table.clusters(list)[usize::from(place)];
        let Some(page) = self.page(list) else { return };
        let triangles = &page.triangles[cluster.start as usize..][..usize::from(cluster.len)];
        for (key, &corners) in (self.table.first_key(list, place)..).zip(triangles) {
            sink.add_triangle(key, corners);
        }
    }

    fn remove_cluster(&self, list: usize, place: u16, sink: &mut dyn Sink) {
        let len = self.table.clusters(list)[usize::from(place)].len;
        let first = self.table.first_key(list, place);
        for key in first..first + u64::from(len) {
            sink.remove_triangle(key);
        }
    }

    /// Where a vertex comes from. Its page must be in memory.
    fn find_vertex(&self, id: VertexId, hint: usize) -> Option<(usize, &ClusterVertex)> {
        let list = self.table.list_of(id, hint);
        let place = id - self.table.vertices(list).start;
        Some((list, self.page(list)?.vertices.get(place as usize)?))
    }
}

/// A page must have what its node says, and name no vertex that comes later.
fn check_page(table: &Table, page: &ClusterPage, list: usize) -> Result<(), MultiresError> {
    let complain = |what: &'static str, expected: usize, given: usize| {
        let (expected, given) = (expected as u64, given as u64);
        Err(MultiresError::BadClusters { group: page.group, what, expected, given })
    };
    let own = table.vertices(list);
    if page.vertices.len() != own.len() {
        return complain("vertices in its page", own.len(), page.vertices.len());
    }
    let triangles = table.clusters(list).iter().map(|c| usize::from(c.len)).sum();
    if page.triangles.len() != triangles {
        return complain("triangles in its page", triangles, page.triangles.len());
    }
    if let Some(&corner) = page.triangles.as_flattened().iter().find(|&&v| v >= own.end) {
        return complain("corners below", own.end as usize, corner as usize);
    }
    let before = if list == table.nodes.len() { 0 } else { own.start };
    if let Some(&vertex) = page.removed.iter().find(|&&v| v >= before) {
        return complain("vertices taken away, below", before as usize, vertex as usize);
    }
    if let Some(pair) = page.removed.windows(2).find(|pair| pair[0] >= pair[1]) {
        return complain("vertices taken away in order, above", pair[0] as usize, pair[1] as usize);
    }
    Ok(())
}

fn list_of_nodes(nodes: &[NodeId]) -> NodeList {
    let mut list = NodeList::new();
    for &node in nodes {
        list.insert(node);
    }
    list
}

impl Hierarchy for ClusterSurface {
    fn node_bound(&self) -> NodeId {
        self.pages.len() as NodeId
    }

    fn exists(&self, node: NodeId) -> bool {
        (node as usize) < self.pages.len()
    }

    fn roots(&self) -> Vec<NodeId> {
        self.table.roots().to_vec()
    }

    fn parents(&self, node: NodeId) -> NodeList {
        list_of_nodes(self.table.parents(node))
    }

    fn children(&self, node: NodeId) -> NodeList {
        list_of_nodes(self.table.children(node))
    }

    #[inline]
    fn parent_count(&self, node: NodeId) -> usize {
        self.table.parents(node).len()
    }

    fn error_m(&self, node: NodeId) -> f32 {
        self.table.nodes[node as usize].error_m
    }

    fn bound(&self, node: NodeId) -> Sphere {
        self.table.nodes[node as usize].bound
    }

    #[inline]
    fn error_and_bound(&self, node: NodeId) -> (f32, Sphere) {
        let slim = &self.table.nodes[node as usize];
        (slim.error_m, slim.bound)
    }

    fn triangles_added(&self, node: NodeId, _active: &dyn ActiveSet) -> i32 {
        self.table.nodes[node as usize].triangles_added
    }

    fn base_triangle_count(&self) -> usize {
        self.base.triangles.len()
    }

    fn level(&self, node: NodeId) -> u32 {
        self.table.nodes[node as usize].level
    }

    #[inline]
    fn is_resident(&self, node: NodeId) -> bool {
        self.pages[node as usize].is_some()
    }
}

impl Surface for ClusterSurface {
    fn emit_base(&self, sink: &mut dyn Sink) {
        let list = self.pages.len();
        self.add_vertices(list, &self.base, sink);
        for place in 0..self.table.clusters(list).len() {
            self.add_cluster(list, place as u16, sink);
        }
    }

    fn refine(&self, node: NodeId, _active: &dyn ActiveSet, sink: &mut dyn Sink) {
        let list = node as usize;
        let Some(page) = self.page(list) else { return };
        for (list, place, _) in self.table.replaced(node) {
            self.remove_cluster(list, place, sink);
        }
        for &id in &page.removed {
            sink.remove_vertex(id);
        }
        self.add_vertices(list, page, sink);
        for place in 0..self.table.clusters(list).len() {
            self.add_cluster(list, place as u16, sink);
        }
    }

    fn coarsen(&self, node: NodeId, _active: &dyn ActiveSet, sink: &mut dyn Sink) {
        let list = node as usize;
        let Some(page) = self.page(list) else { return };
        for place in 0..self.table.clusters(list).len() {
            self.remove_cluster(list, place as u16, sink);
        }
        for id in self.table.vertices(list) {
            sink.remove_vertex(id);
        }
        let mut hint = self.pages.len();
        for &id in &page.removed {
            let Some((from, vertex)) = self.find_vertex(id, hint) else { continue };
            sink.add_vertex(id, self.vertex(from, vertex));
            hint = from;
        }
        for (list, place, _) in self.table.replaced(node) {
            self.add_cluster(list, place, sink);
        }
    }

    fn emit_front(&self, active: &dyn ActiveSet, sink: &mut dyn Sink) {
        let is_applied = |list: usize| list == self.pages.len() || active.is_active(list as NodeId);
        let applied = (0..self.table.lists()).filter(|&list| is_applied(list));
        let pages: Vec<(usize, &ClusterPage)> = applied.filter_map(|list| Some((list, self.page(list)?))).collect();
        let mut gone: Vec<VertexId> = pages.iter().flat_map(|(_, page)| page.removed.iter().copied()).collect();
        gone.sort_unstable();
        for &(list, page) in &pages {
            let own = self.table.vertices(list);
            let mut gone = &gone[gone.partition_point(|&id| id < own.start)..];
            for (id, vertex) in own.zip(&page.vertices) {
                if gone.first() == Some(&id) {
                    gone = &gone[1..];
                } else {
                    sink.add_vertex(id, self.vertex(list, vertex));
                }
            }
        }
        for &(list, _) in &pages {
            for (cluster, place) in self.table.clusters(list).iter().zip(0..) {
                if cluster.replaced_by == NOBODY || !active.is_active(cluster.replaced_by) {
                    self.add_cluster(list, place, sink);
                }
            }
        }
    }

    fn mesh_of(&self, active: &dyn ActiveSet) -> TriangleMesh {
        let is_applied = |list: usize| list == self.pages.len() || active.is_active(list as NodeId);
        let mut triangles = Vec::new();
        for list in (0..self.table.lists()).filter(|&list| is_applied(list)) {
            let Some(page) = self.page(list) else { continue };
            for cluster in self.table.clusters(list) {
                if cluster.replaced_by == NOBODY || !active.is_active(cluster.replaced_by) {
                    let start = cluster.start as usize;
                    triangles.extend_from_slice(&page.triangles[start..start + usize::from(cluster.len)]);
                }
            }
        }
        let mut ids = triangles.as_flattened().to_vec();
        ids.sort_unstable();
        ids.dedup();
        let mut mesh = TriangleMesh::default();
        let mut hint = self.pages.len();
        for &id in &ids {
            let Some((list, vertex)) = self.find_vertex(id, hint) else { continue };
            hint = list;
            mesh.positions.push(DVec3::from_array(vertex.position_m));
            mesh.normals.push(vertex.normal);
            let [r, g, b] = vertex.colour;
            mesh.colours.push([r, g, b, 255]);
        }
        if mesh.colours.iter().all(|&c| c == [255; 4]) {
            mesh.colours.clear();
        }
        let place = |id: VertexId| ids.partition_point(|&other| other < id) as u32;
        mesh.triangles = triangles.iter().map(|t| t.map(place)).collect();
        mesh
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use yamanami_core::BASE_CLUSTERS;

    /// A square of two triangles, and a node that puts four around its middle.
    fn square() -> (Vec<ClusterNode>, ClusterPage, ClusterPage) {
        let at = |x: f64, y: f64| ClusterVertex { position_m: [x, y, 0.0], normal: [0.0, 0.0, 1.0], colour: [255; 3] };
        let base = ClusterPage {
            group: BASE_CLUSTERS,
            vertices: vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)],
            removed: Vec::new(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        };
        let node = ClusterNode {
            error_m: 0.1,
            bound: Sphere { centre: DVec3::new(0.5, 0.5, 0.0), radius_m: 0.8 },
            level: 0,
            replaced: vec![(BASE_CLUSTERS, 0), (BASE_CLUSTERS, 1)],
            cluster_triangles: vec![3, 1],
            first_vertex: 4,
            vertex_count: 1,
        };
        let page = ClusterPage {
            group: 0,
            vertices: vec![at(0.5, 0.5)],
            removed: Vec::new(),
            triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
        };
        (vec![node], base, page)
    }

    #[test]
    fn a_node_by_hand_is_applied_and_undone() {
        let (nodes, base, page) = square();
        let mut surface = ClusterSurface::new(&nodes, &[1, 1], base).unwrap();
        assert!(!surface.is_resident(0));
        let before = surface.resident_bytes();
        surface.insert(page).unwrap();
        assert!(surface.is_resident(0) && surface.resident_bytes() > before);
        let mut sink = yamanami_core::MeshMirror::default();
        surface.emit_base(&mut sink);
        let empty = sink.clone();
        surface.refine(0, &|_| false, &mut sink);
        assert_eq!(sink.triangles.len(), 4);
        assert_eq!(sink.to_mesh().positions, surface.mesh_of(&|_| true).positions);
        surface.coarsen(0, &|_| true, &mut sink);
        assert_eq!(sink, empty);
        assert!(surface.remove(0).is_some() && surface.remove(0).is_none() && surface.remove(7).is_none());
        assert_eq!(surface.resident_bytes(), before);
    }

    #[test]
    fn what_does_not_fit_together_is_refused_in_one_line() {
        let complaint = |spoil: &dyn Fn(&mut ClusterNode, &mut ClusterPage)| {
            let (mut nodes, base, mut page) = square();
            spoil(&mut nodes[0], &mut page);
            let made = ClusterSurface::new(&nodes, &[1, 1], base);
            made.and_then(|mut s| s.insert(page)).unwrap_err().to_string()
        };
        assert_eq!(complaint(&|n, _| n.first_vertex = 7), "node 0: first vertex: expected 4, given 7");
        assert!(complaint(&|n, _| n.replaced[0].0 = 0).contains("parents below"));
        assert!(complaint(&|n, _| n.replaced[0].1 = 2).contains("clusters of its parent below"));
        assert!(complaint(&|n, _| n.replaced[0].1 = 1).contains("no other node"));
        assert!(complaint(&|n, _| n.replaced.clear()).contains("taken away"));
        assert!(complaint(&|n, _| n.error_m = f32::NAN).contains("not numbers"));
        assert!(complaint(&|_, p| p.triangles[0][0] = 5).contains("corners below"));
        assert!(complaint(&|_, p| p.removed.push(4)).contains("taken away, below"));
        assert!(complaint(&|_, p| p.vertices.clear()).contains("vertices in its page"));
        assert!(complaint(&|_, p| p.group = 3).contains("nodes below"));
    }
}
