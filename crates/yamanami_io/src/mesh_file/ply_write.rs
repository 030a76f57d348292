//! Writing PLY: binary, little endian, double precision, so that projected coordinates keep every digit. Pictures are
//! named as MeshLab does: `comment TextureFile`, and a `texnumber` of each face where there are several.

use super::MeshMeta;
use super::companions::Pictures;
use std::io::{Result, Write};
use yamanami_core::TriangleMesh;

pub(super) fn write(out: &mut dyn Write, mesh: &TriangleMesh, meta: &MeshMeta, pictures: &Pictures) -> Result<()> {
    writeln!(out, "ply\nformat binary_little_endian 1.0\ncomment written by yamanami, metres, z up")?;
    for line in meta.lines() {
        writeln!(out, "comment {line}")?;
    }
    for name in pictures.names() {
        writeln!(out, "comment TextureFile {name}")?;
    }
    writeln!(out, "element vertex {}", mesh.positions.len())?;
    writeln!(out, "property double x\nproperty double y\nproperty double z")?;
    if !mesh.normals.is_empty() {
        writeln!(out, "property float nx\nproperty float ny\nproperty float nz")?;
    }
    if !mesh.texcoords.is_empty() {
        writeln!(out, "property float s\nproperty float t")?;
    }
    if !mesh.colours.is_empty() {
        writeln!(out, "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha")?;
    }
    writeln!(out, "element face {}", mesh.triangles.len())?;
    // most readers expect signed indices; unsigned ones only where they are needed
    let index = if mesh.positions.len() > i32::MAX as usize { "uint" } else { "int" };
    writeln!(out, "property list uchar {index} vertex_indices")?;
    let several =
        pictures.names().next().is_some() && (0..mesh.materials.len()).any(|m| pictures.number_of(m) != Some(0));
    if several {
        writeln!(out, "property int texnumber")?;
    }
    writeln!(out, "end_header")?;
    let mut record = Vec::new();
    for (i, p) in mesh.positions.iter().enumerate() {
        record.clear();
        record.extend(p.to_array().into_iter().flat_map(f64::to_le_bytes));
        record.extend(mesh.normals.get(i).into_iter().flatten().flat_map(|c| c.to_le_bytes()));
        if let Some(&[u, v]) = mesh.texcoords.get(i) {
            // v is up here
            record.extend([u, 1.0 - v].into_iter().flat_map(f32::to_le_bytes));
        }
        record.extend(mesh.colours.get(i).into_iter().flatten());
        out.write_all(&record)?;
    }
    for (number, t) in mesh.triangles.iter().enumerate() {
        let mut record = [3u8; 17];
        for (k, i) in t.iter().enumerate() {
            record[1 + 4 * k..5 + 4 * k].copy_from_slice(&i.to_le_bytes());
        }
        let picture = pictures.number_of(mesh.material(number)).map_or(-1, |k| k as i32);
        record[13..].copy_from_slice(&picture.to_le_bytes());
        out.write_all(&record[..if several { 17 } else { 13 }])?;
    }
    Ok(())
}
