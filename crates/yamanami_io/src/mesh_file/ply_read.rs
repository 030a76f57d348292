//! Reading PLY: text and both byte orders, any order of properties, polygons cut into fans, triangle strips.

use super::ply_header::{self, Element, Encoding, Kind, Number};
use crate::IoError;
use glam::DVec3;
use std::path::Path;
use yamanami_core::TriangleMesh;

pub(super) fn read(name: &Path, bytes: &[u8]) -> Result<TriangleMesh, IoError> {
    let (header, rest) = ply_header::read(name, bytes)?;
    let mut values = Values { name, rest, encoding: header.encoding };
    let mut mesh = TriangleMesh::default();
    let vertices = header.elements.iter().find(|e| e.name == "vertex").map_or(0, |e| e.count);
    if vertices > u64::from(u32::MAX) {
        return Err(IoError::too_large(name, "vertices", vertices, u32::MAX.into()));
    }
    for element in &header.elements {
        values.check_room(element)?;
        match element.name.as_str() {
            "vertex" => read_vertices(&mut values, element, &mut mesh)?,
            "face" => read_polygons(&mut values, element, vertices, &mut mesh.triangles, fan)?,
            "tristrips" => read_polygons(&mut values, element, vertices, &mut mesh.triangles, strip)?,
            _ => skip(&mut values, element)?,
        }
    }
    Ok(mesh)
}

/// The values after the header.
struct Values<'a> {
    name: &'a Path,
    rest: &'a [u8],
    encoding: Encoding,
}

impl<'a> Values<'a> {
    /// Refuses a count that the rest of the file cannot hold.
    fn check_room(&self, element: &Element) -> Result<(), IoError> {
        let least = element.least_bytes(self.encoding) as u64;
        // text may lack the last separator
        let needed = element.count.saturating_mul(least).saturating_sub(u64::from(self.encoding == Encoding::Ascii));
        if needed > self.rest.len() as u64 {
            let expected = format!("at least {needed} bytes for {} records", element.count);
            return Err(self.bad(&format!("element '{}'", element.name), &expected, &format!("{}", self.rest.len())));
        }
        Ok(())
    }

    fn bad(&self, place: &str, expected: &str, found: &str) -> IoError {
        IoError::malformed(self.name, place, expected, found)
    }

    /// The next value, or `None` at the end of the file or where there is no number.
    fn next(&mut self, number: Number) -> Option<f64> {
        if self.encoding == Encoding::Ascii {
            let start = self.rest.iter().position(|b| !b.is_ascii_whitespace())?;
            let rest = &self.rest[start..];
            let end = rest.iter().position(|b| b.is_ascii_whitespace()).unwrap_or(rest.len());
            self.rest = &rest[end..];
            return std::str::from_utf8(&rest[..end]).ok()?.parse().ok();
        }
        let (raw, rest) = self.rest.split_at_checked(number.size())?;
        self.rest = rest;
        let mut little = [0u8; 8];
        little[..raw.len()].copy_from_slice(raw);
        if self.encoding == Encoding::BigEndian {
            little[..raw.len()].reverse();
        }
        let bits = u64::from_le_bytes(little);
        Some(match number {
            Number::I8 => f64::from(bits as i8),
            Number::U8 => f64::from(bits as u8),
            Number::I16 => f64::from(bits as i16),
            Number::U16 => f64::from(bits as u16),
            Number::I32 => f64::from(bits as i32),
            Number::U32 => f64::from(bits as u32),
            Number::F32 => f64::from(f32::from_bits(bits as u32)),
            Number::F64 => f64::from_bits(bits),
        })
    }

    /// The next value of a record's property.
    fn scalar(&mut self, number: Number, element: &Element, record: u64, property: usize) -> Result<f64, IoError> {
        self.next(number).ok_or_else(|| {
            let property = &element.properties[property].name;
            self.bad(&format!("{} {record}, '{property}'", element.name), "a number", "none")
        })
    }

    /// The next list; its items replace those in `items`.
    fn list(
        &mut self,
        [count, item]: [Number; 2],
        element: &Element,
        record: u64,
        property: usize,
        items: &mut Vec<f64>,
    ) -> Result<(), IoError> {
        items.clear();
        let length = self.scalar(count, element, record, property)?;
        if !(length >= 0.0 && length.fract() == 0.0 && length <= self.rest.len() as f64) {
            let place = format!("{} {record}, '{}'", element.name, element.properties[property].name);
            let expected = format!("a list that fits in the {} bytes left", self.rest.len());
            return Err(self.bad(&place, &expected, &format!("{length} items")));
        }
        for _ in 0..length as usize {
            items.push(self.scalar(item, element, record, property)?);
        }
        Ok(())
    }
}

