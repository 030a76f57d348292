//! A triangle cut to a tile: by the lines of its sides, so that every tile finds the same crossings.
//!
//! Based on: Sutherland, Hodgman, "Reentrant polygon clipping", 1974. Where we differ: a crossing is always worked out from
//! the whole edge of the triangle, its ends in one order, never from what another line has left of it.

use super::border::{EAST, NORTH, SOUTH, Side, WEST};

/// What a corner of the clipped polygon is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Corner {
    /// A corner of the triangle, by number.
    Own(usize),
    /// On a side of the tile, so far along it.
    On(usize, f64),
    /// A corner of the tile: on two sides.
    Tile(usize, usize),
}

/// What runs from a corner to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Edge {
    /// An edge of the triangle: from corner k to k + 1.
    Own(usize),
    Side(usize),
}

/// A corner of a triangle: its place, and a number that is the same in all tiles.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) at: [f64; 2],
    pub(super) number: u64,
}

/// Clips a triangle; the polygon turns as the triangle does. It may have corners that coincide.
pub(super) fn clip(triangle: &[Place; 3], sides: &[Side; 4], out: &mut Vec<Corner>) {
    let mut polygon: Vec<(Corner, [f64; 2], Edge)> =
        (0..3).map(|k| (Corner::Own(k), triangle[k].at, Edge::Own(k))).collect();
    let mut next = Vec::with_capacity(8);
    for side in [WEST, SOUTH, EAST, NORTH] {
        let Side { axis, at, .. } = sides[side];
        let inside = |p: [f64; 2]| if side < EAST { p[axis] >= at } else { p[axis] <= at };
        next.clear();
        for k in 0..polygon.len() {
            let (from, to) = (polygon[k], polygon[(k + 1) % polygon.len()]);
            let cross = || match from.2 {
                Edge::Own(edge) => {
                    let along = crossing(triangle[edge], triangle[(edge + 1) % 3], axis, at);
                    let mut place = [at; 2];
                    place[1 - axis] = along;
                    (Corner::On(side, along), place)
                }
                Edge::Side(other) => {
                    let mut place = [at; 2];
                    place[sides[other].axis] = sides[other].at;
                    (Corner::Tile(other, side), place)
                }
            };
            match (inside(from.1), inside(to.1)) {
                (true, true) => next.push(from),
                (true, false) => {
                    next.push(from);
                    // a corner on the line is the crossing itself
                    if from.1[axis] != at {
                        let (corner, place) = cross();
                        next.push((corner, place, Edge::Side(side)));
                    } else if let Some(last) = next.last_mut() {
                        last.2 = Edge::Side(side);
                    }
                }
                (false, true) => {
                    if to.1[axis] != at {
                        let (corner, place) = cross();
                        next.push((corner, place, from.2));
                    }
                }
                (false, false) => {}
            }
        }
        std::mem::swap(&mut polygon, &mut next);
    }
    out.clear();
    out.extend(polygon.into_iter().map(|(corner, ..)| corner));
}

/// Where an edge crosses a line, along the line.
fn crossing(a: Place, b: Place, axis: usize, at: f64) -> f64 {
    let (a, b) = if a.number < b.number { (a.at, b.at) } else { (b.at, a.at) };
    let part = (at - a[axis]) / (b[axis] - a[axis]);
    a[1 - axis] + part * (b[1 - axis] - a[1 - axis])
}

/// Triangulates a polygon on a lattice, counter-clockwise or weakly so: every corner stays one of the triangulation, also
/// those on straight lines. Calls `out` with indices; triangles without area do not come up.
pub(super) fn ears(polygon: &[[i32; 2]], mut out: impl FnMut([usize; 3])) {
    let mut left: Vec<usize> = (0..polygon.len()).collect();
    while left.len() >= 3 {
        let n = left.len();
        let at = |k: usize| polygon[left[k % n]];
        let mut best: Option<(i64, usize)> = None;
        for k in 0..n {
            let [a, b, c] = [at(k + n - 1), at(k), at(k + 1)];
            if area(a, b, c) <= 0 {
                continue;
            }
            let holds = |p: [i32; 2]| {
                p != a && p != b && p != c && area(a, b, p) >= 0 && area(b, c, p) >= 0 && area(c, a, p) >= 0
            };
            if (0..n).any(|j| holds(at(j))) {
                continue;
            }
            let across = i64::from(a[0] - c[0]).pow(2) + i64::from(a[1] - c[1]).pow(2);
            if best.is_none_or(|(least, _)| across < least) {
                best = Some((across, k));
            }
        }
        let Some((_, k)) = best else { return };
        out([left[(k + n - 1) % n], left[k], left[(k + 1) % n]]);
        left.remove(k);
    }
}

/// Twice the area, positive when counter-clockwise.
pub(super) fn area(a: [i32; 2], b: [i32; 2], c: [i32; 2]) -> i64 {
    let [bx, by, cx, cy] = [b[0] - a[0], b[1] - a[1], c[0] - a[0], c[1] - a[1]].map(i64::from);
    bx * cy - cx * by
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ears_keep_corners_on_straight_lines() {
        let polygon = [[0, 0], [1, 0], [2, 0], [4, 0], [4, 4], [0, 4], [0, 2]];
        let (mut sum, mut used) = (0, [false; 7]);
        ears(&polygon, |t| {
            sum += area(polygon[t[0]], polygon[t[1]], polygon[t[2]]);
            t.into_iter().for_each(|k| used[k] = true);
        });
        assert_eq!((sum, used), (32, [true; 7]));
    }
}
