//! Reading Wavefront OBJ: vertices with and without colours, texture coordinates, normals, faces of any number of
//! corners, materials; all else is passed over.
//!
//! Corners with different texture coordinates become different vertices; corners that differ in their normals alone do
//! not, so that a scan stays in one piece: then the normals are dropped.

use super::mtl::Library;
use super::origin::Origin;
use super::polygon::Polygons;
use super::{ply_vertices, seams};
use crate::IoError;
use glam::DVec3;
use std::collections::HashMap;
use yamanami_core::{Material, TriangleMesh};

pub(super) fn read(origin: &mut Origin<'_>, bytes: &[u8]) -> Result<TriangleMesh, IoError> {
    let mut reader = Reader {
        origin,
        line: 0,
        mesh: TriangleMesh::default(),
        colours: Vec::new(),
        texcoords: Vec::new(),
        normals: Vec::new(),
        normal_of: Vec::new(),
        texcoord_of: Vec::new(),
        polygons: Polygons::default(),
        library: Library::default(),
        material_names: Vec::new(),
        known_materials: HashMap::new(),
        material: 0,
        corners: Vec::new(),
        corner_texcoords: Vec::new(),
    };
    let mut joined = Vec::new();
    for line in bytes.split(|&b| b == b'\n') {
        reader.line += 1;
        let line = line.trim_ascii();
        // a backslash carries a statement on to the next line
        if let Some(start) = line.strip_suffix(b"\\") {
            joined.extend_from_slice(start);
            joined.push(b' ');
        } else if joined.is_empty() {
            reader.statement(line)?;
        } else {
            joined.extend_from_slice(line);
            reader.statement(&joined)?;
            joined.clear();
        }
    }
    reader.statement(&joined)?;
    reader.finish()
}

/// Nothing named yet, and different ones.
const NONE: u32 = u32::MAX;
const SEVERAL: u32 = u32::MAX - 1;
/// Most materials.
const MATERIALS_LIMIT: usize = u16::MAX as usize;

struct Reader<'o, 'a> {
    origin: &'o mut Origin<'a>,
    line: usize,
    mesh: TriangleMesh,
    /// Colours up to the last vertex that has one.
    colours: Vec<[f32; 4]>,
    texcoords: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    /// For each vertex the normal that faces name beside it.
    normal_of: Vec<u32>,
    /// For each triangle's corners the texture coordinates, up to the last triangle that has any.
    texcoord_of: Vec<[u32; 3]>,
    polygons: Polygons,
    library: Library,
    material_names: Vec<String>,
    known_materials: HashMap<String, u16>,
    material: u16,
    /// Corners of the face being read: vertex and texture coordinate.
    corners: Vec<u32>,
    corner_texcoords: Vec<u32>,
}

impl Reader<'_, '_> {
    fn bad(&self, expected: &str, found: &[u8]) -> IoError {
        let found: String = String::from_utf8_lossy(found).chars().take(60).collect();
        self.origin.bad(format!("line {}", self.line), expected, format!("'{found}'"))
    }

