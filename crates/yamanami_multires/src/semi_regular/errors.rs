//! Errors and bounds of the nodes of a semi-regular surface: what distance stays while a node is missing, and what it and its
//! descendants change.
//!
//! *What must hold.* A front draws each base triangle in parts: triangles T of some level, each by the template of the set c of its
//! applied midpoints, short of all. Let E(c) bound the two-sided distance between the template and the finest mesh's part F that belongs
//! to T. It is enough that *some* missing midpoint answers for E(c) ([`charge_three`]): a front that has all nodes with an error above
//! a tolerance then draws only templates within the tolerance, and the whole is not farther off than its worst part.
//!
//! *A lemma.* Let D be a triangle and F a surface over it, linear on pieces, through D's corners. Let a be the greatest distance of F's
//! vertices from D, and b that of the vertices on F's sides from the straight side. Then the two-sided distance is at most max(a, b). No
//! point of F is farther than a from D, as the distance to something convex is greatest at vertices. For the other way, widen F by a
//! collar, from each point w of a side straight to the nearest point n(w) of the straight side; and send each point to the nearest one
//! of D. The collar's rim goes once around D's, side onto side, so that every x of D is met: it is the nearest point of D to some point y. If y is
//! of F, x is within a. If y = (1 − t) w + t n(w) is of the collar, |x − y| ≤ (1 − t) b and |y − w| ≤ t b, so w is within b of x. How fast
//! F moves along D or its sides does not matter.
//!
//! *E(c).* Let `whole` be the lemma's bound for T and all of F; it is E({}). Let M be the template and M_4 T's four children, drawn.
//! - M is a surface over T: by the lemma it is within the greatest distance of an applied midpoint from its side. So E(c) ≤ whole + that.
//! - F is within the greatest `whole` of the children of M_4. M_4 is a surface over each triangle of M. Its vertices there lie on the
//!   sides: missing midpoints on sides of T; and the one side that is no edge of M_4, a median from a corner to the midpoint x between y and
//!   z, crosses the edge yz in the middle of both. So E(c) ≤ greatest `whole` of the children + greatest distance of the missing
//!   midpoints from their sides and of (y + z) / 2 from the median.
//!
//! Both hold, so the lesser counts. Errors are then made monotone: a node's is not below its children's. They are rounded up to f32; the
//! rounding of f64 before is left aside.

use super::triangle::{Triangle, adjacent, children};
use crate::bound::triangle::{distance2, nearest_on_edge};
use crate::wavelet::charge_three;
use glam::DVec3;
use rayon::prelude::*;
use yamanami_core::SemiRegular;

/// Fewest triangles or vertices that are worth a task of their own.
const TASK: usize = 256;

/// Errors of the nodes and radii of their bounds around their vertices, in metres, by vertex; zero for the base mesh's.
pub(super) fn errors_and_radii(mesh: &SemiRegular, positions: &[DVec3]) -> (Vec<f32>, Vec<f32>) {
    let charges = Charges::new(mesh, positions);
    let (mut errors, mut radii) = (vec![0f32; positions.len()], vec![0f32; positions.len()]);
    for level in (1..=mesh.levels()).rev() {
        let nodes = mesh.new_vertices(level);
        let (finer_errors, finer_radii) = (&errors, &radii);
        let found: Vec<(f32, f32)> = (nodes.clone().into_par_iter().with_min_len(TASK))
            .map(|node| {
                let from = positions[node as usize];
                let (mut error_m, mut radius_m) = (0f32, 0f64);
                for (t, role) in adjacent(mesh, node) {
                    error_m = error_m.max(charges.of(t)[role]);
                    for vertex in t.vertices(mesh) {
                        radius_m = radius_m.max(from.distance(positions[vertex as usize]));
                    }
                }
                for &child in children(mesh, node).iter() {
                    let child = child as usize;
                    error_m = error_m.max(finer_errors[child]);
                    radius_m = radius_m.max(from.distance(positions[child]) + f64::from(finer_radii[child]));
                }
                (error_m, round_up(radius_m))
            })
            .collect();
        for (node, (error_m, radius_m)) in nodes.zip(found) {
            errors[node as usize] = error_m;
            radii[node as usize] = radius_m;
        }
    }
    (errors, radii)
}

/// The least `f32` that is not below.
fn round_up(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) < value { near.next_up() } else { near }
}

/// What each triangle above the last level charges its midpoints h, p, q.
struct Charges {
    /// Triangles of one base triangle, above the last level.
    block: usize,
    /// Base triangle by base triangle, level by level.
    charges: Vec<[f32; 3]>,
}

impl Charges {
    fn new(mesh: &SemiRegular, positions: &[DVec3]) -> Self {
        let levels = mesh.levels();
        let block = first_of_level(levels);
        let mut charges = vec![[0f32; 3]; block * mesh.base().triangles().len()];
        if block > 0 {
            charges.par_chunks_mut(block).enumerate().for_each_init(Vec::new, |places, (face, charges)| {
                let grid = Grid::new(mesh, positions, face as u32, places);
                // of the level below: the finest triangles are as they are
                let mut whole_below = vec![0f64; 1 << (2 * levels)];
                for level in (0..levels).rev() {
                    let charges = &mut charges[first_of_level(level)..first_of_level(level + 1)];
                    whole_below = grid.weigh(level, &whole_below, charges);
                }
            });
        }
        Self { block, charges }
    }

