//! The laws of a terrain mesh: no crack, no T-vertex, no flipped triangle.
//!
//! Vertices at equal positions are one vertex here, so a mesh without shared indices is judged fairly. A crack whose
//! sides meet in plan shows as T-vertices or, where the heights differ, as further border loops.

use crate::places::{places, used};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use yamanami_core::TriangleMesh;

/// A vertex this close to an edge, relative to the edge's length, lies on it; wide enough for single-precision files.
const ON_EDGE_RELATIVE: f64 = 1e-5;
/// A triangle whose height is below this part of its longest side has no area.
const FLAT_RELATIVE: f64 = 1e-12;

/// How well a mesh keeps the laws of a terrain mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct ConformityReport {
    /// Triangles of the mesh.
    pub triangles: usize,
    /// Different positions used by triangles.
    pub vertices: usize,
    /// Edges with one triangle: the mesh's border, the borders of its holes, and the sides of cracks.
    pub open_edges: usize,
    /// Connected runs of open edges: 1 for a terrain without holes.
    pub border_loops: usize,
    /// Vertices that lie, in plan, strictly inside an open edge.
    pub t_vertices: usize,
    /// Edges with more than two triangles.
    pub non_manifold_edges: usize,
    /// Edges whose two triangles run along them in the same direction: one of them faces the other way.
    pub inconsistent_edges: usize,
    /// Triangles without area in plan.
    pub degenerate: usize,
    /// Triangles that are clockwise seen from above.
    pub flipped: usize,
}

impl ConformityReport {
    /// Whether all laws are kept. Open edges and border loops are no fault in themselves: see
    /// [`Self::border_loops`].
    pub fn is_conforming(&self) -> bool {
        let faults = [
            self.t_vertices,
            self.non_manifold_edges,
            self.inconsistent_edges,
            self.degenerate,
            self.flipped,
        ];
        faults == [0; 5]
    }
}

impl std::fmt::Display for ConformityReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{} triangles, {} vertices, {} open edges in {} loops; faults: {} T-vertices, {} non-manifold edges, \
             {} inconsistent edges, {} degenerate, {} flipped",
            self.triangles,
            self.vertices,
            self.open_edges,
            self.border_loops,
            self.t_vertices,
            self.non_manifold_edges,
            self.inconsistent_edges,
            self.degenerate,
            self.flipped
        )
    }
}

/// Checks a terrain mesh (z up, counter-clockwise from above) against the laws.
///
/// # Panics
/// When a triangle names a vertex that the mesh does not have.
pub fn conformity(mesh: &TriangleMesh) -> ConformityReport {
    let vertex = places(mesh);
    let (degenerate, flipped) = turns(mesh);
    let mut report = ConformityReport {
        triangles: mesh.triangles.len(),
        vertices: used(mesh, &vertex),
        degenerate,
        flipped,
        ..ConformityReport::default()
    };
    // one number an edge: lower vertex, higher vertex, and in the last bit the direction
    let mut edges: Vec<(u64, bool)> = mesh
        .triangles
        .par_iter()
        .flat_map_iter(|t| {
            let [a, b, c] = t.map(|i| vertex[i as usize]);
            [[a, b], [b, c], [c, a]]
        })
        .filter(|[p, q]| p != q)
        .map(|[p, q]| ((u64::from(p.min(q)) << 32) | u64::from(p.max(q)), p < q))
        .collect();
    edges.par_sort_unstable();
    let mut open = Vec::new();
    for same in edges.chunk_by(|a, b| a.0 == b.0) {
        match same {
            [(edge, _)] => open.push([(edge >> 32) as u32, *edge as u32]),
            [(_, first), (_, second)] => report.inconsistent_edges += usize::from(first == second),
            _ => report.non_manifold_edges += 1,
        }
    }
    report.open_edges = open.len();
    report.border_loops = connected_runs(&open);
    report.t_vertices = t_vertices(mesh, &open);
    report
}

/// Numbers of degenerate and of clockwise triangles.
fn turns(mesh: &TriangleMesh) -> (usize, usize) {
    let turn = |t: usize| {
        let [a, b, c] = mesh.corners(t).map(DVec3::truncate);
        let area = (b - a).perp_dot(c - a);
        let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        match area {
            _ if area > FLAT_RELATIVE * longest => (0, 0),
            _ if area < -FLAT_RELATIVE * longest => (0, 1),
            _ => (1, 0),
        }
    };
    (0..mesh.triangles.len()).into_par_iter().map(turn).reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1))
}