    fn statement(&mut self, line: &[u8]) -> Result<(), IoError> {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty());
        match words.next() {
            Some(b"v") => self.vertex(words, line)?,
            Some(b"vt") => {
                let mut numbers = words.map_while(number);
                let Some(u) = numbers.next() else { return Err(self.bad("one to three numbers", line)) };
                let v = numbers.next().unwrap_or(0.0);
                self.texcoords.push([u as f32, (1.0 - v) as f32]);
                self.check_count("texture coordinates", self.texcoords.len())?;
            }
            Some(b"vn") => {
                let mut numbers = words.map_while(number);
                let (Some(x), Some(y), Some(z)) = (numbers.next(), numbers.next(), numbers.next()) else {
                    return Err(self.bad("three numbers", line));
                };
                self.normals.push([x as f32, y as f32, z as f32]);
                self.check_count("normals", self.normals.len())?;
            }
            Some(b"f") => self.face(words, line)?,
            Some(b"mtllib") => {
                let named = String::from_utf8_lossy(&line[6..]).trim().to_owned();
                self.library.add(self.origin, &named);
            }
            Some(b"usemtl") => self.use_material(String::from_utf8_lossy(&line[6..]).trim())?,
            _ => {}
        }
        Ok(())
    }

    fn check_count(&self, what: &str, count: usize) -> Result<(), IoError> {
        let limit = SEVERAL as usize - 1;
        if count > limit {
            return Err(IoError::too_large(self.origin.name, what, count as u64, limit as u64));
        }
        Ok(())
    }

    /// A vertex: place, perhaps a weight, perhaps a colour.
    fn vertex<'w>(&mut self, words: impl Iterator<Item = &'w [u8]>, line: &[u8]) -> Result<(), IoError> {
        let mut numbers = [0.0; 7];
        let mut count = 0;
        for (slot, value) in numbers.iter_mut().zip(words.map_while(number)) {
            *slot = value;
            count += 1;
        }
        if count < 3 {
            return Err(self.bad("three numbers", line));
        }
        let [x, y, z, r, g, b, a] = numbers;
        if count >= 6 {
            // vertices without one among those with one are white
            self.colours.resize(self.mesh.positions.len(), [f32::INFINITY; 4]);
            let alpha = if count == 7 { a as f32 } else { f32::INFINITY };
            self.colours.push([r as f32, g as f32, b as f32, alpha]);
        }
        self.mesh.positions.push(DVec3::new(x, y, z));
        self.normal_of.push(NONE);
        self.check_count("vertices", self.mesh.positions.len())
    }

    fn use_material(&mut self, name: &str) -> Result<(), IoError> {
        if self.known_materials.is_empty() && !self.mesh.triangles.is_empty() {
            // those before have none
            self.material_names.push(String::new());
            self.known_materials.insert(String::new(), 0);
            self.mesh.material_of.resize(self.mesh.triangles.len(), 0);
        }
        if let Some(&known) = self.known_materials.get(name) {
            self.material = known;
            return Ok(());
        }
        let number = self.material_names.len();
        if number >= MATERIALS_LIMIT {
            return Err(IoError::too_large(self.origin.name, "materials", number as u64 + 1, MATERIALS_LIMIT as u64));
        }
        self.material = number as u16;
        self.material_names.push(name.to_owned());
        self.known_materials.insert(name.to_owned(), self.material);
        Ok(())
    }

    /// A face's corners, `vertex`, `vertex/texture`, `vertex//normal` or `vertex/texture/normal`, counted from 1, or
    /// backwards from the last one with a minus.
    fn face<'w>(&mut self, words: impl Iterator<Item = &'w [u8]>, line: &[u8]) -> Result<(), IoError> {
        self.corners.clear();
        self.corner_texcoords.clear();
        for word in words {
            if word.starts_with(b"#") {
                break;
            }
            let mut parts = word.split(|&b| b == b'/');
            let among = |what: &str, count: usize| format!("{what} among the {count} so far");
            let vertices = self.mesh.positions.len();
            let vertex = index(parts.next(), vertices)
                .ok_or_else(|| self.bad(&format!("corners among the {vertices} vertices so far"), line))?;
            let texcoord = match parts.next().filter(|part| !part.is_empty()) {
                Some(part) => index(Some(part), self.texcoords.len())
                    .ok_or_else(|| self.bad(&among("texture coordinates", self.texcoords.len()), line))?,
                None => NONE,
            };
            if let Some(part) = parts.next().filter(|part| !part.is_empty()) {
                let normal = index(Some(part), self.normals.len())
                    .ok_or_else(|| self.bad(&among("normals", self.normals.len()), line))?;
                let known = &mut self.normal_of[vertex as usize];
                let same = |a: u32, b: u32| a == b || self.normals[a as usize] == self.normals[b as usize];
                *known = match *known {
                    NONE => normal,
                    SEVERAL => SEVERAL,
                    known if same(known, normal) => known,
                    _ => SEVERAL,
                };
            }
            self.corners.push(vertex);
            self.corner_texcoords.push(texcoord);
        }
        if self.corners.len() < 3 {
            return Err(self.bad("a face of at least 3 corners", line));
        }
        let before = self.mesh.triangles.len();
        self.polygons.push(&self.corners, &mut self.mesh.triangles);
        if self.corner_texcoords.iter().any(|&t| t != NONE) {
            self.texcoord_of.resize(before, [NONE; 3]);
            let first = self.corner_texcoords[0];
            self.texcoord_of.extend(self.corner_texcoords[1..].windows(2).map(|pair| [first, pair[0], pair[1]]));
        }
        if !self.material_names.is_empty() {
            self.mesh.material_of.resize(self.mesh.triangles.len(), self.material);
        }
        Ok(())
    }

    fn finish(mut self) -> Result<TriangleMesh, IoError> {
        let mut mesh = self.mesh;
        if !self.colours.is_empty() {
            self.colours.resize(mesh.positions.len(), [f32::INFINITY; 4]);
            let coloured = self.colours.iter().filter(|c| c[0].is_finite()).copied().collect::<Vec<_>>();
            let mut bytes = ply_vertices::real_colours(&coloured);
            mesh.colours = self
                .colours
                .iter()
                .map(|c| if c[0].is_finite() { bytes.next().unwrap_or([255; 4]) } else { [255; 4] })
                .collect();
        }
        // normals are kept where every vertex that has a face has exactly one
        if self.normal_of.contains(&SEVERAL) {
            self.origin.note("normals not read: they differ between the faces of a vertex");
        } else if self.normal_of.iter().any(|&n| n != NONE) {
            let normal = |&n: &u32| self.normals.get(n as usize).copied().unwrap_or_default();
            mesh.normals = self.normal_of.iter().map(normal).collect();
        }
        if !self.texcoord_of.is_empty() {
            self.texcoord_of.resize(mesh.triangles.len(), [NONE; 3]);
            let numbers = seams::split(self.origin, &mut mesh, &self.texcoord_of, NONE)?;
            let texcoord = |n: u32| self.texcoords.get(n as usize).copied().unwrap_or_default();
            mesh.texcoords = numbers.into_iter().map(texcoord).collect();
        }
        self.polygons.cut(&mesh.positions, &mut mesh.triangles);
        mesh.materials = self
            .material_names
            .iter()
            .map(|name| match name.as_str() {
                "" => Material::default(),
                name => self.library.material(self.origin, name),
            })
            .collect();
        if mesh.materials.len() < 2 {
            mesh.material_of = Vec::new();
        }
        Ok(mesh)
    }
}

fn number(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// An index as faces have it, as one from 0.
fn index(word: Option<&[u8]>, count: usize) -> Option<u32> {
    let given: i64 = std::str::from_utf8(word?).ok()?.parse().ok()?;
    let index = if given < 0 { given.checked_add(count as i64)? } else { given - 1 };
    (0..count as i64).contains(&index).then_some(index as u32)
}
