//! The distance between two surfaces, bounded: never less than the true one, and above it by no more than a stated gap.
//!
//! Samples only ever show that two surfaces are at least so far apart. A reduced model that promises a tolerance needs the
//! other side: a number that no point of either surface is beyond. It holds for surfaces of any kind, open or not manifold,
//! with needles or in pieces, and rounding is counted in.
//!
//! Based on: Guthe, Borodin, Klein, "Fast and accurate Hausdorff distance calculation between meshes", 2005 (bounds by
//! convexity over one triangle, refined only where the maximum may be); Tang, Lee, Kim, "Interactive Hausdorff distance
//! computation for general polygonal models", 2009. Cutting pieces along the edges of the nearest triangle is ours: bisection
//! needs ever smaller pieces along every edge of the other surface, the smaller the distance the more.

mod frame;
mod piece;
mod search;
mod tree;
pub(crate) mod triangle;

use frame::{Frame, SLACK};
use glam::DVec3;
use rayon::prelude::*;
use search::{Direction, Far, Goal, Outcome};
use tree::{Near, Tree};
use yamanami_core::TriangleMesh;

/// How well to bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundOptions {
    /// The larger of both directions is bounded to this share of itself: 0.05 for five per cent.
    pub relative_gap: f64,
    /// Stops as soon as it is known whether the distance is within this, metres: the upper bound is then not above it, or the
    /// lower one is beyond. 0 to bound the distance itself.
    pub at_most_m: f64,
    /// Stops cutting after so many steps, of about a microsecond each, with a larger gap. None for a few hundred a triangle.
    pub most_steps: Option<u64>,
}

impl Default for BoundOptions {
    fn default() -> Self {
        Self { relative_gap: 0.05, at_most_m: 0.0, most_steps: None }
    }
}

/// The distance of one surface's farthest point to the other, from both sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DistanceBound {
    /// No point is farther, metres. Infinite where the other surface has no triangle, a corner is not finite, or the distance
    /// is beyond what was asked.
    pub upper_m: f64,
    /// Some point is at least so far, metres.
    pub lower_m: f64,
    /// That point.
    pub place: DVec3,
    /// The triangle it lies on.
    pub triangle: u32,
}

/// The distance between two surfaces, both ways.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoWayBound {
    /// From points of the first to the second.
    pub a_to_b: DistanceBound,
    /// From points of the second to the first.
    pub b_to_a: DistanceBound,
}

impl TwoWayBound {
    /// The Hausdorff distance is not larger, metres.
    pub fn upper_m(&self) -> f64 {
        self.a_to_b.upper_m.max(self.b_to_a.upper_m)
    }

    /// The Hausdorff distance is not smaller, metres.
    pub fn lower_m(&self) -> f64 {
        self.a_to_b.lower_m.max(self.b_to_a.lower_m)
    }
}

/// A triangle that is not known to be within a distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beyond {
    /// The triangle.
    pub triangle: u32,
    /// A point of it that is, or may be, too far.
    pub place: DVec3,
    /// How far that point is, metres, but for rounding.
    pub distance_m: f64,
    /// The triangle of the other surface nearest to that point.
    pub nearest: u32,
}

/// Bounds the distance between two surfaces. The smaller direction is only worked out as far as the larger one needs it.
/// The result depends on the meshes and options only. A surface without triangles is infinitely far from one with some.
///
/// # Panics
/// When a triangle names a vertex that its mesh does not have.
pub fn distance_bound(a: &TriangleMesh, b: &TriangleMesh, options: &BoundOptions) -> TwoWayBound {
    let same = |upper_m: f64, lower_m: f64| DistanceBound { upper_m, lower_m, place: DVec3::ZERO, triangle: 0 };
    let both = |a_to_b, b_to_a| TwoWayBound { a_to_b, b_to_a };
    let Some(frame) = Frame::around(&[a, b]) else {
        return both(same(f64::INFINITY, 0.0), same(f64::INFINITY, 0.0));
    };
    // no point of an empty surface is far from anything
    match (a.triangles.is_empty(), b.triangles.is_empty()) {
        (true, true) => return both(same(0.0, 0.0), same(0.0, 0.0)),
        (true, false) => return both(same(0.0, 0.0), same(f64::INFINITY, f64::INFINITY)),
        (false, true) => return both(same(f64::INFINITY, f64::INFINITY), same(0.0, 0.0)),
        (false, false) => {}
    }
    let [tree_a, tree_b] = trees([a, b], &frame);
    let goal = Goal::Greatest { gap: options.relative_gap.max(0.0), at_most: limit(&frame, options.at_most_m) };
    let [ab, ba] = outcomes([a, b], [&tree_a, &tree_b], goal, options.most_steps);
    let bound = |outcome: &Outcome, from: &Tree, to: &Tree| DistanceBound {
        upper_m: frame.upper_m(outcome.upper2.sqrt().next_up()),
        lower_m: frame.lower_m(to.at_least(outcome.farthest.place)),
        place: frame.metres(outcome.farthest.place),
        triangle: from.numbers[outcome.farthest.face as usize],
    };
    both(bound(&ab, &tree_a, &tree_b), bound(&ba, &tree_b, &tree_a))
}

