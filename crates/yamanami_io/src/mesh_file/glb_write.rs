//! Writing binary glTF 2.0: one mesh, one node, a primitive for each material. glTF is y up and in single precision, so
//! positions are turned and made relative to an origin in whole metres, which the node's translation adds again. Colours
//! are linear there, in sixteen bits, which the eight of sRGB come back from.

use super::gltf_materials::picture_kind;
use super::srgb;
use super::{MeshMeta, one_line};
use crate::IoError;
use glam::{DVec3, Vec3};
use serde_json::{Value, json};
use std::io::{Result, Write};
use std::path::Path;
use std::sync::Arc;
use yamanami_core::TriangleMesh;

/// Room for the JSON beside the buffer; real ones take a few hundred bytes and the texts.
const JSON_ROOM: u64 = 1 << 24;
const FLOAT: u32 = 5126;
const WORD: u32 = 5123;
const INDEX: u32 = 5125;

/// Refuses a mesh whose file would pass the format's 4 GiB.
pub(super) fn check_size(path: &Path, mesh: &TriangleMesh) -> std::result::Result<(), IoError> {
    let vectors = mesh.positions.len() + mesh.normals.len() + mesh.triangles.len();
    let pictures: usize = mesh.materials.iter().flat_map(|m| &m.texture).map(|t| t.bytes.len()).sum();
    let given = (12 * vectors + 8 * (mesh.texcoords.len() + mesh.colours.len()) + pictures) as u64;
    let limit = u64::from(u32::MAX) - JSON_ROOM;
    if given > limit {
        return Err(IoError::too_large(path, "bytes of a GLB", given, limit));
    }
    Ok(())
}

/// All that comes before the bytes of the buffer: a document and the length of what follows, if anything.
pub(crate) fn glb_head(mut text: String, buffer: usize) -> Vec<u8> {
    while !text.len().is_multiple_of(4) {
        text.push(' ');
    }
    let mut head = b"glTF".to_vec();
    let chunk = if buffer > 0 { 8 + buffer } else { 0 };
    for word in [2, 12 + 8 + text.len() + chunk, text.len()] {
        head.extend((word as u32).to_le_bytes());
    }
    head.extend(b"JSON");
    head.extend(text.into_bytes());
    if buffer > 0 {
        head.extend((buffer as u32).to_le_bytes());
        head.extend(b"BIN\0");
    }
    head
}

/// Turns z up into y up.
fn y_up<T>([x, y, z]: [T; 3]) -> [T; 3]
where
    T: std::ops::Neg<Output = T>,
{
    [x, z, -y]
}

