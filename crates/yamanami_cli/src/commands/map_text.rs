//! What `map` tells: as lines, or as JSON with the place of every name.

use super::map::Written;
use crate::failure::Failure;
use crate::{out, text};
use serde_json::{Value, json};
use std::path::Path;
use yamanami::MadeMap;
use yamanami::core::{MapView, NestedField};
use yamanami::map::Outcome;

/// Triangles of every sample within the rim: two a cell of the finest grid there.
pub(super) fn full_triangles(field: &NestedField, view: &MapView) -> u64 {
    let levels = field.levels();
    let mut cells = 0u64;
    for (i, level) in levels.iter().enumerate() {
        let finer_m = levels.get(i + 1).map_or(0.0, yamanami::core::FieldLevel::reach_m);
        let (width, half_m) = (level.width(), 0.5 * level.spacing_m());
        for row in 0..width - 1 {
            for column in 0..width - 1 {
                let middle = level.plane_from_grid(column, row) + glam::DVec2::new(half_m, -half_m);
                let is_finer = middle.abs().max_element() < finer_m;
                cells += u64::from(!is_finer && (middle - view.map.centre).length() <= view.rim_m);
            }
        }
    }
    2 * cells
}

/// How far named places lie from where they are drawn: the worst, pixels.
fn worst_name_px(made: &MadeMap) -> Option<f64> {
    let shown = made.composed.labels.iter().zip(&made.name_error_px);
    let shown = shown.filter(|(label, _)| matches!(label.outcome, Outcome::Shown | Outcome::ShownHidden));
    shown.map(|(_, &px)| px).filter(|px| px.is_finite()).reduce(f64::max)
}

fn count(made: &MadeMap, outcome: Outcome) -> usize {
    made.composed.labels.iter().filter(|label| label.outcome == outcome).count()
}

pub(super) fn print(file: &Path, written: &Written) -> Result<(), Failure> {
    let Written { job, ground, full_triangles: full, made, times, .. } = written;
    let [width, height] = job.view.size_px;
    out::row("map", format_args!("{}, {width} x {height} px", file.display()))?;
    for source in &ground.sources {
        let (name, share) = (source.path.display(), 100.0 * source.share);
        out::row("ground", format_args!("{name}, {} between samples: {share:.1} %", text::length_m(source.spacing_m)))?;
    }
    let grids: Vec<String> = ground.field.levels().iter().map(|level| text::length_m(level.spacing_m())).collect();
    out::row(
        "heights",
        format_args!("{} known within the rim, in grids of {}", percent(ground.known_share), grids.join(", ")),
    )?;
    let ratio = *full as f64 / made.triangles.max(1) as f64;
    out::row(
        "triangles",
        format_args!(
            "{} of {} ({} times fewer)",
            text::count(made.triangles as u64),
            text::count(*full),
            text::number(ratio)
        ),
    )?;
    match made.error_px {
        Some(px) => out::row("error", format_args!("at most {} px, everywhere", text::number(f64::from(px))))?,
        None => out::row("error", "not bounded by the paper's bands")?,
    }
    if let Some(e) = &made.errors {
        out::row(
            "measured",
            format_args!(
                "at {} samples: at most {} px, 99.9 % within {} px, RMS {} px, {:.3} % of 3.5 px and more",
                text::count(e.samples as u64),
                text::number(e.max_px),
                text::number(e.p999_px),
                text::number(e.rms_px),
                100.0 * e.over_large
            ),
        )?;
    }
    if !made.composed.labels.is_empty() {
        let shown = count(made, Outcome::Shown) + count(made, Outcome::ShownHidden);
        out::row(
            "names",
            format_args!(
                "{shown} shown, {} hidden, {} without room, {} beyond the rim",
                count(made, Outcome::Hidden),
                count(made, Outcome::Crowded),
                count(made, Outcome::BeyondRim)
            ),
        )?;
        if let Some(px) = worst_name_px(made) {
            out::row("", format_args!("the ground at each is drawn within {} px of its place", text::number(px)))?;
        }
    }
    let seconds = |ms: f64| text::number(ms / 1e3);
    out::row(
        "time",
        format_args!(
            "ground {} s, hierarchy {} s, map {} s, file {} s",
            seconds(times.read_ms),
            seconds(times.build_ms),
            seconds(times.make_ms),
            seconds(times.write_ms)
        ),
    )
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

pub(super) fn to_json(written: &Written) -> Value {
    let Written { job, ground, full_triangles: full, places, made, times } = written;
    let (view, map) = (&job.view, &job.view.map);
    let names: Vec<Value> = made
        .composed
        .labels
        .iter()
        .zip(places)
        .zip(&made.name_error_px)
        .map(|((label, place), error_px)| {
            let lon_lat = place.position.is_finite().then(|| ground.plane.to_lon_lat(place.position));
            json!({
                "name": label.name,
                "reading": place.reading,
                "outcome": label.outcome.word(),
                "lat": lon_lat.map(|[_, lat]| lat),
                "lon": lon_lat.map(|[lon, _]| lon),
                "x_m": finite(label.at.x),
                "y_m": finite(label.at.y),
                "height_m": finite(label.at.z),
                "distance_m": finite(label.distance_m),
                "bearing_deg": finite(label.bearing_rad.to_degrees()),
                "anchor_px": [finite(label.anchor_px.x), finite(label.anchor_px.y)],
                "box_px": label.box_px.as_ref().map(|b| b.corners().map(|p| [p.x, p.y])),
                "ground_error_px": finite(*error_px),
            })
        })
        .collect();
    json!({
        "size_px": view.size_px,
        "centre_px": [view.centre_px.x, view.centre_px.y],
        "ring_px": view.ring_px,
        "projection": {
            "ring_m": map.ring_m,
            "eye_m": map.eye_m,
            "alpha": map.alpha,
            "alpha_fall": map.alpha_fall,
            "scale": map.scale,
            "exaggeration": map.exaggeration,
            "refraction": map.curvature.map(|c| c.refraction),
            "rim_m": view.rim_m,
            "up_azimuth_deg": view.up_azimuth_rad.to_degrees(),
        },
        "known_share": ground.known_share,
        "grid_spacings_m": ground.field.levels().iter().map(yamanami::core::FieldLevel::spacing_m).collect::<Vec<_>>(),
        "triangles": made.triangles,
        "full_triangles": full,
        "error_bound_px": made.error_px,
        "measured": made.errors.map(|e| json!({
            "samples": e.samples,
            "max_px": e.max_px,
            "p999_px": e.p999_px,
            "rms_px": e.rms_px,
            "share_over_3_5_px": e.over_large,
        })),
        "worst_name_error_px": worst_name_px(made),
        "names": names,
        "read_ms": times.read_ms,
        "build_ms": times.build_ms,
        "make_ms": times.make_ms,
        "write_ms": times.write_ms,
    })
}

fn finite(v: f64) -> Option<f64> {
    v.is_finite().then_some(v)
}
