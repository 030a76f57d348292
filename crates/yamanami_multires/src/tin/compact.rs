//! A mesh without the vertices that no triangle has.

use glam::DVec3;
use yamanami_core::TriangleMesh;

/// The mesh of the triangles; what is left of the vertices keeps its order.
pub(super) fn compact(positions: &[DVec3], mut triangles: Vec<[u32; 3]>) -> TriangleMesh {
    let mut numbers = vec![u32::MAX; positions.len()];
    for &v in triangles.as_flattened() {
        numbers[v as usize] = 0;
    }
    let mut kept = Vec::with_capacity(positions.len());
    for (number, &p) in numbers.iter_mut().zip(positions) {
        if *number == 0 {
            *number = kept.len() as u32;
            kept.push(p);
        }
    }
    for v in triangles.as_flattened_mut() {
        *v = numbers[*v as usize];
    }
    TriangleMesh::new(kept, triangles)
}
