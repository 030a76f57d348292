//! What `info` says of the databases of models.

use crate::failure::Failure;
use crate::progress::Bar;
use crate::{inputs, out, text};
use serde_json::{Value, json};
use std::path::Path;
use yamanami::io::store::ClusterStore;

/// Opens a database, says what it is (unless `quiet`) and gives the same as JSON. `verify`: reads every page.
pub(crate) fn tell(path: &Path, quiet: bool, verify: bool) -> Result<Value, Failure> {
    let store = ClusterStore::open(path)?;
    if verify {
        let _bar = Bar::spinner("verifying");
        store.verify()?;
    }
    let bytes = inputs::file_bytes(path)?;
    let meta = store.meta();
    let levels = levels(&store);
    let bytes_per_face = bytes as f64 / meta.source_faces.max(1) as f64;
    let (a, b) = (meta.bounds.min, meta.bounds.max);
    let what = if meta.tin.is_some() { "TIN" } else { "model" };
    let annex = store.annex()?;
    if !quiet {
        out::row("file", format_args!("{}, {}", path.display(), text::bytes(bytes)))?;
        out::row(
            "format",
            format_args!("yamanami database of a {what}, {} bytes a face", text::number(bytes_per_face)),
        )?;
        if !meta.source.is_empty() {
            out::row("made from", &meta.source)?;
        }
        out::row("faces", text::count(meta.source_faces))?;
        out::row("vertices", text::count(meta.source_vertices))?;
        let axis = |name: &str, a: f64, b: f64| format!("{name} {a:.3} to {b:.3}");
        out::row("bounds", [axis("x", a.x, b.x), axis("y", a.y, b.y), axis("z", a.z, b.z)].join(", "))?;
        if let Some(tin) = &meta.tin {
            out::row("CRS", format_args!("{}, {} m a unit", text::crs(&tin.crs), tin.unit_m))?;
            let [lines, hidden] = [annex.breaklines.len(), annex.unseen.triangles.len()].map(|n| text::count(n as u64));
            out::row("breaklines", format_args!("{lines}; {hidden} hidden faces"))?;
            out::row("kept", "bit for bit")?;
        } else {
            out::row("kept", format_args!("within {} m", text::number(meta.max_error_m)))?;
        }
        out::row("colours", if meta.has_colours { "of the vertices" } else { "none" })?;
        let each = levels.iter().map(usize::to_string).collect::<Vec<_>>().join(" ");
        out::row(
            "levels",
            format_args!(
                "{}; nodes, coarse to fine: {each}; {} triangles of all levels",
                levels.len(),
                text::count(meta.triangles)
            ),
        )?;
        if verify {
            out::row("verified", "every page is sound")?;
        }
    }
    Ok(json!({
        "kind": "database",
        "paths": [path],
        "format": format!("yamanami {what} database"),
        "title": meta.title,
        "source": meta.source,
        "bytes": bytes,
        "bytes_per_face": bytes_per_face,
        "faces": meta.source_faces,
        "vertices": meta.source_vertices,
        "min": [a.x, a.y, a.z],
        "max": [b.x, b.y, b.z],
        "max_error_m": meta.max_error_m,
        "crs_epsg": meta.tin.as_ref().and_then(|tin| tin.crs.epsg),
        "unit_m": meta.tin.as_ref().map(|tin| tin.unit_m),
        "breaklines": annex.breaklines.len(),
        "hidden_faces": annex.unseen.triangles.len(),
        "has_colours": meta.has_colours,
        "levels": levels.len(),
        "nodes": meta.nodes,
        "triangles_of_all_levels": meta.triangles,
        "vertices_of_all_levels": meta.vertices,
        "base_triangles": store.base_clusters().iter().map(|&n| u64::from(n)).sum::<u64>(),
        "verified": verify,
    }))
}

/// Nodes of each level, the coarsest first.
fn levels(store: &ClusterStore) -> Vec<usize> {
    let mut counts = std::collections::BTreeMap::new();
    for node in store.nodes() {
        *counts.entry(node.level).or_insert(0) += 1;
    }
    counts.into_values().collect()
}
