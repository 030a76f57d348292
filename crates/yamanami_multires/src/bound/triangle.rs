//! The point of a triangle nearest to another point, and a distance that no point of it is nearer than.
//!
//! Based on: Ericson, "Real-Time Collision Detection", 2005 (Voronoi regions of a triangle).

use glam::DVec3;

/// A point of the triangle: the nearest one but for rounding. Whatever the triangle's shape it does lie on it, so the
/// distance to it is never too short.
#[inline]
pub(super) fn nearest(p: DVec3, [a, b, c]: &[DVec3; 3]) -> DVec3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return *a;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return *b;
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return *c;
    }
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    let sum = va + vb + vc;
    if va > 0.0 && vb > 0.0 && vc > 0.0 && sum.is_normal() {
        return a + ab * (vb / sum) + ac * (vc / sum);
    }
    // on an edge, or the triangle is so thin that the signs mean nothing: the nearest edge decides
    let ends = [[*a, *b], [*b, *c], [*c, *a]].map(|edge| nearest_on_edge(p, edge));
    let mut best = ends[0];
    for q in &ends[1..] {
        if (p - q).length_squared() < (p - best).length_squared() {
            best = *q;
        }
    }
    best
}

/// The point of an edge nearest to another point, but for rounding.
#[inline]
pub(crate) fn nearest_on_edge(p: DVec3, [from, to]: [DVec3; 2]) -> DVec3 {
    let along = to - from;
    let length = along.length_squared();
    if length > 0.0 { from + along * (along.dot(p - from) / length).clamp(0.0, 1.0) } else { from }
}

/// Square of the distance from a point to a triangle.
#[inline]
pub(crate) fn distance2(p: DVec3, triangle: &[DVec3; 3]) -> f64 {
    (p - nearest(p, triangle)).length_squared()
}

/// A length that the whole triangle is at least away from `p`: how far it lies beyond the plane through `p` that looks at
/// `q`. Equal to the distance where `q` is the nearest point.
pub(super) fn at_least(p: DVec3, q: DVec3, triangle: &[DVec3; 3]) -> f64 {
    let towards = q - p;
    let length = towards.length();
    if length == 0.0 {
        return 0.0;
    }
    let towards = towards / length;
    triangle.iter().map(|&corner| towards.dot(corner - p)).fold(f64::INFINITY, f64::min).max(0.0)
}
