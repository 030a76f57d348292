//! What `info` says of TIN files.

use crate::failure::Failure;
use crate::progress::Bar;
use crate::{inputs, out, text};
use serde_json::{Value, json};
use std::path::Path;
use yamanami::core::{BreaklineKind, Tin};
use yamanami::io::tin_file::{TinReadOptions, read_tin};
use yamanami::multires::tin::{line_edges, mend};

/// Reads a TIN, says what it is and what is wrong with it (unless `quiet`), and gives the same as JSON.
pub(crate) fn tell(path: &Path, quiet: bool) -> Result<Value, Failure> {
    let read = {
        let _bar = Bar::spinner("reading");
        read_tin(path, &TinReadOptions::default())?
    };
    let bytes = inputs::file_bytes(path)?;
    let given = [read.tin.mesh.triangles.len(), read.tin.mesh.positions.len()];
    let mended = mend(read.tin);
    let tin = &mended.tin;
    let faults: Vec<String> = mended.faults.iter().map(ToString::to_string).collect();
    let area_m2 = plan_area_m2(tin);
    let missing = line_edges(tin).missing;
    let count_of = |kind: BreaklineKind| tin.breaklines.iter().filter(|l| l.kind == kind).count();
    let kinds = [BreaklineKind::Hard, BreaklineKind::Soft, BreaklineKind::Boundary].map(count_of);
    let bounds = tin.mesh.bounds();
    if !quiet {
        let count = |n: usize| text::count(n as u64);
        out::row("file", format_args!("{}, {}", path.display(), text::bytes(bytes)))?;
        out::row("format", "TIN")?;
        if !tin.name.is_empty() {
            out::row("surface", &tin.name)?;
        }
        if !read.other_surfaces.is_empty() {
            out::row("others", read.other_surfaces.join(", "))?;
        }
        out::row("faces", format_args!("{}, {} hidden", count(given[0]), count(tin.hidden.len())))?;
        out::row("vertices", count(given[1]))?;
        let [hard, soft, boundary] = kinds;
        out::row("breaklines", format_args!("{hard} hard, {soft} soft, {boundary} boundaries"))?;
        if missing > 0 {
            out::row("not edges", format_args!("{} steps of breaklines", count(missing)))?;
        }
        if !tin.mesh.positions.is_empty() {
            let axis = |name: &str, a: f64, b: f64| format!("{name} {a:.3} to {b:.3}");
            let (a, b) = (bounds.min, bounds.max);
            out::row("bounds", [axis("x", a.x, b.x), axis("y", a.y, b.y), axis("z", a.z, b.z)].join(", "))?;
        }
        out::row("area", format_args!("{} m² in plan", text::number(area_m2)))?;
        out::row("CRS", format_args!("{}, {} m a unit", text::crs(&tin.crs), tin.unit_m))?;
        for line in read.notes.iter().chain(&faults) {
            out::row("note", line)?;
        }
    }
    let corner = |p: glam::DVec3| (!tin.mesh.positions.is_empty()).then_some([p.x, p.y, p.z]);
    Ok(json!({
        "kind": "TIN",
        "paths": [path],
        "bytes": bytes,
        "surface": tin.name,
        "other_surfaces": read.other_surfaces,
        "faces": given[0],
        "vertices": given[1],
        "hidden_faces": tin.hidden.len(),
        "hard_breaklines": kinds[0],
        "soft_breaklines": kinds[1],
        "boundaries": kinds[2],
        "breakline_steps_that_are_no_edges": missing,
        "min": corner(bounds.min),
        "max": corner(bounds.max),
        "plan_area_m2": area_m2,
        "crs_epsg": tin.crs.epsg,
        "crs_name": tin.crs.name,
        "unit_m": tin.unit_m,
        "notes": read.notes,
        "faults": faults,
    }))
}

fn plan_area_m2(tin: &Tin) -> f64 {
    let corners = |t| tin.mesh.corners(t);
    (0..tin.mesh.triangles.len()).map(corners).map(|[a, b, c]| 0.5 * (b - a).cross(c - a).z).sum()
}
