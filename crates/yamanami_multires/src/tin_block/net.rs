//! A triangulated network in which the surroundings of a triangle are taken out and fanned anew from one point.
//!
//! Based on: Hiraoka, Yamada, Urahama, "A fast drawing method of TINs for three-dimensional GIS" (三次元GISのためのTINの高速描画法),
//! APA, 2005, figure 1. The new point takes the number of one that goes, so that nothing grows.

use crate::collapse::stars::{Corner, Stars};
use glam::DVec3;
use yamanami_core::TriangleMesh;

const NONE: u32 = u32::MAX;

/// Share of the products' sum by which a turn must be to the left: far above what rounding can do to it, so that the sign is
/// certain and no triangle is as thin as that.
const CERTAIN: f64 = 1e-7;

/// A network that loses triangles. Numbers of triangles and vertices are slots, used again.
#[derive(Debug)]
pub(super) struct Net {
    positions: Vec<DVec3>,
    corners: Vec<[u32; 3]>,
    stars: Stars,
    slope: Vec<f64>,
    /// Sum of the slopes around each vertex.
    around: Vec<f64>,
    is_fixed: Vec<bool>,
    live: usize,
}

impl Net {
    /// Takes a mesh whose corners are in range. Vertices whose triangles do not close around them are fixed.
    pub(super) fn new(mesh: &TriangleMesh) -> Self {
        let vertices = mesh.positions.len();
        let mut net = Self {
            positions: mesh.positions.clone(),
            corners: mesh.triangles.clone(),
            stars: Stars::new(&mesh.triangles, vertices),
            slope: (0..mesh.triangles.len()).map(|t| slope_of(mesh.corners(t))).collect(),
            around: Vec::new(),
            is_fixed: Vec::new(),
            live: mesh.triangles.len(),
        };
        net.around = (0..vertices as u32).map(|v| net.slope_around(v)).collect();
        net.is_fixed = (0..vertices as u32).map(|v| !net.is_closed_around(v)).collect();
        net
    }

    /// Triangles left.
    pub(super) fn len(&self) -> usize {
        self.live
    }

