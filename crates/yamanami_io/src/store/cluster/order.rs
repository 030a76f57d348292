//! An order of triangles and vertices in which pages take fewer bytes.

use super::triangles::{Border, turned};
use std::collections::HashMap;
use yamanami_core::{BASE_CLUSTERS, ClusterNode, ClusterPage, VertexId};

/// Puts the triangles of each cluster in an order in which one shares an edge with another before it, and a page's
/// vertices in the order in which its triangles use them. It is the same surface under other numbers. `base_clusters` has
/// the triangles in each cluster of the base mesh; pages come in the order of their nodes, the base mesh's apart.
///
/// Pages that do not fit their nodes stay as they are.
pub fn put_in_order(nodes: &[ClusterNode], base_clusters: &[u16], base: &mut ClusterPage, pages: &mut [ClusterPage]) {
    let own_base = base.vertices.len();
    let count = nodes.iter().map(|n| n.vertex_count as usize).sum::<usize>() + own_base;
    if nodes.len() != pages.len() || u32::try_from(count).is_err() {
        return;
    }
    let mut new_id: Vec<VertexId> = (0..count as u32).collect();
    let base_order = order(base, base_clusters, 0);
    let groups = std::iter::once((0, base_order, &mut *base));
    let rest = nodes.iter().zip(pages.iter_mut()).map(|(node, page)| {
        let order = order(page, &node.cluster_triangles, node.first_vertex);
        (node.first_vertex, order, page)
    });
    for (first, order, page) in groups.chain(rest) {
        let Some(order) = order else { continue };
        page.triangles = order.triangles;
        let old = std::mem::take(&mut page.vertices);
        for (place, &from) in order.vertices.iter().enumerate() {
            page.vertices.push(old[from as usize]);
            new_id[(first + from) as usize] = first + place as u32;
        }
    }
    let renumber = |id: &mut VertexId| *id = new_id.get(*id as usize).copied().unwrap_or(*id);
    for page in std::iter::once(base).chain(pages) {
        page.triangles.as_flattened_mut().iter_mut().for_each(renumber);
        page.removed.iter_mut().for_each(renumber);
        page.removed.sort_unstable();
    }
}

/// A page's triangles in their new order, with the old numbers, and its vertices: the old place of each.
struct Order {
    triangles: Vec<[VertexId; 3]>,
    vertices: Vec<u32>,
}

fn order(page: &ClusterPage, clusters: &[u16], first: VertexId) -> Option<Order> {
    let own = page.vertices.len() as u32;
    let total: usize = clusters.iter().map(|&n| usize::from(n)).sum();
    if total != page.triangles.len() || (page.group == BASE_CLUSTERS && first != 0) {
        return None;
    }
    let mut border = Border::new(own);
    let mut triangles = Vec::with_capacity(total);
    let mut others: HashMap<VertexId, u32> = HashMap::new();
    let mut names: Vec<VertexId> = Vec::new();
    let mut rest = page.triangles.as_slice();
    for &len in clusters {
        let (cluster, later) = rest.split_at(usize::from(len));
        rest = later;
        let local: Vec<[u32; 3]> = cluster
            .iter()
            .map(|corners| {
                corners.map(|id| match id.checked_sub(first) {
                    Some(place) if place < own => place,
                    _ => *others.entry(id).or_insert_with(|| {
                        names.push(id);
                        border.add_other()
                    }),
                })
            })
            .collect();
        walk(&local, &mut border, |_, corners| {
            triangles.push(corners.map(|v| if v < own { first + v } else { names[(v - own) as usize] }));
        });
    }
    border.place_rest();
    Some(Order { triangles, vertices: border.placings.iter().map(|p| p.vertex).collect() })
}

/// Visits a cluster's triangles, each turned to begin with the edge that it is glued to.
pub(super) fn walk(cluster: &[[u32; 3]], border: &mut Border, mut visit: impl FnMut(usize, [u32; 3])) {
    let mut at_edge: HashMap<(u32, u32), usize> = HashMap::with_capacity(3 * cluster.len());
    for (i, &[a, b, c]) in cluster.iter().enumerate() {
        for edge in [(a, b), (b, c), (c, a)] {
            at_edge.entry(edge).or_insert(i);
        }
    }
    let mut left = vec![true; cluster.len()];
    let mut first_left = 0;
    loop {
        let found = border.gates().zip(0..).find_map(|(gate, passed)| {
            let &i = at_edge.get(&(gate.from, gate.to)).filter(|&&i| left[i])?;
            turned(cluster[i], gate).map(|(_, corners)| (passed, i, corners, gate.across))
        });
        let (i, corners) = if let Some((passed, i, corners, across)) = found {
            border.reach(passed);
            border.place(corners, across);
            (i, corners)
        } else {
            while first_left < left.len() && !left[first_left] {
                first_left += 1;
            }
            let Some(&corners) = cluster.get(first_left) else { return };
            border.place_one_by_one(corners);
            (first_left, corners)
        };
        border.add(corners);
        left[i] = false;
        visit(i, corners);
    }
}
