//! Cutting polygons into triangles: quads along their better diagonal, others by clipping ears in the polygon's plane,
//! so that concave ones keep their outline. Every corner stays a corner: no T-vertex appears beside a neighbour.
//!
//! Based on: Meisters, "Polygons have ears", 1975 (ear clipping); Sutherland, Sproull and Schumacker, "A
//! characterization of ten hidden-surface algorithms", 1974 (Newell's plane of a polygon).

use glam::{DVec2, DVec3};

/// Most tests of a corner against an ear for one polygon. One far beyond any roof or floor plan stays a fan.
const EAR_TESTS: usize = 1 << 26;

/// Polygons of more than three corners, for the time being cut as fans: their places may not be known yet.
#[derive(Default)]
pub(super) struct Polygons {
    /// First triangle and number of corners.
    runs: Vec<(usize, u32)>,
}

impl Polygons {
    /// Appends a polygon of at least three corners as a fan.
    pub(super) fn push(&mut self, corners: &[u32], triangles: &mut Vec<[u32; 3]>) {
        if corners.len() > 3 {
            self.runs.push((triangles.len(), corners.len() as u32));
        }
        for pair in corners[1..].windows(2) {
            triangles.push([corners[0], pair[0], pair[1]]);
        }
    }

    /// Cuts the fans anew, now by shape. A polygon keeps its triangles' numbers.
    pub(super) fn cut(self, positions: &[DVec3], triangles: &mut [[u32; 3]]) {
        let mut corners = Vec::new();
        for (first, count) in self.runs {
            let fan = &mut triangles[first..first + count as usize - 2];
            corners.clear();
            corners.extend_from_slice(&fan[0][..2]);
            corners.extend(fan.iter().map(|t| t[2]));
            let place = |i: u32| positions[i as usize];
            if let [a, b, c, d] = corners[..] {
                if better_across(place(a), place(b), place(c), place(d)) {
                    fan.copy_from_slice(&[[a, b, d], [b, c, d]]);
                }
            } else if let Some(cut) = ears(&corners, place) {
                fan.copy_from_slice(&cut);
            }
        }
    }
}

