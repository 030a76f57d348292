//! The overlay of two triangulations in plan: every piece that a triangle of one shares with a triangle of the other.
//!
//! Based on: Sutherland, Hodgman, "Reentrant polygon clipping", 1974. Both heights are linear on a piece, so what is
//! integrated over the pieces is exact. Pieces are cut in the frame of a corner of the first triangle: large coordinates
//! cost no digits, and triangles that only touch share exactly nothing.

use super::PlanIndex;
use super::locate::{PlanBox, plan_corners, plan_turn};
use super::plane::Plane;
use super::twins::twins;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use yamanami_core::TriangleMesh;

/// Triangles of the first surface handled by one task; also the grouping of sums, so part of the result's last bits.
const CHUNK: usize = 2048;

/// A convex piece that two triangles share.
pub(super) struct Piece<'a> {
    /// Place of the frame of `corners`.
    pub(super) origin: DVec2,
    /// Corners in plan, counter-clockwise.
    pub(super) corners: &'a [DVec2],
    /// The planes of both triangles, in the same frame.
    pub(super) planes: [Plane; 2],
}

impl Piece<'_> {
    /// Plan area, square metres.
    fn area(&self) -> f64 {
        let mut area = 0.0;
        self.differences(|part, _| area += part);
        area
    }

    /// Calls `each` with area and height differences (second less first) of the triangles of a fan over the piece.
    pub(super) fn differences(&self, mut each: impl FnMut(f64, [f64; 3])) {
        let [first, second] = &self.planes;
        let difference = |p: DVec2| second.height(p) - first.height(p);
        let [apex, rest @ ..] = self.corners else { return };
        for pair in rest.windows(2) {
            let area = (pair[0] - *apex).perp_dot(pair[1] - *apex) / 2.0;
            each(area, [difference(*apex), difference(pair[0]), difference(pair[1])]);
        }
    }
}

/// Sums over all pieces on which the surfaces may differ, one a chunk of the first surface's triangles, in their order;
/// and the plan area of the triangles that are the same in both.
pub(super) fn fold<S: Default + Send>(
    first: &TriangleMesh,
    second: &PlanIndex<'_>,
    add: impl Fn(&mut S, &Piece<'_>) + Sync,
) -> (Vec<S>, f64) {
    let [same, same_in_second] = twins(first, second.mesh());
    let chunks = first.triangles.len().div_ceil(CHUNK);
    let sums: Vec<(S, f64)> = (0..chunks)
        .into_par_iter()
        .map(|chunk| {
            let (mut sums, mut same_m2, mut clip) = (S::default(), 0.0, Clip::default());
            for t in chunk * CHUNK..first.triangles.len().min((chunk + 1) * CHUNK) {
                if same[t] {
                    same_m2 += triangle_area(first.corners(t));
                    continue;
                }
                clip.pieces(first, t as u32, second, |other, piece| {
                    if !same_in_second[other as usize] {
                        add(&mut sums, piece);
                    }
                });
            }
            (sums, same_m2)
        })
        .collect();
    let same_m2 = sums.iter().map(|(_, same_m2)| same_m2).sum();
    (sums.into_iter().map(|(sums, _)| sums).collect(), same_m2)
}

/// Plan area that triangles of a surface share with others of it, square metres.
pub(super) fn overlap_m2(index: &PlanIndex<'_>) -> f64 {
    let mesh = index.mesh();
    let count = mesh.triangles.len();
    let chunk = |chunk: usize| {
        let (mut area, mut clip) = (0.0, Clip::default());
        for t in chunk * CHUNK..count.min((chunk + 1) * CHUNK) {
            clip.pieces(mesh, t as u32, index, |other, piece| {
                if (t as u32) < other {
                    area += piece.area();
                }
            });
        }
        area
    };
    (0..count.div_ceil(CHUNK)).into_par_iter().map(chunk).collect::<Vec<f64>>().into_iter().sum()
}

/// Plan area of a surface, square metres.
pub(super) fn plan_area(mesh: &TriangleMesh) -> f64 {
    let chunk = |triangles: &[[u32; 3]]| -> f64 { triangles.iter().map(|t| triangle_area(corners(mesh, t))).sum() };
    mesh.triangles.par_chunks(CHUNK).map(chunk).collect::<Vec<_>>().into_iter().sum()
}

fn corners(mesh: &TriangleMesh, triangle: &[u32; 3]) -> [DVec3; 3] {
    triangle.map(|i| mesh.positions[i as usize])
}

/// Plan area of a triangle; 0 where a corner is not finite.
pub(super) fn triangle_area([a, b, c]: [DVec3; 3]) -> f64 {
    if !(a.is_finite() && b.is_finite() && c.is_finite()) {
        return 0.0;
    }
    (b - a).truncate().perp_dot((c - a).truncate()).abs() / 2.0
}

/// Memory of a cut, used again and again.
#[derive(Default)]
struct Clip {
    polygon: Vec<DVec2>,
    spare: Vec<DVec2>,
}

impl Clip {
    /// Calls `each` with every triangle of `second` that shares a piece with triangle `t` of `first`, and that piece.
    fn pieces(&mut self, first: &TriangleMesh, t: u32, second: &PlanIndex<'_>, mut each: impl FnMut(u32, &Piece<'_>)) {
        let turn = plan_turn(first, t);
        if turn == 0.0 {
            return;
        }
        let corners = first.corners(t as usize);
        let origin = corners[0].truncate();
        let local = |corners: [DVec3; 3]| corners.map(|p| p - origin.extend(0.0));
        let mut own = local(corners);
        let plane = Plane::of(own);
        if turn < 0.0 {
            own.swap(1, 2);
        }
        let own = own.map(|p| p.truncate());
        let bounds = PlanBox::of(plan_corners(first, t));
        second.visit(
            |b| b.meets(&bounds),
            |other| {
                if !PlanBox::of(plan_corners(second.mesh(), other)).meets(&bounds) {
                    return;
                }
                let theirs = local(second.mesh().corners(other as usize));
                let [a, b, c] = theirs.map(|p| p.truncate());
                let ring = if (b - a).perp_dot(c - a) < 0.0 { [a, c, b] } else { [a, b, c] };
                self.polygon.clear();
                self.polygon.extend(own);
                for (from, to) in [(ring[0], ring[1]), (ring[1], ring[2]), (ring[2], ring[0])] {
                    self.keep_left(from, to);
                }
                if self.polygon.len() >= 3 {
                    each(other, &Piece { origin, corners: &self.polygon, planes: [plane, Plane::of(theirs)] });
                }
            },
        );
    }

    /// Cuts off what lies right of a line.
    fn keep_left(&mut self, from: DVec2, to: DVec2) {
        let side = |p: DVec2| (to - from).perp_dot(p - from);
        self.spare.clear();
        let Some(&last) = self.polygon.last() else { return };
        let (mut before, mut before_side) = (last, side(last));
        for &p in &self.polygon {
            let here = side(p);
            if (before_side < 0.0) != (here < 0.0) && before_side != 0.0 && here != 0.0 {
                self.spare.push(before + (p - before) * (before_side / (before_side - here)));
            }
            if here >= 0.0 {
                self.spare.push(p);
            }
            (before, before_side) = (p, here);
        }
        std::mem::swap(&mut self.polygon, &mut self.spare);
    }
}
