//! What `info` says of elevation files and databases.

use super::info::HeightFacts;
use crate::failure::Failure;
use crate::{inputs, out, text};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use yamanami::core::GeoReference;
use yamanami::io::dem::DemFile;
use yamanami::io::store::{Quantum, TerrainStore};

/// The keys that every grid has.
fn grid_json(geo: &GeoReference, size: [usize; 2]) -> Value {
    let [west, south, east, north] = text::bounds(geo, size);
    json!({
        "width": size[0],
        "height": size[1],
        "samples": size[0] as u64 * size[1] as u64,
        "crs": {
            "epsg": geo.crs.epsg,
            "name": geo.crs.name,
            "geographic": geo.crs.geographic,
        },
        "step_x": geo.step[0],
        "step_y": geo.step[1],
        "step_x_m": geo.step_m[0],
        "step_y_m": geo.step_m[1],
        "west": west,
        "south": south,
        "east": east,
        "north": north,
    })
}

fn with(mut value: Value, more: Value) -> Value {
    if let (Value::Object(map), Value::Object(more)) = (&mut value, more) {
        map.extend(more);
    }
    value
}

pub(crate) fn dem_json(paths: &[PathBuf], file: &DemFile, facts: &HeightFacts) -> Value {
    let info = file.info();
    let samples = info.size[0] as f64 * info.size[1] as f64;
    with(
        grid_json(&info.geo, info.size),
        json!({
            "kind": "dem",
            "paths": paths,
            "format": info.format,
            "files": info.files,
            "bytes": inputs::total_bytes(paths),
            "sample_type": info.sample_type.to_string(),
            "compression": info.compression,
            "chunk": info.chunk,
            "overviews": info.overviews,
            "no_data_value": info.no_data.filter(|v| v.is_finite()),
            "no_data_samples": facts.no_data,
            "no_data_share": facts.no_data as f64 / samples,
            "min_m": facts.range_m.map(|r| r[0]),
            "max_m": facts.range_m.map(|r| r[1]),
            "notes": info.notes,
        }),
    )
}

pub(crate) fn print_dem(paths: &[PathBuf], file: &DemFile, facts: &HeightFacts) -> Result<(), Failure> {
    let info = file.info();
    let names: Vec<String> = paths.iter().take(4).map(|p| p.display().to_string()).collect();
    let more =
        if paths.len() > names.len() { format!(" and {} more", paths.len() - names.len()) } else { String::new() };
    out::row("file", format_args!("{}{more}, {}", names.join(", "), text::bytes(inputs::total_bytes(paths))))?;
    let parts = if info.files > 1 { format!(", mosaic of {} grids", info.files) } else { String::new() };
    out::row("format", format_args!("{}, {}, compression {}{parts}", info.format, info.sample_type, info.compression))?;
    out::row(
        "stored as",
        format_args!("blocks of {} x {}{}", info.chunk[0], info.chunk[1], overviews(&info.overviews)),
    )?;
    print_grid(&info.geo, info.size)?;
    let samples = info.size[0] as f64 * info.size[1] as f64;
    out::row("heights", range(facts.range_m))?;
    let stated = info.no_data.map_or_else(String::new, |v| format!(", stated as {v}"));
    out::row(
        "no-data",
        format_args!(
            "{} samples, {} %{stated}",
            text::count(facts.no_data),
            text::number(100.0 * facts.no_data as f64 / samples)
        ),
    )?;
    info.notes.iter().try_for_each(|note| out::row("note", note))
}

fn overviews(sizes: &[[usize; 2]]) -> String {
    match sizes {
        [] => ", no overviews".to_owned(),
        _ => format!(", overviews {}", sizes.iter().map(|[w, h]| format!("{w} x {h}")).collect::<Vec<_>>().join(", ")),
    }
}

fn range(range_m: Option<[f32; 2]>) -> String {
    range_m.map_or_else(
        || "none: no sample has data".to_owned(),
        |[low, high]| format!("{} to {} m", text::number(f64::from(low)), text::number(f64::from(high))),
    )
}

