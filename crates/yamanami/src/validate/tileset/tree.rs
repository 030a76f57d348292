//! All tiles of a tileset with their place in the world, and what is wrong with the documents that name them.
//!
//! Based on: Open Geospatial Consortium, "3D Tiles Specification 1.1", 2023.

use super::implicit;
use super::volume::Volume;
use crate::validate::report::ValidateReport;
use glam::{DMat3, DMat4};
use serde_json::Value;
use std::collections::BTreeSet;
use yamanami_io::inspect::{Container, Faults, Wrapped, unwrapped, without_gzip};

/// Most tiles of a tileset that are looked at.
pub(super) const MOST_TILES: usize = 1 << 22;

/// Deepest explicit tiles and external tilesets.
const DEEPEST: u32 = 128;

/// Extensions that may be required.
const KNOWN: [&str; 5] = [
    "3DTILES_content_gltf",
    "3DTILES_implicit_tiling",
    "3DTILES_multiple_contents",
    "3DTILES_metadata",
    "3DTILES_bounding_volume_S2",
];

/// A tile.
#[derive(Debug, Clone)]
pub(super) struct Tile {
    pub(super) parent: Option<usize>,
    pub(super) depth: u32,
    pub(super) name: String,
    pub(super) world_from_tile: DMat4,
    pub(super) volume: Option<Volume>,
    pub(super) error_m: f64,
    pub(super) is_added: bool,
    /// Files of triangles, by their names in the container.
    pub(super) contents: Vec<String>,
    pub(super) has_children: bool,
}

/// The tiles of a tileset, parents before children.
pub(super) struct Tree<'c> {
    pub(super) container: &'c Container,
    pub(super) tiles: Vec<Tile>,
    /// Names of all files that documents name.
    pub(super) named: BTreeSet<String>,
}

/// Where a document stands.
pub(super) struct Document<'d> {
    /// Its name in the container.
    pub(super) name: &'d str,
    pub(super) schema: &'d Value,
    /// Names of the documents around it, its own included.
    pub(super) above: Vec<String>,
}

/// What a tile hands down.
#[derive(Clone, Copy)]
pub(super) struct From {
    pub(super) parent: Option<usize>,
    pub(super) depth: u32,
    pub(super) world_from_parent: DMat4,
    pub(super) error_m: f64,
    pub(super) is_added: bool,
}

/// A name relative to a document's; `None` for what does not lie in the container.
pub(super) fn beside(document: &str, uri: &str) -> Option<String> {
    let uri = uri.split(['?', '#']).next().unwrap_or_default();
    if uri.contains(':') || uri.starts_with('/') {
        return None;
    }
    let mut parts: Vec<&str> = document.split('/').collect();
    parts.pop();
    for part in uri.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop()?;
            }
            part => parts.push(part),
        }
    }
    Some(parts.join("/").replace("%20", " "))
}

impl<'c> Tree<'c> {
    /// Reads a tileset and those that it includes.
    pub(super) fn read(container: &'c Container, name: &str, report: &mut ValidateReport) -> Self {
        let mut tree = Self { container, tiles: Vec::new(), named: BTreeSet::new() };
        let top = From {
            parent: None,
            depth: 0,
            world_from_parent: DMat4::IDENTITY,
            error_m: f64::INFINITY,
            is_added: false,
        };
        match container.read(name) {
            Ok(Some(bytes)) => tree.document(name, &bytes, Vec::new(), top, report),
            Ok(None) => report.add("TS01", name, "", "a tileset", "no such file"),
            Err(cause) => report.add("TS01", name, "", "a tileset that can be read", cause.to_string()),
        }
        tree
    }

