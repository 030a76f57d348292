//! GeoJSON: the features and shapes in it, for maps and for breaklines.
//!
//! Format: IETF RFC 7946, "The GeoJSON Format", 2016 (H. Butler et al.); its older form with a `crs` member too.

use super::feature::{Feature, Features, Line, Shape};
use super::words::{Words, word_of};
use crate::{IoError, crs};
use glam::DVec3;
use serde_json::Value;
use std::path::Path;
use yamanami_core::Crs;

/// The whole of a file.
pub(crate) fn parse(label: &Path, bytes: &[u8]) -> Result<Value, IoError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    serde_json::from_slice(bytes)
        .map_err(|e| IoError::malformed(label, format!("line {}", e.line()), "GeoJSON", e.to_string()))
}

/// The CRS of a `crs` member: `urn:ogc:def:crs:EPSG::6677` or `EPSG:6677`; one that is not known has but its name.
pub(crate) fn stated_crs(root: &Value) -> Option<Crs> {
    let name = root.get("crs")?.get("properties")?.get("name")?.as_str()?;
    if name.ends_with("CRS84") {
        return crs::from_epsg(4326);
    }
    let code = name.rsplit(':').next().filter(|_| name.contains("EPSG")).and_then(|code| code.parse().ok());
    Some(code.and_then(crs::from_epsg).unwrap_or_else(|| Crs { epsg: code, name: name.to_owned(), ..Crs::default() }))
}

fn members<'v>(object: &'v Value, key: &str) -> &'v [Value] {
    object.get(key).and_then(Value::as_array).map(Vec::as_slice).unwrap_or_default()
}

/// Gives every feature's properties and geometry; of a bare geometry there are no properties. (How deep collections nest
/// is bounded: by the parser of JSON.)
pub(crate) fn for_each<'v>(object: &'v Value, visit: &mut dyn FnMut(&'v Value, &'v Value)) {
    match object.get("type").and_then(Value::as_str) {
        Some("FeatureCollection") => members(object, "features").iter().for_each(|f| for_each(f, visit)),
        Some("Feature") => {
            visit(object.get("properties").unwrap_or(&Value::Null), object.get("geometry").unwrap_or(&Value::Null));
        }
        _ => visit(&Value::Null, object),
    }
}

/// Adds a geometry's points and lines to a shape; how many parts of it are none.
pub(crate) fn add_geometry(geometry: &Value, shape: &mut Shape) -> usize {
    let parts = members(geometry, "coordinates");
    let mut faults = 0;
    let mut line = |places: &Value, is_area: bool| match places.as_array().map(Vec::as_slice).and_then(line_of) {
        Some(points) => shape.lines.push(Line { points, is_area }),
        None => faults += 1,
    };
    match geometry.get("type").and_then(Value::as_str) {
        Some("LineString") => line(&geometry["coordinates"], false),
        Some("MultiLineString") => parts.iter().for_each(|part| line(part, false)),
        Some("Polygon") => parts.iter().for_each(|ring| line(ring, true)),
        Some("MultiPolygon") => {
            let rings = parts.iter().flat_map(|polygon| polygon.as_array().map(Vec::as_slice).unwrap_or_default());
            rings.for_each(|ring| line(ring, true));
        }
        Some("Point") => match place(&geometry["coordinates"]) {
            Some(point) => shape.points.push(point),
            None => faults += 1,
        },
        Some("MultiPoint") => {
            let before = shape.points.len();
            shape.points.extend(parts.iter().filter_map(place));
            faults += parts.len() - (shape.points.len() - before);
        }
        Some("GeometryCollection") => {
            faults += members(geometry, "geometries").iter().map(|g| add_geometry(g, shape)).sum::<usize>();
        }
        _ => faults += 1,
    }
    faults
}

fn line_of(places: &[Value]) -> Option<Vec<DVec3>> {
    places.iter().map(place).collect()
}

fn place(place: &Value) -> Option<DVec3> {
    let of = |k: usize| place.get(k).and_then(Value::as_f64);
    Some(DVec3::new(of(0)?, of(1)?, of(2).unwrap_or(f64::NAN)))
}

/// Reads a file's features.
pub(super) fn read(label: &Path, bytes: &[u8]) -> Result<Features, IoError> {
    let root = parse(label, bytes)?;
    let mut features = Vec::new();
    for_each(&root, &mut |properties, geometry| {
        let mut feature = Feature { place: format!("feature {}", features.len() + 1), ..Feature::default() };
        feature.words = words_of(properties);
        if add_geometry(geometry, &mut feature.shape) > 0 {
            feature.fault = Some("a geometry that is none".to_owned());
        }
        features.push(feature);
    });
    let name = label.file_stem().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    Ok(Features { name, crs: stated_crs(&root), features, ..Features::default() })
}

fn words_of(properties: &Value) -> Words {
    let mut words = Words::default();
    for (key, value) in properties.as_object().into_iter().flatten() {
        let Some(word) = word_of(key) else { continue };
        match value {
            Value::String(text) => words.add(word, text),
            Value::Number(number) => words.add(word, &number.to_string()),
            _ => {}
        }
    }
    words
}
