//! A ring of vertices cut into triangles, ear by ear.
//!
//! Based on: Gary Meisters, "Polygons have ears", 1975; Newell's normal of a ring that is not flat (Sutherland, Sproull,
//! Schumacker, "A characterization of ten hidden-surface algorithms", 1974).

use glam::{DVec2, DVec3};
use yamanami_core::View;

/// Triangles on a ring of at least three vertices, two fewer than it has. It is laid out as the view sees it where there
/// is exactly one, else along its mean normal.
pub(crate) fn cut_into_triangles(positions: &[DVec3], ring: &[u32], views: &[View]) -> Vec<[u32; 3]> {
    let places: Vec<DVec3> = ring.iter().map(|&v| positions[v as usize]).collect();
    let flat = match views {
        [view] => seen_flat(&places, view),
        _ => None,
    };
    ears(&flat.unwrap_or_else(|| laid_flat(&places))).into_iter().map(|t| t.map(|k| ring[k])).collect()
}

/// The ring as a view sees it; `None` where a part of it is behind the eye.
fn seen_flat(places: &[DVec3], view: &View) -> Option<Vec<DVec2>> {
    let forward = view.forward();
    let right = forward.cross(view.up()).normalize();
    let up = right.cross(forward);
    let project = |&place: &DVec3| {
        let from_eye = place - view.eye;
        let depth = from_eye.dot(forward);
        (depth > 0.0).then(|| DVec2::new(from_eye.dot(right), from_eye.dot(up)) / depth)
    };
    places.iter().map(project).collect()
}

/// The ring along its mean normal.
fn laid_flat(places: &[DVec3]) -> Vec<DVec2> {
    let origin = places.first().copied().unwrap_or_default();
    let pairs = places.iter().zip(places.iter().cycle().skip(1));
    let normal: DVec3 = pairs.map(|(&a, &b)| (a - origin).cross(b - origin)).sum();
    let normal = normal.try_normalize().unwrap_or(DVec3::Z);
    let across = normal.any_orthonormal_vector();
    let up = normal.cross(across);
    places.iter().map(|&p| DVec2::new((p - origin).dot(across), (p - origin).dot(up))).collect()
}

/// Cuts a ring in the plane. Ears that hold no other vertex go first; where the ring crosses itself and none is left, the
/// next corner goes as it is, so that there always is an end.
fn ears(ring: &[DVec2]) -> Vec<[usize; 3]> {
    let area: f64 = (0..ring.len()).map(|i| ring[i].perp_dot(ring[(i + 1) % ring.len()])).sum();
    let turn = if area < 0.0 { -1.0 } else { 1.0 };
    let side = |a: usize, b: usize, c: usize| turn * (ring[b] - ring[a]).perp_dot(ring[c] - ring[a]);
    let mut left: Vec<usize> = (0..ring.len()).collect();
    let mut triangles = Vec::with_capacity(ring.len().saturating_sub(2));
    let mut start = 0;
    while left.len() > 2 {
        let n = left.len();
        let corner = |i: usize| [left[(i + n - 1) % n], left[i % n], left[(i + 1) % n]];
        let is_ear = |i: usize| {
            let [a, b, c] = corner(i);
            let holds = |p: usize| side(a, b, p) >= 0.0 && side(b, c, p) >= 0.0 && side(c, a, p) >= 0.0;
            side(a, b, c) > 0.0 && !left.iter().any(|&p| p != a && p != b && p != c && holds(p))
        };
        let ear = (start..start + n).find(|&i| is_ear(i % n)).unwrap_or(start) % n;
        triangles.push(corner(ear));
        left.remove(ear);
        // going on behind the ear keeps triangles from fanning out of one corner
        start = if ear + 1 < left.len() { ear + 1 } else { 0 };
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(ring: &[DVec2], [a, b, c]: [usize; 3]) -> f64 {
        0.5 * (ring[b] - ring[a]).perp_dot(ring[c] - ring[a])
    }

    #[test]
    fn a_star_is_cut_without_overlap_in_either_turn() {
        let mut ring: Vec<DVec2> = (0..40)
            .map(|k| {
                let angle = std::f64::consts::TAU * f64::from(k) / 40.0;
                DVec2::from_angle(angle) * if k % 2 == 0 { 1.0 } else { 0.3 }
            })
            .collect();
        for _ in 0..2 {
            let triangles = ears(&ring);
            assert_eq!(triangles.len(), 38);
            let whole: f64 = (0..40).map(|i| 0.5 * ring[i].perp_dot(ring[(i + 1) % 40])).sum();
            let parts: Vec<f64> = triangles.iter().map(|&t| area(&ring, t)).collect();
            assert!(parts.iter().all(|a| a * whole > 0.0), "all turn as the ring does");
            assert!((parts.iter().sum::<f64>() - whole).abs() < 1e-12);
            ring.reverse();
        }
    }

    #[test]
    fn rings_that_cross_or_have_no_area_end_all_the_same() {
        let eight = [(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| DVec2::new(x, y));
        assert_eq!(ears(&eight).len(), 2);
        assert_eq!(ears(&[DVec2::ZERO; 7]).len(), 5);
        assert_eq!(cut_into_triangles(&[DVec3::ZERO; 3], &[2, 0, 1], &[]), [[1, 2, 0]]);
    }
}