    fn document(&mut self, name: &str, bytes: &[u8], mut above: Vec<String>, from: From, report: &mut ValidateReport) {
        self.named.insert(name.to_owned());
        let mut faults = Faults::default();
        let plain = without_gzip(bytes, "TS01", &mut faults).unwrap_or_default();
        report.add_all(name, faults.into_vec());
        let document: Value = match serde_json::from_slice(&plain) {
            Ok(Value::Object(map)) => Value::Object(map),
            other => {
                let found = other.map_or_else(|e| e.to_string(), |_| "something else".into());
                report.add("TS01", name, "", "a JSON object", found);
                return;
            }
        };
        let version = &document["asset"]["version"];
        if !(version == "1.0" || version == "1.1") {
            let code = if version.is_null() { "TS02" } else { "TS03" };
            report.add(code, name, "asset.version", "1.0 or 1.1", version.to_string());
        }
        let known = |extension: &&str| KNOWN.contains(extension);
        let required = document["extensionsRequired"].as_array().into_iter().flatten().filter_map(Value::as_str);
        if let Some(unknown) = required.clone().find(|e| !known(e)) {
            report.add("TS17", name, "extensionsRequired", "extensions that are known", unknown);
        }
        if !document["root"].is_object() {
            report.add("TS02", name, "root", "a tile", document["root"].to_string());
            return;
        }
        match (document["geometricError"].as_f64(), document["root"]["geometricError"].as_f64()) {
            (None, _) => report.add("TS02", name, "geometricError", "a number", document["geometricError"].to_string()),
            (Some(error), Some(root)) if error < root => {
                report.add("TS13", name, "geometricError", format!("at least its root's {root}"), error.to_string());
            }
            (Some(error), _) if error < 0.0 => {
                report.add("TS04", name, "geometricError", "a number, not negative", error.to_string());
            }
            _ => {}
        }
        if document["root"]["refine"].is_null() {
            report.add("TS08", name, "root.refine", "ADD or REPLACE", "none");
        }
        above.push(name.to_owned());
        let context = Document { name, schema: &document["schema"], above };
        // explicit tiles, deep ones too, without recursion
        let mut stack: Vec<(&Value, String, From)> = vec![(&document["root"], "root".into(), from)];
        while let Some((value, label, from)) = stack.pop() {
            if self.tiles.len() >= MOST_TILES || from.depth > DEEPEST {
                report.add("TS16", name, label, format!("at most {MOST_TILES} tiles and {DEEPEST} levels"), "more");
                return;
            }
            let below = self.tile(&context, value, &label, from, report);
            let children = value["children"].as_array().map_or(&[][..], Vec::as_slice);
            for (k, child) in children.iter().enumerate().rev() {
                stack.push((child, format!("{label}.children[{k}]"), below));
            }
        }
    }

    /// Takes a tile; gives what its children need.
    fn tile(
        &mut self,
        document: &Document<'_>,
        value: &Value,
        label: &str,
        from: From,
        report: &mut ValidateReport,
    ) -> From {
        let place = format!("{} {label}", document.name);
        let transform = transform(&value["transform"]).unwrap_or_else(|found| {
            report.add("TS11", &place, "transform", "16 numbers: rotation, even scale, place", found);
            DMat4::IDENTITY
        });
        let world_from_tile = from.world_from_parent * transform;
        let error_m = match value["geometricError"].as_f64() {
            Some(error) if error >= 0.0 => error,
            Some(error) => {
                report.add("TS04", &place, "geometricError", "a number, not negative", error.to_string());
                0.0
            }
            None => {
                report.add("TS02", &place, "geometricError", "a number", value["geometricError"].to_string());
                from.error_m.min(0.0)
            }
        };
        if error_m > from.error_m {
            let expected = format!("at most its parent's {}", from.error_m);
            report.add("TS05", &place, "geometricError", expected, error_m.to_string());
        }
        let is_added = match &value["refine"] {
            Value::Null => from.is_added,
            v if v == "ADD" || v == "REPLACE" => v == "ADD",
            other => {
                report.add("TS08", &place, "refine", "ADD or REPLACE", other.to_string());
                false
            }
        };
        let volume = if value["boundingVolume"].is_object() {
            let volume = Volume::of(&value["boundingVolume"]);
            volume.map_err(|found| report.add("TS14", &place, "boundingVolume", "a region, box or sphere", found)).ok()
        } else {
            report.add("TS02", &place, "boundingVolume", "a region, box or sphere", "none");
            None
        };
        let is_implicit =
            value["implicitTiling"].is_object() || value["extensions"]["3DTILES_implicit_tiling"].is_object();
        let children = value["children"].as_array().is_some_and(|c| !c.is_empty());
        let number = self.push(Tile {
            parent: from.parent,
            depth: from.depth,
            name: place,
            world_from_tile,
            volume: volume.map(|v| v.moved(&world_from_tile)),
            error_m,
            is_added,
            contents: Vec::new(),
            has_children: children,
        });
        let below =
            From { parent: Some(number), depth: from.depth + 1, world_from_parent: world_from_tile, error_m, is_added };
        if is_implicit {
            // the pattern stands for its root, too, which takes this tile's place
            implicit::expand(self, document, value, number, report);
            return below;
        }
        for content in contents(value) {
            self.content(document, number, content, below, report);
        }
        below
    }

