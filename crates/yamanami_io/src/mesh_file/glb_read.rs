//! Reading binary glTF 2.0: the triangles of the default scene, with the nodes' transforms, turned from y up to z up.
//!
//! Quantised positions (`KHR_mesh_quantization`) are read; compressed ones are refused by name. Buffers outside the file
//! are not followed.

use crate::IoError;
use glam::{DMat4, DQuat, DVec3};
use serde::Deserialize;
use std::collections::HashMap;
use std::path::Path;
use yamanami_core::TriangleMesh;

/// Instances and shared buffers let a small file name a huge mesh: most vertices and corners per byte of file.
const ITEMS_PER_BYTE: usize = 64;

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Document {
    scene: Option<usize>,
    #[serde(default)]
    scenes: Vec<Scene>,
    #[serde(default)]
    nodes: Vec<Node>,
    #[serde(default)]
    meshes: Vec<Mesh>,
    #[serde(default)]
    accessors: Vec<Accessor>,
    #[serde(default)]
    buffer_views: Vec<BufferView>,
    #[serde(default)]
    buffers: Vec<Buffer>,
    #[serde(default)]
    extensions_required: Vec<String>,
}

#[derive(Deserialize)]
struct Scene {
    #[serde(default)]
    nodes: Vec<usize>,
}

#[derive(Deserialize)]
struct Node {
    mesh: Option<usize>,
    #[serde(default)]
    children: Vec<usize>,
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

impl Node {
    fn parent_from_node(&self) -> DMat4 {
        match &self.matrix {
            Some(columns) => DMat4::from_cols_array(columns),
            None => DMat4::from_scale_rotation_translation(
                self.scale.map_or(DVec3::ONE, DVec3::from),
                self.rotation.map_or(DQuat::IDENTITY, DQuat::from_array),
                self.translation.map_or(DVec3::ZERO, DVec3::from),
            ),
        }
    }
}

#[derive(Deserialize)]
struct Mesh {
    #[serde(default)]
    primitives: Vec<Primitive>,
}

#[derive(Deserialize)]
struct Primitive {
    attributes: HashMap<String, usize>,
    indices: Option<usize>,
    mode: Option<u32>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Accessor {
    buffer_view: Option<usize>,
    #[serde(default)]
    byte_offset: usize,
    component_type: u32,
    count: usize,
    #[serde(rename = "type")]
    shape: String,
    #[serde(default)]
    normalized: bool,
    sparse: Option<serde::de::IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct BufferView {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: Option<usize>,
}

#[derive(Deserialize)]
struct Buffer {
    uri: Option<serde::de::IgnoredAny>,
}

pub(super) fn read(name: &Path, bytes: &[u8]) -> Result<TriangleMesh, IoError> {
    let (json, binary) = chunks(name, bytes)?;
    let document: Document = serde_json::from_slice(json)
        .map_err(|e| IoError::malformed(name, "JSON chunk", "a glTF document", e.to_string()))?;
    if let Some(extension) = document.extensions_required.iter().find(|e| !is_harmless(e)) {
        let what = format!("the glTF extension {extension} that this file requires");
        return Err(IoError::unsupported(name, what, "export it as plain glTF, without compression"));
    }
    let mut scene = SceneReader {
        name,
        binary,
        document: &document,
        mesh: TriangleMesh::default(),
        items_left: bytes.len().saturating_mul(ITEMS_PER_BYTE),
    };
    scene.walk()?;
    let mut mesh = scene.mesh;
    for p in &mut mesh.positions {
        *p = DVec3::new(p.x, -p.z, p.y);
    }
    for n in &mut mesh.normals {
        *n = [n[0], -n[2], n[1]];
    }
    Ok(mesh)
}

/// Extensions that do not touch the triangles, or that are read.
fn is_harmless(extension: &str) -> bool {
    extension == "KHR_mesh_quantization" || extension.starts_with("KHR_materials_") || extension.contains("_texture_")
}

/// The JSON and the binary chunk (which may be missing).
fn chunks<'a>(name: &Path, bytes: &'a [u8]) -> Result<(&'a [u8], &'a [u8]), IoError> {
    let bad = |place: &str, expected: &str, found: String| IoError::malformed(name, place, expected, found);
    let word = |at: usize| bytes.get(at..at + 4).map(|w| u32::from_le_bytes([w[0], w[1], w[2], w[3]]));
    if bytes.get(..4) != Some(b"glTF") {
        return Err(bad("start", "'glTF'", "something else".into()));
    }
    if word(4) != Some(2) {
        return Err(bad("header", "glTF version 2", word(4).map_or("end of file".into(), |v| v.to_string())));
    }
    let chunk = |at: usize, kind: &[u8; 4]| -> Option<&'a [u8]> {
        let length = word(at)? as usize;
        (bytes.get(at + 4..at + 8) == Some(kind)).then_some(())?;
        bytes.get(at + 8..(at + 8).checked_add(length)?)
    };
    let json = chunk(12, b"JSON").ok_or_else(|| bad("first chunk", "a whole JSON chunk", "none".into()))?;
    let next = 20 + json.len().next_multiple_of(4);
    if bytes.len() <= next {
        return Ok((json, &[]));
    }
    let binary = chunk(next, b"BIN\0").ok_or_else(|| {
        let stated = word(next).unwrap_or(0);
        bad("second chunk", &format!("a BIN chunk of {stated} bytes"), format!("{} bytes", bytes.len() - next))
    })?;
    Ok((json, binary))
}

struct SceneReader<'a> {
    name: &'a Path,
    binary: &'a [u8],
    document: &'a Document,
    mesh: TriangleMesh,
    items_left: usize,
}

