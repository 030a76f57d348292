//! The base mesh: vertices of the source go one by one, each onto a neighbour, until few, well-shaped triangles are left. Every
//! step keeps the kind of surface, its parts and borders, and is written down so that points can be carried back through it.
//!
//! Based on: Lee, Sweldens, Schröder, Cowsar, Dobkin, "MAPS: Multiresolution Adaptive Parameterization of Surfaces", 1998 (what
//! stays is a part of the source's vertices; area and bend decide together); Garland and Heckbert, "Surface Simplification Using
//! Quadric Error Metrics", 1997 (the bend); Dey, Edelsbrunner, Guha, Nekhayev, "Topology preserving edge contraction", 1999.

use super::history::{History, Piece};
use super::source::Source;
use super::star::{MOST_NEIGHBOURS, Star};
use crate::collapse::quadric::Quadric;
use crate::collapse::stars::{Corner, Stars};
use glam::DVec3;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// How much the area that a vertex stands for counts beside the quadric error, so that flat parts keep triangles too.
const AREA_WEIGHT: f64 = 0.05;

/// How dear it is to cut off a tip, by the power that lays it flat: what stands out would be left without a vertex of its own.
const TIP_POWER: i32 = 3;

/// Weight of the planes that hold borders.
const BORDER_WEIGHT: f64 = 4.0;

/// The least quality that a new triangle may have in the plane of its step; an equilateral one has 1.
const LEAST_FLAT_QUALITY: f64 = 1e-3;

/// The least that it may have in space, unless a triangle before has less than twice its own.
const LEAST_QUALITY: f64 = 0.1;

/// Neighbours beyond which a vertex that gains them is dear.
const GOOD_NEIGHBOURS: usize = 7;

/// A corner of a triangle that has gone.
pub(super) const GONE: u32 = u32::MAX;

/// What is left, and how it came to be.
#[derive(Debug)]
pub(super) struct Decimated {
    /// Corners, as source vertices; triangles that have gone have none.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The way back.
    pub(super) history: History,
}

impl Decimated {
    /// Takes steps back until about so many triangles are there again.
    pub(super) fn go_back(&mut self, faces: usize) {
        let left = self.triangles.iter().filter(|t| t[0] != GONE).count();
        let begin = self.history.before(self.history.len(), left, faces);
        self.history.undo(begin..self.history.len(), &mut self.triangles);
        self.history.truncate(begin);
    }
}

/// A vertex's best move.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Move {
    /// Bits of the cost: of numbers that are not negative they sort as the numbers do.
    cost: u64,
    vertex: u32,
    onto: u32,
    stamp: u32,
}

struct Decimator<'a> {
    positions: &'a [DVec3],
    triangles: Vec<[u32; 3]>,
    stars: Stars,
    quadrics: Vec<Quadric>,
    /// Source area that each vertex stands for.
    areas: Vec<f64>,
    is_border: Vec<bool>,
    stamps: Vec<u32>,
    queue: BinaryHeap<Reverse<Move>>,
    history: History,
    marks: Vec<u32>,
    mark: u32,
}

/// Removes vertices until `target` triangles are left, or no more can go. `progress` hears how many are left.
pub(super) fn decimate(source: &Source, target: usize, progress: &dyn Fn(usize)) -> Decimated {
    let vertices = source.positions.len();
    let mut decimator = Decimator {
        positions: &source.positions,
        triangles: source.triangles().to_vec(),
        stars: Stars::new(source.triangles(), vertices),
        quadrics: vec![Quadric::default(); vertices],
        areas: vec![0.0; vertices],
        is_border: (0..vertices as u32).map(|v| source.surface.is_on_border(v)).collect(),
        stamps: vec![0; vertices],
        queue: BinaryHeap::with_capacity(2 * vertices),
        history: History::default(),
        marks: vec![0; vertices],
        mark: 0,
    };
    decimator.weigh(source);
    let mut star = Star::default();
    for v in 0..vertices as u32 {
        decimator.enqueue(v, &mut star);
    }
    let mut left = decimator.triangles.len();
    let mut steps = 0u32;
    while left > target {
        let Some(Reverse(best)) = decimator.queue.pop() else { break };
        if decimator.stamps[best.vertex as usize] != best.stamp {
            continue;
        }
        left -= decimator.perform(best, &mut star);
        steps += 1;
        if steps.is_multiple_of(4096) {
            progress(left);
        }
    }
    Decimated { triangles: decimator.triangles, history: decimator.history }
}

