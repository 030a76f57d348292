//! What `info` says of mesh files.

use crate::failure::Failure;
use crate::{inputs, out, text};
use serde_json::{Value, json};
use std::path::Path;
use yamanami::core::TriangleMesh;
use yamanami::io::mesh_file;
use yamanami::measure::{MeshDefects, conformity, mesh_defects};

/// Reads a mesh, says what it is (unless `quiet`) and gives the same as JSON.
pub(crate) fn tell(path: &Path, quiet: bool) -> Result<Value, Failure> {
    let read = mesh_file::read_mesh_with_notes(path)?;
    let mesh = &read.mesh;
    let bytes = inputs::file_bytes(path)?;
    let found = mesh_defects(mesh);
    // a height over every place: what folds over, or stands upright, is no terrain
    let is_terrain = found.faces_up == found.triangles && found.triangles > 0;
    let t_vertices = is_terrain.then(|| conformity(mesh).t_vertices);
    if !quiet {
        print(path, bytes, mesh, &found, t_vertices)?;
        for note in &read.notes {
            out::row("note", note)?;
        }
    }
    let bounds = mesh.bounds();
    let corner = |p: glam::DVec3| (!mesh.positions.is_empty()).then_some([p.x, p.y, p.z]);
    let materials: Vec<Value> = mesh
        .materials
        .iter()
        .map(|m| {
            let texture = m.texture.as_ref().map(|t| json!({"name": t.name, "bytes": t.bytes.len()}));
            json!({"name": m.name, "base_colour": m.base_colour, "texture": texture})
        })
        .collect();
    Ok(json!({
        "kind": "mesh",
        "paths": [path],
        "bytes": bytes,
        "faces": found.triangles,
        "vertices": found.vertices,
        "places": found.places,
        "min": corner(bounds.min),
        "max": corner(bounds.max),
        "is_terrain": is_terrain,
        "components": found.components,
        "open_edges": found.open_edges,
        "border_loops": found.border_loops,
        "non_manifold_edges": found.non_manifold_edges,
        "inconsistent_edges": found.inconsistent_edges,
        "duplicate_faces": found.duplicate_faces,
        "repeated_corner_faces": found.repeated_corner_faces,
        "zero_area_faces": found.zero_area_faces,
        "isolated_vertices": found.isolated_vertices,
        "unwelded_places": found.unwelded_places,
        "t_vertices": t_vertices,
        "has_normals": !mesh.normals.is_empty(),
        "has_colours": !mesh.colours.is_empty(),
        "has_texcoords": !mesh.texcoords.is_empty(),
        "materials": materials,
        "notes": read.notes,
    }))
}

fn print(
    path: &Path,
    bytes: u64,
    mesh: &TriangleMesh,
    found: &MeshDefects,
    t_vertices: Option<usize>,
) -> Result<(), Failure> {
    let count = |n: usize| text::count(n as u64);
    let listed = |counts: &[(&str, usize)], otherwise: &str| {
        let some = counts.iter().filter(|(_, n)| *n > 0);
        let list = some.map(|(name, n)| format!("{} {name}", count(*n))).collect::<Vec<_>>().join(", ");
        if list.is_empty() { otherwise.to_owned() } else { list }
    };
    out::row("file", format_args!("{}, {}", path.display(), text::bytes(bytes)))?;
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_uppercase();
    let format = name.trim_end_matches(".GZ").trim_end_matches(".ZST").rsplit('.').next().unwrap_or_default();
    let terrain = if t_vertices.is_some() { ", a terrain: nothing folds over" } else { "" };
    out::row("format", format_args!("{format} mesh{terrain}"))?;
    out::row("faces", count(found.triangles))?;
    out::row("vertices", format_args!("{} ({} places)", count(found.vertices), count(found.places)))?;
    if !mesh.positions.is_empty() {
        let bounds = mesh.bounds();
        let axis = |name: &str, a: f64, b: f64| format!("{name} {a:.3} to {b:.3}");
        let (a, b) = (bounds.min, bounds.max);
        out::row("bounds", [axis("x", a.x, b.x), axis("y", a.y, b.y), axis("z", a.z, b.z)].join(", "))?;
    }
    let carried = [
        ("normals", !mesh.normals.is_empty()),
        ("colours", !mesh.colours.is_empty()),
        ("texture coordinates", !mesh.texcoords.is_empty()),
    ];
    let carried: Vec<&str> = carried.iter().filter(|(_, has)| *has).map(|(name, _)| *name).collect();
    out::row("carries", if carried.is_empty() { "places only".to_owned() } else { carried.join(", ") })?;
    if !mesh.materials.is_empty() {
        let textures = mesh.materials.iter().flat_map(|m| &m.texture);
        let mut textures: Vec<String> =
            textures.map(|t| format!("{} ({})", t.name, text::bytes(t.bytes.len() as u64))).collect();
        textures.sort();
        textures.dedup();
        let list = if textures.is_empty() { String::new() } else { format!("; textures {}", textures.join(", ")) };
        out::row("materials", format_args!("{}{list}", count(mesh.materials.len())))?;
    }
    out::row("components", count(found.components))?;
    let border = [("open edges", found.open_edges)];
    let loops = match found.border_loops {
        0 => String::new(),
        1 => " in 1 loop".to_owned(),
        n => format!(" in {} loops", count(n)),
    };
    out::row("border", format_args!("{}{loops}", listed(&border, "closed")))?;
    let defects = [
        ("non-manifold edges", found.non_manifold_edges),
        ("edges with faces turned over", found.inconsistent_edges),
        ("duplicate faces", found.duplicate_faces),
        ("faces with a repeated corner", found.repeated_corner_faces),
        ("faces without area", found.zero_area_faces),
        ("isolated vertices", found.isolated_vertices),
        ("places with several vertices", found.unwelded_places),
        ("T-vertices", t_vertices.unwrap_or(0)),
    ];
    out::row("defects", listed(&defects, "none"))
}
