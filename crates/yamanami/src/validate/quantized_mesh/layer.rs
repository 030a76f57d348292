//! layer.json: what it must say, and whether the tiles that it says are available are those that are there.
//!
//! Based on: Mapbox, "TileJSON 2.1", with what Cesium adds to it.

use super::pyramid::{Pyramid, TileId};
use crate::validate::report::ValidateReport;
use serde_json::Value;

const NAME: &str = "layer.json";

/// A rectangle of available tiles, ends included, rows as in names.
#[derive(Debug, Clone, Copy)]
pub(super) struct Range {
    x: [u32; 2],
    y: [u32; 2],
}

impl Range {
    pub(super) fn of(value: &Value) -> Option<Self> {
        let number = |key: &str| value[key].as_u64().and_then(|v| u32::try_from(v).ok());
        let range = Self { x: [number("startX")?, number("endX")?], y: [number("startY")?, number("endY")?] };
        (range.x[0] <= range.x[1] && range.y[0] <= range.y[1]).then_some(range)
    }

    fn holds(&self, id: TileId) -> bool {
        (self.x[0]..=self.x[1]).contains(&id.x) && (self.y[0]..=self.y[1]).contains(&id.y)
    }

    /// A tile of the rectangle that is not there.
    pub(super) fn missing(&self, pyramid: &Pyramid, z: u32) -> Option<TileId> {
        // after so many tiles as there are, one is missing at the latest
        let places = (self.x[0]..=self.x[1]).flat_map(|x| (self.y[0]..=self.y[1]).map(move |y| TileId { z, x, y }));
        places.take(pyramid.tiles.len() + 1).find(|id| !pyramid.tiles.contains(id))
    }
}

/// What is wrong with the document itself.
pub(super) fn check(layer: &Value, report: &mut ValidateReport) {
    let mut wrong = |code, place: &str, expected: &str, found: &Value| {
        report.add(code, NAME, place, expected, found.to_string());
    };
    let format = layer["format"].as_str().unwrap_or_default();
    if !format.starts_with("quantized-mesh-1.") {
        wrong("LJ02", "format", "quantized-mesh-1.0", &layer["format"]);
    }
    if !layer["tilejson"].is_string() {
        wrong("LJ02", "tilejson", "a version like 2.1.0", &layer["tilejson"]);
    }
    let template = layer["tiles"][0].as_str().unwrap_or_default();
    if !["{z}", "{x}", "{y}"].iter().all(|part| template.contains(part)) {
        wrong("LJ03", "tiles", "a template like {z}/{x}/{y}.terrain", &layer["tiles"]);
    }
    let scheme = &layer["scheme"];
    let known =
        scheme.is_null() || scheme.as_str().is_some_and(|s| ["tms", "slippymap"].contains(&s.to_lowercase().as_str()));
    if !known {
        wrong("LJ04", "scheme", "tms or slippyMap", scheme);
    }
    let projection = &layer["projection"];
    if !(projection.is_null() || projection == "EPSG:4326" || projection == "EPSG:3857") {
        wrong("LJ04", "projection", "EPSG:4326 or EPSG:3857", projection);
    }
    let bounds: Vec<f64> = layer["bounds"].as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
    let on_globe =
        |b: &[f64]| -180.0 <= b[0] && b[0] < b[2] && b[2] <= 180.0 && -90.0 <= b[1] && b[1] < b[3] && b[3] <= 90.0;
    if !(layer["bounds"].is_null() || bounds.len() == 4 && on_globe(&bounds)) {
        wrong("LJ05", "bounds", "west, south, east and north in degrees", &layer["bounds"]);
    }
}

/// Holds layer.json against the tiles that are there.
pub(super) fn check_available(pyramid: &Pyramid, layer: &Value, report: &mut ValidateReport) {
    let zooms = || pyramid.tiles.iter().map(|id| id.z);
    for (key, own) in [("minzoom", zooms().min()), ("maxzoom", zooms().max())] {
        if let (Some(stated), Some(own)) = (layer[key].as_u64(), own)
            && stated != u64::from(own)
        {
            report.add("LJ08", NAME, key, own.to_string(), stated.to_string());
        }
    }
    let Some(levels) = layer["available"].as_array() else {
        if layer["metadataAvailability"].is_null() {
            report.add("LJ07", NAME, "available", "ranges for every zoom", "none");
        }
        return;
    };
    let mut by_zoom: Vec<Vec<Range>> = Vec::new();
    for (z, ranges) in (0u32..).zip(levels) {
        let mut own = Vec::new();
        for range in ranges.as_array().into_iter().flatten() {
            let Some(parsed) = Range::of(range).filter(|r| z <= 30 && r.x[1] < pyramid.columns(z) && r.y[1] < 1 << z)
            else {
                report.add("LJ06", NAME, format!("available, zoom {z}"), "a range of tiles", range.to_string());
                continue;
            };
            if let Some(id) = parsed.missing(pyramid, z) {
                report.add(
                    "LJ06",
                    NAME,
                    format!("available, zoom {z}"),
                    format!("{} to be there", pyramid.name(id)),
                    "no such file",
                );
            }
            own.push(parsed);
        }
        by_zoom.push(own);
    }
    if !layer["metadataAvailability"].is_null() {
        // the rest is told by the tiles themselves
        return;
    }
    for &id in &pyramid.tiles {
        if !by_zoom.get(id.z as usize).is_some_and(|ranges| ranges.iter().any(|r| r.holds(id))) {
            report.add("LJ07", &pyramid.name(id), "", "to be among the available", "not there");
        }
    }
}

/// Parents up to the root.
pub(super) fn check_tree(pyramid: &Pyramid, report: &mut ValidateReport) {
    for x in 0..pyramid.columns(0) {
        let root = TileId { z: 0, x, y: 0 };
        if !pyramid.tiles.contains(&root) {
            report.add("PY02", &pyramid.name(root), "", "a root tile: viewers start there", "no such file");
        }
    }
    for &id in pyramid.tiles.iter().filter(|id| id.z > 0) {
        let parent = id.ancestor(1);
        if !pyramid.tiles.contains(&parent) {
            report.add("PY01", &pyramid.name(id), "", format!("its parent {}", pyramid.name(parent)), "no such file");
        }
    }
}
