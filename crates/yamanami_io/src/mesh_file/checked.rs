//! What holds for every mesh that is read or written: triangles, finite positions, indices in range.

use crate::IoError;
use std::path::Path;
use yamanami_core::TriangleMesh;

/// Checks a mesh that was read, so that nothing after it needs to. Readers check their indices themselves, where they
/// can say which face is wrong; normals that are not one a vertex, or not directions, are dropped.
pub(super) fn readable(name: &Path, mut mesh: TriangleMesh) -> Result<TriangleMesh, IoError> {
    if mesh.triangles.is_empty() {
        let vertices = mesh.positions.len();
        return Err(IoError::malformed(
            name,
            "faces",
            "at least one triangle",
            format!("{vertices} vertices, no face"),
        ));
    }
    if let Some(i) = mesh.positions.iter().position(|p| !p.is_finite()) {
        let p = mesh.positions[i];
        return Err(IoError::malformed(name, format!("vertex {i}"), "three finite numbers", p.to_string()));
    }
    if mesh.normals.len() != mesh.positions.len() || !mesh.normals.iter_mut().all(to_unit) {
        mesh.normals = Vec::new();
    }
    Ok(mesh)
}

/// Scales a normal to length 1; false when it has no direction.
fn to_unit(normal: &mut [f32; 3]) -> bool {
    let n = glam::Vec3::from(*normal);
    let length = n.length();
    // one that is of unit length already keeps its bits
    if (length - 1.0).abs() > 1e-6 {
        *normal = n.try_normalize().unwrap_or_default().to_array();
    }
    length > 0.0 && length.is_finite()
}

/// Checks a mesh that is to be written.
pub(super) fn writable(path: &Path, mesh: &TriangleMesh) -> Result<(), IoError> {
    let bad = |expected: &str, given: String| IoError::BadRequest {
        what: format!("{}: mesh to write", path.display()),
        expected: expected.into(),
        given,
    };
    let vertices = mesh.positions.len();
    if mesh.triangles.is_empty() {
        return Err(bad("at least one triangle", "none".into()));
    }
    if let Some(t) = mesh.triangles.iter().position(|t| t.iter().any(|&i| i as usize >= vertices)) {
        return Err(bad(&format!("corners below {vertices}"), format!("triangle {t} with {:?}", mesh.triangles[t])));
    }
    if let Some(i) = mesh.positions.iter().position(|p| !p.is_finite()) {
        return Err(bad("finite positions", format!("vertex {i} at {}", mesh.positions[i])));
    }
    if !mesh.normals.is_empty() && mesh.normals.len() != vertices {
        return Err(bad(&format!("{vertices} normals or none"), mesh.normals.len().to_string()));
    }
    Ok(())
}
