//! Faces as files have them made those of a TIN: counter-clockwise from above, with an area in plan, of finite vertices.
//!
//! Based on: J. R. Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", 1997
//! (which way a triangle turns is exact).

use super::Notes;
use glam::DVec3;
use robust::{Coord, orient2d};
use std::fmt::Display;

/// Twice the signed area in plan; the sign is exact.
pub(super) fn plan_area([a, b, c]: [DVec3; 3]) -> f64 {
    let plan = |p: DVec3| Coord { x: p.x, y: p.y };
    orient2d(plan(a), plan(b), plan(c))
}

/// A triangle as a TIN has it, counter-clockwise from above, of corners whose places are told by `place`; `None` for one
/// that has no area in plan. What was changed is counted in the notes, as being `at` some place of the file.
pub(super) fn upward<T: Copy>(
    [a, b, c]: [T; 3],
    place: impl Fn(T) -> DVec3,
    notes: &mut Notes,
    at: impl Display,
) -> Option<[T; 3]> {
    let corners = [a, b, c].map(place);
    if !corners.iter().all(|p| p.is_finite()) {
        notes.count("faces with a corner that is no finite number dropped", at);
        return None;
    }
    let area = plan_area(corners);
    if area == 0.0 || !area.is_finite() {
        notes.count("faces that are vertical or without an area dropped", at);
        return None;
    }
    if area > 0.0 {
        return Some([a, b, c]);
    }
    notes.count("faces that were clockwise from above turned over", at);
    Some([a, c, b])
}

/// The two triangles of a quadrilateral, by the numbers of its corners: along the diagonal that lies inside, the shorter
/// of two, the one from the first corner of two equal ones.
pub(super) fn cut_quad(quad: [DVec3; 4]) -> [[usize; 3]; 2] {
    const ALONG: [[usize; 3]; 2] = [[0, 1, 2], [0, 2, 3]];
    const ACROSS: [[usize; 3]; 2] = [[0, 1, 3], [1, 2, 3]];
    let inside = |cut: [[usize; 3]; 2]| {
        let [one, other] = cut.map(|corners| plan_area(corners.map(|k| quad[k])));
        one > 0.0 && other > 0.0 || one < 0.0 && other < 0.0
    };
    let [a, b, c, d] = quad;
    match (inside(ALONG), inside(ACROSS)) {
        (true, false) => ALONG,
        (false, true) => ACROSS,
        _ if b.distance_squared(d) < a.distance_squared(c) => ACROSS,
        _ => ALONG,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_are_turned_and_dropped_and_told() {
        let [a, b, c] = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let mut notes = Notes::default();
        let mut face = |corners, line| upward(corners, |p| p, &mut notes, line);
        assert_eq!(face([a, b, c], 1), Some([a, b, c]));
        assert_eq!(face([a, c, b], 2), Some([a, b, c]));
        assert_eq!(face([a, b, b + DVec3::Z], 3), None);
        assert_eq!(face([a, b, DVec3::NAN], 4), None);
        assert_eq!(face([b, b, c], 5), None);
        assert_eq!(
            notes.into_lines(),
            [
                "faces that were clockwise from above turned over: 1, first at 2",
                "faces that are vertical or without an area dropped: 2, first at 3",
                "faces with a corner that is no finite number dropped: 1, first at 4",
            ]
        );
    }

    #[test]
    fn quadrilaterals_are_cut_inside() {
        let quad = |corners: [[f64; 2]; 4]| cut_quad(corners.map(|[x, y]| DVec3::new(x, y, 0.0)));
        assert_eq!(quad([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(quad([[0.0, 0.0], [1.0, 0.0], [3.0, 1.0], [0.0, 1.0]]), [[0, 1, 3], [1, 2, 3]]);
        assert_eq!(quad([[0.0, 4.0], [0.0, 0.0], [4.0, 0.0], [1.0, 1.0]]), [[0, 1, 3], [1, 2, 3]]);
        assert_eq!(quad([[0.0, 0.0], [4.0, 0.0], [1.0, 1.0], [0.0, 4.0]]), [[0, 1, 2], [0, 2, 3]]);
    }
}
