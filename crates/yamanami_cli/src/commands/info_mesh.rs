//! What `info` says of mesh files.

use crate::failure::Failure;
use crate::{inputs, out, text};
use serde_json::{Value, json};
use std::path::Path;
use yamanami::io::mesh_file;
use yamanami::measure::conformity;

/// Reads a mesh, says what it is (unless `quiet`) and gives the same as JSON.
pub(crate) fn tell(path: &Path, quiet: bool) -> Result<Value, Failure> {
    let mesh = mesh_file::read_mesh(path)?;
    let bytes = inputs::file_bytes(path)?;
    let bounds = mesh.bounds();
    let found = conformity(&mesh);
    // a height over every place: what folds over, or stands upright, is no terrain
    let is_terrain = found.flipped == 0 && found.degenerate == 0 && !mesh.triangles.is_empty();
    if !quiet {
        let format = path.extension().unwrap_or_default().to_string_lossy().to_uppercase();
        out::row("file", format_args!("{}, {}", path.display(), text::bytes(bytes)))?;
        out::row(
            "format",
            format_args!("{format} mesh{}", if is_terrain { ", a terrain: nothing folds over" } else { "" }),
        )?;
        out::row("faces", text::count(mesh.triangles.len() as u64))?;
        out::row(
            "vertices",
            format_args!(
                "{} ({} places)",
                text::count(mesh.positions.len() as u64),
                text::count(found.vertices as u64)
            ),
        )?;
        if !mesh.positions.is_empty() {
            let axis = |name: &str, a: f64, b: f64| format!("{name} {a:.3} to {b:.3}");
            let (a, b) = (bounds.min, bounds.max);
            out::row("bounds", [axis("x", a.x, b.x), axis("y", a.y, b.y), axis("z", a.z, b.z)].join(", "))?;
        }
        let closed = if found.open_edges == 0 {
            "closed".to_owned()
        } else {
            format!(
                "{} open edges in {} loops",
                text::count(found.open_edges as u64),
                text::count(found.border_loops as u64)
            )
        };
        out::row("border", closed)?;
        let mut defects = vec![
            ("non-manifold edges", found.non_manifold_edges),
            ("edges with faces turned over", found.inconsistent_edges),
        ];
        if is_terrain {
            defects.push(("T-vertices", found.t_vertices));
        }
        defects.retain(|(_, n)| *n > 0);
        let list =
            defects.iter().map(|(name, n)| format!("{} {name}", text::count(*n as u64))).collect::<Vec<_>>().join(", ");
        out::row("defects", if list.is_empty() { "none" } else { &list })?;
    }
    let corner = |p: glam::DVec3| (!mesh.positions.is_empty()).then_some([p.x, p.y, p.z]);
    Ok(json!({
        "kind": "mesh",
        "paths": [path],
        "bytes": bytes,
        "faces": mesh.triangles.len(),
        "vertices": mesh.positions.len(),
        "places": found.vertices,
        "min": corner(bounds.min),
        "max": corner(bounds.max),
        "is_terrain": is_terrain,
        "open_edges": found.open_edges,
        "border_loops": found.border_loops,
        "non_manifold_edges": found.non_manifold_edges,
        "inconsistent_edges": found.inconsistent_edges,
        "t_vertices": is_terrain.then_some(found.t_vertices),
    }))
}
