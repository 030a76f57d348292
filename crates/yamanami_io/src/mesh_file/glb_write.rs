//! Writing binary glTF 2.0: one mesh, one node. glTF is y up and in single precision, so positions are turned and made
//! relative to an origin in whole metres, which the node's translation adds again.

use super::{MeshMeta, one_line};
use crate::IoError;
use glam::{DVec3, Vec3};
use serde_json::json;
use std::io::{Result, Write};
use std::path::Path;
use yamanami_core::TriangleMesh;

/// Room for the JSON beside the buffer; real ones take a few hundred bytes and the texts.
const JSON_ROOM: u64 = 1 << 24;

/// Refuses a mesh whose file would pass the format's 4 GiB.
pub(super) fn check_size(path: &Path, mesh: &TriangleMesh) -> std::result::Result<(), IoError> {
    let given = 12 * (mesh.positions.len() + mesh.normals.len() + mesh.triangles.len()) as u64;
    let limit = u64::from(u32::MAX) - JSON_ROOM;
    if given > limit {
        return Err(IoError::too_large(path, "bytes of a GLB", given, limit));
    }
    Ok(())
}

/// Turns z up into y up.
fn y_up<T>([x, y, z]: [T; 3]) -> [T; 3]
where
    T: std::ops::Neg<Output = T>,
{
    [x, z, -y]
}

pub(super) fn write(out: &mut dyn Write, mesh: &TriangleMesh, meta: &MeshMeta) -> Result<()> {
    let origin = mesh.bounds().centre().round();
    let local = |p: DVec3| Vec3::from(y_up((p - origin).as_vec3().to_array()));
    let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for &p in &mesh.positions {
        (min, max) = (min.min(local(p)), max.max(local(p)));
    }
    let (vertices, corners) = (mesh.positions.len(), 3 * mesh.triangles.len());
    let positions_end = 12 * vertices;
    let normals_end = positions_end + 12 * mesh.normals.len();
    let length = normals_end + 4 * corners;

    let mut views = vec![
        json!({"buffer": 0, "byteOffset": 0, "byteLength": positions_end, "target": 34962}),
        json!({"buffer": 0, "byteOffset": normals_end, "byteLength": 4 * corners, "target": 34963}),
    ];
    let mut accessors = vec![
        json!({"bufferView": 0, "componentType": 5126, "count": vertices, "type": "VEC3",
            "min": min.to_array(), "max": max.to_array()}),
        json!({"bufferView": 1, "componentType": 5125, "count": corners, "type": "SCALAR"}),
    ];
    let mut attributes = json!({"POSITION": 0});
    if !mesh.normals.is_empty() {
        let byte_length = 12 * mesh.normals.len();
        views.push(json!({"buffer": 0, "byteOffset": positions_end, "byteLength": byte_length, "target": 34962}));
        accessors.push(json!({"bufferView": 2, "componentType": 5126, "count": vertices, "type": "VEC3"}));
        attributes["NORMAL"] = json!(2);
    }
    let title = one_line(&meta.title);
    let document = json!({
        "asset": {"version": "2.0", "generator": "yamanami"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{
            "name": if title.is_empty() { "surface" } else { &title },
            "mesh": 0,
            "translation": y_up(origin.to_array()).map(|c| c + 0.0),
            "extras": {"crs": meta.crs, "note": meta.note, "origin_z_up_m": origin.to_array()},
        }],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": 1, "material": 0, "mode": 4}]}],
        "materials": [{
            "doubleSided": true,
            "pbrMetallicRoughness": {"baseColorFactor": [0.72, 0.70, 0.66, 1.0], "metallicFactor": 0.0,
                "roughnessFactor": 1.0},
        }],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": length}],
    });
    let mut text = document.to_string();
    while !text.len().is_multiple_of(4) {
        text.push(' ');
    }
    let total = u32::try_from(12 + 8 + text.len() + 8 + length)
        .map_err(|_| std::io::Error::other("a GLB file holds less than 4 GiB"))?;
    out.write_all(b"glTF")?;
    for word in [2, total, text.len() as u32] {
        out.write_all(&word.to_le_bytes())?;
    }
    out.write_all(b"JSON")?;
    out.write_all(text.as_bytes())?;
    out.write_all(&(length as u32).to_le_bytes())?;
    out.write_all(b"BIN\0")?;
    let positions = mesh.positions.iter().map(|&p| local(p).to_array());
    for vector in positions.chain(mesh.normals.iter().map(|&n| y_up(n))) {
        for c in vector {
            out.write_all(&c.to_le_bytes())?;
        }
    }
    for i in mesh.triangles.iter().flatten() {
        out.write_all(&i.to_le_bytes())?;
    }
    Ok(())
}
