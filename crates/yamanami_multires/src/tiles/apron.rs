//! The rim around a terrain that is to be filled outside: as many samples on as they are apart, once level, so that the last
//! samples lie safely on the ground, and once down or up to the height of the fill.

use super::walk::Item;

/// A sample's column and row; those of the rim lie up to [`RIM`] outside of the grid.
pub(super) type Spot = [i64; 2];

/// Samples from the grid's edge to that of the rim.
pub(super) const RIM: i64 = 2;

/// How far outside a grid of `size` a place is, samples.
pub(super) fn outside(at: [f64; 2], size: [u32; 2]) -> f64 {
    [0, 1].into_iter().map(|k| (-at[k]).max(at[k] - f64::from(size[k] - 1))).fold(0.0, f64::max)
}

/// Adds the rim beside the edges of a triangle of the front that lie on the grid's edge.
pub(super) fn rim(corners: [Spot; 3], size: [u32; 2], error_m: f32, level: u32, out: &mut Vec<Item>) {
    let last = size.map(|n| i64::from(n) - 1);
    for k in 0..3 {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        for axis in 0..2 {
            for (edge, away) in [(0, -1), (last[axis], 1)] {
                if a[axis] != edge || b[axis] != edge {
                    continue;
                }
                let beyond = |p: Spot, by: i64| {
                    let mut p = p;
                    p[axis] += away * by;
                    p
                };
                for ring in 0..RIM {
                    let quad = [beyond(b, ring), beyond(a, ring), beyond(a, ring + 1), beyond(b, ring + 1)];
                    push(quad, error_m, level, out);
                }
                // a corner of the grid comes with the edge along its row
                for p in [a, b] {
                    if axis == 1 && (p[0] == 0 || p[0] == last[0]) {
                        let along = if p[0] == 0 { -1 } else { 1 };
                        for (i, j) in (0..RIM).flat_map(|i| (0..RIM).map(move |j| (i, j))) {
                            let at = |i: i64, j: i64| [p[0] + along * i, p[1] + away * j];
                            push([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)], error_m, level, out);
                        }
                    }
                }
            }
        }
    }
}

/// Adds a quadrangle as two triangles, whichever way it turns.
fn push(quad: [Spot; 4], error_m: f32, level: u32, out: &mut Vec<Item>) {
    let [a, b, c, d] = quad;
    // rows run south
    let turn = (b[0] - a[0]) * (a[1] - c[1]) - (c[0] - a[0]) * (a[1] - b[1]);
    let [a, b, c, d] = if turn > 0 { [a, b, c, d] } else { [d, c, b, a] };
    out.push(Item::Rim([a, b, c], level, error_m));
    out.push(Item::Rim([a, c, d], level, error_m));
}
