//! Reading PLY: text and both byte orders, any order of properties, polygons, triangle strips, colours, and texture
//! coordinates by vertex or by face corner.

use super::origin::Origin;
use super::ply_header::{self, Element, Encoding, Kind, Number};
use super::ply_values::Values;
use super::polygon::Polygons;
use super::{ply_vertices, seams};
use crate::IoError;
use yamanami_core::{Material, TriangleMesh};

/// Most pictures of a file.
const TEXTURES_LIMIT: usize = 4096;

pub(super) fn read(origin: &mut Origin<'_>, bytes: &[u8]) -> Result<TriangleMesh, IoError> {
    let (header, rest) = ply_header::read(origin.name, bytes)?;
    let mut values = Values { name: origin.name, rest, encoding: header.encoding };
    let mut mesh = TriangleMesh::default();
    let vertices = header.elements.iter().find(|e| e.name == "vertex").map_or(0, |e| e.count);
    if vertices >= u64::from(u32::MAX) {
        return Err(IoError::too_large(origin.name, "vertices", vertices, u64::from(u32::MAX) - 1));
    }
    let mut faces = Faces { vertices, ..Faces::default() };
    let mut vertices_read = false;
    for element in &header.elements {
        values.check_room(element)?;
        match element.name.as_str() {
            "vertex" if !std::mem::replace(&mut vertices_read, true) => {
                ply_vertices::read(&mut values, element, &mut mesh)?;
            }
            "face" => faces.read(&mut values, element)?,
            "tristrips" => faces.read_strips(&mut values, element)?,
            _ => values.skip(element)?,
        }
    }
    if header.textures.len() > TEXTURES_LIMIT {
        let (given, limit) = (header.textures.len() as u64, TEXTURES_LIMIT as u64);
        return Err(IoError::too_large(origin.name, "textures", given, limit));
    }
    mesh.materials = header.textures.iter().map(|named| origin.picture_material(named)).collect();
    faces.finish(origin, &mut mesh)?;
    Ok(mesh)
}

/// No texture coordinate: a pattern that no number has.
const UNSET: [u32; 2] = [u32::MAX; 2];

/// No picture.
const BARE: u16 = u16::MAX;

#[derive(Default)]
struct Faces {
    vertices: u64,
    triangles: Vec<[u32; 3]>,
    polygons: Polygons,
    /// Bits of the texture coordinates of each triangle's corners, as far as there are any.
    corner_texcoords: Vec<[[u32; 2]; 3]>,
    /// Each triangle's picture, as far as there are any.
    texture_of: Vec<u16>,
    has_face_colours: bool,
}

impl Faces {
    fn read(&mut self, values: &mut Values<'_>, element: &Element) -> Result<(), IoError> {
        let is_list = |&k: &usize| matches!(element.properties[k].kind, Kind::List { .. });
        let Some(corners_at) = element.property(&["vertex_indices", "vertex_index"]).filter(is_list) else {
            return Err(values.bad(&format!("element '{}'", element.name), "a list 'vertex_indices'", "none"));
        };
        let texcoords_at = element.property(&["texcoord"]).filter(is_list);
        let texture_at = element.property(&["texnumber"]).filter(|k| !is_list(k));
        self.has_face_colours |= element.property(&["red"]).is_some();
        let plain = match (element.properties.len(), element.properties[corners_at].kind) {
            (1, Kind::List { count: Number::U8, item: Number::I32 | Number::U32 }) => values.encoding,
            _ => Encoding::Ascii,
        };
        if let Kind::List { item, .. } = element.properties[corners_at].kind {
            // no more than what the file has room for
            let least = element.least_bytes(values.encoding) + 3 * item.size().min(2);
            self.triangles.reserve(element.count.min((values.rest.len() / least) as u64) as usize);
        }
        let (mut items, mut corners, mut texcoords, mut other) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut number = 0;
        while number < element.count {
            if plain != Encoding::Ascii {
                number += self.run_of_triangles(values, plain, element.count - number);
                if number == element.count {
                    break;
                }
            }
            let mut texture = 0.0;
            for (k, property) in element.properties.iter().enumerate() {
                match property.kind {
                    Kind::Scalar(kind) => {
                        let value = values.scalar(kind, element, number, k)?;
                        if texture_at == Some(k) {
                            texture = value;
                        }
                    }
                    Kind::List { count, item } => {
                        let into = match k {
                            _ if k == corners_at => &mut items,
                            _ if texcoords_at == Some(k) => &mut texcoords,
                            _ => &mut other,
                        };
                        values.list([count, item], element, number, k, into)?;
                    }
                }
            }
            let place = || format!("{} {number}", element.name);
            if items.len() < 3 {
                return Err(values.bad(&place(), "at least 3 corners", &items.len().to_string()));
            }
            corners.clear();
            for &corner in &items {
                match self.corner(corner) {
                    Some(corner) => corners.push(corner),
                    None => {
                        let expected = format!("corners below {}", self.vertices);
                        return Err(values.bad(&place(), &expected, &corner.to_string()));
                    }
                }
            }
            self.polygons.push(&corners, &mut self.triangles);
            if texcoords_at.is_some() {
                self.push_texcoords(&texcoords, corners.len());
            }
            if texture_at.is_some() {
                // MeshLab's -1 is a face without a picture
                let texture = if texture >= 0.0 { texture.min(65534.0) as u16 } else { BARE };
                self.texture_of.resize(self.triangles.len() + 2 - corners.len(), BARE);
                self.texture_of.resize(self.triangles.len(), texture);
            }
            number += 1;
        }
        Ok(())
    }

