//! Which edges of a TIN its breaklines run along.

use glam::DVec3;
use std::collections::{HashMap, HashSet};
use yamanami_core::Tin;

/// What was found of a TIN's breaklines in its mesh.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct LineEdges {
    /// Edges of the mesh, each once, by vertices.
    pub edges: Vec<[u32; 2]>,
    /// Segments of breaklines that are no edges and do not lead along edges from vertex to vertex.
    pub missing: usize,
}

/// A place without the sign of zeros, to compare by.
fn key(p: DVec3) -> [u64; 2] {
    [p.x + 0.0, p.y + 0.0].map(f64::to_bits)
}

/// Share of a segment's length that a vertex on it may be off it, in plan: what writing with few digits does.
const OFF_LINE: f64 = 1e-6;

/// Finds the mesh's edges under the breaklines: a segment's ends are vertices by their place in plan, and between them it
/// may pass through others.
pub fn line_edges(tin: &Tin) -> LineEdges {
    let mut found = LineEdges::default();
    if tin.breaklines.is_empty() {
        return found;
    }
    let positions = &tin.mesh.positions;
    let mut beside: HashMap<u32, Vec<u32>> = HashMap::new();
    let ends: HashSet<[u64; 2]> = tin.breaklines.iter().flat_map(|l| &l.points).map(|&p| key(p)).collect();
    let mut vertex_at: HashMap<[u64; 2], u32> = HashMap::with_capacity(ends.len());
    let mut is_edge: HashSet<(u32, u32)> = HashSet::with_capacity(3 * tin.mesh.triangles.len());
    for &[a, b, c] in &tin.mesh.triangles {
        for (u, v) in [(a, b), (b, c), (c, a)] {
            if is_edge.insert((u.min(v), u.max(v))) {
                beside.entry(u).or_default().push(v);
                beside.entry(v).or_default().push(u);
            }
            let place = key(positions[u as usize]);
            if ends.contains(&place) {
                vertex_at.insert(place, u);
            }
        }
    }
    let mut edges = HashSet::new();
    for line in &tin.breaklines {
        for pair in line.points.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|p| vertex_at.get(&key(p)).copied());
            let (Some(a), Some(b)) = (a, b) else {
                found.missing += usize::from(key(pair[0]) != key(pair[1]));
                continue;
            };
            if a != b && !walk(a, b, positions, &beside, &mut edges) {
                found.missing += 1;
            }
        }
    }
    found.edges = edges.into_iter().map(|(a, b)| [a, b]).collect();
    found.edges.sort_unstable();
    found
}

/// Goes from `a` to `b` over vertices that lie on the segment, and takes the edges; false when there is no such way.
fn walk(a: u32, b: u32, positions: &[DVec3], beside: &HashMap<u32, Vec<u32>>, edges: &mut HashSet<(u32, u32)>) -> bool {
    let p = |v: u32| positions[v as usize];
    let whole = p(b) - p(a);
    let length2 = whole.x * whole.x + whole.y * whole.y;
    let along = |v: u32| {
        let d = p(v) - p(a);
        let t = (d.x * whole.x + d.y * whole.y) / length2;
        let off = (d.x * whole.y - d.y * whole.x).abs() / length2;
        (t, off)
    };
    let (mut at, mut passed, mut way) = (a, 0.0, Vec::new());
    while at != b {
        let nexts = beside.get(&at).into_iter().flatten();
        let on_line = nexts.map(|&v| (along(v), v)).filter(|&((t, off), _)| t > passed && t <= 1.0 && off <= OFF_LINE);
        let Some(((t, _), next)) = on_line.min_by(|x, y| x.0.0.total_cmp(&y.0.0)) else { return false };
        way.push((at.min(next), at.max(next)));
        (at, passed) = (next, t);
    }
    edges.extend(way);
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use yamanami_core::{Breakline, BreaklineKind, TriangleMesh};

    #[test]
    fn a_segment_may_pass_through_vertices() {
        let at = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let mesh = TriangleMesh::new(
            vec![at(0.0, 0.0), at(1.0, 0.0), at(2.0, 0.0), at(1.0, 1.0), at(1.0, -1.0)],
            vec![[0, 1, 3], [1, 2, 3], [0, 4, 1], [1, 4, 2]],
        );
        let mut tin = Tin::of_mesh("", mesh);
        let line = |points: Vec<DVec3>| Breakline { name: String::new(), kind: BreaklineKind::Hard, points };
        tin.breaklines = vec![line(vec![at(0.0, 0.0), at(2.0, 0.0)]), line(vec![at(3.0, 3.0), at(0.0, 0.0)])];
        assert_eq!(line_edges(&tin), LineEdges { edges: vec![[0, 1], [1, 2]], missing: 1 });
    }
}
