//! Errors and bounds of the nodes of a semi-regular surface: what distance stays while a node is missing, and what it and its
//! descendants change.
//!
//! *Why the errors bound the two-sided distance.* A front and the finest mesh are two maps of the base mesh into space, `M` and `F`,
//! both linear on pieces. Every point of one has a partner on the other, so neither surface is farther from the other than the greatest
//! `|M(u) − F(u)|`. A front draws each base triangle in parts: triangles T of some level, each by the template of the set c of its applied
//! midpoints, short of all. It is enough to have E(c) ≥ |M − F| on T for each c, and *some* missing midpoint that answers for it
//! ([`charge_three`]); a front that has all nodes with an error above a tolerance then draws only templates within the tolerance.
//!
//! *E(c).* Let L be the plane of T's corners, `d_h, d_p, d_q` how far the midpoints lie off the middles of their edges.
//! - `whole` = greatest |F − L| at the finest vertices of T. F − L is linear on each finest triangle of T, a length of something
//!   linear is convex, so `whole` is greatest on all of T: it is E({}).
//! - A template's hat functions add up to one at most, so |M_c − L| is at most the greatest applied |d|, and
//!   E(c) ≤ whole + that.
//! - Let M_4 be linear on T's four children: |F − M_4| is at most the greatest `whole` of the children. M_c − M_4 is linear on the
//!   pieces into which their edges cut T. At T's corners and applied midpoints it vanishes; at a missing midpoint it is that one's d. The
//!   one edge of M_c that is not one of M_4 is a median, from a corner to the midpoint x between y and z; it crosses the edge yz
//!   in the middle of both, where M_c − M_4 = (d_x − d_y − d_z) / 2. So E(c) ≤ greatest `whole` of the children + greatest of these.
//!
//! Both hold, so the lesser counts. Errors are then made monotone: a node's is not below its children's. They are exact up to the
//! rounding of f64 and rounded up to f32.

use super::triangle::{Triangle, adjacent, children};
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
                let [r, p, q, h, m, n] = t.points().map(|at| self.at(level + 1, at));
                let details = [h - 0.5 * (p + q), m - 0.5 * (r + p), n - 0.5 * (q + r)];
                let children = t.children().map(|child| whole_below[child.index() as usize]);
                let whole = self.whole(t, [r, p, q]);
                let errors = config_errors(whole, children.into_iter().fold(0.0, f64::max), details);
                *charges = charge_three(&errors.map(round_up));
                whole
            })
            .collect()
    }

    /// Greatest distance of the finest vertices of a triangle from where it would have them.
    fn whole(&self, t: Triangle, [r, p, q]: [DVec3; 3]) -> f64 {
        let shift = self.levels - t.level;
        let side = 1usize << shift;
        let inverse = 1.0 / side as f64;
        // from a corner on, along its two sides; a turned triangle is walked backwards
        let [a, b] = t.at.map(|c| ((c + u32::from(t.half)) << shift) as usize);
        let (corner, along, across) = if t.half == 0 { (r, p - r, q - r) } else { (p, q - p, r - p) };
        let (along, across) = (along * inverse, across * inverse);
        let mut worst = 0f64;
        for j in 0..=side {
            let start = corner + across * j as f64;
            let mut weigh = |i: usize, place: DVec3| {
                worst = worst.max((place - start - along * i as f64).length_squared());
            };
            let count = side - j + 1;
            if t.half == 0 {
                let first = self.row(b + j) + a;
                self.places[first..first + count].iter().enumerate().for_each(|(i, &place)| weigh(i, place));
            } else {
                let last = self.row(b - j) + a;
                let row = &self.places[last + 1 - count..=last];
                row.iter().rev().enumerate().for_each(|(i, &place)| weigh(i, place));
            }
        }
        worst.sqrt()
    }
}

/// The midpoint (0 = h, 1 = p, 2 = q) to which each template has a median.
const MEDIAN: [usize; 7] = [0, 0, 1, 0, 2, 0, 2];

/// E(c) of the seven configurations short of all, see above.
fn config_errors(whole: f64, children: f64, details: [DVec3; 3]) -> [f64; 7] {
    std::array::from_fn(|config| {
        if config == 0 {
            return whole;
        }
        let x = MEDIAN[config];
        let crossing = 0.5 * (details[x] - details[(x + 1) % 3] - details[(x + 2) % 3]).length();
        let (mut applied, mut left) = (0f64, crossing);
        for (bit, detail) in details.iter().enumerate() {
            let of = if config >> bit & 1 == 1 { &mut applied } else { &mut left };
            *of = of.max(detail.length());
        }
        (whole + applied).min(children + left)
    })
}
