//! What `reduce` tells of its work.

use super::cleaning;
use super::reduce::Told;
use crate::failure::Failure;
use crate::{out, text};
use serde_json::json;
use yamanami::measure::ModelDifference;
use yamanami::{Closing, LookLimits, LookSame, Probe, ReducedBy};

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
        "certified_m": told.reduced.certified_m,
        "cleaned": told.cleaned.as_ref().map(cleaning::to_json),
        "reduce_s": told.reduce_s,
        "bytes": told.bytes,
    });
    if let (Some(need), Some([width, height])) = (&told.need, told.display) {
        result["display"] = json!({
            "width_px": width,
            "height_px": height,
            "covered_px": need.covered_px,
            "pixels": need.pixels,
            "polygons_per_pixel": told.args.polygons_per_pixel,
            "faces_per_pixel": mesh.triangles.len() as f64 / need.pixels.max(1) as f64,
        });
    }
    if let Some(hidden) = told.hidden_faces {
        result["hidden_faces"] = json!(hidden);
    }
    if let Some(closing) = told.closing {
        result["closing"] = json!({
            "polygons": closing.polygons,
            "largest_corners": closing.largest,
            "faces": closing.faces,
            "left_open": closing.left_open,
        });
    }
    if let Some(look) = told.look {
        let measures =
            |d: &ModelDifference| json!({ "flip_mean": d.flip_mean, "flip_p99": d.flip_p99, "ssim": d.ssim });
        let limits = |l: &LookLimits| json!({ "flip_mean": l.flip_mean, "flip_p99": l.flip_p99, "ssim": l.ssim });
        let probe = |p: &Probe| json!({ "faces": p.faces, "same": p.same, "difference": measures(&p.difference) });
        result["look"] = json!({
            "difference": look.difference.as_ref().map(measures),
            "limits": look.limits.iter().map(limits).collect::<Vec<_>>(),
            "probes": look.probes.iter().map(probe).collect::<Vec<_>>(),
        });
    }
    out::json(&result)
}

fn as_text(told: &Told<'_>) -> Result<(), Failure> {
    let (mesh, [faces, vertices]) = (&told.reduced.mesh, told.source);
    let count = |n: usize| text::count(n as u64);
    out::row("source", format_args!("{} faces, {} vertices", count(faces), count(vertices)))?;
    if let Some(cleaned) = &told.cleaned {
        cleaning::tell(cleaned)?;
    }
    if let (Some(need), Some([width, height])) = (&told.need, told.display) {
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
    if let Some(hidden) = told.hidden_faces {
        out::row("hidden", format_args!("{} faces that no view sees", count(hidden)))?;
    }
    if told.target > 0 {
        let more = if told.target > faces { ", more than the source has" } else { "" };
        out::row("target", format_args!("{} faces{more}", count(told.target)))?;
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
    if let Some(certified_m) = told.reduced.certified_m {
        out::row(
            "certified",
            format_args!("never further than {} m from the source, both ways", text::number(certified_m)),
        )?;
    }
    if let Some(closing) = told.closing {
        out::row("closed", closing_text(&closing))?;
    }
    if let Some(look) = told.look {
        look_rows(look)?;
    }
    if told.reduced.by != ReducedBy::Nothing {
        out::row("time", format_args!("{} s to reduce", text::number(told.reduce_s)))?;
    }
    out::row("mesh file", format_args!("{}, {}", told.args.output.display(), text::bytes(told.bytes)))?;
    if let (Some(need), Some([width, height])) = (&told.need, told.display) {
        out::line("")?;
        out::line(format_args!("{:<12}{:>14}{:>8}{:>14}{:>14}", "display", "pixels (1x)", "k", "target", "result"))?;
        out::line(format_args!(
            "{:<12}{:>14}{:>8}{:>14}{:>14}",
            format!("{width}x{height}"),
            text::count(need.pixels),
            text::number(match told.look {
                Some(_) => mesh.triangles.len() as f64 / need.pixels.max(1) as f64,
                None => told.args.polygons_per_pixel,
            }),
            if told.look.is_some() { "looks same".to_owned() } else { count(told.target) },
            count(mesh.triangles.len())
        ))?;
    }
    Ok(())
}

fn closing_text(closing: &Closing) -> String {
    let polygons = match closing.polygons {
        0 => "by nothing".to_owned(),
        1 => format!("by one polygon of {} corners", text::count(closing.largest as u64)),
        n => format!("by {n} polygons, the largest of {} corners", text::count(closing.largest as u64)),
    };
    let open = match closing.left_open {
        0 => String::new(),
        1 => "; one border stays open where its polygon would show".to_owned(),
        n => format!("; {n} borders stay open where their polygon would show"),
    };
    format!("{polygons} ({} triangles){open}", text::count(closing.faces as u64))
}

fn look_rows(look: &LookSame) -> Result<(), Failure> {
    if let Some(d) = &look.difference {
        out::row(
            "difference",
            format_args!(
                "FLIP {} in the mean, {} at one pixel in a hundred; SSIM {:.4}: the worst of the views",
                text::number(d.flip_mean),
                text::number(d.flip_p99),
                d.ssim
            ),
        )?;
    }
    // the range over the views
    let range = |measure: fn(&LookLimits) -> f64| {
        let values = look.limits.iter().map(measure);
        let (low, high) = values.fold((f64::INFINITY, 0f64), |(low, high), v| (low.min(v), high.max(v)));
        if high - low < 1e-9 { text::number(low) } else { format!("{} to {}", text::number(low), text::number(high)) }
    };
    out::row(
        "limits",
        format_args!(
            "FLIP {} in the mean, {} at one pixel in a hundred; SSIM {}",
            range(|l| l.flip_mean),
            range(|l| l.flip_p99),
            range(|l| l.ssim)
        ),
    )?;
    let tried: Vec<String> = look
        .probes
        .iter()
        .map(|p| format!("{}{}", text::count(p.faces as u64), if p.same { "" } else { " (differs)" }))
        .collect();
    out::row("tried", tried.join(", "))
}

fn ending(told: &Told<'_>) -> String {
    let faces = text::count(told.source[0] as u64);
    if told.look.is_some() {
        return match told.reduced.by {
            ReducedBy::Nothing => format!("the look: nothing smaller than the source's {faces} faces looks the same"),
            _ => "the look: with fewer faces the difference shows".to_owned(),
        };
    }
    match told.reduced.by {
        ReducedBy::Nothing => {
            let least = told.need.as_ref().map_or_else(String::new, |need| {
                format!(", {} a pixel", text::number(told.source[0] as f64 / need.pixels.max(1) as f64))
            });
            format!("nothing to do: the source has {faces} faces{least}")
        }
        ReducedBy::Faces => "the target".to_owned(),
        ReducedBy::Error => "the error: the next step would not have been certain to stay within it".to_owned(),
        ReducedBy::Topology => {
            let wanted = if told.target > 0 {
                format!("; {} were wanted", text::count(told.target as u64))
            } else {
                String::new()
            };
            format!("the surface: no edge is left that can go without folding or pinching the surface{wanted}")
        }
    }
}
