//! Reading glTF 2.0, text and binary: the triangles of the default scene, with the nodes' transforms, turned from y up
//! to z up; colours, texture coordinates and materials.
//!
//! Quantised attributes (`KHR_mesh_quantization`), packed ones (`EXT_meshopt_compression`, `KHR_meshopt_compression`)
//! and transformed texture coordinates (`KHR_texture_transform`) are read; what else a file requires is refused by name.

use super::gltf_buffers::Buffers;
use super::gltf_json::Document;
use super::gltf_materials::{self, Mapping, Materials};
use super::origin::Origin;
use super::srgb;
use crate::IoError;
use glam::{DMat3, DMat4, DVec3};
use std::collections::HashMap;
use yamanami_core::{Material, TriangleMesh};

/// Reads a document that is text.
pub(super) fn read_text(origin: &mut Origin<'_>, bytes: &[u8]) -> Result<TriangleMesh, IoError> {
    read_document(origin, "JSON", bytes, None)
}

/// Reads a binary document.
pub(super) fn read_binary(origin: &mut Origin<'_>, bytes: &[u8]) -> Result<TriangleMesh, IoError> {
    let (json, binary) = chunks(origin, bytes)?;
    read_document(origin, "JSON chunk", json, Some(binary))
}

fn read_document(
    origin: &mut Origin<'_>,
    place: &str,
    json: &[u8],
    binary: Option<&[u8]>,
) -> Result<TriangleMesh, IoError> {
    let document: Document =
        serde_json::from_slice(json).map_err(|e| origin.bad(place, "a glTF document", e.to_string()))?;
    if let Some(extension) = document.extensions_required.iter().find(|e| !is_read_or_harmless(e)) {
        let what = format!("the glTF extension {extension} that this file requires");
        return Err(IoError::unsupported(origin.name, what, "export it without that extension"));
    }
    for extension in document.extensions_used.iter().filter(|e| e.as_str() == "EXT_mesh_gpu_instancing") {
        origin.note(format!("the glTF extension {extension} is not read: each part stands once"));
    }
    let buffers = Buffers::new(origin, &document, binary);
    let mut scene = SceneReader {
        origin,
        buffers,
        document: &document,
        materials: Materials::default(),
        mesh: TriangleMesh::default(),
        parts: 0,
    };
    scene.walk()?;
    Ok(scene.finish())
}

/// Extensions that do not touch the triangles, or that are read.
fn is_read_or_harmless(extension: &str) -> bool {
    let read = ["KHR_mesh_quantization", "EXT_meshopt_compression", "KHR_meshopt_compression"];
    let harmless = ["KHR_materials_", "KHR_lights_", "EXT_lights_", "KHR_animation_", "KHR_xmp"];
    read.contains(&extension)
        || extension.contains("_texture_")
        || harmless.iter().any(|start| extension.starts_with(start))
}

/// The JSON and the binary chunk (which may be missing).
fn chunks<'b>(origin: &Origin<'_>, bytes: &'b [u8]) -> Result<(&'b [u8], &'b [u8]), IoError> {
    let word = |at: usize| bytes.get(at..at + 4).map(|w| u32::from_le_bytes([w[0], w[1], w[2], w[3]]));
    if bytes.get(..4) != Some(b"glTF") {
        return Err(origin.bad("start", "'glTF'", "something else"));
    }
    if word(4) != Some(2) {
        return Err(origin.bad("header", "glTF version 2", word(4).map_or("end of file".into(), |v| v.to_string())));
    }
    let chunk = |at: usize, kind: &[u8; 4]| -> Option<&'b [u8]> {
        let length = word(at)? as usize;
        (bytes.get(at + 4..at + 8) == Some(kind)).then_some(())?;
        bytes.get(at + 8..(at + 8).checked_add(length)?)
    };
    let json = chunk(12, b"JSON").ok_or_else(|| origin.bad("first chunk", "a whole JSON chunk", "none"))?;
    let next = 20 + json.len().next_multiple_of(4);
    if bytes.len() <= next {
        return Ok((json, &[]));
    }
    let binary = chunk(next, b"BIN\0").ok_or_else(|| {
        let stated = word(next).unwrap_or(0);
        let expected = format!("a BIN chunk of {stated} bytes");
        origin.bad("second chunk", expected, format!("{} bytes", bytes.len() - next))
    })?;
    Ok((json, binary))
}

/// Most primitives of all nodes; a few nodes may share a mesh of very many.
const PARTS_LIMIT: usize = 1 << 24;

struct SceneReader<'r, 'o, 'd> {
    origin: &'r mut Origin<'o>,
    buffers: Buffers<'d>,
    document: &'d Document,
    materials: Materials,
    mesh: TriangleMesh,
    parts: usize,
}

