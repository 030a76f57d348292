//! Normals of the vertices of a semi-regular mesh: the sum of its triangles' area vectors, on the finest level.

use glam::DVec3;
use rayon::prelude::*;
use yamanami_core::SemiRegular;

/// Fewest vertices that are worth a task of their own.
const TASK: usize = 1024;

/// Unit normals by vertex; upwards where the triangles have none.
pub(super) fn normals(mesh: &SemiRegular, positions: &[DVec3]) -> Vec<[f32; 3]> {
    let one = |ring: &mut Vec<u32>, vertex: u32| {
        let is_closed = mesh.ring(mesh.levels(), vertex, ring);
        let middle = positions[vertex as usize];
        let to = |k: usize| positions[ring[k % ring.len()] as usize] - middle;
        let steps = if is_closed { ring.len() } else { ring.len() - 1 };
        let sum: DVec3 = (0..steps).map(|k| to(k).cross(to(k + 1))).sum();
        sum.try_normalize().unwrap_or(DVec3::Z).as_vec3().to_array()
    };
    (0..positions.len() as u32).into_par_iter().with_min_len(TASK).map_init(Vec::new, one).collect()
}