    fn of(&self, t: Triangle) -> [f32; 3] {
        self.charges[self.block * t.face as usize + first_of_level(t.level) + t.index() as usize]
    }
}

/// Triangles of one base triangle on all levels above.
fn first_of_level(level: u32) -> usize {
    ((1 << (2 * level)) - 1) / 3
}

/// The finest vertices of one base triangle by lattice coordinates.
struct Grid<'a> {
    face: u32,
    levels: u32,
    places: &'a [DVec3],
}

impl<'a> Grid<'a> {
    fn new(mesh: &SemiRegular, positions: &[DVec3], face: u32, places: &'a mut Vec<DVec3>) -> Self {
        let levels = mesh.levels();
        let size = 1u32 << levels;
        places.clear();
        for b in 0..=size {
            places.extend((0..=size - b).map(|a| positions[mesh.vertex(levels, face, [a, b]) as usize]));
        }
        Self { face, levels, places }
    }

    /// Where row `b` begins in `places`.
    fn row(&self, b: usize) -> usize {
        let size = 1usize << self.levels;
        b * (2 * size + 3 - b) / 2
    }

    fn at(&self, level: u32, at: [u32; 2]) -> DVec3 {
        let [a, b] = at.map(|c| (c << (self.levels - level)) as usize);
        self.places[self.row(b) + a]
    }

    /// Charges the midpoints of a level's triangles; gives `whole` of each.
    fn weigh(&self, level: u32, whole_below: &[f64], charges: &mut [[f32; 3]]) -> Vec<f64> {
        let triangles = charges.par_iter_mut().enumerate().with_min_len((TASK >> (self.levels - level)).max(1));
        triangles
            .map(|(index, charges)| {
                let t = Triangle::from_index(self.face, level, index as u32);
                let points = t.points().map(|at| self.at(level + 1, at));
                let children = t.children().map(|child| whole_below[child.index() as usize]);
                let whole = self.whole(t, points);
                let errors = config_errors(whole, children.into_iter().fold(0.0, f64::max), points);
                *charges = charge_three(&errors.map(round_up));
                whole
            })
            .collect()
    }

    /// The lemma's bound for a triangle with the corners R, P, Q and all of the finest mesh above it.
    fn whole(&self, t: Triangle, [r, p, q, ..]: [DVec3; 6]) -> f64 {
        let shift = self.levels - t.level;
        let side = 1usize << shift;
        // from corner A on, along its sides to B and C; a turned triangle is walked backwards
        let [x, y] = t.at.map(|at| ((at + u32::from(t.half)) << shift) as usize);
        let corners @ [a, b, c] = if t.half == 0 { [r, p, q] } else { [p, q, r] };
        let [along, across] = [b, c].map(|end| (end - a) / side as f64);
        let mut worst = 0f64;
        for j in 0..=side {
            let start = a + across * j as f64;
            let mut weigh = |i: usize, place: DVec3| {
                // its own point of the triangle is not the nearest, but close enough for most
                if place.distance_squared(start + along * i as f64) > worst {
                    let edge = match (i, j) {
                        (_, 0) => Some([a, b]),
                        (0, _) => Some([a, c]),
                        _ if i + j == side => Some([b, c]),
                        _ => None,
                    };
                    worst = worst.max(match edge {
                        Some(edge) => place.distance_squared(nearest_on_edge(place, edge)),
                        None => distance2(place, &corners),
                    });
                }
            };
            let count = side - j + 1;
            if t.half == 0 {
                let first = self.row(y + j) + x;
                self.places[first..first + count].iter().enumerate().for_each(|(i, &place)| weigh(i, place));
            } else {
                let last = self.row(y - j) + x;
                let row = &self.places[last + 1 - count..=last];
                row.iter().rev().enumerate().for_each(|(i, &place)| weigh(i, place));
            }
        }
        worst.sqrt()
    }
}

/// Roles of the ends of the sides that h, p, q lie on.
const SIDES: [[usize; 2]; 3] = [[1, 2], [0, 1], [2, 0]];

/// The midpoint (0 = h, 1 = p, 2 = q) to which each template has a median, and the roles of the corners opposite to these.
const MEDIAN: [usize; 7] = [0, 0, 1, 0, 2, 0, 2];
const OPPOSITE: [usize; 3] = [0, 2, 1];

/// E(c) of the seven configurations short of all, see above, of a triangle with the points R, P, Q, h, p, q.
fn config_errors(whole: f64, children: f64, points: [DVec3; 6]) -> [f64; 7] {
    let off = |place: DVec3, edge: [usize; 2]| place.distance(nearest_on_edge(place, edge.map(|role| points[role])));
    let midpoints: [f64; 3] = std::array::from_fn(|k| off(points[3 + k], SIDES[k]));
    let medians: [f64; 3] = std::array::from_fn(|x| {
        let crossing = 0.5 * (points[3 + (x + 1) % 3] + points[3 + (x + 2) % 3]);
        off(crossing, [OPPOSITE[x], 3 + x])
    });
    std::array::from_fn(|config| {
        if config == 0 {
            return whole;
        }
        let (mut applied, mut left) = (0f64, medians[MEDIAN[config]]);
        for (bit, &midpoint) in midpoints.iter().enumerate() {
            let of = if config >> bit & 1 == 1 { &mut applied } else { &mut left };
            *of = of.max(midpoint);
        }
        (whole + applied).min(children + left)
    })
}
