//! The triangles of the blocks, hypotenuses along the radius where they can be. Knows no height.

use super::blocks::{Blocks, Vertices};
use rayon::prelude::*;

/// A triangle on the lattice: the right angle first, then counter-clockwise from above (rows run south).
type Corners = [[i64; 2]; 3];

/// Triangles, the level of each, and where each block's begin, with the end.
pub(super) fn triangles(blocks: &Blocks, vertices: &Vertices) -> (Vec<[u32; 3]>, Vec<u8>, Vec<u32>) {
    let numbers = vertices.numbers();
    let width = blocks.width();
    let of_block = |block: usize| {
        let mut found: Vec<([u32; 3], u8)> = Vec::new();
        if blocks.levels[block] == 0 {
            return found;
        }
        let ([x, y], side) = (blocks.corner(block), blocks.side);
        let [nw, sw, se, ne] = [[x, y], [x, y + side], [x + side, y + side], [x + side, y]];
        let centre = [x + side / 2, y + side / 2];
        for [from, to] in [[nw, sw], [sw, se], [se, ne], [ne, nw]] {
            halve(blocks, vertices, [centre, from, to], 1, &mut |corners, level| {
                found.push((corners.map(|[x, y]| numbers[(y * width + x) as usize]), level));
            });
        }
        found
    };
    let by_block: Vec<_> = (0..blocks.levels.len()).into_par_iter().map(of_block).collect();
    let mut starts = vec![0];
    let (mut triangles, mut levels) = (Vec::new(), Vec::new());
    for found in by_block {
        triangles.extend(found.iter().map(|f| f.0));
        levels.extend(found.iter().map(|f| f.1));
        starts.push(triangles.len() as u32);
    }
    (triangles, levels, starts)
}

/// Halves a triangle as long as the middle of its hypotenuse is a vertex.
fn halve(blocks: &Blocks, vertices: &Vertices, corners: Corners, level: u8, push: &mut impl FnMut(Corners, u8)) {
    let [a, b, c] = corners;
    let twice = [b[0] + c[0], b[1] + c[1]];
    let middle = twice.map(|at| at / 2);
    if twice.iter().all(|at| at % 2 == 0) && vertices.has(middle) {
        halve(blocks, vertices, [middle, a, b], level + 1, push);
        halve(blocks, vertices, [middle, c, a], level + 1, push);
        return;
    }
    let opposite = [twice[0] - a[0], twice[1] - a[1]];
    let across =
        if is_across_better(blocks, twice, [b, c], [a, opposite]) && has_twin(blocks, vertices, corners, opposite) {
            // the twin does the same, and has the other half
            [b, opposite, a]
        } else {
            corners
        };
    push(across, level);
}

/// Whether the second of two diagonals of a square lies nearer to the radius than the first.
fn is_across_better(blocks: &Blocks, twice_middle: [i64; 2], first: [[i64; 2]; 2], second: [[i64; 2]; 2]) -> bool {
    let eye = blocks.eye();
    let out = [twice_middle[0] - 2 * eye[0], twice_middle[1] - 2 * eye[1]];
    let along = |[from, to]: [[i64; 2]; 2]| (out[0] * (to[0] - from[0]) + out[1] * (to[1] - from[1])).abs();
    along(second) > along(first)
}

/// Whether the triangle on the other side of the hypotenuse is drawn and of the same size.
fn has_twin(blocks: &Blocks, vertices: &Vertices, [_, b, c]: Corners, opposite: [i64; 2]) -> bool {
    let inside = [0, 1].map(|k| 2 * opposite[k] + b[k] + c[k]);
    blocks.is_drawn_around(inside) && vertices.has(opposite)
}
