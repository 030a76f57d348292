//! What each step of the decimation did to the parametrisation, and the way back: points of the base mesh are carried through the
//! steps, last one first, to the source.
//!
//! Based on: Lee, Sweldens, Schröder, Cowsar, Dobkin, "MAPS: Multiresolution Adaptive Parameterization of Surfaces", 1998 (stars
//! are flattened and triangulated anew in the plane); Liu, Kim, Chaudhuri, Aigerman, Jacobson, "Neural Subdivision", 2020 (points
//! are sent the other way, one step at a time, so that the map is one to one).

use super::source::Place;
use std::ops::Range;

const NONE: u32 = u32::MAX;

/// A triangle in the plane of a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    pub(super) triangle: u32,
    /// Which of the step's points its corners are.
    pub(super) corners: [u8; 3],
}

/// The same part of the plane cut in two ways.
#[derive(Debug, Clone, Copy, Default)]
struct Step {
    points: u32,
    before: u32,
    after: u32,
}

/// All steps, in order.
#[derive(Debug, Default)]
pub(super) struct History {
    points: Vec<[f64; 2]>,
    /// The vertex that each point is.
    vertices: Vec<u32>,
    before: Vec<Piece>,
    after: Vec<Piece>,
    /// Where each step begins.
    steps: Vec<Step>,
}

impl History {
    /// Adds a step: triangles before and after it over the same vertices at points of a plane.
    pub(super) fn push(&mut self, vertices: &[u32], points: &[[f64; 2]], before: &[Piece], after: &[Piece]) {
        self.steps.push(self.end());
        self.points.extend_from_slice(points);
        self.vertices.extend_from_slice(vertices);
        self.before.extend_from_slice(before);
        self.after.extend_from_slice(after);
    }

    /// Where the next step would begin.
    fn end(&self) -> Step {
        let [points, before, after] = [self.points.len(), self.before.len(), self.after.len()].map(|n| n as u32);
        Step { points, before, after }
    }

    fn step(&self, number: usize) -> Step {
        self.steps.get(number).copied().unwrap_or_else(|| self.end())
    }

    /// How many steps there are.
    pub(super) fn len(&self) -> usize {
        self.steps.len()
    }

    /// The step before which there were `faces` triangles or hardly more, if `left` are left after step `end`.
    pub(super) fn before(&self, end: usize, mut left: usize, faces: usize) -> usize {
        for number in (0..end).rev() {
            let (step, next) = (self.step(number), self.step(number + 1));
            left += (next.before - step.before) as usize - (next.after - step.after) as usize;
            if left >= faces {
                return number;
            }
        }
        0
    }

    /// Forgets all steps from one on.
    pub(super) fn truncate(&mut self, steps: usize) {
        let end = self.step(steps);
        self.steps.truncate(steps);
        self.points.truncate(end.points as usize);
        self.vertices.truncate(end.points as usize);
        self.before.truncate(end.before as usize);
        self.after.truncate(end.after as usize);
    }

    /// Undoes steps on the triangles.
    pub(super) fn undo(&self, steps: Range<usize>, triangles: &mut [[u32; 3]]) {
        for number in steps.rev() {
            let (step, next) = (self.step(number), self.step(number + 1));
            let vertices = &self.vertices[step.points as usize..];
            for piece in &self.before[step.before as usize..next.before as usize] {
                triangles[piece.triangle as usize] = piece.corners.map(|k| vertices[usize::from(k)]);
            }
        }
    }

    /// Carries places in triangles after some steps to those before them.
    pub(super) fn carry_back(&self, steps: Range<usize>, triangles: usize, places: &mut [Place]) {
        // the places in each triangle, as a list linked through them
        let mut first = vec![NONE; triangles];
        let mut next = vec![NONE; places.len()];
        let put = |first: &mut [u32], next: &mut [u32], place: u32, triangle: u32| {
            next[place as usize] = std::mem::replace(&mut first[triangle as usize], place);
        };
        for (k, place) in places.iter().enumerate() {
            put(&mut first, &mut next, k as u32, place.triangle);
        }
        let mut moved: Vec<(u32, [f64; 2])> = Vec::new();
        for number in steps.rev() {
            let (step, end) = (self.step(number), self.step(number + 1));
            let points = &self.points[step.points as usize..end.points as usize];
            let before = &self.before[step.before as usize..end.before as usize];
            for piece in &self.after[step.after as usize..end.after as usize] {
                let [a, b, c] = piece.corners.map(|k| points[usize::from(k)]);
                let mut at = std::mem::replace(&mut first[piece.triangle as usize], NONE);
                while at != NONE {
                    let [u, v, w] = places[at as usize].shares;
                    moved.push((at, [0, 1].map(|axis| a[axis] * u + b[axis] * v + c[axis] * w)));
                    at = next[at as usize];
                }
            }
            for (at, point) in moved.drain(..) {
                let place = locate(points, before, point);
                places[at as usize] = place;
                put(&mut first, &mut next, at, place.triangle);
            }
        }
    }
}

/// The piece in which a point lies, or nearly.
fn locate(points: &[[f64; 2]], pieces: &[Piece], at: [f64; 2]) -> Place {
    let mut best = (f64::NEG_INFINITY, Place::corner(pieces[0].triangle, 0));
    for piece in pieces {
        let shares = shares(at, piece.corners.map(|k| points[usize::from(k)]));
        let least = shares[0].min(shares[1]).min(shares[2]);
        if least > best.0 {
            best = (least, Place { triangle: piece.triangle, shares });
        }
        if least >= 0.0 {
            break;
        }
    }
    let inside = best.1.shares.map(|s| s.max(0.0));
    let sum: f64 = inside.iter().sum();
    Place { triangle: best.1.triangle, shares: inside.map(|s| s / sum) }
}

fn shares(p: [f64; 2], [a, b, c]: [[f64; 2]; 3]) -> [f64; 3] {
    let area = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    let all = area(a, b, c);
    let (u, v) = (area(p, b, c) / all, area(a, p, c) / all);
    [u, v, 1.0 - u - v]
}
