//! What `reduce` tells of its work.

use super::reduce::Told;
use crate::failure::Failure;
use crate::{out, text};
use serde_json::json;
use yamanami::ReducedBy;

/// Prints the outcome.
pub(super) fn tell(told: &Told<'_>) -> Result<(), Failure> {
    if told.args.json { as_json(told) } else { as_text(told) }
}

fn as_json(told: &Told<'_>) -> Result<(), Failure> {
    let mesh = &told.reduced.mesh;
    let mut result = json!({
        "output": told.args.output,
        "source_faces": told.source[0],
        "source_vertices": told.source[1],
        "faces": mesh.triangles.len(),
        "vertices": mesh.positions.len(),
        "target_faces": told.target,
        "stopped_by": match told.reduced.by {
            ReducedBy::Nothing => "source",
            ReducedBy::Faces => "target",
            ReducedBy::Error => "error",
            ReducedBy::Topology => "topology",
        },
        "estimate_m": told.reduced.estimate_m,
        "reduce_s": told.reduce_s,
        "bytes": told.bytes,
    });
    if let (Some(need), Some([width, height])) = (&told.need, told.args.display) {
        result["display"] = json!({
            "width_px": width,
            "height_px": height,
            "covered_px": need.covered_px,
            "pixels": need.pixels,
            "polygons_per_pixel": told.args.polygons_per_pixel,
            "faces_per_pixel": mesh.triangles.len() as f64 / need.pixels.max(1) as f64,
        });
    }
    out::json(&result)
}

fn as_text(told: &Told<'_>) -> Result<(), Failure> {
    let (mesh, [faces, vertices]) = (&told.reduced.mesh, told.source);
    let count = |n: usize| text::count(n as u64);
    out::row("source", format_args!("{} faces, {} vertices", count(faces), count(vertices)))?;
    if let (Some(need), Some([width, height])) = (&told.need, told.args.display) {
        for (i, (&covered, view)) in need.covered_px.iter().zip(told.views).enumerate() {
            let name = if i == 0 { "view" } else { "" };
            let from = view.eye - view.target;
            let counts = if covered == need.pixels && told.views.len() > 1 { ", the most: this counts" } else { "" };
            out::row(
                name,
                format_args!(
                    "{} of {} pixels covered, from {:.0}° east of north, {:.0}° up{counts}",
                    text::count(covered),
                    text::count(u64::from(width) * u64::from(height)),
                    from.x.atan2(from.y).to_degrees().rem_euclid(360.0),
                    from.z.atan2(from.x.hypot(from.y)).to_degrees()
                ),
            )?;
        }
    }
    if told.target > 0 {
        out::row("target", format_args!("{} faces", count(told.target)))?;
    }
    out::row(
        "result",
        format_args!(
            "{} faces ({} %), {} vertices",
            count(mesh.triangles.len()),
            text::number(100.0 * mesh.triangles.len() as f64 / faces.max(1) as f64),
            count(mesh.positions.len())
        ),
    )?;
    out::row("ended by", ending(told))?;
    if told.reduced.by != ReducedBy::Nothing {
        out::row("time", format_args!("{} s to reduce", text::number(told.reduce_s)))?;
    }
    out::row("mesh file", format_args!("{}, {}", told.args.output.display(), text::bytes(told.bytes)))?;
    if let (Some(need), Some([width, height])) = (&told.need, told.args.display) {
        out::line("")?;
        out::line(format_args!("{:<12}{:>14}{:>8}{:>14}{:>14}", "display", "pixels (1x)", "k", "target", "result"))?;
        out::line(format_args!(
            "{:<12}{:>14}{:>8}{:>14}{:>14}",
            format!("{width}x{height}"),
            text::count(need.pixels),
            text::number(told.args.polygons_per_pixel),
            count(need.faces),
            count(mesh.triangles.len())
        ))?;
    }
    Ok(())
}

fn ending(told: &Told<'_>) -> String {
    let faces = text::count(told.source[0] as u64);
    match told.reduced.by {
        ReducedBy::Nothing => {
            let least = told.need.as_ref().map_or_else(String::new, |need| {
                format!(", {} a pixel", text::number(told.source[0] as f64 / need.pixels.max(1) as f64))
            });
            format!("nothing to do: the source has {faces} faces{least}")
        }
        ReducedBy::Faces => "the target".to_owned(),
        ReducedBy::Error => format!(
            "the error: steps moved the surface by up to {} m by their own estimate",
            text::number(told.reduced.estimate_m)
        ),
        ReducedBy::Topology => {
            let wanted = if told.target > 0 {
                format!("; {} were wanted", text::count(told.target as u64))
            } else {
                String::new()
            };
            format!("the surface: no edge is left that can go without folding, pinching or losing a part{wanted}")
        }
    }
}