fn print_grid(geo: &GeoReference, size: [usize; 2]) -> Result<(), Failure> {
    let [width, height] = size;
    out::row("size", format_args!("{width} x {height} = {} samples", text::count(width as u64 * height as u64)))?;
    let [dx_m, dy_m] = geo.step_m.map(text::number);
    let in_degrees = || {
        let seconds = geo.step.map(|s| text::number(s.abs() * 3600.0));
        format!("{}\" x {}\", on the ground {dx_m} x {dy_m} m", seconds[0], seconds[1])
    };
    let spacing = if geo.crs.geographic { in_degrees() } else { format!("{dx_m} x {dy_m} m") };
    out::row("spacing", spacing)?;
    let extent = [geo.step_m[0] * (width - 1) as f64, geo.step_m[1] * (height - 1) as f64].map(text::length_m);
    out::row("extent", format_args!("{} x {}", extent[0], extent[1]))?;
    out::row("crs", text::crs(&geo.crs))?;
    let [west, south, east, north] = text::bounds(geo, size).map(|v| text::coordinate(v, &geo.crs));
    out::row("bounds", format_args!("x {west} to {east}, y {south} to {north}"))
}

/// Pages by level, coarsest first.
fn pages(store: &TerrainStore) -> Vec<u64> {
    let count = |level| store.pages_at(level).iter().map(|&n| u64::from(n)).product();
    (0..=store.lattice().levels()).rev().map(count).collect()
}

fn quantum_text(quantum: Quantum) -> String {
    match quantum {
        Quantum::PerMetre(1) => "whole metres".to_owned(),
        Quantum::PerMetre(n) => format!("multiples of {} m", text::number(1.0 / f64::from(n))),
        Quantum::Step(step_m) => format!("multiples of {} m", text::number(step_m)),
        _ => "32-bit floats, bit by bit".to_owned(),
    }
}

pub(crate) fn database_json(path: &Path, store: &TerrainStore, bytes: u64, verified: bool) -> Value {
    let meta = store.meta();
    let size = meta.size.map(|n| n as usize);
    let samples = size[0] as f64 * size[1] as f64;
    with(
        grid_json(&meta.geo, size),
        json!({
            "kind": "database",
            "paths": [path],
            "format": "yamanami surface database",
            "title": meta.title,
            "source": meta.source,
            "bytes": bytes,
            "bytes_per_sample": bytes as f64 / samples,
            "levels": store.lattice().levels() + 1,
            "pages": pages(store).iter().sum::<u64>(),
            "max_error_m": meta.max_error_m,
            "heights": quantum_text(meta.quantum),
            "has_holes": meta.has_holes,
            "min_m": meta.height_range_m[0],
            "max_m": meta.height_range_m[1],
            "verified": verified,
        }),
    )
}

pub(crate) fn print_database(path: &Path, store: &TerrainStore, bytes: u64, verified: bool) -> Result<(), Failure> {
    let meta = store.meta();
    let size = meta.size.map(|n| n as usize);
    let samples = size[0] as f64 * size[1] as f64;
    out::row("file", format_args!("{}, {}", path.display(), text::bytes(bytes)))?;
    out::row(
        "format",
        format_args!("yamanami surface database, {} bytes a sample", text::number(bytes as f64 / samples)),
    )?;
    if !meta.source.is_empty() {
        out::row("made from", &meta.source)?;
    }
    print_grid(&meta.geo, size)?;
    out::row("heights", range(Some(meta.height_range_m)))?;
    let kept = if meta.max_error_m > 0.0 {
        format!("within {} m, as {}", text::number(meta.max_error_m), quantum_text(meta.quantum))
    } else {
        format!("exactly, as {}", quantum_text(meta.quantum))
    };
    out::row("kept", kept)?;
    out::row("no-data", if meta.has_holes { "some" } else { "none" })?;
    let pages = pages(store);
    let each = pages.iter().map(u64::to_string).collect::<Vec<_>>().join(" ");
    out::row("levels", format_args!("{}; pages, coarse to fine: {each}", pages.len()))?;
    if verified { out::row("verified", "every page is sound") } else { Ok(()) }
}
