//! The k-disk of an edge: the vertices within k edges of its ends, and how they are joined.

use std::ops::Range;
use yamanami_core::SemiRegular;

/// Where no vertex of the disk is.
pub(super) const OUTSIDE: u16 = u16::MAX;

/// Finds disks, one after the other, in the mesh of one level.
#[derive(Debug)]
pub(super) struct DiskFinder<'a> {
    mesh: &'a SemiRegular,
    level: u32,
    rings: u32,
    /// Place in the disk, by vertex, valid where `stamp` is the current one.
    place: Vec<(u32, u16)>,
    stamp: u32,
    /// Where each vertex's ring is in `rings` and whether it is closed; an empty range where nobody has asked yet.
    known: Vec<(Range<u32>, bool)>,
    rings_found: Vec<u32>,
    ring: Vec<u32>,
    disk: Vec<u32>,
    /// Where each ring begins, in `joined`.
    begins: Vec<u32>,
    joined: Vec<u16>,
    signature: Vec<u16>,
}

impl<'a> DiskFinder<'a> {
    /// Disks of so many rings in a level's mesh.
    pub(super) fn new(mesh: &'a SemiRegular, level: u32, rings: u32) -> Self {
        let count = mesh.vertex_count(level) as usize;
        let (place, known) = (vec![(0, 0); count], vec![(0..0, false); count]);
        let (rings_found, ring, disk, begins, joined, signature) = Default::default();
        Self { mesh, level, rings, place, stamp: 0, known, rings_found, ring, disk, begins, joined, signature }
    }

    /// The disk of an edge: its ends, then ring by ring.
    pub(super) fn find(&mut self, ends: [u32; 2]) -> Disk<'_> {
        self.stamp += 1;
        self.disk.clear();
        self.begins.clear();
        self.joined.clear();
        self.signature.clear();
        for v in ends {
            self.enter(v);
        }
        let mut from = vec![1u16, 0];
        let mut inner = 0;
        for _ in 0..self.rings {
            let outer = self.disk.len();
            for at in inner..outer {
                self.turned_ring(at, self.disk[usize::from(from[at])]);
                for k in 0..self.ring.len() {
                    if self.enter(self.ring[k]) {
                        from.push(at as u16);
                    }
                }
            }
            inner = outer;
        }
        for at in 0..self.disk.len() {
            let is_closed = self.turned_ring(at, self.disk[usize::from(from[at])]);
            self.begins.push(self.joined.len() as u32);
            self.signature.push(self.ring.len() as u16 * 2 + u16::from(is_closed));
            for k in 0..self.ring.len() {
                let (stamp, place) = self.place[self.ring[k] as usize];
                self.joined.push(if stamp == self.stamp { place } else { OUTSIDE });
            }
        }
        self.begins.push(self.joined.len() as u32);
        self.signature.extend_from_slice(&self.joined);
        Disk { vertices: &self.disk, begins: &self.begins, joined: &self.joined, signature: &self.signature }
    }

    fn enter(&mut self, vertex: u32) -> bool {
        let place = &mut self.place[vertex as usize];
        if place.0 == self.stamp {
            return false;
        }
        *place = (self.stamp, self.disk.len() as u16);
        self.disk.push(vertex);
        true
    }

    /// The ring around a vertex of the disk; where it is closed, from the vertex that it was found from, so that equal surroundings
    /// are met in equal order.
    fn turned_ring(&mut self, at: usize, from: u32) -> bool {
        let vertex = self.disk[at];
        let (place, is_closed) = &mut self.known[vertex as usize];
        if place.start == place.end {
            *is_closed = self.mesh.ring(self.level, vertex, &mut self.ring);
            let begin = self.rings_found.len() as u32;
            *place = begin..begin + self.ring.len() as u32;
            self.rings_found.extend_from_slice(&self.ring);
        }
        let ring = &self.rings_found[place.start as usize..place.end as usize];
        let begin = if *is_closed { ring.iter().position(|&v| v == from).unwrap_or(0) } else { 0 };
        self.ring.clear();
        self.ring.extend_from_slice(&ring[begin..]);
        self.ring.extend_from_slice(&ring[..begin]);
        *is_closed
    }
}

/// A disk.
#[derive(Debug, Clone, Copy)]
pub(super) struct Disk<'a> {
    /// Its vertices, the edge's ends first.
    pub(super) vertices: &'a [u32],
    begins: &'a [u32],
    joined: &'a [u16],
    /// Equal for disks that are joined, and go on, in the same way.
    pub(super) signature: &'a [u16],
}

impl Disk<'_> {
    /// The neighbours of its `at`-th vertex by their places in the disk, or [`OUTSIDE`]; and whether they go all around.
    pub(super) fn ring(&self, at: usize) -> (&[u16], bool) {
        let ring = &self.joined[self.begins[at] as usize..self.begins[at + 1] as usize];
        (ring, self.signature[at] & 1 == 1)
    }

    /// Triangles at the edge.
    pub(super) fn edge_triangles(&self) -> usize {
        let (ring, is_closed) = self.ring(0);
        // an open ring begins and ends with border edges
        if is_closed || (ring.first() != Some(&1) && ring.last() != Some(&1)) { 2 } else { 1 }
    }

    /// The third corners of the triangles at the edge, by their places in the disk where they are in it.
    pub(super) fn opposite(&self) -> impl Iterator<Item = u16> {
        let (ring, is_closed) = self.ring(0);
        let n = ring.len();
        let at = ring.iter().position(|&v| v == 1).unwrap_or(0);
        let after = (is_closed || at + 1 < n).then(|| ring[(at + 1) % n]);
        let before = (is_closed || at > 0).then(|| ring[(at + n - 1) % n]);
        after.into_iter().chain(before)
    }
}
