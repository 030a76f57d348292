//! The open border of a tile's mesh, and how far it is from that of a neighbour.
//!
//! A tile of a scan has no straight sides. Two borders that should meet are told from two that merely begin near each other
//! by the direction in which the nearest point lies: across the border, not along it.

use glam::DVec3;
use std::collections::HashMap;
use yamanami_core::{Aabb, TriangleMesh};

/// Points looked at along an edge, its ends included.
const POINTS: usize = 3;

/// Across rather than along: the sine of the angle between the border and the way to the other.
const ACROSS: f64 = 0.9;

/// The edges of a mesh that only one triangle has.
#[derive(Debug, Clone, Default)]
pub struct OpenEdges {
    edges: Vec<[DVec3; 2]>,
    cells: HashMap<[i32; 3], Vec<u32>>,
    cell_m: f64,
    bounds: Option<Aabb>,
}

/// How far two borders gape.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct SeamGap {
    /// Greatest distance in metres of a point of one border to the other, where they face each other.
    pub max_m: f64,
    /// Where it is.
    pub at: DVec3,
    /// Points that face the other border.
    pub points: usize,
}

impl OpenEdges {
    /// Of a mesh. Vertices at one place, to `weld_m`, are one, so that seams of normals do not count.
    pub fn new(mesh: &TriangleMesh, weld_m: f64) -> Self {
        let key = |p: DVec3| (p / weld_m.max(1e-9)).round().to_array().map(|v| v as i64);
        let mut ways: HashMap<[[i64; 3]; 2], (i32, [DVec3; 2])> = HashMap::new();
        for t in 0..mesh.triangles.len() {
            let corners = mesh.corners(t);
            for k in 0..3 {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                let (ka, kb) = (key(a), key(b));
                if ka != kb {
                    let (pair, way) = if ka < kb { ([ka, kb], 1) } else { ([kb, ka], -1) };
                    ways.entry(pair).or_insert((0, [a, b])).0 += way;
                }
            }
        }
        let mut open: Vec<_> = ways.into_iter().filter(|(_, (way, _))| *way != 0).collect();
        // the order of a hash map must not show
        open.sort_by_key(|(pair, _)| *pair);
        let edges: Vec<[DVec3; 2]> = open.into_iter().map(|(_, (_, edge))| edge).collect();
        let mut bounds = Aabb::EMPTY;
        edges.iter().flatten().for_each(|&p| bounds.include(p));
        let mean = edges.iter().map(|[a, b]| a.distance(*b)).sum::<f64>() / edges.len().max(1) as f64;
        let mut found =
            Self { cell_m: mean.max(1e-6) * 2.0, bounds: (!edges.is_empty()).then_some(bounds), ..Self::default() };
        for (number, [a, b]) in edges.iter().enumerate() {
            let steps = ((a.distance(*b) / found.cell_m).ceil() as usize).clamp(1, 1 << 12);
            for step in 0..=steps {
                let cell = found.cell(a.lerp(*b, step as f64 / steps as f64));
                let list = found.cells.entry(cell).or_default();
                if list.last() != Some(&(number as u32)) {
                    list.push(number as u32);
                }
            }
        }
        found.edges = edges;
        found
    }

    /// Edges there are.
    pub fn len(&self) -> usize {
        self.edges.len()
    }

    /// Whether the mesh is closed.
    pub fn is_empty(&self) -> bool {
        self.edges.is_empty()
    }

    fn cell(&self, p: DVec3) -> [i32; 3] {
        (p / self.cell_m).floor().to_array().map(|v| v as i32)
    }

    /// The point of these edges nearest to a place, within `reach_m`.
    fn closest(&self, p: DVec3, reach_m: f64) -> Option<DVec3> {
        let mut best: Option<(f64, DVec3)> = None;
        let most = (reach_m / self.cell_m).ceil().min(8.0) as i32 + 1;
        let [x, y, z] = self.cell(p);
        for ring in 0..=most {
            // all that lies nearer than the next ring was seen
            if best.is_some_and(|(d, _)| d <= f64::from(ring - 1) * self.cell_m) {
                break;
            }
            let shell = |dx: i32, dy: i32, dz: i32| dx.abs().max(dy.abs()).max(dz.abs()) == ring;
            for dx in -ring..=ring {
                for dy in -ring..=ring {
                    for dz in -ring..=ring {
                        if !shell(dx, dy, dz) {
                            continue;
                        }
                        for &k in self
                            .cells
                            .get(&[x.wrapping_add(dx), y.wrapping_add(dy), z.wrapping_add(dz)])
                            .into_iter()
                            .flatten()
                        {
                            let [a, b] = self.edges[k as usize];
                            let along = ((p - a).dot(b - a) / (b - a).length_squared().max(1e-300)).clamp(0.0, 1.0);
                            let q = a.lerp(b, along);
                            let d = p.distance(q);
                            if d <= reach_m && best.is_none_or(|(least, _)| d < least) {
                                best = Some((d, q));
                            }
                        }
                    }
                }
            }
        }
        best.map(|(_, q)| q)
    }

    /// The greatest distance of this border to another, where that one lies across from it within `reach_m`.
    pub fn gap_to(&self, other: &Self, reach_m: f64) -> SeamGap {
        let mut gap = SeamGap::default();
        let Some(bounds) = other.bounds else { return gap };
        let (low, high) = (bounds.min - reach_m, bounds.max + reach_m);
        for &[a, b] in &self.edges {
            let way = (b - a).normalize_or_zero();
            for k in 0..POINTS {
                let p = a.lerp(b, k as f64 / (POINTS - 1) as f64);
                if !(p.cmpge(low).all() && p.cmple(high).all()) {
                    continue;
                }
                let Some(q) = other.closest(p, reach_m) else { continue };
                let d = p.distance(q);
                if way.cross(q - p).length() < ACROSS * d {
                    continue;
                }
                gap.points += 1;
                if d > gap.max_m {
                    (gap.max_m, gap.at) = (d, p);
                }
            }
        }
        gap
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strip(x0: f64, lift: f64) -> TriangleMesh {
        let at = |x: f64, y: f64| DVec3::new(x0 + x, y, if x == 0.0 { lift } else { 0.0 });
        let positions = (0..5).flat_map(|y| [at(0.0, f64::from(y)), at(1.0, f64::from(y))]).collect();
        let triangles =
            (0..4u32).flat_map(|k| [[2 * k, 2 * k + 1, 2 * k + 3], [2 * k, 2 * k + 3, 2 * k + 2]]).collect();
        TriangleMesh::new(positions, triangles)
    }

    #[test]
    fn borders_that_meet_do_not_gape_and_lifted_ones_do() {
        let left = OpenEdges::new(&strip(0.0, 0.0), 1e-6);
        assert_eq!(left.len(), 10);
        let right = OpenEdges::new(&strip(1.0, 0.0), 1e-6);
        let gap = left.gap_to(&right, 0.4);
        assert!(gap.max_m == 0.0 && gap.points >= 5, "{gap:?}");
        let lifted = OpenEdges::new(&strip(1.0, 0.3), 1e-6);
        assert!((left.gap_to(&lifted, 0.4).max_m - 0.3).abs() < 1e-12);
    }
}
