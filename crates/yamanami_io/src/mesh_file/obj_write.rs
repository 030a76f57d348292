//! Writing OBJ and the material library (MTL) beside it.

use super::MeshMeta;
use super::companions::{Pictures, word};
use std::collections::HashSet;
use std::io::{Result, Write};
use yamanami_core::TriangleMesh;

/// What faces call the materials: one word each, none twice.
pub(super) fn material_names(mesh: &TriangleMesh) -> Vec<String> {
    let mut taken = HashSet::new();
    let mut unique = |number: usize, name: &str| {
        let plain = word(name, &format!("material_{}", number + 1));
        let numbered = (2..).map(|k| format!("{plain}_{k}"));
        let mut names = std::iter::once(plain.clone()).chain(numbered);
        names.find(|name| taken.insert(name.clone())).unwrap_or(plain)
    };
    mesh.materials.iter().enumerate().map(|(number, m)| unique(number, &m.name)).collect()
}

pub(super) fn write_library(
    out: &mut dyn Write,
    mesh: &TriangleMesh,
    names: &[String],
    pictures: &Pictures,
) -> Result<()> {
    writeln!(out, "# written by yamanami")?;
    for (number, (material, name)) in mesh.materials.iter().zip(names).enumerate() {
        let [r, g, b, alpha] = material.base_colour;
        writeln!(out, "newmtl {name}\nKd {r} {g} {b}\nd {alpha}\nillum 1")?;
        if let Some(picture) = pictures.name_of(number) {
            writeln!(out, "map_Kd {picture}")?;
        }
    }
    Ok(())
}

pub(super) fn write(
    out: &mut dyn Write,
    mesh: &TriangleMesh,
    meta: &MeshMeta,
    library: &str,
    materials: &[String],
) -> Result<()> {
    writeln!(out, "# written by yamanami, metres, z up")?;
    for line in meta.lines() {
        writeln!(out, "# {line}")?;
    }
    if !materials.is_empty() {
        writeln!(out, "mtllib {library}")?;
    }
    // the shortest decimals that read back as the same numbers; of colours, as the same bytes
    for (i, p) in mesh.positions.iter().enumerate() {
        write!(out, "v {} {} {}", p.x, p.y, p.z)?;
        if let Some(colour) = mesh.colours.get(i) {
            let [r, g, b] = [0, 1, 2].map(|k| (f64::from(colour[k]) / 255.0 * 1e4).round() / 1e4);
            write!(out, " {r} {g} {b}")?;
        }
        writeln!(out)?;
    }
    for &[u, v] in &mesh.texcoords {
        // v is up here; in double precision the turn loses nothing
        writeln!(out, "vt {u} {}", 1.0 - f64::from(v))?;
    }
    for [x, y, z] in &mesh.normals {
        writeln!(out, "vn {x} {y} {z}")?;
    }
    let mut painted = None;
    for (number, t) in mesh.triangles.iter().enumerate() {
        let material = mesh.material(number);
        if painted != Some(material) {
            painted = Some(material);
            if let Some(name) = materials.get(material) {
                writeln!(out, "usemtl {name}")?;
            }
        }
        let [a, b, c] = t.map(|i| u64::from(i) + 1);
        match (mesh.texcoords.is_empty(), mesh.normals.is_empty()) {
            (true, true) => writeln!(out, "f {a} {b} {c}")?,
            (true, false) => writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}")?,
            (false, true) => writeln!(out, "f {a}/{a} {b}/{b} {c}/{c}")?,
            (false, false) => writeln!(out, "f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}")?,
        }
    }
    Ok(())
}
