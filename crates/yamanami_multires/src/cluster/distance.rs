//! A plain bound on the two-sided distance of two patches.

use yamanami_core::TriangleMesh;

/// Every point of a triangle is within 1/√3 of its longest side of a corner, and the corner within some distance of the
/// other patch's nearest vertex.
pub(super) fn distance_bound_m(a: &TriangleMesh, b: &TriangleMesh) -> f64 {
    let one_way = |from: &TriangleMesh, to: &TriangleMesh| {
        let nearest =
            |p: &glam::DVec3| to.positions.iter().map(|q| (*p - *q).length_squared()).fold(f64::INFINITY, f64::min);
        let off: Vec<f64> = from.positions.iter().map(|p| nearest(p).sqrt()).collect();
        (0..from.triangles.len()).fold(0f64, |worst, t| {
            let [p, q, r] = from.corners(t);
            let side = (p - q).length().max((q - r).length()).max((r - p).length());
            let corner = from.triangles[t].iter().map(|&v| off[v as usize]).fold(0.0, f64::max);
            worst.max(corner + 0.578 * side)
        })
    };
    one_way(a, b).max(one_way(b, a))
}
