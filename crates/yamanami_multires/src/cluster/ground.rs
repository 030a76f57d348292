//! A group simplified as a piece of ground: a TIN stays a TIN, errors are vertical, lines stay lines.
//!
//! Where the group is locked it meets others; the line between a locked vertex and the next is a border only where no
//! other group goes on, so what is alone at an edge with a free vertex is the border of the ground.

use super::patch::{Coarser, Patch};
use super::split::edge_key;
use super::weld::Vertices;
use crate::tin::collapse::{Task, reduce};
use crate::tin::vertical::{Ground as Piece, vertical_difference};
use crate::tin::{line_edges, t_junctions};
use glam::DVec3;
use std::collections::HashSet;
use std::mem::take;
use yamanami_core::{Snap, Tin, TriangleMesh};

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
    /// Vertices and triangles are only lent.
    pub(super) fn new(tin: &Tin, snap: Option<Snap>, vertices: &mut Vertices, triangles: &mut Vec<[u32; 3]>) -> Self {
        let mut lines = HashSet::new();
        // by the welded vertices' numbers
        let mut welded = Tin::of_mesh("", TriangleMesh::new(take(&mut vertices.positions), take(triangles)));
        let stays = t_junctions(&welded.mesh).into_iter().flat_map(|(v, [a, b])| [v, a, b]).collect();
        if !tin.breaklines.is_empty() {
            welded.breaklines.clone_from(&tin.breaklines);
            lines.extend(line_edges(&welded).edges.iter().map(|&[a, b]| edge_key(a, b)));
        }
        (vertices.positions, *triangles) = (welded.mesh.positions, welded.mesh.triangles);
        Self { snap, lines, stays }
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
        Coarser { mesh, source: reduced.source, lines: reduced.lines, stray_m: reduced.stray_m, under: Vec::new() }
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
    /// Notes where the coarser one's vertices lie.
    pub(super) fn distance_m(&self, patch: &Patch, coarser: &mut Coarser) -> f64 {
        let origin = patch.mesh.positions.first().copied().unwrap_or_default();
        let near = |mesh: &TriangleMesh| mesh.positions.iter().map(|&p| p - origin).collect::<Vec<DVec3>>();
        let (finer_near, coarser_near) = (near(&patch.mesh), near(&coarser.mesh));
        let finer = Piece { positions: &finer_near, triangles: &patch.mesh.triangles };
        let coarser_piece = Piece { positions: &coarser_near, triangles: &coarser.mesh.triangles };
        let difference = vertical_difference(finer, coarser_piece);
        coarser.under = difference.under;
        difference.worst_m.max(coarser.stray_m)
    }
}