/// The triangles of each surface that are not known to lie within `limit_m` of the other one: where there are none, the
/// Hausdorff distance is within it for certain. A triangle is listed with a point that is too far, or that could not be shown
/// not to be. `limit_m` cannot be less than what rounding needs, 10^-12 of the size of the models.
///
/// # Panics
/// When a triangle names a vertex that its mesh does not have.
pub fn faces_beyond(a: &TriangleMesh, b: &TriangleMesh, limit_m: f64) -> [Vec<Beyond>; 2] {
    let all = |from: &TriangleMesh| {
        let beyond =
            |t: usize| Beyond { triangle: t as u32, place: from.corners(t)[0], distance_m: f64::INFINITY, nearest: 0 };
        (0..from.triangles.len()).map(beyond).collect::<Vec<_>>()
    };
    let Some(frame) = Frame::around(&[a, b]) else { return [all(a), all(b)] };
    if a.triangles.is_empty() || b.triangles.is_empty() {
        return [all(a), all(b)];
    }
    let [tree_a, tree_b] = trees([a, b], &frame);
    beyond([a, b], [&tree_a, &tree_b], &frame, limit_m)
}

fn beyond(meshes: [&TriangleMesh; 2], trees: [&Tree; 2], frame: &Frame, limit_m: f64) -> [Vec<Beyond>; 2] {
    let goal = Goal::Within { limit: limit(frame, limit_m) };
    let found = outcomes(meshes, trees, goal, None);
    std::array::from_fn(|k| {
        let (from, to) = (trees[k], trees[1 - k]);
        let beyond = |far: &Far| Beyond {
            triangle: from.numbers[far.face as usize],
            place: frame.metres(far.place),
            distance_m: frame.length_in_metres(far.distance2.sqrt()),
            nearest: to.numbers[far.near as usize],
        };
        let mut all: Vec<Beyond> = found[k].beyond.iter().map(beyond).collect();
        all.sort_by_key(|b| b.triangle);
        all
    })
}

/// A surface that others are held against, one after the other.
#[derive(Debug)]
pub(crate) struct Judge<'a> {
    mesh: &'a TriangleMesh,
    /// Twice as wide as the mesh, for the others to have room; none where the mesh cannot be judged by.
    prepared: Option<(Frame, Tree)>,
}

impl<'a> Judge<'a> {
    /// Prepares a surface.
    pub(crate) fn new(mesh: &'a TriangleMesh) -> Self {
        let frame = Frame::around(&[mesh]).filter(|_| !mesh.triangles.is_empty()).map(Frame::twice);
        Self { mesh, prepared: frame.map(|frame| (frame, Tree::new(mesh, &frame))) }
    }

    /// As [`faces_beyond`], the judge first.
    pub(crate) fn faces_beyond(&self, other: &TriangleMesh, limit_m: f64) -> [Vec<Beyond>; 2] {
        match &self.prepared {
            Some((frame, tree)) if !other.triangles.is_empty() && frame.holds(other) => {
                beyond([self.mesh, other], [tree, &Tree::new(other, frame)], frame, limit_m)
            }
            _ => faces_beyond(self.mesh, other, limit_m),
        }
    }

    /// The triangle nearest to each place; 0 for a surface that has none.
    pub(crate) fn nearest(&self, places: &[DVec3]) -> Vec<u32> {
        let Some((frame, tree)) = &self.prepared else { return vec![0; places.len()] };
        let nearest = |&place: &DVec3| tree.numbers[tree.nearest(frame.unit(place), Near::NOTHING).slot as usize];
        places.iter().map(nearest).collect()
    }

    /// The distance of each place, metres; infinite for a surface that has no triangle.
    pub(crate) fn distances_m(&self, places: &[DVec3]) -> Vec<f64> {
        let Some((frame, tree)) = &self.prepared else { return vec![f64::INFINITY; places.len()] };
        let distance = |&p: &DVec3| frame.length_in_metres(tree.nearest(frame.unit(p), Near::NOTHING).distance2.sqrt());
        places.par_iter().map(distance).collect()
    }
}

/// A limit in units, less what rounding may add.
fn limit(frame: &Frame, limit_m: f64) -> f64 {
    (frame.length_in_units(limit_m) * (1.0 - 4.0 * f64::EPSILON) - SLACK).max(0.0)
}

fn trees(meshes: [&TriangleMesh; 2], frame: &Frame) -> [Tree; 2] {
    meshes.map(|mesh| Tree::new(mesh, frame))
}

fn outcomes(meshes: [&TriangleMesh; 2], trees: [&Tree; 2], goal: Goal, most_steps: Option<u64>) -> [Outcome; 2] {
    let direction = |from: usize, to: usize| {
        Direction::new(trees[from], &meshes[from].triangles, meshes[from].positions.len(), trees[to], goal)
    };
    let faces = meshes[0].triangles.len() + meshes[1].triangles.len();
    let most_steps = most_steps.unwrap_or(faces as u64 * STEPS_A_FACE + STEPS_ANYWAY);
    search::search([&direction(0, 1), &direction(1, 0)], goal, most_steps)
}

/// Steps by default, for each triangle and for any mesh.
const STEPS_A_FACE: u64 = 200;
const STEPS_ANYWAY: u64 = 1 << 20;
