//! A group simplified as a piece of ground: a TIN stays a TIN, errors are vertical, lines stay lines.
//!
//! Where the group is locked it meets others; the line between a locked vertex and the next is a border only where no
//! other group goes on, so what is alone at an edge with a free vertex is the border of the ground.

use super::patch::{Coarser, Patch};
use super::split::edge_key;
use super::weld::Vertices;
use crate::tin::collapse::{Task, reduce};
use crate::tin::vertical::{Ground as Piece, vertical_distance_m};
use crate::tin::{line_edges, t_junctions};
use glam::DVec3;
use std::collections::HashSet;
use yamanami_core::{Snap, Tin, TriangleMesh};

/// Vertices that hang on an edge of others, and its ends.
fn stays(mesh: &TriangleMesh) -> HashSet<u32> {
    t_junctions(mesh).into_iter().flat_map(|(v, [a, b])| [v, a, b]).collect()
}

/// What is known of the ground beside its triangles.
#[derive(Debug)]
pub(super) struct Ground {
    snap: Option<Snap>,
    /// Edges of breaklines, of all rounds so far: those of vertices gone are in nobody's way.
    lines: HashSet<u64>,
    /// Vertices that stay on all levels, for a seam that shares no edges hangs on them.
    stays: HashSet<u32>,
}

impl Ground {
    pub(super) fn new(tin: &Tin, snap: Option<Snap>, vertices: &Vertices, triangles: &[[u32; 3]]) -> Self {
        let mut lines = HashSet::new();
        // by the welded vertices' numbers
        let mesh = TriangleMesh::new(vertices.positions.clone(), triangles.to_vec());
        let stays = stays(&mesh);
        if !tin.breaklines.is_empty() {
            let welded = Tin { mesh, breaklines: tin.breaklines.clone(), ..Tin::default() };
            lines.extend(line_edges(&welded).edges.iter().map(|&[a, b]| edge_key(a, b)));
        }
        Self { snap, lines, stays }
    }

    /// The ground above several tiles: `lines` by place, `mesh` their coarsest triangles.
    pub(super) fn above(mesh: &TriangleMesh, lines: HashSet<u64>, snap: Option<Snap>) -> Self {
        Self { snap, lines, stays: stays(mesh) }
    }

    /// Whether a breakline runs along an edge.
    pub(super) fn has_line(&self, a: u32, b: u32) -> bool {
        self.lines.contains(&edge_key(a, b))
    }

    pub(super) fn add_lines(&mut self, lines: &[[u32; 2]]) {
        self.lines.extend(lines.iter().map(|&[a, b]| edge_key(a, b)));
    }

    /// The patch with about so many triangles.
    pub(super) fn reduce(&self, patch: &Patch, target: usize) -> Coarser {
        let stays = |v: &u32| self.stays.contains(v);
        let is_locked: Vec<bool> = patch.ids.iter().zip(&patch.locked).map(|(v, &l)| l || stays(v)).collect();
        let reduced = reduce(Task {
            positions: &patch.mesh.positions,
            triangles: &patch.mesh.triangles,
            is_locked: &is_locked,
            lines: &self.lines_of(patch),
            target,
            most_stray_m: f64::INFINITY,
            snap: self.snap,
        });
        let mesh = TriangleMesh::new(reduced.positions, reduced.triangles);
        Coarser { mesh, source: reduced.source, lines: reduced.lines, stray_m: reduced.stray_m }
    }

    fn lines_of(&self, patch: &Patch) -> Vec<[u32; 2]> {
        if self.lines.is_empty() {
            return Vec::new();
        }
        let edges = patch.mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let is_line =
            |[a, b]: &[u32; 2]| self.lines.contains(&edge_key(patch.ids[*a as usize], patch.ids[*b as usize]));
        let mut lines: Vec<[u32; 2]> = edges.filter(is_line).map(|[a, b]| [a.min(b), a.max(b)]).collect();
        lines.sort_unstable();
        lines.dedup();
        lines
    }

    /// How far the coarser patch is from the finer one: vertically where both are, along borders and breaklines in space.
    pub(super) fn distance_m(&self, patch: &Patch, coarser: &Coarser) -> f64 {
        let origin = patch.mesh.positions.first().copied().unwrap_or_default();
        let near = |mesh: &TriangleMesh| mesh.positions.iter().map(|&p| p - origin).collect::<Vec<DVec3>>();
        let (finer_near, coarser_near) = (near(&patch.mesh), near(&coarser.mesh));
        let finer = Piece { positions: &finer_near, triangles: &patch.mesh.triangles };
        let coarser_piece = Piece { positions: &coarser_near, triangles: &coarser.mesh.triangles };
        vertical_distance_m(finer, coarser_piece).max(coarser.stray_m)
    }
}
