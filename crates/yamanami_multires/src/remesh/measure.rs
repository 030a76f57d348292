//! How far the result lies from its source: what the report says.

use crate::bound::Judge;
use glam::DVec3;
use yamanami_core::{BaseMesh, TriangleMesh};

/// The distance of samples on one surface from the other: each vertex, and the middle of each triangle.
pub(super) struct Samples {
    /// Root of the mean square, weighted by area, metres.
    pub(super) rms_m: f64,
    /// The greatest, metres.
    pub(super) greatest_m: f64,
}

/// Distances from samples on a mesh to another one.
pub(super) fn samples(from: &TriangleMesh, to: &Judge<'_>) -> Samples {
    let middles = (0..from.triangles.len()).map(|t| from.corners(t).iter().sum::<DVec3>() / 3.0);
    let at: Vec<DVec3> = from.positions.iter().copied().chain(middles).collect();
    let distances = to.distances_m(&at);
    let (mut sum, mut area, mut greatest_m) = (0.0, 0.0, 0.0f64);
    let (of_vertices, of_middles) = distances.split_at(from.positions.len());
    for (t, corners) in from.triangles.iter().enumerate() {
        let [a, b, c] = from.corners(t);
        let weight = (b - a).cross(c - a).length();
        // vertices that no triangle uses are no part of the surface
        greatest_m = corners.iter().map(|&v| of_vertices[v as usize]).fold(greatest_m.max(of_middles[t]), f64::max);
        // exact for squares of what is linear in the triangle
        let corners: f64 = corners.iter().map(|&v| of_vertices[v as usize].powi(2)).sum();
        sum += weight * (corners / 12.0 + 0.75 * of_middles[t].powi(2));
        area += weight;
    }
    let rms_m = if area > 0.0 { (sum / area).sqrt() } else { 0.0 };
    Samples { rms_m, greatest_m }
}

/// What kind of surface a mesh is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SurfaceKind {
    /// Parts that do not hang together.
    pub components: usize,
    /// Closed lines of border.
    pub borders: usize,
    /// Handles, of all parts together.
    pub genus: usize,
}

impl SurfaceKind {
    /// Counts.
    pub(super) fn of(mesh: &BaseMesh) -> Self {
        let vertices = mesh.vertex_count();
        let mut parts = Parts((0..vertices).collect());
        let mut loops = Parts((0..vertices).collect());
        let (mut components, mut edges_and_faces) = (vertices as usize, 0isize);
        let mut borders = 0;
        for edge in mesh.edges() {
            components -= usize::from(parts.join(edge.ends));
            if edge.right.is_none() {
                // a line of border closes where its last edge joins what is one already
                borders += usize::from(!loops.join(edge.ends));
            }
            edges_and_faces += 1;
        }
        edges_and_faces -= mesh.triangles().len() as isize;
        let euler = vertices as isize - edges_and_faces;
        let genus = (2 * components as isize - borders as isize - euler) / 2;
        Self { components, borders, genus: genus.max(0) as usize }
    }
}

/// Numbers that are joined: each points to another one of its part, the first to itself.
struct Parts(Vec<u32>);

impl Parts {
    fn root(&mut self, mut v: u32) -> u32 {
        while self.0[v as usize] != v {
            self.0[v as usize] = self.0[self.0[v as usize] as usize];
            v = self.0[v as usize];
        }
        v
    }

    /// Whether the two were apart.
    fn join(&mut self, ends: [u32; 2]) -> bool {
        let [a, b] = ends.map(|v| self.root(v));
        self.0[a.max(b) as usize] = a.min(b);
        a != b
    }
}
