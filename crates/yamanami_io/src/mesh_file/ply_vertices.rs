//! The vertices of a PLY file: places, normals, colours and texture coordinates under the names that programs give them.

use super::ply_header::{Element, Encoding, Kind, Number};
use super::ply_values::Values;
use crate::IoError;
use glam::DVec3;
use yamanami_core::TriangleMesh;

/// Where each quantity is in a record.
struct Columns {
    place: [usize; 3],
    normal: Option<[usize; 3]>,
    colour: Option<[usize; 3]>,
    alpha: Option<usize>,
    texcoord: Option<[usize; 2]>,
}

impl Columns {
    fn of(element: &Element) -> Option<Self> {
        let scalar =
            |names: &[&str]| element.property(names).filter(|&k| matches!(element.properties[k].kind, Kind::Scalar(_)));
        let three = |names: [&str; 3]| {
            let [a, b, c] = names.map(|n| scalar(&[n]));
            Some([a?, b?, c?])
        };
        let two = |names: [&str; 2]| {
            let [a, b] = names.map(|n| scalar(&[n]));
            Some([a?, b?])
        };
        Some(Self {
            place: three(["x", "y", "z"])?,
            normal: three(["nx", "ny", "nz"]),
            colour: three(["red", "green", "blue"])
                .or_else(|| three(["diffuse_red", "diffuse_green", "diffuse_blue"]))
                .or_else(|| three(["r", "g", "b"])),
            alpha: scalar(&["alpha", "diffuse_alpha", "a"]),
            texcoord: two(["s", "t"])
                .or_else(|| two(["u", "v"]))
                .or_else(|| two(["texture_u", "texture_v"]))
                .or_else(|| two(["texture_s", "texture_t"])),
        })
    }
}

/// What a stored 1 means in a colour.
#[derive(Clone, Copy)]
enum Shade {
    /// 255 is full, whatever integer holds it.
    Byte,
    /// 65535 is full.
    Word,
    /// 1 is full, or 255 if any value is above 1: both are found.
    Real,
}

impl Shade {
    fn of(element: &Element, column: usize) -> Self {
        match element.properties[column].kind {
            Kind::Scalar(Number::F32 | Number::F64) => Self::Real,
            Kind::Scalar(Number::U16) => Self::Word,
            _ => Self::Byte,
        }
    }
}

/// A share of full as a byte; what is no number is 0.
pub(super) fn byte(share: f64) -> u8 {
    (share * 255.0).round() as u8
}

pub(super) fn read(values: &mut Values<'_>, element: &Element, mesh: &mut TriangleMesh) -> Result<(), IoError> {
    let Some(columns) = Columns::of(element) else {
        let found: Vec<&str> = element.properties.iter().map(|p| p.name.as_str()).collect();
        return Err(values.bad("element 'vertex'", "properties x, y and z", &format!("'{}'", found.join(" "))));
    };
    // the count fits the file, so this allocates a small multiple of its size at most
    mesh.positions.reserve(element.count as usize);
    let mut sink = VertexSink { columns, real_colours: Vec::new(), mesh, element };
    let mut record = vec![0.0; element.properties.len()];
    if element.is_fixed() && values.encoding != Encoding::Ascii {
        let encoding = values.encoding;
        let size = element.least_bytes(encoding);
        // the room was checked
        let (records, rest) = values.rest.split_at(size * element.count as usize);
        values.rest = rest;
        let mut fields = Vec::new();
        let mut offset = 0;
        for (k, property) in element.properties.iter().enumerate() {
            if let Kind::Scalar(number) = property.kind {
                if sink.columns.uses(k) {
                    fields.push((k, offset, number));
                }
                offset += number.size();
            }
        }
        for raw in records.chunks_exact(size) {
            for &(k, offset, number) in &fields {
                record[k] = number.value(&raw[offset..offset + number.size()], encoding);
            }
            sink.push(&record);
        }
    } else {
        let mut items = Vec::new();
        for number in 0..element.count {
            for (k, property) in element.properties.iter().enumerate() {
                match property.kind {
                    Kind::Scalar(kind) => record[k] = values.scalar(kind, element, number, k)?,
                    Kind::List { count, item } => values.list([count, item], element, number, k, &mut items)?,
                }
            }
            sink.push(&record);
        }
    }
    sink.finish();
    Ok(())
}

impl Columns {
    fn uses(&self, column: usize) -> bool {
        let groups: [&[usize]; 5] = [
            &self.place,
            self.normal.as_ref().map_or(&[], |c| c),
            self.colour.as_ref().map_or(&[], |c| c),
            self.alpha.as_slice(),
            self.texcoord.as_ref().map_or(&[], |c| c),
        ];
        groups.iter().any(|group| group.contains(&column))
    }
}

struct VertexSink<'a> {
    columns: Columns,
    /// Colours in floating point, until their scale is known.
    real_colours: Vec<[f32; 4]>,
    mesh: &'a mut TriangleMesh,
    element: &'a Element,
}

impl VertexSink<'_> {
    #[inline]
    fn push(&mut self, record: &[f64]) {
        let [x, y, z] = self.columns.place.map(|k| record[k]);
        self.mesh.positions.push(DVec3::new(x, y, z));
        if let Some(normal) = self.columns.normal {
            self.mesh.normals.push(normal.map(|k| record[k] as f32));
        }
        if let Some(texcoord) = self.columns.texcoord {
            let [u, v] = texcoord.map(|k| record[k]);
            self.mesh.texcoords.push([u as f32, (1.0 - v) as f32]);
        }
        if let Some([r, g, b]) = self.columns.colour {
            let columns = [Some(r), Some(g), Some(b), self.columns.alpha];
            match Shade::of(self.element, r) {
                Shade::Byte => self.mesh.colours.push(columns.map(|k| k.map_or(255, |k| record[k] as u8))),
                Shade::Word => {
                    self.mesh.colours.push(columns.map(|k| k.map_or(255, |k| byte(record[k] / 65535.0))));
                }
                Shade::Real => {
                    self.real_colours.push(columns.map(|k| k.map_or(f32::INFINITY, |k| record[k] as f32)));
                }
            }
        }
    }

    fn finish(self) {
        self.mesh.colours.extend(real_colours(&self.real_colours));
    }
}

/// Colours in floating point: 1 is full, or 255 if any is above 1. A missing alpha is infinite, and so full.
pub(super) fn real_colours(colours: &[[f32; 4]]) -> impl Iterator<Item = [u8; 4]> {
    let full = if colours.iter().any(|c| c[..3].iter().any(|&c| c > 1.0)) { 255.0 } else { 1.0 };
    colours.iter().map(move |c| c.map(|c| byte(f64::from(c / full))))
}