impl SceneReader<'_, '_, '_> {
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
                return Err(self.origin.bad("scene", expected, number.to_string()));
            };
            if std::mem::replace(&mut seen[number], true) {
                return Err(self.origin.bad(format!("node {number}"), "one parent", "several, or itself"));
            }
            let world_from_node = world_from_parent * node.parent_from_node();
            if node.skin.is_some() {
                self.origin.note("skins are not applied: the model stands in its bind pose");
            }
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
            return Err(self.origin.bad("nodes", expected, number.to_string()));
        };
        self.parts = self.parts.saturating_add(mesh.primitives.len());
        if self.parts > PARTS_LIMIT {
            return Err(IoError::too_large(self.origin.name, "parts", self.parts as u64, PARTS_LIMIT as u64));
        }
        // primitives of a mesh may share their vertices: first one and number by what they are made of
        let mut known = HashMap::new();
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let mode = primitive.mode.unwrap_or(4);
            let place = format!("mesh {number}, primitive {p}");
            let attribute = |name: &str| primitive.attributes.get(name).copied();
            let Some(positions) = attribute("POSITION") else { continue };
            if !(4..=6).contains(&mode) {
                self.origin.note("points and lines are not read, only triangles");
                continue;
            }
            if primitive.targets.is_some() {
                self.origin.note("morph targets are not applied");
            }
            let mapping = gltf_materials::mapping(document, primitive.material);
            let texcoords = attribute(&format!("TEXCOORD_{}", mapping.set));
            let accessors = [Some(positions), attribute("NORMAL"), attribute("COLOR_0"), texcoords];
            let key = (accessors, mapping.transform.map(|t| t.bits()));
            let (first, count) = match known.get(&key) {
                Some(&read) => read,
                None => {
                    let read = self.vertices(&place, accessors, mapping, world_from_node)?;
                    known.insert(key, read);
                    read
                }
            };
            let material = self.materials.number(self.origin, document, &mut self.buffers, primitive.material)?;
            let corners = match primitive.indices {
                Some(indices) => self.buffers.indices(self.origin, &place, indices, count)?,
                None => {
                    self.buffers.spend(self.origin, count)?;
                    (0..count as u32).collect()
                }
            };
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
            self.mesh.material_of.resize(self.mesh.triangles.len(), material);
        }
        Ok(())
    }

    /// Appends transformed vertices (places, normals, colours, texture coordinates by accessor); gives the first one's
    /// number and how many there are.
    fn vertices(
        &mut self,
        place: &str,
        [positions, normals, colours, texcoords]: [Option<usize>; 4],
        mapping: Mapping,
        world_from_node: DMat4,
    ) -> Result<(u32, usize), IoError> {
        let before = self.mesh.positions.len();
        let values = self.buffers.values(self.origin, place, positions.unwrap_or_default(), 3)?;
        let count = values.len() / 3;
        let first = u32::try_from(before)
            .ok()
            .filter(|f| u32::try_from(count).is_ok_and(|n| f.checked_add(n).is_some()))
            .ok_or_else(|| {
                IoError::too_large(self.origin.name, "vertices", (before + count) as u64, u32::MAX.into())
            })?;
        let points = values.chunks_exact(3).map(|p| world_from_node.transform_point3(DVec3::new(p[0], p[1], p[2])));
        self.mesh.positions.extend(points);
        let after = self.mesh.positions.len();
        if let Some(normals) = normals {
            let values = self.buffers.values(self.origin, place, normals, 3)?;
            // the cofactors keep normals upright under uneven scales; mirrors are undone by the sign
            let m = DMat3::from_mat4(world_from_node);
            let cofactors =
                DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis))
                    * m.determinant().signum();
            let turned = values.chunks_exact(3).map(|n| {
                let n = cofactors * DVec3::new(n[0], n[1], n[2]);
                n.normalize_or_zero().as_vec3().to_array()
            });
            self.mesh.normals.extend(turned.take(count));
        }
        // where only some primitives have normals, the numbers differ and all are dropped in the end
        if let Some(colours) = colours {
            let width = self.buffers.width(colours).clamp(3, 4);
            let values = self.buffers.values(self.origin, place, colours, width)?;
            self.mesh.colours.resize(before, [255; 4]);
            let bytes = values.chunks_exact(width).map(|c| {
                let [r, g, b] = [c[0], c[1], c[2]].map(srgb::byte_of_linear);
                [r, g, b, c.get(3).map_or(255, |&a| (a * 255.0).round() as u8)]
            });
            self.mesh.colours.extend(bytes.take(count));
        }
        if !self.mesh.colours.is_empty() {
            self.mesh.colours.resize(after, [255; 4]);
        }
        if let Some(texcoords) = texcoords {
            let values = self.buffers.values(self.origin, place, texcoords, 2)?;
            self.mesh.texcoords.resize(before, [0.0; 2]);
            let mapped = values.chunks_exact(2).map(|t| {
                let t = [t[0], t[1]];
                mapping.transform.map_or(t, |transform| transform.apply(t)).map(|c| c as f32)
            });
            self.mesh.texcoords.extend(mapped.take(count));
        }
        if !self.mesh.texcoords.is_empty() {
            self.mesh.texcoords.resize(after, [0.0; 2]);
        }
        Ok((first, count))
    }

    fn finish(self) -> TriangleMesh {
        let mut mesh = self.mesh;
        for p in &mut mesh.positions {
            *p = DVec3::new(p.x, -p.z, p.y);
        }
        for n in &mut mesh.normals {
            *n = [n[0], -n[2], n[1]];
        }
        mesh.materials = self.materials.list;
        if mesh.materials.iter().all(|m| *m == Material::default()) {
            mesh.materials.clear();
        }
        if mesh.materials.len() < 2 {
            mesh.material_of = Vec::new();
        }
        mesh
    }
}
