//! Corners to vertices: files that give texture coordinates by face corner have seams, where one place needs several
//! vertices.

use super::origin::Origin;
use crate::IoError;
use std::collections::HashMap;
use std::hash::Hash;
use yamanami_core::TriangleMesh;

/// Splits the vertices whose corners have different keys, and gives each vertex's key (`unset` where no corner has one).
/// The first key at a vertex keeps its number, further ones are appended, so that a mesh without seams stays as it is; a
/// corner without a key splits nothing.
pub(super) fn split<K: Copy + Eq + Hash>(
    origin: &Origin<'_>,
    mesh: &mut TriangleMesh,
    keys: &[[K; 3]],
    unset: K,
) -> Result<Vec<K>, IoError> {
    let mut key_of = vec![unset; mesh.positions.len()];
    let mut further: HashMap<(u32, K), u32> = HashMap::new();
    for (triangle, keys) in mesh.triangles.iter_mut().zip(keys) {
        for (corner, &key) in triangle.iter_mut().zip(keys) {
            let vertex = *corner as usize;
            if key == unset || key_of[vertex] == key {
                continue;
            }
            if key_of[vertex] == unset {
                key_of[vertex] = key;
                continue;
            }
            *corner = *further.entry((*corner, key)).or_insert_with(|| {
                key_of.push(key);
                mesh.positions.push(mesh.positions[vertex]);
                if let Some(&normal) = mesh.normals.get(vertex) {
                    mesh.normals.push(normal);
                }
                if let Some(&colour) = mesh.colours.get(vertex) {
                    mesh.colours.push(colour);
                }
                key_of.len() as u32 - 1
            });
        }
        if key_of.len() > u32::MAX as usize - 3 {
            return Err(IoError::too_large(origin.name, "vertices", key_of.len() as u64, u64::from(u32::MAX) - 3));
        }
    }
    Ok(key_of)
}