    /// Numbers of the triangles left.
    pub(super) fn triangles(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.corners.len() as u32).filter(|&t| self.corners[t as usize][0] != NONE)
    }

    /// What is left, in the order of the slots.
    pub(super) fn to_mesh(&self) -> TriangleMesh {
        let mut number = vec![NONE; self.positions.len()];
        let mut positions = Vec::new();
        for (v, &p) in self.positions.iter().enumerate() {
            if !self.stars.of(v as u32).is_empty() {
                number[v] = positions.len() as u32;
                positions.push(p);
            }
        }
        let triangles = self.triangles().map(|t| self.corners[t as usize].map(|v| number[v as usize])).collect();
        TriangleMesh::new(positions, triangles)
    }

    /// Whether the surroundings of a triangle may go: those with a vertex of the border must stay.
    pub(super) fn is_free(&self, t: u32) -> bool {
        self.corners[t as usize].iter().all(|&v| !self.is_fixed[v as usize])
    }

    /// The triangles that share a vertex with a free one, it included.
    pub(super) fn surroundings(&self, t: u32, ring: &mut Vec<u32>) {
        ring.clear();
        let [a, b, c] = self.corners[t as usize];
        ring.extend(self.triangles_at(a));
        ring.extend(self.triangles_at(b).filter(|&u| !self.corners[u as usize].contains(&a)));
        ring.extend(self.triangles_at(c).filter(|&u| {
            let corners = self.corners[u as usize];
            !corners.contains(&a) && !corners.contains(&b)
        }));
    }

    /// Sum of the slopes of a free triangle's surroundings, and their number. As stars close around its corners, it is in
    /// three of them and each neighbour over an edge in two: nothing else is counted twice, however large the stars are.
    pub(super) fn slope_sum(&self, t: u32) -> (f64, usize) {
        let corners = self.corners[t as usize];
        let stars: usize = corners.iter().map(|&v| self.stars.of(v).len()).sum();
        let sum: f64 = corners.iter().map(|&v| self.around[v as usize]).sum();
        let edges = [0, 1, 2].map(|k| [corners[k], corners[(k + 1) % 3]]);
        let beyond: f64 = edges.iter().map(|&edge| self.beyond(t, edge).map_or(0.0, |u| self.slope[u as usize])).sum();
        (sum - 2.0 * self.slope[t as usize] - beyond, stars - 5)
    }

    /// The neighbour over an edge.
    fn beyond(&self, t: u32, [a, b]: [u32; 2]) -> Option<u32> {
        let (few, other) = if self.stars.of(a).len() <= self.stars.of(b).len() { (a, b) } else { (b, a) };
        self.triangles_at(few).find(|&u| u != t && self.corners[u as usize].contains(&other))
    }

    fn slope_around(&self, v: u32) -> f64 {
        self.triangles_at(v).map(|t| self.slope[t as usize]).sum()
    }

    /// Root mean square distance in height of the vertices in and around a hole from the plane that fits them best, metres.
    pub(super) fn plane_deviation_m(&self, t: u32, ring: &[u32]) -> f64 {
        let middle = self.centroid(t);
        let corners = self.corners[t as usize];
        let mut n = 0.0;
        let mut sum = DVec3::ZERO;
        let [mut xx, mut xy, mut yy, mut xz, mut yz, mut zz] = [0.0; 6];
        // each vertex of the hole's border begins one of its edges
        let around = ring.iter().filter_map(|&u| self.edge_away_from(u, corners)).map(|[from, _]| from);
        for v in corners.into_iter().chain(around) {
            let p = self.positions[v as usize] - middle;
            n += 1.0;
            sum += p;
            xx += p.x * p.x;
            xy += p.x * p.y;
            yy += p.y * p.y;
            xz += p.x * p.z;
            yz += p.y * p.z;
            zz += p.z * p.z;
        }
        let mean = sum / n;
        xx -= n * mean.x * mean.x;
        xy -= n * mean.x * mean.y;
        yy -= n * mean.y * mean.y;
        xz -= n * mean.x * mean.z;
        yz -= n * mean.y * mean.z;
        zz -= n * mean.z * mean.z;
        let det = xx * yy - xy * xy;
        let explained = if det > 0.0 { (yy * xz * xz - 2.0 * xy * xz * yz + xx * yz * yz) / det } else { 0.0 };
        ((zz - explained).max(0.0) / n).sqrt()
    }

    /// Where the new point comes when `t` and its surroundings go.
    pub(super) fn centroid(&self, t: u32) -> DVec3 {
        let [a, b, c] = self.places(t);
        (a + b + c) / 3.0
    }

    /// The border, counter-clockwise, of the polygon that the surroundings of `t` leave, where it is simple and seen whole from the centroid of `t`.
    pub(super) fn hole(&self, t: u32, ring: &[u32]) -> Option<Vec<u32>> {
        let corners = self.corners[t as usize];
        let mut edges: Vec<[u32; 2]> = ring.iter().filter_map(|&u| self.edge_away_from(u, corners)).collect();
        edges.sort_unstable();
        // what two triangles of the surroundings share is no border
        let all = edges.clone();
        edges.retain(|&[a, b]| all.binary_search(&[b, a]).is_err());
        let hole = round_of(&edges)?;
        let middle = self.centroid(t);
        let is_left = |i: usize| {
            let [a, b] = [hole[i], hole[(i + 1) % hole.len()]].map(|v| self.positions[v as usize] - middle);
            let (plus, minus) = (a.x * b.y, a.y * b.x);
            plus - minus > CERTAIN * (plus.abs() + minus.abs())
        };
        (0..hole.len()).all(is_left).then_some(hole)
    }

    /// Takes the surroundings of `t` out and fans the hole from its centroid; gives the new triangles.
    pub(super) fn fan(&mut self, t: u32, ring: &[u32], hole: &[u32]) -> Vec<u32> {
        let point = self.centroid(t);
        let new = self.corners[t as usize][0];
        let gone: Vec<u32> = ring.iter().flat_map(|&u| self.corners[u as usize]).collect();
        for &u in ring {
            self.corners[u as usize] = [NONE; 3];
        }
        let mut on_hole = hole.to_vec();
        on_hole.sort_unstable();
        for v in gone.into_iter().filter(|v| on_hole.binary_search(v).is_err()) {
            self.stars.set(v, &[]);
        }
        self.positions[new as usize] = point;
        // each edge of the hole belonged to a triangle that went, so there are slots enough
        let made: Vec<u32> = ring[..hole.len()].to_vec();
        let mut star = Vec::new();
        for (i, &v) in hole.iter().enumerate() {
            let before = made[(i + made.len() - 1) % made.len()];
            star.clear();
            star.extend(self.stars.of(v).iter().filter(|corner| self.corners[corner.triangle()][0] != NONE));
            star.extend([Corner::new(before as usize, 1), Corner::new(made[i] as usize, 0)]);
            self.stars.set(v, &star);
        }
        star.clear();
        for (i, &slot) in made.iter().enumerate() {
            self.corners[slot as usize] = [hole[i], hole[(i + 1) % hole.len()], new];
            self.slope[slot as usize] = slope_of(self.places(slot));
            star.push(Corner::new(slot as usize, 2));
        }
        self.stars.set(new, &star);
        for &v in hole.iter().chain([&new]) {
            self.around[v as usize] = self.slope_around(v);
        }
        self.live -= ring.len() - hole.len();
        made
    }

    /// The triangles at a vertex.
    pub(super) fn triangles_at(&self, v: u32) -> impl Iterator<Item = u32> + '_ {
        self.stars.of(v).iter().map(|corner| corner.triangle() as u32)
    }

    pub(super) fn places(&self, t: u32) -> [DVec3; 3] {
        self.corners[t as usize].map(|v| self.positions[v as usize])
    }

    /// The edge of `u` opposite to its one corner among `corners`; `None` where it has more than one.
    fn edge_away_from(&self, u: u32, corners: [u32; 3]) -> Option<[u32; 2]> {
        let own = self.corners[u as usize];
        let mut shared = (0..3).filter(|&k| corners.contains(&own[k]));
        match (shared.next(), shared.next()) {
            (Some(k), None) => Some([own[(k + 1) % 3], own[(k + 2) % 3]]),
            _ => None,
        }
    }

    /// Whether the triangles at a vertex are one closed round.
    fn is_closed_around(&self, v: u32) -> bool {
        let edge = |corner: &Corner| {
            let [_, from, to] = corner.turned(&self.corners);
            [from, to]
        };
        let mut edges: Vec<[u32; 2]> = self.stars.of(v).iter().map(edge).collect();
        edges.sort_unstable();
        round_of(&edges).is_some()
    }
}

/// The vertices of sorted edges that make one closed round and pass each vertex once, in its order.
fn round_of(edges: &[[u32; 2]]) -> Option<Vec<u32>> {
    let [first, mut at] = *edges.first()?;
    let mut round = vec![first];
    while at != first && round.len() < edges.len() {
        round.push(at);
        let i = edges.partition_point(|edge| edge[0] < at);
        let is_one = edges.get(i + 1).is_none_or(|edge| edge[0] != at);
        let &[_, to] = edges.get(i).filter(|edge| edge[0] == at && is_one)?;
        at = to;
    }
    (at == first && round.len() == edges.len() && round.len() >= 3).then_some(round)
}

/// The paper's slope of a triangle: from its centroid to its corners, difference of heights over distance, the mean of three.
pub(super) fn slope_of(places: [DVec3; 3]) -> f64 {
    let middle = (places[0] + places[1] + places[2]) / 3.0;
    let slope = |p: DVec3| {
        let away = p - middle;
        let distance_m = away.length();
        if distance_m > 0.0 { away.z.abs() / distance_m } else { 0.0 }
    };
    places.map(slope).iter().sum::<f64>() / 3.0
}
