//! The semi-regular mesh while it is laid over the source: every vertex at a place on it.

use super::source::{Place, Source};
use super::walk;
use glam::DVec3;
use rayon::prelude::*;
use yamanami_core::{Place as LatticePlace, SemiRegular};

/// Vertices on the source.
#[derive(Debug)]
pub(super) struct Net<'a> {
    pub(super) source: &'a Source,
    pub(super) topology: &'a SemiRegular,
    /// The level whose mesh it is.
    pub(super) level: u32,
    pub(super) places: Vec<Place>,
    pub(super) positions: Vec<DVec3>,
    /// The source's unit normals at the places.
    pub(super) normals: Vec<DVec3>,
    /// Vertices that stay where they are.
    pub(super) is_pinned: Vec<bool>,
}

impl<'a> Net<'a> {
    /// Puts the vertices of a level's mesh at their places; those of borders on the border.
    pub(super) fn new(source: &'a Source, topology: &'a SemiRegular, level: u32, mut places: Vec<Place>) -> Self {
        let mut net = Self {
            source,
            topology,
            level,
            places: Vec::new(),
            positions: Vec::new(),
            normals: Vec::new(),
            is_pinned: vec![false; topology.vertex_count(level) as usize],
        };
        for v in 0..topology.vertex_count(level) {
            let at = places[v as usize];
            if net.is_border(v) {
                let on_border = walk::descend_border(source, at, source.position(at));
                places[v as usize] = on_border.map_or(at, |f| f.place);
            }
        }
        net.put_all(places);
        net
    }

    /// Moves a vertex.
    pub(super) fn put(&mut self, vertex: u32, place: Place) {
        let v = vertex as usize;
        self.places[v] = place;
        self.positions[v] = self.source.position(place);
        self.normals[v] = self.source.normal(place);
    }

    /// Whether a vertex lies on the border.
    pub(super) fn is_border(&self, vertex: u32) -> bool {
        match self.topology.place(vertex) {
            LatticePlace::Base => self.topology.base().is_on_border(vertex),
            LatticePlace::Edge { edge, .. } => self.topology.base().edges()[edge as usize].right.is_none(),
            LatticePlace::Face { .. } => false,
        }
    }

    /// Moves all vertices.
    pub(super) fn put_all(&mut self, places: Vec<Place>) {
        self.positions = places.par_iter().map(|&p| self.source.position(p)).collect();
        self.normals = places.par_iter().map(|&p| self.source.normal(p)).collect();
        self.places = places;
    }

    /// Adds the vertices of the next level.
    pub(super) fn add_level(&mut self, places: &[Place]) {
        self.level += 1;
        self.places.extend_from_slice(places);
        self.is_pinned.resize(self.places.len(), false);
        self.positions.extend(places.iter().map(|&p| self.source.position(p)));
        self.normals.extend(places.iter().map(|&p| self.source.normal(p)));
    }

    /// The mesh of a coarser level.
    pub(super) fn coarser(&self, level: u32) -> Self {
        let count = self.topology.vertex_count(level) as usize;
        Self {
            level,
            places: self.places[..count].to_vec(),
            positions: self.positions[..count].to_vec(),
            normals: self.normals[..count].to_vec(),
            is_pinned: self.is_pinned[..count].to_vec(),
            ..*self
        }
    }

    /// The length of the straight way between two of its points, as the density has it.
    pub(super) fn length(&self, a: u32, b: u32) -> f64 {
        let [p, q] = [a, b].map(|v| self.source.density(self.places[v as usize]));
        self.positions[a as usize].distance(self.positions[b as usize]) * 0.5 * (p + q)
    }

    /// The least cosine between a triangle's normal and the source's at its corners, were the first corner at `at`: near 0 where the
    /// triangle cuts off what stands out between them.
    pub(super) fn facing(&self, [at, normal]: [DVec3; 2], [b, c]: [u32; 2]) -> f64 {
        let [p, q] = [b, c].map(|v| self.positions[v as usize]);
        let own = (p - at).cross(q - at).normalize_or_zero();
        own.dot(normal).min(own.dot(self.normals[b as usize])).min(own.dot(self.normals[c as usize]))
    }

    /// The least of these around a vertex with these neighbours.
    pub(super) fn least_facing(&self, at: [DVec3; 2], ring: &[u32], is_closed: bool) -> f64 {
        let pairs = if is_closed { ring.len() } else { ring.len() - 1 };
        (0..pairs).map(|k| self.facing(at, [ring[k], ring[(k + 1) % ring.len()]])).fold(1.0, f64::min)
    }

    /// Triangles that face away from the source.
    pub(super) fn folded(&self) -> usize {
        let faces_away = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| self.positions[v as usize]);
            let there: DVec3 = t.iter().map(|&v| self.normals[v as usize]).sum();
            (b - a).cross(c - a).dot(there) < 0.0
        };
        self.topology.triangles(self.level).iter().filter(|t| faces_away(t)).count()
    }
}
