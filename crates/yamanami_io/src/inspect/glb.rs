//! A binary glTF, for judging: its chunks, what it says it needs, and the document.
//!
//! Based on: Khronos Group, "glTF 2.0 Specification", 2021.

use super::glb_geometry::{GlbMesh, geometry};
use super::{Bytes, Faults};
use serde_json::Value;

/// Extensions that a viewer of 3D Tiles may be asked for, and that change nothing that is judged here or are read.
const KNOWN: [&str; 8] = [
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "KHR_texture_basisu",
    "EXT_texture_webp",
    "EXT_mesh_features",
    "EXT_structural_metadata",
];

/// What a binary glTF holds.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Glb {
    /// The triangles of its scene.
    pub mesh: GlbMesh,
    /// The file could be read so far that the mesh is what a viewer shows.
    pub is_whole: bool,
}

/// Reads a binary glTF as far as it goes.
pub fn glb(bytes: &[u8], faults: &mut Faults) -> Glb {
    let Some((json, binary)) = chunks(bytes, faults) else { return Glb::default() };
    let document: Value = match serde_json::from_slice(json) {
        Ok(document) => document,
        Err(cause) => {
            faults.add("GL02", "JSON chunk", "a JSON object", cause.to_string());
            return Glb::default();
        }
    };
    if document["asset"]["version"] != "2.0" {
        faults.add("GL02", "asset.version", "2.0", document["asset"]["version"].to_string());
    }
    if let Some(length) = document["buffers"][0]["byteLength"].as_u64().filter(|&n| n > binary.len() as u64)
        && document["buffers"][0]["uri"].is_null()
    {
        faults.add("GL01", "binary chunk", format!("{length} bytes, as buffer 0 says"), binary.len().to_string());
    }
    let can_be_read = extensions(&document, faults);
    if !can_be_read {
        return Glb::default();
    }
    let (mesh, is_whole) = geometry(&document, binary, faults);
    Glb { mesh, is_whole }
}

fn chunks<'b>(bytes: &'b [u8], faults: &mut Faults) -> Option<(&'b [u8], &'b [u8])> {
    let mut reader = Bytes::new(bytes);
    let header = (|| Some((reader.array::<4>()?, reader.u32()?, reader.u32()?)))();
    let Some((magic, version, length)) = header else {
        faults.add("GL01", "header", "12 bytes", format!("{} bytes", bytes.len()));
        return None;
    };
    if magic != *b"glTF" || version != 2 {
        faults.add("GL01", "header", "'glTF' version 2", format!("{magic:?} version {version}"));
        return None;
    }
    if length as usize != bytes.len() {
        faults.add("GL01", "header", format!("a length of {} bytes", bytes.len()), length.to_string());
    }
    let (mut json, mut binary) = (None, &[][..]);
    while reader.left() >= 8 {
        let at = reader.at;
        let (Some(size), Some(kind)) = (reader.u32(), reader.array::<4>()) else { break };
        if size % 4 != 0 {
            faults.add("GL01", format!("chunk at byte {at}"), "a length that is a multiple of 4", size.to_string());
        }
        let Some(content) = reader.take(size as usize) else {
            let found = format!("{} bytes left", reader.left());
            faults.add("GL01", format!("chunk at byte {at}"), format!("{size} bytes"), found);
            break;
        };
        match &kind {
            b"JSON" if json.is_none() && at == 12 => json = Some(content),
            b"BIN\0" => binary = content,
            _ => {}
        }
    }
    if json.is_none() {
        faults.add("GL01", "first chunk", "a whole JSON chunk", "none");
    }
    json.map(|json| (json, binary))
}

/// What is used is declared, what is required is used; whether the triangles can be read.
fn extensions(document: &Value, faults: &mut Faults) -> bool {
    let list = |name: &str| -> Vec<&str> {
        document[name].as_array().into_iter().flatten().filter_map(Value::as_str).collect()
    };
    let (used, required) = (list("extensionsUsed"), list("extensionsRequired"));
    for extension in &required {
        if !used.contains(extension) {
            faults.add("GL07", "extensionsRequired", format!("{extension} in extensionsUsed, too"), "not there");
        }
    }
    let mut found = Vec::new();
    names(document, &mut found, 0);
    for name in found {
        if !used.contains(&name) {
            faults.add("GL07", "extensionsUsed", format!("{name}, which is used"), "not there");
        }
    }
    let unknown = required.iter().find(|e| !KNOWN.contains(e) && !e.starts_with("KHR_materials_"));
    if let Some(unknown) = unknown {
        faults.add("GL12", "extensionsRequired", "extensions that are looked into", *unknown);
    }
    unknown.is_none()
}

/// Names of all extensions in use.
fn names<'v>(value: &'v Value, found: &mut Vec<&'v str>, depth: usize) {
    // the parser nests no deeper than 128
    if depth > 128 {
        return;
    }
    match value {
        Value::Array(list) => list.iter().for_each(|v| names(v, found, depth + 1)),
        Value::Object(map) => {
            for (key, v) in map {
                if let ("extensions", Value::Object(own)) = (key.as_str(), v) {
                    for name in own.keys() {
                        if !found.contains(&name.as_str()) {
                            found.push(name);
                        }
                    }
                }
                names(v, found, depth + 1);
            }
        }
        _ => {}
    }
}
