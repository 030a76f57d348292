//! The plane of a triangle, evaluated without losing digits to large coordinates.
//!
//! The corners are put in order first, so that a triangle gives the same height to the last bit whichever way round its
//! file names them: two copies of a surface differ by exactly nothing.

use glam::{DVec2, DVec3};

/// Of a triangle that is thinner than this share of its length only its longest side is left: what rounding does to the
/// corners of a piece would go up and down its plane by metres.
const THINNEST: f64 = 1e-9;

/// Height as a linear function of place over a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Plane {
    corner: DVec3,
    /// Metres of height a metre east and north.
    pub(super) gradient: DVec2,
    /// Least and greatest height of the corners: rounding on slivers never leads out of them.
    span: [f64; 2],
}

impl Plane {
    /// The plane of a triangle with an area in plan.
    pub(super) fn of(mut corners: [DVec3; 3]) -> Self {
        corners.sort_unstable_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)).then(p.z.total_cmp(&q.z)));
        let [a, b, c] = corners;
        let (u, v) = (b - a, c - a);
        let turn = u.x * v.y - u.y * v.x;
        // in this order the first and the last corner are the ends of the longest side of a thin one
        let length2_m2 = v.truncate().length_squared();
        let gradient = if turn.abs() > THINNEST * length2_m2 {
            DVec2::new(u.z * v.y - v.z * u.y, v.z * u.x - u.z * v.x) / turn
        } else if length2_m2 > 0.0 {
            v.truncate() * (v.z / length2_m2)
        } else {
            DVec2::ZERO
        };
        Self { corner: a, gradient, span: [a.z.min(b.z).min(c.z), a.z.max(b.z).max(c.z)] }
    }

    /// Height at a place in the frame of the corners.
    pub(super) fn height(&self, place: DVec2) -> f64 {
        (self.corner.z + self.gradient.dot(place - self.corner.truncate())).clamp(self.span[0], self.span[1])
    }
}
