//! The lazy wavelet's step: what new vertices lie off the middles of their parents.

use super::cells::{Cells, FEW, cut_off};
use rayon::prelude::*;
use std::ops::Range;

/// Details that make a piece of work.
const BAND: usize = 8192;

/// Adds (sign 1) the middles of the parents to the details, or takes them away (sign −1).
pub(super) fn predict<const D: usize>(at: Cells<'_>, cells: &[[f64; D]], details: &mut [[f64; D]], sign: f64) {
    let (edges, faces) = details.split_at_mut(at.details_inside());
    let few = 1 + FEW / at.size;
    edges.par_chunks_exact_mut(at.size).with_min_len(few).enumerate().for_each_init(
        Vec::new,
        |along, (edge, details)| {
            let ends = at.base.edges()[edge].ends.map(|v| cells[v as usize]);
            along.clear();
            along.push(ends[0]);
            along.extend_from_slice(&cells[at.edge(edge)]);
            along.push(ends[1]);
            add_middles(details, along, &along[1..], sign);
        },
    );
    if at.size == 1 {
        return;
    }
    let few = 1 + FEW / (3 * at.run_length()).min(BAND);
    bands(at, faces).into_par_iter().with_min_len(few).for_each_init(
        || (Vec::new(), Vec::new()),
        |(below, above), Band { face, rows, mut runs }| {
            at.load_row(cells, face, rows.start, below);
            for y in rows {
                at.load_row(cells, face, y + 1, above);
                let ends = [(&below[..], &below[1..]), (&below[1..], &above[..]), (&below[1..], &above[1..])];
                for (run, (p, q)) in ends.into_iter().enumerate() {
                    add_middles(cut_off(&mut runs[run], row_length(at.size, run, y)), p, q, sign);
                }
                std::mem::swap(below, above);
            }
        },
    );
}

/// The rows `rows` of lattice edges inside a triangle: in each run those between the lattice rows y and y + 1, or along y.
struct Band<'a, const D: usize> {
    face: usize,
    rows: Range<usize>,
    runs: [&'a mut [[f64; D]]; 3],
}

fn bands<'a, const D: usize>(at: Cells<'_>, details: &'a mut [[f64; D]]) -> Vec<Band<'a, D>> {
    let mut bands = Vec::new();
    for (face, details) in details.chunks_exact_mut(3 * at.run_length()).enumerate() {
        let (first, rest) = details.split_at_mut(at.run_length());
        let (second, third) = rest.split_at_mut(at.run_length());
        let mut runs = [first, second, third];
        let mut begin = 0;
        while begin < at.size {
            let mut end = begin;
            let mut lengths = [0; 3];
            while end < at.size && lengths[0] < BAND / 3 {
                for (run, length) in lengths.iter_mut().enumerate() {
                    *length += row_length(at.size, run, end);
                }
                end += 1;
            }
            let [a, b, c] = &mut runs;
            let runs = [cut_off(a, lengths[0]), cut_off(b, lengths[1]), cut_off(c, lengths[2])];
            bands.push(Band { face, rows: begin..end, runs });
            begin = end;
        }
    }
    bands
}

/// Details of a run at row `y`. Those along row 0 are on a side, and so not inside.
fn row_length(size: usize, run: usize, y: usize) -> usize {
    match run {
        0 if y == 0 => 0,
        0 => size - y,
        _ => size - 1 - y,
    }
}

fn add_middles<const D: usize>(details: &mut [[f64; D]], p: &[[f64; D]], q: &[[f64; D]], sign: f64) {
    let n = details.len();
    let half = sign * 0.5;
    let ends = p[..n].as_flattened().iter().zip(q[..n].as_flattened());
    for (detail, (p, q)) in details.as_flattened_mut().iter_mut().zip(ends) {
        *detail += half * (p + q);
    }
}