    pub(super) fn push(&mut self, tile: Tile) -> usize {
        if let Some(parent) = tile.parent.and_then(|p| self.tiles.get_mut(p)) {
            parent.has_children = true;
        }
        self.tiles.push(tile);
        self.tiles.len() - 1
    }

    fn content(
        &mut self,
        document: &Document<'_>,
        tile: usize,
        content: &Value,
        below: From,
        report: &mut ValidateReport,
    ) {
        let place = self.tiles[tile].name.clone();
        // 1.0 pre-releases said url
        let Some(uri) = content["uri"].as_str().or(content["url"].as_str()) else {
            report.add("TS02", &place, "content.uri", "a text", content["uri"].to_string());
            return;
        };
        let Some(name) = beside(document.name, uri) else {
            report.add("TS16", &place, "content.uri", "a file of the tileset", uri);
            return;
        };
        self.named.insert(name.clone());
        if !self.container.has(&name) {
            report.add("TS09", &place, "content.uri", format!("{name} to be there"), "no such file");
            return;
        }
        if !name.ends_with(".json") {
            self.tiles[tile].contents.push(name);
            return;
        }
        let bytes = self.container.read(&name).ok().flatten().unwrap_or_default();
        match unwrapped(&bytes, &mut Faults::default()) {
            Wrapped::Tileset if document.above.contains(&name) => {
                report.add("TS15", &place, "content.uri", "a tileset that does not include this one", name);
            }
            Wrapped::Tileset if document.above.len() as u32 > DEEPEST => {
                report.add("TS16", &place, "content.uri", format!("at most {DEEPEST} tilesets in each other"), "more");
            }
            _ => self.document(&name, &bytes, document.above.clone(), below, report),
        }
    }
}

/// The contents of a tile, one or several.
pub(super) fn contents(value: &Value) -> Vec<&Value> {
    if let Some(several) = value["contents"].as_array() {
        return several.iter().collect();
    }
    let extension = &value["extensions"]["3DTILES_multiple_contents"];
    if let Some(several) = extension["contents"].as_array().or(extension["content"].as_array()) {
        return several.iter().collect();
    }
    Some(&value["content"]).filter(|c| c.is_object()).into_iter().collect()
}

/// A tile's transform: rotation, even scale and place.
fn transform(value: &Value) -> Result<DMat4, String> {
    if value.is_null() {
        return Ok(DMat4::IDENTITY);
    }
    let numbers: Vec<f64> = value.as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
    let Ok(columns) = <[f64; 16]>::try_from(numbers) else { return Err(value.to_string()) };
    let matrix = DMat4::from_cols_array(&columns);
    let linear = DMat3::from_mat4(matrix);
    let bottom = [columns[3], columns[7], columns[11], columns[15]];
    let lengths = [linear.x_axis, linear.y_axis, linear.z_axis].map(|a| a.length());
    let sheared = [(0, 1), (0, 2), (1, 2)].iter().any(|&(a, b)| {
        let (p, q) = (linear.col(a), linear.col(b));
        p.dot(q).abs() > 1e-4 * p.length() * q.length()
    });
    let finite = columns.iter().all(|v| v.is_finite());
    if !finite || bottom != [0.0, 0.0, 0.0, 1.0] || sheared || lengths.contains(&0.0) || linear.determinant() < 0.0 {
        return Err(format!("{columns:?}"));
    }
    Ok(matrix)
}