    fn corner(&self, value: f64) -> Option<u32> {
        (value >= 0.0 && value < self.vertices as f64 && value.fract() == 0.0).then_some(value as u32)
    }

    /// Reads the usual record, a byte 3 and three indices, as long as it comes; gives how many.
    fn run_of_triangles(&mut self, values: &mut Values<'_>, encoding: Encoding, most: u64) -> u64 {
        let index = |raw: &[u8]| {
            let raw = [raw[0], raw[1], raw[2], raw[3]];
            if encoding == Encoding::BigEndian { u32::from_be_bytes(raw) } else { u32::from_le_bytes(raw) }
        };
        let before = self.triangles.len();
        for record in values.rest.chunks_exact(13).take(most as usize) {
            let triangle = [index(&record[1..5]), index(&record[5..9]), index(&record[9..13])];
            if record[0] != 3 || triangle.iter().any(|&i| u64::from(i) >= self.vertices) {
                break;
            }
            self.triangles.push(triangle);
        }
        let read = self.triangles.len() - before;
        values.rest = &values.rest[13 * read..];
        read as u64
    }

    /// Spreads a face's texture coordinates over its fan; a list of another length says nothing.
    fn push_texcoords(&mut self, list: &[f64], corners: usize) {
        let at = |k: usize| match list {
            _ if list.len() != 2 * corners => UNSET,
            _ => [list[2 * k] as f32, (1.0 - list[2 * k + 1]) as f32].map(|c| if c.is_nan() { 0 } else { c.to_bits() }),
        };
        // faces of an element without coordinates may have come before
        self.corner_texcoords.resize(self.triangles.len() + 2 - corners, [UNSET; 3]);
        self.corner_texcoords.extend((1..corners - 1).map(|k| [at(0), at(k), at(k + 1)]));
    }

    fn read_strips(&mut self, values: &mut Values<'_>, element: &Element) -> Result<(), IoError> {
        let list = element.property(&["vertex_indices", "vertex_index"]);
        if list.is_none() {
            return values.skip(element);
        }
        let (mut items, mut corners) = (Vec::new(), Vec::new());
        for number in 0..element.count {
            for (k, property) in element.properties.iter().enumerate() {
                match property.kind {
                    Kind::Scalar(kind) => {
                        values.scalar(kind, element, number, k)?;
                    }
                    Kind::List { count, item } => values.list([count, item], element, number, k, &mut items)?,
                }
                if list != Some(k) {
                    continue;
                }
                corners.clear();
                for &item in &items {
                    let corner = self.corner(item);
                    if corner.is_none() && item != -1.0 {
                        let expected = format!("corners below {}, or -1", self.vertices);
                        return Err(values.bad(&format!("tristrips {number}"), &expected, &item.to_string()));
                    }
                    corners.push(corner);
                }
                strip(&corners, &mut self.triangles);
            }
        }
        Ok(())
    }

    fn finish(mut self, origin: &mut Origin<'_>, mesh: &mut TriangleMesh) -> Result<(), IoError> {
        mesh.triangles = self.triangles;
        if !self.corner_texcoords.is_empty() {
            self.corner_texcoords.resize(mesh.triangles.len(), [UNSET; 3]);
            let bits = seams::split(origin, mesh, &self.corner_texcoords, UNSET)?;
            let set = |b: [u32; 2]| if b == UNSET { [0.0; 2] } else { b.map(f32::from_bits) };
            mesh.texcoords = bits.into_iter().map(set).collect();
        }
        if !self.texture_of.is_empty() && !mesh.materials.is_empty() {
            self.texture_of.resize(mesh.triangles.len(), BARE);
            let bare = mesh.materials.len() as u16;
            mesh.material_of = self.texture_of.into_iter().map(|t| t.min(bare)).collect();
            if mesh.material_of.contains(&bare) {
                mesh.materials.push(Material::default());
            }
        }
        if self.has_face_colours && mesh.colours.is_empty() {
            origin.note("colours of faces are not read, only those of vertices");
        }
        self.polygons.cut(&mesh.positions, &mut mesh.triangles);
        Ok(())
    }
}

fn strip(corners: &[Option<u32>], triangles: &mut Vec<[u32; 3]>) {
    for run in corners.split(Option::is_none) {
        for (k, three) in run.windows(3).enumerate() {
            // strips join at triangles without area, which are no faces
            if let [Some(a), Some(b), Some(c)] = *three
                && a != b
                && b != c
                && c != a
            {
                triangles.push(if k % 2 == 0 { [a, b, c] } else { [b, a, c] });
            }
        }
    }
}
