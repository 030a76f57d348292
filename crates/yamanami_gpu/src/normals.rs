//! Normals of meshes that bring none.
//!
//! Based on: Thürmer, Wüthrich, "Computing vertex normals from polygonal facets", 1998 (each triangle counts by its angle
//! at the vertex, so that the way a face is cut into triangles does not matter).

use glam::DVec3;
use yamanami_core::TriangleMesh;

/// Unit normals of a mesh's vertices: the mean of the triangles around each, weighted by their angles there; straight up
/// where there is no triangle with an area. Corners that do not exist are passed over.
pub fn vertex_normals(mesh: &TriangleMesh) -> Vec<[f32; 3]> {
    let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
    for triangle in &mesh.triangles {
        let [Some(&a), Some(&b), Some(&c)] = triangle.map(|i| mesh.positions.get(i as usize)) else { continue };
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
        let sides = [b - a, c - b, a - c];
        for (k, &corner) in triangle.iter().enumerate() {
            sums[corner as usize] += normal * sides[k].angle_between(-sides[(k + 2) % 3]);
        }
    }
    sums.into_iter().map(|n| n.try_normalize().map_or([0.0, 0.0, 1.0], |n| n.as_vec3().to_array())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The corner of a cube leans to all three faces alike, though one of them is cut into two triangles there.
    #[test]
    fn a_face_counts_once_however_it_is_cut() {
        let o = DVec3::ZERO;
        let mesh = TriangleMesh::new(
            vec![o, DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(1.0, 1.0, 0.0)],
            vec![[0, 1, 4], [0, 4, 2], [0, 3, 1], [0, 2, 3], [0, 1, 9]],
        );
        let corner = DVec3::from_array(vertex_normals(&mesh)[0].map(f64::from));
        assert!((corner - DVec3::new(1.0, 1.0, 1.0).normalize()).length() < 1e-6, "{corner}");
        assert_eq!(vertex_normals(&TriangleMesh::new(vec![o], vec![])), [[0.0, 0.0, 1.0]]);
    }
}
