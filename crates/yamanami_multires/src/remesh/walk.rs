//! Walks over the source: to the point nearest to a target, along the border, straight on, and to where a line pierces the surface.
//! Each goes from triangle to neighbour, so it stays on the sheet on which it begins.

use super::source::{Place, Source};
use glam::DVec3;

/// Steps after which a walk gives up. Each step of a walk comes nearer, so that only a hostile mesh needs so many.
const MOST_STEPS: usize = 1 << 14;

/// Triangles that a line is looked for in: without this a walk could go round in circles.
const MOST_PIERCED: usize = 256;

/// How far a walk along the border goes, by the distance of its target.
const BORDER_WAY: f64 = 3.0;

/// Triangles that a straight way goes over, at most.
const MOST_TRACED: usize = 4096;

/// Where a walk ended.
#[derive(Debug, Clone, Copy)]
pub(super) struct Found {
    pub(super) place: Place,
    pub(super) position: DVec3,
    /// Square of the distance to the target.
    pub(super) distance2: f64,
}

/// The point nearest to `target` that is reached without ever going away from it.
pub(super) fn descend(source: &Source, from: Place, target: DVec3) -> Found {
    let mut best = nearest(source, from.triangle, target);
    for _ in 0..MOST_STEPS {
        let [u, v, w] = best.place.shares.map(|s| s <= 0.0);
        let next = match (u, v, w) {
            (false, false, false) => None,
            // on a side: only what lies across can be nearer
            (true, false, false) => across(source, best, 1, target),
            (false, true, false) => across(source, best, 2, target),
            (false, false, true) => across(source, best, 0, target),
            (false, true, true) => around(source, best, 0, target),
            (true, false, true) => around(source, best, 1, target),
            _ => around(source, best, 2, target),
        };
        match next {
            Some(next) if next.distance2 < best.distance2 => best = next,
            _ => break,
        }
    }
    best
}

fn across(source: &Source, at: Found, side: usize, target: DVec3) -> Option<Found> {
    let (other, _) = source.across(at.place.triangle, side)?;
    Some(nearest(source, other, target))
}

/// The best of the triangles around a corner.
fn around(source: &Source, at: Found, corner: usize, target: DVec3) -> Option<Found> {
    let vertex = source.triangles()[at.place.triangle as usize][corner];
    let fan = source.surface.fan(vertex).iter();
    fan.map(|&(t, _)| nearest(source, t, target)).min_by(|a, b| a.distance2.total_cmp(&b.distance2))
}

/// The point of a triangle nearest to a target.
fn nearest(source: &Source, triangle: u32, target: DVec3) -> Found {
    let corners = source.corners(triangle);
    let shares = nearest_shares(target, corners);
    let position = super::source::blend(corners, shares);
    Found { place: Place { triangle, shares }, position, distance2: position.distance_squared(target) }
}

/// Barycentric coordinates of the point of a triangle nearest to `p`, by its Voronoi regions (Ericson, "Real-Time Collision
/// Detection", 2005).
fn nearest_shares(p: DVec3, [a, b, c]: [DVec3; 3]) -> [f64; 3] {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let share = |part: f64, rest: f64| if part + rest > 0.0 { part / (part + rest) } else { 0.0 };
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let v = share(d1, -d3);
        return [1.0 - v, v, 0.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let w = share(d2, -d6);
        return [1.0 - w, 0.0, w];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let w = share(d4 - d3, d5 - d6);
        return [0.0, 1.0 - w, w];
    }
    let sum = va + vb + vc;
    if sum > 0.0 && sum.is_finite() { [va / sum, vb / sum, vc / sum] } else { [1.0, 0.0, 0.0] }
}

/// The point of the border nearest to `target` on the way along it, a few times as far as the target is away: borders of scans are
/// ragged, and a walk that must always come nearer would be caught. None where the place is not at the border.
pub(super) fn descend_border(source: &Source, from: Place, target: DVec3) -> Option<Found> {
    let start = border_side(source, from)?;
    let mut best = nearest_of_side(source, start, target);
    let farthest = BORDER_WAY * source.position(from).distance(target);
    for forwards in [true, false] {
        let (mut side, mut gone) = (start, 0.0);
        for _ in 0..MOST_STEPS {
            let corners = source.triangles()[side.0 as usize];
            // a fan goes from the border edge that leaves its vertex to the one that comes into it
            let next = if forwards {
                source.surface.fan(corners[(side.1 + 1) % 3]).first().map(|&(t, k)| (t, usize::from(k)))
            } else {
                source.surface.fan(corners[side.1]).last().map(|&(t, k)| (t, (usize::from(k) + 2) % 3))
            };
            side = next.filter(|&next| next != start && gone <= farthest).unwrap_or(start);
            if side == start {
                break;
            }
            let at = source.corners(side.0);
            gone += at[side.1].distance(at[(side.1 + 1) % 3]);
            let there = nearest_of_side(source, side, target);
            if there.distance2 < best.distance2 {
                best = there;
            }
        }
    }
    Some(best)
}

