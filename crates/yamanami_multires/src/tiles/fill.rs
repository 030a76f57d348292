//! What lies outside the terrain in a tile: level ground between the terrain's rim and the tile's sides, of points dense
//! enough for the globe's curvature.
//!
//! Based on: Chew, "Constrained Delaunay triangulations", 1989; the triangulation is the `spade` crate's.

use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation, handles::FixedVertexHandle};
use std::collections::{HashMap, HashSet};

/// A vertex of the tile's mesh on its lattice.
#[derive(Debug, Clone, Copy)]
struct Node {
    place: Point2<f64>,
    vertex: u32,
}

impl HasPosition for Node {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.place
    }
}

/// Edges of a mesh that no other triangle has the other way round, as they run.
pub(super) fn open_edges(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let edges = || triangles.iter().flat_map(|t| (0..3).map(|k| [t[k], t[(k + 1) % 3]]));
    let all: HashSet<[u32; 2]> = edges().collect();
    edges().filter(|&[a, b]| !all.contains(&[b, a])).collect()
}

/// Triangulates what lies on the outer side of `open` edges that `is_outer`, up to the hull of all vertices. `places` are
/// those of all vertices, `free` the numbers of more vertices; those of `seeds` lie outside in any case.
pub(super) fn fill(
    places: &[[u16; 2]],
    open: &[[u32; 2]],
    is_outer: impl Fn([u32; 2]) -> bool,
    free: &[u32],
    seeds: &[u32],
) -> Vec<[u32; 3]> {
    let mut cdt = ConstrainedDelaunayTriangulation::<Node>::new();
    let mut handles: HashMap<u32, FixedVertexHandle> = HashMap::new();
    for &vertex in open.iter().flatten().chain(free) {
        if handles.contains_key(&vertex) {
            continue;
        }
        let [u, v] = places[vertex as usize].map(f64::from);
        // whole numbers up to 32767 are always taken
        if let Ok(handle) = cdt.insert(Node { place: Point2::new(u, v), vertex }) {
            handles.insert(vertex, handle);
        }
    }
    for [a, b] in open {
        let (a, b) = (handles[a], handles[b]);
        if a != b && cdt.can_add_constraint(a, b) {
            cdt.add_constraint(a, b);
        }
    }
    let mut waiting = Vec::new();
    for &[a, b] in open.iter().filter(|&&edge| is_outer(edge)) {
        // the ground lies left of its edges, the fill right of them
        if let Some(edge) = cdt.get_edge_from_neighbors(handles[&b], handles[&a]) {
            waiting.extend(edge.face().as_inner().map(|face| face.fix()));
        }
    }
    for seed in seeds {
        let around = cdt.vertex(handles[seed]).out_edges();
        waiting.extend(around.filter_map(|edge| edge.face().as_inner().map(|face| face.fix())));
    }
    let mut seen = HashSet::new();
    while let Some(face) = waiting.pop() {
        if !seen.insert(face) {
            continue;
        }
        for edge in cdt.face(face).adjacent_edges() {
            if !cdt.is_constraint_edge(edge.as_undirected().fix()) {
                waiting.extend(edge.rev().face().as_inner().map(|face| face.fix()));
            }
        }
    }
    // in the triangulation's own order, which does not depend on the set's
    let inner = cdt.inner_faces().filter(|face| seen.contains(&face.fix()));
    inner.map(|face| face.vertices().map(|v| v.data().vertex)).collect()
}