impl SceneReader<'_> {
    fn bad(&self, place: String, expected: impl Into<String>, found: impl Into<String>) -> IoError {
        IoError::malformed(self.name, place, expected, found)
    }

    /// Visits the nodes of the scene, parents before children.
    fn walk(&mut self) -> Result<(), IoError> {
        let document = self.document;
        let mut is_child = vec![false; document.nodes.len()];
        for &child in document.nodes.iter().flat_map(|n| &n.children) {
            if let Some(is_child) = is_child.get_mut(child) {
                *is_child = true;
            }
        }
        let roots: Vec<usize> = match document.scenes.get(document.scene.unwrap_or(0)) {
            Some(scene) => scene.nodes.clone(),
            None => (0..document.nodes.len()).filter(|&n| !is_child[n]).collect(),
        };
        let mut seen = vec![false; document.nodes.len()];
        let mut stack: Vec<(usize, DMat4)> = roots.into_iter().rev().map(|n| (n, DMat4::IDENTITY)).collect();
        while let Some((number, world_from_parent)) = stack.pop() {
            let Some(node) = document.nodes.get(number) else {
                let expected = format!("a node below {}", document.nodes.len());
                return Err(self.bad("scene".into(), expected, number.to_string()));
            };
            if std::mem::replace(&mut seen[number], true) {
                return Err(self.bad(format!("node {number}"), "one parent", "several, or itself"));
            }
            let world_from_node = world_from_parent * node.parent_from_node();
            if let Some(mesh) = node.mesh {
                self.instance(mesh, world_from_node)?;
            }
            stack.extend(node.children.iter().rev().map(|&child| (child, world_from_node)));
        }
        Ok(())
    }

    fn instance(&mut self, number: usize, world_from_node: DMat4) -> Result<(), IoError> {
        let document = self.document;
        let Some(mesh) = document.meshes.get(number) else {
            let expected = format!("a mesh below {}", document.meshes.len());
            return Err(self.bad("nodes".into(), expected, number.to_string()));
        };
        // primitives of a mesh may share their vertices
        let mut first_of = HashMap::new();
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let mode = primitive.mode.unwrap_or(4);
            if !(4..=6).contains(&mode) {
                continue;
            }
            let place = format!("mesh {number}, primitive {p}");
            let Some(&positions) = primitive.attributes.get("POSITION") else {
                continue;
            };
            let normals = primitive.attributes.get("NORMAL").copied();
            let (first, count) = match first_of.get(&(positions, normals)) {
                Some(&known) => known,
                None => {
                    let read = self.vertices(&place, positions, normals, world_from_node)?;
                    first_of.insert((positions, normals), read);
                    read
                }
            };
            let corners = self.corners(&place, primitive.indices, count)?;
            let mirrored = world_from_node.determinant() < 0.0;
            let mut push = |[a, b, c]: [u32; 3]| {
                let t = if mirrored { [a, c, b] } else { [a, b, c] };
                self.mesh.triangles.push(t.map(|i| first + i));
            };
            match mode {
                4 => corners.chunks_exact(3).for_each(|t| push([t[0], t[1], t[2]])),
                5 => {
                    for (k, t) in corners.windows(3).enumerate() {
                        push(if k % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] });
                    }
                }
                _ => corners.windows(2).skip(1).for_each(|t| push([corners[0], t[0], t[1]])),
            }
        }
        Ok(())
    }

    /// Appends transformed vertices; gives the first one's number and how many there are.
    fn vertices(
        &mut self,
        place: &str,
        positions: usize,
        normals: Option<usize>,
        world_from_node: DMat4,
    ) -> Result<(u32, usize), IoError> {
        let before = self.mesh.positions.len();
        let values = self.values(place, positions, 3)?;
        let count = values.len() / 3;
        let first = u32::try_from(before)
            .ok()
            .filter(|f| u32::try_from(count).is_ok_and(|n| f.checked_add(n).is_some()))
            .ok_or_else(|| IoError::too_large(self.name, "vertices", (before + count) as u64, u32::MAX.into()))?;
        let points = values.chunks_exact(3).map(|p| world_from_node.transform_point3(DVec3::new(p[0], p[1], p[2])));
        self.mesh.positions.extend(points);
        if let Some(normals) = normals {
            let values = self.values(place, normals, 3)?;
            // the cofactors keep normals upright under uneven scales; mirrors are undone by the sign
            let m = glam::DMat3::from_mat4(world_from_node);
            let cofactors =
                glam::DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis))
                    * m.determinant().signum();
            let turned = values.chunks_exact(3).map(|n| {
                let n = cofactors * DVec3::new(n[0], n[1], n[2]);
                n.normalize_or_zero().as_vec3().to_array()
            });
            self.mesh.normals.extend(turned.take(count));
        }
        // where only some primitives have normals, the numbers differ and all are dropped in the end
        Ok((first, count))
    }

    fn corners(&mut self, place: &str, indices: Option<usize>, vertices: usize) -> Result<Vec<u32>, IoError> {
        let Some(indices) = indices else {
            self.spend(vertices)?;
            return Ok((0..vertices as u32).collect());
        };
        let values = self.values(place, indices, 1)?;
        if let Some(k) = values.iter().position(|&v| !(v >= 0.0 && v < vertices as f64 && v.fract() == 0.0)) {
            let expected = format!("indices below {vertices}");
            return Err(self.bad(format!("{place}, corner {k}"), expected, values[k].to_string()));
        }
        Ok(values.iter().map(|&v| v as u32).collect())
    }

    fn spend(&mut self, items: usize) -> Result<(), IoError> {
        match self.items_left.checked_sub(items) {
            Some(left) => self.items_left = left,
            None => {
                let (given, limit) = (items as u64, self.items_left as u64);
                return Err(IoError::too_large(self.name, "vertices and corners of repeated parts", given, limit));
            }
        }
        Ok(())
    }

    /// All numbers of an accessor of scalars (`width` 1) or vectors.
    fn values(&mut self, place: &str, number: usize, width: usize) -> Result<Vec<f64>, IoError> {
        let document = self.document;
        let place = || format!("{place}, accessor {number}");
        let Some(accessor) = document.accessors.get(number) else {
            return Err(self.bad(place(), format!("an accessor below {}", document.accessors.len()), "none"));
        };
        let shape = if width == 1 { "SCALAR" } else { "VEC3" };
        if accessor.shape != shape {
            let given: String = accessor.shape.chars().take(20).collect();
            return Err(self.bad(place(), shape, given));
        }
        if accessor.sparse.is_some() {
            return Err(IoError::unsupported(self.name, place() + " is sparse", "export it without sparse accessors"));
        }
        let view = accessor.buffer_view.and_then(|v| document.buffer_views.get(v));
        let Some(view) = view else {
            return Err(self.bad(place(), "a buffer view", "none"));
        };
        if view.buffer != 0 || document.buffers.first().is_none_or(|b| b.uri.is_some()) {
            let what = place() + " lies outside the file";
            return Err(IoError::unsupported(self.name, what, "pack all buffers into the GLB"));
        }
        let Some(component) = Component::numbered(accessor.component_type) else {
            return Err(self.bad(place(), "a component type of 5120 to 5126", accessor.component_type.to_string()));
        };
        let size = component.size() * width;
        let stride = view.byte_stride.unwrap_or(size);
        self.spend(accessor.count)?;
        let part = || {
            let end = view.byte_offset.checked_add(view.byte_length)?;
            let part = self.binary.get(view.byte_offset..end)?.get(accessor.byte_offset..)?;
            let needed = match accessor.count {
                0 => 0,
                n => (n - 1).checked_mul(stride)?.checked_add(size)?,
            };
            (stride >= size).then(|| part.get(..needed))?
        };
        let Some(part) = part() else {
            let expected = format!("{} items every {stride} bytes inside the buffer", accessor.count);
            return Err(self.bad(place(), expected, format!("{} bytes of buffer", self.binary.len())));
        };
        let scale = component.largest();
        let mut values = Vec::with_capacity(accessor.count * width);
        for item in part.chunks(stride.max(1)) {
            for raw in item[..size].chunks_exact(component.size()) {
                let value = component.value(raw);
                // the least of a signed type stands for -1, as its neighbour does
                values.push(if accessor.normalized { (value / scale).max(-1.0) } else { value });
            }
        }
        Ok(values)
    }
}

/// Type of an accessor's numbers.
#[derive(Clone, Copy)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn numbered(number: u32) -> Option<Self> {
        Some(match number {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// What a normalised value of 1 is stored as.
    fn largest(self) -> f64 {
        match self {
            Self::I8 => i8::MAX.into(),
            Self::U8 => u8::MAX.into(),
            Self::I16 => i16::MAX.into(),
            Self::U16 => u16::MAX.into(),
            Self::U32 => u32::MAX.into(),
            Self::F32 => 1.0,
        }
    }

    fn value(self, raw: &[u8]) -> f64 {
        let mut bytes = [0u8; 4];
        bytes[..raw.len()].copy_from_slice(raw);
        let bits = u32::from_le_bytes(bytes);
        match self {
            Self::I8 => f64::from(bits as i8),
            Self::U8 => f64::from(bits as u8),
            Self::I16 => f64::from(bits as i16),
            Self::U16 => f64::from(bits as u16),
            Self::U32 => f64::from(bits),
            Self::F32 => f64::from(f32::from_bits(bits)),
        }
    }
}