fn read_vertices(values: &mut Values<'_>, element: &Element, mesh: &mut TriangleMesh) -> Result<(), IoError> {
    let places = ["x", "y", "z", "nx", "ny", "nz"].map(|name| element.property(&[name]));
    let ([Some(x), Some(y), Some(z)], normal) = ([places[0], places[1], places[2]], &places[3..]) else {
        let found: Vec<&str> = element.properties.iter().map(|p| p.name.as_str()).collect();
        return Err(values.bad("element 'vertex'", "properties x, y and z", &format!("'{}'", found.join(" "))));
    };
    let normal = match *normal {
        [Some(x), Some(y), Some(z)] => Some([x, y, z]),
        _ => None,
    };
    // the count fits the file, so this allocates a small multiple of its size at most
    mesh.positions.reserve(element.count as usize);
    let mut record = vec![0.0; element.properties.len()];
    let mut items = Vec::new();
    for number in 0..element.count {
        for (k, property) in element.properties.iter().enumerate() {
            match property.kind {
                Kind::Scalar(kind) => record[k] = values.scalar(kind, element, number, k)?,
                Kind::List { count, item } => values.list([count, item], element, number, k, &mut items)?,
            }
        }
        mesh.positions.push(DVec3::new(record[x], record[y], record[z]));
        if let Some(n) = normal {
            mesh.normals.push(n.map(|k| record[k] as f32));
        }
    }
    Ok(())
}

/// Cuts a list of corners into triangles; corners are below the number of vertices, or `None` for a strip's restart.
type Cut = fn(&[Option<u32>], &mut Vec<[u32; 3]>);

fn read_polygons(
    values: &mut Values<'_>,
    element: &Element,
    vertices: u64,
    triangles: &mut Vec<[u32; 3]>,
    cut: Cut,
) -> Result<(), IoError> {
    let is_list = |&k: &usize| matches!(element.properties[k].kind, Kind::List { .. });
    let Some(corners_at) = element.property(&["vertex_indices", "vertex_index"]).filter(is_list) else {
        return Err(values.bad(&format!("element '{}'", element.name), "a list 'vertex_indices'", "none"));
    };
    let strips = element.name == "tristrips";
    let (mut items, mut corners) = (Vec::new(), Vec::new());
    for number in 0..element.count {
        for (k, property) in element.properties.iter().enumerate() {
            match property.kind {
                Kind::Scalar(kind) => {
                    values.scalar(kind, element, number, k)?;
                }
                Kind::List { count, item } => values.list([count, item], element, number, k, &mut items)?,
            }
            if k != corners_at {
                continue;
            }
            let place = || format!("{} {number}", element.name);
            if !strips && items.len() < 3 {
                return Err(values.bad(&place(), "at least 3 corners", &items.len().to_string()));
            }
            corners.clear();
            for &corner in &items {
                corners.push(match corner {
                    -1.0 if strips => None,
                    c if c >= 0.0 && c < vertices as f64 && c.fract() == 0.0 => Some(c as u32),
                    c => return Err(values.bad(&place(), &format!("corners below {vertices}"), &c.to_string())),
                });
            }
            cut(&corners, triangles);
        }
    }
    Ok(())
}

fn fan(corners: &[Option<u32>], triangles: &mut Vec<[u32; 3]>) {
    for pair in corners[1..].windows(2) {
        if let [Some(a), Some(b), Some(c)] = [corners[0], pair[0], pair[1]] {
            triangles.push([a, b, c]);
        }
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

fn skip(values: &mut Values<'_>, element: &Element) -> Result<(), IoError> {
    let fixed = element.properties.iter().all(|p| matches!(p.kind, Kind::Scalar(_)));
    if fixed && values.encoding != Encoding::Ascii {
        // the room was checked
        values.rest = &values.rest[element.count as usize * element.least_bytes(values.encoding)..];
        return Ok(());
    }
    if element.properties.is_empty() {
        return Ok(());
    }
    let mut items = Vec::new();
    for number in 0..element.count {
        for (k, property) in element.properties.iter().enumerate() {
            match property.kind {
                Kind::Scalar(kind) => {
                    values.scalar(kind, element, number, k)?;
                }
                Kind::List { count, item } => values.list([count, item], element, number, k, &mut items)?,
            }
        }
    }
    Ok(())
}
