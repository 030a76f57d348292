//! The semi-regular mesh while it is laid over the source: every vertex at a place on it.

use super::source::{Place, Source};
use super::walk;
use glam::DVec3;
use yamanami_core::SemiRegular;

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
}

impl<'a> Net<'a> {
    /// Puts the vertices of a level's mesh at their places; those of borders on the border.
    pub(super) fn new(source: &'a Source, topology: &'a SemiRegular, level: u32, mut places: Vec<Place>) -> Self {
        let mut ring = Vec::new();
        for v in 0..topology.vertex_count(level) {
            let at = places[v as usize];
            if !topology.ring(level, v, &mut ring) {
                let on_border = walk::descend_border(source, at, source.position(at));
                places[v as usize] = on_border.map_or(at, |f| f.place);
            }
        }
        let positions = places.iter().map(|&p| source.position(p)).collect();
        let normals = places.iter().map(|&p| source.normal(p)).collect();
        Self { source, topology, level, places, positions, normals }
    }

    /// Moves a vertex.
    pub(super) fn put(&mut self, vertex: u32, place: Place) {
        let v = vertex as usize;
        self.places[v] = place;
        self.positions[v] = self.source.position(place);
        self.normals[v] = self.source.normal(place);
    }

    /// The cosine between a triangle's normal and the source's at its corners, were the first corner at `at`.
    pub(super) fn facing(&self, [at, normal]: [DVec3; 2], [b, c]: [u32; 2]) -> f64 {
        let [p, q] = [b, c].map(|v| self.positions[v as usize]);
        let there = normal + self.normals[b as usize] + self.normals[c as usize];
        (p - at).cross(q - at).normalize_or_zero().dot(there.normalize_or_zero())
    }

    /// The least of these around a vertex with these neighbours.
    pub(super) fn least_facing(&self, at: [DVec3; 2], ring: &[u32], is_closed: bool) -> f64 {
        let pairs = if is_closed { ring.len() } else { ring.len() - 1 };
        (0..pairs).map(|k| self.facing(at, [ring[k], ring[(k + 1) % ring.len()]])).fold(1.0, f64::min)
    }

    /// Triangles that face away from the source.
    pub(super) fn folded(&self) -> usize {
        let faces_away =
            |&[a, b, c]: &[u32; 3]| self.facing([self.positions[a as usize], self.normals[a as usize]], [b, c]) < 0.0;
        self.topology.triangles(self.level).iter().filter(|t| faces_away(t)).count()
    }
}