/// The border side that a place lies on, but for rounding: a side of its triangle, or one at the corner where it is.
fn border_side(source: &Source, place: Place) -> Option<(u32, usize)> {
    let Place { triangle, shares } = place;
    let least = |ways: &mut dyn Iterator<Item = (f64, usize)>| ways.min_by(|a, b| a.0.total_cmp(&b.0));
    let open = (0..3).filter(|&side| source.across(triangle, side).is_none());
    let side = least(&mut open.map(|side| (shares[(side + 2) % 3], side)));
    let corners = source.triangles()[triangle as usize];
    let on_border = (0..3).filter(|&k| source.surface.is_on_border(corners[k]));
    let corner = least(&mut on_border.map(|k| (1.0 - shares[k], k)));
    match (side, corner) {
        (Some(side), Some(corner)) if side.0 <= corner.0 => Some((triangle, side.1)),
        (_, Some(corner)) => source.surface.fan(corners[corner.1]).first().map(|&(t, k)| (t, usize::from(k))),
        (side, None) => side.map(|side| (triangle, side.1)),
    }
}

fn nearest_of_side(source: &Source, (triangle, side): (u32, usize), target: DVec3) -> Found {
    let corners = source.corners(triangle);
    let (a, b) = (corners[side], corners[(side + 1) % 3]);
    let along = b - a;
    let length2 = along.length_squared();
    let share = if length2 > 0.0 { (along.dot(target - a) / length2).clamp(0.0, 1.0) } else { 0.0 };
    let mut shares = [0.0; 3];
    shares[side] = 1.0 - share;
    shares[(side + 1) % 3] = share;
    let position = a + along * share;
    Found { place: Place { triangle, shares }, position, distance2: position.distance_squared(target) }
}

/// Where the line through `p` along `normal` pierces the surface, walking from a triangle near it; none where the walk comes to
/// the border or to a triangle that faces away.
pub(super) fn pierce(source: &Source, from: u32, p: DVec3, normal: DVec3) -> Option<Found> {
    let (x, y) = normal.any_orthonormal_pair();
    let mut triangle = from;
    for _ in 0..MOST_PIERCED {
        let corners = source.corners(triangle);
        let flat = corners.map(|c| [x.dot(c - p), y.dot(c - p)]);
        // twice the areas that the line's point makes with each side
        let areas = [0, 1, 2].map(|k| {
            let ([px, py], [qx, qy]) = (flat[k], flat[(k + 1) % 3]);
            px * qy - py * qx
        });
        let sum = areas[0] + areas[1] + areas[2];
        if sum <= 0.0 {
            return None;
        }
        let side = (0..3).min_by(|&j, &k| areas[j].total_cmp(&areas[k]))?;
        if areas[side] >= 0.0 {
            let shares = [areas[1] / sum, areas[2] / sum, areas[0] / sum];
            let position = super::source::blend(corners, shares);
            let found = Found { place: Place { triangle, shares }, position, distance2: position.distance_squared(p) };
            return Some(found);
        }
        triangle = source.across(triangle, side)?.0;
    }
    None
}

/// Goes straight on over the surface, as far as `way` is long and in its direction; a border ends it just before.
pub(super) fn trace(source: &Source, from: Place, way: DVec3) -> Place {
    let Place { mut triangle, mut shares } = from;
    let mut left = way.length();
    let mut direction = way;
    let mut entered = usize::MAX;
    for _ in 0..MOST_TRACED {
        let corners = source.corners(triangle);
        let (e, f) = (corners[1] - corners[0], corners[2] - corners[0]);
        let twice_area = e.cross(f);
        let normal = twice_area.normalize_or_zero();
        direction = (direction - normal * normal.dot(direction)).normalize_or_zero();
        let square = twice_area.length_squared();
        if !(left > 0.0 && square > 0.0) {
            break;
        }
        let step = direction * left;
        let (v, w) = (step.cross(f).dot(twice_area) / square, e.cross(step).dot(twice_area) / square);
        let rates = [-v - w, v, w];
        // the corner whose share is used up first
        let mut exit = (1.0, None);
        for k in (0..3).filter(|&k| rates[k] < 0.0 && k != entered) {
            let until = shares[k] / -rates[k];
            if until < exit.0 {
                exit = (until, Some(k));
            }
        }
        let Some(corner) = exit.1 else {
            shares = sound(std::array::from_fn(|k| shares[k] + rates[k]));
            break;
        };
        let side = (corner + 1) % 3;
        let Some((other, there)) = source.across(triangle, side) else {
            shares = sound(std::array::from_fn(|k| shares[k] + 0.9 * exit.0 * rates[k]));
            break;
        };
        shares = sound(std::array::from_fn(|k| if k == corner { 0.0 } else { shares[k] + exit.0 * rates[k] }));
        left *= 1.0 - exit.0;
        let along = (corners[(side + 1) % 3] - corners[side]).normalize_or_zero();
        let (ahead, across) = (direction.dot(along), direction.dot(along.cross(normal)));
        let [a, b, c] = source.corners(other);
        direction = along * ahead + along.cross((b - a).cross(c - a).normalize_or_zero()) * across;
        let mut entering = [0.0; 3];
        entering[there] = shares[(side + 1) % 3];
        entering[(there + 1) % 3] = shares[side];
        (triangle, shares, entered) = (other, entering, (there + 2) % 3);
    }
    Place { triangle, shares }
}

/// Shares of which rounding has made none negative.
fn sound(shares: [f64; 3]) -> [f64; 3] {
    let shares = shares.map(|s| s.max(0.0));
    let sum: f64 = shares.iter().sum();
    shares.map(|s| s / sum)
}
