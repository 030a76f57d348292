//! How a level's mesh lies in memory while it is worked on: its *cells*, so that rows of the lattice are contiguous, and its details.
//!
//! Cells are the base vertices, then for each base edge its inner vertices from the first end to the second, then for each base triangle
//! its inner vertices row by row: each vertex of the level once, in another order than the mesh numbers them. Details are the new vertices
//! of the next finer level in the mesh's own order, whose rows are contiguous too.

use rayon::prelude::*;
use std::ops::Range;
use yamanami_core::{BaseMesh, Place, SemiRegular, Side};

/// Work with fewer values than this is not worth a second thread.
pub(super) const FEW: usize = 4096;

/// A level's cells and the details towards the next one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cells<'a> {
    pub(super) base: &'a BaseMesh,
    /// Steps of a base edge: 2^level.
    pub(super) size: usize,
}

/// Where a row begins, among rows of `longest`, `longest − 1`, …
fn row_begin(row: usize, longest: usize) -> usize {
    row * (2 * longest + 1 - row) / 2
}

impl<'a> Cells<'a> {
    pub(super) fn new(base: &'a BaseMesh, level: u32) -> Self {
        Self { base, size: 1 << level }
    }

    fn edges(&self) -> usize {
        self.base.edges().len()
    }

    /// Cells inside a base triangle.
    pub(super) fn inside(&self) -> usize {
        (self.size - 1) * self.size.saturating_sub(2) / 2
    }

    /// Cells on base edges and inside base triangles begin here.
    pub(super) fn sections(&self) -> (usize, usize) {
        let on_edges = self.base.vertex_count() as usize;
        (on_edges, on_edges + self.edges() * (self.size - 1))
    }

    pub(super) fn count(&self) -> usize {
        self.sections().1 + self.base.triangles().len() * self.inside()
    }

    /// The cells inside an edge.
    pub(super) fn edge(&self, edge: usize) -> Range<usize> {
        let begin = self.sections().0 + edge * (self.size - 1);
        begin..begin + self.size - 1
    }

    /// The inner cells of a triangle's row `b`, 1 to size − 1; the first has a = 1.
    pub(super) fn row(&self, face: usize, b: usize) -> Range<usize> {
        let begin = self.sections().1 + face * self.inside() + row_begin(b - 1, self.size.saturating_sub(2));
        begin..begin + self.size - 1 - b
    }

    /// The cell at lattice coordinates of a base triangle.
    pub(super) fn cell(&self, face: usize, [a, b]: [usize; 2]) -> usize {
        let c = self.size - a - b;
        let corner = |k: usize| self.base.triangles()[face][k] as usize;
        match (a, b, c) {
            (0, 0, _) => corner(0),
            (_, 0, 0) => corner(1),
            (0, _, 0) => corner(2),
            (a, 0, _) => self.on_side(face, 0, a),
            (_, b, 0) => self.on_side(face, 1, b),
            (0, _, c) => self.on_side(face, 2, c),
            _ => self.row(face, b).start + a - 1,
        }
    }

    fn on_side(&self, face: usize, side: usize, at: usize) -> usize {
        let Side { edge, is_reversed } = self.base.sides()[face][side];
        self.edge(edge as usize).start + if is_reversed { self.size - at } else { at } - 1
    }

    /// The cell of a vertex of this level's mesh.
    pub(super) fn of_vertex(&self, mesh: &SemiRegular, vertex: u32) -> usize {
        let scale = self.size >> mesh.level_of(vertex);
        match mesh.place(vertex) {
            Place::Base => vertex as usize,
            Place::Edge { edge, at } => self.edge(edge as usize).start + at as usize * scale - 1,
            Place::Face { face, at } => self.cell(face as usize, at.map(|v| v as usize * scale)),
        }
    }

    /// Details inside one of a triangle's three runs.
    pub(super) fn run_length(&self) -> usize {
        self.size * (self.size - 1) / 2
    }

    /// Details inside base triangles begin here, after `size` for each edge.
    pub(super) fn details_inside(&self) -> usize {
        self.edges() * self.size
    }

    /// Where a row begins within its run; it has `size − 1 − row` details.
    pub(super) fn row_of_run(&self, row: usize) -> usize {
        row_begin(row, self.size - 1)
    }

    /// The detail at coordinates of the *finer* lattice in a base triangle; one of them or both are odd.
    pub(super) fn detail(&self, face: usize, [a, b]: [usize; 2]) -> usize {
        let c = 2 * self.size - a - b;
        let on_side = |side: usize, at: usize| {
            let Side { edge, is_reversed } = self.base.sides()[face][side];
            edge as usize * self.size + if is_reversed { 2 * self.size - at } else { at } / 2
        };
        let (run, row, column) = match (a, b, c) {
            (a, 0, _) => return on_side(0, a),
            (_, b, 0) => return on_side(1, b),
            (0, _, c) => return on_side(2, c),
            _ if b & 1 == 0 => (0, b / 2 - 1, a / 2),
            _ if a & 1 == 1 => (1, b / 2, a / 2),
            _ => (2, b / 2, a / 2 - 1),
        };
        self.details_inside() + (3 * face + run) * self.run_length() + self.row_of_run(row) + column
    }

