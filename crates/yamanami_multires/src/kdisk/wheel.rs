//! Surroundings that come again and again: of a base vertex with so many triangles around it, and of no base vertex at all. Their
//! stencils are found in a wheel: one base vertex, the triangles around it, split as often as it takes.

use super::disk::DiskFinder;
use super::stencil::Stencils;
use std::collections::HashMap;
use yamanami_core::{BaseMesh, SemiRegular};

/// The stencils of details that lie among vertices of valence six only, of the three directions of edges.
#[derive(Debug, Default)]
pub(super) struct Regular {
    /// What a coarse vertex at (a, b) gathers: share of the detail of a direction's edge `x, y` further. Edges count from the lattice point
    /// (a, b): direction 0 goes to (a + 1, b), 1 from (a + 1, b) to (a, b + 1), 2 to (a, b + 1).
    pub(super) taps: Vec<Tap>,
    pub(super) stencil: u32,
}

/// A share, and of which detail.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tap {
    pub(super) direction: usize,
    pub(super) x: i32,
    pub(super) y: i32,
    pub(super) share: f64,
}

/// The details near an inner base vertex whose disks feel it, and the cells that take shares of them.
#[derive(Debug)]
pub(super) struct Corner {
    /// The details' parents are up to so many edges off, the nearer one.
    pub(super) reach: usize,
    /// Details: the triangle around the vertex, and fine lattice coordinates in it with the vertex as corner 0.
    pub(super) details: Vec<(usize, [usize; 2])>,
    pub(super) square_norms: Vec<f64>,
    /// Cells up to so many edges off take part.
    pub(super) radius: usize,
    /// For each cell, in the order of [`around`], where its shares begin.
    pub(super) begins: Vec<u32>,
    /// Places in `details`, and what the cell takes of them.
    pub(super) shares: Vec<(u32, f64)>,
}

/// Lattice points other than the middle of a vertex's surroundings: triangle and coordinates there, the vertex being corner 0.
pub(super) fn around(triangles: usize, radius: usize) -> impl Iterator<Item = (usize, [usize; 2])> {
    (0..triangles).flat_map(move |t| (1..=radius).flat_map(move |a| (0..=radius - a).map(move |b| (t, [a, b]))))
}

/// A wheel and the places of its vertices.
struct Wheel {
    mesh: SemiRegular,
    level: u32,
}

impl Wheel {
    fn new(triangles: usize, rings: u32) -> Option<Self> {
        let level = (3 * rings + 6).next_power_of_two().trailing_zeros();
        let n = triangles as u32;
        let base = BaseMesh::new(n + 1, (0..n).map(|k| [0, 1 + k, 1 + (k + 1) % n]).collect()).ok()?;
        Some(Self { mesh: SemiRegular::new(base, level + 1).ok()?, level })
    }

    fn parents(&self, triangle: usize, fine: [usize; 2]) -> [u32; 2] {
        let vertex = self.mesh.vertex(self.level + 1, triangle as u32, fine.map(|v| v as u32));
        self.mesh.parents(vertex).unwrap_or_default()
    }

    fn vertex(&self, triangle: usize, at: [usize; 2]) -> u32 {
        self.mesh.vertex(self.level, triangle as u32, at.map(|v| v as u32))
    }
}

impl Regular {
    pub(super) fn new(rings: u32, stencils: &mut Stencils) -> Self {
        let Some(wheel) = Wheel::new(6, rings) else { return Self::default() };
        // the wheel unrolled: a triangle is the one before, turned by 60°
        let mut place: HashMap<u32, [i32; 2]> = HashMap::from([(0, [0, 0])]);
        for (triangle, at) in around(6, rings as usize + 2) {
            let mut flat = at.map(|v| v as i32);
            for _ in 0..triangle {
                flat = [-flat[1], flat[0] + flat[1]];
            }
            place.insert(wheel.vertex(triangle, at), flat);
        }
        let mut finder = DiskFinder::new(&wheel.mesh, wheel.level, rings);
        let mut found = Self::default();
        for (direction, fine) in [[1, 0], [1, 1], [0, 1]].into_iter().enumerate() {
            let disk = finder.find(wheel.parents(0, fine));
            let stencil = stencils.of(&disk);
            found.stencil = stencil;
            for (v, &share) in disk.vertices.iter().zip(stencils.shares(stencil)) {
                let [x, y] = place[v];
                found.taps.push(Tap { direction, x: -x, y: -y, share });
            }
        }
        found
    }
}

impl Corner {
    /// The surroundings of an inner vertex with so many triangles.
    pub(super) fn new(triangles: usize, rings: u32, regular: &Regular, stencils: &mut Stencils) -> Option<Self> {
        let wheel = Wheel::new(triangles, rings)?;
        let mut finder = DiskFinder::new(&wheel.mesh, wheel.level, rings);
        // disks around a vertex of few triangles may meet themselves beyond it
        let mut reach = rings as usize;
        let mut is_regular = |(t, fine)| stencils.of(&finder.find(wheel.parents(t, fine))) == regular.stencil;
        while reach < 2 * rings as usize + 1 && !shell(1, reach + 1).all(&mut is_regular) {
            reach += 1;
        }
        let radius = reach + 1 + rings as usize;
        let mut place: HashMap<u32, u32> = HashMap::from([(0, 0)]);
        for (nth, (triangle, at)) in (1..).zip(around(triangles, radius)) {
            place.insert(wheel.vertex(triangle, at), nth);
        }
        let details: Vec<(usize, [usize; 2])> = (0..=reach).flat_map(|r| shell(triangles, r)).collect();
        let mut square_norms = Vec::with_capacity(details.len());
        let mut gathered = vec![Vec::new(); place.len()];
        for (nth, &(triangle, fine)) in (0..).zip(&details) {
            let disk = finder.find(wheel.parents(triangle, fine));
            let stencil = stencils.of(&disk);
            square_norms.push(stencils.square_norm(stencil));
            for (v, &share) in disk.vertices.iter().zip(stencils.shares(stencil)) {
                gathered[place[v] as usize].push((nth, share));
            }
        }
        let begins = std::iter::once(0).chain(gathered.iter().scan(0, |end, shares| {
            *end += shares.len() as u32;
            Some(*end)
        }));
        let begins = begins.collect();
        Some(Self { reach, details, square_norms, radius, begins, shares: gathered.concat() })
    }
}

/// Details whose nearer parent is so many edges off the middle.
fn shell(triangles: usize, distance: usize) -> impl Iterator<Item = (usize, [usize; 2])> {
    around(triangles, 2 * distance + 1).filter(move |(_, [a, b])| (a + b) / 2 == distance && (a & 1 == 1 || b & 1 == 1))
}
