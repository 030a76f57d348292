//! What holds for every mesh that is read or written: triangles, finite positions, indices in range, as many of each
//! attribute as there are vertices.

use super::origin::Origin;
use crate::IoError;
use std::path::Path;
use yamanami_core::TriangleMesh;

/// Checks a mesh that was read, so that nothing after it needs to. Readers check their indices themselves, where they
/// can say which face is wrong. A vertex without a place is an error where a face uses it, and left out otherwise;
/// attributes that are not one a vertex, and normals that are not directions, are dropped.
pub(super) fn readable(origin: &mut Origin<'_>, mut mesh: TriangleMesh) -> Result<TriangleMesh, IoError> {
    if mesh.triangles.is_empty() {
        let found = format!("{} vertices, no face", mesh.positions.len());
        return Err(origin.bad("faces", "at least one triangle", found));
    }
    if mesh.positions.iter().any(|p| !p.is_finite()) {
        leave_out_lost_vertices(origin, &mut mesh)?;
    }
    let vertices = mesh.positions.len();
    if mesh.normals.len() != vertices || !all_directions(&mut mesh) {
        if !mesh.normals.is_empty() {
            origin.note("normals not read: some vertices have none");
        }
        mesh.normals = Vec::new();
    }
    if mesh.colours.len() != vertices {
        if !mesh.colours.is_empty() {
            origin.note("colours not read: some vertices have none");
        }
        mesh.colours = Vec::new();
    }
    if mesh.texcoords.len() != vertices {
        if !mesh.texcoords.is_empty() {
            origin.note("texture coordinates not read: some vertices have none");
        }
        mesh.texcoords = Vec::new();
    }
    let mut lost = 0;
    for texcoord in mesh.texcoords.iter_mut().filter(|t| !t.iter().all(|c| c.is_finite())) {
        *texcoord = [0.0; 2];
        lost += 1;
    }
    if lost > 0 {
        origin.note(format!("{lost} texture coordinates are no numbers: zero in their place"));
    }
    Ok(mesh)
}

fn used_vertices(mesh: &TriangleMesh) -> Vec<bool> {
    let mut used = vec![false; mesh.positions.len()];
    for &i in mesh.triangles.iter().flatten() {
        used[i as usize] = true;
    }
    used
}

fn leave_out_lost_vertices(origin: &mut Origin<'_>, mesh: &mut TriangleMesh) -> Result<(), IoError> {
    let used = used_vertices(mesh);
    let lost = |i: usize| !mesh.positions[i].is_finite();
    if let Some(i) = (0..used.len()).find(|&i| used[i] && lost(i)) {
        return Err(origin.bad(format!("vertex {i}"), "three finite numbers", mesh.positions[i].to_string()));
    }
    let kept: Vec<bool> = (0..used.len()).map(|i| !lost(i)).collect();
    let mut number = 0;
    let number_of: Vec<u32> = kept
        .iter()
        .map(|&k| {
            number += u32::from(k);
            number.wrapping_sub(1)
        })
        .collect();
    let count = kept.iter().filter(|&&k| !k).count();
    origin.note(format!("{count} vertices without a place left out: no face uses them"));
    fn keep<T>(values: &mut Vec<T>, kept: &[bool]) {
        if values.len() == kept.len() {
            let mut kept = kept.iter();
            values.retain(|_| kept.next().is_some_and(|&k| k));
        }
    }
    keep(&mut mesh.positions, &kept);
    keep(&mut mesh.normals, &kept);
    keep(&mut mesh.colours, &kept);
    keep(&mut mesh.texcoords, &kept);
    for i in mesh.triangles.iter_mut().flatten() {
        *i = number_of[*i as usize];
    }
    Ok(())
}

/// Brings all normals to length 1; false when that of a vertex with faces has no direction.
fn all_directions(mesh: &mut TriangleMesh) -> bool {
    let mut lost = Vec::new();
    for (i, normal) in mesh.normals.iter_mut().enumerate() {
        if !to_unit(normal) {
            lost.push(i);
        }
    }
    if lost.is_empty() {
        return true;
    }
    let used = used_vertices(mesh);
    for &i in &lost {
        mesh.normals[i] = [0.0, 0.0, 1.0];
    }
    lost.iter().all(|&i| !used[i])
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
    let attributes = [
        ("normals", mesh.normals.len()),
        ("colours", mesh.colours.len()),
        ("texture coordinates", mesh.texcoords.len()),
    ];
    for (what, count) in attributes {
        if count != 0 && count != vertices {
            return Err(bad(&format!("{vertices} {what} or none"), count.to_string()));
        }
    }
    let (materials, triangles) = (mesh.materials.len(), mesh.triangles.len());
    if !mesh.material_of.is_empty() {
        if mesh.material_of.len() != triangles {
            let given = mesh.material_of.len().to_string();
            return Err(bad(&format!("a material for each of {triangles} triangles, or none"), given));
        }
        if let Some(m) = mesh.material_of.iter().find(|&&m| usize::from(m) >= materials) {
            return Err(bad(&format!("materials below {materials}"), m.to_string()));
        }
    }
    Ok(())
}