    /// A whole row of a triangle, its ends on the sides included.
    pub(super) fn load_row<const D: usize>(&self, cells: &[[f64; D]], face: usize, b: usize, row: &mut Vec<[f64; D]>) {
        row.clear();
        let end = self.size - b;
        if b == 0 || end == 0 {
            row.extend((0..=end).map(|a| cells[self.cell(face, [a, b])]));
            return;
        }
        row.push(cells[self.cell(face, [0, b])]);
        row.extend_from_slice(&cells[self.row(face, b)]);
        row.push(cells[self.cell(face, [end, b])]);
    }

    /// Cells of the next finer level from these and the details, which here are its new vertices.
    pub(super) fn join<const D: usize>(&self, cells: &[[f64; D]], details: &[[f64; D]], finer: &mut [[f64; D]]) {
        let fine = Self { base: self.base, size: 2 * self.size };
        let (on_edges, inside) = fine.sections();
        finer[..on_edges].copy_from_slice(&cells[..on_edges]);
        let (edges, faces) = finer[on_edges..].split_at_mut(inside - on_edges);
        for (edge, fine) in edges.chunks_exact_mut(2 * self.size - 1).enumerate() {
            interleave(&details[edge * self.size..][..self.size], &cells[self.edge(edge)], fine);
        }
        if fine.inside() == 0 {
            return;
        }
        let few = 1 + FEW / fine.inside();
        faces.par_chunks_exact_mut(fine.inside()).with_min_len(few).enumerate().for_each(|(face, mut rest)| {
            for b in 1..fine.size - 1 {
                let row;
                (row, rest) = rest.split_at_mut(fine.size - 1 - b);
                let y = b / 2;
                if b & 1 == 0 {
                    interleave(&details[self.run_row(face, 0, y - 1)], &cells[self.row(face, y)], row);
                } else {
                    interleave(&details[self.run_row(face, 1, y)], &details[self.run_row(face, 2, y)], row);
                }
            }
        });
    }

    /// The inverse of [`Self::join`].
    pub(super) fn part<const D: usize>(&self, finer: &[[f64; D]], cells: &mut [[f64; D]], details: &mut [[f64; D]]) {
        let fine = Self { base: self.base, size: 2 * self.size };
        let (on_edges, inside) = self.sections();
        cells[..on_edges].copy_from_slice(&finer[..on_edges]);
        let (edges, faces) = cells[on_edges..].split_at_mut(inside - on_edges);
        let (edge_details, face_details) = details.split_at_mut(self.details_inside());
        for (edge, odd) in edge_details.chunks_exact_mut(self.size).enumerate() {
            let finer = &finer[fine.edge(edge)];
            pick(finer, 0, odd);
            pick(finer, 1, &mut edges[edge * (self.size - 1)..][..self.size - 1]);
        }
        if self.inside() > 0 {
            let few = 1 + FEW / self.inside();
            faces.par_chunks_exact_mut(self.inside()).with_min_len(few).enumerate().for_each(|(face, mut rest)| {
                for y in 1..self.size - 1 {
                    let row;
                    (row, rest) = rest.split_at_mut(self.size - 1 - y);
                    pick(&finer[fine.row(face, 2 * y)], 1, row);
                }
            });
        }
        if self.run_length() > 0 {
            let few = 1 + FEW / self.run_length();
            face_details.par_chunks_exact_mut(self.run_length()).with_min_len(few).enumerate().for_each(
                |(nth, run)| {
                    let (face, run_number) = (nth / 3, nth % 3);
                    let (first_row, offset) = [(2, 0), (1, 0), (1, 1)][run_number];
                    let mut rest = run;
                    for row in 0..self.size - 1 {
                        let odd;
                        (odd, rest) = rest.split_at_mut(self.size - 1 - row);
                        pick(&finer[fine.row(face, 2 * row + first_row)], offset, odd);
                    }
                },
            );
        }
    }

    /// A row of a triangle's run among the details.
    pub(super) fn run_row(&self, face: usize, run: usize, row: usize) -> Range<usize> {
        let begin = self.details_inside() + (3 * face + run) * self.run_length() + self.row_of_run(row);
        begin..begin + self.size - 1 - row
    }
}

/// Cuts the first elements off.
pub(super) fn cut_off<'a, T>(rest: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    let (first, after) = std::mem::take(rest).split_at_mut(count);
    *rest = after;
    first
}

fn interleave<const D: usize>(first: &[[f64; D]], second: &[[f64; D]], all: &mut [[f64; D]]) {
    for (pair, (a, b)) in all.chunks_exact_mut(2).zip(first.iter().zip(second)) {
        pair.copy_from_slice(&[*a, *b]);
    }
    if all.len() & 1 == 1
        && let (Some(end), Some(last)) = (all.last_mut(), first.last())
    {
        *end = *last;
    }
}

/// Every other element, from the `offset`-th on.
fn pick<const D: usize>(from: &[[f64; D]], offset: usize, into: &mut [[f64; D]]) {
    for (to, pair) in into.iter_mut().zip(from[offset.min(from.len())..].chunks(2)) {
        *to = pair[0];
    }
}