/// Connected components of a set of edges.
pub(crate) fn connected_runs(edges: &[[u32; 2]]) -> usize {
    let mut ends: Vec<u32> = edges.iter().flatten().copied().collect();
    ends.sort_unstable();
    ends.dedup();
    let place = |v: u32| ends.partition_point(|&e| e < v);
    let mut parent: Vec<usize> = (0..ends.len()).collect();
    fn root(parent: &mut [usize], mut i: usize) -> usize {
        while parent[i] != i {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        i
    }
    let mut runs = ends.len();
    for &[p, q] in edges {
        let (p, q) = (root(&mut parent, place(p)), root(&mut parent, place(q)));
        if p != q {
            parent[p.max(q)] = p.min(q);
            runs -= 1;
        }
    }
    runs
}

/// Vertices strictly inside an open edge, in plan. Only ends of open edges can be: any other is closed all round.
fn t_vertices(mesh: &TriangleMesh, open: &[[u32; 2]]) -> usize {
    let plan = |v: u32| mesh.positions[v as usize].truncate();
    let mut ends: Vec<u32> = open.iter().flatten().copied().collect();
    ends.sort_unstable();
    ends.dedup();
    // two orders, so that an edge along either axis has a short list of candidates
    let sorted_by = |axis: usize| {
        let mut order = ends.clone();
        order.par_sort_unstable_by(|&a, &b| plan(a)[axis].total_cmp(&plan(b)[axis]));
        order
    };
    let by_axis = [sorted_by(0), sorted_by(1)];
    let mut inside: Vec<u32> = open
        .par_iter()
        .flat_map_iter(|&[p, q]| {
            let (from, to) = (plan(p), plan(q));
            let near = ON_EDGE_RELATIVE * from.distance(to);
            let range = |axis: usize| {
                let (low, high) = (from[axis].min(to[axis]) - near, from[axis].max(to[axis]) + near);
                let first = by_axis[axis].partition_point(|&v| plan(v)[axis] < low);
                first..by_axis[axis].partition_point(|&v| plan(v)[axis] <= high).max(first)
            };
            let (x, y) = (range(0), range(1));
            let candidates = if x.len() < y.len() { &by_axis[0][x] } else { &by_axis[1][y] };
            candidates.iter().copied().filter(move |&v| lies_inside(plan(v), from, to, near))
        })
        .collect();
    inside.par_sort_unstable();
    inside.dedup();
    inside.len()
}

/// Whether a point is within `near` of the segment and farther than that from both its ends.
fn lies_inside(point: DVec2, from: DVec2, to: DVec2, near: f64) -> bool {
    let along = to - from;
    let length = along.length();
    if length == 0.0 {
        return false;
    }
    let at = (point - from).dot(along) / length;
    at > near && at < length - near && along.perp_dot(point - from).abs() <= near * length
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> TriangleMesh {
        TriangleMesh {
            positions: points.iter().map(|&p| p.into()).collect(),
            triangles: triangles.to_vec(),
            ..TriangleMesh::default()
        }
    }

    const SQUARE: [[f64; 3]; 4] = [[0.0, 0.0, 1.0], [10.0, 0.0, 2.0], [10.0, 10.0, 3.0], [0.0, 10.0, 4.0]];

    #[test]
    fn a_square_of_two_triangles_keeps_the_laws() {
        let report = conformity(&mesh(&SQUARE, &[[0, 1, 2], [0, 2, 3]]));
        assert!(report.is_conforming(), "{report}");
        assert_eq!((report.vertices, report.open_edges, report.border_loops), (4, 4, 1));
    }

    #[test]
    fn a_t_vertex_is_found_even_when_its_height_fits() {
        let mut points = SQUARE.to_vec();
        points.push([5.0, 5.0, 2.0]);
        let report = conformity(&mesh(&points, &[[0, 1, 4], [1, 2, 4], [0, 2, 3]]));
        assert_eq!((report.t_vertices, report.open_edges), (1, 7), "{report}");
        assert!(!report.is_conforming());
    }

    #[test]
    fn a_closed_fan_has_no_t_vertex() {
        let mut points = SQUARE.to_vec();
        points.push([5.0, 5.0, 2.0]);
        let report = conformity(&mesh(&points, &[[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]));
        assert!(report.is_conforming() && report.border_loops == 1, "{report}");
    }

    #[test]
    fn vertices_at_one_place_are_one_vertex() {
        let split = [SQUARE[0], SQUARE[1], SQUARE[2], [-0.0, 0.0, 1.0], SQUARE[2], SQUARE[3]];
        let report = conformity(&mesh(&split, &[[0, 1, 2], [3, 4, 5]]));
        assert_eq!((report.vertices, report.open_edges), (4, 4));
        let mut wall = split;
        wall[3][2] = 1.5;
        assert_eq!(conformity(&mesh(&wall, &[[0, 1, 2], [3, 4, 5]])).open_edges, 6);
    }

    #[test]
    fn flipped_flat_and_crowded_triangles_are_counted() {
        let report = conformity(&mesh(&SQUARE, &[[0, 1, 2], [0, 3, 2], [0, 0, 1]]));
        assert_eq!((report.flipped, report.degenerate, report.inconsistent_edges), (1, 1, 1), "{report}");
        let report = conformity(&mesh(&SQUARE, &[[0, 1, 2], [0, 2, 3], [0, 2, 1]]));
        assert_eq!(report.non_manifold_edges, 1, "{report}");
    }

    #[test]
    fn a_hole_is_a_second_loop_and_no_fault() {
        let n = 5u32;
        let points: Vec<_> = (0..n * n).map(|k| [f64::from(k % n), f64::from(k / n), 0.0]).collect();
        let mut triangles = Vec::new();
        for (i, j) in (0..n - 1).flat_map(|j| (0..n - 1).map(move |i| (i, j))).filter(|&c| c != (1, 1)) {
            let a = j * n + i;
            triangles.extend([[a, a + 1, a + n + 1], [a, a + n + 1, a + n]]);
        }
        let report = conformity(&mesh(&points, &triangles));
        assert!(report.is_conforming(), "{report}");
        assert_eq!((report.open_edges, report.border_loops), (20, 2));
    }
}