/// Whether a quad is better cut from its second corner to its fourth.
fn better_across(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> bool {
    let fold = |one: [DVec3; 3], other: [DVec3; 3]| {
        let normal = |[p, q, r]: [DVec3; 3]| (q - p).cross(r - p);
        normal(one).dot(normal(other))
    };
    // a diagonal outside a concave quad folds it over itself
    let (along, across) = (fold([a, b, c], [a, c, d]), fold([a, b, d], [b, c, d]));
    match (along > 0.0, across > 0.0) {
        (true, false) => false,
        (false, true) => true,
        // the shorter one; of equal ones, up to rounding, that of the fan
        _ => b.distance_squared(d) < a.distance_squared(c) * (1.0 - 1e-12),
    }
}

/// Twice the signed area of a triangle.
fn area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// The triangles of a polygon, or `None` where the fan is right already or nothing better can be said.
fn ears(corners: &[u32], place: impl Fn(u32) -> DVec3) -> Option<Vec<[u32; 3]>> {
    let count = corners.len();
    let origin = place(corners[0]);
    let local: Vec<DVec3> = corners.iter().map(|&i| place(i) - origin).collect();
    let normal = (0..count).map(|k| local[k].cross(local[(k + 1) % count])).sum::<DVec3>();
    let side = normal.try_normalize()?;
    let (u, v) = side.any_orthonormal_pair();
    // the pair's own turn is not promised
    let v = if u.cross(v).dot(side) > 0.0 { v } else { -v };
    let plan: Vec<DVec2> = local.iter().map(|p| DVec2::new(p.dot(u), p.dot(v))).collect();

    let mut previous: Vec<usize> = (0..count).map(|k| (k + count - 1) % count).collect();
    let mut next: Vec<usize> = (0..count).map(|k| (k + 1) % count).collect();
    let turn = |k: usize, previous: &[usize], next: &[usize]| area(plan[previous[k]], plan[k], plan[next[k]]);
    let mut reflex: Vec<usize> = (0..count).filter(|&k| turn(k, &previous, &next) <= 0.0).collect();
    if reflex.is_empty() || count.checked_mul(reflex.len()).is_none_or(|tests| tests > EAR_TESTS) {
        return None;
    }

    let mut triangles = Vec::with_capacity(count - 2);
    let (mut at, mut left, mut since_cut, mut tests) = (0, count, 0, 0usize);
    while left > 3 {
        let (p, n) = (previous[at], next[at]);
        let convex = turn(at, &previous, &next) > 0.0;
        let (a, b, c) = (plan[p], plan[at], plan[n]);
        tests += reflex.len();
        if tests > 4 * EAR_TESTS {
            return None;
        }
        let holds = |&k: &usize| {
            let q = plan[k];
            k != p
                && k != at
                && k != n
                && q != a
                && q != b
                && q != c
                && area(a, b, q) >= 0.0
                && area(b, c, q) >= 0.0
                && area(c, a, q) >= 0.0
        };
        // in a polygon that crosses itself there may be no ear left: then any corner has to do
        if (convex && !reflex.iter().any(holds)) || since_cut > left {
            triangles.push([corners[p], corners[at], corners[n]]);
            (next[p], previous[n]) = (n, p);
            left -= 1;
            since_cut = 0;
            reflex.retain(|&k| k != at && (k != p && k != n || turn(k, &previous, &next) <= 0.0));
            // the corner after the next gives rounder triangles than a fan around one corner
            at = next[n];
        } else {
            since_cut += 1;
            at = n;
        }
    }
    triangles.push([corners[previous[at]], corners[at], corners[next[at]]]);
    Some(triangles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cut(outline: &[[f64; 2]]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let positions: Vec<DVec3> = outline.iter().map(|&[x, y]| DVec3::new(x, y, 0.5 * x + 2.0 * y)).collect();
        let corners: Vec<u32> = (0..outline.len() as u32).collect();
        let (mut polygons, mut triangles) = (Polygons::default(), Vec::new());
        polygons.push(&corners, &mut triangles);
        polygons.cut(&positions, &mut triangles);
        assert_eq!(triangles.len(), outline.len() - 2);
        (positions, triangles)
    }

    fn areas(positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<f64> {
        let plan = |i: u32| positions[i as usize].truncate();
        triangles.iter().map(|&[a, b, c]| area(plan(a), plan(b), plan(c)) / 2.0).collect()
    }

    #[test]
    fn a_concave_quad_is_cut_inside() {
        let (positions, triangles) = cut(&[[0.0, 0.0], [4.0, 0.0], [1.0, 1.0], [0.0, 4.0]]);
        assert_eq!(triangles, [[0, 1, 2], [0, 2, 3]]);
        assert!(areas(&positions, &triangles).iter().all(|&a| a > 0.0));
        let (positions, triangles) = cut(&[[0.0, 4.0], [0.0, 0.0], [4.0, 0.0], [1.0, 1.0]]);
        assert_eq!(triangles, [[0, 1, 3], [1, 2, 3]]);
        assert!(areas(&positions, &triangles).iter().all(|&a| a > 0.0));
    }

    #[test]
    fn a_comb_keeps_its_outline() {
        let mut outline = vec![[0.0, -1.0]];
        for k in 0..50 {
            outline.push([f64::from(k) + 0.5, -1.0]);
        }
        for k in (0..50).rev() {
            outline.extend([[f64::from(k) + 0.6, 5.0], [f64::from(k) + 0.4, 0.0]]);
        }
        let (positions, triangles) = cut(&outline);
        let whole: f64 = (0..outline.len())
            .map(|k| {
                let ([a, b], [c, d]) = (outline[k], outline[(k + 1) % outline.len()]);
                (a * d - b * c) / 2.0
            })
            .sum();
        let parts = areas(&positions, &triangles);
        assert!(parts.iter().all(|&a| a > -1e-9), "no triangle is turned over");
        assert!((parts.iter().sum::<f64>() - whole).abs() < 1e-9);
    }

    proptest! {
        #[test]
        fn a_star_shaped_outline_is_covered_once(radii in prop::collection::vec(0.1..1.0f64, 5..40)) {
            let n = radii.len() as f64;
            let outline: Vec<[f64; 2]> = radii.iter().enumerate().map(|(k, r)| {
                let angle = std::f64::consts::TAU * k as f64 / n;
                [r * angle.cos(), r * angle.sin()]
            }).collect();
            let (positions, triangles) = cut(&outline);
            prop_assert!(areas(&positions, &triangles).iter().all(|&a| a > -1e-12));
        }

        #[test]
        fn any_corners_give_all_triangles(points in prop::collection::vec(prop::array::uniform2(-3..3i32), 4..20)) {
            let outline: Vec<[f64; 2]> = points.iter().map(|p| p.map(f64::from)).collect();
            cut(&outline);
        }
    }
}