/// The parts of the buffer so far, and the accessors on them.
#[derive(Default)]
struct Layout {
    length: usize,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Layout {
    /// A view of so many bytes at the end; every view starts at a multiple of four.
    fn view(&mut self, bytes: usize, target: Option<u32>) -> usize {
        let mut view = json!({"buffer": 0, "byteOffset": self.length, "byteLength": bytes});
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.views.push(view);
        self.length += bytes.next_multiple_of(4);
        self.views.len() - 1
    }

    fn accessor(&mut self, view: usize, component: u32, count: usize, shape: &str) -> usize {
        self.accessors.push(json!({"bufferView": view, "componentType": component, "count": count, "type": shape}));
        self.accessors.len() - 1
    }

    /// An attribute of all vertices.
    fn attribute(&mut self, component: u32, count: usize, shape: &str, bytes_each: usize) -> usize {
        let view = self.view(count * bytes_each, Some(34962));
        self.accessor(view, component, count, shape)
    }
}

/// Triangles by material: numbers in that order, and each material's share.
fn by_material(mesh: &TriangleMesh) -> (Vec<u32>, Vec<(usize, usize)>) {
    let mut counts = vec![0usize; mesh.materials.len().max(1)];
    for t in 0..mesh.triangles.len() {
        counts[mesh.material(t)] += 1;
    }
    let shares = counts.iter().copied().enumerate().filter(|&(_, n)| n > 0).collect::<Vec<_>>();
    if shares.len() < 2 {
        return (Vec::new(), shares);
    }
    let mut order: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
    order.sort_by_key(|&t| mesh.material(t as usize));
    (order, shares)
}

pub(super) fn write(out: &mut dyn Write, mesh: &TriangleMesh, meta: &MeshMeta) -> Result<()> {
    let origin = mesh.bounds().centre().round();
    let local = |p: DVec3| Vec3::from(y_up((p - origin).as_vec3().to_array()));
    let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for &p in &mesh.positions {
        (min, max) = (min.min(local(p)), max.max(local(p)));
    }
    let vertices = mesh.positions.len();
    let mut layout = Layout::default();
    let positions = layout.attribute(FLOAT, vertices, "VEC3", 12);
    layout.accessors[positions]["min"] = json!(min.to_array());
    layout.accessors[positions]["max"] = json!(max.to_array());
    let mut attributes = json!({"POSITION": positions});
    if !mesh.normals.is_empty() {
        attributes["NORMAL"] = json!(layout.attribute(FLOAT, vertices, "VEC3", 12));
    }
    if !mesh.texcoords.is_empty() {
        attributes["TEXCOORD_0"] = json!(layout.attribute(FLOAT, vertices, "VEC2", 8));
    }
    if !mesh.colours.is_empty() {
        let colours = layout.attribute(WORD, vertices, "VEC4", 8);
        layout.accessors[colours]["normalized"] = json!(true);
        attributes["COLOR_0"] = json!(colours);
    }
    let (order, shares) = by_material(mesh);
    let indices = layout.view(12 * mesh.triangles.len(), Some(34963));
    let mut primitives = Vec::new();
    let mut before = 0;
    for &(material, triangles) in &shares {
        let accessor = layout.accessor(indices, INDEX, 3 * triangles, "SCALAR");
        layout.accessors[accessor]["byteOffset"] = json!(12 * before);
        before += triangles;
        primitives.push(json!({"attributes": attributes, "indices": accessor, "material": material, "mode": 4}));
    }
    let painted = Painted::of(mesh, &mut layout);

    let title = one_line(&meta.title);
    let mut document = json!({
        "asset": {"version": "2.0", "generator": "yamanami"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{
            "name": if title.is_empty() { "surface" } else { &title },
            "mesh": 0,
            "translation": y_up(origin.to_array()).map(|c| c + 0.0),
            "extras": {"crs": meta.crs, "note": meta.note, "origin_z_up_m": origin.to_array()},
        }],
        "meshes": [{"primitives": primitives}],
        "materials": painted.materials,
        "accessors": layout.accessors,
        "bufferViews": layout.views,
        "buffers": [{"byteLength": layout.length}],
    });
    if !painted.pictures.is_empty() {
        document["images"] = json!(painted.images);
        document["textures"] = json!((0..painted.pictures.len()).map(|k| json!({"source": k})).collect::<Vec<_>>());
    }
    let text = document.to_string();
    u32::try_from(text.len() + layout.length + 64)
        .map_err(|_| std::io::Error::other("a GLB file holds less than 4 GiB"))?;
    out.write_all(&glb_head(text, layout.length))?;
    let positions = mesh.positions.iter().map(|&p| local(p).to_array());
    for vector in positions.chain(mesh.normals.iter().map(|&n| y_up(n))) {
        floats(out, &vector)?;
    }
    for texcoord in &mesh.texcoords {
        floats(out, texcoord)?;
    }
    let linear: Vec<u16> = (0..=255).map(srgb::linear_word_of_byte).collect();
    for &[r, g, b, a] in &mesh.colours {
        let words = [linear[usize::from(r)], linear[usize::from(g)], linear[usize::from(b)], u16::from(a) * 257];
        for word in words {
            out.write_all(&word.to_le_bytes())?;
        }
    }
    for k in 0..mesh.triangles.len() {
        let t = order.get(k).map_or(k, |&t| t as usize);
        let [a, b, c] = mesh.triangles[t].map(u32::to_le_bytes);
        out.write_all(&[a, b, c].concat())?;
    }
    for bytes in &painted.pictures {
        out.write_all(bytes)?;
        out.write_all(&[0; 3][..bytes.len().next_multiple_of(4) - bytes.len()])?;
    }
    Ok(())
}

fn floats(out: &mut dyn Write, values: &[f32]) -> Result<()> {
    for value in values {
        out.write_all(&value.to_le_bytes())?;
    }
    Ok(())
}

/// Materials with their pictures, each picture once.
#[derive(Default)]
struct Painted {
    materials: Vec<Value>,
    images: Vec<Value>,
    pictures: Vec<Arc<[u8]>>,
}

impl Painted {
    fn of(mesh: &TriangleMesh, layout: &mut Layout) -> Self {
        let mut painted = Self::default();
        for material in &mesh.materials {
            let [r, g, b, alpha] = material.base_colour;
            let mut pbr = json!({"baseColorFactor": [r, g, b, alpha], "metallicFactor": 0.0, "roughnessFactor": 1.0});
            // what is neither PNG nor JPEG has no place in the format
            if let Some(texture) = &material.texture
                && let Some((_, kind)) = picture_kind(&texture.bytes)
            {
                let same = |p: &Arc<[u8]>| Arc::ptr_eq(p, &texture.bytes) || *p == texture.bytes;
                let number = painted.pictures.iter().position(same).unwrap_or_else(|| {
                    let view = layout.view(texture.bytes.len(), None);
                    painted.images.push(json!({"bufferView": view, "mimeType": kind, "name": texture.name}));
                    painted.pictures.push(texture.bytes.clone());
                    painted.pictures.len() - 1
                });
                pbr["baseColorTexture"] = json!({"index": number});
            }
            let mut entry = json!({"doubleSided": true, "pbrMetallicRoughness": pbr});
            if !material.name.is_empty() {
                entry["name"] = json!(one_line(&material.name));
            }
            if alpha < 1.0 {
                entry["alphaMode"] = json!("BLEND");
            }
            painted.materials.push(entry);
        }
        if painted.materials.is_empty() {
            // the format's own default would be a mirror; colours of vertices stay as they are
            let shade = if mesh.colours.is_empty() { [0.72, 0.70, 0.66, 1.0] } else { [1.0; 4] };
            painted.materials.push(json!({
                "doubleSided": true,
                "pbrMetallicRoughness": {"baseColorFactor": shade, "metallicFactor": 0.0, "roughnessFactor": 1.0},
            }));
        }
        painted
    }
}