impl Decimator<'_> {
    /// Gives the vertices their planes and areas.
    fn weigh(&mut self, source: &Source) {
        for (t, corners) in source.triangles().iter().enumerate() {
            let [a, b, c] = source.corners(t as u32);
            let twice_area = (b - a).cross(c - a);
            let normal = twice_area.normalize_or_zero();
            let third = twice_area.length() / 6.0;
            let plane = Quadric::plane(normal, -normal.dot(a), third);
            for &v in corners {
                self.quadrics[v as usize] += plane;
                self.areas[v as usize] += third;
            }
            for side in (0..3).filter(|&side| source.across(t as u32, side).is_none()) {
                let [p, q] = [side, (side + 1) % 3].map(|k| self.positions[corners[k] as usize]);
                let across = (q - p).cross(normal).normalize_or_zero();
                let plane = Quadric::plane(across, -across.dot(p), BORDER_WEIGHT * (q - p).length_squared());
                self.quadrics[corners[side] as usize] += plane;
                self.quadrics[corners[(side + 1) % 3] as usize] += plane;
            }
        }
    }

    /// Works out a vertex's best move and puts it in the queue.
    fn enqueue(&mut self, vertex: u32, star: &mut Star) {
        self.stamps[vertex as usize] += 1;
        let neighbours = self.stars.of(vertex).len();
        if neighbours == 0 || neighbours >= MOST_NEIGHBOURS {
            return;
        }
        star.find(vertex, &self.stars, &self.triangles);
        if !star.flatten(vertex, self.positions) {
            return;
        }
        let mut best: Option<(f64, u32)> = None;
        for k in 0..star.ring.len() {
            if !star.is_closed && k != 0 && k + 1 != star.ring.len() {
                continue;
            }
            let Some(cost) = self.cost(vertex, star, k, best.map_or(f64::INFINITY, |b| b.0)) else { continue };
            if best.is_none_or(|b| cost < b.0) {
                best = Some((cost, star.ring[k]));
            }
        }
        if let Some((cost, onto)) = best {
            let stamp = self.stamps[vertex as usize];
            self.queue.push(Reverse(Move { cost: cost.to_bits(), vertex, onto, stamp }));
        }
    }

    /// What it costs to move a vertex onto its neighbour `k`; none where that may not be, or costs no less than `limit`.
    fn cost(&mut self, vertex: u32, star: &Star, k: usize, limit: f64) -> Option<f64> {
        let onto = star.ring[k];
        let [from, to] = [vertex, onto].map(|v| self.positions[v as usize]);
        let quadric = self.quadrics[vertex as usize] + self.quadrics[onto as usize];
        let mut turn = DVec3::ZERO;
        let mut worst_before = 1.0f64;
        for t in 0..star.corners.len() {
            let (twice_area, quality) = shape([t, star.after(t)].map(|k| self.positions[star.ring[k] as usize]), from);
            turn += twice_area;
            worst_before = worst_before.min(quality);
        }
        let bend = quadric.at(to);
        let even = (self.areas[vertex as usize] + self.areas[onto as usize]) * 2.6 * from.distance_squared(to);
        let plain = (bend + AREA_WEIGHT * even) * star.power.max(1.0).powi(TIP_POWER);
        if plain >= limit {
            return None;
        }
        let normal = turn.normalize_or_zero();
        let (mut worst, mut least_facing, mut count) = (1.0f64, 1.0f64, 0);
        for t in star.staying(k) {
            let (i, j) = (t, star.after(t));
            if flat_quality([star.flat[k], star.flat[i], star.flat[j]]) < LEAST_FLAT_QUALITY {
                return None;
            }
            let (twice_area, quality) = shape([i, j].map(|k| self.positions[star.ring[k] as usize]), to);
            worst = worst.min(quality);
            least_facing = least_facing.min(twice_area.normalize_or_zero().dot(normal));
            count += 1;
        }
        if worst < LEAST_QUALITY.min(0.5 * worst_before) {
            return None;
        }
        if count == 0 || !self.keeps_surface(vertex, star, k) {
            return None;
        }
        let shape = 1.0 / worst.max(1e-3).powi(2);
        let fold = if least_facing < 0.3 { 1.0 + 10.0 * (0.3 - least_facing) } else { 1.0 };
        let neighbours = self.stars.of(onto).len() + count - star.corners.len().saturating_sub(count);
        let crowd = neighbours.saturating_sub(GOOD_NEIGHBOURS) as f64;
        let lone = self.loses_a_neighbour_of_few(star, k);
        Some(plain * shape * fold * (1.0 + 0.3 * crowd * crowd) * lone)
    }

    /// A factor for neighbours that are left with three triangles.
    fn loses_a_neighbour_of_few(&self, star: &Star, k: usize) -> f64 {
        let beside = [k + 1, k + star.ring.len() - 1].map(|k| star.ring[k % star.ring.len()]);
        let few = beside.iter().filter(|&&v| !self.is_border[v as usize] && self.stars.of(v).len() <= 4);
        [1.0, 3.0, 9.0][few.count()]
    }

    /// The link condition, and that no triangle comes to be twice.
    fn keeps_surface(&mut self, vertex: u32, star: &Star, k: usize) -> bool {
        let onto = star.ring[k];
        let interior = star.is_closed;
        if interior && star.ring.len() < 3 || !interior && k != 0 && k + 1 != star.ring.len() {
            return false;
        }
        self.mark += 1;
        for &n in &star.ring {
            self.marks[n as usize] = self.mark;
        }
        self.marks[onto as usize] = 0;
        self.marks[vertex as usize] = 0;
        let mut common = 0;
        let mut shut = false;
        for corner in self.stars.of(onto) {
            let [_, b, c] = corner.turned(&self.triangles);
            for n in [b, c] {
                if self.marks[n as usize] == self.mark {
                    common += 1;
                    self.marks[n as usize] = 0;
                }
            }
            shut |= star.ring.len() == 3 && interior && ![b, c].contains(&vertex) && {
                let others = [(k + 1) % 3, (k + 2) % 3].map(|k| star.ring[k]);
                others.contains(&b) && others.contains(&c)
            };
        }
        common == if interior { 2 } else { 1 } && !shut
    }

    /// Does a move, if it may still be done; gives how many triangles went.
    fn perform(&mut self, best: Move, star: &mut Star) -> usize {
        let Move { vertex, onto, .. } = best;
        star.find(vertex, &self.stars, &self.triangles);
        let place = star.ring.iter().position(|&n| n == onto);
        let Some(k) = place.filter(|&k| self.keeps_surface(vertex, star, k)) else {
            self.enqueue(vertex, star);
            return 0;
        };
        if !star.flatten(vertex, self.positions) {
            return 0;
        }
        self.remember(vertex, star, k);
        let mut merged: Vec<Corner> = Vec::with_capacity(MOST_NEIGHBOURS);
        let staying: Vec<usize> = star.staying(k).collect();
        for (t, &corner) in star.corners.iter().enumerate() {
            if staying.contains(&t) {
                corner.set(&mut self.triangles, onto);
                merged.push(corner);
            } else {
                let triangle = corner.triangle();
                for n in [star.ring[t], star.ring[star.after(t)]] {
                    self.stars.remove(n, triangle);
                }
                self.triangles[triangle] = [GONE; 3];
            }
        }
        merged.extend_from_slice(self.stars.of(onto));
        self.stars.set(vertex, &[]);
        self.stars.set(onto, &merged);
        let quadric = self.quadrics[vertex as usize];
        self.quadrics[onto as usize] += quadric;
        let share = self.areas[vertex as usize] / star.ring.len() as f64;
        let ring = std::mem::take(&mut star.ring);
        for &n in &ring {
            self.areas[n as usize] += share;
        }
        self.stamps[vertex as usize] += 1;
        let went = star.corners.len() - staying.len();
        for &n in &ring {
            self.enqueue(n, star);
        }
        went
    }

    /// Writes a move down: the vertex is the last point of its plane.
    fn remember(&mut self, vertex: u32, star: &Star, k: usize) {
        let centre = star.flat.len() as u8;
        let mut points = star.flat.clone();
        points.push([0.0, 0.0]);
        let mut vertices = star.ring.clone();
        vertices.push(vertex);
        let piece = |t: usize, pivot: u8| {
            let corner = star.corners[t];
            let mut corners = [0; 3];
            let at = corner.place();
            corners[at] = pivot;
            corners[(at + 1) % 3] = t as u8;
            corners[(at + 2) % 3] = star.after(t) as u8;
            Piece { triangle: corner.triangle() as u32, corners }
        };
        let before: Vec<Piece> = (0..star.corners.len()).map(|t| piece(t, centre)).collect();
        let after: Vec<Piece> = star.staying(k).map(|t| piece(t, k as u8)).collect();
        self.history.push(&vertices, &points, &before, &after);
    }
}

/// How near a triangle is to an equilateral one, from twice its area and the sum of its squared sides.
fn quality(twice_area: f64, squared_sides: f64) -> f64 {
    if squared_sides > 0.0 { 2.0 * 3f64.sqrt() * twice_area / squared_sides } else { 0.0 }
}

/// Twice the area vector of a triangle and its quality.
fn shape([b, c]: [DVec3; 2], a: DVec3) -> (DVec3, f64) {
    let twice_area = (b - a).cross(c - a);
    let sides = a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a);
    (twice_area, quality(twice_area.length(), sides))
}

fn flat_quality([a, b, c]: [[f64; 2]; 3]) -> f64 {
    let square = |p: [f64; 2], q: [f64; 2]| (q[0] - p[0]).powi(2) + (q[1] - p[1]).powi(2);
    let twice_area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    quality(twice_area, square(a, b) + square(b, c) + square(c, a))
}
