//! Writing PLY: binary, little endian, double precision, so that projected coordinates keep every digit.

use super::MeshMeta;
use std::io::{Result, Write};
use yamanami_core::TriangleMesh;

pub(super) fn write(out: &mut impl Write, mesh: &TriangleMesh, meta: &MeshMeta) -> Result<()> {
    writeln!(out, "ply\nformat binary_little_endian 1.0\ncomment written by yamanami, metres, z up")?;
    for line in meta.lines() {
        writeln!(out, "comment {line}")?;
    }
    writeln!(out, "element vertex {}", mesh.positions.len())?;
    writeln!(out, "property double x\nproperty double y\nproperty double z")?;
    if !mesh.normals.is_empty() {
        writeln!(out, "property float nx\nproperty float ny\nproperty float nz")?;
    }
    writeln!(out, "element face {}", mesh.triangles.len())?;
    // most readers expect signed indices; unsigned ones only where they are needed
    let index = if mesh.positions.len() > i32::MAX as usize { "uint" } else { "int" };
    writeln!(out, "property list uchar {index} vertex_indices\nend_header")?;
    for (i, p) in mesh.positions.iter().enumerate() {
        for c in p.to_array() {
            out.write_all(&c.to_le_bytes())?;
        }
        for c in mesh.normals.get(i).into_iter().flatten() {
            out.write_all(&c.to_le_bytes())?;
        }
    }
    for t in &mesh.triangles {
        let mut record = [3u8; 13];
        for (k, i) in t.iter().enumerate() {
            record[1 + 4 * k..5 + 4 * k].copy_from_slice(&i.to_le_bytes());
        }
        out.write_all(&record)?;
    }
    Ok(())
}
