//! Triangles that two surfaces have in common, corner for corner.
//!
//! Own idea: where both have the same triangle they do not differ, and nothing need be laid over anything. Real surveys
//! cover a few places twice by slips of some micrometres, beside walls of many metres; so a surface would else differ
//! from itself.

use glam::DVec3;
use rayon::prelude::*;
use yamanami_core::TriangleMesh;

/// For each triangle of both surfaces whether the other has it, too, whichever corner comes first.
pub(super) fn twins(first: &TriangleMesh, second: &TriangleMesh) -> [Vec<bool>; 2] {
    let hashed = |mesh: &TriangleMesh| {
        let hash = |t: u32| (hash(&sorted(mesh, t)), t);
        let mut hashed: Vec<(u64, u32)> = (0..mesh.triangles.len() as u32).into_par_iter().map(hash).collect();
        hashed.par_sort_unstable();
        hashed
    };
    let (hashed_first, hashed_second) = rayon::join(|| hashed(first), || hashed(second));
    [found_in(first, second, &hashed_second), found_in(second, first, &hashed_first)]
}

fn found_in(mesh: &TriangleMesh, other: &TriangleMesh, hashed: &[(u64, u32)]) -> Vec<bool> {
    (0..mesh.triangles.len() as u32)
        .into_par_iter()
        .map(|t| {
            let corners = sorted(mesh, t);
            let hash = hash(&corners);
            let start = hashed.partition_point(|entry| entry.0 < hash);
            hashed[start..].iter().take_while(|entry| entry.0 == hash).any(|entry| sorted(other, entry.1) == corners)
        })
        .collect()
}

fn sorted(mesh: &TriangleMesh, triangle: u32) -> [DVec3; 3] {
    // -0 is 0
    let mut corners = mesh.corners(triangle as usize).map(|p| p + DVec3::ZERO);
    corners.sort_unstable_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)).then(p.z.total_cmp(&q.z)));
    corners
}

fn hash(corners: &[DVec3; 3]) -> u64 {
    corners
        .iter()
        .flat_map(DVec3::to_array)
        .fold(0, |hash: u64, v| (hash.rotate_left(23) ^ v.to_bits()).wrapping_mul(0x9E37_79B9_7F4A_7C15))
}

#[cfg(test)]
mod tests {
    use super::super::tests::{rough, shifted};
    use super::*;

    #[test]
    fn twins_are_found_whatever_their_order_and_only_they() {
        let a = shifted(rough(6, 3));
        let mut b = a.clone();
        b.triangles.iter_mut().for_each(|t| t.rotate_left(1));
        b.triangles.reverse();
        let moved = b.triangles[5][0];
        b.positions[moved as usize].z += 1e-6;
        let [in_b, in_a] = twins(&a, &b);
        let untouched = |t: &[u32; 3]| !t.contains(&moved);
        assert_eq!(in_b, a.triangles.iter().map(untouched).collect::<Vec<_>>());
        assert_eq!(in_a, b.triangles.iter().map(untouched).collect::<Vec<_>>());
    }
}
